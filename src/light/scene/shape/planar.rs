//! Flat quads and triangles.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::{Facet, Vector, chosen, cumulative};
use crate::space::{Domain, Point, PolygonError, Side};

/// A convex quad or a triangle in a plane.
#[derive(Clone, Debug)]
pub struct Planar {
    corners: Vec<Vector>,
    axes: [Vector; 2],
    normal: Vector,
    facets: Vec<Facet>,
    cumulative: Vec<f64>,
    domain: Domain<2>,
    /// Only where the chart is not a rectangle.
    outline: Vec<Point<2>>,
    chart: Chart,
}

/// The coordinates (u, v) of places in a plane, each a linear form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chart([[f64; 4]; 2]);

impl Chart {
    fn new(axes: &[Vector; 2], corner: Vector) -> Self {
        Self(axes.map(|axis| [axis.x, axis.y, axis.z, -axis.dot(&corner)]))
    }

    /// Those of a place, left where rounding puts them.
    #[inline(always)]
    pub fn coordinates(&self, place: Vector) -> [f64; 2] {
        [Self::form(&self.0[0], place), Self::form(&self.0[1], place)]
    }

    #[inline(always)]
    fn form(&[x, y, z, offset]: &[f64; 4], place: Vector) -> f64 {
        z.mul_add(place.z, y.mul_add(place.y, x.mul_add(place.x, offset)))
    }
}

/// Why corners make no flat piece.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanarError {
    /// All on a line.
    #[error("the corners enclose no area")]
    Empty,
    /// A quad with a corner off the plane of the others.
    #[error(
        "the fourth corner is {distance:.3} off the plane of the others; make two triangles of it, (1, 2, 3) and (1, 3, 4)"
    )]
    Bent {
        /// By how much.
        distance: f64,
    },
    /// A quad with an inward corner or crossing edges.
    #[error(
        "corner {0} points inward or edges cross; give the corners of a convex quad in their order around it"
    )]
    Concave(usize),
    /// The outline is no polygon.
    #[error(transparent)]
    Outline(#[from] PolygonError),
    /// A facing direction along the plane.
    #[error("this direction lies in the plane of the surface, so it does not tell the sides apart")]
    Facing,
}

/// As a share of the size: corners this far off a plane are on it.
const FLAT: f64 = 1e-6;
/// Likewise: what differs by no more is the same.
const SAME: f64 = 1e-12;

