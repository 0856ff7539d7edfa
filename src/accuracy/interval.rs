//! Confidence intervals for means, medians and shares over replicates.
//!
//! # References
//! Clopper & Pearson 1934, The use of confidence or fiducial limits illustrated in the case of the binomial, Biometrika 26; Wilson 1927, Probable
//! inference, Journal of the American Statistical Association 22; Conover 1999, Practical Nonparametric Statistics, section 3.2 (quantiles).

use crate::numeric::special::normal_quantile;
use crate::numeric::{Sum, root};
use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::beta::beta_reg;

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

/// From here on the continued fraction of the binomial distribution does not converge any more, and its normal limit is better than 1 % of the interval.
const MANY: f64 = 5000.0;

/// The two-sided interval for a probability of which `hits` of `trials` independent trials came out: at least `confidence` whatever the probability.
/// [Clopper & Pearson 1934] Where hits and misses are both many it is Wilson's score interval, which is the same to 1 % of its length.
///
/// # Panics
/// If there are no trials, or more hits than trials.
pub fn share_interval(hits: usize, trials: usize, confidence: f64) -> Interval {
    assert!(
        0 < trials && hits <= trials,
        "{hits} hits in {trials} trials"
    );
    let (k, n) = (hits as f64, trials as f64);
    let share = k / n;
    let tail = 0.5 - 0.5 * confidence;
    let (low, high) = if k.min(n - k) > MANY {
        let z = normal_quantile(1.0 - tail);
        let centre = share + z * z / (2.0 * n);
        let reach = z * (share * (1.0 - share) / n + (z / (2.0 * n)).powi(2)).sqrt();
        let scale = 1.0 + z * z / n;
        ((centre - reach) / scale, (centre + reach) / scale)
    } else {
        // P(k or more) falls to the tail at the lower end, P(k or fewer) at the upper one
        let solve = |f: &dyn Fn(f64) -> f64, end: f64| root(f, 0.0, 1.0).unwrap_or(end);
        let low = if hits == 0 {
            0.0
        } else {
            solve(&|p| beta_reg(k, n - k + 1.0, p) - tail, 0.0)
        };
        let high = if hits == trials {
            1.0
        } else {
            solve(&|p| beta_reg(n - k, k + 1.0, 1.0 - p) - tail, 1.0)
        };
        (low, high)
    };
    Interval {
        value: share,
        standard_error: Some((share * (1.0 - share) / n).sqrt()),
        low: low.min(share),
        high: high.max(share),
    }
}

/// The two-sided interval for the median of what `sorted` values were drawn from: two of the values themselves, so that nothing is assumed of the
/// distribution, and ties only make it safer. [Conover 1999, section 3.2] `None` where even the least and the greatest value do not enclose it with
/// that confidence: [`fewest_for_median`] says how many values do.
///
/// # Panics
/// If there are no values.
pub fn median_interval(sorted: &[f64], confidence: f64) -> Option<Interval> {
    let n = sorted.len();
    assert!(n > 0, "a median needs values");
    let reach = order(n, confidence)?;
    Some(Interval {
        value: 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]),
        standard_error: None,
        low: sorted[reach - 1],
        high: sorted[n - reach],
    })
}

