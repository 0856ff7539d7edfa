//! Errors of kernel estimates in the plane.

use super::optimum::{self, Optimum, Oracle};
use super::{Asymptotic, Integrated, KernelError, Moments, NoAsymptotics, kernel_moments};
use crate::density::{Bivariate, Density, PlaneComponent, normal_at};
use crate::kernel::Shape;
use crate::numeric::Sum;
use crate::space::Point;
use std::f64::consts::PI;

/// The integrated errors over the whole plane of Gaussian kernel estimates of a normal mixture, for any bandwidths and sample size.
pub struct PlaneKernelError {
    pairs: Vec<Pair>,
    /// ∫(Δf)²
    curvature: f64,
    /// The shortest scale of the density, and its greatest deviation: where to look for optima.
    scales: (f64, f64),
}

/// Two components: the product of their weights, the distance of their means, the sum of their covariances.
struct Pair {
    weight: f64,
    distance: [f64; 2],
    covariance: [[f64; 2]; 2],
}

impl PlaneKernelError {
    /// Prepares the errors; `None` unless `truth` is a normal mixture, the only case with closed forms. O(components²).
    pub fn new(truth: &dyn Bivariate) -> Option<Self> {
        let components = truth.normal_components()?;
        let mut pairs = Vec::with_capacity(components.len() * components.len());
        for a in components {
            for b in components {
                pairs.push(Pair {
                    weight: a.weight * b.weight,
                    distance: [0, 1].map(|k: usize| a.mean[k] - b.mean[k]),
                    covariance: sum(a.covariance, b.covariance),
                });
            }
        }
        let (_, covariance) = truth.mean_and_covariance();
        Some(Self {
            pairs,
            curvature: truth.laplacian_roughness(),
            scales: (
                truth.finest_scale(0).min(truth.finest_scale(1)),
                covariance[0][0].max(covariance[1][1]).sqrt(),
            ),
        })
    }

    /// The errors with a bandwidth for each axis and `draws` points (or the effective size of a weighted sample).
    ///
    /// With gₐ the mixture's autocorrelation smoothed by the covariance a·diag(h²), at 0: bias² = g₂ - 2g₁ + g₀ and
    /// variance = \[1/(4π h₁h₂) - g₂\] / n. [Wand & Jones 1993; Marron & Wand 1992, theorem 2.1, in the plane]
    pub fn at(&self, h: [f64; 2], draws: f64) -> Integrated {
        let (mut squared_bias, mut square_of_mean) = (Sum::default(), Sum::default());
        for pair in &self.pairs {
            let still = normal_at(pair.distance, pair.covariance).density;
            let smoothed = |a: f64| {
                let [s, t] = h.map(|h| a * h * h);
                let wide = normal_at(pair.distance, sum(pair.covariance, [[s, 0.0], [0.0, t]]));
                let narrow = normal_at(pair.distance, pair.covariance);
                let [[p, r], [_, q]] = pair.covariance;
                // gₐ - g₀ by the logarithm of their quotient where they are close, so that small bandwidths lose no digits
                let determinants = (p * t + q * s + s * t) / (p * q - r * r);
                let squares = s * wide.pull[0] * narrow.pull[0] + t * wide.pull[1] * narrow.pull[1];
                let logarithm = 0.5 * (squares - determinants.ln_1p());
                let rise = if logarithm.abs() < 1.0 {
                    still * logarithm.exp_m1()
                } else {
                    wide.density - still
                };
                (wide.density, rise)
            };
            let (half, full) = (smoothed(1.0), smoothed(2.0));
            squared_bias.add(pair.weight * full.1);
            squared_bias.add(-2.0 * pair.weight * half.1);
            square_of_mean.add(pair.weight * full.0);
        }
        Integrated {
            squared_bias: squared_bias.value().max(0.0),
            variance: (1.0 / (4.0 * PI * h[0] * h[1]) - square_of_mean.value()) / draws,
        }
    }

    /// The bandwidth, the same on both axes, of least MISE, and all other local minima.
    pub fn optimum(&self, draws: f64) -> Optimum {
        let (finest, deviation) = self.scales;
        let low = finest * 0.01_f64.min(0.1 / draws.sqrt());
        optimum::search(|h| self.at([h, h], draws), low, 20.0 * deviation)
    }

    /// The leading terms for large samples, the bandwidth being the same on both axes.
    ///
    /// # Errors
    /// Never for a normal mixture; the type is that of the line.
    pub fn asymptotic(&self, draws: f64) -> Result<Asymptotic, NoAsymptotics> {
        Asymptotic::of_plane_kernel(1.0, 1.0 / (4.0 * PI), self.curvature, draws)
    }
}

fn sum(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|i: usize| [0, 1].map(|j: usize| a[i][j] + b[i][j]))
}

