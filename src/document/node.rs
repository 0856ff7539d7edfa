//! Walking a parsed document: tables that know which of their keys were asked for, and values of the expected type.

use super::problem::{Problem, Span, printable};

use crate::parameter::{listed, nearest};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Gathers what is wrong while reading goes on.
#[derive(Default)]
pub(crate) struct Reader {
    pub(crate) problems: Vec<Problem>,
}

/// A value of the document.
pub(crate) type Item<'d> = Spanned<DeValue<'d>>;

/// A key with its value.
#[derive(Clone, Copy)]
pub(crate) struct Entry<'d> {
    key: &'d Spanned<std::borrow::Cow<'d, str>>,
    pub(crate) item: &'d Item<'d>,
}

impl<'d> Entry<'d> {
    pub(crate) fn key(&self) -> &'d str {
        self.key.get_ref()
    }

    pub(crate) fn key_span(&self) -> Span {
        self.key.span()
    }
}

/// A table being read: each key is taken once, and what is left over is unknown.
pub(crate) struct Table<'d> {
    /// Where to point when something is missing.
    pub(crate) span: Span,
    /// What the table describes, for messages: "an estimator".
    what: String,
    left: Vec<Entry<'d>>,
}

impl<'d> Table<'d> {
    pub(crate) fn new(table: &'d DeTable<'d>, span: Span, what: impl Into<String>) -> Self {
        let mut left: Vec<Entry<'d>> = table
            .iter()
            .map(|(key, item)| Entry { key, item })
            .collect();
        left.sort_by_key(|entry| entry.key_span().start);
        Self {
            span,
            what: what.into(),
            left,
        }
    }

    /// The entry of that key, which is then known.
    pub(crate) fn take(&mut self, key: &str) -> Option<Entry<'d>> {
        let at = self.left.iter().position(|entry| entry.key() == key)?;
        Some(self.left.remove(at))
    }

    /// The same, reporting if it is missing.
    pub(crate) fn need(
        &mut self,
        reader: &mut Reader,
        key: &str,
        help: impl Into<String>,
    ) -> Option<Entry<'d>> {
        let found = self.take(key);
        // A misspelt key is reported as such and need not be missed as well.
        let misspelt = || {
            self.left
                .iter()
                .any(|entry| nearest(entry.key(), [key]).is_some())
        };
        if found.is_none() && !misspelt() {
            reader.report(
                Problem::at(self.span.clone(), format!("{} needs `{key}`", self.what))
                    .help(help)
                    .doubtful(),
            );
        }
        found
    }

    /// The keys not taken yet.
    pub(crate) fn left(&self) -> &[Entry<'d>] {
        &self.left
    }

    /// Reports the keys left over; says whether there were any.
    pub(crate) fn finish(self, reader: &mut Reader, allowed: &[&str]) -> bool {
        self.finish_with(reader, allowed, |_| None)
    }

    /// The same, with advice for some keys.
    pub(crate) fn finish_with(
        self,
        reader: &mut Reader,
        allowed: &[&str],
        advice: impl Fn(&str) -> Option<String>,
    ) -> bool {
        for entry in &self.left {
            let mut problem = Problem::at(
                entry.key_span(),
                format!("{} has no key `{}`", self.what, printable(entry.key())),
            )
            .allowed(listed(allowed));
            if let Some(advice) = advice(entry.key()) {
                problem = problem.help(advice);
            } else {
                problem = problem.suggest(nearest(entry.key(), allowed.iter().copied()));
            }
            reader.report(problem);
        }
        !self.left.is_empty()
    }
}

/// A number as it was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Number {
    Whole(i128),
    Real(f64),
}

impl Number {
    pub(crate) fn real(self) -> f64 {
        match self {
            Self::Whole(x) => x as f64,
            Self::Real(x) => x,
        }
    }
}

impl Reader {
    pub(crate) fn report(&mut self, problem: Problem) {
        self.problems.push(problem);
    }

    /// Reports a value of the wrong type.
    pub(crate) fn wrong_type(&mut self, item: &Item<'_>, what: &str, expected: &str) {
        self.report(
            Problem::at(
                item.span(),
                format!("{what} must be {expected}, not {}", found(item)),
            )
            .allowed(expected),
        );
    }

    pub(crate) fn text<'d>(&mut self, item: &'d Item<'d>, what: &str) -> Option<&'d str> {
        let text = item.get_ref().as_str();
        if text.is_none() {
            self.wrong_type(item, what, "a text in quotes");
        }
        text
    }

    pub(crate) fn table<'d>(&mut self, item: &'d Item<'d>, what: &str) -> Option<Table<'d>> {
        if let DeValue::Table(table) = item.get_ref() {
            return Some(Table::new(table, item.span(), what));
        }
        self.wrong_type(item, what, "a table { .. }");
        None
    }

