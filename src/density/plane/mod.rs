//! Known truths in the plane.
//!
//! | density | names | file |
//! |---|---|---|
//! | weighted normals with any covariance | `normal-2d`, `normal-mixture-2d` | `mixture.rs` |
//! | f(x) g(y) of any two densities on a line | `product` | `product.rs` |
//! | the unit square: flat, a ramp, with a Gaussian highlight, with a bright disc, with all of these | `uniform-2d`, `ramp-2d`, `highlight`, `disc`, `mix` | `square.rs` |
//! | 1 + a sin 2πx sin 2πy on the unit square | `smooth` | `smooth.rs` |
//! | flat or linear on a polygon | `triangle`, `l-shape`, `polygon` | `room.rs` |
//!
//! All draw a fixed number of random words.

pub(super) mod mixture;
pub(super) mod product;
pub(super) mod room;
mod slices;
pub(super) mod smooth;
pub(super) mod square;
pub(super) mod window;

pub use mixture::{NormalAt, PlaneComponent, PlaneMixture, PlaneMixtureError, normal_at};
pub use product::Product;
pub use room::Room;
pub use smooth::Smooth;
pub use square::{Square, SquarePart};
pub use window::WindowPlane;
