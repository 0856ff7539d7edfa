//! How fine the cells must be for a tolerance: the error bound and its proof.
//!
//! All bounds are relative to the **peak** P = max f̂ of the estimate itself (times h and over the mass unit), not to a ceiling that n scattered
//! points never come near. Weights are not negative; that is what makes it possible.
//!
//! # The remainder of an expansion
//! A point at distance at most r·h from the centre of its cell contributes φ(v - s) with |s| ≤ r; the Taylor series in s cut after M terms leaves at
//! most rᴹ/M! · |φ⁽ᴹ⁾| at some place within r of v. Cramér's bound |Heₘ(v)| ≤ 1.0865 √(M!) exp(v²/4)
//! \[Abramowitz & Stegun 1964, 22.14.17\] makes this at most 1.0865 rᴹ/√(M!) exp(-v²/4)/√(2π), and moving v by up to r
//! costs a factor exp(r/√8) and widens exp(-v²/4) to exp(-v²/2V), V = 2/(1 - r/√2) (by |vs|/2 ≤ as² + v²/16a with a = 1/(r√8)).
//! Now exp(-v²/2V) = √(2πV) times the normal density of variance V > 1, which is an average of shifted φ's. Summed over all points
//! with their weights, an average of shifted estimates is at most P. So the sum of all remainders is at most P times
//!
//! ```text
//! E(M, r) = 1.0865 √2 · rᴹ/√(M!) · exp(r/√8) / √(1 - r/√2)
//! ```
//!
//! whatever the data. Translating fine expansions to a coarser cell and cutting after M' terms adds E(M', R) with R the half width of the coarse
//! cell, since Σ rᵐ/m! · ρᴹ'⁻ᵐ/(M'-m)! ≤ (r + ρ)ᴹ'/M'! with ρ = R - r the farthest fine centre.
//!
//! # The reach
//! Points farther than R·h from a target are left out. The mass of a window of width h is at most P/φ(½); summing windows from R on, both
//! sides, the neglected part is at most P · 2 exp(1/8) exp(-R²/2) / (1 - exp(-R - ½)) ≤ 2.3 exp(-R²/2) P. So a reach
//! of 7.8 costs 1.4e-13 of the peak even if 10⁹ points lie just beyond it.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Terms of the expansions from which sums are evaluated.
pub(super) const ORDER: usize = 16;

/// Half a unit in the last place of one.
pub(in crate::engine) const ROUNDING: f64 = f64::EPSILON / 2.0;

/// Points that are summed without compensation in one go, see [`crate::space::binning`].
const BLOCK: f64 = (1 << 17) as f64;

/// Cell widths, order and reach for one bandwidth and tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Setting {
    /// h.
    pub bandwidth: f64,
    /// Moments of a fine cell: 4 or 8.
    pub moments: usize,
    /// The width of a fine cell: a power of two.
    pub fine: f64,
    /// Fine cells in one coarse cell: a power of two.
    pub ratio: usize,
    /// Beyond this many h nothing is counted.
    pub reach: f64,
    /// The bound on the whole error, relative to the peak.
    pub error: f64,
}

impl Setting {
    /// The cheapest setting whose bound is at most `tolerance`, or the most exact one if none is. `None` if h is so extreme that
    /// the widths of cells are not ordinary numbers.
    pub fn choose(bandwidth: f64, points: usize, tolerance: f64) -> Option<Self> {
        if !(1e-290..1e290).contains(&bandwidth) {
            return None;
        }
        let coarse = power_of_two_below(0.7 * bandwidth);
        // a sixteenth of the tolerance for the reach, but no more than can be of use
        let reach = (2.0 * (16.0 * 2.3 / tolerance.clamp(1e-14, 1e-2)).ln()).sqrt();
        let mut best: Option<Self> = None;
        for (moments, most) in [(4, 32), (8, 64)] {
            let mut ratio = 1;
            while ratio <= most {
                let fine = coarse / ratio as f64;
                let error = bound(bandwidth, coarse, fine, moments, points, reach);
                let setting = Self {
                    bandwidth,
                    moments,
                    fine,
                    ratio,
                    reach,
                    error,
                };
                if error <= tolerance {
                    return Some(setting);
                }
                if best.is_none_or(|b| error < b.error) {
                    best = Some(setting);
                }
                ratio *= 2;
            }
        }
        best
    }

