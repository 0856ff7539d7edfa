//! One-variable mathematics without data: sums, quadrature, minima, roots, special functions, transforms.

mod chebyshev;
mod logarithm;
mod minimise;
mod normal_quantile;
pub mod orthogonal;
mod quadrature;
mod root;
pub mod special;
mod summation;
mod transform;

pub use chebyshev::Piecewise;
pub use minimise::{Minimum, local_minima, minimise};
pub use quadrature::{GaussLegendre, panels};
pub use root::{root, sign_change};
pub use summation::{Sum, sum, two_sum};
pub use transform::{forward_transform, inverse_transform};
