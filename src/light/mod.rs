//! Light in rooms: photons walk at random and leave hits on surfaces, which are weighted points like any others.
//!
//! | module | what it is |
//! |---|---|
//! | [`vector`] | places, directions, rays, frames |
//! | [`spectrum`] | numbers for colours |
//! | [`material`] | what a surface does to light |
//! | [`cie`] | from wavelengths to colours |
//! | [`emission`] | how a surface shines |
//! | [`ray`] | what rays meet |
//! | [`scene`] | surfaces in space, read from TOML |
//! | [`hits`] | where photons arrived: weighted points |
//! | [`ledger`] | where the light went |
//! | [`walk`] | photons: lamps, flights, survival |
//! | [`mod@reference`] | what the light really is, without a photon |
//! | [`photons`] | the hits on a surface as a source of samples |
//! | [`illumination`] | light at places, from whatever knows it, and pictures of it |
//! | [`camera`], [`image`] | rays through pixels, and what pixels become |

pub mod camera;
#[cfg(test)]
mod chance;
pub mod cie;
pub mod emission;
pub mod hits;
pub mod illumination;
pub mod image;
pub mod ledger;
pub mod material;
pub mod photons;
pub mod ray;
pub mod reference;
pub mod scene;
pub mod spectrum;
pub mod vector;
pub mod walk;
