//! What is wrong with a file, where, and what would be right.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::fmt::{self, Write as _};
use std::ops::Range;

/// The bytes of a text that something is about.
pub type Span = Range<usize>;

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// The bytes of the text at fault.
    pub span: Span,
    /// The line, from 1; 0 if the problem has no place in the text.
    pub line: usize,
    /// The column of the first character at fault, from 1, in characters.
    pub column: usize,
    /// The column after the last character at fault on that line.
    pub end: usize,
    /// What is wrong.
    pub message: String,
    /// What is allowed there.
    pub allowed: Option<String>,
    /// What was probably meant.
    pub suggestion: Option<String>,
    /// What to do, where the list of what is allowed does not say it.
    pub help: Option<String>,
    /// Whether the problem might vanish when others are mended: something is missed that may only have been misread.
    pub(crate) doubtful: bool,
}

impl Problem {
    /// A problem at `span`; the line and the column are found when the problems are gathered.
    pub(crate) fn at(span: Span, message: impl Into<String>) -> Self {
        Self {
            span,
            line: 0,
            column: 0,
            end: 0,
            message: message.into(),
            allowed: None,
            suggestion: None,
            help: None,
            doubtful: false,
        }
    }

    pub(crate) fn allowed(self, allowed: impl fmt::Display) -> Self {
        Self {
            allowed: Some(allowed.to_string()),
            ..self
        }
    }

    pub(crate) fn suggest(self, suggestion: Option<impl Into<String>>) -> Self {
        Self {
            suggestion: suggestion.map(Into::into),
            ..self
        }
    }

    pub(crate) fn help(self, help: impl Into<String>) -> Self {
        Self {
            help: Some(help.into()),
            ..self
        }
    }

    pub(crate) fn doubtful(self) -> Self {
        Self {
            doubtful: true,
            ..self
        }
    }
}

/// Everything that is wrong with one file, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problems {
    origin: String,
    text: String,
    list: Vec<Problem>,
    input_output: bool,
}

/// No more problems than this are written out; the rest are counted.
const SHOWN: usize = 50;
/// Longer lines are cut around the place at fault.
const LINE_SHOWN: usize = 160;

impl Problems {
    /// Locates `list` in `text`, drops repetitions and sorts by place.
    pub(crate) fn new(origin: &str, text: &str, mut list: Vec<Problem>) -> Self {
        list.sort_by_key(|problem| problem.span.start);
        let mut kept: Vec<Problem> = Vec::with_capacity(list.len());
        let (mut line, mut line_start, mut seen) = (1, 0, 0);
        for mut problem in list {
            let start = floor_boundary(text, problem.span.start);
            let end = ceil_boundary(text, problem.span.end.max(start));
            problem.span = start..end;
            if kept
                .iter()
                .rev()
                .take_while(|other| other.span.start == start)
                .any(|other| other.span == problem.span && other.message == problem.message)
            {
                continue;
            }
            for (at, _) in text[seen..start].match_indices('\n') {
                line += 1;
                line_start = seen + at + 1;
            }
            seen = start;
            problem.line = line;
            problem.column = text[line_start..start].chars().count() + 1;
            let marked = text[start..end].lines().next().unwrap_or("");
            problem.end = problem.column + marked.chars().count().max(1);
            kept.push(problem);
        }
        Self {
            origin: origin.to_owned(),
            text: text.to_owned(),
            list: kept,
            input_output: false,
        }
    }

    /// The file itself could not be had.
    pub(crate) fn unreadable(origin: &str, message: impl Into<String>) -> Self {
        Self {
            origin: origin.to_owned(),
            text: String::new(),
            list: vec![Problem::at(0..0, message)],
            input_output: true,
        }
    }

    /// The file was had, but is not a text that could be read.
    pub(crate) fn whole(origin: &str, message: impl Into<String>) -> Self {
        Self {
            input_output: false,
            ..Self::unreadable(origin, message)
        }
    }

