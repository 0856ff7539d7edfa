//! The nearest-neighbour estimator with any kernel, and the filters of photon maps.

use super::balloon::{Ball, Rule, fit};
use super::nearest_neighbour::{K, k};
use super::{Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws};
use crate::kernel::{Kernel, Shape, Symmetry};
use crate::neighbour::{Scratch, Searchable};
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;

/// f̂(x) = Σ wᵢ K((x - Xᵢ)/d_k) / d_kᵈ over all points but the k-th, with d_k the distance from x to the k-th nearest point and K radial in the plane.
/// [Silverman 1986, eq. 5.2, in d dimensions]
///
/// Given d_k, the k - 1 points nearer than that are spread evenly in the ball where the density is even, so any kernel of unit mass is exactly unbiased
/// there **if the k-th is left out**; with a kernel that is 0 at the edge it is left out by itself. The uniform kernel is then
/// `nearest-neighbour` in its unbiased convention. The Gaussian sums over all points, with d_k for its deviation.
///
/// | shape | weight at u = d/d_k, over the volume V(d_k) | mean where the density is even |
/// |---|---|---|
/// | a kernel | V(1) K(u) | f |
/// | `jensen-cone` | (1 - s u) / (1 - s d/(d + 1)), s the steepness | f |
/// | `jensen-gaussian` | α (1 - (1 - exp(-β u²/2)) / (1 - exp(-β))), α = 0.918, β = 1.953 | 0.5312 f in the plane |
/// | `jensen-gaussian-corrected` | the same with α/0.5312 = 1.7283 | f |
///
/// The filters are those of Jensen 1996 and 2001. The Gaussian one was published with an α that makes it 46.9 % too dark [Garcia Hernandez et al. 2014];
/// here both are to be had. Jensen's slope k is 1/s; as published the k-th photon is kept, which is consistent for s = 1 only.
///
/// **Limits.** As for `nearest-neighbour`: the integral is not the mass, walls are not seen. Where points at the target are k or more, the first neighbour
/// farther away takes the place of the k-th, with a warning. On a periodic axis a kernel that reaches farther than half round is cut off.
#[derive(Clone, Copy, Debug)]
pub struct GeneralisedNearestNeighbour {
    k: usize,
    profile: Profile,
}

/// The weight of a point by its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Profile {
    Kernel(Shape),
    Cone { steepness: f64 },
    JensenGaussian { corrected: bool },
}

/// Jensen's constants of the Gaussian filter. [Jensen 2001, section 7.2.1]
const ALPHA: f64 = 0.918;
const BETA: f64 = 1.953;

/// How far the Gaussian kernel is summed: beyond it is below 1e-17 of its peak.
const GAUSSIAN_REACH: f64 = 8.9;

/// Jensen's Gaussian filter at distance u d_k.
fn jensen(u: f64) -> f64 {
    ALPHA * (1.0 - (-0.5 * BETA * u * u).exp_m1() / (-BETA).exp_m1())
}

/// Its mean over the unit ball, what an estimate with it is of the density: 0.5312 in the plane.
fn jensen_mean<const D: usize>() -> f64 {
    let inside = if D == 1 {
        // ∫₀¹ exp(-βu²/2) du
        let root = (0.5 * BETA).sqrt();
        libm::erf(root) * std::f64::consts::PI.sqrt() / (2.0 * root)
    } else {
        // 2 ∫₀¹ u exp(-βu²/2) du
        -(-0.5 * BETA).exp_m1() / (0.5 * BETA)
    };
    ALPHA * (1.0 + (1.0 - inside) / (-BETA).exp_m1())
}

impl Profile {
    fn weight(self, u: f64) -> f64 {
        match self {
            Self::Kernel(shape) => shape.value(u),
            Self::Cone { steepness } => 1.0 - steepness * u,
            Self::JensenGaussian { .. } => jensen(u),
        }
    }

    /// Whether it is zero at the edge of the ball; then the k-th point drops out by itself.
    fn fades(self) -> bool {
        // the cosine is 5e-17 there
        self.weight(1.0).abs() < 1e-12
    }
}

