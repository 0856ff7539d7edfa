//! Holding the claims of an experiment against its results.

mod comparison;
mod coverage;
mod everywhere;
mod modes;
mod optimum;
mod regret;
mod slope;
mod uncertain;

pub use optimum::swept;
pub use slope::slope;

use super::manifest::Line;
use super::results::{Group, Results};
use super::run::Bench;
use super::{Claim, Elsewhere, Experiment, Measure, Statement};
use crate::accuracy::sidak;
use crate::random;
use comparison::{agrees, below_by, equal};
use coverage::covers;
use everywhere::everywhere;
use modes::{median_modes, share_of_modes};
use optimum::{best_is_near, oracle};
use regret::regret;
use slope::has_slope;
use uncertain::uncertainty;

/// How a claim came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ruling {
    /// Shown, at the confidence it names.
    Holds,
    /// Not shown: contradicted, or left open by the numbers.
    Fails,
}

impl Ruling {
    /// The word in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Fails => "not shown",
        }
    }
}

/// The verdict on one claim.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The claim, as a position in the experiment.
    pub claim: usize,
    /// How it came out: it holds if it does in every group it is about.
    pub outcome: Ruling,
    /// The numbers, a sentence a group.
    pub detail: String,
}

impl Verdict {
    /// The verdict in words.
    pub fn line(&self, experiment: &Experiment) -> Line {
        let claim = &experiment.claims[self.claim];
        Line {
            claim: claim.says.clone(),
            holds: self.outcome == Ruling::Holds,
            detail: self.detail.clone(),
            theory: claim.statement.is_theory(),
        }
    }
}

/// Judges every claim.
pub fn judge<const D: usize>(bench: &Bench<D>, results: &Results<D>) -> Vec<Verdict> {
    let experiment = bench.experiment();
    experiment
        .claims
        .iter()
        .enumerate()
        .map(|(number, claim)| {
            let parts: Vec<Option<Group<D>>> = results
                .groups
                .iter()
                .filter(|group| concerns(claim, group))
                .map(|group| group.within(claim.region.as_deref()?))
                .collect();
            let groups: Vec<&Group<D>> = results
                .groups
                .iter()
                .filter(|group| concerns(claim, group))
                .zip(&parts)
                .map(|(whole, part)| part.as_ref().unwrap_or(whole))
                .collect();
            if let Statement::Slope { .. } = claim.statement {
                return over_sizes(number, &claim.statement, &groups);
            }
            let rulings: Vec<(bool, String)> = groups
                .iter()
                .map(|group| judge_one(bench, results, number, claim, (group, groups.len())))
                .collect();
            let holds = !rulings.is_empty() && rulings.iter().all(|(holds, _)| *holds);
            let detail = summarise(&rulings, &groups);
            Verdict {
                claim: number,
                outcome: if holds { Ruling::Holds } else { Ruling::Fails },
                detail,
            }
        })
        .collect()
}

/// Judges a claim about all sizes of each source together.
fn over_sizes<const D: usize>(
    number: usize,
    statement: &Statement,
    groups: &[&Group<D>],
) -> Verdict {
    let none = || (false, "the run has no numbers for this claim".to_owned());
    let mut rulings = Vec::new();
    // groups come source by source
    for of_source in groups.chunk_by(|a, b| a.source == b.source) {
        let Statement::Slope {
            measure,
            of,
            equals,
            margin,
            confidence,
        } = statement
        else {
            continue;
        };
        let ruling = has_slope(of_source, (of, *measure), *equals, *margin, *confidence);
        let (holds, detail) = ruling.unwrap_or_else(none);
        rulings.push((holds, format!("{}: {detail}", of_source[0].name)));
    }
    let holds = !rulings.is_empty() && rulings.iter().all(|(holds, _)| *holds);
    let details: Vec<String> = rulings.into_iter().map(|(_, detail)| detail).collect();
    Verdict {
        claim: number,
        outcome: if holds { Ruling::Holds } else { Ruling::Fails },
        detail: details.join("; "),
    }
}

/// The numbers of a claim in words: of each group, or of those where it fails and one other where there are many.
fn summarise<const D: usize>(rulings: &[(bool, String)], groups: &[&Group<D>]) -> String {
    const MANY: usize = 3;
    if let [(_, detail)] = rulings {
        return detail.clone();
    }
    let holds = rulings.iter().filter(|(holds, _)| *holds).count();
    let mut example = holds == rulings.len();
    let told = rulings
        .iter()
        .zip(groups)
        .filter(|((holds, _), _)| rulings.len() <= MANY || !holds || std::mem::take(&mut example));
    let told: Vec<String> = told
        .map(|((_, detail), group)| format!("{}, n = {}: {detail}", group.name, group.draws))
        .collect();
    if rulings.len() <= MANY {
        return told.join("; ");
    }
    let which = if holds == rulings.len() {
        "for instance"
    } else {
        "but not"
    };
    format!(
        "{holds} of {} cases hold, {which} {}",
        rulings.len(),
        told.join("; ")
    )
}

fn concerns<const D: usize>(claim: &Claim, group: &Group<D>) -> bool {
    claim.draws.is_none_or(|draws| draws == group.draws)
        && claim
            .source
            .as_ref()
            .is_none_or(|source| *source == group.name)
}

