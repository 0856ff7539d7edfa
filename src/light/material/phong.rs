//! Glossy surfaces.

use super::mirror::mirrored;
use super::{Scattered, Spectrum, Vector};
use crate::light::vector::Frame;
use rand::{Rng, RngExt};
use std::f64::consts::TAU;

/// Reflects a lobe around the mirror direction.
///
/// The modified Phong model: f = ρ (n + 2)/(2π) cosⁿ α, where α is the angle to the mirror direction. Directions are drawn with density
/// (n + 1)/(2π) cosⁿ α, so that each carries ρ cos θ (n + 2)/(n + 1), which is at most 1 for the reflectances that scenes may have,
/// ρ ≤ (n + 1)/(n + 2). What would go below the surface is absorbed, so that at grazing angles less than ρ is reflected. [Lafortune & Willems 1994, "Using the modified Phong reflectance model for physically based rendering"]
#[derive(Clone, Debug, PartialEq)]
pub struct Phong {
    /// The share of light that is reflected at normal incidence, at most.
    pub reflectance: Spectrum,
    /// n: the larger, the sharper the lobe.
    pub exponent: f64,
}

impl Phong {
    #[inline]
    pub(super) fn scatter(
        &self,
        incoming: Vector,
        normal: Vector,
        random: &mut impl Rng,
    ) -> Scattered {
        let n = self.exponent;
        let (u, v): (f64, f64) = (random.random(), random.random());
        // cos α = (1 − u)^(1/(n + 1))
        let cos = (1.0 - u).powf(1.0 / (n + 1.0));
        let radius = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (TAU * v).sin_cos();
        let direction = Frame::about(mirrored(incoming, normal)).direction([
            radius * cos_phi,
            radius * sin_phi,
            cos,
        ]);
        let cos_theta = direction.dot(&normal).max(0.0);
        Scattered {
            direction,
            factor: cos_theta * (n + 2.0) / (n + 1.0),
        }
    }
}
