//! Two densities on lines, one for each axis, independent of each other.

use super::slices::{Change, sliced};
use crate::density::{self, Bivariate, Builder, Density, Entry, Univariate};
use crate::parameter::{BuildError, Kind, Parameter, Values, nearest};
use crate::random::Stream;
use crate::space::{Domain, Field, Point, clipped_to_box};
use std::sync::Arc;

/// f(x, y) = g(x) k(y).
pub struct Product {
    factors: [Arc<dyn Univariate>; 2],
    domain: Domain<2>,
}

impl Product {
    /// The density with these marginals.
    pub fn new(factors: [Arc<dyn Univariate>; 2]) -> Self {
        let of =
            |value: &dyn Fn(&Domain<1>) -> f64| [0, 1].map(|k: usize| value(factors[k].domain()));
        let sides = [0, 1].map(|k: usize| factors[k].domain().sides()[0]);
        let domain = Domain::new(of(&|d| d.low()[0]), of(&|d| d.high()[0]), sides)
            .unwrap_or_else(|error| unreachable!("each axis is that of a domain: {error}"));
        Self { factors, domain }
    }

    fn each(&self, value: impl Fn(&dyn Univariate, usize) -> f64) -> [f64; 2] {
        [0, 1].map(|axis: usize| value(&*self.factors[axis], axis))
    }
}

impl Field<2> for Product {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        let [f, g] = self.each(|factor, axis| factor.at([x[axis]]));
        f * g
    }
}

impl Density<2> for Product {
    /// The words of the first factor, then those of the second.
    fn draw(&self, random: &mut Stream) -> Point<2> {
        let [x] = self.factors[0].draw(random);
        let [y] = self.factors[1].draw(random);
        [x, y]
    }

    fn probability(&self, low: Point<2>, high: Point<2>) -> f64 {
        let [f, g] = self.each(|factor, axis| factor.probability([low[axis]], [high[axis]]));
        f * g
    }

    fn breaks(&self, axis: usize) -> Vec<f64> {
        self.factors[axis].breaks(0)
    }

    fn finest_scale(&self, axis: usize) -> f64 {
        self.factors[axis].finest_scale(0)
    }

    fn bulk(&self, tail: f64) -> (Point<2>, Point<2>) {
        (
            self.each(|factor, _| factor.bulk(tail).0[0]),
            self.each(|factor, _| factor.bulk(tail).1[0]),
        )
    }

    fn level(&self) -> Option<f64> {
        let [a, b] = &self.factors;
        Some(a.level()? * b.level()?)
    }

    fn bivariate(&self) -> Option<&dyn Bivariate> {
        Some(self)
    }
}

impl Bivariate for Product {
    /// By slices: the density of the first axis times the probability under that of the second.
    fn probability_within(&self, corners: &[Point<2>]) -> f64 {
        let (low, high) = self.bulk(1e-18);
        let change = Change {
            breaks: [self.breaks(0), self.breaks(1)],
            scales: [self.finest_scale(0), self.finest_scale(1)],
        };
        let [f, g] = &self.factors;
        sliced(
            &clipped_to_box(corners, low, high),
            &change,
            |x, bottom, top| f.at([x]) * g.probability([bottom], [top]),
        )
    }

    fn gradient(&self, x: Point<2>) -> [f64; 2] {
        let [f, g] = self.each(|factor, axis| factor.at([x[axis]]));
        let [df, dg] = self.each(|factor, axis| factor.derivative(1, x[axis]));
        [df * g, f * dg]
    }

    fn laplacian(&self, x: Point<2>) -> f64 {
        let [f, g] = self.each(|factor, axis| factor.at([x[axis]]));
        let [ddf, ddg] = self.each(|factor, axis| factor.derivative(2, x[axis]));
        ddf * g + f * ddg
    }

    fn gradient_roughness(&self) -> f64 {
        let [f, g] = self.each(|factor, _| factor.roughness(0));
        let [df, dg] = self.each(|factor, _| factor.roughness(1));
        df * g + f * dg
    }

    /// R(f″)R(g) + R(f)R(g″) + 2R(f′)R(g′), the last because ∫f f″ = -R(f′).
    fn laplacian_roughness(&self) -> f64 {
        let [f, g] = self.each(|factor, _| factor.roughness(0));
        let [df, dg] = self.each(|factor, _| factor.roughness(1));
        let [ddf, ddg] = self.each(|factor, _| factor.roughness(2));
        ddf * g + f * ddg + 2.0 * df * dg
    }

    fn factors(&self) -> Option<[&dyn Univariate; 2]> {
        Some([&*self.factors[0], &*self.factors[1]])
    }

    fn mean_and_covariance(&self) -> (Point<2>, [[f64; 2]; 2]) {
        let [a, b] = self.each(|factor, _| factor.mean_and_deviation().0);
        let [s, t] = self.each(|factor, _| factor.mean_and_deviation().1);
        ([a, b], [[s * s, 0.0], [0.0, t * t]])
    }
}

pub(in crate::density) const ENTRIES: &[Entry] = &[Entry {
    names: &["product"],
    summary: "in the plane: two densities on lines, one for each axis, by name",
    reference: "Scott 1992, section 6.3",
    parameters: &[
        Parameter::required("x", Kind::Text, "the density of the first axis, by name"),
        Parameter::required("y", Kind::Text, "the density of the second axis, by name"),
    ],
    build: Builder::Plane(build),
}];

fn build(values: &Values) -> Result<Arc<dyn Bivariate>, BuildError> {
    let factor = |parameter: &'static str| {
        let name = values.word(parameter).unwrap_or_default();
        density::named(name).ok_or_else(|| {
            let known = || {
                density::entries()
                    .filter(|entry| entry.dimensions() == 1 && entry.stands_alone())
                    .flat_map(|entry| entry.names.iter().copied())
            };
            let guess = nearest(name, known())
                .map(|guess| format!("; did you mean \"{guess}\"?"))
                .unwrap_or_default();
            BuildError {
                parameter,
                what: format!(
                    "no density on a line is called \"{}\" (or it needs parameters){guess}",
                    name.escape_debug()
                ),
            }
        })
    };
    Ok(Arc::new(Product::new([factor("x")?, factor("y")?])))
}
