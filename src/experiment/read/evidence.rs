//! Whether a claim can be shown at all, and whether it could fail: found before anything is computed.

use super::problem::{Problem, Span, printable};
use super::setting::{Rungs, Setting};
use super::{node::Reader, value::Located};
use crate::accuracy::{fewest_for_median, share_interval};
use crate::experiment::{Measure, budget};
use crate::parameter::listed;

/// Of what is expected: a margin as wide as half of it would call "equal" what differs by a factor of two.
const HALF: f64 = 0.5;

/// The absolute margin around `expected` that the file gives as `within` or `margin`, if it leaves out enough for the claim to fail.
pub(super) fn margin(
    reader: &mut Reader,
    read: &Located,
    measure: Measure,
    over: Option<&str>,
    expected: f64,
    setting: &Setting<'_>,
) -> Option<f64> {
    let values = &read.values;
    let (problem, help) = match (values.number("within"), values.number("margin")) {
        (Some(within), None) if expected != 0.0 => return Some(within * expected.abs()),
        (None, Some(margin)) => {
            let (most, why) = widest(measure, over, expected, setting);
            if most.is_none_or(|most| margin < most) {
                return Some(margin);
            }
            let most = most.unwrap_or(f64::INFINITY);
            reader.report(
                Problem::at(
                    read.place("margin"),
                    format!("a margin of {margin} around {expected} could hardly fail: {why}"),
                )
                .allowed(format!("a number above 0 and below {most}")),
            );
            return None;
        }
        (Some(_), None) => (
            Problem::at(
                read.place("within"),
                "a share of 0 is 0: nothing lies within it",
            ),
            Some("give `margin`, in the unit of the measure"),
        ),
        (Some(_), Some(_)) => (
            Problem::at(
                read.place("margin"),
                "give `within` (a share) or `margin` (absolute), not both",
            ),
            None,
        ),
        (None, None) => (
            Problem::at(
                read.place("equals"),
                "no two measured numbers are equal: how far off is still equal?",
            ),
            Some("give `within` (a share) or `margin` (absolute)"),
        ),
    };
    reader.report(match help {
        Some(help) => problem.help(help),
        None => problem,
    });
    None
}

/// Margins must be below this, and why; no number where nothing is known to compare with.
fn widest(
    measure: Measure,
    over: Option<&str>,
    expected: f64,
    setting: &Setting<'_>,
) -> (Option<f64>, &'static str) {
    if expected != 0.0 {
        return (
            Some(HALF * expected.abs()),
            "it is half of the expected value or more",
        );
    }
    if over.is_some() {
        return (Some(1.0), "it lets the two be equal");
    }
    match measure {
        Measure::Mise
        | Measure::Bias2
        | Measure::Variance
        | Measure::ExactMise
        | Measure::ExactBias2
        | Measure::ExactVariance => (
            setting.power,
            "an estimate that is zero everywhere is no more than ∫f² wrong",
        ),
        Measure::Miae | Measure::Energy | Measure::Mass | Measure::Wall => {
            (Some(1.0), "an estimate that is zero everywhere is 1 wrong")
        }
        Measure::Jump => (
            Some(1.0),
            "no jump is larger than the range of the estimate",
        ),
        Measure::Modes => (Some(1.0), "it lets one mode be none"),
        Measure::Mire
        | Measure::Bias
        | Measure::Smoothing
        | Measure::OverBest
        | Measure::OverKernel
        | Measure::OverLocalKernel => (None, ""),
    }
}

