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
        let errors = Errors::from_sums(sums, estimate.len() as f64, cell);
        self.held(errors, &(0..estimate.len()), estimate, cell)
    }

    /// The errors over some of the cells; where the truth is small is told by all of them.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "an iterator is a value; it is walked several times"
    )]
    pub fn errors_over(
        &self,
        cells: impl Iterator<Item = usize> + Clone,
        estimate: &[f64],
        cell: f64,
    ) -> Errors {
        let (mut sums, mut many) = ([Sum::default(); 4], 0.0);
        for i in cells.clone() {
            many += 1.0;
            let terms = terms(estimate[i], self.truth[i], self.inverse[i]);
            for (sum, term) in sums.iter_mut().zip(terms) {
                sum.add(term);
            }
        }
        let errors = Errors::from_sums(sums.map(Sum::value), many, cell);
        self.held(errors, &cells, estimate, cell)
    }

    /// `errors`, unless a square or a sum on the way to them was beyond all numbers: then the same in units of the largest error, which are infinite only where the result is.
    fn held(
        &self,
        errors: Errors,
        cells: &(impl Iterator<Item = usize> + Clone),
        estimate: &[f64],
        cell: f64,
    ) -> Errors {
        let Errors {
            ise,
            iae,
            ire,
            bias,
        } = errors;
        if [ise, iae, ire, bias].iter().all(|error| error.is_finite()) {
            return errors;
        }
        let terms = || {
            (cells.clone()).map(|i| {
                let inverse = self.inverse[i];
                let [error, _, _, _] = terms(estimate[i], self.truth[i], inverse);
                // where relative errors are not taken an infinite one is none either
                let relative = if inverse > 0.0 { error * inverse } else { 0.0 };
                (error, relative)
            })
        };
        let largest =
            |of: fn((f64, f64)) -> f64| terms().map(of).fold(0.0, |a: f64, b| a.max(b.abs()));
        let (unit, relative_unit) = (largest(|term| term.0), largest(|term| term.1));
        let part = |error: f64, unit: f64| {
            if unit == 0.0 || error.abs() >= unit {
                // infinite ones are whole units, too
                error.signum() * f64::from(u8::from(unit > 0.0))
            } else {
                error / unit
            }
        };
        let (mut sums, mut many) = ([Sum::default(); 4], 0.0);
        for (error, relative) in terms() {
            many += 1.0;
            let (error, relative) = (part(error, unit), part(relative, relative_unit));
            let parts = [error, error * error, error.abs(), relative * relative];
            sums.iter_mut()
                .zip(parts)
                .for_each(|(sum, term)| sum.add(term));
        }
        let [signed, squares, absolute, relative] = sums.map(Sum::value);
        // nothing of a unit that is infinite is nothing
        let times = |share: f64, unit: f64| if share == 0.0 { 0.0 } else { share * unit };
        Errors {
            ise: times(times(squares * cell, unit), unit),
            iae: times(absolute * cell, unit),
            ire: times(times(relative * cell, relative_unit), relative_unit),
            bias: times(signed / many, unit),
        }
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

    /// Squares beyond all numbers, of errors that are not: what can be written is, what cannot is infinite, and nothing is no number.
    #[test]
    fn huge_errors_are_huge_and_never_no_number() {
        for cells in [1, 4, 11] {
            let truth = vec![1.0; cells];
            let with = |error: f64| {
                let mut estimate = truth.clone();
                estimate[cells / 2] = error;
                estimate
            };
            let (n, yardstick) = (cells as f64, Yardstick::new(truth.clone()));
            for (error, cell, ise) in [
                (1e160, 1e-30, 1e290),
                (-1e160, 1e-30, 1e290),
                (1e160, 1.0, f64::INFINITY),
                (f64::MAX, 1.0, f64::INFINITY),
                (f64::INFINITY, 0.1, f64::INFINITY),
            ] {
                let whole = yardstick.errors(&with(error), cell);
                let some = yardstick.errors_over(0..cells, &with(error), cell);
                for found in [whole, some] {
                    let same =
                        |a: f64, b: f64| a.to_bits() == b.to_bits() || (a / b - 1.0).abs() < 1e-12;
                    assert!(same(found.ise, ise) && same(found.ire, ise), "{found:?}");
                    assert!(same(found.iae, error.abs() * cell), "{found:?}");
                    assert!(same(found.bias, error / n), "{found:?}");
                }
            }
            // both ways at once
            let wild: Vec<f64> = (0..cells).map(|i| [-1e308, 1e308][i % 2]).collect();
            let found = yardstick.errors(&wild, 1e-300);
            assert!(!found.bias.is_nan() && found.ise.is_infinite(), "{found:?}");
            assert!(found.iae > 0.9e8 && found.iae.is_finite(), "{found:?}");
        }
    }

    #[test]
    fn tails_below_the_floor_do_not_enter_the_relative_error() {
        let yardstick = Yardstick::new(vec![1.0, 1e-9]);
        for found in [
            yardstick.errors(&[1.01, f64::INFINITY], 1.0),
            yardstick.errors_over(0..2, &[1.01, f64::INFINITY], 1.0),
        ] {
            assert!((found.ire - 1e-4).abs() < 1e-14, "{found:?}");
            assert!(
                found.ise.is_infinite() && found.iae.is_infinite(),
                "{found:?}"
            );
        }
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
