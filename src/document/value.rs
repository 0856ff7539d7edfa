//! Values as their declarations say.

use super::node::{Entry, Item, Number, Reader, Table, found};
use super::problem::{Problem, Span, printable};
use crate::parameter::{Absent, Kind, Parameter, Value, Values, listed, nearest};
use std::collections::BTreeMap;
use toml::de::DeValue;

/// Checked values and where they stand.
pub(crate) struct Located {
    pub(crate) values: Values,
    /// Where each given value stands; parameters left to their defaults are absent.
    pub(crate) spans: BTreeMap<&'static str, Span>,
    /// Where the whole table stands.
    pub(crate) span: Span,
    /// Whether all is well; if not, what is wrong has been reported.
    pub(crate) complete: bool,
}

impl Located {
    /// Where a parameter stands, or the table where it was not given.
    pub(crate) fn place(&self, name: &str) -> Span {
        self.spans.get(name).unwrap_or(&self.span).clone()
    }

    /// Whether the file gives the parameter.
    pub(crate) fn given(&self, name: &str) -> bool {
        self.spans.contains_key(name)
    }
}

/// Reads the whole table as `parameters` declare.
pub(crate) fn values(
    reader: &mut Reader,
    parameters: &'static [Parameter],
    mut table: Table<'_>,
    what: &str,
) -> Located {
    let entries: Vec<_> = parameters
        .iter()
        .map(|parameter| (parameter, table.take(parameter.name)))
        .collect();
    located(reader, parameters, entries, table, what)
}

/// The same for entries already taken from the table.
pub(crate) fn located(
    reader: &mut Reader,
    parameters: &'static [Parameter],
    entries: Vec<(&'static Parameter, Option<Entry<'_>>)>,
    table: Table<'_>,
    what: &str,
) -> Located {
    let mut read = Located {
        values: Values::defaults(parameters),
        spans: BTreeMap::new(),
        span: table.span.clone(),
        complete: true,
    };
    let mut missing = Vec::new();
    for (parameter, entry) in entries {
        match entry {
            Some(entry) => {
                read.spans.insert(parameter.name, entry.item.span());
                match value(reader, parameter, entry.item) {
                    Some(value) => read.values.set(parameter.name, value),
                    None => read.complete = false,
                }
            }
            None if parameter.absent == Absent::Required => missing.push(parameter),
            None => {}
        }
    }
    let allowed: Vec<&str> = parameters.iter().map(|p| p.name).collect();
    let misspelt: Vec<&str> = table
        .left()
        .iter()
        .filter_map(|entry| nearest(entry.key(), allowed.iter().copied()))
        .collect();
    let unknown = table.finish(reader, &allowed);
    for parameter in missing {
        read.complete = false;
        // A misspelt key is reported as such and need not be missed as well.
        if !misspelt.contains(&parameter.name) {
            reader.report(
                Problem::at(
                    read.span.clone(),
                    format!("{what} needs `{}`: {}", parameter.name, parameter.help),
                )
                .allowed(parameter.kind)
                .doubtful(),
            );
        }
    }
    read.complete &= !unknown;
    read
}

/// One value of a parameter.
pub(crate) fn value(reader: &mut Reader, parameter: &Parameter, item: &Item<'_>) -> Option<Value> {
    let what = format!("`{}`", parameter.name);
    match parameter.kind {
        Kind::Real => reader.real(item, &what).map(Value::Number),
        Kind::Positive => positive(reader, item, &what, parameter.kind).map(Value::Number),
        Kind::Fraction => within(reader, item, &what, parameter.kind, |x| {
            (0.0..=1.0).contains(&x)
        }),
        Kind::Between(low, high) => {
            within(reader, item, &what, parameter.kind, |x| low < x && x < high)
        }
        Kind::Range(least, most) => within(reader, item, &what, parameter.kind, |x| {
            (least..=most).contains(&x)
        }),
        Kind::Count { least, most } => reader.count(item, &what, least, most).map(Value::Count),
        Kind::Choice(words) => word(reader, item, &what, words).map(Value::Word),
        Kind::Choices(words) => {
            let DeValue::Array(list) = item.get_ref() else {
                reader.wrong_type(item, &what, &parameter.kind.to_string());
                return None;
            };
            let read: Vec<_> = list
                .iter()
                .map(|item| word(reader, item, &format!("each of {what}"), words))
                .collect();
            read.into_iter().collect::<Option<_>>().map(Value::Words)
        }
        Kind::Text => reader
            .text(item, &what)
            .map(|text| Value::Word(text.to_owned())),
        Kind::Texts => {
            let read = texts(reader, item, &what)?;
            Some(Value::Words(
                read.into_iter().map(|(text, _)| text).collect(),
            ))
        }
        Kind::Flag => {
            let flag = item.get_ref().as_bool();
            if flag.is_none() {
                reader.wrong_type(item, &what, "true or false");
            }
            flag.map(Value::Flag)
        }
        Kind::PositiveOr(words) | Kind::CountOr { words, .. } => {
            let DeValue::String(text) = item.get_ref() else {
                return match parameter.kind {
                    Kind::CountOr { least, most, .. } => {
                        reader.count(item, &what, least, most).map(Value::Count)
                    }
                    _ => positive(reader, item, &what, parameter.kind).map(Value::Number),
                };
            };
            if words.contains(&text.as_ref()) {
                return Some(Value::Word(text.to_string()));
            }
            reader.report(
                Problem::at(
                    item.span(),
                    format!("{what} cannot be \"{}\"", printable(text)),
                )
                .suggest(nearest(text, words.iter().copied()))
                .allowed(parameter.kind),
            );
            None
        }
        Kind::Rows(parameters) => rows(reader, parameters, item, &what),
    }
}

