//! Statements of uncertainty that are too sure or not sure enough.

use super::Fault;
use crate::accuracy::Interval;
use crate::doctor::subjects::BATCHES;
use crate::estimator::Estimator;
use crate::numeric::special::normal_quantile;
use crate::sample::Sample;
use crate::space::Targets;
use crate::uncertainty::{ErrorEstimate, Halves, Split, UncertaintyError};
use std::sync::Arc;

/// Even photons, odd photons.
pub const PARITY_SPLIT: Fault = Fault {
    name: "parity-split",
    summary: "batches are made of hits, not of paths",
    caught_by: "halves-by-path",
    plant: |subjects| {
        subjects.halves = Arc::new(Halves {
            batches: BATCHES,
            split: Split::Point,
        });
    },
};

/// Squared errors times a number.
struct Times(f64, Arc<dyn ErrorEstimate<1>>);

impl ErrorEstimate<1> for Times {
    fn squared(
        &self,
        estimator: &dyn Estimator<1>,
        sample: &Sample<1>,
        targets: Targets<'_, 1>,
    ) -> Result<Vec<f64>, UncertaintyError> {
        let mut squared = self.1.squared(estimator, sample, targets)?;
        for value in &mut squared {
            *value *= self.0;
        }
        Ok(squared)
    }
}

/// The misprint: ½ (var f̂A + var f̂B).
pub const HALF_FOR_QUARTER: Fault = Fault {
    name: "half-for-quarter",
    summary: "the variance of the mean of two halves is ½ (var A + var B), not ¼",
    caught_by: "halves",
    plant: |subjects| subjects.halves = Arc::new(Times(2.0, subjects.halves.clone())),
};

/// 1/B for 1/(B - 1).
pub const BIASED_BATCHES: Fault = Fault {
    name: "biased-batches",
    summary: "squared deviations of B batches are divided by B, not B - 1",
    caught_by: "halves",
    plant: |subjects| {
        let times = (BATCHES as f64 - 1.0) / BATCHES as f64;
        subjects.halves = Arc::new(Times(times, subjects.halves.clone()));
    },
};

/// An interval shortened.
fn shorter(interval: Interval, times: f64) -> Interval {
    Interval {
        low: interval.value + times * (interval.low - interval.value),
        high: interval.value + times * (interval.high - interval.value),
        ..interval
    }
}

/// 1/n for 1/(n - 1).
pub const BIASED_VARIANCE: Fault = Fault {
    name: "biased-variance",
    summary: "an interval rests on the variance with n for n - 1",
    caught_by: "interval-coverage",
    plant: |subjects| {
        let right = subjects.interval.clone();
        subjects.interval = Arc::new(move |values, confidence| {
            let n = values.len() as f64;
            shorter(right(values, confidence), ((n - 1.0) / n).sqrt())
        });
    },
};

/// 1.96 whatever n is.
pub const NORMAL_FOR_STUDENT: Fault = Fault {
    name: "normal-for-student",
    summary: "an interval of five values takes 1.96 standard errors, not 2.78",
    caught_by: "interval-coverage",
    plant: |subjects| {
        let right = subjects.interval.clone();
        subjects.interval = Arc::new(move |values, confidence| {
            let interval = right(values, confidence);
            let error = interval.standard_error.unwrap_or(0.0);
            let reach = normal_quantile(0.5 + 0.5 * confidence) * error;
            Interval {
                low: interval.value - reach,
                high: interval.value + reach,
                ..interval
            }
        });
    },
};
