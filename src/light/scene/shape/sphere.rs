//! Spheres.

use super::Vector;
use crate::space::{Domain, Side};
use std::f64::consts::{PI, TAU};

/// A sphere, seen from outside or from inside.
#[derive(Clone, Debug)]
pub struct Sphere {
    centre: Vector,
    radius: f64,
    inward: bool,
    domain: Domain<2>,
}

/// Why numbers make no sphere.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SphereError {
    /// No size.
    #[error("a sphere of radius {0}; the radius must be positive and finite")]
    Radius(f64),
}

impl Sphere {
    /// A sphere whose front is its outside or, if `inward`, its inside.
    ///
    /// # Errors
    /// If the radius is not positive and finite.
    pub fn new(centre: Vector, radius: f64, inward: bool) -> Result<Self, SphereError> {
        let fault = SphereError::Radius(radius);
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(fault);
        }
        let sides = [[Side::Periodic; 2], [Side::Wall; 2]];
        let domain = Domain::new([0.0; 2], [TAU * radius, 2.0 * radius], sides);
        Ok(Self {
            centre,
            radius,
            inward,
            domain: domain.map_err(|_| fault)?,
        })
    }

    /// The centre.
    #[inline]
    pub fn centre(&self) -> Vector {
        self.centre
    }

    /// The radius.
    #[inline]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether the front is the inside.
    #[inline]
    pub fn inward(&self) -> bool {
        self.inward
    }

    pub(super) fn area(&self) -> f64 {
        4.0 * PI * self.radius * self.radius
    }

    pub(super) fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    /// u = R φ, v = z + R: a strip of the sphere has the area of the strip of the cylinder around it. [Archimedes]
    #[inline]
    pub(super) fn place(&self, u: f64, v: f64) -> Vector {
        let z = v - self.radius;
        let across = (v * (2.0 * self.radius - v)).max(0.0).sqrt();
        let (sin, cos) = (u / self.radius).sin_cos();
        self.centre + Vector::new(across * cos, across * sin, z)
    }

    #[inline]
    pub(super) fn coordinates(&self, place: Vector) -> [f64; 2] {
        let from = place - self.centre;
        let longitude = from.y.atan2(from.x);
        let longitude = if longitude < 0.0 {
            longitude + TAU
        } else {
            longitude
        };
        let high = self.domain.high();
        [
            (longitude * self.radius).clamp(0.0, high[0]),
            (from.z + self.radius).clamp(0.0, high[1]),
        ]
    }

    /// Of length 1 even for a place that rounding has put beside the sphere: with the radius for its length, directions about it would have the error of the
    /// place, the next place a larger one, and a photon would leave a closed sphere after some forty bounces.
    #[inline]
    pub(super) fn normal(&self, place: Vector) -> Vector {
        let outward = (place - self.centre).normalize();
        if self.inward { -outward } else { outward }
    }

    #[inline]
    pub(super) fn draw(&self, s: f64, t: f64) -> Vector {
        let high = self.domain.high();
        self.place(s * high[0], t * high[1])
    }
}
