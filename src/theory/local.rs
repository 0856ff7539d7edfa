//! How much smoothing is best at one place.

use super::neighbour::{Places, best_count};
use super::optimum::search_coarsely;
use super::{
    Asymptotic, Convention, Integrated, Moments, best_neighbours, kernel_moments,
    plane_kernel_moments,
};
use crate::density::{Bivariate, Density, Univariate};
use crate::kernel::{Kernel, Shape, Symmetry};
use crate::space::Point;

/// The best bandwidth or k at one place, and the error there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// Where the mean squared error at the place is least.
    pub at: f64,
    /// E f̂ - f there.
    pub bias: f64,
    /// var f̂ there.
    pub variance: f64,
    /// The same smoothing by the leading terms for large samples; infinite where the curvature vanishes, so that more smoothing is always better to
    /// this order.
    pub asymptotic: f64,
}

impl Local {
    /// The mean squared error.
    pub fn error(self) -> f64 {
        self.bias.mul_add(self.bias, self.variance)
    }
}

/// The least mean squared error between two bandwidths.
fn least(moments: impl Fn(f64) -> Moments, f: f64, low: f64, high: f64, asymptotic: f64) -> Local {
    let error = |h: f64| {
        let Moments { mean, variance } = moments(h);
        Integrated {
            squared_bias: (mean - f).powi(2),
            variance,
        }
    };
    let at = search_coarsely(error, low, high).at;
    let Moments { mean, variance } = moments(at);
    Local {
        at,
        bias: mean - f,
        variance,
        asymptotic,
    }
}

/// h⁴ k₂² f''²/4 + f R(K)/(n h): least at h⁵ = f R(K)/(n k₂² f''²). [Silverman 1986, section 3.3; Wand & Jones 1995, section 2.5]
pub(super) fn best_kernel_at(truth: &dyn Univariate, shape: Shape, draws: f64, x: f64) -> Local {
    let (f, curvature) = (truth.at([x]), truth.derivative(2, x).powi(2));
    let leading = Asymptotic::of_kernel(shape.variance(), shape.roughness() * f, curvature, draws);
    let (finest, deviation) = (truth.finest_scale(0), truth.mean_and_deviation().1);
    let low = finest * 0.05_f64.min(1.0 / draws.sqrt());
    least(
        |h| kernel_moments(truth, shape, h, draws, x),
        f,
        low,
        10.0 * deviation,
        leading.map_or(f64::INFINITY, |leading| leading.best()),
    )
}

/// h⁴ k₂² (Δf)²/4 + f R(K)/(n h²): least at h⁶ = 2 f R(K)/(n k₂² (Δf)²).
pub(super) fn best_kernel_in_plane_at(
    truth: &dyn Bivariate,
    (shape, symmetry): (Shape, Symmetry),
    draws: f64,
    x: Point<2>,
) -> Local {
    let (f, curvature) = (truth.at(x), truth.laplacian(x).powi(2));
    let leading = Asymptotic::of_plane_kernel(
        symmetry.variance::<2>(shape),
        symmetry.roughness::<2>(shape) * f,
        curvature,
        draws,
    );
    let (_, covariance) = truth.mean_and_covariance();
    let deviation = covariance[0][0].max(covariance[1][1]).sqrt();
    let finest = truth.finest_scale(0).min(truth.finest_scale(1));
    let low = finest * 0.05_f64.min(draws.powf(-0.25));
    least(
        |h| plane_kernel_moments(truth, shape, symmetry, [h, h], draws, x),
        f,
        low,
        8.0 * deviation,
        leading.map_or(f64::INFINITY, |leading| leading.best()),
    )
}

/// The best k ≥ 3 at a place.
pub(super) fn best_neighbour_at<const D: usize>(
    truth: &dyn Density<D>,
    convention: Convention,
    draws: usize,
    place: Point<D>,
) -> Option<Local> {
    if draws < 4 {
        return None;
    }
    let alone = [place];
    let places = Places::new(truth, &alone)?;
    let f = truth.at(place);
    let moments = |k: usize| places.moments(k, convention, draws).map(|all| all[0]);
    moments(3)?;
    let error = |m: Option<Moments>| m.map_or(f64::INFINITY, |m| (m.mean - f).powi(2) + m.variance);
    let (k, best) = best_count(3, draws - 1, moments, error);
    let curvature = match (truth.univariate(), &place[..]) {
        (Some(line), &[x]) => line.derivative(2, x),
        (None, &[x, y]) => truth.bivariate()?.laplacian([x, y]),
        _ => return None,
    };
    let Moments { mean, variance } = best?;
    Some(Local {
        at: k as f64,
        bias: mean - f,
        variance,
        asymptotic: best_neighbours::<D>(draws as f64, f, curvature),
    })
}
