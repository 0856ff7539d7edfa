//! Ideal diffuse surfaces.

use super::{Scattered, Spectrum, Vector};
use crate::light::vector::Frame;
use crate::random::Stream;
use rand::RngExt;

/// Reflects the same radiance in all directions, whatever the direction of arrival.
#[derive(Clone, Debug, PartialEq)]
pub struct Lambertian {
    /// The share of light that is reflected.
    pub reflectance: Spectrum,
}

/// A direction about `normal` with density cos θ / π, from two uniform numbers: sin² θ = u, φ = 2π v. [Lambert 1760]
#[inline]
pub fn cosine_direction(normal: Vector, u: f64, v: f64) -> Vector {
    let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
    let radius = u.sqrt();
    Frame::about(normal).direction([radius * cos, radius * sin, (1.0 - u).sqrt()])
}

#[inline]
pub(super) fn scatter(normal: Vector, random: &mut Stream) -> Scattered {
    let (u, v) = (random.random(), random.random());
    Scattered {
        direction: cosine_direction(normal, u, v),
        factor: 1.0,
    }
}
