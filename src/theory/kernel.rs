//! Integrated errors of kernel estimates.

use super::autocorrelation::{Deficit, Pair, pairs};
use super::optimum::{self, Optimum, Oracle};
use super::{Asymptotic, Integrated, NoAsymptotics};
use crate::density::Univariate;
use crate::kernel::{Kernel, Shape};
use crate::numeric::{GaussLegendre, Piecewise, Sum, panels};
use std::f64::consts::PI;

/// The integrated errors over the whole line of kernel estimates of one density with one kernel, for any bandwidth and sample size.
///
/// "Whole line" includes what leaks beyond walls. Made once (up to some tenths of a second), then tens to hundreds of microseconds a bandwidth.
pub struct KernelError {
    shape: Shape,
    path: Path,
    /// R(f'')
    curvature: f64,
    /// The shortest scale of the density, and its deviation: where to look for optima.
    scales: (f64, f64),
}

/// ∫(K_h * f - f)², ∫f² - ∫(K_h * f)² and ∫f², each without cancellation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parts {
    pub(super) squared_bias: f64,
    pub(super) lost: f64,
    pub(super) roughness: f64,
}

enum Path {
    /// A normal mixture and the Gaussian kernel.
    Closed(Vec<Pair>),
    Quadrature {
        deficit: Deficit,
        twice: Twice,
        rule: GaussLegendre,
    },
}

impl KernelError {
    /// Prepares the errors of estimates of `truth` with the kernel `shape`.
    pub fn new(truth: &dyn Univariate, shape: Shape) -> Self {
        match (truth.normal_components(), shape) {
            (Some(components), Shape::Gaussian) => {
                Self::with(truth, shape, Path::Closed(pairs(components)))
            }
            _ => Self::by_quadrature(truth, shape),
        }
    }

    /// The same by quadrature even where there is a closed form, so that each can be checked against the other.
    pub fn by_quadrature(truth: &dyn Univariate, shape: Shape) -> Self {
        let path = Path::Quadrature {
            deficit: Deficit::of(truth),
            twice: Twice::of(shape),
            rule: GaussLegendre::new(20),
        };
        Self::with(truth, shape, path)
    }

    fn with(truth: &dyn Univariate, shape: Shape, path: Path) -> Self {
        Self {
            shape,
            path,
            curvature: truth.roughness(2),
            scales: (truth.finest_scale(0), truth.mean_and_deviation().1),
        }
    }

    /// The errors with bandwidth `h` and `draws` points (or the effective size of a weighted sample).
    pub fn at(&self, h: f64, draws: f64) -> Integrated {
        let parts = self.parts(h);
        Integrated {
            squared_bias: parts.squared_bias,
            variance: (self.shape.roughness() / h - (parts.roughness - parts.lost)) / draws,
        }
    }

    /// What the errors are made of, whatever the sample size.
    pub(super) fn parts(&self, h: f64) -> Parts {
        match &self.path {
            Path::Closed(pairs) => closed(pairs, h),
            Path::Quadrature {
                deficit,
                twice,
                rule,
            } => {
                // in u = t/h: pieces of the kernel, and of the table
                let reach = twice.reach();
                let pieces = deficit.cuts().map(|t| t / h).take_while(|&u| u < reach);
                let cuts = panels(0.0, reach, twice.breaks().chain(pieces), f64::INFINITY);
                let (mut squared_bias, mut lost) = (Sum::default(), Sum::default());
                for panel in cuts.windows(2) {
                    for (u, weight) in rule.on(panel[0], panel[1]) {
                        let part = 2.0 * weight * deficit.at(h * u);
                        let twice = twice.at(u);
                        squared_bias.add(part * 2.0f64.mul_add(self.shape.value(u), -twice));
                        lost.add(part * twice);
                    }
                }
                Parts {
                    squared_bias: squared_bias.value().max(0.0),
                    lost: lost.value(),
                    roughness: deficit.total(),
                }
            }
        }
    }

