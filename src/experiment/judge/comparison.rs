//! Claims that compare errors: with each other, with a value, with theory.

use super::short;
use crate::accuracy::{Interval, compare, lower_bound, sidak};
use crate::experiment::Measure;
use crate::experiment::results::{Group, Outcome};
use crate::experiment::run::Bench;
use crate::experiment::table::exact_counterpart;
use crate::random;

pub(super) fn below_by<const D: usize>(
    ((group, of), (other, below)): ((&Group<D>, &str), (&Group<D>, &str)),
    measure: Measure,
    by: f64,
    confidence: f64,
    mut random: random::Stream,
) -> Option<(bool, String)> {
    let (a, b) = (group.outcome(of)?, other.outcome(below)?);
    let (Some(a_values), Some(b_values)) = (
        a.per_replicate(measure, group.truth_integral()),
        b.per_replicate(measure, other.truth_integral()),
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

pub(super) fn equal<const D: usize>(
    bench: &Bench<D>,
    (group, of): (&Group<D>, &str),
    over: Option<(&Group<D>, &str)>,
    measure: Measure,
    (equals, margin): (f64, f64),
    confidence: f64,
) -> Option<(bool, String)> {
    let outcome = group.outcome(of)?;
    let (low, value, high) = match over {
        None => {
            let interval = outcome.interval(measure, confidence, group)?;
            (interval.low, interval.value, interval.high)
        }
        // the least MISE is over the whole line, the measured one over the grid: they compare only where the grid holds all
        Some((_, "minimum")) if group.truth_integral() < 0.999 => {
            return Some((
                false,
                "the grid is too narrow to compare with the least MISE over the whole line"
                    .to_owned(),
            ));
        }
        Some((_, "minimum")) => {
            let least = least_mise(bench, group, of)?;
            let interval = outcome.interval(measure, confidence, group)?;
            (
                interval.low / least,
                interval.value / least,
                interval.high / least,
            )
        }
        Some((other, over)) => {
            let divisor = (other, other.outcome(over)?);
            ratio(measure, (group, outcome), divisor, confidence)?
        }
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
fn ratio<const D: usize>(
    measure: Measure,
    (group, a): (&Group<D>, &Outcome),
    (other, b): (&Group<D>, &Outcome),
    confidence: f64,
) -> Option<(f64, f64, f64)> {
    if let (Some(a), Some(b)) = (
        a.per_replicate(measure, group.truth_integral()),
        b.per_replicate(measure, other.truth_integral()),
    ) {
        let paired = compare(&a, &b, confidence);
        let error = paired.ratio_error.unwrap_or(0.0);
        let interval = Interval::around(paired.ratio, error, a.len() as f64 - 1.0, confidence);
        return Some((interval.low, paired.ratio, interval.high));
    }
    let ratio = a.measures.get(&measure)?.value / b.measures.get(&measure)?.value;
    Some((ratio, ratio, ratio))
}

/// The least MISE that any bandwidth or width gives an estimator here, by theory.
fn least_mise<const D: usize>(bench: &Bench<D>, group: &Group<D>, of: &str) -> Option<f64> {
    let estimators = &bench.experiment().estimators;
    let number = estimators.iter().position(|spec| spec.name == of)?;
    Some(
        bench
            .best_of_family(group.source, group.size, number)?
            .error
            .mise(),
    )
}

pub(super) fn agrees<const D: usize>(
    group: &Group<D>,
    measure: Measure,
    of: &[String],
    confidence: f64,
) -> Option<(bool, String)> {
    let chosen = group.outcomes_of(of);
    let exact = exact_counterpart(measure)?;
    let each = sidak(confidence, chosen.len());
    let mut outside = Vec::new();
    let mut farthest: f64 = 0.0;
    for outcome in &chosen {
        let interval = outcome.interval(measure, each, group)?;
        let Some(exact) = outcome.measures.get(&exact).map(|exact| exact.value) else {
            return Some((
                false,
                format!("there is no exact value for {}", outcome.name),
            ));
        };
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
