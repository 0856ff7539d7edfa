//! What the light in a scene really is: the truth that estimates from photons are judged by.
//!
//! | file | what |
//! |---|---|
//! | `contour` | what a place receives from a polygon, in closed form |
//! | `form_factor` | closed forms for rectangles: what numerical form factors are judged by |
//! | `patch`, `transfer` | surfaces cut into patches, and the light they exchange, with what stands between |
//! | `cover` | what of a patch is covered, and whether the rest loses light to backs |
//! | `system` | the balance of that light, by elimination or sweeps |
//! | `direct` | light straight from lamps |
//! | `radiosity` | irradiance anywhere in a room of flat diffuse surfaces, on two levels |
//! | `path` | irradiance in any scene, with standard errors |
//! | `truth` | either of them over a surface, as a field |
//! | `discrete` | the random walk between patches and the theory of its scores |
//!
//! Nothing here draws a photon, and the walk of the photons uses nothing of it.

pub mod contour;
mod cover;
pub mod direct;
pub mod discrete;
pub mod form_factor;
mod patch;
mod path;
mod radiosity;
mod system;
#[cfg(test)]
mod tests;
mod transfer;
mod truth;

pub use cover::Cover;
pub use direct::Lamps;
pub use patch::{Patch, patches};
pub use path::{Measured, PathTracer};
pub use radiosity::{Gathered, Radiosity, RadiosityError};
pub use system::{FormFactors, Unbalanced};
pub use transfer::form_factors;
pub use truth::{Light, Reference, SurfaceTruth};
