//! Holding the claims of an experiment against its results.

use super::manifest::Line;
use super::results::{Group, Outcome, Results};
use super::run::Bench;
use super::{Claim, Experiment, Measure, Statement};
use crate::accuracy::{Interval, compare, lower_bound, sidak};
use crate::experiment::table::exact_counterpart;
use crate::kernel::Shape;
use crate::random;
use crate::theory;

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
        }
    }
}

/// Judges every claim.
pub fn judge(bench: &Bench, results: &Results) -> Vec<Verdict> {
    let experiment = bench.experiment();
    experiment
        .claims
        .iter()
        .enumerate()
        .map(|(number, claim)| {
            let groups: Vec<&Group> = results
                .groups
                .iter()
                .filter(|group| concerns(claim, group))
                .collect();
            let rulings: Vec<(bool, String)> = groups
                .iter()
                .map(|group| judge_one(bench, number, claim, group))
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

/// The numbers of a claim in words: of each group, or of those where it fails and one other where there are many.
fn summarise(rulings: &[(bool, String)], groups: &[&Group]) -> String {
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

fn concerns(claim: &Claim, group: &Group) -> bool {
    claim.draws.is_none_or(|draws| draws == group.draws)
        && claim
            .source
            .as_ref()
            .is_none_or(|source| *source == group.name)
}

fn judge_one(bench: &Bench, number: usize, claim: &Claim, group: &Group) -> (bool, String) {
    let experiment = bench.experiment();
    let ruling = match &claim.statement {
        Statement::Below {
            measure,
            of,
            below,
            by,
            confidence,
        } => {
            let random = random::stream(
                experiment.seed,
                &format!("bootstrap/{}/{}", group.name, group.draws),
                number as u64,
            );
            below_by(group, *measure, (of, below), *by, *confidence, random)
        }
        Statement::Equals {
            measure,
            of,
            over,
            equals,
            margin,
            confidence,
        } => equal(
            bench,
            group,
            *measure,
            (of, over.as_deref()),
            (*equals, *margin),
            *confidence,
        ),
        Statement::AgreesWithExact {
            measure,
            of,
            confidence,
        } => agrees(group, *measure, of, *confidence),
        Statement::MedianModes { of, median } => group
            .outcome(of)
            .map(|outcome| median_modes(outcome, *median)),
        Statement::ShareOfModes {
            of,
            count,
            share,
            margin,
        } => group
            .outcome(of)
            .map(|outcome| share_of_modes(outcome, *count, *share, *margin)),
        Statement::BestIsNear { of, within } => best_is_near(bench, group, of, *within),
        Statement::Oracle {
            quantity,
            kernel,
            equals,
            digits,
        } => oracle(bench, group, quantity, kernel, *equals, *digits),
    };
    ruling.unwrap_or_else(|| (false, "the run has no numbers for this claim".to_owned()))
}

fn below_by(
    group: &Group,
    measure: Measure,
    (of, below): (&str, &str),
    by: f64,
    confidence: f64,
    mut random: random::Stream,
) -> Option<(bool, String)> {
    let (a, b) = (group.outcome(of)?, group.outcome(below)?);
    let mass = group.truth_integral();
    let (Some(a_values), Some(b_values)) = (
        a.per_replicate(measure, mass),
        b.per_replicate(measure, mass),
    ) else {
        let (a, b) = (
            a.measures.get(&measure)?.value,
            b.measures.get(&measure)?.value,
        );
        return Some((
            a * by <= b,
            format!(
                "{} against {}: {} times smaller",
                short(a),
                short(b),
                short(b / a)
            ),
        ));
    };
    let gains: Vec<f64> = a_values
        .iter()
        .zip(&b_values)
        .map(|(a, b)| b - by * a)
        .collect();
    let bound = lower_bound(&gains, confidence, &mut random)?;
    let ratio = compare(&b_values, &a_values, confidence);
    let error = ratio.ratio_error.unwrap_or(0.0);
    let detail = format!(
        "{} times smaller (standard error {})",
        short(ratio.ratio),
        short(error)
    );
    Some((bound > 0.0, detail))
}

fn equal(
    bench: &Bench,
    group: &Group,
    measure: Measure,
    (of, over): (&str, Option<&str>),
    (equals, margin): (f64, f64),
    confidence: f64,
) -> Option<(bool, String)> {
    let outcome = group.outcome(of)?;
    let (low, value, high) = match over {
        None => {
            let interval = outcome.interval(measure, confidence, group)?;
            (interval.low, interval.value, interval.high)
        }
        Some("minimum") => {
            let least = least_mise(bench, group, of)?;
            let interval = outcome.interval(measure, confidence, group)?;
            (
                interval.low / least,
                interval.value / least,
                interval.high / least,
            )
        }
        Some(other) => ratio(group, measure, outcome, group.outcome(other)?, confidence)?,
    };
    let inside = equals - margin <= low && high <= equals + margin;
    let band = if high > low {
        format!(" (interval {} to {})", short(low), short(high))
    } else {
        String::new()
    };
    Some((
        inside,
        format!(
            "{}{band}, expected {} ± {}",
            short(value),
            short(equals),
            short(margin)
        ),
    ))
}

/// One outcome's measure over another's, paired where both are simulated: lower end, value, upper end.
fn ratio(
    group: &Group,
    measure: Measure,
    a: &Outcome,
    b: &Outcome,
    confidence: f64,
) -> Option<(f64, f64, f64)> {
    let mass = group.truth_integral();
    if let (Some(a), Some(b)) = (
        a.per_replicate(measure, mass),
        b.per_replicate(measure, mass),
    ) {
        let paired = compare(&a, &b, confidence);
        let error = paired.ratio_error.unwrap_or(0.0);
        let interval = Interval::around(paired.ratio, error, a.len() as f64 - 1.0, confidence);
        return Some((interval.low, paired.ratio, interval.high));
    }
    let ratio = a.measures.get(&measure)?.value / b.measures.get(&measure)?.value;
    Some((ratio, ratio, ratio))
}

/// The least MISE that any bandwidth gives an estimator's kernel here, by theory.
fn least_mise(bench: &Bench, group: &Group, of: &str) -> Option<f64> {
    let spec = bench
        .experiment()
        .estimators
        .iter()
        .find(|spec| spec.name == of)?;
    let shape = spec.values.word("shape").and_then(Shape::named)?;
    let truth = bench.truth(group.source)?;
    Some(
        theory::KernelError::new(&**truth, shape)
            .optimum(group.draws as f64)
            .error
            .mise(),
    )
}

fn agrees(
    group: &Group,
    measure: Measure,
    of: &[String],
    confidence: f64,
) -> Option<(bool, String)> {
    let chosen: Vec<&Outcome> = group
        .outcomes
        .iter()
        .filter(|o| of.is_empty() || of.contains(&o.name))
        .collect();
    let exact = exact_counterpart(measure)?;
    let each = sidak(confidence, chosen.len());
    let mut outside = Vec::new();
    let mut farthest: f64 = 0.0;
    for outcome in &chosen {
        let interval = outcome.interval(measure, each, group)?;
        let exact = outcome.measures.get(&exact)?.value;
        if let Some(error) = interval.standard_error.filter(|e| *e > 0.0) {
            farthest = farthest.max((interval.value - exact).abs() / error);
        }
        if !(interval.low <= exact && exact <= interval.high) {
            let (low, high) = (short(interval.low), short(interval.high));
            outside.push(format!(
                "{}: exact {} outside {low} to {high}",
                outcome.name,
                short(exact)
            ));
        }
    }
    let detail = if outside.is_empty() {
        format!(
            "all {} exact values inside; the farthest is {} standard errors off",
            chosen.len(),
            short(farthest)
        )
    } else {
        outside.join(", ")
    };
    Some((outside.is_empty(), detail))
}

fn median_modes(outcome: &Outcome, expected: f64) -> (bool, String) {
    let mut counts: Vec<usize> = outcome.replicates.iter().map(|r| r.modes).collect();
    counts.sort_unstable();
    let (below, above) = (counts[(counts.len() - 1) / 2], counts[counts.len() / 2]);
    let median = 0.5 * (below + above) as f64;
    let percentile = |p: f64| counts[((counts.len() - 1) as f64 * p).round() as usize];
    let detail = format!(
        "median {median}, 5 to 95 %: {} to {}; expected {expected}",
        percentile(0.05),
        percentile(0.95)
    );
    ((median - expected).abs() < 1e-9, detail)
}

fn share_of_modes(outcome: &Outcome, count: usize, share: f64, margin: f64) -> (bool, String) {
    let n = outcome.replicates.len() as f64;
    let found = outcome
        .replicates
        .iter()
        .filter(|r| r.modes == count)
        .count() as f64
        / n;
    let error = (found * (1.0 - found) / n).sqrt();
    let detail = format!(
        "{} of the samples (standard error {}), expected {share} ± {margin}",
        short(found),
        short(error)
    );
    ((found - share).abs() <= margin, detail)
}

fn best_is_near(bench: &Bench, group: &Group, of: &str, within: f64) -> Option<(bool, String)> {
    let experiment = bench.experiment();
    let curve = swept(experiment, group, of, Measure::Mise);
    let (simulated, _) = lowest(&curve)?;
    let spec = experiment
        .estimators
        .iter()
        .find(|spec| spec.sweep.as_ref().is_some_and(|sweep| sweep.group == of))?;
    let shape = spec.values.word("shape").and_then(Shape::named)?;
    let exact = theory::KernelError::new(&**bench.truth(group.source)?, shape)
        .optimum(group.draws as f64)
        .at;
    let apart = (simulated / exact - 1.0).abs();
    let detail = format!(
        "simulated optimum {}, exact {}: {} % apart",
        short(simulated),
        short(exact),
        short(100.0 * apart)
    );
    Some((apart <= within, detail))
}

/// (parameter, value) of a measure along a sweep, ascending.
pub fn swept(
    experiment: &Experiment,
    group: &Group,
    of: &str,
    measure: Measure,
) -> Vec<(f64, f64)> {
    let mut curve: Vec<(f64, f64)> = experiment
        .estimators
        .iter()
        .zip(&group.outcomes)
        .filter_map(|(spec, outcome)| {
            let sweep = spec.sweep.as_ref().filter(|sweep| sweep.group == of)?;
            Some((sweep.value, outcome.measures.get(&measure)?.value))
        })
        .collect();
    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
    curve
}

/// The minimum of a sampled curve: of the parabola through its lowest point and the two beside it, in the logarithm of the parameter.
fn lowest(curve: &[(f64, f64)]) -> Option<(f64, f64)> {
    let best = (0..curve.len()).min_by(|&a, &b| curve[a].1.total_cmp(&curve[b].1))?;
    if best == 0 || best + 1 == curve.len() {
        return None;
    }
    let [(a, fa), (b, fb), (c, fc)] =
        [curve[best - 1], curve[best], curve[best + 1]].map(|(h, m)| (h.ln(), m));
    let (left, right) = ((b - a) * (fb - fc), (b - c) * (fb - fa));
    let vertex = b - 0.5 * ((b - a) * left - (b - c) * right) / (left - right);
    Some((
        if vertex.is_finite() {
            vertex.exp()
        } else {
            b.exp()
        },
        fb,
    ))
}

fn oracle(
    bench: &Bench,
    group: &Group,
    quantity: &str,
    kernel: &str,
    equals: f64,
    digits: u32,
) -> Option<(bool, String)> {
    let truth = bench.truth(group.source)?;
    let oracle =
        theory::KernelError::new(&**truth, Shape::named(kernel)?).oracle(group.draws as f64);
    let best = &oracle.optimum;
    let asymptotic = oracle.asymptotic.ok();
    let found = match quantity {
        "h_mise" => best.at,
        "mise" => best.error.mise(),
        "bias2" => best.error.squared_bias,
        "variance" => best.error.variance,
        "h_amise" => asymptotic?.best(),
        "amise" => {
            let asymptotic = asymptotic?;
            asymptotic.at(asymptotic.best()).mise()
        }
        _ => return None,
    };
    // half a unit in the last digit that is claimed
    let unit = 10.0_f64.powi(equals.abs().log10().floor() as i32 - digits as i32 + 1);
    Some((
        (found - equals).abs() <= 0.5 * unit * (1.0 + 1e-9),
        format!("{quantity} is {found:.8}, expected {equals}"),
    ))
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
    use super::{lowest, short};

    #[test]
    fn numbers_in_sentences_have_four_digits() {
        assert_eq!(short(2.839_71), "2.84");
        assert_eq!(short(0.004_570_4), "0.00457");
        assert_eq!(short(12_345.6), "12346");
        assert_eq!(short(1.0), "1");
        assert_eq!(short(1.234_56e-9), "1.235e-9");
        assert_eq!(short(-0.5), "-0.5");
    }

    #[test]
    fn the_parabola_finds_the_place_between_samples() {
        let curve: Vec<(f64, f64)> = [0.1, 0.2, 0.3, 0.5, 0.9]
            .iter()
            .map(|&h: &f64| (h, (h.ln() - 0.25_f64.ln()).powi(2)))
            .collect();
        let (place, _) = lowest(&curve).expect("inside");
        assert!((place - 0.25).abs() < 1e-12, "{place}");
        assert!(lowest(&curve[2..]).is_none());
    }
}
