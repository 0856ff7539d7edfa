//! Comparing two estimators that saw the same samples.
//!
//! # References
//! Efron & Tibshirani 1993, An Introduction to the Bootstrap, section 12.5 (bootstrap-t).

use super::{Interval, mean_interval};
use crate::random::Stream;
use rand::RngExt;

/// The comparison of a quantity of A with that of B on the same replicates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paired {
    /// The mean of A - B with its paired interval.
    pub difference: Interval,
    /// mean A / mean B.
    pub ratio: f64,
    /// The standard error of the ratio, by linearisation.
    pub ratio_error: Option<f64>,
}

/// Compares replicate by replicate, two-sided intervals at `confidence`.
///
/// # Panics
/// If the lists are empty or of different lengths: they are not pairs then.
pub fn compare(a: &[f64], b: &[f64], confidence: f64) -> Paired {
    assert!(!a.is_empty() && a.len() == b.len(), "pairs");
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let n = a.len() as f64;
    let (mean_a, mean_b) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
    let ratio = mean_a / mean_b;
    // var(ā/b̄) ≈ var(mean of aᵢ - ratio·bᵢ) / b̄²
    let residuals: Vec<f64> = a
        .iter()
        .zip(b)
        .map(|(a, b)| (a - ratio * b) / mean_b)
        .collect();
    let ratio_error = mean_interval(&residuals, confidence).standard_error;
    Paired {
        difference: mean_interval(&differences, confidence),
        ratio,
        ratio_error,
    }
}

/// The one-sided lower confidence bound for the mean of `values` by the bootstrap-t, which does not lean on the normality that
/// squared errors of few replicates lack. `None` for fewer than two values.
pub fn lower_bound(values: &[f64], confidence: f64, random: &mut Stream) -> Option<f64> {
    const RESAMPLES: usize = 1999;
    let whole = mean_interval(values, confidence);
    let error = whole.standard_error?;
    if error <= 0.0 {
        return Some(whole.value);
    }
    let mut drawn = vec![0.0; values.len()];
    let mut studentised: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            drawn.fill_with(|| values[random.random_range(0..values.len())]);
            let again = mean_interval(&drawn, confidence);
            match again.standard_error {
                Some(e) if e > 0.0 => (again.value - whole.value) / e,
                // a resample of one value repeated: no evidence, the extreme
                _ => f64::INFINITY,
            }
        })
        .collect();
    studentised.sort_by(f64::total_cmp);
    let rank = ((RESAMPLES + 1) as f64 * confidence).ceil() as usize;
    Some(whole.value - error * studentised[rank.clamp(1, RESAMPLES) - 1])
}

#[cfg(test)]
mod tests {
    use super::{compare, lower_bound};
    use crate::random::stream;
    use rand::RngExt;

    #[test]
    fn pairing_removes_what_is_common() {
        let common: Vec<f64> = (0..50).map(|i| f64::from(i % 7)).collect();
        let a: Vec<f64> = common.iter().map(|c| c + 0.1).collect();
        let paired = compare(&a, &common, 0.99);
        assert!((paired.difference.value - 0.1).abs() < 1e-12);
        assert!(paired.difference.high - paired.difference.low < 1e-10);
    }

    #[test]
    fn the_bound_covers_skewed_means_as_often_as_it_says() {
        let mut random = stream(11, "bound", 0);
        let trials = 600;
        let below = (0..trials)
            .filter(|_| {
                // exponential: mean 1, skewed as squared errors are
                let values: Vec<f64> = (0..60)
                    .map(|_| -(1.0 - random.random::<f64>()).ln())
                    .collect();
                lower_bound(&values, 0.95, &mut random).is_some_and(|bound| bound <= 1.0)
            })
            .count() as f64;
        let margin = 4.0 * (0.95 * 0.05 / f64::from(trials)).sqrt();
        assert!(
            (below / f64::from(trials) - 0.95).abs() < margin,
            "{below} of {trials}"
        );
    }
}
