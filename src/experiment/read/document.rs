//! Text → tables, as far as the syntax lets.

use super::LARGEST;
use super::node::Reader;
use super::problem::{Problem, Problems, Span};
use std::fs::File;
use std::io::Read;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Longer texts are read without recovery from syntax errors: each byte can be one.
const RECOVERABLE: usize = 1 << 18;

/// The text of the file at `path`; `-` is the standard input.
pub(super) fn text(path: &Path) -> Result<String, Problems> {
    let origin = path.display().to_string();
    let unreadable = |error: std::io::Error| {
        Problems::unreadable(&origin, format!("cannot read the experiment: {error}"))
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
        return Err(Problems::whole(
            &origin,
            format!(
                "an experiment file has at most {} MiB; this one is larger",
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

/// The document as far as it can be read, and the places where it is broken.
pub(super) fn parse<'t>(text: &'t str, reader: &mut Reader) -> (Spanned<DeTable<'t>>, Vec<Span>) {
    let (document, errors) = if text.len() <= RECOVERABLE {
        DeTable::parse_recoverable(text)
    } else {
        match DeTable::parse(text) {
            Ok(document) => (document, Vec::new()),
            Err(error) => (Spanned::new(0..0, DeTable::new()), vec![error]),
        }
    };
    let mut faults: Vec<(Span, String)> = errors
        .iter()
        .map(|error| {
            let span = error.span().unwrap_or(0..0);
            (span, error.message().to_owned())
        })
        .collect();
    faults.sort_by_key(|(span, _)| span.start);
    let mut broken = Vec::new();
    // A bracket never closed swallows the rest of the file: it is the fault, not what it swallows.
    let unclosed = faults
        .iter()
        .any(|(_, message)| message.starts_with("unclosed"))
        .then(|| swallowing(document.get_ref(), text.trim_end().len()))
        .flatten();
    if let Some(open) = unclosed {
        faults.retain(|(span, _)| span.start < open);
        reader.report(Problem::at(
            open..open + 1,
            format!("this `{}` is never closed", &text[open..=open]),
        ));
        broken.push(open..text.len());
    }
    let mut last_line = None;
    for (span, message) in faults {
        let line = line_of(text, span.start);
        // What follows the first fault of a line is mostly its echo.
        if last_line.as_ref() != Some(&line) {
            reader.report(plain(text, span, &message));
            broken.push(line.clone());
            last_line = Some(line);
        }
    }
    (document, broken)
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

/// The start of the outermost list or table that goes on to the end of the text.
fn swallowing(table: &DeTable<'_>, end: usize) -> Option<usize> {
    table.values().filter_map(|item| in_item(item, end)).min()
}

fn in_item(item: &Spanned<DeValue<'_>>, end: usize) -> Option<usize> {
    let span = item.span();
    match item.get_ref() {
        // Headers end at their bracket; only values in brackets reach the end unclosed.
        DeValue::Array(_) | DeValue::Table(_) if span.end >= end && span.end > span.start + 1 => {
            Some(span.start)
        }
        DeValue::Array(list) => list.iter().filter_map(|item| in_item(item, end)).min(),
        DeValue::Table(table) => swallowing(table, end),
        _ => None,
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
pub(super) fn sift(problems: &mut Vec<Problem>, text: &str, broken: &[Span]) {
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
