//! Kernel sums in the plane.
//!
//! | engine | sums | targets | cost | file |
//! |---|---|---|---|---|
//! | gather | any kernel, any width rule | any | n + m · (data within reach) | `gather.rs` |
//! | splat | any kernel, fixed width or one a point | a grid | n · (cells within reach) + m | `splat/` |
//! | mesh | compact product kernels, fixed width | a grid | n + m | `mesh.rs` |
//! | binned | Gaussian, fixed width | a grid | n + nodes · (nodes within reach on an axis) | `binned.rs` |
//! | hermite | Gaussian, fixed width | a grid | n + m · (cells within reach on an axis) | `hermite/` |
//!
//! Measured on one thread, n = 10⁶ standard normal points, 256 × 256 cells, h = 0.1 (`benches/peers/plane.py`): Epanechnikov by splat 0.05 s product and 0.06 s
//! radial, by mesh 0.14 s, which pays where footprints are wide; Gaussian by hermite 0.44 s at 10⁻¹² and 0.08 s at 10⁻³, by splat 2.5 s.
//!
//! All are exact to the tolerance, at best 10⁻¹² of the ceiling mass × K(0) / (h₁ h₂), and are judged by the definition, [`Direct`].

mod binned;
mod gather;
mod hermite;
mod look;
mod mesh;
mod overlap;
mod pairs;
mod pieces;
mod profile;
mod splat;

pub use binned::BinnedGrid;
pub use gather::Gather;
pub use hermite::HermiteGrid;
pub use mesh::Mesh;
pub use pairs::PlanePairs;
pub use splat::Splat;

use super::direct::by_definition;
use super::{Direct, Engine};

/// The engines of the plane. To add one is to add it here; the laws find it.
pub const PLANE: &[&dyn Engine<2>] = &[&Direct, &Gather, &Splat, &Mesh, &HermiteGrid, &BinnedGrid];
