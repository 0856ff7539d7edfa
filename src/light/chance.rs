//! Chance is tested with chance: statistics for the tests of samplers, at stated levels.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// The probability that independent uniform numbers are at least as far from uniform as these: Kolmogorov's asymptotic distribution.
pub fn uniform(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let n = numbers.len() as f64;
    let distance = numbers.iter().enumerate().fold(0.0_f64, |most, (i, &x)| {
        let i = i as f64;
        most.max((i + 1.0) / n - x).max(x - i / n)
    });
    let t = distance * (n.sqrt() + 0.12 + 0.11 / n.sqrt());
    let tail: f64 = (1..=50)
        .map(|k| {
            let k = f64::from(k);
            let sign = if k % 2.0 > 0.5 { 1.0 } else { -1.0 };
            2.0 * sign * (-2.0 * k * k * t * t).exp()
        })
        .sum();
    tail.clamp(0.0, 1.0)
}

/// The probability of counts at least as far from `expected` as these, by the χ² statistic with one degree of freedom less than cells.
pub fn counts(found: &[f64], expected: &[f64]) -> f64 {
    let statistic: f64 = found
        .iter()
        .zip(expected)
        .map(|(found, expected)| (found - expected).powi(2) / expected)
        .sum();
    ChiSquared::new(found.len() as f64 - 1.0).map_or(0.0, |chi| chi.sf(statistic))
}

/// Whether means agree with what is expected, by z-scores at level 0.001 for all together (Šidák). `blocks[b][i]` is the share of
/// block b in quantity i; blocks are independent and of equal size.
pub fn worst(blocks: &[Vec<f64>], expected: &[f64]) -> Result<(), String> {
    let count = blocks.len() as f64;
    let cells = expected.len() as f64;
    let level = 1.0 - (1.0 - 0.001_f64).powf(cells.recip());
    let limit = Normal::standard().inverse_cdf(1.0 - 0.5 * level);
    for (cell, expected) in expected.iter().enumerate() {
        let mean = blocks.iter().map(|block| block[cell]).sum::<f64>() / count;
        let square: f64 = blocks
            .iter()
            .map(|block| (block[cell] - mean).powi(2))
            .sum();
        let error = (square / (count - 1.0) / count).sqrt();
        let z = (mean - expected) / error;
        if z.is_nan() || z.abs() > limit {
            return Err(format!(
                "quantity {cell}: {mean} ± {error}, expected {expected}: {z} standard errors, {limit} allowed"
            ));
        }
    }
    Ok(())
}