    /// The leading terms for large samples.
    ///
    /// # Errors
    /// If R(f'') is infinite, so that there are none.
    pub fn asymptotic(&self, draws: f64) -> Result<Asymptotic, NoAsymptotics> {
        Asymptotic::of_kernel(
            self.shape.variance(),
            self.shape.roughness(),
            self.curvature,
            draws,
        )
    }

    /// The bandwidth of least MISE and all other local minima, searched from far below the finest scale of the density to 20 of its deviations.
    pub fn optimum(&self, draws: f64) -> Optimum {
        let (finest, deviation) = self.scales;
        // at a jump the best bandwidth falls as n^(-1/2), faster than anywhere else
        let low = finest * 0.01_f64.min(0.1 / draws.sqrt());
        optimum::search(|h| self.at(h, draws), low, 20.0 * deviation)
    }

    /// The optimum and the asymptotics for samples of `draws` points.
    pub fn oracle(&self, draws: f64) -> Oracle {
        Oracle {
            optimum: self.optimum(draws),
            asymptotic: self.asymptotic(draws),
        }
    }
}

/// The closed form for normal mixtures and the Gaussian kernel, with gₐ the mixture's autocorrelation smoothed by variance ah²: bias² = g₂ - 2g₁ + g₀
/// and variance = \[1/(2√π h) - g₂\] / n, all at 0. [Marron & Wand 1992, theorem 2.1]
fn closed(pairs: &[Pair], h: f64) -> Parts {
    let (mut squared_bias, mut lost, mut roughness) =
        (Sum::default(), Sum::default(), Sum::default());
    for pair in pairs {
        let g = |a: f64| {
            let variance = (a * h).mul_add(h, pair.variance);
            (-0.5 * pair.distance.powi(2) / variance).exp() / (2.0 * PI * variance).sqrt()
        };
        let (still, half, full) = (g(0.0), g(1.0), g(2.0));
        // gₐ - g₀, by the logarithm of their quotient where they are close
        let rise = |a: f64, smoothed: f64| {
            let ratio = a * h * h / pair.variance;
            let logarithm = (0.5 * pair.distance.powi(2) / pair.variance)
                .mul_add(ratio / (1.0 + ratio), -0.5 * ratio.ln_1p());
            if logarithm.abs() < 1.0 {
                still * logarithm.exp_m1()
            } else {
                smoothed - still
            }
        };
        let fallen = pair.weight * rise(2.0, full);
        squared_bias.add(fallen);
        squared_bias.add(-2.0 * pair.weight * rise(1.0, half));
        lost.add(-fallen);
        roughness.add(pair.weight * still);
    }
    Parts {
        squared_bias: squared_bias.value().max(0.0),
        lost: lost.value(),
        roughness: roughness.value(),
    }
}

/// K * K, the kernel smoothed by itself.
pub(super) enum Twice {
    Gaussian,
    Compact(Piecewise),
}

impl Twice {
    pub(super) fn of(shape: Shape) -> Self {
        if shape == Shape::Gaussian {
            return Self::Gaussian;
        }
        let rule = GaussLegendre::new(16);
        let value = |u: f64| {
            let cuts = panels(u - 1.0, 1.0, [0.0, u], f64::INFINITY);
            rule.integrate_panels(|v| shape.value(v) * shape.value(u - v), &cuts)
        };
        Self::Compact(Piecewise::fit(value, &[0.0, 1.0, 2.0], 1e-17))
    }

    /// (K * K)(u) for u ≥ 0.
    pub(super) fn at(&self, u: f64) -> f64 {
        match self {
            Self::Gaussian => (-0.25 * u * u).exp() / (4.0 * PI).sqrt(),
            Self::Compact(table) if u < 2.0 => table.at(u),
            Self::Compact(_) => 0.0,
        }
    }

    /// Nothing lies beyond.
    fn reach(&self) -> f64 {
        match self {
            Self::Gaussian => 13.0,
            Self::Compact(_) => 2.0,
        }
    }

    /// Where K or K * K is not smooth, or changes much.
    fn breaks(&self) -> impl Iterator<Item = f64> {
        let last = self.reach() as i32;
        (1..last).map(f64::from)
    }
}
