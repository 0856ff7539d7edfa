//! Claims about how often intervals hold what they are about.

use super::short;
use crate::accuracy::share_interval;
use crate::experiment::results::Group;

/// Whether the whole interval for the share of intervals about estimates that hold the mean, or the truth, lies within the margin of what is expected.
pub(super) fn covers<const D: usize>(
    group: &Group<D>,
    of: &str,
    (at, truth): (&[f64], bool),
    (expected, margin): (f64, f64),
    confidence: f64,
) -> Option<(bool, String)> {
    let coverage = group.outcome(of)?.coverage.as_ref()?;
    let distance = |i: usize| -> f64 {
        let place = group.grid.centre(i);
        place.iter().zip(at).map(|(x, y)| (x - y).powi(2)).sum()
    };
    let nearest = (0..group.grid.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?;
    let held = if truth {
        &coverage.truth
    } else {
        &coverage.mean
    };
    let (held, count) = (*held.get(nearest)? as usize, coverage.count as usize);
    let interval = share_interval(held, count, confidence);
    let place = group.place(nearest);
    let detail = format!(
        "at {place} in {} of the samples (interval {} to {}), expected {} ± {margin}",
        short(interval.value),
        short(interval.low),
        short(interval.high),
        short(expected)
    );
    let holds = expected - margin <= interval.low && interval.high <= expected + margin;
    Some((holds, detail))
}
