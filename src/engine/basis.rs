//! The functions in which a compact kernel separates into a factor of the target and a factor of the datum.
//!
//! For a target at y and a datum at d, both seen from one centre in units of h, every compact kernel is a finite sum
//! K(y - d) = Σₖ aₖ(y) bₖ(d) as long as y - d stays inside one piece of the kernel. So Σᵢ wᵢ K(y - dᵢ) needs only the *moments*
//! Mₖ = Σᵢ wᵢ bₖ(dᵢ), however many data there are: powers of d for polynomials, cosine and sine for the cosine kernel.
// inlined wherever it is called from code compiled for wide registers
#![allow(clippy::inline_always)]

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Data handled at one go by the loops over all data: long enough to fill vector registers, short enough to stay in the first cache.
pub(super) const CHUNK: usize = 512;

/// Which side of the data a target is on: the piece of the kernel in which u = y - d lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// u ≥ 0: the target lies to the right of the data.
    Right,
    /// u ≤ 0.
    Left,
}

/// `N` functions of the datum that span a kernel on each of its pieces.
pub(super) trait Basis<const N: usize>: Copy + Send + Sync {
    /// Whether lifting does anything; if not, the lifted numbers of a datum are its distance and nothing.
    const LIFTS: bool;

    /// Whether the kernel has two pieces, left and right of 0.
    const KINKED: bool;

    /// Turns the distances of a chunk of data into the two numbers from which [`Basis::row`] makes the moments of one datum.
    fn lift(self, first: &mut [f64; CHUNK], second: &mut [f64; CHUNK]);

    /// The functions at one datum, from its lifted numbers.
    fn row(self, first: f64, second: f64) -> [f64; N];

    /// The functions at a datum at distance `d` (|d| ≤ 1) from the centre.
    fn at(self, d: f64) -> [f64; N];

    /// Moments about another centre, which sees every datum at d + `by` instead of d.
    fn shift(self, moments: &[f64; N], by: f64) -> [f64; N];

    /// Σ w K(y - d) of the data with these moments.
    fn value(self, moments: &[f64; N], y: f64, side: Side) -> f64;
}

/// 1, d, d², ... for a kernel that is a polynomial in |u|.
#[derive(Clone, Copy, Debug)]
pub(super) struct Powers<const N: usize> {
    right: [f64; N],
    left: [f64; N],
}

impl<const N: usize> Powers<N> {
    /// The basis for K(u) = Σ cₖ |u|ᵏ; at most `N` coefficients. The rest are zeros: an `N` that fills vector registers
    /// costs less than one that does not.
    pub(super) fn new(coefficients: &[f64]) -> Self {
        let right = std::array::from_fn(|k| coefficients.get(k).copied().unwrap_or(0.0));
        let mut left: [f64; N] = right;
        left.iter_mut().skip(1).step_by(2).for_each(|c| *c = -*c);
        Self { right, left }
    }
}

impl<const N: usize> Basis<N> for Powers<N> {
    const LIFTS: bool = false;
    // of the kernels, those of first degree in |u| and no others are not one polynomial in u
    const KINKED: bool = N == 2;

    #[inline(always)]
    fn lift(self, _first: &mut [f64; CHUNK], _second: &mut [f64; CHUNK]) {}

    #[inline(always)]
    fn row(self, first: f64, _second: f64) -> [f64; N] {
        self.at(first)
    }

    #[inline(always)]
    fn at(self, d: f64) -> [f64; N] {
        let mut powers = [1.0; N];
        if N == 8 {
            // so that the upper half is the lower one times one number
            let square = d * d;
            let low = [1.0, d, square, d * square];
            let fourth = square * square;
            for k in 0..N {
                powers[k] = if k < 4 { low[k] } else { fourth * low[k - 4] };
            }
            return powers;
        }
        // products of halves rather than a chain: they do not wait for each other
        for k in 1..N {
            powers[k] = if k == 1 {
                d
            } else {
                powers[k / 2] * powers[k - k / 2]
            };
        }
        powers
    }

    #[inline]
    fn shift(self, moments: &[f64; N], by: f64) -> [f64; N] {
        // (d + b)ᵏ for all k by repeated Horner steps, the triangle of Pascal without its numbers
        let mut shifted = *moments;
        for from in 1..N {
            for k in (from..N).rev() {
                shifted[k] += by * shifted[k - 1];
            }
        }
        shifted
    }

    #[inline]
    fn value(self, moments: &[f64; N], y: f64, side: Side) -> f64 {
        let mut taylor = match side {
            Side::Right => self.right,
            Side::Left => self.left,
        };
        let mut total = 0.0;
        let mut sign = 1.0;
        for k in 0..N {
            // dividing by (u - y) again and again leaves the Taylor coefficients at y
            for i in (k..N - 1).rev() {
                taylor[i] += y * taylor[i + 1];
            }
            total += sign * taylor[k] * moments[k];
            sign = -sign;
        }
        total
    }
}

/// 1, d, d² and nothing, for a kernel of second degree: the squares are made in vector registers, before the moments are scattered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parabola(Powers<4>);

impl Parabola {
    /// The basis for K(u) = c₀ + c₂u².
    pub(super) fn new(coefficients: &[f64]) -> Self {
        Self(Powers::new(coefficients))
    }
}

impl Basis<4> for Parabola {
    const LIFTS: bool = true;
    const KINKED: bool = false;

    #[inline(always)]
    fn lift(self, first: &mut [f64; CHUNK], second: &mut [f64; CHUNK]) {
        for i in 0..CHUNK {
            second[i] = first[i] * first[i];
        }
    }

