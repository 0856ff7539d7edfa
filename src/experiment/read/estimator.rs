//! `[[estimator]]`: one key of the catalogue, perhaps a name, perhaps a sweep.

use super::node::{Entry, Reader, Table};
use super::problem::{Problem, Span, printable};
use super::sweep;
use super::value::{self, Located};
use crate::experiment::catalogue::{self, ESTIMATORS};
use crate::experiment::{EstimatorSpec, SweepMember, significant};
use crate::parameter::{Parameter, Value, Values, listed, nearest};

/// One `[[estimator]]` as read.
pub(super) struct Group {
    /// The name given or made.
    pub(super) name: String,
    /// Where the name stands, or the table.
    pub(super) name_span: Span,
    /// Whether there is a sweep.
    pub(super) swept: bool,
    /// The estimators: one, or one for each member of the sweep; empty if something is wrong.
    pub(super) members: Vec<EstimatorSpec>,
    /// Where the settings stand.
    pub(super) located: Located,
    /// Where the settings of each member of the sweep stand.
    pub(super) places: Vec<Span>,
}

/// Keys of the experiment's top level: found in an `[[estimator]]` they were meant to stand above it.
const ABOVE: &[&str] = &[
    "question",
    "notes",
    "seed",
    "source",
    "draws",
    "replicates",
    "grid",
];

/// The name that an `[[estimator]]` gives.
#[derive(Default)]
pub(super) enum Given {
    /// None: it will be made.
    #[default]
    Nothing,
    /// This one, standing here.
    Name(String, Span),
    /// One that is wrong or misspelt: what it should be is not known.
    Faulty,
}

/// Reads one table; the name it gives is known even if the rest is wrong.
pub(super) fn group(reader: &mut Reader, table: Table<'_>) -> (Given, Option<Group>) {
    let mut name = Given::Nothing;
    let group = inner(reader, table, &mut name);
    (name, group)
}

fn inner(reader: &mut Reader, mut table: Table<'_>, given: &mut Given) -> Option<Group> {
    let name_entry = table.take("name");
    let mut name_span = table.span.clone();
    let name = name_entry.and_then(|entry| {
        name_span = entry.item.span();
        reader.name(entry.item, "the name of an estimator")
    });
    *given = match (&name, name_entry) {
        (Some(name), _) => Given::Name(name.clone(), name_span.clone()),
        (None, Some(_)) => Given::Faulty,
        (None, None) => Given::Nothing,
    };
    let span = table.span.clone();
    let kinds: Vec<Entry<'_>> = ESTIMATORS
        .iter()
        .filter_map(|entry| table.take(entry.name))
        .collect();
    let names: Vec<&str> = ESTIMATORS.iter().map(|entry| entry.name).collect();
    let allowed: Vec<&str> = std::iter::once("name")
        .chain(names.iter().copied())
        .collect();
    let misspelt = |entry: &Entry<'_>| nearest(entry.key(), ["name"]).is_some();
    if name_entry.is_none() && table.left().iter().any(misspelt) {
        *given = Given::Faulty;
    }
    let unknown = table.finish_with(reader, &allowed, |key| {
        if ABOVE.contains(&key) {
            return Some(format!(
                "`{key}` belongs to the experiment: move the line above the first [[..]]"
            ));
        }
        let owner = ESTIMATORS
            .iter()
            .find(|entry| entry.parameters.iter().any(|p| p.name == key))?;
        Some(format!(
            "settings stand in the estimator's own table: {} = {{ {key} = .. }}",
            owner.name
        ))
    });
    let entry = match kinds[..] {
        [entry] => entry,
        [] => {
            if !unknown {
                reader.report(
                    Problem::at(span, "this estimator has no kind")
                        .allowed(listed(&names))
                        .help("for instance: kernel = { bandwidth = 0.3 }")
                        .doubtful(),
                );
            }
            return None;
        }
        [first, second, ..] => {
            let (a, b) = if first.key_span().start < second.key_span().start {
                (first, second)
            } else {
                (second, first)
            };
            reader.report(
                Problem::at(
                    b.key_span(),
                    format!("this estimator is a `{}` already", a.key()),
                )
                .help(format!("give `{}` an [[estimator]] of its own", b.key())),
            );
            return None;
        }
    };
    settings(reader, entry, name, name_span).map(|mut group| {
        if unknown {
            group.members.clear();
        }
        group
    })
}

