//! Ideal diffuse surfaces.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::{Scattered, Spectrum, Vector};
use crate::light::vector::Frame;
use rand::Rng;

/// Reflects the same radiance in all directions, whatever the direction of arrival.
#[derive(Clone, Debug, PartialEq)]
pub struct Lambertian {
    /// The share of light that is reflected.
    pub reflectance: Spectrum,
}

/// A direction about `normal` with density cos θ / π, from two uniform numbers: sin² θ = u, φ = 2π v. [Lambert 1760]
#[inline]
pub fn cosine_direction(normal: Vector, u: f64, v: f64) -> Vector {
    let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
    let radius = u.sqrt();
    Frame::about(normal).direction([radius * cos, radius * sin, (1.0 - u).sqrt()])
}

/// The same from one random word, which is cheaper: u from its upper half, the angle from its lower, both in the middle of 2³² equal steps.
///
/// Two bits of the lower half tell the quarter of the turn, the others an angle of at most π/4 from the middle of the quarter, whose sine and cosine
/// are polynomials right to the last digits. [Moshier 1989, Cephes, `sin.c`] There are no branches and no calls, so that a loop over many
/// directions is compiled for wide registers; and there are only operations that are correctly rounded, so that the direction is the same everywhere.
#[inline(always)]
pub fn cosine_direction_of(normal: Vector, word: u64) -> Vector {
    const STEP: f64 = 1.0 / 4_294_967_296.0;
    const QUARTER: f64 = std::f64::consts::FRAC_PI_2 / 1_073_741_824.0;
    let u = (f64::from((word >> 32) as u32) + 0.5) * STEP;
    let low = word as u32;
    let angle = (f64::from(low >> 2) - 536_870_911.5) * QUARTER;
    let square = angle * angle;
    let sin = SINE
        .iter()
        .fold(0.0_f64, |sum, &c| sum.mul_add(square, c))
        .mul_add(square * angle, angle);
    let cos = COSINE
        .iter()
        .fold(0.0_f64, |sum, &c| sum.mul_add(square, c))
        .mul_add(square * square, 0.5_f64.mul_add(-square, 1.0));
    let radius = if low & 2 == 0 { u.sqrt() } else { -u.sqrt() };
    let (x, y) = if low & 1 == 0 {
        (cos, sin)
    } else {
        (-sin, cos)
    };
    Frame::about(normal).direction([radius * x, radius * y, (1.0 - u).sqrt()])
}

const SINE: [f64; 6] = [
    1.589_623_015_765_465_7e-10,
    -2.505_074_776_285_780_6e-8,
    2.755_731_362_138_572_6e-6,
    -1.984_126_982_958_954e-4,
    8.333_333_333_322_118e-3,
    -1.666_666_666_666_663e-1,
];
const COSINE: [f64; 6] = [
    -1.135_853_652_138_768_2e-11,
    2.087_570_084_197_473_3e-9,
    -2.755_731_417_929_674e-7,
    2.480_158_728_885_170_4e-5,
    -1.388_888_888_887_305_6e-3,
    4.166_666_666_666_659_5e-2,
];

#[inline]
pub(super) fn scatter(normal: Vector, random: &mut impl Rng) -> Scattered {
    Scattered {
        direction: cosine_direction_of(normal, random.next_u64()),
        factor: 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::{Vector, cosine_direction, cosine_direction_of};

    #[test]
    fn a_word_and_two_numbers_tell_the_same_direction() {
        let normal = Vector::new(0.48, -0.6, 0.64);
        for k in 0..4000_u64 {
            let word = k.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (k << 7);
            let low = word as u32;
            let u = (f64::from((word >> 32) as u32) + 0.5) / 4_294_967_296.0;
            // the middle of a quarter is where the turn begins
            let quarter = f64::from((low & 1) + (low & 2));
            let within = (f64::from(low >> 2) + 0.5) / 1_073_741_824.0 - 0.5;
            let v = 0.25 * (quarter + within);
            let direction = cosine_direction_of(normal, word);
            assert!(
                (direction - cosine_direction(normal, u, v)).norm() < 1e-15,
                "{k}"
            );
            assert!((direction.norm() - 1.0).abs() < 1e-15);
        }
    }
}
