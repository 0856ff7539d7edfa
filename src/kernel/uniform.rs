//! The box of the naive estimator; jumps at its ends, where it still has its full value.

use super::{Form, Kernel, polynomial_partial_moment};

/// K(u) = ½ on |u| ≤ 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Uniform;

const COEFFICIENTS: &[f64] = &[0.5];

impl Kernel for Uniform {
    #[inline]
    fn value(self, u: f64) -> f64 {
        if u.abs() <= 1.0 { 0.5 } else { 0.0 }
    }

    #[inline]
    fn of_square(self, square: f64) -> f64 {
        if square <= 1.0 { 0.5 } else { 0.0 }
    }

    fn reach(self) -> f64 {
        1.0
    }

    fn roughness(self) -> f64 {
        0.5
    }

    fn variance(self) -> f64 {
        1.0 / 3.0
    }

    fn partial_moment(self, order: u32, below: f64) -> f64 {
        polynomial_partial_moment(COEFFICIENTS, order, below)
    }

    fn form(self) -> Form {
        Form::Polynomial(COEFFICIENTS)
    }
}
