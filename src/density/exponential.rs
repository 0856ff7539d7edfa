//! The exponential density: steepest at its wall.

use super::{Builder, Density, Entry, Univariate};
use crate::parameter::{Absent, BuildError, Kind, Parameter, Values};
use crate::random::{Stream, open_unit};
use crate::space::{Domain, Field, Point};
use std::sync::Arc;

/// f = λ exp(-λx) on x ≥ 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Exponential {
    rate: f64,
    domain: Domain<1>,
}

impl Exponential {
    /// The exponential density of that rate λ; `None` unless it is from 1e-100 to 1e100.
    pub fn new(rate: f64) -> Option<Self> {
        (1e-100..=1e100).contains(&rate).then(|| Self {
            rate,
            domain: Domain::non_negative(),
        })
    }
}

impl Field<1> for Exponential {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        if x >= 0.0 {
            self.rate * (-self.rate * x).exp()
        } else {
            0.0
        }
    }
}

impl Density<1> for Exponential {
    /// One random word a draw.
    fn draw(&self, random: &mut Stream) -> Point<1> {
        [self.quantile(open_unit(random))]
    }

    fn probability(&self, [low]: Point<1>, [high]: Point<1>) -> f64 {
        let (a, b) = (low.max(0.0), high.max(0.0));
        if a.is_infinite() {
            return 0.0;
        }
        (-self.rate * a).exp() * -(-self.rate * (b - a)).exp_m1()
    }

    fn breaks(&self, _axis: usize) -> Vec<f64> {
        vec![0.0]
    }

    fn finest_scale(&self, _axis: usize) -> f64 {
        1.0 / self.rate
    }

    fn bulk(&self, tail: f64) -> (Point<1>, Point<1>) {
        ([0.0], [-tail.clamp(1e-300, 0.5).ln() / self.rate])
    }

    fn univariate(&self) -> Option<&dyn Univariate> {
        Some(self)
    }
}

impl Univariate for Exponential {
    fn distribution(&self, x: f64) -> f64 {
        -(-self.rate * x.max(0.0)).exp_m1()
    }

    fn quantile(&self, p: f64) -> f64 {
        if !(0.0..=1.0).contains(&p) {
            return f64::NAN;
        }
        -(-p).ln_1p() / self.rate
    }

    fn derivative(&self, order: u32, x: f64) -> f64 {
        (-self.rate).powi(order as i32) * self.at([x])
    }

    fn roughness(&self, order: u32) -> f64 {
        if order == 0 {
            0.5 * self.rate
        } else {
            f64::INFINITY
        }
    }

    fn mean_and_deviation(&self) -> (f64, f64) {
        (1.0 / self.rate, 1.0 / self.rate)
    }
}

pub(super) const ENTRIES: &[Entry] = &[Entry {
    names: &["exponential"],
    summary: "decay from a wall, without end",
    reference: "Silverman 1986, section 2.10 (bounded domains)",
    parameters: &[Parameter::optional(
        "rate",
        Kind::Positive,
        Absent::Number(1.0),
        "λ of exp(-λx): one over the mean",
    )],
    build: Builder::Line(build),
}];

fn build(values: &Values) -> Result<Arc<dyn Univariate>, BuildError> {
    let rate = values.number("rate").unwrap_or(1.0);
    match Exponential::new(rate) {
        Some(density) => Ok(Arc::new(density)),
        None => Err(BuildError {
            parameter: "rate",
            what: format!(
                "the rate of the exponential density must be from 1e-100 to 1e100, not {rate}"
            ),
        }),
    }
}
