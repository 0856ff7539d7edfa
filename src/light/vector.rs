//! Places and directions in space, rays, and frames on surfaces.

// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

/// A place or a direction, in the scene's unit of length.
pub type Vector = nalgebra::Vector3<f64>;

/// A half-line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vector,
    /// Where it goes: of length 1.
    pub direction: Vector,
    /// The primitive on which the origin lies, which the ray therefore does not meet at its origin: exact where an epsilon would be a guess.
    pub leaving: Option<u32>,
}

impl Ray {
    /// A ray from a place that lies on nothing.
    pub fn new(origin: Vector, direction: Vector) -> Self {
        Self {
            origin,
            direction,
            leaving: None,
        }
    }

    /// The place at a distance.
    pub fn at(&self, distance: f64) -> Vector {
        self.origin + self.direction * distance
    }
}

/// Three perpendicular directions of length 1, right-handed, the third along a normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The first tangent.
    pub tangent: Vector,
    /// The second tangent.
    pub bitangent: Vector,
    /// The normal.
    pub normal: Vector,
}

impl Frame {
    /// A frame about `normal`, which has length 1: continuous in it but at its last component 0, without branches and without cancellation.
    /// [Duff, Burgess, Christensen, Hery, Kensler, Liani, Villemin 2017, "Building an orthonormal basis, revisited", listing 3]
    #[inline(always)]
    pub fn about(normal: Vector) -> Self {
        let sign = 1.0_f64.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Self {
            tangent: Vector::new(
                1.0 + sign * normal.x * normal.x * a,
                sign * b,
                -sign * normal.x,
            ),
            bitangent: Vector::new(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// The direction with these components along tangent, bitangent and normal.
    #[inline(always)]
    pub fn direction(&self, [x, y, z]: [f64; 3]) -> Vector {
        self.tangent * x + self.bitangent * y + self.normal * z
    }
}

#[cfg(test)]
mod tests {
    use super::{Frame, Vector};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_frame_is_orthonormal_and_right_handed(x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64) {
            let raw = Vector::new(x, y, z);
            prop_assume!(raw.norm() > 1e-3);
            let Frame { tangent, bitangent, normal } = Frame::about(raw.normalize());
            for (a, b) in [(tangent, bitangent), (bitangent, normal), (normal, tangent)] {
                prop_assert!(a.dot(&b).abs() < 1e-14);
                prop_assert!((a.norm() - 1.0).abs() < 1e-14);
            }
            prop_assert!((tangent.cross(&bitangent) - normal).norm() < 1e-14);
        }
    }

    #[test]
    fn the_poles_are_no_exception() {
        for z in [1.0, -1.0] {
            let frame = Frame::about(Vector::new(0.0, -0.0, z));
            assert!((frame.tangent.cross(&frame.bitangent) - frame.normal).norm() < 1e-15);
        }
    }
}