/// Reads `KIND = { settings }`.
pub(super) fn settings(
    reader: &mut Reader,
    entry: Entry<'_>,
    name: Option<String>,
    name_span: Span,
) -> Option<Group> {
    let kind = catalogue::estimator(entry.key())?;
    let mut table = reader.table(entry.item, &format!("`{}`", kind.name))?;
    // Where the whole table is one line of its own, its key says more than its brace.
    table.span = entry.key_span();
    let mut swept: Option<(&'static Parameter, Entry<'_>)> = None;
    let mut second = false;
    let mut entries = Vec::new();
    for parameter in kind.parameters {
        let given = table.take(parameter.name);
        match given {
            Some(given) if sweep::is_sweep(parameter, given.item) => {
                if let Some((other, _)) = swept {
                    second = true;
                    reader.report(
                        Problem::at(
                            given.item.span(),
                            format!("one sweep an estimator: `{}` is swept already", other.name),
                        )
                        .help("write several [[estimator]] tables"),
                    );
                } else {
                    swept = Some((parameter, given));
                }
            }
            other => entries.push((parameter, other)),
        }
    }
    if let Some((parameter, _)) = swept {
        // Not missing: its values are read below.
        entries.retain(|(other, _)| other.name != parameter.name);
    }
    let located = value::located(
        reader,
        kind.parameters,
        entries,
        table,
        &format!("`{}`", kind.name),
    );
    let name = name.unwrap_or_else(|| {
        made_name(kind.name, kind.parameters, &located.values, |parameter| {
            located.given(parameter)
        })
    });
    let (members, places) = match swept {
        Some((parameter, given)) => {
            let values = sweep::values(reader, parameter, given.item).unwrap_or_default();
            let places = values.iter().map(|(_, span)| span.clone()).collect();
            (
                expand(&name, kind.name, parameter, &located.values, &values),
                places,
            )
        }
        None => (
            vec![EstimatorSpec {
                name: name.clone(),
                kind: kind.name.to_owned(),
                values: located.values.clone(),
                sweep: None,
            }],
            Vec::new(),
        ),
    };
    let sound = located.complete && !second;
    Some(Group {
        name,
        name_span,
        swept: swept.is_some(),
        members: if sound { members } else { Vec::new() },
        located,
        places,
    })
}

/// The members of a sweep, named by as few digits as keep them apart, four at least.
fn expand(
    group: &str,
    kind: &str,
    parameter: &'static Parameter,
    values: &Values,
    swept: &[(Value, Span)],
) -> Vec<EstimatorSpec> {
    let labels = (4..=17)
        .map(|digits| {
            swept
                .iter()
                .map(|(value, _)| short(value, digits))
                .collect::<Vec<_>>()
        })
        .find(|labels| {
            let mut distinct = labels.clone();
            distinct.sort_unstable();
            distinct.dedup();
            distinct.len() == labels.len()
        })
        .unwrap_or_default();
    swept
        .iter()
        .zip(labels)
        .map(|((value, _), label)| {
            let mut values = values.clone();
            values.set(parameter.name, value.clone());
            EstimatorSpec {
                name: format!("{group}, {} = {label}", symbol(parameter.name)),
                kind: kind.to_owned(),
                values,
                sweep: Some(SweepMember {
                    group: group.to_owned(),
                    parameter: parameter.name.to_owned(),
                    value: match value {
                        Value::Count(x) => *x as f64,
                        Value::Number(x) => *x,
                        _ => f64::NAN,
                    },
                }),
            }
        })
        .collect()
}

fn short(value: &Value, digits: usize) -> String {
    match value {
        Value::Number(x) => significant(*x, digits),
        Value::Count(x) => x.to_string(),
        Value::Word(word) => word.clone(),
        Value::Flag(flag) => flag.to_string(),
        Value::Words(words) => words.join(" "),
        Value::Rows(rows) => format!("{} rows", rows.len()),
    }
}

/// How a parameter is called in a name: textbooks write h for the bandwidth.
fn symbol(parameter: &str) -> &str {
    if parameter == "bandwidth" {
        "h"
    } else {
        parameter
    }
}

/// A name that says the kind and what was set: "kernel, gaussian, h = 0.3".
fn made_name(
    kind: &str,
    parameters: &[Parameter],
    values: &Values,
    given: impl Fn(&str) -> bool,
) -> String {
    let mut name = kind.to_owned();
    for parameter in parameters {
        let Some(value) = values.get(parameter.name).filter(|_| given(parameter.name)) else {
            continue;
        };
        name.push_str(", ");
        match value {
            Value::Word(word) => name.push_str(&printable(word)),
            Value::Flag(true) => name.push_str(parameter.name),
            Value::Flag(false) => {
                name.push_str("no ");
                name.push_str(parameter.name);
            }
            other => {
                name.push_str(symbol(parameter.name));
                name.push_str(" = ");
                name.push_str(&short(other, 6));
            }
        }
    }
    name
}
