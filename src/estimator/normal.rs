//! The parametric baseline: what an assumption is worth, right or wrong.

use super::{Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws};
use crate::numeric::{Sum, special::normal_density};
use crate::parameter::{Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Field, Point};
use std::sync::Arc;

/// f̂(x) = φ((x - μ)/σ)/σ with μ and σ by maximum likelihood, σ² = Σ wᵢ (Xᵢ - μ)² / Σ wᵢ; in the plane with the mean and the covariance of the
/// points.
///
/// The error falls like 1/n if the data are normal and not at all below the distance of the nearest normal if they are not. The normal is that
/// of the total; a channel is the same normal with the mass of the channel.
///
/// O(n + m).
pub struct Normal;

struct Fitted {
    mass: f64,
    /// The mean in two parts, so that far from zero it has more digits than one number could hold.
    centre: f64,
    offset: f64,
    deviation: f64,
    domain: Domain<1>,
}

impl Field<1> for Fitted {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        self.mass * normal_density((x - self.centre - self.offset) / self.deviation)
            / self.deviation
    }
}

const LAWS: Laws = Laws {
    mass_conserving: true,
    non_negative: true,
    linear: false,
    reproduces_constants: false,
    reproduces_linear: false,
    continuous: true,
    deterministic: true,
    scale_equivariant: true,
    translation_equivariant: true,
    repeatable: true,
};

impl Estimator<1> for Normal {
    fn laws(&self) -> Laws {
        LAWS
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let (centre, offset, deviation) = likeliest(sample);
        if !resolved(sample, deviation) {
            return Err(FitError::Degenerate(format!(
                "all {} points are at {}: no normal density is likeliest for data without spread; choose another estimator",
                sample.len(),
                centre + offset
            )));
        }
        let field = |mass| -> Arc<dyn Field<1>> {
            Arc::new(Fitted {
                mass,
                centre,
                offset,
                deviation,
                domain: sample.domain().clone(),
            })
        };
        Ok(Estimate::new(field(sample.mass())).with_channels(
            (0..sample.channels())
                .map(|c| field(sample.channel(c).mass()))
                .collect(),
        ))
    }
}

/// The normal of the plane, by its regression of the second axis on the first.
#[derive(Clone)]
pub(super) struct FittedPlane {
    mass: f64,
    /// The mean in two parts, as on the line.
    pub centre: Point<2>,
    pub offset: Point<2>,
    /// The deviation of the first axis, and of the second about the regression.
    pub deviation: [f64; 2],
    pub slope: f64,
    domain: Domain<2>,
}

impl Field<2> for FittedPlane {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        let [u, v] = [0, 1].map(|axis: usize| x[axis] - self.centre[axis] - self.offset[axis]);
        let [s, t] = self.deviation;
        self.mass * normal_density(u / s) / s * normal_density((v - self.slope * u) / t) / t
    }
}

impl Estimator<2> for Normal {
    fn laws(&self) -> Laws {
        LAWS
    }

    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        let fitted = likeliest_plane(sample);
        if !resolved_plane(sample, &fitted) {
            return Err(FitError::Degenerate(format!(
                "all {} points are at one place or on one line: no normal density is likeliest for data without spread; choose another estimator",
                sample.len(),
            )));
        }
        let field = |mass| -> Arc<dyn Field<2>> {
            Arc::new(FittedPlane {
                mass,
                ..fitted.clone()
            })
        };
        Ok(Estimate::new(field(sample.mass())).with_channels(
            (0..sample.channels())
                .map(|c| field(sample.channel(c).mass()))
                .collect(),
        ))
    }
}

/// Whether the spread of the data in every direction is more than what rounding leaves of none.
pub(super) fn resolved_plane(sample: &Sample<2>, fitted: &FittedPlane) -> bool {
    let largest = |axis: usize| {
        sample
            .points()
            .iter()
            .enumerate()
            .filter(|&(i, _)| sample.weight(i) > 0.0)
            .fold(0.0, |largest: f64, (_, x)| largest.max(x[axis].abs()))
    };
    let resolution = 4.0 * f64::EPSILON;
    let least = [
        resolution * largest(0),
        resolution * (largest(1) + fitted.slope.abs() * largest(0)),
    ];
    // so written that NaN is refused
    (0..2).all(|k| fitted.deviation[k] > least[k] && fitted.deviation[k].recip().is_finite())
}

/// Mean, deviations and regression, in three passes so that nothing cancels: residuals are summed as such. O(n).
pub(super) fn likeliest_plane(sample: &Sample<2>) -> FittedPlane {
    let points = sample.points();
    let centre = (0..points.len())
        .find(|&i| sample.weight(i) > 0.0)
        .map_or([0.0; 2], |i| points[i]);
    let mean = |value: &dyn Fn(f64, f64) -> f64| {
        let sum: Sum = points
            .iter()
            .enumerate()
            .map(|(i, x)| sample.weight(i) * value(x[0] - centre[0], x[1] - centre[1]))
            .collect();
        sum.value() / sample.mass()
    };
    let offset = [mean(&|u, _| u), mean(&|_, v| v)];
    let [a, b] = offset;
    let square = mean(&|u, _| (u - a).powi(2));
    let slope = if square > 0.0 {
        mean(&|u, v| (u - a) * (v - b)) / square
    } else {
        0.0
    };
    let residual = mean(&|u, v| (v - b - slope * (u - a)).powi(2));
    FittedPlane {
        mass: sample.mass(),
        centre,
        offset,
        deviation: [square.sqrt(), residual.sqrt()],
        slope,
        domain: sample.domain().clone(),
    }
}