/// A text or a list of at least one text, each with its place.
pub(crate) fn texts(
    reader: &mut Reader,
    item: &Item<'_>,
    what: &str,
) -> Option<Vec<(String, Span)>> {
    match item.get_ref() {
        DeValue::Array(list) if list.is_empty() => {
            reader.report(
                Problem::at(item.span(), format!("{what} is an empty list"))
                    .allowed("at least one text"),
            );
            None
        }
        DeValue::Array(list) => list
            .iter()
            .map(|item| {
                let text = reader.text(item, &format!("each of {what}"))?;
                Some((text.to_owned(), item.span()))
            })
            .collect::<Vec<_>>()
            .into_iter()
            .collect(),
        DeValue::String(text) => Some(vec![(text.to_string(), item.span())]),
        _ => {
            reader.wrong_type(item, what, &Kind::Texts.to_string());
            None
        }
    }
}

fn rows(
    reader: &mut Reader,
    parameters: &'static [Parameter],
    item: &Item<'_>,
    what: &str,
) -> Option<Value> {
    let DeValue::Array(list) = item.get_ref() else {
        reader.wrong_type(item, what, &Kind::Rows(parameters).to_string());
        return None;
    };
    if list.is_empty() {
        reader.report(
            Problem::at(item.span(), format!("{what} is an empty list"))
                .allowed(Kind::Rows(parameters)),
        );
        return None;
    }
    let each = format!("each of {what}");
    let read: Vec<_> = list
        .iter()
        .map(|item| {
            let table = reader.table(item, &each)?;
            let read = values(reader, parameters, table, &each);
            read.complete.then_some(read.values)
        })
        .collect();
    read.into_iter().collect::<Option<_>>().map(Value::Rows)
}

fn word(reader: &mut Reader, item: &Item<'_>, what: &str, words: &[&str]) -> Option<String> {
    let DeValue::String(text) = item.get_ref() else {
        reader.wrong_type(item, what, &format!("one of {}", listed(words)));
        return None;
    };
    if words.contains(&text.as_ref()) {
        return Some(text.to_string());
    }
    reader.report(
        Problem::at(
            item.span(),
            format!("{what} cannot be \"{}\"", printable(text)),
        )
        .suggest(nearest(text, words.iter().copied()))
        .allowed(listed(words)),
    );
    None
}

/// A number above 0 whose reciprocal is still a number: the estimators divide by it.
fn positive(reader: &mut Reader, item: &Item<'_>, what: &str, kind: Kind) -> Option<f64> {
    let expected = kind.to_string();
    let number = reader.number(item, what, &expected)?;
    let x = number.real();
    if x.is_finite() && x > 0.0 && x.recip().is_finite() {
        return Some(x);
    }
    let found = if x > 0.0 && x.is_finite() {
        format!("{x:e}, which is too small to divide by")
    } else {
        shown(number, item)
    };
    reader.report(
        Problem::at(
            item.span(),
            format!("{what} must be {expected}, not {found}"),
        )
        .allowed(expected),
    );
    None
}

fn within(
    reader: &mut Reader,
    item: &Item<'_>,
    what: &str,
    kind: Kind,
    holds: impl Fn(f64) -> bool,
) -> Option<Value> {
    let expected = kind.to_string();
    let number = reader.number(item, what, &expected)?;
    if holds(number.real()) {
        return Some(Value::Number(number.real()));
    }
    reader.report(
        Problem::at(
            item.span(),
            format!("{what} must be {expected}, not {}", shown(number, item)),
        )
        .allowed(expected),
    );
    None
}

fn shown(number: Number, item: &Item<'_>) -> String {
    match number {
        Number::Real(x) if !x.is_finite() => x.to_string(),
        _ => found(item)
            .trim_start_matches("the integer ")
            .trim_start_matches("the decimal number ")
            .to_owned(),
    }
}
