//! Confidence intervals for means over replicates.

use crate::numeric::Sum;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// A mean with its standard error and a two-sided confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The mean.
    pub value: f64,
    /// Its standard error; `None` for a single replicate.
    pub standard_error: Option<f64>,
    /// The lower end; the value itself where there is no standard error.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Interval {
    /// value ± t × standard error with Student's t of `freedom` degrees of freedom.
    pub fn around(value: f64, standard_error: f64, freedom: f64, confidence: f64) -> Self {
        let reach = t_quantile(freedom, 0.5 + 0.5 * confidence) * standard_error;
        Self {
            value,
            standard_error: Some(standard_error),
            low: value - reach,
            high: value + reach,
        }
    }

    /// A value known exactly.
    pub fn exact(value: f64) -> Self {
        Self {
            value,
            standard_error: None,
            low: value,
            high: value,
        }
    }
}

/// The p-quantile of Student's t.
fn t_quantile(freedom: f64, p: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(p))
}

/// The mean of `values` with its Student interval. [the central limit theorem over independent replicates]
///
/// # Panics
/// If there are no values.
pub fn mean_interval(values: &[f64], confidence: f64) -> Interval {
    assert!(!values.is_empty(), "a mean needs values");
    let n = values.len() as f64;
    let mean = values.iter().copied().collect::<Sum>().value() / n;
    if values.len() < 2 {
        return Interval::exact(mean);
    }
    let squares = values
        .iter()
        .map(|v| (v - mean).powi(2))
        .collect::<Sum>()
        .value();
    Interval::around(mean, (squares / (n - 1.0) / n).sqrt(), n - 1.0, confidence)
}

/// The confidence that each of `members` intervals needs so that all hold together with `confidence`. [Šidák 1967]
pub fn sidak(confidence: f64, members: usize) -> f64 {
    confidence.powf(1.0 / members.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::{mean_interval, sidak};
    use crate::random::stream;
    use rand::RngExt;

    #[test]
    fn student_interval_agrees_with_tables() {
        // mean 2, sd 1, n = 3: half-width 4.302653 / √3
        let interval = mean_interval(&[1.0, 2.0, 3.0], 0.95);
        assert!(
            (interval.high - interval.value - 4.302_652_73 / 3.0_f64.sqrt()).abs() < 1e-6,
            "{interval:?}"
        );
    }

    #[test]
    fn coverage_is_nominal_and_a_short_interval_is_caught() {
        let mut random = stream(7, "coverage", 0);
        let trials = 4000;
        let (mut hit, mut short) = (0.0, 0.0);
        for _ in 0..trials {
            let values: Vec<f64> = (0..30).map(|_| random.random::<f64>()).collect();
            let interval = mean_interval(&values, 0.95);
            hit += f64::from(u8::from(interval.low <= 0.5 && 0.5 <= interval.high));
            let reach = 0.9 * (interval.high - interval.value);
            short += f64::from(u8::from((interval.value - 0.5).abs() <= reach));
        }
        // 4 standard errors of a proportion at 0.95
        let margin = 4.0 * (0.95 * 0.05 / f64::from(trials)).sqrt();
        assert!(
            (hit / f64::from(trials) - 0.95).abs() < margin,
            "covered {hit} of {trials}"
        );
        assert!(
            (short / f64::from(trials) - 0.95).abs() > margin,
            "the planted fault passed: {short} of {trials}"
        );
    }

    #[test]
    fn sidak_of_one_is_itself() {
        assert!((sidak(0.99, 1) - 0.99).abs() < 1e-15);
        assert!((sidak(0.99, 3).powi(3) - 0.99).abs() < 1e-15);
    }
}
