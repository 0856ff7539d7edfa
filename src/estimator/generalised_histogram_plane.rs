//! The generalised histogram of the plane: each bin holds a product of polynomials.

use super::cells::{Cells, Lattice};
use super::generalised_histogram::{HIGHEST, legendre};
use super::{
    Build, BuildError, Context, Described, Estimate, Estimator, FitError, GeneralisedHistogram,
    Laws, Moments,
};
use crate::density::Density;
use crate::parameter::{Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Field, Point};
use crate::theory::{Support, plane_equivalent_moments};
use rayon::prelude::*;
use std::sync::Arc;

/// f̂(x, y) = Σⱼₖ (2j + 1)(2k + 1) Pⱼ(s) Pₖ(t) Mⱼₖ / (width-x · width-y) for j, k up to the degree, with (s, t) from -1 to 1 across the bin and Mⱼₖ = Σ wᵢ Pⱼ(sᵢ) Pₖ(tᵢ) over its data.
///
/// As on the line: degree 0 is the histogram, and what is such a polynomial in each bin is reproduced without bias. O(n log n + m log n), with (degree + 1)² numbers a bin.
pub struct GeneralisedHistogramPlane {
    lattice: Lattice,
    degree: usize,
}

/// P₀ to P of the highest degree.
fn all(t: f64) -> [f64; HIGHEST + 1] {
    let [first, second, third] = legendre(t);
    [1.0, first, second, third]
}

struct Fitted {
    lattice: Lattice,
    cells: Cells,
    degree: usize,
    domain: Domain<2>,
}

impl Field<2> for Fitted {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        let number = self.lattice.number(x);
        let Some(moments) = self.cells.get(number) else {
            return 0.0;
        };
        let [s, t] = self.lattice.across(number, x).map(all);
        let terms = self.degree + 1;
        let mut sum = 0.0;
        for j in 0..terms {
            for k in 0..terms {
                let norm = ((2 * j + 1) * (2 * k + 1)) as f64;
                sum += norm * s[j] * t[k] * moments[j * terms + k];
            }
        }
        sum / self.lattice.area()
    }
}

