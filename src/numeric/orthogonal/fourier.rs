//! Sines and cosines of whole periods.

use super::{Basis, LANES, Row};
use std::f64::consts::{SQRT_2, TAU};

/// φ₀ = 1, φ₂ₖ₋₁ = √2 cos 2πku, φ₂ₖ = √2 sin 2πku on \[0, 1\]: for what wraps round. What does not jumps where the ends meet, and is overshot there
/// however many terms there are.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fourier;

impl Basis for Fourier {
    const COMPACT: bool = true;

    fn functions(terms: usize) -> usize {
        (2 * terms).saturating_sub(1)
    }

    fn cuts(terms: usize) -> Vec<f64> {
        // two half waves a degree
        super::graded(2 * terms / 3 + 4)
    }

    fn degree(index: usize) -> usize {
        index.div_ceil(2)
    }

    #[inline(always)]
    fn walk(u: &Row, terms: usize, mut visit: impl FnMut(usize, &Row)) {
        if terms == 0 {
            return;
        }
        visit(0, &[1.0; LANES]);
        let turn = u.map(|u| (TAU * u).sin_cos());
        let mut now = turn.map(|(sin, cos)| (SQRT_2 * sin, SQRT_2 * cos));
        let (mut cosines, mut sines) = ([0.0; LANES], [0.0; LANES]);
        for k in 1..terms {
            for lane in 0..LANES {
                let (sin, cos) = now[lane];
                let (s, c) = turn[lane];
                (cosines[lane], sines[lane]) = (cos, sin);
                now[lane] = (sin * c + cos * s, cos * c - sin * s);
            }
            visit(2 * k - 1, &cosines);
            visit(2 * k, &sines);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn high_degrees_keep_their_digits_and_the_ends_meet() {
        for u in [0.0, 0.1, 0.5, 0.777, 1.0] {
            for (i, value) in Fourier::at(u, 500).into_iter().enumerate().skip(1) {
                let angle = TAU * Fourier::degree(i) as f64 * u;
                let exact = SQRT_2 * if i % 2 == 1 { angle.cos() } else { angle.sin() };
                assert!((value - exact).abs() < 2e-12, "{i} at {u}: {value} {exact}");
            }
        }
    }
}
