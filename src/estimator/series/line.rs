//! The Hermite series, on the line and in the plane.

use super::terms::{TAPER, TERMS};
use super::{Length, fit, plane};
use crate::density::{Density, Univariate};
use crate::estimator::normal::{likeliest, resolved};
use crate::estimator::{
    Build, BuildError, Context, Described, Estimate, Estimator, Family, FitError, Laws, Moments,
};
use crate::numeric::orthogonal::{Hermite, Placed};
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Point};
use crate::theory::{System, series_moments};

/// A series of Hermite functions about the mean of the data, in units of their deviation; or about `location`, in units of `scale`.
///
/// With one term the estimate is a multiple of a normal density of deviation `scale`: functions that fade like exp(-u²/2) fit best where the
/// density does. The mass is not kept: no function is constant. O(n J + m J) for J terms.
///
/// In the plane the functions are products, each axis placed by its own mean and deviation; a correlation of the axes must come from the higher terms.
pub struct HermiteSeries {
    length: Length,
    location: Option<f64>,
    scale: Option<f64>,
}

impl HermiteSeries {
    /// Where the functions are, where that is the same for all samples.
    fn fixed(&self) -> Option<Placed<Hermite>> {
        Some(Placed::about(self.location?, 0.0, self.scale?))
    }
}

impl Estimator<1> for HermiteSeries {
    fn laws(&self) -> Laws {
        let fixed = self.length.fixed().is_some();
        Laws {
            mass_conserving: false,
            // one bell
            non_negative: self.length.fixed() == Some(1),
            linear: fixed && self.fixed().is_some(),
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: true,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: fixed,
        }
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let placed = if let Some(placed) = self.fixed() {
            placed
        } else {
            let (centre, offset, deviation) = likeliest(sample);
            if self.scale.is_none() && !resolved(sample, deviation) {
                return Err(FitError::Degenerate(format!(
                    "all {} points are at {}: their deviation is no scale for a series; give `scale`",
                    sample.len(),
                    centre + offset
                )));
            }
            let (centre, offset) = self.location.map_or((centre, offset), |x| (x, 0.0));
            Placed::about(centre, offset, self.scale.unwrap_or(deviation))
        };
        let positive = Estimator::<1>::laws(self).non_negative;
        fit(sample, placed, self.length, positive, Vec::new())
    }

    fn expectation(
        &self,
        truth: &dyn Density<1>,
        draws: usize,
        places: &[Point<1>],
    ) -> Option<Vec<Moments>> {
        let (placed, terms) = (self.fixed()?, self.length.fixed()?);
        let taper = self.length.taper;
        Some(series_moments(
            truth,
            &placed,
            terms,
            taper,
            draws as f64,
            places.as_flattened(),
        ))
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Series {
            system: System::Hermite,
            place: [self.location, self.scale],
            taper: self.length.taper,
        })
    }
}

impl Estimator<2> for HermiteSeries {
    fn laws(&self) -> Laws {
        let fixed = self.length.fixed();
        Laws {
            mass_conserving: false,
            // one bell
            non_negative: fixed == Some(1),
            // the data place the functions
            linear: false,
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: true,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: fixed.is_some(),
        }
    }

    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        let mut placed = Vec::with_capacity(2);
        for axis in 0..2 {
            let coordinates = sample.points().iter().map(|x| [x[axis]]).collect();
            let along = Sample::new(coordinates, sample.weights().clone(), Domain::whole())
                .map_err(|error| FitError::Degenerate(error.to_string()))?;
            let (centre, offset, deviation) = likeliest(&along);
            if !resolved(&along, deviation) {
                return Err(FitError::Degenerate(format!(
                    "all {} points are at {} on axis {axis}: their deviation is no scale for a series",
                    sample.len(),
                    centre + offset
                )));
            }
            placed.push(Placed::<Hermite>::about(centre, offset, deviation));
        }
        let [x, y] = [placed[0], placed[1]];
        let positive = Estimator::<2>::laws(self).non_negative;
        plane::fit(sample, [x, y], self.length, positive, Vec::new())
    }
}

impl Build<2> for HermiteSeries {
    fn build(values: &Values, context: &Context<2>) -> Result<Self, BuildError> {
        let nowhere = |_: &dyn Univariate| -> Result<Placed<Hermite>, BuildError> {
            unreachable!("there is no truth on a line to place functions by")
        };
        Ok(Self {
            length: Length::given(values, None, context.draws, nowhere)?,
            location: None,
            scale: None,
        })
    }
}

