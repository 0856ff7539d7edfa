//! The kernels as functions of the squared distance, in forms that compile to vector instructions.
// inlined wherever it is called from code compiled for wide registers
#![allow(clippy::inline_always)]

use super::super::basis::COSINE;
use crate::kernel::Shape;
use std::f64::consts::{FRAC_PI_2, LOG2_E, PI};

/// K(√s) / K(0), to a few units in the last place.
pub(super) trait Profile: Copy + Send + Sync + 'static {
    /// Whether the kernel jumps at the end of its support, so that in and out must be decided exactly as the definition decides.
    const JUMPS: bool = false;

    /// Whether it is zero beyond s = 1.
    const COMPACT: bool = true;

    /// K(√s) / K(0).
    fn bare(self, square: f64) -> f64;
}

#[derive(Clone, Copy)]
pub(super) struct Flat;
#[derive(Clone, Copy)]
pub(super) struct Parabola<const POWER: usize>;
#[derive(Clone, Copy)]
pub(super) struct Cone;
#[derive(Clone, Copy)]
pub(super) struct Arch;
#[derive(Clone, Copy)]
pub(super) struct Bell;

impl Profile for Flat {
    const JUMPS: bool = true;

    #[inline(always)]
    fn bare(self, square: f64) -> f64 {
        if square <= 1.0 { 1.0 } else { 0.0 }
    }
}

impl<const POWER: usize> Profile for Parabola<POWER> {
    #[inline(always)]
    fn bare(self, square: f64) -> f64 {
        let rest = 1.0 - square;
        let rest = if rest > 0.0 { rest } else { 0.0 };
        match POWER {
            1 => rest,
            2 => rest * rest,
            _ => rest * rest * rest,
        }
    }
}

impl Profile for Cone {
    #[inline(always)]
    fn bare(self, square: f64) -> f64 {
        let rest = 1.0 - square.sqrt();
        if rest > 0.0 { rest } else { 0.0 }
    }
}

impl Profile for Arch {
    #[inline(always)]
    fn bare(self, square: f64) -> f64 {
        let inside = if square < 1.0 { square } else { 1.0 };
        let t = inside * (FRAC_PI_2 * FRAC_PI_2);
        let mut cosine = COSINE[10];
        for k in (0..10).rev() {
            cosine = cosine * t + COSINE[k];
        }
        if square < 1.0 { cosine } else { 0.0 }
    }
}

impl Profile for Bell {
    const COMPACT: bool = false;

    #[inline(always)]
    fn bare(self, square: f64) -> f64 {
        exponential(-0.5 * square)
    }
}

/// exp(x) for x ≤ 0 without a branch or a call, to 1.5 units in the last place; exp(-708) below that.
#[inline(always)]
pub(super) fn exponential(x: f64) -> f64 {
    /// Adding this rounds to an integer, which then stands in the low bits.
    const ROUNDER: f64 = 6_755_399_441_055_744.0;
    const HIGH: f64 = 6.931_471_803_691_238e-1;
    const LOW: f64 = 1.908_214_929_270_587_7e-10;
    const TERMS: [f64; 13] = [
        1.0,
        1.0,
        1.0 / 2.0,
        1.0 / 6.0,
        1.0 / 24.0,
        1.0 / 120.0,
        1.0 / 720.0,
        1.0 / 5_040.0,
        1.0 / 40_320.0,
        1.0 / 362_880.0,
        1.0 / 3_628_800.0,
        1.0 / 39_916_800.0,
        1.0 / 479_001_600.0,
    ];
    let x = if x > -708.0 { x } else { -708.0 };
    let rounded = x * LOG2_E + ROUNDER;
    let whole = rounded - ROUNDER;
    let rest = (x - whole * HIGH) - whole * LOW;
    let mut series = TERMS[12];
    for k in (0..12).rev() {
        series = series * rest + TERMS[k];
    }
    series * f64::from_bits((rounded.to_bits() << 52).wrapping_add(1023 << 52))
}

/// Beyond how many h nothing is counted: 1 for compact kernels; for the Gaussian so far that what is left out of a sum is at most `tolerance` of the ceiling,
/// even if all data lay just beyond: exp(-R²/2) = `tolerance`.
pub(super) fn reach(shape: Shape, tolerance: f64) -> f64 {
    match shape {
        Shape::Gaussian => (-2.0 * tolerance.clamp(1e-300, 0.5).ln()).sqrt(),
        _ => 1.0,
    }
}

/// What the kernel in the plane is over the product of `bare`s, or over one `bare` of the distance.
pub(super) fn scale(sum: &crate::kernel::KernelSum<2>) -> f64 {
    use crate::kernel::{Kernel, Symmetry};
    let shape = sum.shape();
    match (sum.symmetry(), shape) {
        // the same function, and the product is cheaper
        (_, Shape::Gaussian) => 0.5 / PI,
        (Symmetry::Product, _) => shape.peak().powi(2),
        (Symmetry::Radial, _) => Symmetry::Radial.peak::<2>(shape),
    }
}

/// Evaluates an expression with the profile of a shape known to the compiler.
macro_rules! with_profile {
    ($shape:expr, $profile:ident => $body:expr) => {{
        use $crate::engine::plane::profile::{Arch as Wave, Bell, Cone, Flat, Parabola};
        match $shape {
            $crate::kernel::Shape::Uniform => {
                let $profile = Flat;
                $body
            }
            $crate::kernel::Shape::Epanechnikov => {
                let $profile = Parabola::<1>;
                $body
            }
            $crate::kernel::Shape::Biweight => {
                let $profile = Parabola::<2>;
                $body
            }
            $crate::kernel::Shape::Triweight => {
                let $profile = Parabola::<3>;
                $body
            }
            $crate::kernel::Shape::Triangular => {
                let $profile = Cone;
                $body
            }
            $crate::kernel::Shape::Cosine => {
                let $profile = Wave;
                $body
            }
            $crate::kernel::Shape::Gaussian => {
                let $profile = Bell;
                $body
            }
        }
    }};
}
pub(super) use with_profile;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Kernel;

    fn bare<P: Profile>(profile: P, square: f64) -> (f64, bool) {
        (profile.bare(square), P::COMPACT)
    }

    #[test]
    fn profiles_are_the_kernels() {
        for shape in Shape::ALL {
            for i in 0..=4000 {
                let u = f64::from(i) * 5e-4 * if shape == Shape::Gaussian { 5.0 } else { 1.0 };
                let (bare, compact) = with_profile!(shape, p => bare(p, u * u));
                let got = bare * shape.peak();
                let exact = shape.value(u);
                assert!((got - exact).abs() < 4e-16, "{shape} at {u}: {got} {exact}");
                assert_eq!(compact, shape != Shape::Gaussian);
            }
        }
    }

    #[test]
    fn the_exponential_is_that_of_the_library() {
        for i in 0..200_000 {
            let x = -f64::from(i) * 0.003_53;
            let (got, exact) = (exponential(x), x.exp());
            assert!(
                (got - exact).abs() <= 4e-16 * exact,
                "{x}: {got:e} {exact:e}"
            );
        }
        assert!(exponential(-1e300) < 1e-300);
    }

    #[test]
    fn the_reach_leaves_out_what_was_allowed() {
        for tolerance in [1e-3, 1e-6, 1e-12] {
            let r = reach(Shape::Gaussian, tolerance);
            let left = Shape::Gaussian.value(r) / Shape::Gaussian.peak();
            assert!((left / tolerance - 1.0).abs() < 1e-10);
        }
    }
}