/// Whether a share may be claimed to lie within `margin` of `share` by the experiment's replicates: the claim must leave out half of all shares, and the
/// best possible outcome must show it.
pub(super) fn share(reader: &mut Reader, read: &Located, setting: &Setting<'_>) -> bool {
    let number = |key| read.values.number(key).unwrap_or_default();
    let (share, margin, confidence) = (number("share"), number("margin"), number("confidence"));
    let (low, high) = ((share - margin).max(0.0), (share + margin).min(1.0));
    if high - low > 0.5 {
        let most = (0.5 - share.min(1.0 - share)).max(0.25);
        reader.report(
            Problem::at(
                read.place("margin"),
                format!("the shares from {low} to {high} are more than half of all there are: the claim could hardly fail"),
            )
            .allowed(format!("a number above 0 and at most {most}")),
        );
        return false;
    }
    let Some(replicates) = setting.replicates.filter(|replicates| *replicates > 1) else {
        return true;
    };
    let best = |replicates: usize| {
        let hits = (share * replicates as f64).round() as usize;
        let interval = share_interval(hits, replicates, confidence);
        (low <= interval.low && interval.high <= high, interval)
    };
    let (possible, interval) = best(replicates);
    if !possible {
        let mut enough = replicates;
        while enough < super::REPLICATES as usize && !best(enough).0 {
            enough += enough.div_ceil(10);
        }
        reader.report(
            Problem::at(
                read.place("margin"),
                format!(
                    "{replicates} replicates cannot show this: around their best possible outcome the interval still reaches from {:.3} to {:.3}",
                    interval.low, interval.high
                ),
            )
            .help(format!("`replicates` of more than {enough}, a wider `margin`, or a lower `confidence`")),
        );
    }
    possible
}

/// Whether the experiment's replicates are enough for a median.
pub(super) fn median(reader: &mut Reader, read: &Located, setting: &Setting<'_>) -> bool {
    let confidence = read.values.number("confidence").unwrap_or_default();
    let fewest = fewest_for_median(confidence);
    let few = setting.replicates.filter(|r| (2..fewest).contains(r));
    if let Some(replicates) = few {
        reader.report(
            Problem::at(
                read.place("median"),
                format!(
                    "the median of {replicates} samples has no interval at confidence {confidence}"
                ),
            )
            .help(format!("set `replicates` to {fewest} or more")),
        );
    }
    few.is_none()
}

/// Whether there are blocks of replicates enough for the error of what only blocks have, bias² and variance.
pub(super) fn blocks(
    reader: &mut Reader,
    span: &Span,
    measure: Measure,
    setting: &Setting<'_>,
) -> bool {
    if !matches!(measure, Measure::Bias2 | Measure::Variance) {
        return true;
    }
    let enough = |replicates: usize| replicates.div_ceil(budget::block_length(replicates)) > 2;
    let few = setting
        .replicates
        .filter(|&replicates| replicates > 1 && !enough(replicates));
    if few.is_some() {
        let fewest = (2..=super::REPLICATES as usize).find(|&r| enough(r));
        reader.report(
            Problem::at(
                span.clone(),
                format!(
                    "the replicates are too few for an interval for `{}`",
                    measure.name()
                ),
            )
            .help(format!(
                "set `replicates` to {} or more",
                fewest.unwrap_or_default()
            )),
        );
    }
    few.is_none()
}

/// Whether two estimators can be compared sample by sample: bias² and variance are of all samples together.
pub(super) fn paired(reader: &mut Reader, span: &Span, measure: Measure) -> bool {
    let parts = matches!(measure, Measure::Bias2 | Measure::Variance);
    if parts {
        reader.report(
            Problem::at(
                span.clone(),
                format!(
                    "simulated {} of two estimators cannot be compared sample by sample",
                    measure.name()
                ),
            )
            .help(format!("claim `exact-{}` instead", measure.name())),
        );
    }
    !parts
}

/// Whether theory has an exact value for the estimator of that name.
pub(super) fn exact(
    reader: &mut Reader,
    setting: &Setting<'_>,
    name: &str,
    span: &Span,
    help: &str,
) -> bool {
    let why = setting
        .theory
        .known
        .get(name)
        .and_then(|known| known.inexact.as_ref());
    if let Some(why) = why {
        reader.report(
            Problem::at(
                span.clone(),
                format!("there is no exact value for \"{}\": {why}", printable(name)),
            )
            .help(help),
        );
    }
    why.is_none()
}

