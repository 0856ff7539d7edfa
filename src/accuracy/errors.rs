//! Errors of one estimate.

use crate::numeric::Sum;
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
        Self::over(0..truth.len(), estimate, truth, cell)
    }

    /// The errors over some of the cells; where the truth is small is told by all of them.
    pub fn over(
        cells: impl Iterator<Item = usize>,
        estimate: &[f64],
        truth: &[f64],
        cell: f64,
    ) -> Self {
        let floor = RELATIVE_FLOOR * truth.iter().copied().fold(0.0, f64::max);
        let (mut ise, mut iae, mut ire) = (Sum::default(), Sum::default(), Sum::default());
        let (mut signed, mut many) = (Sum::default(), 0.0);
        for i in cells {
            let (estimate, truth) = (estimate[i], truth[i]);
            let error = estimate - truth;
            signed.add(error);
            many += 1.0;
            ise.add(error * error);
            iae.add(error.abs());
            if truth >= floor && truth > 0.0 {
                ire.add((error / truth).powi(2));
            }
        }
        Self {
            ise: ise.value() * cell,
            iae: iae.value() * cell,
            ire: ire.value() * cell,
            bias: if many > 0.0 {
                signed.value() / many
            } else {
                0.0
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Errors;

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
        let some = Errors::over(10..30, &estimate, &truth, 0.01);
        assert!((some.ise - 0.05).abs() < 1e-14 && (some.bias - 0.5).abs() < 1e-14);
    }

    #[test]
    fn tails_below_the_floor_do_not_enter_the_relative_error() {
        let errors = Errors::between(&[1.0, 1.0], &[1.0, 1e-9], 1.0);
        assert!(errors.ire.abs() < 1e-14 && errors.ise > 0.99);
    }
}
