//! Light at places on surfaces, from whatever knows it, and pictures of it.
//!
//! | who knows | file |
//! |---|---|
//! | an estimator, from the hits of photons | `estimated` |
//! | the balance of light | `solved` |
//! | paths traced from each place | `traced` |
//!
//! A picture asks one of them for the irradiance where each ray of the camera meets a diffuse surface; nothing else differs between pictures.

mod estimated;
mod picture;
mod solved;
mod traced;

pub use estimated::{Estimated, channels};
pub use picture::Shot;
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
}

/// Knows the irradiance on surfaces.
pub trait Irradiance: Sync {
    /// In each channel at each of `spots`, in their order.
    fn at(&self, spots: &[Spot]) -> Vec<[f64; 3]>;
}
