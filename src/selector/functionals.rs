//! What the Gaussian criteria see of a sample: sums over pairs, its size and its spread, in units of the spread.

use super::rules::Silverman;
use super::spread::Spread;
use super::{SelectError, Selection, Selector};
use crate::engine::GaussianPairs;
use crate::kernel::{Kernel, Shape};
use crate::sample::Sample;
use crate::space::Warning;
use std::f64::consts::{PI, SQRT_2};

/// [`Functionals::sum`] or [`Functionals::glance`].
pub(super) type Sum = fn(&Functionals, usize, f64) -> f64;

/// A sample, ready for sums over its pairs. Lengths are in units of `unit`.
pub(super) struct Functionals {
    pairs: GaussianPairs,
    /// The effective size.
    pub n: f64,
    /// The standard deviation, in the unit of the data.
    pub unit: f64,
    /// The quartile range in standard deviations.
    pub quartile_range: f64,
}

impl Functionals {
    /// Measures `sample`.
    pub fn new(sample: &Sample<1>) -> Result<Self, SelectError> {
        let spread = Spread::of(sample)?;
        Ok(Self {
            pairs: GaussianPairs::within(sample, (spread.least, spread.most)),
            n: sample.effective_size(),
            unit: spread.deviation,
            quartile_range: spread.interquartile_range / spread.deviation,
        })
    }

    /// Σᵢⱼ wᵢwⱼ φ⁽ʳ⁾((Xᵢ - Xⱼ)/g), i = j included.
    pub fn sum(&self, order: usize, g: f64) -> f64 {
        self.pairs.sum(order, g * self.unit)
    }

    /// The same at a glance.
    pub fn glance(&self, order: usize, g: f64) -> f64 {
        self.pairs.glance(order, g * self.unit)
    }

    /// Makes what serves exact sums at `g` and above: one pass over the data.
    pub fn prepare(&self, g: f64) {
        self.sum(0, g);
    }

    /// Makes what serves glances at `g` and above: one pass over the data.
    pub fn expect(&self, g: f64) {
        self.pairs.expect(g * self.unit);
    }

    /// ∫ (f̂⁽ˢ⁾)² of the estimate with bandwidth h, a sum over pairs at √2 h; never negative.
    pub fn norm(&self, s: usize, h: f64, sum: Sum) -> f64 {
        let g = SQRT_2 * h;
        let sign = if s.is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * sum(self, 2 * s, g) / g.powi(2 * s as i32 + 1)
    }

    /// 1.144 n^(-1/5): where the least AMISE of any density of this deviation must be below. \[Terrell 1990\]
    pub fn oversmoothed(&self) -> f64 {
        1.144 * self.n.powf(-0.2)
    }

    /// R(K)/n of the Gaussian: the variance of an estimate is this over h.
    pub fn roughness(&self) -> f64 {
        0.5 / PI.sqrt() / self.n
    }
}

/// What a Gaussian bandwidth is for `shape`: equally smooth. \[Marron & Nolan 1988\]
pub(super) fn canonical(shape: Shape) -> f64 {
    shape.canonical_scale() / Shape::Gaussian.canonical_scale()
}

/// Silverman's rule instead, with a warning that says why.
pub(super) fn fall_back(
    sample: &Sample<1>,
    shape: Shape,
    why: &str,
) -> Result<Selection<1>, SelectError> {
    let mut selection = Silverman.select(sample, shape)?;
    selection.warnings.insert(
        0,
        Warning {
            what: format!("{why}; Silverman's rule is used instead"),
            hint: "look at the data for ties and outliers, or give the bandwidth as a number"
                .to_owned(),
        },
    );
    Ok(selection)
}