    /// The tables of `[[key]]`, or of a list of inline tables.
    pub(crate) fn tables<'d>(&mut self, entry: Entry<'d>, what: &str) -> Vec<Table<'d>> {
        let DeValue::Array(array) = entry.item.get_ref() else {
            let key = entry.key();
            self.report(
                Problem::at(
                    entry.item.span(),
                    format!(
                        "`{key}` must be a list of tables, not {}",
                        found(entry.item)
                    ),
                )
                .help(format!("begin each with a line [[{key}]]")),
            );
            return Vec::new();
        };
        array
            .iter()
            .filter_map(|item| self.table(item, what))
            .collect()
    }

    /// A number of any size that the file may hold; `None` and a report if it is none.
    pub(crate) fn number(&mut self, item: &Item<'_>, what: &str, expected: &str) -> Option<Number> {
        match item.get_ref() {
            DeValue::Integer(integer) => {
                if let Ok(x) = i128::from_str_radix(integer.as_str(), integer.radix()) {
                    return Some(Number::Whole(x));
                }
                self.report(
                    Problem::at(
                        item.span(),
                        format!("{what} must be {expected}, not an integer this large"),
                    )
                    .allowed(expected),
                );
                None
            }
            DeValue::Float(float) => {
                let x: f64 = float.as_str().parse().ok()?;
                if x.is_infinite() && !float.as_str().contains("inf") {
                    self.report(
                        Problem::at(
                            item.span(),
                            format!(
                                "{} is larger than any number here: {what} must be {expected}",
                                printable(float.as_str())
                            ),
                        )
                        .allowed(expected),
                    );
                    return None;
                }
                Some(Number::Real(x))
            }
            _ => {
                self.wrong_type(item, what, expected);
                None
            }
        }
    }

    /// A whole number from `least` to `most`.
    pub(crate) fn count(
        &mut self,
        item: &Item<'_>,
        what: &str,
        least: u64,
        most: u64,
    ) -> Option<u64> {
        let expected = format!("a whole number from {least} to {most}");
        match self.number(item, what, &expected)? {
            Number::Whole(x) if x >= i128::from(least) && x <= i128::from(most) => Some(x as u64),
            Number::Whole(x) => {
                self.report(
                    Problem::at(item.span(), format!("{what} must be {expected}, not {x}"))
                        .allowed(expected),
                );
                None
            }
            Number::Real(x) => {
                let mut problem = Problem::at(
                    item.span(),
                    format!("{what} must be {expected}, not {}", found(item)),
                )
                .allowed(&expected);
                if x.fract() == 0.0 && x >= least as f64 && x <= most as f64 {
                    problem = problem.suggest(Some(format!("{}", x as u64)));
                }
                self.report(problem);
                None
            }
        }
    }

    /// A finite number.
    pub(crate) fn real(&mut self, item: &Item<'_>, what: &str) -> Option<f64> {
        let x = self.number(item, what, "a finite number")?.real();
        if x.is_finite() {
            return Some(x);
        }
        self.report(
            Problem::at(
                item.span(),
                format!("{what} must be a finite number, not {x}"),
            )
            .allowed("a finite number"),
        );
        None
    }

    /// A short text that is used as a name in tables, legends and claims.
    pub(crate) fn name(&mut self, item: &Item<'_>, what: &str) -> Option<String> {
        const MOST: usize = 80;
        let text = self.text(item, what)?;
        let fault = if text.trim().is_empty() {
            Some("is empty".to_owned())
        } else if text.trim() != text {
            Some("begins or ends with a space".to_owned())
        } else if text.chars().any(super::problem::is_hidden) {
            Some("holds a control character".to_owned())
        } else if text.chars().count() > MOST {
            Some(format!("has {} characters", text.chars().count()))
        } else {
            None
        };
        if let Some(fault) = fault {
            self.report(
                Problem::at(item.span(), format!("{what} {fault}")).allowed(format!(
                    "1 to {MOST} printable characters, no space at the ends"
                )),
            );
            return None;
        }
        Some(text.to_owned())
    }
}

/// What a value is, with the value where it is short.
pub(crate) fn found(item: &Item<'_>) -> String {
    match item.get_ref() {
        DeValue::String(text) => format!("the text \"{}\"", printable(text)),
        DeValue::Integer(x) => format!("the integer {}", printable(&x.to_string())),
        DeValue::Float(x) => format!("the decimal number {}", printable(x.as_str())),
        DeValue::Boolean(x) => format!("{x}"),
        DeValue::Datetime(_) => "a date or time".to_owned(),
        DeValue::Array(list) if list.is_empty() => "an empty list".to_owned(),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

impl Reader {
    /// A text of one paragraph, not empty.
    pub(crate) fn words(&mut self, item: &Item<'_>, what: &str, most: usize) -> Option<String> {
        let text = self.prose(item, what, most)?;
        if text.is_empty() {
            self.report(Problem::at(item.span(), format!("{what} is empty")));
            return None;
        }
        Some(text.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    /// A text of any number of paragraphs, perhaps empty.
    pub(crate) fn prose(&mut self, item: &Item<'_>, what: &str, most: usize) -> Option<String> {
        let text = self.text(item, what)?;
        let length = text.chars().count();
        if length > most {
            self.report(
                Problem::at(item.span(), format!("{what} has {length} characters"))
                    .allowed(format!("at most {most}")),
            );
            return None;
        }
        let hidden = |c: char| super::problem::is_hidden(c) && !matches!(c, '\n' | '\r' | '\t');
        if text.chars().any(hidden) {
            self.report(Problem::at(
                item.span(),
                format!("{what} holds a control character"),
            ));
            return None;
        }
        Some(text.trim().replace("\r\n", "\n"))
    }
}
