//! Legendre polynomials.

use super::{Basis, LANES, Row};

/// φₖ = √(2k + 1) Pₖ(2u - 1) on \[0, 1\], by (k + 1) Pₖ₊₁ = (2k + 1) t Pₖ - k Pₖ₋₁, which is stable for |t| ≤ 1.
#[derive(Clone, Copy, Debug, Default)]
pub struct Legendre;

impl Basis for Legendre {
    const COMPACT: bool = true;

    #[inline(always)]
    fn walk(u: &Row, terms: usize, mut visit: impl FnMut(usize, &Row)) {
        let t = u.map(|u| 2.0 * u - 1.0);
        let (mut before, mut now, mut row) = ([0.0; LANES], [1.0; LANES], [0.0; LANES]);
        for k in 0..terms {
            let k_real = k as f64;
            let norm = (2.0 * k_real + 1.0).sqrt();
            let (rise, fall) = (
                (2.0 * k_real + 1.0) / (k_real + 1.0),
                k_real / (k_real + 1.0),
            );
            for lane in 0..LANES {
                row[lane] = norm * now[lane];
                let next = rise * t[lane] * now[lane] - fall * before[lane];
                (before[lane], now[lane]) = (now[lane], next);
            }
            visit(k, &row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_degrees_are_the_known_polynomials_and_the_ends_are_one() {
        for u in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let t: f64 = 2.0 * u - 1.0;
            let values = Legendre::at(u, 4);
            let known = [
                1.0,
                3.0_f64.sqrt() * t,
                5.0_f64.sqrt() * (1.5 * t * t - 0.5),
                7.0_f64.sqrt() * (2.5 * t.powi(3) - 1.5 * t),
            ];
            for (value, known) in values.iter().zip(known) {
                assert!((value - known).abs() < 1e-14);
            }
        }
        for (k, value) in Legendre::at(1.0, 600).into_iter().enumerate() {
            assert!((value / (2.0 * k as f64 + 1.0).sqrt() - 1.0).abs() < 1e-12);
        }
        // P₅₀₀(0) = C(500, 250) / 2⁵⁰⁰ = 0.0356646
        let middle = Legendre::at(0.5, 501)[500] / 1001.0_f64.sqrt();
        assert!(
            (middle - 0.035_664_645_553_349_05).abs() < 1e-12,
            "{middle}"
        );
    }
}
