//! Cosines.

use super::{Basis, LANES, Row};
use std::f64::consts::{PI, SQRT_2};

/// φ₀ = 1, φₖ = √2 cos πku on \[0, 1\]: the series of the density reflected at both ends, so that no end jumps.
///
/// By turning (cos πku, sin πku) through the angle πu again and again: rounding grows like k, where the recurrence of Chebyshev alone lets it grow like k² at the ends.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cosine;

impl Basis for Cosine {
    const COMPACT: bool = true;

    #[inline(always)]
    fn walk(u: &Row, terms: usize, mut visit: impl FnMut(usize, &Row)) {
        if terms == 0 {
            return;
        }
        visit(0, &[1.0; LANES]);
        let turn = u.map(|u| (PI * u).sin_cos());
        let mut now = turn.map(|(sin, cos)| (SQRT_2 * sin, SQRT_2 * cos));
        let mut row = [0.0; LANES];
        for k in 1..terms {
            for lane in 0..LANES {
                let (sin, cos) = now[lane];
                let (s, c) = turn[lane];
                row[lane] = cos;
                now[lane] = (sin * c + cos * s, cos * c - sin * s);
            }
            visit(k, &row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn high_degrees_keep_their_digits() {
        for u in [0.0, 1e-9, 0.1, 0.5, 0.777, 1.0 - 1e-9, 1.0] {
            for (k, value) in Cosine::at(u, 1000).into_iter().enumerate().skip(1) {
                let exact = SQRT_2 * (PI * k as f64 * u).cos();
                assert!((value - exact).abs() < 1e-12, "{k} at {u}: {value} {exact}");
            }
        }
    }
}
