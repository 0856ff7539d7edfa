//! Mean and variance of a kernel estimate at one place.

use super::Moments;
use super::integrated::{components, panels_of};
use crate::density::Density;
use crate::kernel::{Kernel, Shape};
use crate::numeric::special::normal_density;
use crate::numeric::{GaussLegendre, Sum, panels};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Beyond so many deviations the Gaussian kernel is below 1e-18 of its peak.
const GAUSSIAN_REACH: f64 = 9.2;

static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(24));

/// E f̂(x) = (K_h * f)(x) and var f̂(x) = \[(K_h² * f)(x) - (K_h * f)(x)²\] / n of the kernel estimate with bandwidth `h` from `draws` points of `truth`.
///
/// A closed form for a normal mixture and the Gaussian kernel, otherwise quadrature to 1e-13 of the peak at the cost of some hundred evaluations.
pub fn kernel_moments(truth: &dyn Density<1>, shape: Shape, h: f64, draws: f64, x: f64) -> Moments {
    let (mean, square) = match (components(truth), shape) {
        (Some(parts), Shape::Gaussian) => {
            let at = |variance: f64| -> f64 {
                parts
                    .iter()
                    .map(|part| {
                        let s = part.deviation.hypot(variance.sqrt());
                        part.weight * normal_density((x - part.mean) / s) / s
                    })
                    .sum()
            };
            // φ_h² is φ of deviation h/√2, over 2√π h
            (at(h * h), at(0.5 * h * h) / (2.0 * PI.sqrt() * h))
        }
        (Some(parts), _) => parts.iter().fold((0.0, 0.0), |(mean, square), part| {
            let s = part.deviation;
            let f = |y: f64| normal_density((y - part.mean) / s) / s;
            let (low, high) = (part.mean - 9.0 * s, part.mean + 9.0 * s);
            let (m, q) = smoothed(shape, h, x, f, [low, high], &[], 1.5 * s);
            (part.weight.mul_add(m, mean), part.weight.mul_add(q, square))
        }),
        (None, _) => {
            let ([low], [high]) = truth.bulk(1e-18);
            smoothed(
                shape,
                h,
                x,
                |y| truth.at([y]),
                [low, high],
                &truth.breaks(0),
                truth.finest_scale(0),
            )
        }
    };
    Moments {
        mean,
        // rounding must not make a variance negative where it vanishes
        variance: ((square - mean * mean) / draws).max(0.0),
    }
}

/// Where the mean of a kernel estimate is not smooth, or changes within less than the density does, for [`super::integrate_over`]: where the edges
/// of the kernel meet a break of `truth`, and where they pass over a component that is narrower than the kernel.
pub fn kernel_cuts(truth: &dyn Density<1>, shape: Shape, h: f64) -> Vec<f64> {
    let ladder = |centre: f64, step: f64| (-6..=6).map(move |k| f64::from(k).mul_add(step, centre));
    let breaks = truth.breaks(0).into_iter();
    match (shape, components(truth)) {
        (Shape::Gaussian, _) => breaks.flat_map(|cut| ladder(cut, 1.5 * h)).collect(),
        (_, None) => breaks.flat_map(|cut| [cut - h, cut + h]).collect(),
        (_, Some(parts)) => parts
            .iter()
            .filter(|part| part.deviation < h)
            .flat_map(|part| [-h, h].map(|edge| (part.mean + edge, 1.5 * part.deviation)))
            .flat_map(|(centre, step)| ladder(centre, step))
            .collect(),
    }
}

/// Mean and variance of f̂(x) = Σ κ(Xᵢ) / n for any κ: E κ(X) and var κ(X) / n over `draws` points of `truth`.
///
/// κ is smooth between consecutive `cuts`, vanishes outside `[low, high]` and changes over no less than `longest`. Quadrature to about 1e-12 of the largest κ.
pub fn equivalent_moments(
    truth: &dyn Density<1>,
    kernel: impl Fn(f64) -> f64,
    [low, high]: [f64; 2],
    cuts: impl IntoIterator<Item = f64>,
    longest: f64,
    draws: f64,
) -> Moments {
    let ([least], [most]) = truth.bulk(1e-18);
    let (low, high) = (low.max(least), high.min(most));
    let (mut mean, mut square) = (Sum::default(), Sum::default());
    if low < high {
        let coarse = panels_of(truth, low, high, cuts);
        let fine = panels(low, high, coarse, longest);
        for panel in fine.windows(2) {
            for (y, weight) in RULE.on(panel[0], panel[1]) {
                let value = kernel(y);
                let term = weight * value * truth.at([y]);
                mean.add(term);
                square.add(term * value);
            }
        }
    }
    let (mean, square) = (mean.value(), square.value());
    Moments {
        mean,
        variance: ((square - mean * mean) / draws).max(0.0),
    }
}

/// (K_h * f)(x) and (K_h² * f)(x), for an f that lives between `low` and `high`.
fn smoothed(
    shape: Shape,
    h: f64,
    x: f64,
    f: impl Fn(f64) -> f64,
    [low, high]: [f64; 2],
    breaks: &[f64],
    longest: f64,
) -> (f64, f64) {
    let (reach, smooth) = match shape {
        Shape::Gaussian => (GAUSSIAN_REACH * h, h),
        _ => (h, 2.0 * h),
    };
    let (low, high) = (low.max(x - reach), high.min(x + reach));
    if low >= high {
        return (0.0, 0.0);
    }
    let cuts = breaks.iter().copied().chain([x]);
    let (mut mean, mut square) = (Sum::default(), Sum::default());
    for panel in panels(low, high, cuts, longest.min(smooth)).windows(2) {
        for (y, weight) in RULE.on(panel[0], panel[1]) {
            let kernel = shape.value((x - y) / h) / h;
            let term = weight * kernel * f(y);
            mean.add(term);
            square.add(term * kernel);
        }
    }
    (mean.value(), square.value())
}