/// Does `work` with the group that has the number with which one of `group` is compared: within the region, too, that the claim is about.
fn elsewhere<const D: usize, T>(
    results: &Results<D>,
    group: &Group<D>,
    other: &Elsewhere,
    region: Option<&str>,
    work: impl FnOnce(&Group<D>) -> Option<T>,
) -> Option<T> {
    let source = other.source.as_ref().unwrap_or(&group.name);
    let draws = other.draws.unwrap_or(group.draws);
    if group.name == *source && group.draws == draws {
        return work(group);
    }
    let mut groups = results.groups.iter();
    let whole = groups.find(|group| group.name == *source && group.draws == draws)?;
    match region {
        Some(region) => work(&whole.within(region)?),
        None => work(whole),
    }
}

#[expect(clippy::too_many_lines, reason = "one arm a kind of statement")]
fn judge_one<const D: usize>(
    bench: &Bench<D>,
    results: &Results<D>,
    number: usize,
    claim: &Claim,
    (group, groups): (&Group<D>, usize),
) -> (bool, String) {
    let experiment = bench.experiment();
    if let Some(reason) = without_grounds(&claim.statement, group) {
        return (false, reason);
    }
    let region = claim.region.as_deref();
    let ruling = match &claim.statement {
        Statement::Below {
            measure,
            of,
            below,
            other,
            by,
            confidence,
        } => {
            let random = random::stream(
                experiment.seed,
                &format!("bootstrap/{}/{}", group.name, group.draws),
                number as u64,
            );
            elsewhere(results, group, other, region, |other| {
                let pair = ((group, &**of), (other, &**below));
                below_by(pair, *measure, *by, *confidence, random)
            })
        }
        Statement::Equals {
            measure,
            of,
            over,
            other,
            equals,
            margin,
            confidence,
        } => elsewhere(results, group, other, region, |other| {
            let over = over.as_deref().map(|over| (other, over));
            let expected = (*equals, *margin);
            equal(bench, (group, of), over, *measure, expected, *confidence)
        }),
        Statement::AgreesWithExact {
            measure,
            of,
            confidence,
        } => agrees(group, *measure, of, sidak(*confidence, groups)),
        Statement::MedianModes {
            of,
            median,
            confidence,
        } => group
            .outcome(of)
            .map(|outcome| median_modes(outcome, *median, *confidence)),
        Statement::ShareOfModes {
            of,
            count,
            share,
            margin,
            confidence,
        } => group
            .outcome(of)
            .map(|outcome| share_of_modes(outcome, *count, *share, *margin, *confidence)),
        Statement::Regret {
            of,
            over,
            median,
            margin,
            below,
            confidence,
        } => {
            let expected = (*median, *margin);
            regret(group, (of, over), expected, below.as_deref(), *confidence)
        }
        Statement::Uncertainty {
            of,
            by,
            quantity,
            equals,
            above,
            confidence,
        } => {
            let expected = (*equals, *above);
            uncertainty(
                experiment,
                group,
                (of, by),
                *quantity,
                expected,
                *confidence,
            )
        }
        Statement::BestIsNear { of, swept, within } => {
            best_is_near(bench, group, (of, *swept), *within)
        }
        Statement::Coverage {
            of,
            at,
            truth,
            equals,
            margin,
            confidence,
        } => covers(group, of, (at, *truth), (*equals, *margin), *confidence),
        Statement::Everywhere { of, confidence } => {
            everywhere(group, of, sidak(*confidence, groups))
        }
        // judged over all sizes together
        Statement::Slope { .. } => None,
        Statement::Oracle {
            quantity,
            kernel,
            symmetry,
            equals,
            digits,
        } => oracle(bench, group, quantity, (kernel, symmetry), *equals, *digits),
    };
    ruling.unwrap_or_else(|| (false, "the run has no numbers for this claim".to_owned()))
}

/// Why a claim cannot be shown by these results, whatever their values.
fn without_grounds<const D: usize>(statement: &Statement, group: &Group<D>) -> Option<String> {
    let (measure, paired) = match statement {
        Statement::Below { measure, .. } => (*measure, true),
        Statement::Equals { measure, over, .. } => (
            *measure,
            over.as_deref().is_some_and(|over| over != "minimum"),
        ),
        Statement::AgreesWithExact { measure, .. } => (*measure, false),
        Statement::Regret { .. } => (Measure::Mise, true),
        Statement::MedianModes { .. } | Statement::ShareOfModes { .. } => (Measure::Modes, false),
        Statement::Uncertainty { .. }
        | Statement::BestIsNear { .. }
        | Statement::Oracle { .. }
        | Statement::Coverage { .. }
        | Statement::Everywhere { .. }
        | Statement::Slope { .. } => {
            return None;
        }
    };
    let parts = matches!(measure, Measure::Bias2 | Measure::Variance);
    if parts && paired {
        return Some(format!(
            "simulated {} of two estimators cannot be compared replicate by replicate; claim exact-{0} instead",
            measure.name()
        ));
    }
    // a data file is one sample, and what it shows is what it shows
    let few = group.truth.is_some()
        && group
            .outcomes
            .iter()
            .any(|outcome| outcome.replicates.len() < 2 || (parts && outcome.blocks.len() < 3));
    (!measure.is_exact() && !measure.is_probe() && few)
        .then(|| "too few replicates for an interval".to_owned())
}

/// A number as a sentence gives it: four significant digits.
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor() as i32;
    if (-4..6).contains(&magnitude) {
        let text = format!("{value:.*}", (3 - magnitude).max(0) as usize);
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    } else {
        format!("{value:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_in_sentences_have_four_digits() {
        assert_eq!(short(2.839_71), "2.84");
        assert_eq!(short(0.004_570_4), "0.00457");
        assert_eq!(short(12_345.6), "12346");
        assert_eq!(short(1.0), "1");
        assert_eq!(short(1.234_56e-9), "1.235e-9");
        assert_eq!(short(-0.5), "-0.5");
    }
}
