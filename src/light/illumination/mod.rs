//! Light at places on surfaces, from whatever knows it, and pictures of it.
//!
//! | who knows | file |
//! |---|---|
//! | an estimator, from the hits of photons | `estimated` |
//! | the balance of light | `solved` |
//! | paths traced from each place | `traced` |
//!
//! A picture asks one of them for the light that comes back where each ray of the camera meets a diffuse surface; nothing else differs between pictures.

mod estimated;
mod picture;
mod solved;
mod traced;

pub use estimated::{Estimated, channels};
pub use picture::{SIGHT_BYTES, Shot};
pub use traced::Traced;

use super::vector::Vector;

/// A place on the front of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The surface, by its position in the scene.
    pub surface: usize,
    /// The primitive that the place is on.
    pub primitive: u32,
    /// The place in space.
    pub place: Vector,
    /// The direction in which the front looks there.
    pub normal: Vector,
    /// The place on the surface.
    pub chart: [f64; 2],
    /// The reflectance there, in three channels; over wavelengths it has no meaning.
    pub reflectance: [f64; 3],
}

impl Spot {
    fn returned(&self, irradiance: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|c: usize| irradiance[c] * self.reflectance[c])
    }
}

/// Knows what diffuse surfaces return of the light that they receive.
pub trait Returned: Sync {
    /// The reflected radiosity in each channel of the scene's colour at each of `spots`, in their order: X, Y and Z over wavelengths.
    fn at(&self, spots: &[Spot]) -> Vec<[f64; 3]>;
}
