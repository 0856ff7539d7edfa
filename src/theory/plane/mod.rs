//! Errors of kernel estimates in the plane.
//!
//! With D(t) = ∫f² - ∫f(x) f(x + t) dx the deficit of the autocorrelation, all that the errors know of a density,
//! ∫(K_h * f - f)² = ∫ D (2K_h - K_h * K_h) and ∫f² - ∫(K_h * f)² = ∫ D (K_h * K_h), as on the line.
//!
//! | density | kernel | how |
//! |---|---|---|
//! | normal mixture | Gaussian | closed form \[Wand & Jones 1993\] |
//! | product of densities | product | from the errors on the two axes |
//! | normal mixture, product of densities | any other | quadrature over the kernel's support |
//! | any on a rectangle or a polygon | Gaussian, reflected or cut and normalised | moments by sums over cosines, see [`WalledKernel`] |
//! | any other | any | integrated errors are not known; [`plane_kernel_moments`] are |

mod adaptive;
mod adaptive_error;
mod deficit;
mod histogram;
mod pointwise;
mod twice;
mod walled;

pub use adaptive::{PlaneWidths, plane_adaptive_moments};
pub use adaptive_error::PlaneAdaptiveError;
pub use histogram::{PlaneHistogramError, plane_histogram_moments};
pub use pointwise::{plane_equivalent_moments, plane_kernel_moments};
pub use walled::WalledKernel;

use super::kernel::Parts;
use super::optimum::{self, Optimum, Oracle};
use super::{Asymptotic, Integrated, KernelError, NoAsymptotics};
use crate::density::{Bivariate, Density};
use crate::kernel::{Kernel, Shape, Symmetry};
use crate::numeric::{GaussLegendre, Sum, panels};
use deficit::{Pair, PlaneDeficit, closed, pairs};
use std::f64::consts::PI;
use std::sync::LazyLock;
use twice::PlaneTwice;

/// The integrated errors over the whole plane of kernel estimates of one density with one kernel, for any bandwidths and sample size.
///
/// "Whole plane" includes what leaks beyond walls. Microseconds a bandwidth in closed form, up to some tens of milliseconds by quadrature.
pub struct PlaneKernelError {
    shape: Shape,
    symmetry: Symmetry,
    path: Path,
    /// ∫(Δf)²
    curvature: f64,
    /// The shortest scale of the density, and its greatest deviation: where to look for optima.
    scales: (f64, f64),
}

enum Path {
    Closed(Vec<Pair>),
    Apart(Box<[KernelError; 2]>),
    Quadrature {
        deficit: PlaneDeficit,
        twice: PlaneTwice,
    },
}

static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(16));

impl PlaneKernelError {
    /// Prepares the errors; `None` for a density that is neither a normal mixture nor a product of densities on lines.
    pub fn new(truth: &dyn Bivariate, shape: Shape, symmetry: Symmetry) -> Option<Self> {
        let round = shape == Shape::Gaussian;
        let path = match (truth.normal_components(), truth.factors()) {
            (Some(components), _) if round => Path::Closed(pairs(components)),
            (None, Some(factors)) if round || symmetry == Symmetry::Product => {
                Path::Apart(Box::new(factors.map(|f| KernelError::new(f, shape))))
            }
            _ => return Self::by_quadrature(truth, shape, symmetry),
        };
        Some(Self::with(truth, shape, symmetry, path))
    }

    /// The same by quadrature even where there is a shorter way, so that each can be checked against the other.
    pub fn by_quadrature(truth: &dyn Bivariate, shape: Shape, symmetry: Symmetry) -> Option<Self> {
        let path = Path::Quadrature {
            deficit: PlaneDeficit::of(truth)?,
            twice: PlaneTwice::of(shape, symmetry),
        };
        Some(Self::with(truth, shape, symmetry, path))
    }

    fn with(truth: &dyn Bivariate, shape: Shape, symmetry: Symmetry, path: Path) -> Self {
        let (_, covariance) = truth.mean_and_covariance();
        Self {
            shape,
            symmetry,
            path,
            curvature: truth.laplacian_roughness(),
            scales: (
                truth.finest_scale(0).min(truth.finest_scale(1)),
                covariance[0][0].max(covariance[1][1]).sqrt(),
            ),
        }
    }

    /// The errors with a bandwidth for each axis and `draws` points (or the effective size of a weighted sample).
    pub fn at(&self, h: [f64; 2], draws: f64) -> Integrated {
        let parts = match &self.path {
            Path::Closed(pairs) => closed(pairs, h),
            Path::Apart(axes) => apart([axes[0].parts(h[0]), axes[1].parts(h[1])]),
            Path::Quadrature { deficit, twice } => self.integrated(deficit, twice, h),
        };
        let own = self.symmetry.roughness::<2>(self.shape) / (h[0] * h[1]);
        Integrated {
            squared_bias: parts.squared_bias,
            variance: (own - (parts.roughness - parts.lost)) / draws,
        }
    }

