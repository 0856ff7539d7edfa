//! What a check found: p-values of its comparisons, and how small an error each would have noticed.

use super::{POWER, check_level};
use crate::accuracy::chance::{detectable, two_sided};
use crate::numeric::Sum;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// One comparison.
struct Part {
    p_value: f64,
    /// The standard error relative to what was expected; for a comparison without chance the tolerance.
    scale: f64,
    chance: bool,
    /// In words.
    told: String,
}

/// Comparisons of what was found with what was expected, as they come.
#[derive(Default)]
pub struct Evidence {
    parts: Vec<Part>,
}

/// What a check found.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The chance of something at least as far from what was expected, over all comparisons (Bonferroni); 0 or 1 where no chance is involved.
    pub p_value: f64,
    /// The relative error that every comparison of the check finds with probability [`POWER`].
    pub detectable: f64,
    /// The comparison that came out worst.
    pub detail: String,
}

impl Finding {
    /// Whether the check failed.
    pub fn is_alarm(&self) -> bool {
        self.p_value <= check_level()
    }
}

impl Evidence {
    /// A mean over independent replicates.
    ///
    /// Squared errors and squared deviations are skew, and the t statistic of their mean then is too: too often far below, too seldom far above. Hall's
    /// transformation takes that out, g(t) = t + γt²/3 + γ²t³/27 + γ/6 with γ the skewness over √n, which keeps the order of all t. \[Hall 1992, eq. 2.2\] Its
    /// spread is an estimate as well, so that it is held against Student's distribution.
    pub fn mean(&mut self, of: &str, values: &[f64], expected: f64) {
        let n = values.len() as f64;
        let mean = values.iter().copied().collect::<Sum>().value() / n;
        let moment = |power: i32| {
            let terms = values.iter().map(|v| (v - mean).powi(power));
            terms.collect::<Sum>().value() / n
        };
        let variance = moment(2) * n / (n - 1.0);
        let error = (variance / n).sqrt();
        self.value(of, mean, error, expected);
        let Some(part) = self.parts.last_mut().filter(|_| error > 0.0) else {
            return;
        };
        let t = (mean - expected) / error;
        let skew = moment(3) / variance.powf(1.5) / n.sqrt();
        let symmetric = t + skew * t * t / 3.0 + (skew * t).powi(2) * t / 27.0 + skew / 6.0;
        let tail = StudentsT::new(0.0, 1.0, n - 1.0).map_or(0.5, |s| s.sf(symmetric.abs()));
        part.p_value = 2.0 * tail;
    }

    /// The variance over independent replicates, with its standard error from their fourth moment.
    pub fn variance(&mut self, of: &str, values: &[f64], expected: f64) {
        let n = values.len() as f64;
        let mean = values.iter().copied().collect::<Sum>().value() / n;
        let squares: Vec<f64> = values
            .iter()
            .map(|v| (v - mean).powi(2) * n / (n - 1.0))
            .collect();
        self.mean(of, &squares, expected);
    }

    /// A value with a standard error.
    pub fn value(&mut self, of: &str, found: f64, error: f64, expected: f64) {
        let z = (found - expected) / error;
        // no spread at all: right or wrong without chance
        let p_value = if error > 0.0 {
            two_sided(z)
        } else {
            f64::from(u8::from((found - expected).abs() <= 1e-12 * expected.abs()))
        };
        let scale = error / if expected == 0.0 { 1.0 } else { expected.abs() };
        self.add(Part {
            p_value,
            scale,
            chance: true,
            told: format!("{of}: {found:.6} for {expected:.6}, z = {z:.2}"),
        });
    }

    /// The p-value of a test, which finds what is `scale` off once in about its one-sigma range.
    pub fn test(&mut self, of: &str, p_value: f64, scale: f64) {
        self.add(Part {
            p_value,
            scale,
            chance: true,
            told: format!("{of}: p = {p_value:.2e}"),
        });
    }

