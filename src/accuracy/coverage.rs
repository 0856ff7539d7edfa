//! Intervals about an estimate at each place, and how often they hold what they are about.
//!
//! f̂ ± z √(estimated variance) is an interval for **E f̂**, the density as the estimator smooths it, not for f: it knows nothing of the bias. With b the bias in units of the
//! deviation, it holds f with probability Φ(z - b) - Φ(-z - b) instead of Φ(z) - Φ(-z), as far as f̂ is normal.
//!
//! # References
//! Hall 1992, Effect of bias estimation on coverage accuracy of bootstrap confidence intervals for a probability density, Annals of Statistics 20 (undersmoothing);
//! Wasserman 2006, All of Nonparametric Statistics, section 6.5.

use crate::numeric::special::{normal_distribution, normal_quantile};
use serde::{Deserialize, Serialize};

/// The half length of a two-sided interval of this confidence, in deviations.
pub fn reach(confidence: f64) -> f64 {
    normal_quantile(0.5 + 0.5 * confidence)
}

/// The probability that an interval of that half length about a normal estimate holds a value that is `bias` away from its mean; all in deviations.
pub fn coverage_with_bias(reach: f64, bias: f64) -> f64 {
    normal_distribution(reach - bias) - normal_distribution(-reach - bias)
}

/// How many intervals held the mean of the estimate and the truth at each place, over replicates. Counts, so that merging is exact.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Coverage {
    /// Intervals at each place.
    pub count: u64,
    /// How many held E f̂; empty where it is not known.
    pub mean: Vec<u64>,
    /// How many held f; empty where it is not known.
    pub truth: Vec<u64>,
}

/// How many of them are there now.
fn note(held: &mut Vec<u64>, estimate: &[f64], half: &[f64], target: &[f64]) {
    held.resize(estimate.len(), 0);
    for (i, count) in held.iter_mut().enumerate() {
        *count += u64::from((estimate[i] - target[i]).abs() <= half[i]);
    }
}

impl Coverage {
    /// Notes one estimate with the half length of its interval at each place.
    ///
    /// # Panics
    /// If what is given is not one number a place.
    pub fn add(
        &mut self,
        estimate: &[f64],
        half: &[f64],
        mean: Option<&[f64]>,
        truth: Option<&[f64]>,
    ) {
        assert_eq!(estimate.len(), half.len(), "one interval a place");
        self.count += 1;
        if let Some(mean) = mean {
            note(&mut self.mean, estimate, half, mean);
        }
        if let Some(truth) = truth {
            note(&mut self.truth, estimate, half, truth);
        }
    }

    /// Takes in other replicates.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        for (held, more) in [
            (&mut self.mean, &other.mean),
            (&mut self.truth, &other.truth),
        ] {
            held.resize(more.len().max(held.len()), 0);
            for (count, more) in held.iter_mut().zip(more) {
                *count += more;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_that_hold_their_target_are_counted() {
        let mut coverage = Coverage::default();
        coverage.add(&[1.0, 2.0], &[0.1, 0.1], Some(&[1.05, 2.2]), None);
        let mut other = Coverage::default();
        other.add(&[1.0, 2.0], &[0.1, 0.3], Some(&[1.05, 2.2]), None);
        coverage.merge(&other);
        assert_eq!((coverage.count, &coverage.mean[..]), (2, &[2, 1][..]));
        assert!(coverage.truth.is_empty());
    }

    #[test]
    fn bias_takes_coverage_away() {
        let z = reach(0.95);
        assert!((z - 1.959_964).abs() < 1e-6);
        assert!((coverage_with_bias(z, 0.0) - 0.95).abs() < 1e-12);
        // one deviation of bias, from tables of the normal distribution
        assert!((coverage_with_bias(z, 1.0) - 0.829_9).abs() < 1e-3);
        assert!((coverage_with_bias(z, 1.0) - coverage_with_bias(z, -1.0)).abs() < 1e-12);
    }
}
