//! A window of any polygon on a density in the plane that goes on beyond it: a free-standing surface in smooth light.

use crate::density::window::unknown;
use crate::density::{Bivariate, Builder, Density, Entry, named_in_plane};
use crate::numeric::{GaussLegendre, Sum, panels};
use crate::parameter::{BuildError, Kind, Parameter, Values};
use crate::random::Stream;
use crate::space::{Domain, Field, Point, Polygon, polygon_moments, within_convex};
use std::sync::Arc;

/// f = g / p inside a polygon, with p the probability of the polygon under g. Its edges are only the ends of what is seen; [`Density::beyond`] gives g.
///
/// Integrals are sums over signed triangles by a product rule, good to about 1e-10 where g is smooth on the polygon.
pub struct WindowPlane {
    whole: Arc<dyn Bivariate>,
    domain: Domain<2>,
    mass: f64,
}

impl WindowPlane {
    /// What `outline` shows of `whole`; `None` if it reaches beyond the domain of `whole` or holds less than 1e-6 of its mass.
    pub fn new(whole: Arc<dyn Bivariate>, outline: Polygon) -> Option<Self> {
        let legal = outline
            .vertices()
            .iter()
            .all(|x| whole.domain().contains(*x));
        let mass = integral(&*whole, outline.vertices(), |_| 1.0);
        (legal && mass >= 1e-6).then(|| Self {
            whole,
            domain: Domain::inside(outline),
            mass,
        })
    }

    fn outline(&self) -> &Polygon {
        self.domain.outline().expect("made with one")
    }

    fn mean_of(&self, function: impl Fn(Point<2>) -> f64) -> f64 {
        integral(&*self.whole, self.outline().vertices(), function) / self.mass
    }
}

/// ∫ g · function over the polygon with these corners: the fan of triangles from the first, each with the sign of its turn.
fn integral(
    whole: &dyn Bivariate,
    corners: &[Point<2>],
    function: impl Fn(Point<2>) -> f64,
) -> f64 {
    let rule = GaussLegendre::new(16);
    let mut total = Sum::default();
    let Some((first, others)) = corners.split_first() else {
        return 0.0;
    };
    for pair in others.windows(2) {
        let [u, v] = [pair[0], pair[1]].map(|x| [x[0] - first[0], x[1] - first[1]]);
        let turn = u[0] * v[1] - u[1] * v[0];
        let scale = (0..2)
            .map(|k| (u[k].abs().max(v[k].abs())) / whole.finest_scale(k))
            .fold(0.0, f64::max);
        // as many panels as the density has features along the longest side
        let longest = (1.0 / scale).clamp(0.02, 1.0);
        let cuts = panels(0.0, 1.0, [], longest);
        // first + s (u + t (v - u)), with area s · turn
        for along in cuts.windows(2) {
            for (s, weight) in rule.on(along[0], along[1]) {
                for across in cuts.windows(2) {
                    for (t, other) in rule.on(across[0], across[1]) {
                        let x = [0, 1].map(|k: usize| first[k] + s * t.mul_add(v[k] - u[k], u[k]));
                        total.add(weight * other * s * turn * whole.at(x) * function(x));
                    }
                }
            }
        }
    }
    // corners may go either way round
    let way = polygon_moments(corners)[0].signum();
    way * total.value()
}

impl Field<2> for WindowPlane {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        if self.domain.contains(x) {
            self.whole.at(x) / self.mass
        } else {
            0.0
        }
    }
}

impl Density<2> for WindowPlane {
    /// What is drawn from the whole until it falls into the polygon.
    fn draw(&self, random: &mut Stream) -> Point<2> {
        loop {
            let x = self.whole.draw(random);
            if self.domain.contains(x) {
                return x;
            }
        }
    }

    fn probability(&self, low: Point<2>, high: Point<2>) -> f64 {
        integral(&*self.whole, &self.outline().within(low, high), |_| 1.0) / self.mass
    }

