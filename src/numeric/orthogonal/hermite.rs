//! Hermite functions.

use super::{Basis, LANES, Row};

/// φₖ(u) = (2ᵏ k! √π)^(-1/2) Hₖ(u) exp(-u²/2) on the line, by φₖ₊₁ = √(2/(k + 1)) u φₖ - √(k/(k + 1)) φₖ₋₁.
///
/// Up to the turning point |u| = √(2k + 1) the functions swing, beyond it they fade faster than exp(-(|u| - √(2k + 1))²/2). Where exp(-u²/2) is too
/// small to start from, the polynomials are kept apart from it with a scale of their own, so that functions of high degree are right far out as well.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hermite;

/// Beyond this the recurrence would start below 1e-270.
const PLAIN: f64 = 35.0;

/// What a polynomial is divided by when it exceeds it, and its logarithm.
const LARGE: f64 = 1e150;
const LARGE_LOGARITHM: f64 = 345.387_763_949_107;

/// φ₀(0) = π^(-1/4).
const TOP: f64 = 0.751_125_544_464_943;

impl Basis for Hermite {
    const COMPACT: bool = false;

    fn cuts(terms: usize) -> Vec<f64> {
        // the steepest phase is √(2k + 1), in the middle
        let turn = (2.0 * terms as f64 + 1.0).sqrt();
        let end = turn + 8.0;
        let panels = (end * turn / 2.0).ceil().max(8.0);
        (0..=panels as usize)
            .map(|i| end * (2.0 * i as f64 / panels - 1.0))
            .collect()
    }

    #[inline(always)]
    fn walk(u: &Row, terms: usize, mut visit: impl FnMut(usize, &Row)) {
        // so far beyond the turning point of the last function that nothing is left of any
        let end = (2.0 * terms as f64 + 1.0).sqrt() + 40.0;
        // there the polynomials would overflow; nothing is there
        let u = u.map(|u| if u.abs() < end { u } else { f64::NAN });
        let far = u.iter().any(|u| u.abs() > PLAIN);
        // φₖ = now · exp(exponent); the exponent is 0 except far out
        let mut exponent = u.map(|u| if u.abs() > PLAIN { -0.5 * u * u } else { 0.0 });
        let mut now = u.map(|u| {
            if u.abs() > PLAIN {
                TOP
            } else {
                TOP * (-0.5 * u * u).exp()
            }
        });
        let (mut before, mut row) = ([0.0; LANES], [0.0; LANES]);
        for k in 0..terms {
            let next = k as f64 + 1.0;
            let (rise, fall) = ((2.0 / next).sqrt(), (k as f64 / next).sqrt());
            for lane in 0..LANES {
                let value = now[lane];
                row[lane] = if value.is_nan() { 0.0 } else { value };
                now[lane] = rise * u[lane] * value - fall * before[lane];
                before[lane] = value;
            }
            if far {
                for lane in 0..LANES {
                    if exponent[lane] < 0.0 {
                        row[lane] *= exponent[lane].exp();
                        if now[lane].abs() > LARGE {
                            now[lane] /= LARGE;
                            before[lane] /= LARGE;
                            exponent[lane] += LARGE_LOGARITHM;
                        }
                    }
                }
            }
            visit(k, &row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_degrees_are_the_known_functions() {
        for u in [-3.0, -0.4, 0.0, 1.1, 5.0_f64] {
            let bell = TOP * (-0.5 * u * u).exp();
            let known = [
                bell,
                2.0_f64.sqrt() * u * bell,
                (4.0 * u * u - 2.0) / 8.0_f64.sqrt() * bell,
                (8.0 * u.powi(3) - 12.0 * u) / 48.0_f64.sqrt() * bell,
            ];
            for (value, known) in Hermite::at(u, 4).iter().zip(known) {
                assert!((value - known).abs() < 1e-15, "at {u}");
            }
        }
    }

    /// The two ways of computing meet where one takes over from the other, and nothing is lost far out: 40-digit values from mpmath.
    #[test]
    fn functions_of_high_degree_are_right_far_out() {
        let (inside, outside) = (
            Hermite::at(PLAIN, 900),
            Hermite::at(PLAIN * (1.0 + 1e-15), 900),
        );
        for (k, (a, b)) in inside.iter().zip(&outside).enumerate() {
            assert!((a - b).abs() <= 1e-12 + 1e-10 * a.abs(), "{k}: {a} {b}");
        }
        for (k, u, known) in [
            (800, 39.0, 0.137_887_883_721_607_4),
            (800, 41.0, 3.709_878_316_793_961_6e-4),
            (899, 45.0, 6.683_424_739_921_111e-13),
            (700, 30.0, 0.138_469_869_183_420_86),
        ] {
            let value = Hermite::at(u, k + 1)[k];
            assert!((value - known).abs() < 1e-11 * known, "{k} at {u}: {value}");
        }
        for u in [39.0, 45.0, 1e3, 1e300, -1e300, f64::INFINITY] {
            let values = Hermite::at(u, 900);
            assert!(values.iter().all(|v| v.is_finite() && v.abs() < 1.0), "{u}");
        }
        assert!(Hermite::at(1e300, 900).iter().all(|v| *v == 0.0));
    }
}
