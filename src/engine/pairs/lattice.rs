//! All displacements between two data, as moments on a lattice: the autocorrelation of a sample, without its bandwidth.
//!
//! The line is cut into cells of one width δ; each cell keeps eight moments of its points about its centre. Two points in cells j apart
//! are jδ + d apart with |d| ≤ δ, and the moments of d over all such pairs are
//!
//! ```text
//! Mⱼ[p] = Σ d^p/p! = Σ_cells Σ_{k+m=p} (s^k/k!) (-t)^m/m!
//! ```
//!
//! correlations of eight sequences with each other, by real transforms. What is left of the data are the lags Mⱼ, and any smooth function of the
//! displacement sums as Σⱼ Σₚ Mⱼ[p] F⁽ᵖ⁾(jδ): binning whose error is of the eighth order in δ instead of the second.
//!
//! # References
//! Silverman 1982, Algorithm AS 176 (transforms of binned data); Greengard & Strain 1991, The fast Gauss transform (moments of cells).

use crate::space::binning::{self, moments};
use rayon::prelude::*;
use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};
use std::sync::Arc;

/// Moments of a displacement.
pub(super) const TERMS: usize = 8;

/// Moments Σ w d^p/p! of the displacements about one lag, in units of the step.
pub(super) type Lag = [f64; TERMS];

/// The lags of one sample at one step.
pub(super) struct Lattice {
    /// δ, a power of two.
    pub step: f64,
    /// The lags from 0 on; those below 0 mirror them.
    pub lags: Vec<Lag>,
    /// Displacements below this are as they are in the data; larger ones need not be.
    pub whole_below: f64,
}

impl Lattice {
    /// How many cells of width `step` cover `low..=high`; infinite where numbers are too coarse for them.
    pub fn cells(low: f64, high: f64, step: f64) -> f64 {
        let (first, last) = ((low / step).floor(), (high / step).ceil());
        if first.abs().max(last.abs()) < (1_u64 << 49) as f64 {
            last - first + 1.0
        } else {
            f64::INFINITY
        }
    }

    /// Collects `points`, all between `low` and `high`, into cells of width `step`, a power of two; `weights` are divided by `mass`. O(n + cells log cells).
    pub fn new(
        points: &[f64],
        weights: Option<&[f64]>,
        mass: f64,
        (low, high): (f64, f64),
        step: f64,
    ) -> Self {
        let cells = moments::<TERMS>(
            points,
            weights,
            binning::Lattice {
                width: step,
                first: (low / step).floor(),
                count: Self::cells(low, high, step) as usize,
            },
        );
        Self {
            step,
            lags: correlate(&cells, mass.recip()),
            whole_below: f64::INFINITY,
        }
    }
}

/// Mⱼ[p] for all lags j ≥ 0 that hold a pair.
fn correlate(cells: &[Lag], scale: f64) -> Vec<Lag> {
    // room for all lags without wrapping round
    let length = smooth_length(2 * cells.len());
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, inverse) = (
        planner.plan_fft_forward(length),
        planner.plan_fft_inverse(length),
    );
    let spectra: Vec<Vec<Complex<f64>>> = (0..TERMS)
        .into_par_iter()
        .map(|k| spectrum(cells, k, scale, &forward))
        .collect();
    let planes: Vec<Vec<f64>> = (0..TERMS)
        .into_par_iter()
        .map(|p| {
            let mut product = forward.make_output_vec();
            for k in 0..=p {
                let sign = if (p - k).is_multiple_of(2) { 1.0 } else { -1.0 } / length as f64;
                // the point further right is s, the one further left t: lag = place of s - place of t
                for ((sum, s), t) in product.iter_mut().zip(&spectra[k]).zip(&spectra[p - k]) {
                    *sum += s * t.conj() * sign;
                }
            }
            // the inverse insists that these are real, which they are up to rounding
            for end in [0, product.len() - 1] {
                product[end].im = 0.0;
            }
            let mut values = inverse.make_output_vec();
            inverse
                .process(&mut product, &mut values)
                .expect("the buffers are of the planned length");
            values
        })
        .collect();
    (0..cells.len())
        .map(|j| std::array::from_fn(|p| planes[p][j]))
        .collect()
}

/// The transform of the k-th moments over k!.
fn spectrum(
    cells: &[Lag],
    k: usize,
    scale: f64,
    forward: &Arc<dyn RealToComplex<f64>>,
) -> Vec<Complex<f64>> {
    let factor = scale / (1..=k).map(|i| i as f64).product::<f64>();
    let mut values = forward.make_input_vec();
    for (value, cell) in values.iter_mut().zip(cells) {
        *value = cell[k] * factor;
    }
    let mut spectrum = forward.make_output_vec();
    forward
        .process(&mut values, &mut spectrum)
        .expect("the buffers are of the planned length");
    spectrum
}

/// The least even length from `least` on with the factors 2 and 3 only.
fn smooth_length(least: usize) -> usize {
    let power = least.max(4).next_power_of_two();
    [power / 16 * 9, power / 4 * 3, power]
        .into_iter()
        .find(|&length| length >= least && length.is_multiple_of(2))
        .unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lags_are_moments_of_displacements() {
        let points: Vec<f64> = (0..60)
            .map(|i| (f64::from(i) * 0.618_034).fract() * 5.0 - 1.0)
            .collect();
        let weights: Vec<f64> = points.iter().map(|x| 1.0 + x * x).collect();
        let mass: f64 = weights.iter().sum();
        let lattice = Lattice::new(&points, Some(&weights), mass, (-1.0, 4.0), 0.25);
        let mut expected = vec![[0.0; TERMS]; lattice.lags.len()];
        for (x, v) in points.iter().zip(&weights) {
            for (y, w) in points.iter().zip(&weights) {
                let cell = |x: f64| (x / 0.25).round_ties_even();
                let lag = cell(*x) - cell(*y);
                if lag >= 0.0 {
                    let mut term = v * w / mass / mass;
                    for (p, sum) in expected[lag as usize].iter_mut().enumerate() {
                        *sum += term;
                        term *= ((x - y) / 0.25 - lag) / (p + 1) as f64;
                    }
                }
            }
        }
        for (lag, expected) in lattice.lags.iter().zip(&expected) {
            for p in 0..TERMS {
                assert!((lag[p] - expected[p]).abs() < 1e-16, "{lag:?} {expected:?}");
            }
        }
    }

    #[test]
    fn lengths_are_smooth_and_long_enough() {
        for least in [1, 4, 5, 17, 100, 1000, 8193] {
            let length = smooth_length(least);
            assert!(length >= least && length <= (2 * least).max(4) && length.is_multiple_of(2));
        }
    }
}
