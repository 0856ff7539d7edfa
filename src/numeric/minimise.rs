//! Minima of a function of one variable, local and global.
//!
//! # References
//! Brent 1973, Algorithms for Minimization without Derivatives, chapter 5.

/// A minimum: where, and how low.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    /// Where the function is lowest.
    pub at: f64,
    /// Its value there.
    pub value: f64,
}

/// Brent's parabolic search for a minimum of `f` between `low` and `high`, to a relative `tolerance` in the place.
///
/// Finds a local minimum; the global one if `f` is unimodal between the bounds. Tolerances below √ε ≈ 1.5e-8 are raised to it,
/// since the function is flat to rounding within that distance.
pub fn minimise(f: impl Fn(f64) -> f64, low: f64, high: f64, tolerance: f64) -> Minimum {
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    let tolerance = tolerance.max(f64::EPSILON.sqrt());
    let (mut a, mut b) = (low, high);
    let mut x = GOLDEN.mul_add(b - a, a);
    let (mut w, mut v) = (x, x);
    let mut fx = f(x);
    let (mut fw, mut fv) = (fx, fx);
    let (mut step, mut before) = (0.0_f64, 0.0_f64);
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        let near = tolerance.mul_add(x.abs(), 1e-300);
        if (x - middle).abs() <= 2.0f64.mul_add(near, -0.5 * (b - a)) {
            break;
        }
        let mut golden = true;
        if before.abs() > near {
            let r = (x - w) * (fx - fv);
            let q = (x - v) * (fx - fw);
            let mut p = (x - v).mul_add(q, -(x - w) * r);
            let mut q = 2.0 * (q - r);
            if q > 0.0 {
                p = -p;
            }
            q = q.abs();
            if p.abs() < (0.5 * q * before).abs() && p > q * (a - x) && p < q * (b - x) {
                before = step;
                step = p / q;
                let u = x + step;
                if u - a < 2.0 * near || b - u < 2.0 * near {
                    step = near.copysign(middle - x);
                }
                golden = false;
            }
        }
        if golden {
            before = if x >= middle { a - x } else { b - x };
            step = GOLDEN * before;
        }
        let u = if step.abs() >= near {
            x + step
        } else {
            x + near.copysign(step)
        };
        let fu = f(u);
        if fu <= fx {
            if u >= x {
                a = x;
            } else {
                b = x;
            }
            (v, fv, w, fw, x, fx) = (w, fw, x, fx, u, fu);
        } else {
            if u < x {
                a = u;
            } else {
                b = u;
            }
            #[expect(
                clippy::float_cmp,
                reason = "the points are copies of each other, as in Brent's procedure"
            )]
            if fu <= fw || w == x {
                (v, fv, w, fw) = (w, fw, u, fu);
            } else if fu <= fv || v == x || v == w {
                (v, fv) = (u, fu);
            }
        }
    }
    Minimum { at: x, value: fx }
}

/// All local minima of `f` on a geometric ladder of `steps` places from `low` to `high` (both positive), each refined by [`minimise`];
/// the lowest first. Empty if the lowest values are at the ends: there is no interior minimum.
pub fn local_minima(f: impl Fn(f64) -> f64, low: f64, high: f64, steps: usize) -> Vec<Minimum> {
    let ratio = (high / low).ln() / (steps - 1) as f64;
    let ladder: Vec<f64> = (0..steps).map(|i| low * (ratio * i as f64).exp()).collect();
    let values: Vec<f64> = ladder.iter().map(|&x| f(x)).collect();
    let mut found: Vec<Minimum> = (1..steps.saturating_sub(1))
        .filter(|&i| values[i] < values[i - 1] && values[i] <= values[i + 1])
        .map(|i| minimise(&f, ladder[i - 1], ladder[i + 1], 1e-8))
        .collect();
    found.sort_by(|a, b| a.value.total_cmp(&b.value));
    found
}

#[cfg(test)]
mod tests {
    use super::{local_minima, minimise};

    #[test]
    fn a_parabola_has_its_vertex() {
        let found = minimise(|x| (x - 0.3).powi(2) + 2.0, -1.0, 5.0, 1e-8);
        assert!((found.at - 0.3).abs() < 1e-7, "{found:?}");
        assert!((found.value - 2.0).abs() < 1e-14);
    }

    #[test]
    fn both_wells_are_found_the_deeper_first() {
        let wells = |x: f64| (x - 1.0).powi(2) * (x - 4.0).powi(2) + 0.1 * x;
        let found = local_minima(wells, 0.1, 10.0, 60);
        assert_eq!(found.len(), 2);
        assert!(
            (found[0].at - 1.0).abs() < 0.02 && (found[1].at - 4.0).abs() < 0.02,
            "{found:?}"
        );
    }
}
