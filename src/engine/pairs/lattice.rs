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

use crate::numeric::{forward_transform, inverse_transform};
use crate::space::binning::{self, moments};
use rayon::prelude::*;
use realfft::RealToComplex;
use realfft::num_complex::Complex;
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

    /// The lags of `cells`, whose weights are divided by `mass`. O(cells log cells).
    pub fn new(cells: &Cells, mass: f64) -> Self {
        Self {
            step: cells.step,
            lags: correlate(&cells.moments, mass.recip()),
            whole_below: f64::INFINITY,
        }
    }
}

/// Moments Σ w uᵏ of the cells of one width, u in widths from the centre.
pub(super) struct Cells {
    /// δ, a power of two.
    pub step: f64,
    moments: Vec<Lag>,
}

impl Cells {
    /// Collects `points`, all between `low` and `high`, into cells of width `step`, a power of two. O(n + cells).
    pub fn collect(
        points: &[f64],
        weights: Option<&[f64]>,
        (low, high): (f64, f64),
        step: f64,
    ) -> Self {
        let lattice = binning::Lattice {
            width: step,
            first: (low / step).floor(),
            count: Lattice::cells(low, high, step) as usize,
        };
        Self {
            step,
            moments: moments::<TERMS>(points, weights, lattice),
        }
    }

    /// The same data in cells twice as wide, each two of these seen from between them: exact, without another look at the data. Where the
    /// first cell lies does not matter to displacements. O(cells).
    pub fn doubled(&self) -> Self {
        let halves = |pair: &[Lag]| {
            let mut sum = seen_from(&pair[0], -0.25);
            if let Some(right) = pair.get(1) {
                let right = seen_from(right, 0.25);
                for k in 0..TERMS {
                    sum[k] += right[k];
                }
            }
            sum
        };
        Self {
            step: 2.0 * self.step,
            moments: self.moments.chunks(2).map(halves).collect(),
        }
    }
}

/// Moments in units twice as long about another centre, from which a datum at u is at u/2 + `by`.
fn seen_from(moments: &Lag, by: f64) -> Lag {
    let mut seen = [0.0; TERMS];
    let mut scale = 1.0;
    for k in 0..TERMS {
        seen[k] = moments[k] * scale;
        scale *= 0.5;
    }
    // (u + b)ᵏ for all k by repeated Horner steps
    for from in 1..TERMS {
        for k in (from..TERMS).rev() {
            seen[k] += by * seen[k - 1];
        }
    }
    seen
}

/// Mⱼ[p] for all lags j ≥ 0 that hold a pair.
fn correlate(cells: &[Lag], scale: f64) -> Vec<Lag> {
    // room for all lags without wrapping round
    let length = smooth_length(2 * cells.len());
    let (forward, inverse) = (forward_transform(length), inverse_transform(length));
    let spectra: Vec<Vec<Complex<f64>>> = (0..TERMS)
        .into_par_iter()
        .map(|k| spectrum(cells, k, scale, &forward))
        .collect();
    let planes: Vec<Vec<f64>> = (0..TERMS / 2)
        .into_par_iter()
        .map(|q| {
            let mut product = products(&spectra, q, 1.0 / length as f64);
            // the inverse insists that these are real, which they are up to rounding
            for end in [0, length / 2] {
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
        .map(|j| {
            std::array::from_fn(|p| {
                let (right, left) = (planes[p / 2][j], planes[p / 2][(length - j) % length]);
                0.5 * if p % 2 == 0 {
                    right + left
                } else {
                    right - left
                }
            })
        })
        .collect()
}

/// The spectra of M[2q] and M[2q+1] in one.
///
/// The point further right is s, the one further left t: lag = place of s - place of t, and M[p] is the inverse of Σₖ (-1)^(p-k) Sₖ S̄ₚ₋ₖ. Together with the term of p - k that of
/// k is real for an even p, whose moment is an even function of the lag, and imaginary for an odd one, whose moment is odd: so neither disturbs the other.
fn products(spectra: &[Vec<Complex<f64>>], q: usize, scale: f64) -> Vec<Complex<f64>> {
    let mut product = vec![Complex::new(0.0, 0.0); spectra[0].len()];
    for k in 0..=q {
        let sign = if k.is_multiple_of(2) { scale } else { -scale };
        let twice = if k == q { sign } else { 2.0 * sign };
        let (even, odd) = (&spectra[2 * q - k], &spectra[2 * q + 1 - k]);
        for (((sum, s), t), u) in product.iter_mut().zip(&spectra[k]).zip(even).zip(odd) {
            sum.re += twice * (s.re * t.re + s.im * t.im);
            sum.im -= 2.0 * sign * (s.im * u.re - s.re * u.im);
        }
    }
    product
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
        let cells = Cells::collect(&points, Some(&weights), (-1.0, 4.0), 0.25);
        let lattice = Lattice::new(&cells, mass);
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
    fn doubled_cells_hold_the_same_data() {
        let points: Vec<f64> = (0..90)
            .map(|i| (f64::from(i) * 0.618_034).fract() * 5.0 - 1.0)
            .collect();
        let weights: Vec<f64> = points.iter().map(|x| 1.0 + x * x).collect();
        let fine = Cells::collect(&points, Some(&weights), (-1.0, 4.0), 0.125);
        let coarse = fine.doubled();
        assert_eq!(coarse.moments.len(), fine.moments.len().div_ceil(2));
        // the first of the fine cells is centred at -1, and between it and the next is the centre of the first of the coarse ones
        let mut expected = vec![[0.0; TERMS]; coarse.moments.len()];
        for (x, w) in points.iter().zip(&weights) {
            let cell = (0.5 * (x / 0.125).round_ties_even() + 4.0).floor();
            let u = (x - (0.25 * cell - 0.9375)) / 0.25;
            for (k, sum) in expected[cell as usize].iter_mut().enumerate() {
                *sum += w * u.powi(k as i32);
            }
        }
        for (cell, expected) in coarse.moments.iter().zip(&expected) {
            for k in 0..TERMS {
                assert!(
                    (cell[k] - expected[k]).abs() < 1e-13,
                    "{cell:?} {expected:?}"
                );
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
