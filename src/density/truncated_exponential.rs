//! The exponential density cut off at 1: two walls, neither of them flat.

use super::{Builder, Density, Entry, Univariate};
use crate::parameter::{Absent, BuildError, Kind, Parameter, Values};
use crate::random::{Stream, open_unit};
use crate::space::{Domain, Field, Point};
use std::sync::Arc;

/// f = λ exp(-λx) / (1 - exp(-λ)) on \[0, 1\].
#[derive(Clone, Debug, PartialEq)]
pub struct TruncatedExponential {
    rate: f64,
    domain: Domain<1>,
}

impl TruncatedExponential {
    /// The truncated exponential density of that rate λ; `None` unless it is from 1e-10 to 700, where it is neither flat to rounding
    /// nor a spike.
    pub fn new(rate: f64) -> Option<Self> {
        (1e-10..=700.0).contains(&rate).then(|| Self {
            rate,
            domain: Domain::unit(),
        })
    }

    /// 1 - exp(-λ), the mass that the endless density has on \[0, 1\].
    fn kept(&self) -> f64 {
        -(-self.rate).exp_m1()
    }
}

impl Field<1> for TruncatedExponential {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        if self.domain.contains([x]) {
            self.rate * (-self.rate * x).exp() / self.kept()
        } else {
            0.0
        }
    }
}

impl Density<1> for TruncatedExponential {
    /// One random word a draw.
    fn draw(&self, random: &mut Stream) -> Point<1> {
        [self.quantile(open_unit(random))]
    }

    fn probability(&self, [low]: Point<1>, [high]: Point<1>) -> f64 {
        let (a, b) = (low.clamp(0.0, 1.0), high.clamp(0.0, 1.0));
        (-self.rate * a).exp() * -(-self.rate * (b - a)).exp_m1() / self.kept()
    }

    fn breaks(&self, _axis: usize) -> Vec<f64> {
        vec![0.0, 1.0]
    }

    fn finest_scale(&self, _axis: usize) -> f64 {
        self.rate.max(1.0).recip()
    }

    fn bulk(&self, _tail: f64) -> (Point<1>, Point<1>) {
        ([0.0], [1.0])
    }

    fn univariate(&self) -> Option<&dyn Univariate> {
        Some(self)
    }
}

impl Univariate for TruncatedExponential {
    fn distribution(&self, x: f64) -> f64 {
        -(-self.rate * x.clamp(0.0, 1.0)).exp_m1() / self.kept()
    }

    fn quantile(&self, p: f64) -> f64 {
        if !(0.0..=1.0).contains(&p) {
            return f64::NAN;
        }
        let inside = if p <= 0.5 {
            -(-p * self.kept()).ln_1p() / self.rate
        } else {
            // from the far end, where the form above cancels for steep densities
            1.0 - ((1.0 - p) * self.rate.exp_m1()).ln_1p() / self.rate
        };
        inside.clamp(0.0, 1.0)
    }

    fn derivative(&self, order: u32, x: f64) -> f64 {
        (-self.rate).powi(order as i32) * self.at([x])
    }

    fn roughness(&self, order: u32) -> f64 {
        if order == 0 {
            0.5 * self.rate / (0.5 * self.rate).tanh()
        } else {
            f64::INFINITY
        }
    }

    fn mean_and_deviation(&self) -> (f64, f64) {
        let r = self.rate;
        let (mean, variance) = if r < 0.1 {
            // the series about the uniform density, where the closed forms cancel
            let s = r * r;
            (
                0.5 - r * (1.0 / 12.0 - s * (1.0 / 720.0 - s * (1.0 / 30_240.0 - s / 1_209_600.0))),
                1.0 / 12.0 - s * (1.0 / 240.0 - s * (1.0 / 6048.0 - s / 172_800.0)),
            )
        } else {
            (
                1.0 / r - 1.0 / r.exp_m1(),
                1.0 / (r * r) - 0.25 / (0.5 * r).sinh().powi(2),
            )
        };
        (mean, variance.sqrt())
    }
}

pub(super) const ENTRIES: &[Entry] = &[Entry {
    names: &["truncated-exponential"],
    summary: "decay from a wall at 0, cut off by a wall at 1",
    reference: "Jones 1993, Simple boundary correction, Statistics and Computing 3",
    parameters: &[Parameter::optional(
        "rate",
        Kind::Positive,
        Absent::Number(1.0),
        "λ of exp(-λx)",
    )],
    build: Builder::Line(build),
}];

fn build(values: &Values) -> Result<Arc<dyn Univariate>, BuildError> {
    let rate = values.number("rate").unwrap_or(1.0);
    match TruncatedExponential::new(rate) {
        Some(density) => Ok(Arc::new(density)),
        None => Err(BuildError {
            parameter: "rate",
            what: format!(
                "the rate of the truncated exponential density must be from 1e-10 to 700, not {rate}"
            ),
        }),
    }
}