    /// Numbers that must agree to within `tolerance` times `size`, without chance.
    pub fn exact(
        &mut self,
        of: &str,
        pairs: impl IntoIterator<Item = (f64, f64)>,
        size: f64,
        tolerance: f64,
    ) {
        let mut worst = (0.0, f64::NAN, f64::NAN);
        for (found, expected) in pairs {
            let off = (found - expected).abs() / size;
            // what is no number is further off than anything
            let off = if off.is_nan() { f64::INFINITY } else { off };
            if off >= worst.0 {
                worst = (off, found, expected);
            }
        }
        let (off, found, expected) = worst;
        self.add(Part {
            p_value: f64::from(u8::from(off <= tolerance)),
            scale: tolerance,
            chance: false,
            told: format!("{of}: off by {off:.1e} at most ({found:.9} for {expected:.9})"),
        });
    }

    fn add(&mut self, part: Part) {
        // what is not a number is not well
        let p_value = if part.p_value.is_nan() {
            0.0
        } else {
            part.p_value
        };
        self.parts.push(Part { p_value, ..part });
    }

    /// All together.
    pub fn finding(self) -> Finding {
        let number = self.parts.len() as f64;
        let sigma = detectable(check_level() / number, POWER);
        let detectable = self
            .parts
            .iter()
            .map(|part| part.scale * if part.chance { sigma } else { 1.0 })
            .fold(0.0, f64::max);
        let worst = self
            .parts
            .iter()
            .min_by(|a, b| a.p_value.total_cmp(&b.p_value));
        Finding {
            p_value: worst.map_or(0.0, |part| (part.p_value * number).min(1.0)),
            detectable,
            detail: worst.map_or_else(String::new, |part| part.told.clone()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_agrees_passes_and_what_does_not_or_is_no_number_fails() {
        let finding = |found: f64| {
            let mut evidence = Evidence::default();
            evidence.value("a", found, 0.1, 1.0);
            evidence.exact("b", [(2.0, 2.0), (found, found)], 1.0, 1e-9);
            evidence.finding()
        };
        assert!(!finding(1.1).is_alarm());
        assert!(finding(1.6).is_alarm());
        assert!(finding(f64::NAN).is_alarm());
        let mut exact = Evidence::default();
        exact.exact("c", [(1.0, 1.0), (1.1, 1.0)], 1.0, 0.01);
        assert!(exact.finding().is_alarm());
    }

    #[test]
    fn a_bias_of_the_stated_size_is_found_as_often_as_stated() {
        // z = (bias + error)/error: found if it is beyond the critical value
        let mut evidence = Evidence::default();
        evidence.value("a", 1.0, 0.02, 1.0);
        let stated = evidence.finding().detectable / 0.02;
        let critical = detectable(check_level(), 0.5);
        let power = crate::numeric::special::normal_distribution(stated - critical);
        assert!((power - POWER).abs() < 1e-9, "{power}");
    }

    /// p-values of means of squares of normal numbers, which are skew, in both tails: as often small as they say.
    #[test]
    fn means_of_skew_numbers_keep_their_level() {
        use crate::random;
        use rand_distr::{Distribution, StandardNormal};
        const TRIALS: usize = 20_000;
        let mut random = random::stream(11, "doctor", 0);
        let (mut low, mut high) = (0usize, 0usize);
        for _ in 0..TRIALS {
            let values: [f64; 100] = std::array::from_fn(|_| {
                let z: f64 = StandardNormal.sample(&mut random);
                z * z
            });
            let mut evidence = Evidence::default();
            evidence.mean("a", &values, 1.0);
            if evidence.parts[0].p_value <= 0.01 {
                let mean = values.iter().sum::<f64>() / 100.0;
                *(if mean < 1.0 { &mut low } else { &mut high }) += 1;
            }
        }
        // 136 and 73 are expected (100 would be exact; measured on 400 000 trials), without the transformation 442 and 12
        assert!(
            (90..190).contains(&low) && (40..115).contains(&high),
            "{low} {high}"
        );
    }
}
