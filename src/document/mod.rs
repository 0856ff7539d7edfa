//! TOML text → checked values, or every problem of the text at once.
//!
//! Reading goes on after a problem: what can still be understood is checked too, so that one look at the messages mends the file. Each problem
//! says where it is, what is allowed there and, where a word looks misspelt, what was probably meant. What the values mean is the business of
//! whoever asks: an experiment, a scene.
//!
//! | file | what it does |
//! |---|---|
//! | `syntax` | text → tables, problems of the syntax |
//! | `node`, `value` | tables and values of the expected type |
//! | `problem` | what is wrong and where; written for people and for scripts |

pub(crate) mod node;
pub(crate) mod problem;
pub(crate) mod syntax;
pub(crate) mod value;

pub use problem::{Problem, Problems, Span};

use node::Reader;
use std::path::Path;
use toml::Spanned;
use toml::de::DeTable;

/// The largest file, in bytes.
pub const LARGEST: usize = 8 << 20;

/// Reads `text`, which came from `origin`, with `read`.
///
/// # Errors
/// With everything that is wrong, if there is anything or `read` found nothing.
pub(crate) fn read<T>(
    text: &str,
    origin: &Path,
    read: impl FnOnce(&mut Reader, &Spanned<DeTable<'_>>, &str) -> Option<T>,
) -> Result<T, Problems> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut reader = Reader::default();
    let mut broken = Vec::new();
    let readable = syntax::close_brackets(text, &mut reader, &mut broken);
    let document = syntax::parse(&readable, &mut reader, &mut broken);
    let found = read(&mut reader, &document, text);
    let mut problems = reader.problems;
    syntax::sift(&mut problems, text, &broken);
    match found {
        Some(found) if problems.is_empty() => Ok(found),
        _ => Err(Problems::new(&origin.display().to_string(), text, problems)),
    }
}
