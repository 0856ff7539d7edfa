//! Abramson's estimator in the plane.

use super::abramson::{Abramson, Pilot, Width, law};
use crate::density::Density;
use crate::engine::PLANE;
use crate::estimator::{
    Build, BuildError, Context, Estimate, Estimator, Family, FitError, Laws, Moments,
};
use crate::kernel::{Shape, Symmetry};
use crate::numeric::Sum;
use crate::parameter::Values;
use crate::sample::Sample;
use crate::selector;
use crate::space::{Grid, Point};
use crate::theory::{PlaneWidths, plane_adaptive_moments, plane_kernel_moments};
use rayon::prelude::*;

/// Times h: kernels wider than that are not integrated over.
const WIDEST: f64 = 32.0;

impl Estimator<2> for Abramson<2> {
    fn laws(&self) -> Laws {
        self.promises()
    }

    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        self.estimate(sample, PLANE)
    }

    /// Where the known density is the pilot and the bandwidth a number.
    fn expectation(
        &self,
        truth: &dyn Density<2>,
        draws: usize,
        places: &[Point<2>],
    ) -> Option<Vec<Moments>> {
        let (h, draws) = (self.width.fixed()?, draws as f64);
        if truth.domain().wraps() {
            return None;
        }
        if self.law.exponent == 0.0 {
            let truth = truth.bivariate()?;
            let at = |x: &Point<2>| {
                plane_kernel_moments(truth, self.shape, self.symmetry, [h; 2], draws, *x)
            };
            return Some(places.par_iter().map(at).collect());
        }
        let Pilot::Truth(pilot, mean) = &self.pilot else {
            return None;
        };
        let level = self.law.clip * mean;
        let width = |y: Point<2>| h * self.law.stretch(pilot.at(y), *mean);
        let bend = |y: Point<2>| pilot.at(y) - level;
        // with next to no clip, far points reach anywhere
        let widest = Some(self.law.widest()).filter(|widest| *widest <= WIDEST)?;
        // where the density has its peak is not known better than by looking
        let least = h * self.narrowest(&**pilot, *mean);
        let widths = PlaneWidths {
            at: &width,
            bend: &bend,
            range: [least, h * widest],
        };
        let (shape, symmetry) = (self.shape, self.symmetry);
        let at = |x: &Point<2>| plane_adaptive_moments(truth, shape, symmetry, &widths, draws, *x);
        Some(places.par_iter().map(at).collect())
    }

    fn family(&self) -> Option<Family> {
        self.kind()
    }
}

impl Abramson<2> {
    /// The least of the factors of h, on 64² places of all but 1e-6 of the mass.
    fn narrowest(&self, pilot: &dyn Density<2>, mean: f64) -> f64 {
        let (low, high) = pilot.bulk(1e-6);
        let places = Grid::new(low, high, [64, 64]);
        let least = |grid: Grid<2>| {
            let factors = grid.centres().map(|y| self.law.stretch(pilot.at(y), mean));
            factors.fold(f64::INFINITY, f64::min)
        };
        places.map_or(1.0, least)
    }
}

/// exp(∫ f log f) by midpoints on 512² cells over all but 1e-12 of the mass: good to about 1e-6 for smooth densities, 1e-3 where there is an edge.
fn geometric_mean(truth: &dyn Density<2>) -> Option<f64> {
    let (low, high) = truth.bulk(1e-12);
    let grid = Grid::new(low, high, [512, 512]).ok()?;
    let (mut mass, mut sum) = (Sum::default(), Sum::default());
    for x in grid.centres() {
        let f = truth.at(x);
        if f > 0.0 {
            mass.add(f);
            sum.add(f * f.ln());
        }
    }
    let mean = (sum.value() / mass.value()).exp();
    (mean > 0.0 && mean.is_finite()).then_some(mean)
}

