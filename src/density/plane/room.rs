//! Rooms with polygons for walls, lit evenly or more and more towards one side.

use crate::density::{Bivariate, Builder, Density, Entry};
use crate::parameter::{Absent, BuildError, Kind, Parameter, Values};
use crate::random::{Stream, open_unit};
use crate::space::{Domain, Field, Point, Polygon, polygon_moments, within_convex};
use std::sync::Arc;

/// f(x) = (1 + s·(x - c)) / A on a polygon of area A with centroid c: linear, of mass 1 whatever the slope s.
#[derive(Clone, Debug)]
pub struct Room {
    domain: Domain<2>,
    area: f64,
    centroid: Point<2>,
    slope: [f64; 2],
    /// Triangles that cover the polygon, each corner with the share of mass of all corners up to it: the density on a triangle is a
    /// mixture of three, each highest at one corner and zero on the opposite edge.
    corners: Vec<(f64, [Point<2>; 3])>,
}

impl Room {
    /// The density on the inside of `outline` that grows by the share `slope` of its mean for each unit of length; `None` if it would fall
    /// below zero somewhere.
    pub fn new(outline: Polygon, slope: [f64; 2]) -> Option<Self> {
        let [area, x, y] = polygon_moments(outline.vertices());
        let centroid = [x / area, y / area];
        let height =
            |x: Point<2>| 1.0 + slope[0] * (x[0] - centroid[0]) + slope[1] * (x[1] - centroid[1]);
        if !outline.vertices().iter().all(|&x| height(x) >= 0.0) {
            return None;
        }
        let mut corners = Vec::new();
        let mut total = 0.0;
        for [a, b, c] in outline.triangles() {
            let third = polygon_moments(&[a, b, c])[0] / 3.0;
            for turned in [[a, b, c], [b, c, a], [c, a, b]] {
                total += third * height(turned[0]);
                corners.push((total, turned));
            }
        }
        for corner in &mut corners {
            corner.0 /= total;
        }
        Some(Self {
            domain: Domain::inside(outline),
            area,
            centroid,
            slope,
            corners,
        })
    }

    fn outline(&self) -> &Polygon {
        self.domain.outline().expect("made with one")
    }

    /// The probability of a part of the room, given as a ring.
    fn share(&self, ring: &[Point<2>]) -> f64 {
        let [area, x, y] = polygon_moments(ring);
        let tilt = self.slope[0] * (x - self.centroid[0] * area)
            + self.slope[1] * (y - self.centroid[1] * area);
        ((area + tilt) / self.area).max(0.0)
    }
}

impl Field<2> for Room {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        if !self.domain.contains(x) {
            return 0.0;
        }
        let [a, b] = [0, 1].map(|k: usize| self.slope[k] * (x[k] - self.centroid[k]));
        ((1.0 + a + b) / self.area).max(0.0)
    }
}

impl Density<2> for Room {
    /// Three random words a draw, always: a corner of a triangle, how near to it (the first of Dirichlet(2, 1, 1), a Beta(2, 2), inverted),
    /// and where between the other two.
    fn draw(&self, random: &mut Stream) -> Point<2> {
        let (share, p, split) = (open_unit(random), open_unit(random), open_unit(random));
        let last = self.corners.len() - 1;
        let at = self
            .corners
            .partition_point(|corner| corner.0 <= share)
            .min(last);
        let [a, b, c] = self.corners[at].1;
        // 3t² - 2t³ = p, the root between 0 and 1
        let t = 0.5 - ((1.0 - 2.0 * p).asin() / 3.0).sin();
        let (u, v) = ((1.0 - t) * split, (1.0 - t) * (1.0 - split));
        let x = [0, 1].map(|k: usize| t * a[k] + u * b[k] + v * c[k]);
        if self.domain.contains(x) {
            return x;
        }
        // rounding put it beside a wall: a little towards the middle of its triangle
        let middle = [0, 1].map(|k: usize| (a[k] + b[k] + c[k]) / 3.0);
        [0, 1].map(|k: usize| x[k] + 1e-9 * (middle[k] - x[k]))
    }

    /// By clipping the polygon to the box; exact to rounding.
    fn probability(&self, low: Point<2>, high: Point<2>) -> f64 {
        self.share(&self.outline().within(low, high))
    }

    fn breaks(&self, axis: usize) -> Vec<f64> {
        let mut breaks: Vec<f64> = self.outline().vertices().iter().map(|x| x[axis]).collect();
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        breaks
    }

    fn finest_scale(&self, axis: usize) -> f64 {
        let (low, high) = self.outline().bounds();
        high[axis] - low[axis]
    }

    fn bulk(&self, _tail: f64) -> (Point<2>, Point<2>) {
        self.outline().bounds()
    }

    fn level(&self) -> Option<f64> {
        let level = self.slope.iter().all(|&s| s == 0.0);
        level.then(|| self.area.recip())
    }

