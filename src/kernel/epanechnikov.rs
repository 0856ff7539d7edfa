//! The kernel of least AMISE.

use super::{Form, Kernel, polynomial_partial_moment};

/// K(u) = ¾ (1 - u²) on |u| ≤ 1. [Epanechnikov 1969]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Epanechnikov;

const COEFFICIENTS: &[f64] = &[0.75, 0.0, -0.75];

impl Kernel for Epanechnikov {
    #[inline]
    fn value(self, u: f64) -> f64 {
        let rest = 1.0 - u * u;
        if rest > 0.0 { 0.75 * rest } else { 0.0 }
    }

    #[inline]
    fn of_square(self, square: f64) -> f64 {
        let rest = 1.0 - square;
        if rest > 0.0 { 0.75 * rest } else { 0.0 }
    }

    fn reach(self) -> f64 {
        1.0
    }

    fn roughness(self) -> f64 {
        0.6
    }

    fn variance(self) -> f64 {
        0.2
    }

    fn partial_moment(self, order: u32, below: f64) -> f64 {
        polynomial_partial_moment(COEFFICIENTS, order, below)
    }

    fn form(self) -> Form {
        Form::Polynomial(COEFFICIENTS)
    }
}
