//! The normal density: never zero, infinitely smooth, and the kernel for which exact errors have closed forms.

use super::{Form, Kernel};
use crate::numeric::special::{normal_density, normal_distribution};
use std::f64::consts::PI;

/// K(u) = φ(u) = exp(-u²/2) / √(2π).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gaussian;

impl Kernel for Gaussian {
    #[inline]
    fn value(self, u: f64) -> f64 {
        normal_density(u)
    }

    #[inline]
    fn of_square(self, square: f64) -> f64 {
        self.value(square.sqrt())
    }

    fn reach(self) -> f64 {
        // exp(-u²/2) is below the smallest subnormal number from here on
        38.604
    }

    fn roughness(self) -> f64 {
        0.5 / PI.sqrt()
    }

    fn variance(self) -> f64 {
        1.0
    }

    fn partial_moment(self, order: u32, below: f64) -> f64 {
        match order {
            0 => normal_distribution(below),
            1 => -normal_density(below),
            2 => {
                normal_distribution(below)
                    - if below.is_finite() {
                        below * normal_density(below)
                    } else {
                        0.0
                    }
            }
            _ => panic!("partial moments are defined for orders 0, 1 and 2"),
        }
    }

    fn form(self) -> Form {
        Form::Gaussian
    }
}
