//! Claims about how much worse an estimator is than another on the same samples: medians, which a few unlucky samples do not move.

use super::short;
use crate::accuracy::{fewest_for_median, median_interval};
use crate::experiment::Measure;
use crate::experiment::results::{Group, Outcome};

/// Whether the interval of the median of ISE(of) / ISE(over) lies within the margin of the expected one, and that of ISE(of) / ISE(below) below 1.
pub(super) fn regret<const D: usize>(
    group: &Group<D>,
    (of, over): (&str, &str),
    (expected, margin): (f64, f64),
    below: Option<&str>,
    confidence: f64,
) -> Option<(bool, String)> {
    let own = group.outcome(of)?;
    let regrets = ratios(group, own, group.outcome(over)?)?;
    let too_few = || {
        let needed = fewest_for_median(confidence);
        Some((
            false,
            format!("the median needs {needed} samples for an interval at confidence {confidence}"),
        ))
    };
    let Some(interval) = median_interval(&regrets, confidence) else {
        return too_few();
    };
    let mean = regrets.iter().sum::<f64>() / regrets.len() as f64;
    let mut detail = format!(
        "median {} (interval {} to {}; mean {}), expected {} ± {}",
        short(interval.value),
        short(interval.low),
        short(interval.high),
        short(mean),
        short(expected),
        short(margin)
    );
    let mut holds = expected - margin <= interval.low && interval.high <= expected + margin;
    if let Some(below) = below {
        let against = ratios(group, own, group.outcome(below)?)?;
        let Some(interval) = median_interval(&against, confidence) else {
            return too_few();
        };
        holds &= interval.high < 1.0;
        detail = format!(
            "{detail}; against {below} {} (interval {} to {})",
            short(interval.value),
            short(interval.low),
            short(interval.high)
        );
    }
    Some((holds, detail))
}

/// The ratios of the errors, ascending.
fn ratios<const D: usize>(group: &Group<D>, of: &Outcome, over: &Outcome) -> Option<Vec<f64>> {
    let mass = group.truth_integral();
    let errors = |outcome: &Outcome| outcome.per_replicate(Measure::Mise, mass);
    let mut ratios: Vec<f64> = errors(of)?
        .iter()
        .zip(errors(over)?)
        .map(|(of, over)| of / over)
        .collect();
    ratios.sort_by(f64::total_cmp);
    Some(ratios)
}
