//! The tent: what a histogram averaged over all its origins becomes.

use super::{Form, Kernel, polynomial_partial_moment};

/// K(u) = 1 - |u| on |u| ≤ 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangular;

const COEFFICIENTS: &[f64] = &[1.0, -1.0];

impl Kernel for Triangular {
    #[inline]
    fn value(self, u: f64) -> f64 {
        (1.0 - u.abs()).max(0.0)
    }

    #[inline]
    fn of_square(self, square: f64) -> f64 {
        self.value(square.sqrt())
    }

    fn reach(self) -> f64 {
        1.0
    }

    fn roughness(self) -> f64 {
        2.0 / 3.0
    }

    fn variance(self) -> f64 {
        1.0 / 6.0
    }

    fn partial_moment(self, order: u32, below: f64) -> f64 {
        polynomial_partial_moment(COEFFICIENTS, order, below)
    }

    fn form(self) -> Form {
        Form::Polynomial(COEFFICIENTS)
    }
}