    fn bivariate(&self) -> Option<&dyn Bivariate> {
        Some(self)
    }
}

impl Bivariate for Room {
    /// The room is cut by the line of each edge; exact to rounding.
    fn probability_within(&self, corners: &[Point<2>]) -> f64 {
        self.share(&within_convex(self.outline().vertices(), corners))
    }

    fn gradient(&self, x: Point<2>) -> [f64; 2] {
        if self.domain.contains(x) {
            self.slope.map(|s| s / self.area)
        } else {
            [0.0; 2]
        }
    }

    fn laplacian(&self, _x: Point<2>) -> f64 {
        0.0
    }

    /// Infinite: the density jumps at the walls.
    fn gradient_roughness(&self) -> f64 {
        f64::INFINITY
    }

    fn laplacian_roughness(&self) -> f64 {
        f64::INFINITY
    }

    /// From the corners: the weights of a place in a triangle are Dirichlet(2, 1, 1) with the mean (2, 1, 1)/4.
    fn mean_and_covariance(&self) -> (Point<2>, [[f64; 2]; 2]) {
        let mut before = 0.0;
        let parts: Vec<_> = self
            .corners
            .iter()
            .map(|&(upto, [a, b, c])| {
                let share = upto - before;
                before = upto;
                let mean = [0, 1].map(|k: usize| 0.5 * a[k] + 0.25 * (b[k] + c[k]));
                // covariance of Dirichlet weights: (αᵢδᵢⱼ/α - αᵢαⱼ/α²)/(α + 1)
                let covariance = [0, 1].map(|i: usize| {
                    [0, 1].map(|j: usize| {
                        let second = 0.5 * a[i] * a[j] + 0.25 * (b[i] * b[j] + c[i] * c[j]);
                        (second - mean[i] * mean[j]) / 5.0
                    })
                });
                (share, mean, covariance)
            })
            .collect();
        super::mixture::moments(parts.iter().copied())
    }
}

const SLOPES: [Parameter; 2] = [
    Parameter::optional(
        "slope-x",
        Kind::Real,
        Absent::Number(0.0),
        "by what share of its mean the density grows for each unit along the first axis",
    ),
    Parameter::optional(
        "slope-y",
        Kind::Real,
        Absent::Number(0.0),
        "by what share of its mean the density grows for each unit along the second axis",
    ),
];

/// Half of the unit square, the right angle at the origin.
const TRIANGLE: [Point<2>; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// The unit square without its upper right quarter.
const ELL: [Point<2>; 6] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [1.0, 0.5],
    [0.5, 0.5],
    [0.5, 1.0],
    [0.0, 1.0],
];

pub(in crate::density) const ENTRIES: &[Entry] = &[
    Entry {
        names: &["triangle"],
        summary: "in the plane: flat or linear on the triangle (0,0), (1,0), (0,1), with walls",
        reference: "-",
        parameters: &SLOPES,
        build: Builder::Plane(|values| made(TRIANGLE.to_vec(), values)),
    },
    Entry {
        names: &["l-shape"],
        summary: "in the plane: flat or linear on the unit square without its upper right quarter, with walls",
        reference: "-",
        parameters: &SLOPES,
        build: Builder::Plane(|values| made(ELL.to_vec(), values)),
    },
    Entry {
        names: &["polygon"],
        summary: "in the plane: flat or linear on any simple polygon, with walls",
        reference: "-",
        parameters: &[
            Parameter::required(
                "vertices",
                Kind::Rows(&[
                    Parameter::required("x", Kind::Real, "the first coordinate"),
                    Parameter::required("y", Kind::Real, "the second coordinate"),
                ]),
                "the corners in order: a list of { x, y }",
            ),
            SLOPES[0],
            SLOPES[1],
        ],
        build: Builder::Plane(|values| {
            let coordinate = |row: &Values, name| row.number(name).unwrap_or(f64::NAN);
            let vertices = values.rows("vertices").iter();
            let vertices = vertices
                .map(|row| [coordinate(row, "x"), coordinate(row, "y")])
                .collect();
            made(vertices, values)
        }),
    },
];

fn made(vertices: Vec<Point<2>>, values: &Values) -> Result<Arc<dyn Bivariate>, BuildError> {
    let outline = Polygon::new(vertices).map_err(|error| BuildError {
        parameter: "vertices",
        what: error.to_string(),
    })?;
    let slope = ["slope-x", "slope-y"].map(|name| values.number(name).unwrap_or(0.0));
    match Room::new(outline, slope) {
        Some(room) => Ok(Arc::new(room)),
        None => Err(BuildError {
            parameter: "slope-x",
            what:
                "with these slopes the density would fall below zero in a corner; give smaller ones"
                    .to_owned(),
        }),
    }
}
