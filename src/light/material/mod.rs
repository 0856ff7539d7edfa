//! What a surface does to light that arrives on its front.
//!
//! | material | what it does | albedo |
//! |---|---|---|
//! | [`Lambertian`] | the same radiance in all directions | its reflectance |
//! | [`Mirror`] | one direction | its reflectance |
//! | [`Phong`] | a lobe around the mirror direction | its reflectance, less what would go below the surface |
//! | [`Dielectric`] | one of two directions, reflected or refracted | 1 |
//!
//! The back of a surface absorbs everything, but for a dielectric, whose back is its inside.

mod dielectric;
mod lambertian;
mod mirror;
mod phong;
#[cfg(test)]
mod tests;

pub use dielectric::{Dielectric, fresnel};
pub use lambertian::{Lambertian, cosine_direction, cosine_direction_of};
pub use mirror::Mirror;
pub use phong::Phong;

use super::spectrum::Spectrum;
use super::vector::Vector;
use rand::Rng;

/// Where light goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattered {
    /// The direction, of length 1; it must not be used where `albedo` is 0.
    pub direction: Vector,
    /// The factor on the reflectance: 1 for perfect sampling, 0 for a direction that does not exist.
    pub factor: f64,
}

/// What a surface does to light.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Diffuse.
    Lambertian(Lambertian),
    /// Specular.
    Mirror(Mirror),
    /// Glossy.
    Phong(Phong),
    /// Clear.
    Dielectric(Dielectric),
}

impl Material {
    /// The share of light that goes on, for each colour.
    #[inline]
    pub fn reflectance(&self) -> &Spectrum {
        match self {
            Self::Lambertian(Lambertian { reflectance })
            | Self::Mirror(Mirror { reflectance })
            | Self::Phong(Phong { reflectance, .. }) => reflectance,
            Self::Dielectric(_) => &dielectric::CLEAR,
        }
    }

    /// Whether light passes through, so that the back of the surface is its inside.
    #[inline]
    pub fn is_clear(&self) -> bool {
        matches!(self, Self::Dielectric(_))
    }

    /// Whether all light is reflected as by an ideal diffuse surface, so that its radiance is its radiosity / π.
    pub fn is_diffuse(&self) -> bool {
        matches!(self, Self::Lambertian(_))
    }

    /// Draws where light coming in along `incoming` goes on, given the normal on the front and the side on which it arrives. The direction
    /// follows the reflected light, so that the light keeps its power × reflectance × factor.
    #[inline]
    pub fn scatter(
        &self,
        incoming: Vector,
        normal: Vector,
        front: bool,
        random: &mut impl Rng,
    ) -> Scattered {
        match self {
            Self::Lambertian(_) => lambertian::scatter(normal, random),
            Self::Mirror(_) => mirror::scatter(incoming, normal),
            Self::Phong(phong) => phong.scatter(incoming, normal, random),
            Self::Dielectric(dielectric) => dielectric.scatter(incoming, normal, front, random),
        }
    }
}
