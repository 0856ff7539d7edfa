//! The sextic kernel: two continuous derivatives.

use super::{Form, Kernel, polynomial_partial_moment};

/// K(u) = 35/32 (1 - u²)³ on |u| ≤ 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triweight;

const COEFFICIENTS: &[f64] = &[
    35.0 / 32.0,
    0.0,
    -105.0 / 32.0,
    0.0,
    105.0 / 32.0,
    0.0,
    -35.0 / 32.0,
];

impl Kernel for Triweight {
    #[inline]
    fn value(self, u: f64) -> f64 {
        let rest = 1.0 - u * u;
        if rest > 0.0 {
            35.0 / 32.0 * rest * rest * rest
        } else {
            0.0
        }
    }

    #[inline]
    fn of_square(self, square: f64) -> f64 {
        let rest = 1.0 - square;
        if rest > 0.0 {
            35.0 / 32.0 * rest * rest * rest
        } else {
            0.0
        }
    }

    fn reach(self) -> f64 {
        1.0
    }

    fn roughness(self) -> f64 {
        350.0 / 429.0
    }

    fn variance(self) -> f64 {
        1.0 / 9.0
    }

    fn partial_moment(self, order: u32, below: f64) -> f64 {
        polynomial_partial_moment(COEFFICIENTS, order, below)
    }

    fn form(self) -> Form {
        Form::Polynomial(COEFFICIENTS)
    }
}
