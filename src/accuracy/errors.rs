//! Errors of one estimate.

use crate::numeric::{Sum, two_sum};
use pulp::{Arch, Simd, WithSimd};
use serde::{Deserialize, Serialize};

/// Relative errors are taken where the truth is at least this share of its peak: in the far tails any estimate is relatively
/// infinitely wrong, and says nothing about lighting or plots.
pub const RELATIVE_FLOOR: f64 = 0.01;

/// The errors of one estimate on a grid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// ∫(f̂ - f)².
    pub ise: f64,
    /// ∫|f̂ - f|.
    pub iae: f64,
    /// ∫((f̂ - f)/f)² over the set where f ≥ [`RELATIVE_FLOOR`] × its peak.
    pub ire: f64,
    /// The mean of f̂ - f over the cells.
    #[serde(default)]
    pub bias: f64,
}

impl Errors {
    /// The errors of `estimate` against `truth`, values on the cells of one grid of cell measure `cell`.
    pub fn between(estimate: &[f64], truth: &[f64], cell: f64) -> Self {
        Yardstick::new(truth.to_vec()).errors(estimate, cell)
    }

    fn from_sums([signed, squares, absolute, relative]: [f64; 4], many: f64, cell: f64) -> Self {
        Self {
            ise: squares * cell,
            iae: absolute * cell,
            ire: relative * cell,
            bias: if many > 0.0 { signed / many } else { 0.0 },
        }
    }
}

/// A truth on the cells of a grid, ready to measure many estimates against.
#[derive(Clone, Debug)]
pub struct Yardstick {
    truth: Vec<f64>,
    /// 1/f where relative errors are taken, else 0.
    inverse: Vec<f64>,
}

impl Yardstick {
    /// The values of `truth` on the cells.
    pub fn new(truth: Vec<f64>) -> Self {
        let floor = RELATIVE_FLOOR * truth.iter().copied().fold(0.0, f64::max);
        let taken = |f: f64| {
            if f >= floor && f > 0.0 {
                f.recip()
            } else {
                0.0
            }
        };
        Self {
            inverse: truth.iter().map(|&f| taken(f)).collect(),
            truth,
        }
    }

    /// The truth.
    pub fn truth(&self) -> &[f64] {
        &self.truth
    }

    /// The errors of `estimate` over all cells, of measure `cell` each. O(cells), 1.5 ns a cell.
    ///
    /// # Panics
    /// If there is not one value for each cell.
    pub fn errors(&self, estimate: &[f64], cell: f64) -> Errors {
        assert_eq!(estimate.len(), self.truth.len(), "one value per cell");
        let sums = Arch::new().dispatch(Lanes {
            estimate,
            truth: &self.truth,
            inverse: &self.inverse,
        });
        Errors::from_sums(sums, estimate.len() as f64, cell)
    }

    /// The errors over some of the cells; where the truth is small is told by all of them.
    pub fn errors_over(
        &self,
        cells: impl Iterator<Item = usize>,
        estimate: &[f64],
        cell: f64,
    ) -> Errors {
        let (mut sums, mut many) = ([Sum::default(); 4], 0.0);
        for i in cells {
            many += 1.0;
            let terms = terms(estimate[i], self.truth[i], self.inverse[i]);
            for (sum, term) in sums.iter_mut().zip(terms) {
                sum.add(term);
            }
        }
        Errors::from_sums(sums.map(Sum::value), many, cell)
    }
}

/// Error, square, absolute value and square of the relative error.
#[inline(always)]
fn terms(estimate: f64, truth: f64, inverse: f64) -> [f64; 4] {
    let error = estimate - truth;
    let relative = error * inverse;
    [error, error * error, error.abs(), relative * relative]
}

/// Sums side by side: as many as registers hold with what they lost. Their number is the same on every machine, and so are the bits.
const LANES: usize = 4;

/// The sums of the four [`terms`], compensated.
struct Lanes<'a> {
    estimate: &'a [f64],
    truth: &'a [f64],
    inverse: &'a [f64],
}

