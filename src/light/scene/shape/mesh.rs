//! Surfaces of many triangles.

use super::{Facet, Vector, chosen, cumulative};

/// Triangles, one-sided, each with a chart of its own.
#[derive(Clone, Debug)]
pub struct Mesh {
    facets: Vec<Facet>,
    normals: Vec<Vector>,
    cumulative: Vec<f64>,
}

/// Why triangles make no mesh.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// No triangle.
    #[error("a mesh without triangles")]
    Empty,
    /// A triangle without area.
    #[error("triangle {0} has no area")]
    Flat(usize),
    /// A corner that is not a finite place.
    #[error("triangle {0} has a corner that is not finite")]
    NotFinite(usize),
}

impl Mesh {
    /// A mesh of triangles whose corners run counter-clockwise as seen from the front. Triangles are counted from 1 in messages.
    ///
    /// # Errors
    /// If there are none, or one has no area.
    pub fn new(triangles: &[[Vector; 3]]) -> Result<Self, MeshError> {
        if triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        let mut facets = Vec::with_capacity(triangles.len());
        for (index, [a, b, c]) in triangles.iter().enumerate() {
            let number = index + 1;
            if ![a, b, c].iter().all(|p| p.iter().all(|x| x.is_finite())) {
                return Err(MeshError::NotFinite(number));
            }
            let (first, second) = (b - a, c - a);
            let longest = first.norm().max(second.norm()).max((c - b).norm());
            if first.cross(&second).norm() <= 1e-12 * longest * longest {
                return Err(MeshError::Flat(number));
            }
            facets.push(Facet {
                origin: *a,
                first,
                second,
                triangle: true,
            });
        }
        Ok(Self {
            normals: facets.iter().map(Facet::normal).collect(),
            cumulative: cumulative(&facets),
            facets,
        })
    }

    pub(super) fn area(&self) -> f64 {
        self.cumulative[self.cumulative.len() - 1]
    }

    pub(super) fn facets(&self) -> &[Facet] {
        &self.facets
    }

    #[inline]
    pub(super) fn normal(&self, part: usize) -> Vector {
        self.normals[part]
    }

    fn axes(&self, part: usize) -> [Vector; 2] {
        let first = self.facets[part].first.normalize();
        [first, self.normals[part].cross(&first)]
    }

    pub(super) fn place(&self, part: usize, u: f64, v: f64) -> Vector {
        let [first, second] = self.axes(part);
        self.facets[part].origin + first * u + second * v
    }

    pub(super) fn coordinates(&self, part: usize, place: Vector) -> [f64; 2] {
        let from = place - self.facets[part].origin;
        self.axes(part).map(|axis| axis.dot(&from))
    }

    #[inline]
    pub(super) fn draw(&self, choice: f64, s: f64, t: f64) -> (usize, Vector) {
        let part = chosen(&self.cumulative, choice);
        (part, self.facets[part].place(s, t))
    }
}
