//! Tests of chance: p-values, and what to make of many of them.

use crate::numeric::special::{normal_distribution, normal_quantile};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// P(|Z| ≥ |z|) of a standard normal Z.
pub fn two_sided(z: f64) -> f64 {
    2.0 * normal_distribution(-z.abs())
}

/// The |z| that a test at `level`, two-sided, finds with probability `power`: (z_{1 - level/2} + z_power) standard errors.
pub fn detectable(level: f64, power: f64) -> f64 {
    -normal_quantile(0.5 * level) + normal_quantile(power)
}

/// The p-value of Kolmogorov and Smirnov's test of `probabilities`, the distribution function at each datum. \[Stephens 1970\]
pub fn kolmogorov_smirnov(mut probabilities: Vec<f64>) -> f64 {
    probabilities.sort_by(f64::total_cmp);
    let n = probabilities.len() as f64;
    let furthest = probabilities
        .iter()
        .enumerate()
        .map(|(i, p)| (p - i as f64 / n).max((i + 1) as f64 / n - p))
        .fold(0.0, f64::max);
    let lambda = (n.sqrt() + 0.12 + 0.11 / n.sqrt()) * furthest;
    if lambda < 0.2 {
        return 1.0;
    }
    let series: f64 = (1..100)
        .map(|k: i32| {
            let sign = if k % 2 == 1 { 1.0 } else { -1.0 };
            sign * (-2.0 * f64::from(k * k) * lambda * lambda).exp()
        })
        .sum();
    (2.0 * series).clamp(0.0, 1.0)
}

/// The p-value of Pearson's test that `counts` are equally likely; 1 for fewer than two.
pub fn equally_likely(counts: &[u64]) -> f64 {
    let expected = counts.iter().sum::<u64>() as f64 / counts.len() as f64;
    let statistic = counts
        .iter()
        .map(|&count| (count as f64 - expected).powi(2) / expected)
        .sum();
    ChiSquared::new(counts.len().saturating_sub(1) as f64).map_or(1.0, |chi| chi.sf(statistic))
}

/// Which of the hypotheses fall if at most `level` is to be the chance that any true one falls. \[Holm 1979\]
pub fn holm(p_values: &[f64], level: f64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&i, &j| p_values[i].total_cmp(&p_values[j]));
    let mut rejected = vec![false; p_values.len()];
    for (rank, &i) in order.iter().enumerate() {
        let within = p_values[i] <= level / (p_values.len() - rank) as f64;
        if !within {
            break;
        }
        rejected[i] = true;
    }
    rejected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_p_values() {
        assert!((two_sided(1.959_963_984_540_054) - 0.05).abs() < 1e-12);
        assert!((detectable(0.05, 0.8) - 2.801_585).abs() < 1e-6);
        // 11 cells, statistic 18.307 is the 5 % point of chi-square with 10 degrees of freedom
        let counts = [100, 100, 100, 100, 100, 100, 100, 100, 100, 130, 70];
        assert!((equally_likely(&counts) - 0.055).abs() < 0.001);
        assert_eq!(
            holm(&[0.01, 0.04, 0.03, 0.005], 0.05),
            [true, false, false, true]
        );
        // λ = 1.358 is the 5 % point: push all probabilities up by that much
        let n = 10_000;
        let shift = 1.358 / f64::from(n).sqrt();
        let probabilities = (0..n)
            .map(|i| (f64::from(i) + 0.5) / f64::from(n) + shift)
            .collect();
        assert!((kolmogorov_smirnov(probabilities) - 0.05).abs() < 0.003);
    }
}