impl WithSimd for Lanes<'_> {
    type Output = [f64; 4];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> [f64; 4] {
        let (estimates, rest) = self.estimate.as_chunks::<LANES>();
        let (truths, rest_of_truth) = self.truth.as_chunks::<LANES>();
        let (inverses, rest_of_inverse) = self.inverse.as_chunks::<LANES>();
        let (mut totals, mut lost) = ([[0.0; LANES]; 4], [[0.0; LANES]; 4]);
        for ((estimate, truth), inverse) in estimates.iter().zip(truths).zip(inverses) {
            for i in 0..LANES {
                let terms = terms(estimate[i], truth[i], inverse[i]);
                for k in 0..4 {
                    lost[k][i] += two_sum(&mut totals[k][i], terms[k]);
                }
            }
        }
        let mut sums = [Sum::default(); 4];
        for (k, sum) in sums.iter_mut().enumerate() {
            for i in 0..LANES {
                sum.add(totals[k][i]);
                sum.add(lost[k][i]);
            }
        }
        let rest = rest.iter().zip(rest_of_truth).zip(rest_of_inverse);
        for ((&estimate, &truth), &inverse) in rest {
            for (sum, term) in sums.iter_mut().zip(terms(estimate, truth, inverse)) {
                sum.add(term);
            }
        }
        sums.map(Sum::value)
    }
}

#[cfg(test)]
mod tests {
    use super::{Errors, RELATIVE_FLOOR, Yardstick};
    use crate::numeric::Sum;

    /// A stand-in with exact answers: truth + c.
    #[test]
    fn a_constant_offset_has_known_errors() {
        let truth = vec![2.0; 100];
        let estimate = vec![2.5; 100];
        let errors = Errors::between(&estimate, &truth, 0.01);
        assert!((errors.ise - 0.25).abs() < 1e-14);
        assert!((errors.iae - 0.5).abs() < 1e-14);
        assert!((errors.ire - 0.0625).abs() < 1e-14);
        assert!((errors.bias - 0.5).abs() < 1e-14);
        let some = Yardstick::new(truth).errors_over(10..30, &estimate, 0.01);
        assert!((some.ise - 0.05).abs() < 1e-14 && (some.bias - 0.5).abs() < 1e-14);
    }

    #[test]
    fn tails_below_the_floor_do_not_enter_the_relative_error() {
        let errors = Errors::between(&[1.0, 1.0], &[1.0, 1e-9], 1.0);
        assert!(errors.ire.abs() < 1e-14 && errors.ise > 0.99);
    }

    /// By the definition, term by term.
    #[test]
    fn side_by_side_they_are_what_they_are_one_by_one() {
        for cells in [0, 1, 7, 8, 9, 64, 515] {
            let truth: Vec<f64> = (0..cells)
                .map(|i| (f64::from(i) * 0.37).sin().abs())
                .collect();
            let estimate: Vec<f64> = (0..cells)
                .map(|i| (f64::from(i) * 0.37 + 0.1).sin().abs() + 1e9 * f64::from(i % 2))
                .collect();
            let peak = truth.iter().copied().fold(0.0, f64::max);
            let pairs = || estimate.iter().zip(&truth);
            let sum = |term: &dyn Fn(f64, f64) -> f64| -> f64 {
                pairs().map(|(e, f)| term(*e, *f)).collect::<Sum>().value() * 0.5
            };
            let relative = |e: f64, f: f64| {
                if f >= RELATIVE_FLOOR * peak && f > 0.0 {
                    ((e - f) / f).powi(2)
                } else {
                    0.0
                }
            };
            let found = Errors::between(&estimate, &truth, 0.5);
            let close = |a: f64, b: f64| (a - b).abs() <= 2e-15 * b.abs();
            assert!(close(found.ise, sum(&|e, f| (e - f).powi(2))), "{cells}");
            assert!(close(found.iae, sum(&|e, f| (e - f).abs())), "{cells}");
            assert!(close(found.ire, sum(&relative)), "{cells}");
            let mean = sum(&|e, f| e - f) / 0.5 / f64::from(cells.max(1));
            assert!(close(found.bias, mean), "{cells}");
        }
    }
}