    fn breaks(&self, axis: usize) -> Vec<f64> {
        let mut breaks: Vec<f64> = self.outline().vertices().iter().map(|x| x[axis]).collect();
        breaks.extend(self.whole.breaks(axis));
        let (low, high) = self.outline().bounds();
        breaks.retain(|x| (low[axis]..=high[axis]).contains(x));
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        breaks
    }

    fn finest_scale(&self, axis: usize) -> f64 {
        let (low, high) = self.outline().bounds();
        self.whole.finest_scale(axis).min(high[axis] - low[axis])
    }

    fn bulk(&self, _tail: f64) -> (Point<2>, Point<2>) {
        self.outline().bounds()
    }

    fn beyond(&self) -> Option<(&dyn Density<2>, f64)> {
        Some((&*self.whole, 1.0 / self.mass))
    }

    fn level(&self) -> Option<f64> {
        Some(self.whole.level()? / self.mass)
    }

    fn bivariate(&self) -> Option<&dyn Bivariate> {
        Some(self)
    }
}

impl Bivariate for WindowPlane {
    /// Of the triangles that the window is made of, each cut to the polygon.
    fn probability_within(&self, corners: &[Point<2>]) -> f64 {
        let parts = self.outline().triangles();
        let parts = parts.iter().map(|part| within_convex(part, corners));
        let sum: Sum = parts
            .map(|ring| self.whole.probability_within(&ring))
            .collect();
        sum.value() / self.mass
    }

    fn gradient(&self, x: Point<2>) -> [f64; 2] {
        if self.domain.contains(x) {
            self.whole.gradient(x).map(|slope| slope / self.mass)
        } else {
            [0.0; 2]
        }
    }

    fn laplacian(&self, x: Point<2>) -> f64 {
        if self.domain.contains(x) {
            self.whole.laplacian(x) / self.mass
        } else {
            0.0
        }
    }

    /// Infinite: the density jumps at the edges of the window.
    fn gradient_roughness(&self) -> f64 {
        f64::INFINITY
    }

    fn laplacian_roughness(&self) -> f64 {
        f64::INFINITY
    }

    fn mean_and_covariance(&self) -> (Point<2>, [[f64; 2]; 2]) {
        let mean = [0, 1].map(|k: usize| self.mean_of(|x| x[k]));
        let covariance = |i: usize, j: usize| self.mean_of(|x| (x[i] - mean[i]) * (x[j] - mean[j]));
        let off = covariance(0, 1);
        (mean, [[covariance(0, 0), off], [off, covariance(1, 1)]])
    }
}

pub(in crate::density) const ENTRIES: &[Entry] = &[Entry {
    names: &["window-2d"],
    summary: "in the plane: what a polygon shows of another density, which goes on beyond it: for virtual margins",
    reference: "Lastra, Urena, Revelles & Montes 2002 (what is registered beyond an edge)",
    parameters: &[
        Parameter::required(
            "density",
            Kind::Text,
            "the density in the plane that is looked at, by name",
        ),
        Parameter::required(
            "vertices",
            Kind::Rows(&[
                Parameter::required("x", Kind::Real, "the first coordinate"),
                Parameter::required("y", Kind::Real, "the second coordinate"),
            ]),
            "the corners of the window in order: a list of { x, y }",
        ),
    ],
    build: Builder::Plane(build),
}];

fn build(values: &Values) -> Result<Arc<dyn Bivariate>, BuildError> {
    let name = values.word("density").unwrap_or("normal-2d");
    let whole = named_in_plane(name).ok_or_else(|| unknown(name, 2))?;
    let coordinate = |row: &Values, name| row.number(name).unwrap_or(f64::NAN);
    let vertices: Vec<Point<2>> = values
        .rows("vertices")
        .iter()
        .map(|row| [coordinate(row, "x"), coordinate(row, "y")])
        .collect();
    let error = |what: String| BuildError {
        parameter: "vertices",
        what,
    };
    let outline = Polygon::new(vertices).map_err(|problem| error(problem.to_string()))?;
    let window = WindowPlane::new(whole, outline).ok_or_else(|| {
        error("the window must lie where the density has its domain, and show at least a millionth of its mass".to_owned())
    })?;
    Ok(Arc::new(window))
}
