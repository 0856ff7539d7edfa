//! Errors of Gaussian kernels that are reflected at the walls of a rectangle.
//!
//! Reflected at all walls, however often, a Gaussian kernel multiplies the coefficient of each product of cosines by exp(-π² (j² h₁² + k² h₂²)/2), so that
//! ∫(E f̂ - f)² and ∫var f̂ are sums over the coefficients of the density. \[Botev, Grotowski & Kroese 2010, section 3, for the kernel\]

use crate::density::Bivariate;
use crate::numeric::{Sum, forward_transform, local_minima};
use crate::theory::{Integrated, Optimum};
use rayon::prelude::*;
use realfft::num_complex::Complex;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// The integrated errors over the rectangle, for any bandwidth and sample size.
///
/// The coefficients are those of the values at the middles of 1024² cells: exact for what has no finer detail, and right to some tenths of a per cent where the density
/// jumps. Some tenths of a second at first, a millisecond for each bandwidth.
pub struct ReflectedError {
    /// a² and E φ² for each pair of frequencies up to `MOST` on the rectangle as a unit square, the second faster.
    terms: Vec<[f64; 2]>,
    /// ∫f² of the density on the unit square.
    power: f64,
    /// The sides of the rectangle.
    sides: [f64; 2],
}

/// Cells along each side.
const CELLS: usize = 1024;
/// Frequencies along each side: those whose double the cells still resolve.
const MOST: usize = CELLS / 2;
/// Bandwidths in whose kernels this many frequencies are all that is left.
const NARROWEST: f64 = 2.0 / MOST as f64;
/// The mass that cells may miss or add.
const MISSED: f64 = 1e-3;
/// Bandwidths that are tried before the best is refined.
const STEPS: usize = 40;

impl ReflectedError {
    /// For a density between four walls; `None` for any other, and for one with details that the cells miss.
    pub fn new(truth: &dyn Bivariate) -> Option<Self> {
        let domain = truth.domain();
        let (low, high) = (domain.low(), domain.high());
        let closed = low.iter().chain(&high).all(|end| end.is_finite());
        if !closed || domain.outline().is_some() || domain.wraps() {
            return None;
        }
        let sides = [0, 1].map(|k: usize| high[k] - low[k]);
        let area = sides[0] * sides[1];
        let middle = |k: usize, i: usize| low[k] + (i as f64 + 0.5) / CELLS as f64 * sides[k];
        let values: Vec<f64> = (0..CELLS * CELLS)
            .into_par_iter()
            .map(|n| area * truth.at([middle(0, n / CELLS), middle(1, n % CELLS)]))
            .collect();
        let squares: Sum = values.iter().map(|g| g * g).collect();
        let power = squares.value() / (CELLS * CELLS) as f64;
        // along the second axis, then along the first
        let half = transposed(&cosines(&values));
        let coefficients = transposed(&cosines(&half));
        let a = |j: usize, k: usize| coefficients[j * CELLS + k];
        // φ² = 1 + φ of twice the frequency / √2, but for the constant
        // a detail that the cells miss has a mass
        if (coefficients[0] - 1.0).abs() > MISSED {
            return None;
        }
        let double = |j: usize| if j == 0 { 0.0 } else { FRAC_1_SQRT_2 };
        let terms = (0..MOST * MOST).map(|n| {
            let (j, k) = (n / MOST, n % MOST);
            let square = 1.0
                + double(j) * a(2 * j, 0)
                + double(k) * a(0, 2 * k)
                + double(j) * double(k) * a(2 * j, 2 * k);
            [a(j, k).powi(2), square]
        });
        Some(Self {
            terms: terms.collect(),
            power,
            sides,
        })
    }

    /// The errors with bandwidth `h` on both axes and samples of `draws` points.
    pub fn at(&self, h: f64, draws: f64) -> Integrated {
        let decay = |k: usize| -> Vec<f64> {
            let rate = 0.5 * (PI * h / self.sides[k]).powi(2);
            (0..MOST).map(|j| (-rate * (j * j) as f64).exp()).collect()
        };
        let (along, across) = (decay(0), decay(1));
        let (mut known, mut bias, mut variance) = (Sum::default(), Sum::default(), Sum::default());
        for (row, first) in self.terms.chunks_exact(MOST).zip(along) {
            for ([square, spread], second) in row.iter().zip(&across) {
                let weight = first * second;
                known.add(*square);
                bias.add((1.0 - weight).powi(2) * square);
                variance.add(weight * weight * (spread - square));
            }
        }
        // of what is finer nothing is left
        let finer = (self.power - known.value()).max(0.0);
        let area = self.sides[0] * self.sides[1];
        Integrated {
            squared_bias: (bias.value() + finer) / area,
            variance: variance.value().max(0.0) / draws / area,
        }
    }