impl Planar {
    /// The piece with these three or four finite corners, in order. The front is on the side to which `facing` points or, without it, the side from
    /// which the corners run counter-clockwise.
    ///
    /// # Errors
    /// If the corners enclose no area, are not in a plane, or not in convex position.
    pub fn new(corners: &[Vector], facing: Option<Vector>) -> Result<Self, PlanarError> {
        let size = corners
            .iter()
            .map(|corner| (corner - corners[0]).norm())
            .fold(0.0, f64::max);
        let edge = corners[1] - corners[0];
        // half the sum of the cross products of a fan: the vector area
        let area: Vector = corners
            .windows(2)
            .skip(1)
            .map(|pair| (pair[0] - corners[0]).cross(&(pair[1] - corners[0])) * 0.5)
            .sum();
        if area.norm() <= SAME * size * size || edge.norm() <= SAME * size {
            return Err(PlanarError::Empty);
        }
        let plane = edge.cross(&(corners[2] - corners[0]));
        if plane.norm() <= SAME * size * size {
            return Err(PlanarError::Empty);
        }
        let plane = plane.normalize();
        if let Some(fourth) = corners.get(3) {
            let distance = plane.dot(&(fourth - corners[0])).abs();
            if distance > FLAT * size {
                return Err(PlanarError::Bent { distance });
            }
        }
        let count = corners.len();
        for corner in 0..count {
            let before = corners[corner] - corners[(corner + count - 1) % count];
            let after = corners[(corner + 1) % count] - corners[corner];
            if plane.dot(&before.cross(&after)) <= SAME * size * size {
                return Err(PlanarError::Concave(corner + 1));
            }
        }
        let turned = match facing {
            None => false,
            Some(facing) => {
                let along = plane.dot(&facing) / facing.norm();
                if along.abs() <= 1e-6 {
                    return Err(PlanarError::Facing);
                }
                along < 0.0
            }
        };
        let first = edge.normalize();
        let axes = [first, plane.cross(&first)];
        let flat: Vec<Point<2>> = corners
            .iter()
            .map(|corner| axes.map(|axis| axis.dot(&(corner - corners[0]))))
            .collect();
        let parallelogram =
            count == 4 && (corners[1] + corners[3] - corners[0] - corners[2]).norm() <= SAME * size;
        let rectangle = parallelogram && flat[3][0].abs() <= SAME * size;
        let domain = if rectangle {
            Domain::new([0.0; 2], [edge.norm(), flat[3][1]], [[Side::Wall; 2]; 2])
                .map_err(|_| PlanarError::Empty)?
        } else {
            Domain::polygon(flat.clone())?
        };
        let facet = |origin: usize, first: usize, second: usize, triangle| {
            let (first, second) = if turned {
                (second, first)
            } else {
                (first, second)
            };
            Facet {
                origin: corners[origin],
                first: corners[first] - corners[origin],
                second: corners[second] - corners[origin],
                triangle,
            }
        };
        let facets = match (count, parallelogram) {
            (4, true) => vec![facet(0, 1, 3, false)],
            (4, false) => vec![facet(0, 1, 2, true), facet(0, 2, 3, true)],
            _ => vec![facet(0, 1, 2, true)],
        };
        Ok(Self {
            chart: Chart::new(&axes, corners[0]),
            corners: corners.to_vec(),
            axes,
            normal: if turned { -plane } else { plane },
            cumulative: cumulative(&facets),
            facets,
            domain,
            outline: if rectangle { Vec::new() } else { flat },
        })
    }

    /// The corners in their order.
    pub fn corners(&self) -> &[Vector] {
        &self.corners
    }

    /// The directions of u and v, of length 1 and perpendicular.
    pub fn axes(&self) -> [Vector; 2] {
        self.axes
    }

    /// The coordinates of its places.
    pub fn chart(&self) -> Chart {
        self.chart
    }

    /// The direction in which the front looks.
    #[inline]
    pub fn normal(&self) -> Vector {
        self.normal
    }

    pub(super) fn area(&self) -> f64 {
        self.cumulative[self.cumulative.len() - 1]
    }

    pub(super) fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    pub(super) fn facets(&self) -> &[Facet] {
        &self.facets
    }

    #[inline]
    pub(super) fn place(&self, u: f64, v: f64) -> Vector {
        self.corners[0] + self.axes[0] * u + self.axes[1] * v
    }

    #[inline]
    pub(super) fn raw_coordinates(&self, place: Vector) -> [f64; 2] {
        self.chart.coordinates(place)
    }

    #[inline]
    pub(super) fn coordinates(&self, place: Vector) -> [f64; 2] {
        self.inside(self.raw_coordinates(place))
    }

    /// The nearest point of the chart that [`Domain::contains`]; the point itself where that is already so.
    pub fn inside(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (low, high) = (self.domain.low(), self.domain.high());
        let clamped = [u.clamp(low[0], high[0]), v.clamp(low[1], high[1])];
        if self.outline.is_empty() || self.domain.contains(clamped) {
            return clamped;
        }
        let centre = [0, 1].map(|axis| {
            self.outline.iter().map(|corner| corner[axis]).sum::<f64>() / self.outline.len() as f64
        });
        // towards the centre of a convex outline by twice as much until inside
        let mut step = f64::EPSILON;
        loop {
            let moved = [0, 1].map(|axis| clamped[axis] + (centre[axis] - clamped[axis]) * step);
            if step >= 1.0 || self.domain.contains(moved) {
                return moved;
            }
            step *= 2.0;
        }
    }

    #[inline]
    pub(super) fn draw(&self, choice: f64, s: f64, t: f64) -> (usize, Vector) {
        let part = chosen(&self.cumulative, choice);
        (part, self.facets[part].place(s, t))
    }
}