    /// Both integrals over the support of K * K, in units of the bandwidths: on a half plane, as D(-t) = D(t).
    fn integrated(&self, deficit: &PlaneDeficit, twice: &PlaneTwice, h: [f64; 2]) -> Parts {
        let (reach, [s, t]) = (twice.reach(), deficit.scales());
        // no panel is much longer than the density changes over, nor than the kernel does
        let longest = [s / h[0], t / h[1]].map(|scale| (1.5 * scale).min(2.0));
        let factor = self.symmetry.factor::<2>(self.shape);
        let (mut squared_bias, mut lost) = (Sum::default(), Sum::default());
        let mut add = |u: [f64; 2], weight: f64, kernel: f64, twice: f64| {
            // at u and mirrored in one axis; the other half is the same again
            let lacking =
                deficit.at([h[0] * u[0], h[1] * u[1]]) + deficit.at([h[0] * u[0], -h[1] * u[1]]);
            let part = 2.0 * weight * lacking;
            squared_bias.add(part * 2.0f64.mul_add(kernel, -twice));
            lost.add(part * twice);
        };
        match twice {
            PlaneTwice::Product(axis) => {
                let cuts = [0, 1].map(|k: usize| {
                    let kinks = deficit.kinks(k).into_iter().map(|t| t / h[k]);
                    panels(0.0, reach, kinks.chain([1.0]), longest[k])
                });
                let along = |axis: usize| -> Vec<(f64, f64)> {
                    (cuts[axis].windows(2))
                        .flat_map(|panel| RULE.on(panel[0], panel[1]))
                        .collect()
                };
                let (first, second) = (along(0), along(1));
                for &(u, a) in &first {
                    for &(v, b) in &second {
                        let kernel = self.shape.value(u) * self.shape.value(v);
                        add([u, v], a * b, kernel, axis.at(u) * axis.at(v));
                    }
                }
            }
            PlaneTwice::Radial(table) => {
                let longest = longest[0].min(longest[1]);
                for ring in panels(0.0, reach, [1.0], longest).windows(2) {
                    // arcs no longer than the panels are
                    let arc = (longest / ring[1]).min(0.5 * PI);
                    let sectors = panels(0.0, 0.5 * PI, [], arc);
                    for (r, a) in RULE.on(ring[0], ring[1]) {
                        let (kernel, twice) = (factor * self.shape.value(r), table(r));
                        for sector in sectors.windows(2) {
                            for (angle, b) in RULE.on(sector[0], sector[1]) {
                                let (sine, cosine) = angle.sin_cos();
                                add([r * cosine, r * sine], a * b * r, kernel, twice);
                            }
                        }
                    }
                }
            }
        }
        Parts {
            squared_bias: squared_bias.value().max(0.0),
            lost: lost.value(),
            roughness: deficit.total(),
        }
    }

    /// The bandwidth, the same on both axes, of least MISE, and all other local minima.
    pub fn optimum(&self, draws: f64) -> Optimum {
        let (finest, deviation) = self.scales;
        let low = finest * 0.01_f64.min(0.1 / draws.sqrt());
        let error = |h: f64| self.at([h, h], draws);
        match &self.path {
            // a ladder of hundreds of bandwidths, each many times the density, would take seconds
            Path::Quadrature { .. } => optimum::search_coarsely(error, 10.0 * low, 6.0 * deviation),
            _ => optimum::search(error, low, 20.0 * deviation),
        }
    }

    /// The leading terms for large samples, the bandwidth being the same on both axes.
    ///
    /// # Errors
    /// If ∫(Δf)² is infinite, so that there are none.
    pub fn asymptotic(&self, draws: f64) -> Result<Asymptotic, NoAsymptotics> {
        plane_asymptotic(self.curvature, self.shape, self.symmetry, draws)
    }
}

fn plane_asymptotic(
    curvature: f64,
    shape: Shape,
    symmetry: Symmetry,
    draws: f64,
) -> Result<Asymptotic, NoAsymptotics> {
    let (variance, roughness) = (
        symmetry.variance::<2>(shape),
        symmetry.roughness::<2>(shape),
    );
    Asymptotic::of_plane_kernel(variance, roughness, curvature, draws)
}

/// A product of densities under a product of kernels, from the parts of each axis: with b = ∫bias²/∫f² and l = lost/∫f² on the axes, the bias² of both
/// together is ∫f² (b₁ + b₂ + l₁l₂ - (b₁ + l₁)(b₂ + l₂)/2), in which nothing large cancels.
fn apart([x, y]: [Parts; 2]) -> Parts {
    let roughness = x.roughness * y.roughness;
    let [b, c] = [x, y].map(|axis| axis.squared_bias / axis.roughness);
    let [l, m] = [x, y].map(|axis| axis.lost / axis.roughness);
    let squared_bias = b + c + 0.5 * (l * m - b * m - c * l - b * c);
    Parts {
        squared_bias: (roughness * squared_bias).max(0.0),
        lost: roughness * (l + m - l * m),
        roughness,
    }
}

