//! The uniform density: flat, with a wall at each end.

use super::{Builder, Density, Entry, Univariate};
use crate::parameter::{Absent, BuildError, Kind, Parameter, Values};
use crate::random::{Stream, open_unit};
use crate::space::{Domain, DomainError, Field, Point};
use std::sync::Arc;

/// f = 1/(b - a) on \[a, b\].
#[derive(Clone, Debug, PartialEq)]
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
    pub fn new(low: f64, high: f64) -> Result<Self, DomainError> {
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
    /// One random word a draw.
    fn draw(&self, random: &mut Stream) -> Point<1> {
        [self.quantile(open_unit(random))]
    }

    fn probability(&self, [low]: Point<1>, [high]: Point<1>) -> f64 {
        (high.clamp(self.low, self.high) - low.clamp(self.low, self.high)) / self.length()
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

    fn level(&self) -> Option<f64> {
        Some(1.0 / self.length())
    }

    fn univariate(&self) -> Option<&dyn Univariate> {
        Some(self)
    }
}

impl Univariate for Uniform {
    fn distribution(&self, x: f64) -> f64 {
        ((x - self.low) / self.length()).clamp(0.0, 1.0)
    }

    fn quantile(&self, p: f64) -> f64 {
        if !(0.0..=1.0).contains(&p) {
            return f64::NAN;
        }
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
            0.5 * self.low + 0.5 * self.high,
            self.length() / 12.0_f64.sqrt(),
        )
    }
}

pub(super) const ENTRIES: &[Entry] = &[Entry {
    names: &["uniform"],
    summary: "flat, with a wall at each end",
    reference: "Silverman 1986, section 2.10 (bounded domains)",
    parameters: &[
        Parameter::optional("low", Kind::Real, Absent::Number(0.0), "where it begins"),
        Parameter::optional("high", Kind::Real, Absent::Number(1.0), "where it ends"),
    ],
    build: Builder::Line(build),
}];

fn build(values: &Values) -> Result<Arc<dyn Univariate>, BuildError> {
    let (low, high) = (
        values.number("low").unwrap_or(0.0),
        values.number("high").unwrap_or(1.0),
    );
    match Uniform::new(low, high) {
        Ok(uniform) if uniform.length().is_finite() && uniform.length() > 1e-300 => {
            Ok(Arc::new(uniform))
        }
        _ => Err(BuildError {
            parameter: "high",
            what: format!(
                "the uniform density needs low < high, with a length that is a normal number; got {low} and {high}"
            ),
        }),
    }
}