impl Build<2> for Abramson<2> {
    fn build(values: &Values, context: &Context<2>) -> Result<Self, BuildError> {
        let shape = values
            .word("shape")
            .and_then(Shape::named)
            .unwrap_or(Shape::Gaussian);
        let symmetry = values
            .word("symmetry")
            .and_then(Symmetry::named)
            .unwrap_or_default();
        let rule = |word: &str| selector::plane_entry_of(word).map(|entry| (entry.build)(symmetry));
        if let Some(word @ ("normal-reference" | "scott")) = values.word("bandwidth") {
            return Err(BuildError {
                parameter: "bandwidth",
                what: format!(
                    "\"{word}\" chooses a width for each axis, and in the plane each datum has one: give a number or \"silverman\""
                ),
            });
        }
        let pilot = if let Some(width) = Width::given(values, "pilot", rule) {
            Pilot::Estimate(width)
        } else if values.word("pilot") == Some("tied") {
            Pilot::Tied
        } else {
            let error = |what: &str| BuildError {
                parameter: "pilot",
                what: what.to_owned(),
            };
            let truth = context.truth.clone().ok_or_else(|| {
                error("\"truth\" is the known density, and the density of measured data is not known; give a bandwidth or a rule")
            })?;
            let mean = geometric_mean(&*truth).ok_or_else(|| {
                error("\"truth\": the geometric mean of this density is not finite; give a bandwidth or a rule")
            })?;
            Pilot::Truth(truth, mean)
        };
        Ok(Self {
            shape,
            symmetry,
            width: Width::given(values, "bandwidth", rule).unwrap_or(Width::Number(1.0)),
            pilot,
            law: law(values),
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::density;
    use crate::estimator::Described;
    use crate::kernel::{Bandwidth, KernelSum};
    use crate::parameter::{Value, Values};
    use crate::random;
    use crate::space::{Domain, Field, Targets};
    use std::sync::Arc;

    fn truth() -> Arc<dyn Density<2>> {
        let entry = density::entry("normal-2d").unwrap();
        entry.build(&Values::default()).unwrap().plane().unwrap()
    }

    fn sample(n: usize) -> Sample<2> {
        let mut stream = random::stream(5, "abramson", 2);
        let truth = truth();
        let points: Vec<Point<2>> = (0..n).map(|_| truth.draw(&mut stream)).collect();
        let weights = (0..n).map(|i| 1.0 + (i % 4) as f64).collect();
        Sample::normalised(points, weights, Domain::whole()).unwrap()
    }

    fn fitted(sample: &Sample<2>, set: &[(&'static str, Value)]) -> Estimate<2> {
        let mut values = Values::defaults(Abramson::<2>::PARAMETERS);
        for (name, value) in set {
            values.set(name, value.clone());
        }
        let context = Context {
            truth: Some(truth()),
            draws: sample.len(),
        };
        let estimator = Abramson::<2>::build(&values, &context).unwrap();
        estimator.fit(sample).unwrap()
    }

    fn word(word: &str) -> Value {
        Value::Word(word.to_owned())
    }

    /// Every engine that the planner may take against the sum as written, with widths worked out by hand from a pilot as written.
    #[test]
    fn engines_agree_with_the_definition_to_rounding() {
        let sample = sample(400);
        let grid = Grid::new([-3.0, -2.5], [3.5, 3.0], [60, 50]).unwrap();
        let scattered: Vec<Point<2>> = grid.centres().step_by(7).collect();
        for shape in [Shape::Epanechnikov, Shape::Gaussian, Shape::Triangular] {
            for symmetry in Symmetry::ALL {
                let set = [
                    ("shape", word(shape.name())),
                    ("symmetry", word(symmetry.name())),
                    ("bandwidth", Value::Number(0.7)),
                    ("pilot", Value::Number(0.9)),
                ];
                let estimate = fitted(&sample, &set);
                let sum = |bandwidth| {
                    KernelSum::new(sample.clone(), shape, bandwidth)
                        .unwrap()
                        .with_symmetry(symmetry)
                };
                let pilot = sum(Bandwidth::Fixed([0.9; 2]));
                let at: Vec<f64> = sample.points().iter().map(|x| pilot.at(*x)).collect();
                let logarithm: f64 = at
                    .iter()
                    .enumerate()
                    .map(|(i, p)| sample.weight(i) * p.ln())
                    .sum();
                let mean = logarithm.exp();
                let width = |p: &f64| 0.7 * (p / mean).max(0.1).powf(-0.5);
                let widths: Arc<[f64]> = at.iter().map(width).collect();
                let ceiling =
                    symmetry.peak::<2>(shape) / widths.iter().copied().fold(9.0, f64::min).powi(2);
                let judge = sum(Bandwidth::PerPoint(widths));
                for targets in [Targets::Grid(&grid), Targets::Points(&scattered)] {
                    let got = estimate.evaluate(targets);
                    for (value, x) in got.values.iter().zip(targets.places()) {
                        let error = (value - judge.at(x)).abs();
                        assert!(error < 1e-12 * ceiling, "{symmetry} {shape} {x:?}: {error}");
                    }
                }
            }
        }
    }

    #[test]
    fn mass_is_kept_and_exponent_zero_is_a_fixed_width() {
        let sample = sample(300);
        let grid = Grid::new([-14.0; 2], [14.0; 2], [280, 280]).unwrap();
        for pilot in [word("normal-reference"), word("truth"), Value::Number(0.5)] {
            let set = [("bandwidth", Value::Number(0.8)), ("pilot", pilot)];
            let mass = fitted(&sample, &set).on(&grid).integral();
            assert!((mass - 1.0).abs() < 1e-6, "{mass}");
        }
        let set = [
            ("bandwidth", Value::Number(0.8)),
            ("exponent", Value::Number(0.0)),
        ];
        let plain =
            KernelSum::new(sample.clone(), Shape::Gaussian, Bandwidth::Fixed([0.8; 2])).unwrap();
        let estimate = fitted(&sample, &set);
        for x in [[0.0, 0.0], [1.0, -2.0]] {
            assert!((estimate.at(x) - plain.at(x)).abs() < 1e-14);
        }
    }

    /// exp(∫ f log f) = 1/(2πe) for the standard normal.
    #[test]
    fn the_geometric_mean_is_that_of_the_entropy() {
        let expected = 1.0 / (2.0 * std::f64::consts::PI * std::f64::consts::E);
        let got = geometric_mean(&*truth()).unwrap();
        assert!((got / expected - 1.0).abs() < 1e-6, "{got} {expected}");
    }
}