impl<const D: usize> Rule<D> for Profile {
    fn density(self, ball: &Ball<'_, D>, _scratch: &mut Scratch) -> f64 {
        let radius = ball.radius();
        let reach = match self {
            Self::Kernel(Shape::Gaussian) => GAUSSIAN_REACH,
            _ => 1.0,
        };
        let content = ball.content(reach, |u| self.weight(u));
        // of those as far as the k-th, the k-th is left out; which one it is, is not known, so the rest stand for all
        let kept = if reach > 1.0 {
            content.tied - 1
        } else {
            ball.rank - 1 - content.nearer
        };
        let share = kept as f64 / content.tied as f64;
        let edge = share * content.edge * self.weight(1.0);
        let sum = content.inside + edge + content.outside;
        match self {
            Self::Kernel(shape) => {
                Symmetry::Radial.factor::<D>(shape) * sum / radius.powi(D as i32)
            }
            Self::Cone { steepness } => {
                let dimension = D as f64;
                sum / ((1.0 - steepness * dimension / (dimension + 1.0))
                    * ball.metric().ball(radius))
            }
            Self::JensenGaussian { corrected } => {
                let mean = if corrected { jensen_mean::<D>() } else { 1.0 };
                sum / (mean * ball.metric().ball(radius))
            }
        }
    }
}

impl<const D: usize> Estimator<D> for GeneralisedNearestNeighbour
where
    Sample<D>: Searchable<D>,
{
    fn laws(&self) -> Laws {
        Laws {
            mass_conserving: false,
            non_negative: true,
            linear: false,
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: self.profile.fades(),
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: false,
        }
    }

    fn fit(&self, sample: &Sample<D>) -> Result<Estimate<D>, FitError> {
        fit(sample, self.k, self.k, self.profile)
    }
}

/// Kernels, then filters.
const SHAPES: [&str; 10] = [
    "epanechnikov",
    "cosine",
    "biweight",
    "triweight",
    "triangular",
    "gaussian",
    "uniform",
    "jensen-cone",
    "jensen-gaussian",
    "jensen-gaussian-corrected",
];

impl Described for GeneralisedNearestNeighbour {
    const NAME: &'static str = "generalised-nearest-neighbour";
    const SUMMARY: &'static str = "a kernel on each point, as wide as the k-th neighbour of the target is far; filters of photon maps";
    const COST: &'static str = "O(n log n + m k); O(n + m k) in the plane where the data are spread evenly; a Gaussian sums some 80 k points in the plane";
    const REFERENCE: &'static str =
        "Silverman 1986, eq. 5.2; Jensen 2001, section 7.2.1; Garcia Hernandez et al. 2014";
    const SMOOTHING: Option<&'static str> = Some("k");
    const PARAMETERS: &'static [Parameter] = &[
        K,
        Parameter::optional(
            "shape",
            Kind::Choice(&SHAPES),
            Absent::Word("epanechnikov"),
            "a kernel, or a filter of photon maps",
        ),
        Parameter::optional(
            "steepness",
            Kind::Fraction,
            Absent::Number(1.0),
            "of jensen-cone: what the weight has lost at the edge of the ball, 1/k in Jensen's letters; other shapes ignore it",
        ),
    ];
}

impl<const D: usize> Build<D> for GeneralisedNearestNeighbour
where
    Sample<D>: Searchable<D>,
{
    fn build(values: &Values, _context: &Context<D>) -> Result<Self, BuildError> {
        let steepness = values.number("steepness").unwrap_or(1.0);
        let word = values.word("shape").unwrap_or("epanechnikov");
        let profile = match word {
            "jensen-cone" => Profile::Cone { steepness },
            "jensen-gaussian" => Profile::JensenGaussian { corrected: false },
            "jensen-gaussian-corrected" => Profile::JensenGaussian { corrected: true },
            _ => Profile::Kernel(Shape::named(word).unwrap_or(Shape::Epanechnikov)),
        };
        Ok(Self {
            k: k(values),
            profile,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::GaussLegendre;

    #[test]
    fn every_kernel_is_among_the_shapes() {
        assert_eq!(SHAPES[..Shape::NAMES.len()], Shape::NAMES);
    }

    /// [Garcia Hernandez et al. 2014]
    #[test]
    fn the_gaussian_filter_of_photon_maps_is_too_dark() {
        assert!((jensen_mean::<2>() - 0.5312).abs() < 5e-5);
        assert!((ALPHA / jensen_mean::<2>() - 1.7283).abs() < 5e-5);
    }

    #[test]
    fn means_over_the_ball_are_integrals() {
        let rule = GaussLegendre::new(40);
        let line = rule.integrate(jensen, 0.0, 1.0);
        let plane = rule.integrate(|u| 2.0 * u * jensen(u), 0.0, 1.0);
        assert!((jensen_mean::<1>() - line).abs() < 1e-14);
        assert!((jensen_mean::<2>() - plane).abs() < 1e-14);
    }
}
