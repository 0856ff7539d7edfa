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

#[cfg(test)]
mod chance;
pub mod cie;
pub mod emission;
pub mod hits;
pub mod ledger;
pub mod material;
pub mod ray;
pub mod scene;
pub mod spectrum;
pub mod vector;
pub mod walk;
