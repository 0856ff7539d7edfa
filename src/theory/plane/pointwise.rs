//! Mean and variance of a kernel estimate at one place of the plane.

use super::deficit::sum;
use crate::density::{Bivariate, Density, PlaneComponent, normal_at};
use crate::kernel::{Kernel, Shape, Symmetry};
use crate::numeric::Sum;
use crate::space::Point;
use crate::theory::{Moments, Support, kernel_moments};
use std::f64::consts::PI;

/// Beyond so many deviations the Gaussian kernel is below 1e-18 of its peak.
pub(super) const GAUSSIAN_REACH: f64 = 9.2;

/// Mean and variance at `x` of the estimate with a kernel of this shape and symmetry and a bandwidth for each axis, over samples of `draws` points.
///
/// In closed form for normal mixtures with the Gaussian kernel, on each axis for products of densities and of kernels; else by quadrature over the support
/// of the kernel, to some 1e-9 of the peak where the density is smooth inside its domain, less near a jump inside it. Walls are not corrected.
pub fn plane_kernel_moments(
    truth: &dyn Bivariate,
    shape: Shape,
    symmetry: Symmetry,
    h: [f64; 2],
    draws: f64,
    x: Point<2>,
) -> Moments {
    let round = shape == Shape::Gaussian;
    if let (Some(components), true) = (truth.normal_components(), round) {
        let smoothed = |a: f64| -> f64 {
            let [s, t] = h.map(|h| a * h * h);
            components
                .iter()
                .map(|part: &PlaneComponent| {
                    let d = [0, 1].map(|k: usize| x[k] - part.mean[k]);
                    let wide = sum(part.covariance, [[s, 0.0], [0.0, t]]);
                    part.weight * normal_at(d, wide).density
                })
                .sum()
        };
        // K_h² is a Gaussian of half the variance, of mass 1/(4π h₁h₂)
        return of(
            smoothed(1.0),
            smoothed(0.5) / (4.0 * PI * h[0] * h[1]),
            draws,
        );
    }
    if let (Some(factors), true) = (truth.factors(), round || symmetry == Symmetry::Product) {
        let [a, b] = [0, 1].map(|k: usize| kernel_moments(factors[k], shape, h[k], 1.0, x[k]));
        // of one point the axes are independent
        let both = a.times(b);
        return Moments {
            variance: both.variance / draws,
            ..both
        };
    }
    let reach = if round { GAUSSIAN_REACH } else { 1.0 };
    let support = Support {
        centre: x,
        reach: h.map(|h| reach * h),
        round: round || symmetry == Symmetry::Radial,
    };
    let factor = symmetry.factor::<2>(shape) / (h[0] * h[1]);
    let kernel = |y: Point<2>| {
        let [u, v] = [0, 1].map(|k: usize| (x[k] - y[k]) / h[k]);
        // on the rim rounding must not decide between all and nothing
        let inside = 1.0 - 4.0 * f64::EPSILON;
        factor
            * match symmetry {
                Symmetry::Product => shape.value(u * inside) * shape.value(v * inside),
                Symmetry::Radial => shape.of_square((u * u + v * v) * inside),
            }
    };
    let smooth = if round { h[0].min(h[1]) } else { f64::INFINITY };
    plane_equivalent_moments(truth, kernel, support, smooth, draws)
}

/// Mean and variance of f̂(x) = Σ κ(Xᵢ) / n for any κ that vanishes outside `support` and is smooth inside it, over no less than `longest`: E κ(X) and
/// var κ(X) / n over `draws` points of `truth`.
pub fn plane_equivalent_moments(
    truth: &dyn Density<2>,
    kernel: impl Fn(Point<2>) -> f64,
    support: Support,
    longest: f64,
    draws: f64,
) -> Moments {
    let scale = 1.5 * truth.finest_scale(0).min(truth.finest_scale(1));
    let (mut mean, mut square) = (Sum::default(), Sum::default());
    for (y, weight) in support.nodes(truth.domain(), longest.min(scale)) {
        let value = kernel(y);
        let term = weight * value * truth.at(y);
        mean.add(term);
        square.add(term * value);
    }
    of(mean.value(), square.value(), draws)
}

pub(super) fn of(mean: f64, square: f64, draws: f64) -> Moments {
    Moments {
        mean,
        // rounding must not make a variance negative where it vanishes
        variance: ((square - mean * mean) / draws).max(0.0),
    }
}