impl Estimator<2> for GeneralisedHistogramPlane {
    fn laws(&self) -> Laws {
        Laws {
            mass_conserving: true,
            non_negative: self.degree == 0,
            linear: true,
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: false,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: true,
        }
    }

    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        let terms = self.degree + 1;
        let values = |place: [f64; 2], row: &mut [f64]| {
            let [s, t] = place.map(all);
            for j in 0..terms {
                for k in 0..terms {
                    row[j * terms + k] = s[j] * t[k];
                }
            }
        };
        let field = |sample: &Sample<2>| -> Result<Arc<dyn Field<2>>, FitError> {
            Ok(Arc::new(Fitted {
                lattice: self.lattice,
                cells: Cells::of(sample, &self.lattice, terms * terms, values)?,
                degree: self.degree,
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

    /// f̂(x) is the mean of κ(x, Xᵢ) = Σⱼₖ (2j + 1)(2k + 1) Pⱼ(s) Pₖ(t) Pⱼ(sᵢ) Pₖ(tᵢ) / (width-x · width-y) over the points in the bin of x: by quadrature over the bin.
    fn expectation(
        &self,
        truth: &dyn Density<2>,
        draws: usize,
        places: &[Point<2>],
    ) -> Option<Vec<Moments>> {
        let lattice = &self.lattice;
        let at = |&x: &Point<2>| {
            let number = lattice.number(x);
            let here = lattice.across(number, x).map(all);
            let kernel = |y: Point<2>| {
                let there = lattice.across(number, y).map(all);
                let axis = |axis: usize| -> f64 {
                    (0..=self.degree)
                        .map(|j| (2 * j + 1) as f64 * here[axis][j] * there[axis][j])
                        .sum()
                };
                axis(0) * axis(1) / lattice.area()
            };
            let support = Support {
                centre: [0, 1].map(|k: usize| {
                    (number[k] + 0.5).mul_add(lattice.widths[k], lattice.origin[k])
                }),
                reach: lattice.widths.map(|width| 0.5 * width),
                round: false,
            };
            plane_equivalent_moments(truth, kernel, support, f64::INFINITY, draws as f64)
        };
        Some(places.par_iter().map(at).collect())
    }
}

impl Described for GeneralisedHistogramPlane {
    const NAME: &'static str = GeneralisedHistogram::NAME;
    const SUMMARY: &'static str = GeneralisedHistogram::SUMMARY;
    const COST: &'static str = GeneralisedHistogram::COST;
    const REFERENCE: &'static str = GeneralisedHistogram::REFERENCE;
    const SMOOTHING: Option<&'static str> = GeneralisedHistogram::SMOOTHING;
    const PARAMETERS: &'static [Parameter] = GeneralisedHistogram::PARAMETERS;
}

impl Build<2> for GeneralisedHistogramPlane {
    fn build(values: &Values, _context: &Context<2>) -> Result<Self, BuildError> {
        let width = values.number("width").unwrap_or(1.0);
        let origin = values.number("origin").unwrap_or(0.0);
        Ok(Self {
            lattice: Lattice {
                widths: [width, values.number("width-y").unwrap_or(width)],
                origin: [origin, values.number("origin-y").unwrap_or(origin)],
            },
            degree: values.count("degree").unwrap_or(1) as usize,
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::estimator::HistogramPlane;
    use crate::parameter::Value;
    use crate::space::Grid;

    fn values(degree: Option<u64>) -> Values {
        let mut values = Values::defaults(GeneralisedHistogramPlane::PARAMETERS);
        values.set("width", Value::Number(0.5));
        values.set("width-y", Value::Number(0.25));
        if let Some(degree) = degree {
            values.set("degree", Value::Count(degree));
        }
        values
    }

    fn fitted(degree: u64, sample: &Sample<2>) -> Estimate<2> {
        let context = Context {
            truth: None,
            draws: 10,
        };
        let estimator = GeneralisedHistogramPlane::build(&values(Some(degree)), &context).unwrap();
        estimator.fit(sample).unwrap()
    }

    /// Points on the nodes of a fine midpoint rule, weighted by a polynomial: the sums are its integrals.
    fn lit(density: impl Fn(Point<2>) -> f64) -> Sample<2> {
        let grid = Grid::new([0.0, 0.0], [1.0, 1.0], [240, 240]).unwrap();
        let points: Vec<Point<2>> = grid.centres().collect();
        let weights = points.iter().map(|x| density(*x)).collect();
        Sample::normalised(points, weights, Domain::unit()).unwrap()
    }

    #[test]
    fn a_polynomial_of_its_degree_is_reproduced() {
        let cubic = |[x, y]: Point<2>| 1.0 + x - 0.8 * x.powi(3) + x * x * y.powi(3) + 0.3 * y;
        let sample = lit(cubic);
        let mass = 1.0 + 0.5 - 0.2 + 1.0 / 12.0 + 0.15;
        let worst = |degree: u64| {
            let estimate = fitted(degree, &sample);
            (0..100)
                .map(|i| {
                    [
                        f64::from(i % 10) * 0.097 + 0.03,
                        f64::from(i / 10) * 0.099 + 0.02,
                    ]
                })
                .map(|x| (estimate.at(x) - cubic(x) / mass).abs())
                .fold(0.0, f64::max)
        };
        // what the midpoint rule is off by, and not what a lower degree is
        assert!(worst(3) < 1e-3, "{}", worst(3));
        assert!(worst(1) > 3e-3 && worst(0) > worst(1), "{}", worst(1));
    }

    #[test]
    fn degree_zero_is_the_histogram_bit_for_bit_and_mass_is_kept() {
        let points = (0..120)
            .map(|i| {
                [
                    (f64::from(i) * 0.618).fract() * 3.0 - 1.0,
                    (f64::from(i) * 0.755).fract(),
                ]
            })
            .collect();
        let weights = (0..120).map(|i| f64::from(i % 4)).collect();
        let sample = Sample::normalised(points, weights, Domain::whole()).unwrap();
        let context = Context {
            truth: None,
            draws: 10,
        };
        let histogram = HistogramPlane::build(&values(None), &context).unwrap();
        let histogram = histogram.fit(&sample).unwrap();
        let grid = Grid::new([-1.5, -0.5], [2.5, 1.5], [160, 160]).unwrap();
        for degree in 0..=3 {
            let estimate = fitted(degree, &sample);
            let mass = estimate.on(&grid).integral();
            // twenty cells a bin: polynomials are summed to a hundredth
            assert!((mass - 1.0).abs() < 1e-2, "{degree}: {mass}");
            if degree == 0 {
                for x in grid.centres() {
                    assert_eq!(estimate.at(x).to_bits(), histogram.at(x).to_bits());
                }
            }
        }
    }
}
