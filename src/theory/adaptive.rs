//! Adaptive kernel estimates whose pilot is a known function: exact mean and variance.

use super::Moments;
use crate::density::Density;
use crate::kernel::{Kernel, Shape};
use crate::numeric::{GaussLegendre, Sum, panels, root};
use std::sync::LazyLock;

static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(24));

/// Beyond so many deviations the Gaussian kernel is below 1e-18 of its peak.
const GAUSSIAN_REACH: f64 = 9.2;

/// exp(∫ f log f), the geometric mean of a density over its own points: Abramson's g.
pub fn geometric_mean(truth: &dyn Density<1>) -> f64 {
    geometric_mean_of(truth, &|y| truth.at([y]))
}

/// exp(∫ f log p), the geometric mean of a pilot over the points of a density.
pub(super) fn geometric_mean_of(truth: &dyn Density<1>, pilot: &dyn Fn(f64) -> f64) -> f64 {
    let ([low], [high]) = truth.bulk(1e-18);
    let rule = &*RULE;
    let mut sum = Sum::default();
    for panel in panels(low, high, truth.breaks(0), truth.finest_scale(0)).windows(2) {
        for (y, weight) in rule.on(panel[0], panel[1]) {
            let (f, p) = (truth.at([y]), pilot(y));
            if f > 0.0 && p > 0.0 {
                sum.add(weight * f * p.ln());
            }
        }
    }
    sum.value().exp()
}

/// The moments at `x` of Σ wᵢ K((x - Xᵢ)/h(Xᵢ))/h(Xᵢ), where the bandwidth is a fixed function of the place of a datum: E f̂ = ∫ K((x - y)/h(y))/h(y) f(y) dy, and
/// the variance is that of the integrand's factor over n. By quadrature between the ends of the windows, where |x - y| = h(y).
///
/// `width` must be smooth between the breaks of the density and `cuts`. [Abramson 1982; Hall & Marron 1988]
pub fn adaptive_moments(
    truth: &dyn Density<1>,
    shape: Shape,
    width: impl Fn(f64) -> f64,
    cuts: &[f64],
    draws: f64,
    x: f64,
) -> Moments {
    let reach = if shape == Shape::Gaussian {
        GAUSSIAN_REACH
    } else {
        1.0
    };
    let ([low], [high]) = truth.bulk(1e-18);
    // how far y is inside the window that reaches x: negative beyond it
    let inside = |y: f64| reach * width(y) - (x - y).abs();
    let longest = (0.25 * truth.finest_scale(0)).min(0.5 * width(x.clamp(low, high)));
    let known = truth.breaks(0).into_iter().chain(cuts.iter().copied());
    let mut pieces = panels(low, high, known.chain([x]), longest);
    let ends: Vec<f64> = pieces
        .windows(2)
        .filter(|piece| inside(piece[0]) * inside(piece[1]) < 0.0)
        .filter_map(|piece| root(inside, piece[0], piece[1]))
        .collect();
    pieces.extend(ends);
    pieces.sort_by(f64::total_cmp);
    let (mut mean, mut square) = (Sum::default(), Sum::default());
    for panel in pieces.windows(2) {
        if inside(0.5 * (panel[0] + panel[1])) <= 0.0 {
            continue;
        }
        for (y, weight) in RULE.on(panel[0], panel[1]) {
            let h = width(y);
            let kernel = shape.value((x - y) / h) / h;
            let term = weight * kernel * truth.at([y]);
            mean.add(term);
            square.add(term * kernel);
        }
    }
    let mean = mean.value();
    Moments {
        mean,
        variance: ((square.value() - mean * mean) / draws).max(0.0),
    }
}
