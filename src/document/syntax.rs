//! Text → tables, as far as the syntax lets.

use super::LARGEST;
use super::node::Reader;
use super::problem::{Problem, Problems, Span};
use std::borrow::Cow;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use toml::Spanned;
use toml::de::DeTable;

/// Longer texts are read without recovery from syntax errors: each byte can be one.
const RECOVERABLE: usize = 1 << 18;

/// The text of the file at `path`, which is to hold a `kind` such as "experiment"; `-` is the standard input.
pub(crate) fn text(path: &Path, kind: &str) -> Result<String, Problems> {
    let origin = path.display().to_string();
    let unreadable = |error: std::io::Error| {
        Problems::unreadable(&origin, format!("cannot read the {kind}: {error}"))
    };
    let mut bytes = Vec::new();
    let most = LARGEST as u64 + 1;
    if path == Path::new("-") {
        std::io::stdin().take(most).read_to_end(&mut bytes)
    } else {
        File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes))
    }
    .map_err(unreadable)?;
    if bytes.len() > LARGEST {
        let article = if kind.starts_with(['a', 'e', 'i', 'o', 'u']) {
            "an"
        } else {
            "a"
        };
        return Err(Problems::whole(
            &origin,
            format!(
                "{article} {kind} file has at most {} MiB; this one is larger",
                LARGEST >> 20
            ),
        ));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let bytes = error.into_bytes();
        let byte = bytes[at];
        // All before the fault is kept so that it can be shown and located.
        let mut before = String::from_utf8_lossy(&bytes[..at]).into_owned();
        before.push('\u{fffd}');
        Problems::new(
            &origin,
            &before,
            vec![
                Problem::at(
                    at..at + '\u{fffd}'.len_utf8(),
                    format!("this byte ({byte:#04x}) is not UTF-8 text"),
                )
                .help("save the file as UTF-8"),
            ],
        )
    })
}

/// The text with the lines blanked where a bracket opens that is never closed: it would swallow the rest of the file. Places stay where they are.
pub(crate) fn close_brackets<'t>(
    text: &'t str,
    reader: &mut Reader,
    broken: &mut Vec<Span>,
) -> Cow<'t, str> {
    /// More such lines are left to be found when these are mended.
    const MOST: usize = 10;
    let mut work = Cow::Borrowed(text);
    if text.len() > RECOVERABLE {
        return work;
    }
    for _ in 0..MOST {
        let Some(open) = unclosed(&work) else { break };
        let line = line_of(&work, open);
        reader.report(Problem::at(
            open..open + 1,
            format!("this `{}` is never closed", &work[open..=open]),
        ));
        work.to_mut()
            .replace_range(line.clone(), &" ".repeat(line.len()));
        broken.push(line);
    }
    work
}

/// Where the outermost bracket opens that is not closed by the end of the text.
fn unclosed(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let mut open: Vec<usize> = Vec::new();
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'#' => at += until(&bytes[at..], b"\n"),
            b'"' | b'\'' => {
                at += string(&bytes[at..]);
                continue;
            }
            b'[' | b'{' => open.push(at),
            b']' | b'}' => {
                let opening = if byte == b']' { b'[' } else { b'{' };
                if open.last().is_some_and(|&last| bytes[last] == opening) {
                    open.pop();
                }
            }
            _ => {}
        }
        at += 1;
    }
    open.first().copied()
}

/// The length of the string that `bytes` begin with, as far as it goes.
fn string(bytes: &[u8]) -> usize {
    let quote = bytes[0];
    let triple = [quote; 3];
    if bytes.starts_with(&triple) {
        let mut at = 3;
        while at < bytes.len() && !bytes[at..].starts_with(&triple) {
            at += if quote == b'"' && bytes[at] == b'\\' {
                2
            } else {
                1
            };
        }
        return (at + 3).min(bytes.len());
    }
    let mut at = 1;
    while at < bytes.len() && bytes[at] != quote && bytes[at] != b'\n' {
        at += if quote == b'"' && bytes[at] == b'\\' {
            2
        } else {
            1
        };
    }
    (at + 1).min(bytes.len())
}

fn until(bytes: &[u8], end: &[u8]) -> usize {
    bytes
        .windows(end.len())
        .position(|window| window == end)
        .unwrap_or(bytes.len())
}

/// The document as far as it can be read; the places where it is broken are added to `broken`.
pub(crate) fn parse<'t>(
    text: &'t str,
    reader: &mut Reader,
    broken: &mut Vec<Span>,
) -> Spanned<DeTable<'t>> {
    let (document, errors) = if text.len() <= RECOVERABLE {
        DeTable::parse_recoverable(text)
    } else {
        match DeTable::parse(text) {
            Ok(document) => (document, Vec::new()),
            Err(error) => (Spanned::new(0..0, DeTable::new()), vec![error]),
        }
    };
    let mut faults: Vec<(Span, &str)> = errors
        .iter()
        .map(|error| (error.span().unwrap_or(0..0), error.message()))
        .collect();
    faults.sort_by_key(|(span, _)| span.start);
    let mut last_line = None;
    for (span, message) in faults {
        let line = line_of(text, span.start);
        // What follows the first fault of a line is mostly its echo.
        if last_line.as_ref() != Some(&line) {
            reader.report(plain(text, span, message));
            broken.push(line.clone());
            last_line = Some(line);
        }
    }
    document
}

/// The syntax error in words that say what to do.
fn plain(text: &str, span: Span, message: &str) -> Problem {
    let (what, help) = match message {
        m if m.starts_with("duplicate key") => (
            "this key is given twice in the same table".to_owned(),
            Some("keep one of the two; a list of tables begins each with [[..]]"),
        ),
        m if m.starts_with("string values must be quoted") => {
            ("a text must stand in quotes".to_owned(), None)
        }
        m if m.contains("recurs") => ("brackets are nested too deep".to_owned(), None),
        m => (m.to_owned(), None),
    };
    let mut problem = Problem::at(span.clone(), what);
    if message.starts_with("string values must be quoted")
        && let Some(word) = text.get(span)
        && word.len() <= 80
    {
        problem = problem.suggest(Some(format!("\"{word}\"")));
    }
    match help {
        Some(help) => problem.help(help),
        None => problem,
    }
}

fn line_of(text: &str, at: usize) -> Span {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    let start = text[..at].rfind('\n').map_or(0, |found| found + 1);
    let end = text[at..].find('\n').map_or(text.len(), |found| at + found);
    start..end
}

/// Where the syntax is broken, drops what may only follow from that: problems on broken lines beside the syntax's own, which come first, and
/// things missed anywhere.
pub(crate) fn sift(problems: &mut Vec<Problem>, text: &str, broken: &[Span]) {
    if broken.is_empty() {
        return;
    }
    let mut syntax = broken.len();
    problems.retain(|problem| {
        if syntax > 0 {
            syntax -= 1;
            return true;
        }
        let line = line_of(text, problem.span.start);
        !problem.doubtful
            && !broken
                .iter()
                .any(|fault| fault.start <= line.end && line.start <= fault.end)
    });
}
