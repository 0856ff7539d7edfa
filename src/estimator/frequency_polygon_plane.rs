//! The frequency polygon of the plane: bilinear between the middles of the bins of a histogram.

use super::cells::{Cells, Lattice};
use super::{
    Build, BuildError, Context, Described, Estimate, Estimator, FitError, FrequencyPolygon, Laws,
    Moments,
};
use crate::density::Density;
use crate::parameter::{Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Field, Point};
use std::sync::Arc;

/// Bilinear interpolation between the values of a histogram at the centres of its bins, empty bins included: continuous, of the mass of the histogram. \[Scott 1992, section 4.2; Hjort 1986\]
///
/// O(n log n + m log n).
pub struct FrequencyPolygonPlane {
    lattice: Lattice,
}

struct Fitted {
    lattice: Lattice,
    cells: Cells,
    domain: Domain<2>,
}

/// The four bins between whose centres `x` lies, with their shares.
fn corners(lattice: &Lattice, x: Point<2>) -> Option<[([f64; 2], f64); 4]> {
    let place = [0, 1].map(|k: usize| (x[k] - lattice.origin[k]) / lattice.widths[k] - 0.5);
    if !place.iter().all(|place| place.is_finite()) {
        return None;
    }
    let first = place.map(f64::floor);
    let share = [place[0] - first[0], place[1] - first[1]];
    Some(
        [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)].map(|(i, j)| {
            let part = |share: f64, step: f64| if step > 0.5 { share } else { 1.0 - share };
            (
                [first[0] + i, first[1] + j],
                part(share[0], i) * part(share[1], j),
            )
        }),
    )
}

impl Field<2> for Fitted {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        let mass = |number| self.cells.get(number).map_or(0.0, |sums| sums[0]);
        let four = corners(&self.lattice, x).into_iter().flatten();
        let sum: f64 = four.map(|(number, share)| share * mass(number)).sum();
        sum / self.lattice.area()
    }
}

impl Estimator<2> for FrequencyPolygonPlane {
    fn laws(&self) -> Laws {
        Laws {
            mass_conserving: true,
            non_negative: true,
            linear: true,
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: true,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: true,
        }
    }

    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        let field = |sample: &Sample<2>| -> Result<Arc<dyn Field<2>>, FitError> {
            Ok(Arc::new(Fitted {
                lattice: self.lattice,
                cells: Cells::masses(sample, &self.lattice)?,
                domain: sample.domain().clone(),
            }))
        };
        let channels = (0..sample.channels())
            .map(|c| field(&sample.channel(c)))
            .collect::<Result<_, _>>()?;
        let mut estimate = Estimate::new(field(sample)?).with_channels(channels);
        estimate.smoothing = Some(self.lattice.area().sqrt());
        Ok(estimate)
    }

    fn expectation(
        &self,
        truth: &dyn Density<2>,
        draws: usize,
        places: &[Point<2>],
    ) -> Option<Vec<Moments>> {
        let area = self.lattice.area();
        let at = |&x: &Point<2>| {
            let four = corners(&self.lattice, x).into_iter().flatten();
            let cells = four.map(|(number, share)| (number, share / area));
            self.lattice.moments(truth, draws, cells)
        };
        Some(places.iter().map(at).collect())
    }
}

impl Described for FrequencyPolygonPlane {
    const NAME: &'static str = FrequencyPolygon::NAME;
    const SUMMARY: &'static str = FrequencyPolygon::SUMMARY;
    const COST: &'static str = FrequencyPolygon::COST;
    const REFERENCE: &'static str = FrequencyPolygon::REFERENCE;
    const SMOOTHING: Option<&'static str> = FrequencyPolygon::SMOOTHING;
    const PARAMETERS: &'static [Parameter] = FrequencyPolygon::PARAMETERS;
}

impl Build<2> for FrequencyPolygonPlane {
    fn build(values: &Values, _context: &Context<2>) -> Result<Self, BuildError> {
        let Some(x) = values.number("width") else {
            return Err(BuildError {
                parameter: "width",
                what: format!(
                    "\"{}\" chooses widths on a line; in the plane give a number",
                    values.word("width").unwrap_or_default()
                ),
            });
        };
        let origin = values.number("origin").unwrap_or(0.0);
        Ok(Self {
            lattice: Lattice {
                widths: [x, values.number("width-y").unwrap_or(x)],
                origin: [origin, values.number("origin-y").unwrap_or(origin)],
            },
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::density;
    use crate::parameter::Value;
    use crate::space::Grid;

    fn polygon() -> FrequencyPolygonPlane {
        let mut values = Values::defaults(FrequencyPolygonPlane::PARAMETERS);
        values.set("width", Value::Number(0.5));
        values.set("width-y", Value::Number(0.4));
        let context = Context {
            truth: None,
            draws: 10,
        };
        FrequencyPolygonPlane::build(&values, &context).unwrap()
    }

    #[test]
    fn it_goes_through_the_histogram_and_is_bilinear_between() {
        let points = vec![[0.1, 0.1], [0.4, 0.3], [0.6, 0.1], [-0.2, 0.9]];
        let sample = Sample::equal(points, Domain::whole()).unwrap();
        let estimate = polygon().fit(&sample).unwrap();
        let one = 0.25 / 0.2;
        for (x, count) in [([0.25, 0.2], 2.0), ([0.75, 0.2], 1.0), ([0.25, 0.6], 0.0)] {
            assert!((estimate.at(x) - count * one).abs() < 1e-14, "{x:?}");
        }
        assert!((estimate.at([0.5, 0.2]) - 1.5 * one).abs() < 1e-14);
        assert!((estimate.at([0.5, 0.3]) - 1.125 * one).abs() < 1e-14);
        let grid = Grid::new([-1.0, -0.6], [1.5, 1.8], [500, 480]).unwrap();
        assert!((estimate.on(&grid).integral() - 1.0).abs() < 1e-12);
        assert!(estimate.at([1e300, 0.0]).abs() < 1e-300);
    }

    /// At the centre of a bin it is the histogram, whose count is binomial.
    #[test]
    fn moments_are_those_of_counts() {
        let truth = density::named_in_plane("normal-2d").unwrap();
        let moments = polygon().expectation(&*truth, 40, &[[0.25, 0.2]]).unwrap();
        let share = truth.probability([0.0, 0.0], [0.5, 0.4]);
        assert!((moments[0].mean - share / 0.2).abs() < 1e-14);
        let variance = share * (1.0 - share) / 40.0 / 0.04;
        assert!((moments[0].variance - variance).abs() < 1e-12);
    }
}