/// The same for all of `names` at once; where `all` of the experiment are meant, with those that could be named instead.
pub(super) fn all_exact(
    reader: &mut Reader,
    setting: &Setting<'_>,
    names: &[String],
    span: &Span,
) -> bool {
    let known = || setting.theory.known.iter();
    let without = known().find(|(name, known)| {
        known.inexact.is_some() && (names.is_empty() || names.contains(name))
    });
    let Some((name, _)) = without else {
        return true;
    };
    let with: Vec<String> = known()
        .filter(|(_, known)| known.inexact.is_none())
        .map(|(name, _)| printable(name))
        .collect();
    let help = match &with[..] {
        [] => {
            "none of the estimators here has one: give a width as a number, \"oracle\" or \"amise\""
                .to_owned()
        }
        some => format!("name in `of` only those that have one: {}", abridged(some)),
    };
    exact(reader, setting, name, span, &help)
}

fn abridged(names: &[String]) -> String {
    const LISTED: usize = 12;
    let list = listed(&names[..names.len().min(LISTED)]);
    if names.len() > LISTED {
        format!("{list} and {} more", names.len() - LISTED)
    } else {
        list
    }
}

/// What theory says of the estimator of that name on `source`, or on all; with the names of the sources. Nothing of what could not be built, and of data files, of which there is more to be said.
fn on<'s>(
    setting: &'s Setting<'_>,
    name: &str,
    source: Option<&str>,
) -> impl Iterator<Item = (&'s str, &'s Rungs)> {
    let all = setting.theory.rungs.iter();
    let known = setting.truth != Some(false);
    all.filter(move |((of, from), _)| {
        known && of == name && source.is_none_or(|source| source == from)
    })
    .map(|((_, from), rungs)| (from.as_str(), rungs))
}

/// Whether theory knows the best width for the estimator of that name on `source`, or on all.
pub(super) fn optimum(
    reader: &mut Reader,
    setting: &Setting<'_>,
    name: &str,
    source: Option<&str>,
    span: &Span,
) -> bool {
    let known = on(setting, name, source).all(|(_, rungs)| rungs.optimum);
    if !known {
        reader.report(
            Problem::at(
                span.clone(),
                format!(
                    "theory does not know the best setting for \"{}\"",
                    printable(name)
                ),
            )
            .help("it does for the bandwidth of kernel estimators and the width of binned ones"),
        );
    }
    known
}

/// Whether there is what a measure divides by: for each estimator that is named, where it is looked at.
pub(super) fn rungs(
    reader: &mut Reader,
    read: &Located,
    measure: Measure,
    source: Option<&str>,
    setting: &Setting<'_>,
) -> bool {
    let values = &read.values;
    let other = values.word("other-source").or(source);
    // by itself over there, where nothing else is named
    let itself = values.word("below").or(values.word("over")).is_none();
    let there = if itself { other } else { source };
    let mut all = [
        ("of", source),
        ("of", there),
        ("below", other),
        ("over", other),
    ]
    .into_iter();
    all.all(|(key, source)| {
        values
            .word(key)
            .is_none_or(|name| rung(reader, setting, measure, name, source, &read.place(key)))
    })
}

/// Whether the errors of the estimator of that name are compared with what `measure` divides by: on `source`, or on all.
fn rung(
    reader: &mut Reader,
    setting: &Setting<'_>,
    measure: Measure,
    name: &str,
    source: Option<&str>,
    span: &Span,
) -> bool {
    let missing = |rungs: &Rungs| {
        measure.is_over_ladder()
            && rungs.ladder.is_none_or(|oracles| match measure {
                Measure::OverBest => !oracles.best,
                _ => !oracles.kernel,
            })
    };
    let Some((from, rungs)) = on(setting, name, source).find(|(_, rungs)| missing(rungs)) else {
        return true;
    };
    let (what, help) = match measure {
        _ if rungs.ladder.is_none() => (
            "theory knows no least error".to_owned(),
            "it does for independent points of a density",
        ),
        Measure::OverBest => (
            format!(
                "theory does not know the best of the kind of \"{}\"",
                printable(name)
            ),
            if rungs.ladder.is_some_and(|oracles| oracles.kernel) {
                "`over-kernel` compares any estimator with the best kernel"
            } else {
                "claim something else, such as `mise`"
            },
        ),
        _ => (
            "there is no best kernel".to_owned(),
            "of a level density the wider is the better, and on long strips none is known; claim something else, such as `mise`",
        ),
    };
    let from = printable(from);
    reader
        .report(Problem::at(span.clone(), format!("{what}, for the source \"{from}\"")).help(help));
    false
}