    /// The problems in the order of the file.
    pub fn list(&self) -> &[Problem] {
        &self.list
    }

    /// Where the text came from, as it was given.
    pub fn origin(&self) -> &str {
        &self.origin
    }

    /// Whether the file could not be read at all, as opposed to being wrong.
    pub fn is_input_output(&self) -> bool {
        self.input_output
    }

    /// All problems as text: each begins with `ORIGIN:LINE:COLUMN: error:` and shows the line with the place marked.
    pub fn render(&self, colour: bool) -> String {
        let renderer = if colour {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        let mut out = String::new();
        for problem in self.list.iter().take(SHOWN) {
            self.one(problem, &renderer, &mut out);
        }
        if self.list.len() > SHOWN {
            let _ = writeln!(out, "and {} more", self.list.len() - SHOWN);
        }
        out
    }

    fn one(&self, problem: &Problem, renderer: &Renderer, out: &mut String) {
        let origin = printable(&self.origin);
        let name = if problem.line == 0 {
            format!("{origin}: error")
        } else {
            format!("{origin}:{}:{}: error", problem.line, problem.column)
        };
        let (line, span) = self.excerpt(problem);
        let mut group = Level::ERROR
            .with_name(name)
            .primary_title(problem.message.as_str())
            .elements([] as [annotate_snippets::Message<'_>; 0]);
        if problem.line > 0 {
            group = group.element(
                Snippet::source(line)
                    .line_start(problem.line)
                    .fold(false)
                    .annotation(AnnotationKind::Primary.span(span)),
            );
        }
        if let Some(suggestion) = &problem.suggestion {
            group = group
                .element(Level::HELP.message(format!("did you mean `{}`?", printable(suggestion))));
        }
        if let Some(help) = &problem.help {
            group = group.element(Level::HELP.message(help.as_str()));
        }
        if let Some(allowed) = &problem.allowed
            && !problem.message.contains(allowed.as_str())
        {
            group = group.element(Level::NOTE.message(format!("allowed: {allowed}")));
        }
        let _ = writeln!(out, "{}", renderer.render(&[group]));
    }

    /// The line at fault, cut where it is long, and the place in it.
    fn excerpt(&self, problem: &Problem) -> (String, Span) {
        let start = self.text[..problem.span.start]
            .rfind('\n')
            .map_or(0, |at| at + 1);
        let end = self.text[problem.span.start..]
            .find('\n')
            .map_or(self.text.len(), |at| problem.span.start + at);
        let end = if self.text[start..end].ends_with('\r') {
            end - 1
        } else {
            end
        };
        let mut first = start;
        let mut last = end;
        if end - start > LINE_SHOWN {
            first = floor_boundary(
                &self.text,
                problem.span.start.saturating_sub(LINE_SHOWN / 2).max(start),
            );
            last = ceil_boundary(&self.text, (first + LINE_SHOWN).min(end));
        }
        let from = problem.span.start.clamp(first, last);
        let to = problem.span.end.clamp(from, last);
        let mut line = String::new();
        if first > start {
            line.push_str("... ");
        }
        let shift = line.len();
        line.push_str(&self.text[first..last]);
        let marks = shift + from - first..shift + to - first;
        if last < end {
            line.push_str(" ...");
        }
        (line, marks)
    }
}

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for Problems {}

fn floor_boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

fn ceil_boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at += 1;
    }
    at
}

/// `text` without control characters and not too long, for messages.
pub(crate) fn printable(text: &str) -> String {
    const MOST: usize = 80;
    let mut out: String = text
        .chars()
        .take(MOST)
        .flat_map(|c| {
            let hidden = is_hidden(c);
            let escaped = hidden.then(|| c.escape_unicode());
            let plain = (!hidden).then_some(c);
            escaped.into_iter().flatten().chain(plain)
        })
        .collect();
    if text.chars().nth(MOST).is_some() {
        out.push_str("...");
    }
    out
}

/// Control characters, and those that turn the direction of writing or have no width.
pub(crate) fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}')
}
