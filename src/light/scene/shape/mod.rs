//! What surfaces look like, and how their points are numbered.
//!
//! A shape with a *chart* numbers its points by (u, v) in the scene's unit of length such that areas are kept: a density over (u, v) is a density
//! over the surface.
//!
//! | shape | u | v | the chart's domain |
//! |---|---|---|---|
//! | quad, triangle | along the edge from the first corner to the second | in the plane, perpendicular to u, towards the other corners | a walled rectangle; otherwise a polygon |
//! | sphere | R × longitude, from 0 to 2πR, from the x axis towards y | z above the lowest point, from 0 to 2R | a rectangle, periodic in u (Archimedes) |
//! | mesh | as for a triangle, of each of its triangles | | none |

mod mesh;
mod planar;
mod sphere;

pub use mesh::{Mesh, MeshError};
pub use planar::{Chart, Planar, PlanarError};
pub use sphere::{Sphere, SphereError};

use super::super::vector::Vector;
use crate::space::Domain;

/// A flat piece of a surface as rays see it: origin + s·first + t·second for s, t ≥ 0 and s, t ≤ 1 or, for a triangle, s + t ≤ 1. The front is
/// where first × second points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// A corner.
    pub origin: Vector,
    /// One edge at that corner.
    pub first: Vector,
    /// The other.
    pub second: Vector,
    /// Whether it is a triangle, or else a parallelogram.
    pub triangle: bool,
}

impl Facet {
    /// The direction in which the front looks.
    pub fn normal(&self) -> Vector {
        self.first.cross(&self.second).normalize()
    }

    /// The area.
    pub fn area(&self) -> f64 {
        self.first.cross(&self.second).norm() * if self.triangle { 0.5 } else { 1.0 }
    }

    /// The place that two uniform numbers stand for: uniform by area.
    pub fn place(&self, s: f64, t: f64) -> Vector {
        let (s, t) = if self.triangle && s + t > 1.0 {
            (1.0 - s, 1.0 - t)
        } else {
            (s, t)
        };
        self.origin + self.first * s + self.second * t
    }

    /// The corners, in order round it.
    pub fn corners(&self) -> Vec<Vector> {
        let Self {
            origin,
            first,
            second,
            triangle,
        } = *self;
        if triangle {
            vec![origin, origin + first, origin + second]
        } else {
            vec![
                origin,
                origin + first,
                origin + first + second,
                origin + second,
            ]
        }
    }
}

/// The shape of a surface.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A flat quad or triangle.
    Planar(Planar),
    /// A sphere.
    Sphere(Sphere),
    /// Many triangles.
    Mesh(Mesh),
}

impl Shape {
    /// The area of the front.
    pub fn area(&self) -> f64 {
        match self {
            Self::Planar(planar) => planar.area(),
            Self::Sphere(sphere) => sphere.area(),
            Self::Mesh(mesh) => mesh.area(),
        }
    }

    /// Where the chart lives; `None` for a mesh, which has none.
    pub fn domain(&self) -> Option<&Domain<2>> {
        match self {
            Self::Planar(planar) => Some(planar.domain()),
            Self::Sphere(sphere) => Some(sphere.domain()),
            Self::Mesh(_) => None,
        }
    }

    /// The facets in order; none for a sphere.
    pub fn facets(&self) -> &[Facet] {
        match self {
            Self::Planar(planar) => planar.facets(),
            Self::Sphere(_) => &[],
            Self::Mesh(mesh) => mesh.facets(),
        }
    }

    /// The place of (u, v); of facet `part` for a mesh, whose `part` must be one of its facets.
    #[inline]
    pub fn place(&self, part: usize, u: f64, v: f64) -> Vector {
        match self {
            Self::Planar(planar) => planar.place(u, v),
            Self::Sphere(sphere) => sphere.place(u, v),
            Self::Mesh(mesh) => mesh.place(part, u, v),
        }
    }

    /// (u, v) of a place on the surface, brought into the chart where rounding put it beside.
    #[inline]
    pub fn coordinates(&self, part: usize, place: Vector) -> [f64; 2] {
        match self {
            Self::Planar(planar) => planar.coordinates(place),
            Self::Sphere(sphere) => sphere.coordinates(place),
            Self::Mesh(mesh) => mesh.coordinates(part, place),
        }
    }

    /// The same, left where rounding put it.
    #[inline]
    pub fn raw_coordinates(&self, part: usize, place: Vector) -> [f64; 2] {
        match self {
            Self::Planar(planar) => planar.raw_coordinates(place),
            _ => self.coordinates(part, place),
        }
    }

    /// The direction in which the front looks at a place on the surface.
    #[inline]
    pub fn normal(&self, part: usize, place: Vector) -> Vector {
        match self {
            Self::Planar(planar) => planar.normal(),
            Self::Sphere(sphere) => sphere.normal(place),
            Self::Mesh(mesh) => mesh.normal(part),
        }
    }

    /// The place, and the facet it is on, that three uniform numbers stand for: uniform by area.
    #[inline]
    pub fn draw(&self, choice: f64, s: f64, t: f64) -> (usize, Vector) {
        match self {
            Self::Planar(planar) => planar.draw(choice, s, t),
            Self::Sphere(sphere) => (0, sphere.draw(s, t)),
            Self::Mesh(mesh) => mesh.draw(choice, s, t),
        }
    }
}

/// A share of [0, 1) for each facet in proportion to its area: where a uniform number falls tells the facet. O(log facets).
fn chosen(cumulative: &[f64], choice: f64) -> usize {
    let total = cumulative[cumulative.len() - 1];
    cumulative
        .partition_point(|&sum| sum <= choice * total)
        .min(cumulative.len() - 1)
}

fn cumulative(facets: &[Facet]) -> Vec<f64> {
    let mut sum = 0.0;
    facets
        .iter()
        .map(|facet| {
            sum += facet.area();
            sum
        })
        .collect()
}
