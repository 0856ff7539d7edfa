//! The quartic kernel: nearly as efficient as the best one, with a continuous slope.

use super::{Form, Kernel, polynomial_partial_moment};

/// K(u) = 15/16 (1 - u²)² on |u| ≤ 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Biweight;

const COEFFICIENTS: &[f64] = &[15.0 / 16.0, 0.0, -30.0 / 16.0, 0.0, 15.0 / 16.0];

impl Kernel for Biweight {
    #[inline]
    fn value(self, u: f64) -> f64 {
        let rest = 1.0 - u * u;
        if rest > 0.0 {
            15.0 / 16.0 * rest * rest
        } else {
            0.0
        }
    }

    #[inline]
    fn of_square(self, square: f64) -> f64 {
        let rest = 1.0 - square;
        if rest > 0.0 {
            15.0 / 16.0 * rest * rest
        } else {
            0.0
        }
    }

    fn reach(self) -> f64 {
        1.0
    }

    fn roughness(self) -> f64 {
        5.0 / 7.0
    }

    fn variance(self) -> f64 {
        1.0 / 7.0
    }

    fn partial_moment(self, order: u32, below: f64) -> f64 {
        polynomial_partial_moment(COEFFICIENTS, order, below)
    }

    fn form(self) -> Form {
        Form::Polynomial(COEFFICIENTS)
    }
}