    /// The width of a coarse cell.
    pub fn coarse(&self) -> f64 {
        self.fine * self.ratio as f64
    }

    /// Coarse cells on either side of a target's own that can hold a point within reach.
    pub fn neighbours(&self) -> usize {
        (self.reach * self.bandwidth / self.coarse() + 0.5).ceil() as usize
    }
}

/// The largest power of two not above `x`, exactly.
pub(in crate::engine) fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & (0x7FF << 52))
}

/// E(M, r) of the module's documentation.
pub(in crate::engine) fn remainder(order: usize, ratio: f64) -> f64 {
    let mut term = 1.0865 * SQRT_2;
    for m in 1..=order {
        term *= ratio / (m as f64).sqrt();
    }
    term * (ratio / (2.0 * SQRT_2)).exp() / (1.0 - ratio * FRAC_1_SQRT_2).sqrt()
}

fn bound(bandwidth: f64, coarse: f64, fine: f64, moments: usize, points: usize, reach: f64) -> f64 {
    let (r, big) = (0.5 * fine / bandwidth, 0.5 * coarse / bandwidth);
    // the same expansion once more about the targets' cells, and the rounding of a few dozen terms
    2.0 * remainder(ORDER, big)
        + remainder(moments, r)
        + 2.3 * (-0.5 * reach * reach).exp()
        + rounding_of_sums(r, points)
        + 64.0 * ROUNDING
}

/// What rounding in the moments of cells of half width r may cost: the mass of a cell is exact; its first moment is at most r times that, rounded once
/// per point of a block and once per block.
pub(in crate::engine) fn rounding_of_sums(ratio: f64, points: usize) -> f64 {
    let n = points as f64;
    remainder(1, ratio) * (n.min(BLOCK) + n / BLOCK / 16.0) * ROUNDING
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::special::normal_density_derivative;

    #[test]
    fn the_remainder_bounds_a_single_point() {
        for order in [4, 8, 16] {
            for r in [0.01, 0.05, 0.2, 0.35] {
                for i in -80..=80 {
                    let v = f64::from(i) * 0.1;
                    let (mut sum, mut factor) = (0.0, 1.0);
                    for m in 0..order {
                        sum += factor * normal_density_derivative(m, v);
                        factor *= -r / f64::from(m + 1);
                    }
                    let exact = normal_density_derivative(0, v - r);
                    let error = (sum - exact).abs() / normal_density_derivative(0, 0.0);
                    assert!(
                        error <= remainder(order as usize, r) + 1e-15,
                        "{order} {r} {v}: {error}"
                    );
                }
            }
        }
    }

    #[test]
    fn tolerances_are_met_by_the_setting() {
        for h in [1e-280, 3.3e-5, 0.7, 1.0, 1.99, 1e12] {
            for n in [1, 1000, 10_000_000, 1 << 32] {
                for tolerance in [1e-3, 1e-6, 1e-8, 1e-10, 1e-12] {
                    let s = Setting::choose(h, n, tolerance).expect("ordinary");
                    assert!(s.error <= tolerance, "{s:?}");
                    assert!(s.coarse() <= 0.7 * h && s.coarse() > 0.35 * h);
                }
            }
        }
        assert!(Setting::choose(1e-300, 10, 1e-6).is_none());
        let best = Setting::choose(1.0, 10, 0.0).expect("ordinary");
        assert!(best.error > 0.0 && best.error < 1e-12);
    }
}
