//! Claims about how many modes estimates show.

use super::short;
use crate::experiment::results::Outcome;

pub(super) fn median_modes(outcome: &Outcome, expected: f64) -> (bool, String) {
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

pub(super) fn share_of_modes(
    outcome: &Outcome,
    count: usize,
    share: f64,
    margin: f64,
) -> (bool, String) {
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
