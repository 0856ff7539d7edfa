//! One arrival of a photon.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use crate::light::vector::Vector;

/// One arrival of a photon at the front of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// The first coordinate on the surface, see [`crate::light::scene::shape`].
    pub u: f32,
    /// The second coordinate.
    pub v: f32,
    /// The flux before absorption, for each channel of the scene's colour.
    pub flux: [f32; 3],
    /// The number of the path.
    pub path: u32,
    /// The facet of a mesh, or of a quad of two triangles; 0 otherwise.
    pub part: u32,
    /// The surface.
    pub surface: u16,
    /// How many arrivals at surfaces the photon has behind it, this one included: 1 is direct light.
    pub bounce: u16,
    direction: [i16; 2],
}

impl Record {
    /// An arrival along a direction that was [`folded`].
    #[inline(always)]
    pub fn new(
        [u, v]: [f64; 2],
        flux: [f32; 3],
        (path, bounce): (u32, u16),
        (surface, part): (usize, usize),
        direction: [i16; 2],
    ) -> Self {
        Self {
            u: u as f32,
            v: v as f32,
            flux,
            path,
            part: part as u32,
            surface: surface as u16,
            bounce,
            direction,
        }
    }

    /// The direction of arrival, of length 1.
    pub fn direction(&self) -> Vector {
        unfolded(self.direction)
    }
}

const SCALE: f64 = 32_767.0;

/// A direction of length 1 in 32 bits, right to 7e-5: the sphere on an octahedron, the octahedron on a square.
/// [Meyer, Süßmuth, Sußner, Stamminger, Greiner 2010]
#[inline(always)]
pub fn folded(direction: Vector) -> [i16; 2] {
    // added to a number, it leaves the nearest integer in the last bits: rounding without a call, for many at once
    const INTEGER: f64 = 6_755_399_441_055_744.0;
    let scale = (direction.x.abs() + direction.y.abs() + direction.z.abs()).recip();
    let (x, y) = (direction.x * scale, direction.y * scale);
    let below = direction.z < 0.0;
    let over = ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y));
    let (x, y) = if below { over } else { (x, y) };
    let (x, y) = (x.mul_add(SCALE, INTEGER), y.mul_add(SCALE, INTEGER));
    [x.to_bits() as i16, y.to_bits() as i16]
}

fn unfolded(folded: [i16; 2]) -> Vector {
    let [x, y] = folded.map(|t| f64::from(t) / SCALE);
    let z = 1.0 - x.abs() - y.abs();
    let (x, y) = if z < 0.0 {
        ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y))
    } else {
        (x, y)
    };
    Vector::new(x, y, z).normalize()
}

#[cfg(test)]
mod tests {
    use super::{Vector, folded, unfolded};

    #[test]
    fn directions_come_back_to_some_seconds_of_arc() {
        let mut worst = 0.0_f64;
        for i in -20..=20 {
            for j in -20..=20 {
                for k in -20..=20 {
                    let raw = Vector::new(f64::from(i), f64::from(j), f64::from(k));
                    if raw.norm() > 0.0 {
                        let direction = raw.normalize();
                        worst = worst.max((unfolded(folded(direction)) - direction).norm());
                    }
                }
            }
        }
        assert!(worst < 7e-5, "{worst}");
    }
}
