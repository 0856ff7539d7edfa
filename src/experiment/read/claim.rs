//! `[[claim]]`.

use super::evidence;
use super::form::{ANY, BEST, COMMON, Form, MODES, ORACLE, REGRET};
use super::node::{Entry, Reader, Table};
use super::problem::{Problem, Span};
use super::rate::{coverage, everywhere, slope};
use super::setting::Setting;
use super::value::{self, Located};
use crate::experiment::{Claim, Elsewhere, Measure, Statement};
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
    let region = table.take("region");
    let part = region.map(|entry| entry.key_span());
    let region = region.map(|entry| setting.region(reader, entry.item));
    let entry = key(reader, table, &span)?;
    let about = source.as_ref().and_then(Option::as_deref);
    let statement = match entry.key() {
        "best" => best(reader, entry, about, setting),
        "oracle" => oracle(reader, entry, setting),
        "regret" => regret(reader, entry, setting),
        "uncertainty" => super::uncertainty::claim(reader, entry, setting),
        "coverage" => coverage(reader, entry, setting),
        "everywhere" => everywhere(reader, entry, setting),
        "slope" => slope(reader, entry, setting, draws.is_some()),
        name => {
            let measure = Measure::ALL
                .into_iter()
                .find(|measure| measure.name() == name)?;
            if let Some(part) = part.filter(|_| measure.is_over_ladder()) {
                reader.report(whole_only(measure, part));
                return None;
            }
            measured(reader, entry, measure, about, setting)
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
        region: match region {
            Some(region) => Some(region?),
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
        .chain([
            "best",
            "oracle",
            "regret",
            "uncertainty",
            "slope",
            "coverage",
            "everywhere",
        ])
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

pub(super) fn settings(
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

fn best(
    reader: &mut Reader,
    entry: Entry<'_>,
    source: Option<&str>,
    setting: &Setting<'_>,
) -> Option<Statement> {
    let demanded = setting.demand(reader, &entry.key_span(), "the claim `best`", true, true);
    let read = settings(reader, entry, BEST)?;
    let of = read.values.word("of")?;
    let swept = read.values.word("near") == Some("exact");
    let place = read.place("of");
    let known = setting.names.sweep(reader, of, &place)
        && setting.names.members(of).iter().all(|member| {
            if swept {
                evidence::exact(reader, setting, member, &place, SIMULATED)
            } else {
                evidence::optimum(reader, setting, member, source, &place)
            }
        });
    (known && demanded).then_some(Statement::BestIsNear {
        of: of.to_owned(),
        swept,
        within: read.values.number("within")?,
    })
}

fn regret(reader: &mut Reader, entry: Entry<'_>, setting: &Setting<'_>) -> Option<Statement> {
    let demanded = setting.demand(reader, &entry.key_span(), "the claim `regret`", true, false);
    let read = settings(reader, entry, REGRET)?;
    let mut known = true;
    for key in ["of", "over", "below"] {
        if let Some(name) = read.values.word(key) {
            known &= setting.names.one(reader, name, &read.place(key));
        }
    }
    let word = |key: &str| read.values.word(key).map(str::to_owned);
    (known && demanded).then_some(Statement::Regret {
        of: word("of")?,
        over: word("over")?,
        median: read.values.number("median")?,
        margin: read.values.number("margin")?,
        below: word("below"),
        confidence: read.values.number("confidence")?,
    })
}

fn oracle(reader: &mut Reader, entry: Entry<'_>, setting: &Setting<'_>) -> Option<Statement> {
    let demanded = setting.demand(reader, &entry.key_span(), "the claim `oracle`", true, false);
    let read = settings(reader, entry, ORACLE)?;
    demanded.then_some(Statement::Oracle {
        quantity: read.values.word("quantity")?.to_owned(),
        kernel: read.values.word("kernel")?.to_owned(),
        symmetry: read.values.word("symmetry").unwrap_or("product").to_owned(),
        equals: read.values.number("equals")?,
        digits: read.values.count("digits")? as u32,
    })
}

/// What to do where there is nothing exact to claim.
pub(super) const SIMULATED: &str = "give it a width as a number, \"oracle\" or \"amise\", or claim something simulated, such as `mise`";

fn whole_only(measure: Measure, span: Span) -> Problem {
    let what = format!(
        "`{}` compares errors over the whole grid, and theory has none of a part",
        measure.name()
    );
    Problem::at(span, what)
        .help("leave out `region`, or claim something of both estimators, such as `mise`")
}

/// `MEASURE = { .. }` in any of its forms, about one source or all.
fn measured(
    reader: &mut Reader,
    entry: Entry<'_>,
    measure: Measure,
    source: Option<&str>,
    setting: &Setting<'_>,
) -> Option<Statement> {
    let form = form(reader, entry, measure)?;
    let exact = measure.is_exact();
    // A data file is one sample: what is measured on it is a plain number without an interval.
    let replicated =
        !exact && !measure.is_probe() && (setting.truth != Some(false) || form.key == "count");
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
            known &= setting.names.one(reader, name, &read.place(key))
                && (!exact || evidence::exact(reader, setting, name, &read.place(key), SIMULATED));
        }
    }
    known &= evidence::blocks(reader, &entry.key_span(), measure, setting);
    known &= evidence::rungs(reader, &read, measure, source, setting);
    let statement = match form.key {
        "below" => {
            let below = values.word("below")?;
            let other = elsewhere(reader, &read, measure, setting)?;
            if below == of && other.is_here() {
                reader.report(Problem::at(
                    read.place("below"),
                    "an estimator cannot be below itself",
                ));
                return None;
            }
            if !evidence::paired(reader, &read.place("below"), measure) {
                return None;
            }
            Statement::Below {
                measure,
                of,
                below: below.to_owned(),
                other,
                by: values.number("by")?,
                confidence,
            }
        }
        "equals" => equals(reader, &read, (measure, of), confidence, (source, setting))?,
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
            let (all, exact) = all_exact(reader, &read, setting)?;
            known &= exact;
            Statement::AgreesWithExact {
                measure,
                of: all,
                confidence,
            }
        }
        "median" => {
            known &= evidence::median(reader, &read, setting);
            Statement::MedianModes {
                of,
                median: values.count("median")?,
                confidence,
            }
        }
        _ => {
            let statement = Statement::ShareOfModes {
                of,
                count: values.count("count")? as usize,
                share: values.number("share")?,
                margin: values.number("margin")?,
                confidence,
            };
            known &= evidence::share(reader, &read, setting);
            statement
        }
    };
    (demanded && known).then_some(statement)
}

/// The estimators that `of` names, and whether all have exact values.
pub(super) fn all_exact(
    reader: &mut Reader,
    read: &Located,
    setting: &Setting<'_>,
) -> Option<(Vec<String>, bool)> {
    let mut all = Vec::new();
    for name in read.values.words("of") {
        let found = setting.names.many(reader, name, &read.place("of"));
        if found.is_empty() {
            return None;
        }
        all.extend(found);
    }
    let exact = evidence::all_exact(reader, setting, &all, &read.place("of"));
    Some((all, exact))
}

fn equals(
    reader: &mut Reader,
    read: &Located,
    (measure, of): (Measure, String),
    confidence: f64,
    (source, setting): (Option<&str>, &Setting<'_>),
) -> Option<Statement> {
    let values = &read.values;
    let other = elsewhere(reader, read, measure, setting)?;
    let own = (!other.is_here()).then(|| of.clone());
    let over = values.word("over").map(str::to_owned).or(own);
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
        Some("minimum") if !other.is_here() => {
            reader.report(
                Problem::at(
                    read.place("over"),
                    "the minimum is that of the claim's own source and sample size",
                )
                .help("leave out `other-source` and `other-draws`"),
            );
            return None;
        }
        Some("minimum") => {
            // what has no exact value has been reported
            let known = setting.theory.known.get(&of);
            if known.is_some_and(|known| known.inexact.is_some())
                || !evidence::optimum(reader, setting, &of, source, &read.place("of"))
            {
                return None;
            }
        }
        None => {}
        Some(other) => {
            let place = read.place(if values.word("over").is_some() {
                "over"
            } else {
                "of"
            });
            if !setting.names.one(reader, other, &place) {
                return None;
            }
            if !evidence::paired(reader, &place, measure) {
                return None;
            }
            if measure.is_exact() && !evidence::exact(reader, setting, other, &place, SIMULATED) {
                return None;
            }
        }
    }
    let expected = values.number("equals")?;
    let margin = evidence::margin(reader, read, measure, over.as_deref(), expected, setting)?;
    Some(Statement::Equals {
        measure,
        of,
        over,
        other,
        equals: expected,
        margin,
        confidence,
    })
}

/// `other-source` and `other-draws`.
fn elsewhere(
    reader: &mut Reader,
    read: &Located,
    measure: Measure,
    setting: &Setting<'_>,
) -> Option<Elsewhere> {
    let other = Elsewhere {
        source: read.values.word("other-source").map(str::to_owned),
        draws: read.values.count("other-draws").map(|draws| draws as usize),
    };
    let mut sound = true;
    if let Some(source) = &other.source {
        sound &= setting.knows_source(reader, source, &read.place("other-source"));
    }
    if let Some(draws) = other.draws {
        sound &= setting.knows_draws(reader, draws, &read.place("other-draws"));
    }
    if !other.is_here() && measure.is_exact() {
        sound = false;
        reader.report(
            Problem::at(
                read.place(if other.source.is_some() {
                    "other-source"
                } else {
                    "other-draws"
                }),
                "exact values are compared on one source and sample size",
            )
            .help("claim something simulated, such as `mise`"),
        );
    }
    sound.then_some(other)
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
