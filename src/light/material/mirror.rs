//! Ideal mirrors.

use super::{Scattered, Spectrum, Vector};

/// Reflects in one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Mirror {
    /// The share of light that is reflected.
    pub reflectance: Spectrum,
}

/// `incoming` mirrored at the plane perpendicular to `normal`, of length 1 again whatever rounding did.
#[inline]
pub(super) fn mirrored(incoming: Vector, normal: Vector) -> Vector {
    (incoming - normal * (2.0 * incoming.dot(&normal))).normalize()
}

#[inline]
pub(super) fn scatter(incoming: Vector, normal: Vector) -> Scattered {
    Scattered {
        direction: mirrored(incoming, normal),
        factor: 1.0,
    }
}