    /// The bandwidth of least MISE; `None` where the widest is the best, as for an even density, or a narrower one than is resolved.
    pub fn optimum(&self, draws: f64) -> Option<Optimum> {
        let [least, most] = [f64::min, f64::max].map(|pick| pick(self.sides[0], self.sides[1]));
        if NARROWEST * most >= least {
            return None;
        }
        let mise = |h: f64| self.at(h, draws).mise();
        let found = local_minima(mise, NARROWEST * most, least, STEPS);
        let (best, others) = found.split_first()?;
        Some(Optimum {
            at: best.at,
            error: self.at(best.at, draws),
            others: others.to_vec(),
        })
    }
}

/// The coefficients Σ x_n √2 cos(πj(n + ½)/N) / N of each row, without √2 for the constant: through the spectrum of the row and its mirror image.
fn cosines(rows: &[f64]) -> Vec<f64> {
    let plan = forward_transform(2 * CELLS);
    let turn: Vec<Complex<f64>> = (0..CELLS)
        .map(|j| {
            let scale = if j == 0 { 0.5 } else { FRAC_1_SQRT_2 };
            Complex::from_polar(scale / CELLS as f64, -PI * j as f64 / (2 * CELLS) as f64)
        })
        .collect();
    let rows = rows.par_chunks_exact(CELLS).flat_map_iter(|row| {
        let mut mirrored: Vec<f64> = row.iter().chain(row.iter().rev()).copied().collect();
        let mut spectrum = plan.make_output_vec();
        // lengths are those of the plan
        let done = plan.process(&mut mirrored, &mut spectrum);
        debug_assert!(done.is_ok());
        let found: Vec<f64> = (spectrum.iter().zip(&turn))
            .map(|(y, t)| (y * t).re)
            .collect();
        found
    });
    rows.collect()
}

fn transposed(square: &[f64]) -> Vec<f64> {
    (0..CELLS * CELLS)
        .map(|n| square[(n % CELLS) * CELLS + n / CELLS])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{CELLS, MOST, ReflectedError, cosines};
    use crate::density;
    use crate::parameter::Values;

    fn named(name: &str) -> ReflectedError {
        let entry = density::entry(name).expect("in the catalogue");
        let truth = entry
            .build(&Values::defaults(entry.parameters))
            .expect("legal");
        let truth = truth.plane().expect("in the plane");
        ReflectedError::new(&*truth).expect("four walls")
    }

    /// On a rectangle that is no square, by hand.
    #[test]
    fn sides_are_told_apart() {
        let unit = named("ramp-2d");
        let mut long = ReflectedError {
            terms: unit.terms.clone(),
            power: unit.power,
            sides: [1.0, 3.0],
        };
        let (h, n) = (0.1, 50.0);
        let found = long.at(h, n);
        let direct: f64 = (0..MOST * MOST)
            .map(|at| {
                let (j, k) = ((at / MOST) as f64, (at % MOST) as f64);
                let rate = |x: f64| -0.5 * (std::f64::consts::PI * h * x).powi(2);
                let weight = (rate(j) + rate(k / 3.0)).exp();
                let [square, spread] = long.terms[at];
                (1.0 - weight).powi(2) * square + weight * weight * (spread - square) / n
            })
            .sum();
        let known: f64 = long.terms.iter().map(|t| t[0]).sum();
        let direct = (direct + (long.power - known).max(0.0)) / 3.0;
        assert!((found.mise() / direct - 1.0).abs() < 1e-9);
        // the ramp rises along the first axis: it is smoothed less where that is the longer one
        long.sides = [3.0, 1.0];
        assert!(long.at(h, n).squared_bias < 0.5 * found.squared_bias);
        long.sides = [1.0, 300.0];
        assert!(long.optimum(n).is_none());
    }

    #[test]
    fn cosines_are_sums_of_products() {
        let row: Vec<f64> = (0..CELLS)
            .map(|n| ((n * n) as f64 * 0.001).sin() + 0.3)
            .collect();
        let found = cosines(&row);
        for j in [0, 1, 2, 77, CELLS - 1] {
            let scale = if j == 0 { 1.0 } else { 2.0_f64.sqrt() } / CELLS as f64;
            let term = |(n, x): (usize, &f64)| {
                x * (std::f64::consts::PI * j as f64 * (n as f64 + 0.5) / CELLS as f64).cos()
            };
            let direct: f64 = row.iter().enumerate().map(term).sum();
            assert!((found[j] - scale * direct).abs() < 1e-12, "{j}");
        }
    }

    /// Of an even density nothing but the variance is wrong: Σ w² / n over all frequencies but the constant.
    #[test]
    fn an_even_density_has_no_bias() {
        let errors = named("uniform-2d");
        let h = 0.05;
        let found = errors.at(h, 100.0);
        let side: f64 = (0..MOST)
            .map(|j| (-(std::f64::consts::PI * h * j as f64).powi(2)).exp())
            .sum();
        assert!(found.squared_bias < 1e-20);
        assert!((found.variance / ((side * side - 1.0) / 100.0) - 1.0).abs() < 1e-12);
        assert!(errors.optimum(100.0).is_none());
    }
}
