//! `slope`, `coverage` and `everywhere`: how fast an error falls, how often an interval is right, and whether theory is, place by place.

use super::claim::{SIMULATED, all_exact, settings};
use super::evidence;
use super::form::{AGREES, COVERAGE, SLOPE};
use super::node::{Entry, Reader};
use super::problem::Problem;
use super::setting::Setting;
use crate::experiment::{Measure, Statement};

/// Reads `slope = { .. }`; `sized` says whether the claim names one sample size.
pub(super) fn slope(
    reader: &mut Reader,
    entry: Entry<'_>,
    setting: &Setting<'_>,
    sized: bool,
) -> Option<Statement> {
    let span = entry.key_span();
    let read = settings(reader, entry, SLOPE)?;
    let values = &read.values;
    let word = values.word("measure")?;
    let measure = Measure::ALL.into_iter().find(|m| m.name() == word)?;
    let what = "the claim `slope`";
    let mut known = setting.demand(reader, &span, what, true, !measure.is_exact());
    if sized || setting.draws.is_some_and(|draws| draws.len() < 2) {
        reader.report(
            Problem::at(span.clone(), "a slope needs two sample sizes or more")
                .help("give `draws` of the experiment as a list, such as [1000, 10000, 100000], and none to the claim"),
        );
        known = false;
    }
    let of = values.word("of")?.to_owned();
    known &= setting.names.one(reader, &of, &read.place("of"));
    let equals = values.number("equals");
    let exact = values.word("agrees-with").is_some();
    if exact == equals.is_some() {
        reader.report(
            Problem::at(
                span,
                "a slope is compared with a number or with the exact one",
            )
            .allowed("`equals` or `agrees-with`, not both"),
        );
        return None;
    }
    if exact && measure.is_exact() {
        reader.report(
            Problem::at(
                read.place("agrees-with"),
                "the slope of exact values is the exact one: nothing could contradict that",
            )
            .help("give `equals`, or a simulated `measure`"),
        );
        return None;
    }
    if exact && measure != Measure::Mise {
        reader.report(
            Problem::at(
                read.place("measure"),
                format!("there is no exact value for `{word}`"),
            )
            .allowed("`mise`"),
        );
        return None;
    }
    if exact || measure.is_exact() {
        known &= evidence::exact(reader, setting, &of, &read.place("of"), SIMULATED);
    }
    known.then_some(Statement::Slope {
        measure,
        of,
        equals,
        margin: values.number("margin")?,
        confidence: values.number("confidence")?,
    })
}

/// Reads `coverage = { .. }`.
pub(super) fn coverage(
    reader: &mut Reader,
    entry: Entry<'_>,
    setting: &Setting<'_>,
) -> Option<Statement> {
    let span = entry.key_span();
    let read = settings(reader, entry, COVERAGE)?;
    let values = &read.values;
    let what = "the claim `coverage`";
    let mut known = setting.demand(reader, &span, what, true, true);
    if !setting.interval {
        reader.report(Problem::at(span, "the experiment counts no coverage").help(
            "set `interval` of the experiment to a confidence, for instance interval = 0.95",
        ));
        known = false;
    }
    let of = values.word("of")?.to_owned();
    known &= setting.names.one(reader, &of, &read.place("of"));
    let truth = values.word("target") == Some("truth");
    if !truth {
        known &= evidence::exact(reader, setting, &of, &read.place("of"), SIMULATED);
    }
    let at = setting.place(reader, &read)?;
    known.then_some(Statement::Coverage {
        of,
        at,
        truth,
        equals: values.number("equals")?,
        margin: values.number("margin")?,
        confidence: values.number("confidence")?,
    })
}

/// Reads `everywhere = { .. }`.
pub(super) fn everywhere(
    reader: &mut Reader,
    entry: Entry<'_>,
    setting: &Setting<'_>,
) -> Option<Statement> {
    let what = "the claim `everywhere`";
    let demanded = setting.demand(reader, &entry.key_span(), what, true, true);
    let read = settings(reader, entry, AGREES)?;
    let (of, exact) = all_exact(reader, &read, setting)?;
    (demanded && exact).then_some(Statement::Everywhere {
        of,
        confidence: read.values.number("confidence")?,
    })
}
