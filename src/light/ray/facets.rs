//! Flat pieces, all tried at once.
//!
//! For a facet o + s·a + t·b with unit-free normal m = a × b the ray p + λ d meets the plane where λ = m·(o − p) / m·d. With the dual edges
//! A = (b × m)/|m|², B = (m × a)/|m|² (A·a = B·b = 1, A·b = B·a = 0) the coordinates are s = A·(p − o) + λ A·d and t likewise. To divide only
//! once, for the facet that is met, everything is compared after multiplication with m·d. The numbers of all facets stand in rows, so that a
//! loop over them is a loop over lanes.

use super::Found;
use crate::light::scene::Facet;
use crate::light::vector::{Ray, Vector};

/// Flat pieces in rows, see the [module](self).
#[derive(Debug)]
pub(super) struct Facets {
    planes: Vec<Plane>,
}

/// One facet as its rays see it: three linear forms of a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// m and −m·o: the signed distance, times |m|.
    normal: Vector,
    offset: f64,
    /// A and −A·o: s.
    first: Vector,
    first_offset: f64,
    /// B and −B·o: t.
    second: Vector,
    second_offset: f64,
    /// 1 for a triangle, 0 for a parallelogram: s + k t ≤ 1 and t + k s ≤ 1.
    share: f64,
}

impl Plane {
    pub(super) fn new(facet: &Facet) -> Self {
        let m = facet.first.cross(&facet.second);
        let square = m.norm_squared();
        let first = facet.second.cross(&m) / square;
        let second = m.cross(&facet.first) / square;
        let normal = m / square.sqrt();
        Self {
            normal,
            offset: -normal.dot(&facet.origin),
            first,
            first_offset: -first.dot(&facet.origin),
            second,
            second_offset: -second.dot(&facet.origin),
            share: f64::from(u8::from(facet.triangle)),
        }
    }

    /// The distance at which the ray meets the facet, if it is positive.
    #[inline]
    pub(super) fn distance(&self, ray: &Ray) -> Option<f64> {
        /// Facets reach this much, as a share of their edges, beyond them: no ray slips through between two that share an edge.
        const REACH: f64 = 1e-12;
        let across = self.normal.dot(&ray.direction);
        let above = self.normal.dot(&ray.origin) + self.offset;
        let distance = -above / across;
        // false for NaN too
        if !(distance > 0.0 && distance < f64::INFINITY) {
            return None;
        }
        let s = self.first.dot(&ray.origin)
            + self.first_offset
            + distance * self.first.dot(&ray.direction);
        let t = self.second.dot(&ray.origin)
            + self.second_offset
            + distance * self.second.dot(&ray.direction);
        let inside = s >= -REACH
            && t >= -REACH
            && s + self.share * t <= 1.0 + REACH
            && t + self.share * s <= 1.0 + REACH;
        inside.then_some(distance)
    }
}

impl Facets {
    pub(super) fn new(facets: &[Facet]) -> Self {
        Self {
            planes: facets.iter().map(Plane::new).collect(),
        }
    }

    #[inline]
    pub(super) fn nearest(&self, ray: &Ray, limit: f64) -> Option<Found> {
        let mut limit = limit;
        let mut found = None;
        for (index, plane) in self.planes.iter().enumerate() {
            let primitive = index as u32;
            if ray.leaving != Some(primitive)
                && let Some(distance) = plane.distance(ray)
                && distance < limit
            {
                limit = distance;
                found = Some(Found {
                    primitive,
                    distance,
                });
            }
        }
        found
    }
}