    #[inline(always)]
    fn row(self, first: f64, second: f64) -> [f64; 4] {
        [1.0, first, second, 0.0]
    }

    #[inline(always)]
    fn at(self, d: f64) -> [f64; 4] {
        self.row(d, d * d)
    }

    // what comes to stand in the place of the cubes is never looked at
    #[inline]
    fn shift(self, moments: &[f64; 4], by: f64) -> [f64; 4] {
        self.0.shift(moments, by)
    }

    #[inline]
    fn value(self, moments: &[f64; 4], y: f64, side: Side) -> f64 {
        self.0.value(moments, y, side)
    }
}

/// cos(πd/2), sin(πd/2) for the kernel π/4 cos(πu/2).
#[derive(Clone, Copy, Debug)]
pub(super) struct Waves;

/// Alternating Taylor coefficients 1/k! - 1/(k+2)! ... of the cosine (first = 0) or sine (first = 1) in x².
const fn taylor(first: u32) -> [f64; 11] {
    let mut terms = [0.0; 11];
    let mut factorial = 1.0;
    let mut k = 0;
    while k < 11 {
        terms[k] = if k % 2 == 0 { 1.0 } else { -1.0 } / factorial;
        let next = (first as usize + 2 * k + 1) as f64;
        factorial *= next * (next + 1.0);
        k += 1;
    }
    terms
}

/// Up to x²⁰ and x²¹: on |x| ≤ π/2 the first term left out is below 2e-17.
pub(super) const COSINE: [f64; 11] = taylor(0);
const SINE: [f64; 11] = taylor(1);

impl Basis<2> for Waves {
    const LIFTS: bool = true;
    const KINKED: bool = false;

    #[inline(always)]
    fn lift(self, first: &mut [f64; CHUNK], second: &mut [f64; CHUNK]) {
        for i in 0..CHUNK {
            [first[i], second[i]] = self.at(first[i]);
        }
    }

    #[inline(always)]
    fn row(self, first: f64, second: f64) -> [f64; 2] {
        [first, second]
    }

    #[inline(always)]
    fn at(self, d: f64) -> [f64; 2] {
        let x = FRAC_PI_2 * d;
        let square = x * x;
        let (mut cosine, mut sine) = (COSINE[10], SINE[10]);
        for k in (0..10).rev() {
            cosine = cosine * square + COSINE[k];
            sine = sine * square + SINE[k];
        }
        [cosine, sine * x]
    }

    #[inline]
    fn shift(self, moments: &[f64; 2], by: f64) -> [f64; 2] {
        let (sine, cosine) = (FRAC_PI_2 * by).sin_cos();
        [
            moments[0] * cosine - moments[1] * sine,
            moments[1] * cosine + moments[0] * sine,
        ]
    }

    #[inline]
    fn value(self, moments: &[f64; 2], y: f64, _side: Side) -> f64 {
        let (sine, cosine) = (FRAC_PI_2 * y).sin_cos();
        FRAC_PI_4 * (cosine * moments[0] + sine * moments[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Form, Kernel, Shape};

    fn separates<const N: usize>(shape: Shape, basis: impl Basis<N>, used: usize) {
        let pairs = [
            (0.9, 0.3),
            (-0.6, 0.35),
            (0.2, -0.7),
            (0.5, 0.5),
            (-1.3, -0.4),
        ];
        for (y, d) in pairs {
            let side = if y >= d { Side::Right } else { Side::Left };
            let direct = shape.value(y - d);
            assert!(
                (basis.value(&basis.at(d), y, side) - direct).abs() < 4e-15,
                "{shape} {y} {d}"
            );
            // the same datum and target seen from a centre 0.4 further left
            let moved = basis.shift(&basis.at(d), 0.4);
            assert!(
                (basis.value(&moved, y + 0.4, side) - direct).abs() < 4e-15,
                "{shape} {y} {d}"
            );
            // a place that the kernel does not use may hold anything
            for k in 0..used {
                assert!((moved[k] - basis.at(d + 0.4)[k]).abs() < 1e-15);
            }
        }
        let mut first = std::array::from_fn(|i| (i as f64 / CHUNK as f64).mul_add(2.0, -1.0));
        let distances = first;
        let mut second = [0.0; CHUNK];
        basis.lift(&mut first, &mut second);
        for i in 0..CHUNK {
            assert_eq!(
                basis.row(first[i], second[i]).map(f64::to_bits),
                basis.at(distances[i]).map(f64::to_bits)
            );
        }
    }

    #[test]
    fn kernels_separate_into_target_and_datum() {
        for shape in Shape::ALL {
            match shape.form() {
                Form::Polynomial(c) if c.len() == 1 => separates(shape, Powers::<1>::new(c), 1),
                Form::Polynomial(c) if c.len() == 2 => separates(shape, Powers::<2>::new(c), 2),
                Form::Polynomial(c) if c.len() <= 4 => {
                    separates(shape, Powers::<4>::new(c), 4);
                    separates(shape, Parabola::new(c), 3);
                }
                Form::Polynomial(c) => separates(shape, Powers::<8>::new(c), 8),
                Form::Cosine => separates(shape, Waves, 2),
                Form::Gaussian => {}
            }
        }
    }

    #[test]
    fn cosine_and_sine_are_those_of_the_library() {
        for i in -1000..=1000 {
            let d = f64::from(i) / 1000.0;
            let (sine, cosine) = (FRAC_PI_2 * d).sin_cos();
            let [c, s] = Waves.at(d);
            assert!(
                (c - cosine).abs() < 3e-16 && (s - sine).abs() < 3e-16,
                "{d}"
            );
        }
    }
}
