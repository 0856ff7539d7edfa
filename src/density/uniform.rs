//! The uniform density: flat, with a wall at each end.

use super::{Density, Univariate};
use crate::random::Stream;
use crate::space::{Domain, Field, Point};
use rand::RngExt;

/// f = 1/(b - a) on \[a, b\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uniform {
    low: f64,
    high: f64,
    domain: Domain<1>,
}

impl Uniform {
    /// The uniform density on `[low, high]`.
    ///
    /// # Errors
    /// If the interval is empty or not finite.
    pub fn new(low: f64, high: f64) -> Result<Self, crate::space::DomainError> {
        Ok(Self {
            low,
            high,
            domain: Domain::walled([low], [high])?,
        })
    }

    fn length(&self) -> f64 {
        self.high - self.low
    }
}

impl Field<1> for Uniform {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, x: Point<1>) -> f64 {
        if self.domain.contains(x) {
            1.0 / self.length()
        } else {
            0.0
        }
    }
}

impl Density<1> for Uniform {
    fn draw(&self, random: &mut Stream) -> Point<1> {
        [self.quantile(random.random::<f64>())]
    }

    fn probability(&self, [low]: Point<1>, [high]: Point<1>) -> f64 {
        self.distribution(high) - self.distribution(low)
    }

    fn breaks(&self, _axis: usize) -> Vec<f64> {
        vec![self.low, self.high]
    }

    fn finest_scale(&self, _axis: usize) -> f64 {
        self.length()
    }

    fn bulk(&self, _tail: f64) -> (Point<1>, Point<1>) {
        ([self.low], [self.high])
    }
}

impl Univariate for Uniform {
    fn distribution(&self, x: f64) -> f64 {
        ((x - self.low) / self.length()).clamp(0.0, 1.0)
    }

    fn quantile(&self, p: f64) -> f64 {
        p.mul_add(self.length(), self.low)
            .clamp(self.low, self.high)
    }

    fn derivative(&self, _order: u32, _x: f64) -> f64 {
        0.0
    }

    fn roughness(&self, order: u32) -> f64 {
        if order == 0 {
            1.0 / self.length()
        } else {
            f64::INFINITY
        }
    }

    fn mean_and_deviation(&self) -> (f64, f64) {
        (
            0.5 * (self.low + self.high),
            self.length() / 12.0_f64.sqrt(),
        )
    }
}
