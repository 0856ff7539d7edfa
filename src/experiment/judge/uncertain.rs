//! Claims about estimates of the error.

use super::short;
use crate::experiment::Experiment;
use crate::experiment::results::Group;
use crate::experiment::uncertainty::Quantity;

/// Whether the interval of a quantity lies within the margin of what is expected, or above a bound.
pub(super) fn uncertainty<const D: usize>(
    experiment: &Experiment,
    group: &Group<D>,
    (of, by): (&str, &str),
    quantity: Quantity,
    (equals, above): (Option<(f64, f64)>, Option<f64>),
    confidence: f64,
) -> Option<(bool, String)> {
    let at = experiment
        .uncertainties
        .iter()
        .position(|it| it.name == by)?;
    let outcome = group.outcome(of)?;
    let interval = outcome.uncertainty(at, quantity, confidence, group)?;
    if interval.standard_error.is_none() {
        return Some((false, "too few replicates for an interval".to_owned()));
    }
    let mut holds = true;
    let mut detail = format!(
        "{} {} (interval {} to {})",
        quantity.name(),
        short(interval.value),
        short(interval.low),
        short(interval.high)
    );
    if let Some((expected, margin)) = equals {
        holds &= expected - margin <= interval.low && interval.high <= expected + margin;
        detail = format!("{detail}, expected {} ± {}", short(expected), short(margin));
    }
    if let Some(bound) = above {
        holds &= interval.low >= bound;
        detail = format!("{detail}, to be above {}", short(bound));
    }
    Some((holds, detail))
}
