//! Integrated errors, and how to get them from moments at places.

use super::Moments;
use crate::density::{Density, NormalComponent};
use crate::numeric::{GaussLegendre, Sum, panels};

/// The two parts of a mean integrated squared error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Integrated {
    /// ∫ (E f̂ - f)².
    pub squared_bias: f64,
    /// ∫ var f̂.
    pub variance: f64,
}

impl Integrated {
    /// MISE: E ∫ (f̂ - f)².
    pub fn mise(self) -> f64 {
        self.squared_bias + self.variance
    }
}

/// Errors over an interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Over {
    /// The integrated errors.
    pub absolute: Integrated,
    /// The same with each squared error divided by f(x)² (so that `mise` is the MIRE): infinite or undefined where f vanishes inside the interval.
    pub relative: Integrated,
}

/// Integrates the errors of an estimate with these `moments` of `truth` over an interval.
///
/// `cuts` are the places where the mean or the variance is not smooth, beside those of the density: bin edges, or for a kernel
/// [`super::kernel_cuts`]. Cost: 24 evaluations a panel; panels as in [`panels_of`].
pub fn integrate_over(
    truth: &dyn Density<1>,
    [low, high]: [f64; 2],
    cuts: impl IntoIterator<Item = f64>,
    moments: impl Fn(f64) -> Moments,
) -> Over {
    let rule = GaussLegendre::new(24);
    let mut sums = [Sum::default(); 4];
    for panel in panels_of(truth, low, high, cuts).windows(2) {
        for (x, weight) in rule.on(panel[0], panel[1]) {
            let (f, Moments { mean, variance }) = (truth.at([x]), moments(x));
            let squared_bias = (mean - f).powi(2);
            sums[0].add(weight * squared_bias);
            sums[1].add(weight * variance);
            sums[2].add(weight * squared_bias / (f * f));
            sums[3].add(weight * variance / (f * f));
        }
    }
    let [squared_bias, variance, relative_bias, relative_variance] = sums.map(Sum::value);
    Over {
        absolute: Integrated {
            squared_bias,
            variance,
        },
        relative: Integrated {
            squared_bias: relative_bias,
            variance: relative_variance,
        },
    }
}

/// The normals that `truth` is made of, where it is.
pub(super) fn components(truth: &dyn Density<1>) -> Option<&[NormalComponent]> {
    truth.univariate()?.normal_components()
}

/// Panels between `low` and `high` on which `truth` is smooth: short where it is steep, and for normal mixtures only there. Ascending, both ends included.
pub fn panels_of(
    truth: &dyn Density<1>,
    low: f64,
    high: f64,
    cuts: impl IntoIterator<Item = f64>,
) -> Vec<f64> {
    let mut all: Vec<f64> = cuts.into_iter().collect();
    if let Some(parts) = components(truth) {
        // each component is smooth on its own scale, and nothing beyond nine deviations
        for part in parts {
            all.extend((-6..=6).map(|k| (1.5 * f64::from(k)).mul_add(part.deviation, part.mean)));
        }
        panels(low, high, all, f64::INFINITY)
    } else {
        all.extend(truth.breaks(0));
        panels(low, high, all, truth.finest_scale(0))
    }
}