/// The greatest r ≥ 1 for which the r-th least and the r-th greatest of `n` values enclose the median with `confidence`.
fn order(n: usize, confidence: f64) -> Option<usize> {
    let tail = 0.5 - 0.5 * confidence;
    let trials = n as f64;
    // P(fewer than r of n values are below the median)
    let missed = |r: usize| beta_reg(trials - r as f64 + 1.0, r as f64, 0.5);
    let greatest = if trials > 2.0 * MANY {
        let z = normal_quantile(1.0 - tail);
        (0.5 * (trials + 1.0 - z * trials.sqrt())) as usize
    } else {
        // the first of 1, 2, .. that misses too often, by bisection
        let (mut low, mut high) = (0, n / 2 + 1);
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if missed(middle) <= tail {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    };
    (greatest > 0).then_some(greatest)
}

/// How many values a median needs for an interval of that confidence: 2^(1 - n) must not be more than what is left of it.
pub fn fewest_for_median(confidence: f64) -> usize {
    (1.0 - (1.0 - confidence).log2()).ceil() as usize
}

/// The confidence that each of `members` intervals needs so that all hold together with `confidence`. [Šidák 1967]
pub fn sidak(confidence: f64, members: usize) -> f64 {
    confidence.powf(1.0 / members.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::{
        MANY, fewest_for_median, mean_interval, median_interval, order, share_interval, sidak,
    };
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

    #[test]
    fn share_intervals_agree_with_tables_and_with_their_definition() {
        // Clopper & Pearson 95 % for 8 of 20, by R's binom.test
        let interval = share_interval(8, 20, 0.95);
        assert!((interval.low - 0.191_190).abs() < 1e-6, "{interval:?}");
        assert!((interval.high - 0.639_457).abs() < 1e-6, "{interval:?}");
        // no hits: the upper end is 1 - (tail)^(1/n), the rule of three
        let none = share_interval(0, 50, 0.95);
        assert!(
            none.low.to_bits() == 0 && (none.high - (1.0 - 0.025_f64.powf(0.02))).abs() < 1e-12
        );
        let all = share_interval(50, 50, 0.95);
        assert!((all.low - 0.025_f64.powf(0.02)).abs() < 1e-12 && (all.high - 1.0).abs() < 1e-15);
    }

    #[test]
    fn share_intervals_never_cover_less_than_they_say() {
        // exactly, by summing the binomial distribution: no chance in this test
        let n = 60;
        let intervals: Vec<_> = (0..=n).map(|k| share_interval(k, n, 0.95)).collect();
        let (mut least, mut short) = (1.0_f64, 1.0_f64);
        for step in 1..200 {
            let p = f64::from(step) / 200.0;
            let mut mass = (1.0 - p).powi(n as i32);
            let (mut covered, mut covered_by_short) = (0.0, 0.0);
            for (k, interval) in intervals.iter().enumerate() {
                covered += if interval.low <= p && p <= interval.high {
                    mass
                } else {
                    0.0
                };
                let near = (p - interval.value).abs() <= 0.9 * (interval.high - interval.value);
                covered_by_short += if near { mass } else { 0.0 };
                mass *= (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
            }
            least = least.min(covered);
            short = short.min(covered_by_short);
        }
        assert!(least >= 0.95, "{least}");
        assert!(short < 0.95, "the planted fault passed: {short}");
    }

    #[test]
    fn many_trials_go_over_into_the_score_interval_without_a_step() {
        let n = 4 * MANY as usize;
        let exact = share_interval(MANY as usize, n, 0.99);
        let score = share_interval(MANY as usize + 1, n, 0.99);
        let step = 1.0 / n as f64;
        let length = exact.high - exact.low;
        assert!((score.low - exact.low - step).abs() < 0.01 * length);
        assert!((score.high - exact.high - step).abs() < 0.01 * length);
    }

    #[test]
    fn the_median_lies_between_two_values_as_often_as_it_says() {
        // Conover's table: of 20 values the 6th and the 15th at 95 %
        assert_eq!(order(20, 0.95), Some(6));
        // P(miss) of the r-th of n, summed as written
        for (n, confidence) in [(8, 0.99), (30, 0.95), (101, 0.99), (1000, 0.9)] {
            let r = order(n, confidence).expect("enough");
            let miss = |r: usize| {
                let (mut mass, mut sum) = (0.5_f64.powi(n as i32), 0.0);
                for k in 0..r {
                    sum += mass;
                    mass *= (n - k) as f64 / (k + 1) as f64;
                }
                2.0 * sum
            };
            assert!(miss(r) <= 1.0 - confidence + 1e-12, "{n}");
            assert!(miss(r + 1) > 1.0 - confidence, "{n}: could be shorter");
        }
        // without a step where the normal limit takes over
        let (before, after) = (
            order(10_000, 0.99).expect("many"),
            order(10_002, 0.99).expect("many"),
        );
        assert!(after - before <= 2, "{before} {after}");
    }

    #[test]
    fn few_values_have_no_median_interval() {
        for confidence in [0.9, 0.95, 0.99, 0.9999] {
            let fewest = fewest_for_median(confidence);
            let values: Vec<f64> = (0..fewest).map(|i| i as f64).collect();
            let interval = median_interval(&values, confidence).expect("enough");
            assert!(interval.low.to_bits() == 0, "{interval:?}");
            assert!(median_interval(&values[1..], confidence).is_none());
        }
    }
}