/// The optimum and the asymptotics of kernel estimates of `truth`, on a line for every kernel, in the plane for the Gaussian and normal mixtures;
/// `None` where no exact theory is known.
pub fn kernel_oracle<const D: usize>(
    truth: &dyn Density<D>,
    shape: Shape,
    draws: f64,
) -> Option<Oracle> {
    if let Some(line) = truth.univariate() {
        return Some(KernelError::new(line, shape).oracle(draws));
    }
    let errors = PlaneKernelError::new(truth.bivariate()?).filter(|_| shape == Shape::Gaussian)?;
    Some(Oracle {
        optimum: errors.optimum(draws),
        asymptotic: errors.asymptotic(draws),
    })
}

/// Mean and variance at `x` of the estimate with a product kernel of this shape and a bandwidth for each axis, over samples of `draws` points:
/// in closed form for normal mixtures with the Gaussian kernel, by quadrature on each axis for products of densities; `None` for other truths.
pub fn plane_kernel_moments(
    truth: &dyn Bivariate,
    shape: Shape,
    h: [f64; 2],
    draws: f64,
    x: Point<2>,
) -> Option<Moments> {
    if let (Some(components), Shape::Gaussian) = (truth.normal_components(), shape) {
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
        let mean = smoothed(1.0);
        // K_h² is a Gaussian of half the variance, of mass 1/(4π h₁h₂)
        let square = smoothed(0.5) / (4.0 * PI * h[0] * h[1]);
        return Some(Moments {
            mean,
            variance: (square - mean * mean) / draws,
        });
    }
    let factors = truth.factors()?;
    let [a, b] = [0, 1].map(|k: usize| kernel_moments(factors[k], shape, h[k], 1.0, x[k]));
    let mean = a.mean * b.mean;
    // of one point: E K² = variance + mean², and the axes are independent
    let square = (a.variance + a.mean * a.mean) * (b.variance + b.mean * b.mean);
    Some(Moments {
        mean,
        variance: (square - mean * mean) / draws,
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::density::named_in_plane;

    fn normal() -> PlaneKernelError {
        PlaneKernelError::new(&*named_in_plane("normal-2d").unwrap()).unwrap()
    }

    /// N(0, I): bias² and variance written out. [Wand & Jones 1995, section 4.4]
    #[test]
    fn the_round_normal_is_the_textbook_formula() {
        let n = 500.0;
        for h in [1e-4_f64, 0.05, 0.3, 1.0, 4.0] {
            let g = |a: f64| 1.0 / (2.0 * PI * (2.0 + a * h * h));
            let error = normal().at([h, h], n);
            let variance = (1.0 / (4.0 * PI * h * h) - g(2.0)) / n;
            assert!((error.variance / variance - 1.0).abs() < 1e-13, "{h}");
            // g₂ - 2g₁ + g₀ over a common denominator, which cancels nothing
            let q = h * h;
            let squared = 2.0 * q * q / (2.0 * PI * 2.0 * (2.0 + q) * (2.0 + 2.0 * q));
            let apart = (error.squared_bias / squared - 1.0).abs();
            assert!(apart < 1e-12 / q.min(1.0) + 1e-12, "{h}: {apart:e}");
        }
    }

    #[test]
    fn the_best_bandwidth_nears_the_asymptotic_one() {
        for n in [1e3_f64, 1e6, 1e9] {
            let best = normal().optimum(n);
            let asymptotic = normal().asymptotic(n).unwrap().best();
            // h = n^(-1/6) for N(0, I)
            assert!((asymptotic / n.powf(-1.0 / 6.0) - 1.0).abs() < 1e-12);
            assert!(
                (best.at / asymptotic - 1.0).abs() < 2.0 * n.powf(-1.0 / 3.0),
                "{n}: {}",
                best.at
            );
        }
    }

    /// Pointwise moments integrated over the plane are the integrated errors.
    #[test]
    fn moments_at_places_integrate_to_the_errors() {
        let truth = named_in_plane("normal-2d").unwrap();
        let (h, n) = ([0.5, 0.3], 100.0);
        let (mut bias, mut variance) = (Sum::default(), Sum::default());
        let step = 0.05;
        for i in -140..=140 {
            for j in -140..=140 {
                let x = [f64::from(i) * step, f64::from(j) * step];
                let m = plane_kernel_moments(&*truth, Shape::Gaussian, h, n, x).unwrap();
                bias.add((m.mean - truth.at(x)).powi(2) * step * step);
                variance.add(m.variance * step * step);
            }
        }
        let whole = normal().at(h, n);
        assert!((bias.value() / whole.squared_bias - 1.0).abs() < 1e-9);
        assert!((variance.value() / whole.variance - 1.0).abs() < 1e-9);
    }
}