/// The optimum and the asymptotics of kernel estimates of `truth`, on a line for every density, in the plane for normal mixtures and products;
/// `None` where no exact theory is known. The symmetry only matters in the plane.
pub fn kernel_oracle<const D: usize>(
    truth: &dyn Density<D>,
    shape: Shape,
    symmetry: Symmetry,
    draws: f64,
) -> Option<Oracle> {
    if let Some(line) = truth.univariate() {
        return Some(KernelError::new(line, shape).oracle(draws));
    }
    let errors = PlaneKernelError::new(truth.bivariate()?, shape, symmetry)?;
    Some(Oracle {
        optimum: errors.optimum(draws),
        asymptotic: errors.asymptotic(draws),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::density::named_in_plane;

    fn normal() -> PlaneKernelError {
        let truth = named_in_plane("normal-2d").unwrap();
        PlaneKernelError::new(&*truth, Shape::Gaussian, Symmetry::Product).unwrap()
    }

    /// Each way against the others, where two are known.
    #[test]
    fn all_ways_agree() {
        use crate::density::{PlaneComponent, PlaneMixture, Product, named};
        let close = |a: Integrated, b: Integrated, what: &str| {
            for (x, y) in [(a.squared_bias, b.squared_bias), (a.variance, b.variance)] {
                assert!((x / y - 1.0).abs() < 1e-8, "{what}: {x:e} {y:e}");
            }
        };
        let widths = [[0.02, 0.03], [0.4, 0.4], [1.5, 0.7]];
        let truth = PlaneMixture::new(vec![
            PlaneComponent::new(0.5, [-1.0, 0.0], [0.5, 0.8], 0.6),
            PlaneComponent::new(0.5, [1.0, 0.5], [0.7, 0.4], 0.0),
        ])
        .unwrap();
        for symmetry in Symmetry::ALL {
            let short = PlaneKernelError::new(&truth, Shape::Gaussian, symmetry).unwrap();
            let long = PlaneKernelError::by_quadrature(&truth, Shape::Gaussian, symmetry).unwrap();
            for h in widths {
                close(short.at(h, 300.0), long.at(h, 300.0), symmetry.name());
            }
        }
        // a product of mixtures is a product, and of one normal each a normal of the plane
        let product = Product::new([named("uniform").unwrap(), named("bimodal").unwrap()]);
        let round = Product::new([named("normal").unwrap(), named("normal").unwrap()]);
        for shape in [Shape::Epanechnikov, Shape::Uniform, Shape::Gaussian] {
            let short = PlaneKernelError::new(&product, shape, Symmetry::Product).unwrap();
            let long = PlaneKernelError::by_quadrature(&product, shape, Symmetry::Product).unwrap();
            for h in [[0.02, 0.03], [0.4, 0.4]] {
                close(short.at(h, 300.0), long.at(h, 300.0), shape.name());
            }
            let normal = named_in_plane("normal-2d").unwrap();
            for symmetry in Symmetry::ALL {
                let one = PlaneKernelError::by_quadrature(&round, shape, symmetry).unwrap();
                let other = PlaneKernelError::by_quadrature(&*normal, shape, symmetry).unwrap();
                close(
                    one.at([0.3, 0.5], 50.0),
                    other.at([0.3, 0.5], 50.0),
                    shape.name(),
                );
            }
        }
    }

    /// 2.40 n^(-1/6) and 2.78 n^(-1/6) for the round Epanechnikov and biweight kernels. [Silverman 1986, table 4.1]
    #[test]
    fn round_kernels_have_the_published_constants() {
        let truth = named_in_plane("normal-2d").unwrap();
        let n = 1e6;
        for (shape, constant, digits) in [
            (Shape::Gaussian, 1.0, 1e-12),
            (Shape::Epanechnikov, 2.40, 0.005),
            (Shape::Biweight, 2.78, 0.005),
        ] {
            let errors = PlaneKernelError::new(&*truth, shape, Symmetry::Radial).unwrap();
            let found = errors.asymptotic(n).unwrap().best() * n.powf(1.0 / 6.0);
            assert!((found - constant).abs() < digits, "{shape}: {found}");
        }
        // the exact optimum nears it
        let errors = PlaneKernelError::new(&*truth, Shape::Epanechnikov, Symmetry::Radial).unwrap();
        let best = errors.optimum(1e8).at / errors.asymptotic(1e8).unwrap().best();
        assert!((best - 1.0).abs() < 0.01, "{best}");
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
                let m = plane_kernel_moments(&*truth, Shape::Gaussian, Symmetry::Product, h, n, x);
                bias.add((m.mean - truth.at(x)).powi(2) * step * step);
                variance.add(m.variance * step * step);
            }
        }
        let whole = normal().at(h, n);
        assert!((bias.value() / whole.squared_bias - 1.0).abs() < 1e-9);
        assert!((variance.value() / whole.variance - 1.0).abs() < 1e-9);
    }
}