/// Whether a deviation is one: a spread below the resolution of the numbers themselves is no spread. O(n).
pub(super) fn resolved(sample: &Sample<1>, deviation: f64) -> bool {
    let largest = sample
        .coordinates()
        .iter()
        .enumerate()
        .filter(|&(i, _)| sample.weight(i) > 0.0)
        .fold(0.0, |largest: f64, (_, x)| largest.max(x.abs()));
    deviation > 4.0 * f64::EPSILON * largest && deviation.recip().is_finite()
}

/// A point of the sample, the distance of the mean from it, and the deviation. O(n).
pub(super) fn likeliest(sample: &Sample<1>) -> (f64, f64, f64) {
    let x = sample.coordinates();
    // a point of weight zero may be anywhere, and a far centre costs digits
    let centre = (0..x.len())
        .find(|&i| sample.weight(i) > 0.0)
        .map_or(0.0, |i| x[i]);
    let about = |offset: f64, power: i32| {
        let sum: Sum = x
            .iter()
            .enumerate()
            .map(|(i, x)| sample.weight(i) * (x - centre - offset).powi(power))
            .collect();
        sum.value() / sample.mass()
    };
    let offset = about(0.0, 1);
    (centre, offset, about(offset, 2).sqrt())
}

impl Described for Normal {
    const NAME: &'static str = "normal";
    const SUMMARY: &'static str =
        "the likeliest normal density: right if the data are normal, else never";
    const COST: &'static str = "O(n + m)";
    const REFERENCE: &'static str = "Silverman 1986, section 1.1";
    const SMOOTHING: Option<&'static str> = None;
    const PARAMETERS: &'static [Parameter] = &[];
}

impl<const D: usize> Build<D> for Normal
where
    Self: Estimator<D>,
{
    fn build(_values: &Values, _context: &Context<D>) -> Result<Self, BuildError> {
        Ok(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Domain;

    #[test]
    fn the_likeliest_normal_divides_by_the_mass() {
        let points = vec![[1.0], [2.0], [4.0], [7.0], [1e18]];
        let weights = vec![3.0, 1.0, 1.0, 1.0, 0.0];
        let sample = Sample::normalised(points, weights, Domain::whole()).expect("legal");
        let (centre, offset, deviation) = likeliest(&sample);
        let mean = centre + offset;
        let expected: f64 = (3.0 * (1.0 - 8.0 / 3.0_f64).powi(2)
            + (2.0 - 8.0 / 3.0_f64).powi(2)
            + (4.0 - 8.0 / 3.0_f64).powi(2)
            + (7.0 - 8.0 / 3.0_f64).powi(2))
            / 6.0;
        assert!((mean - 8.0 / 3.0).abs() < 1e-15);
        assert!((deviation - expected.sqrt()).abs() < 1e-14);
        let fitted = Normal.fit(&sample).expect("spread");
        let peak = 1.0 / (std::f64::consts::TAU.sqrt() * deviation);
        assert!((fitted.at([mean]) - peak).abs() < 1e-15);
    }

    #[test]
    fn data_without_spread_are_refused() {
        for x in [vec![[2.0]], vec![[1e9 / 3.0]; 7], vec![[0.0]; 3]] {
            let sample = Sample::equal(x, Domain::whole()).expect("legal");
            assert!(matches!(Normal.fit(&sample), Err(FitError::Degenerate(_))));
        }
    }

    #[test]
    fn in_the_plane_the_covariance_is_that_of_the_points() {
        let points = vec![
            [1.0, 0.5],
            [2.0, -1.0],
            [4.0, 3.0],
            [7.0, 2.5],
            [1e18, -4.0],
        ];
        let weights = vec![3.0, 1.0, 1.0, 1.0, 0.0];
        let sample =
            Sample::normalised(points.clone(), weights.clone(), Domain::whole()).expect("legal");
        let mean = |f: &dyn Fn(Point<2>) -> f64| {
            let total: f64 = (0..4).map(|i| weights[i] * f(points[i])).sum();
            total / 6.0
        };
        let (a, b) = (mean(&|x| x[0]), mean(&|x| x[1]));
        let xx = mean(&|x| (x[0] - a).powi(2));
        let yy = mean(&|x| (x[1] - b).powi(2));
        let xy = mean(&|x| (x[0] - a) * (x[1] - b));
        let determinant = xx * yy - xy * xy;
        let fitted = Normal.fit(&sample).expect("spread");
        for x in [[a, b], [3.0, 1.0], [0.0, -2.0], [6.0, 5.0]] {
            let (u, v) = (x[0] - a, x[1] - b);
            let square = (yy * u * u - 2.0 * xy * u * v + xx * v * v) / determinant;
            let expected = (-square / 2.0).exp() / (std::f64::consts::TAU * determinant.sqrt());
            assert!((fitted.at(x) - expected).abs() < 1e-14, "{x:?}");
        }
    }

    #[test]
    fn points_on_a_line_in_the_plane_are_refused() {
        let third: f64 = 1.0 / 3.0;
        for points in [
            vec![[1.0, 2.0]],
            vec![[1e9 / 3.0, 5.0]; 6],
            (0..9).map(|i| [f64::from(i), 4.0]).collect(),
            (0..9).map(|i| [4.0, f64::from(i)]).collect(),
            (0..9)
                .map(|i| [f64::from(i), third.mul_add(f64::from(i), 1e9)])
                .collect(),
        ] {
            let sample = Sample::<2>::equal(points, Domain::whole()).expect("legal");
            assert!(
                matches!(Normal.fit(&sample), Err(FitError::Degenerate(_))),
                "{sample:?}"
            );
        }
    }
}
