//! `[[claim]]`.

use super::form::{ANY, BEST, COMMON, Form, MODES, ORACLE};
use super::node::{Entry, Reader, Table};
use super::problem::{Problem, Span};
use super::setting::Setting;
use super::value::{self, Located};
use crate::experiment::{Claim, Measure, Statement};
use crate::parameter::{Parameter, listed};

/// Reads one `[[claim]]`.
pub(super) fn claim(
    reader: &mut Reader,
    mut table: Table<'_>,
    setting: &Setting<'_>,
    line: usize,
) -> Option<Claim> {
    let span = table.span.clone();
    let says = table.take("says");
    let says = says.map(|entry| reader.words(entry.item, "`says`", 1000));
    let draws = table.take("draws");
    let draws = draws.map(|entry| setting.draws(reader, entry.item));
    let source = table.take("source");
    let source = source.map(|entry| setting.source(reader, entry.item));
    let entry = key(reader, table, &span)?;
    let statement = match entry.key() {
        "best" => best(reader, entry, setting),
        "oracle" => oracle(reader, entry, setting),
        name => {
            let measure = Measure::ALL
                .into_iter()
                .find(|measure| measure.name() == name)?;
            measured(reader, entry, measure, setting)
        }
    }?;
    let says = match says {
        Some(says) => says?,
        None => statement.to_string(),
    };
    Some(Claim {
        says,
        draws: match draws {
            Some(draws) => Some(draws?),
            None => None,
        },
        source: match source {
            Some(source) => Some(source?),
            None => None,
        },
        statement,
        line,
    })
}

/// The names of all statements.
pub(crate) fn statements() -> Vec<&'static str> {
    Measure::ALL
        .into_iter()
        .map(Measure::name)
        .chain(["best", "oracle"])
        .collect()
}

/// The one key that says what is claimed.
fn key<'d>(reader: &mut Reader, mut table: Table<'d>, span: &Span) -> Option<Entry<'d>> {
    let kinds = statements();
    let mut given: Vec<Entry<'d>> = kinds.iter().filter_map(|name| table.take(name)).collect();
    given.sort_by_key(|entry| entry.key_span().start);
    let allowed: Vec<&str> = COMMON
        .iter()
        .map(|parameter| parameter.name)
        .chain(kinds.iter().copied())
        .collect();
    let unknown = table.finish(reader, &allowed);
    match given[..] {
        [one] => Some(one),
        [] => {
            if !unknown {
                reader.report(
                    Problem::at(span.clone(), "this claim states nothing")
                        .allowed(listed(&kinds))
                        .help("for instance: mise = { of = \"A\", below = \"B\", by = 2.0 }")
                        .doubtful(),
                );
            }
            None
        }
        [first, second, ..] => {
            reader.report(
                Problem::at(
                    second.key_span(),
                    format!("this claim is about `{}` already", first.key()),
                )
                .help(format!("give `{}` a [[claim]] of its own", second.key())),
            );
            None
        }
    }
}

fn settings(
    reader: &mut Reader,
    entry: Entry<'_>,
    parameters: &'static [Parameter],
) -> Option<Located> {
    let what = format!("`{}`", entry.key());
    let mut table = reader.table(entry.item, &what)?;
    table.span = entry.key_span();
    let located = value::values(reader, parameters, table, &what);
    located.complete.then_some(located)
}

fn best(reader: &mut Reader, entry: Entry<'_>, setting: &Setting<'_>) -> Option<Statement> {
    let demanded = setting.demand(reader, &entry.key_span(), "the claim `best`", true, true);
    let read = settings(reader, entry, BEST)?;
    let of = read.values.word("of")?;
    let known = setting.names.sweep(reader, of, &read.place("of"));
    (known && demanded).then_some(Statement::BestIsNear {
        of: of.to_owned(),
        within: read.values.number("within")?,
    })
}

fn oracle(reader: &mut Reader, entry: Entry<'_>, setting: &Setting<'_>) -> Option<Statement> {
    let demanded = setting.demand(reader, &entry.key_span(), "the claim `oracle`", true, false);
    let read = settings(reader, entry, ORACLE)?;
    demanded.then_some(Statement::Oracle {
        quantity: read.values.word("quantity")?.to_owned(),
        kernel: read.values.word("kernel")?.to_owned(),
        equals: read.values.number("equals")?,
        digits: read.values.count("digits")? as u32,
    })
}