impl Described for HermiteSeries {
    const NAME: &'static str = "hermite-series";
    const SUMMARY: &'static str =
        "a sum of Hermite functions: a normal density and corrections to it";
    const COST: &'static str = "O(n J + m J) for J terms; in the plane J²";
    const REFERENCE: &'static str = "Schwartz 1967; Walter 1977, Annals of Statistics 5";
    const SMOOTHING: Option<&'static str> = Some("terms");
    const PARAMETERS: &'static [Parameter] = &[
        TERMS,
        TAPER,
        Parameter::optional(
            "location",
            Kind::Real,
            Absent::Unset,
            "where the functions are centred, if not at the mean of the data",
        )
        .place()
        .only_in(1),
        Parameter::optional(
            "scale",
            Kind::Positive,
            Absent::Unset,
            "the deviation of the lowest term, if not that of the data",
        )
        .length()
        .only_in(1),
    ];
}

impl Build<1> for HermiteSeries {
    fn build(values: &Values, context: &Context<1>) -> Result<Self, BuildError> {
        let (location, scale) = (values.number("location"), values.number("scale"));
        let truth = context.truth.as_ref().and_then(|truth| truth.univariate());
        let length = Length::given(values, truth, context.draws, |truth| {
            // the best for functions placed by the truth, as data place them on average
            let (mean, deviation) = truth.mean_and_deviation();
            Ok(Placed::<Hermite>::about(
                location.unwrap_or(mean),
                0.0,
                scale.unwrap_or(deviation),
            ))
        })?;
        Ok(Self {
            length,
            location,
            scale,
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::parameter::Value;
    use crate::space::{Field, Grid};

    fn built(terms: u64) -> HermiteSeries {
        let mut values = Values::defaults(HermiteSeries::PARAMETERS);
        values.set("terms", Value::Count(terms));
        let context = Context {
            truth: None,
            draws: 60,
        };
        <HermiteSeries as Build<2>>::build(&values, &context).unwrap()
    }

    fn sample() -> Sample<2> {
        let points = (0..60)
            .map(|i| {
                let t = f64::from(i);
                [(t * 0.618).fract().powi(2), 40.0 * (t * 0.755).fract()]
            })
            .collect();
        Sample::equal(points, Domain::whole()).unwrap()
    }

    /// f̂ = Σ ĉⱼₖ ψⱼψₖ with ĉ the means of the products, each datum by itself.
    #[test]
    fn the_plane_is_a_product_of_lines() {
        let sample = sample();
        let estimate = Estimator::<2>::fit(&built(4), &sample).unwrap();
        let placed = [0, 1].map(|axis: usize| {
            let mean = sample.points().iter().map(|x| x[axis]).sum::<f64>() / 60.0;
            let square = |x: &Point<2>| (x[axis] - mean).powi(2);
            let variance = sample.points().iter().map(square).sum::<f64>() / 60.0;
            Placed::<Hermite>::about(mean, 0.0, variance.sqrt())
        });
        for target in [[0.1, 3.0], [0.8, 25.0], [2.0, -60.0]] {
            let at = |x: &Point<2>| [0, 1].map(|axis: usize| placed[axis].at(x[axis], 4));
            let [a, b] = at(&target);
            let mut expected = 0.0;
            for x in sample.points() {
                let [u, v] = at(x);
                let along = |f: &[f64], g: &[f64]| f.iter().zip(g).map(|(f, g)| f * g).sum::<f64>();
                expected += along(&a, &u) * along(&b, &v) / 60.0;
            }
            let got = estimate.at(target);
            assert!(
                (got - expected).abs() < 1e-13,
                "{target:?}: {got} {expected}"
            );
        }
    }

    #[test]
    fn one_term_is_a_bell_and_more_follow_the_data() {
        let sample = sample();
        let grid = Grid::new([-6.0, -150.0], [7.0, 190.0], [130, 130]).unwrap();
        let bell = Estimator::<2>::fit(&built(1), &sample).unwrap().on(&grid);
        assert!(bell.values().iter().all(|value| *value >= 0.0));
        let mass = |terms| {
            let estimate = Estimator::<2>::fit(&built(terms), &sample).unwrap();
            estimate.on(&grid).integral()
        };
        assert!((mass(9) - 1.0).abs() < 0.1, "{}", mass(9));
        let flat = (0..9).map(|i| [f64::from(i), 3.0]).collect();
        let flat = Sample::equal(flat, Domain::whole()).unwrap();
        assert!(Estimator::<2>::fit(&built(2), &flat).is_err());
    }
}