/// `MEASURE = { .. }` in any of its forms.
fn measured(
    reader: &mut Reader,
    entry: Entry<'_>,
    measure: Measure,
    setting: &Setting<'_>,
) -> Option<Statement> {
    let form = form(reader, entry, measure)?;
    let exact = matches!(
        measure,
        Measure::ExactMise | Measure::ExactBias2 | Measure::ExactVariance
    );
    // A data file is one sample: what is measured on it is a plain number without an interval.
    let replicated = !exact && setting.truth != Some(false);
    let demanded = setting.demand(
        reader,
        &entry.key_span(),
        &format!("a claim about `{}`", measure.name()),
        measure.needs_truth(),
        replicated,
    );
    let read = settings(reader, entry, form.parameters)?;
    let values = &read.values;
    let confidence = values.number("confidence").unwrap_or(0.99);
    let of = values.word("of").unwrap_or_default().to_owned();
    let mut known = true;
    for key in ["of", "below"] {
        if let Some(name) = values.word(key) {
            known &= setting.names.one(reader, name, &read.place(key));
        }
    }
    let statement = match form.key {
        "below" => {
            let below = values.word("below")?;
            if below == of {
                reader.report(Problem::at(
                    read.place("below"),
                    "an estimator cannot be below itself",
                ));
                return None;
            }
            Statement::Below {
                measure,
                of,
                below: below.to_owned(),
                by: values.number("by")?,
                confidence,
            }
        }
        "equals" => equals(reader, &read, measure, of, confidence, setting)?,
        "agrees-with" => {
            if !matches!(measure, Measure::Mise | Measure::Bias2 | Measure::Variance) {
                reader.report(
                    Problem::at(
                        entry.key_span(),
                        format!("there is no exact value for `{}`", measure.name()),
                    )
                    .allowed("`mise`, `bias2`, `variance`"),
                );
                return None;
            }
            let mut all = Vec::new();
            for name in values.words("of") {
                let found = setting.names.many(reader, name, &read.place("of"));
                if found.is_empty() {
                    return None;
                }
                all.extend(found);
            }
            Statement::AgreesWithExact {
                measure,
                of: all,
                confidence,
            }
        }
        "median" => Statement::MedianModes {
            of,
            median: values.number("median")?,
        },
        _ => Statement::ShareOfModes {
            of,
            count: values.count("count")? as usize,
            share: values.number("share")?,
            margin: values.number("margin")?,
        },
    };
    (demanded && known).then_some(statement)
}

fn equals(
    reader: &mut Reader,
    read: &Located,
    measure: Measure,
    of: String,
    confidence: f64,
    setting: &Setting<'_>,
) -> Option<Statement> {
    let values = &read.values;
    let over = values.word("over").map(str::to_owned);
    match over.as_deref() {
        Some("minimum") if measure != Measure::ExactMise => {
            reader.report(
                Problem::at(
                    read.place("over"),
                    "the minimum is known for `exact-mise` only",
                )
                .allowed("the name of an estimator"),
            );
            return None;
        }
        Some("minimum") | None => {}
        Some(other) => {
            if !setting.names.one(reader, other, &read.place("over")) {
                return None;
            }
        }
    }
    let expected = values.number("equals")?;
    let margin = match (values.number("within"), values.number("margin")) {
        (Some(within), None) if expected != 0.0 => within * expected.abs(),
        (Some(_), None) => {
            reader.report(
                Problem::at(
                    read.place("within"),
                    "a share of 0 is 0: nothing lies within it",
                )
                .help("give `margin`, in the unit of the measure"),
            );
            return None;
        }
        (None, Some(margin)) => margin,
        (Some(_), Some(_)) => {
            reader.report(Problem::at(
                read.place("margin"),
                "give `within` (a share) or `margin` (absolute), not both",
            ));
            return None;
        }
        (None, None) => {
            reader.report(
                Problem::at(
                    read.place("equals"),
                    "no two measured numbers are equal: how far off is still equal?",
                )
                .help("give `within` (a share) or `margin` (absolute)"),
            );
            return None;
        }
    };
    Some(Statement::Equals {
        measure,
        of,
        over,
        equals: expected,
        margin,
        confidence,
    })
}

/// Which form a statement about a measure has: told by the key that only this form takes.
fn form(reader: &mut Reader, entry: Entry<'_>, measure: Measure) -> Option<&'static Form> {
    let mut forms: Vec<&'static Form> = ANY.iter().collect();
    if measure == Measure::Modes {
        forms.extend(MODES);
    }
    let mut table = reader.table(entry.item, &format!("`{}`", measure.name()))?;
    let mut given: Vec<(&'static Form, Entry<'_>)> = forms
        .iter()
        .filter_map(|form| Some((*form, table.take(form.key)?)))
        .collect();
    given.sort_by_key(|(_, entry)| entry.key_span().start);
    let keys: Vec<&str> = forms.iter().map(|form| form.key).collect();
    match given[..] {
        [(form, _)] => Some(form),
        [] => {
            let mut all: Vec<&str> = forms
                .iter()
                .flat_map(|form| form.parameters.iter().map(|p| p.name))
                .collect();
            all.sort_unstable();
            all.dedup();
            for key in &all {
                table.take(key);
            }
            if !table.finish(reader, &all) {
                reader.report(
                    Problem::at(
                        entry.key_span(),
                        format!("`{}` is compared with nothing", measure.name()),
                    )
                    .allowed(listed(&keys))
                    .doubtful(),
                );
            }
            None
        }
        [(first, _), (_, second), ..] => {
            reader.report(
                Problem::at(
                    second.key_span(),
                    format!("this claim has `{}` already", first.key),
                )
                .help("write a [[claim]] for each"),
            );
            None
        }
    }
}
