//! The right half of a normal density: flat at its wall, so that only the jump is the matter.

use super::{Builder, Density, Entry, Univariate};
use crate::numeric::special::{
    normal_density, normal_density_derivative, normal_probability, normal_quantile,
};
use crate::parameter::{Absent, BuildError, Kind, Parameter, Values};
use crate::random::{Stream, open_unit};
use crate::space::{Domain, Field, Point};
use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};
use std::sync::Arc;

/// f = 2 φ(x/σ) / σ on x ≥ 0.
#[derive(Clone, Debug, PartialEq)]
pub struct HalfNormal {
    scale: f64,
    domain: Domain<1>,
}

impl HalfNormal {
    /// Half of the normal density whose deviation is `scale`; `None` unless it is from 1e-100 to 1e100.
    pub fn new(scale: f64) -> Option<Self> {
        (1e-100..=1e100).contains(&scale).then(|| Self {
            scale,
            domain: Domain::non_negative(),
        })
    }
}

impl Field<1> for HalfNormal {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        if x >= 0.0 {
            2.0 * normal_density(x / self.scale) / self.scale
        } else {
            0.0
        }
    }
}

impl Density<1> for HalfNormal {
    /// One random word a draw.
    fn draw(&self, random: &mut Stream) -> Point<1> {
        [self.quantile(open_unit(random))]
    }

    fn probability(&self, [low]: Point<1>, [high]: Point<1>) -> f64 {
        let (a, b) = (low.max(0.0) / self.scale, high.max(0.0) / self.scale);
        if b < 1.0 {
            libm::erf(b * FRAC_1_SQRT_2) - libm::erf(a * FRAC_1_SQRT_2)
        } else {
            2.0 * normal_probability(a, b)
        }
    }

    fn breaks(&self, _axis: usize) -> Vec<f64> {
        vec![0.0]
    }

    fn finest_scale(&self, _axis: usize) -> f64 {
        self.scale
    }

    fn bulk(&self, tail: f64) -> (Point<1>, Point<1>) {
        let z = normal_quantile(0.5 * tail.clamp(1e-300, 0.5));
        ([0.0], [-z * self.scale])
    }

    fn univariate(&self) -> Option<&dyn Univariate> {
        Some(self)
    }
}

impl Univariate for HalfNormal {
    fn distribution(&self, x: f64) -> f64 {
        libm::erf(x.max(0.0) / self.scale * FRAC_1_SQRT_2)
    }

    fn quantile(&self, p: f64) -> f64 {
        if !(0.0..=1.0).contains(&p) {
            return f64::NAN;
        }
        self.scale
            * if p <= 0.5 {
                SQRT_2 * statrs::function::erf::erf_inv(p)
            } else {
                -normal_quantile(0.5 * (1.0 - p))
            }
    }

    fn derivative(&self, order: u32, x: f64) -> f64 {
        if x >= 0.0 {
            2.0 * normal_density_derivative(order, x / self.scale)
                / self.scale.powi(order as i32 + 1)
        } else {
            0.0
        }
    }

    fn roughness(&self, order: u32) -> f64 {
        if order == 0 {
            1.0 / (PI.sqrt() * self.scale)
        } else {
            f64::INFINITY
        }
    }

    fn mean_and_deviation(&self) -> (f64, f64) {
        (
            self.scale * (2.0 / PI).sqrt(),
            self.scale * (1.0 - 2.0 / PI).sqrt(),
        )
    }
}

pub(super) const ENTRIES: &[Entry] = &[Entry {
    names: &["half-normal"],
    summary: "the right half of a normal: flat at its wall",
    reference: "Silverman 1986, section 2.10 (bounded domains)",
    parameters: &[Parameter::optional(
        "scale",
        Kind::Positive,
        Absent::Number(1.0),
        "the deviation of the whole normal",
    )],
    build: Builder::Line(build),
}];

fn build(values: &Values) -> Result<Arc<dyn Univariate>, BuildError> {
    let scale = values.number("scale").unwrap_or(1.0);
    match HalfNormal::new(scale) {
        Some(density) => Ok(Arc::new(density)),
        None => Err(BuildError {
            parameter: "scale",
            what: format!(
                "the scale of the half-normal density must be from 1e-100 to 1e100, not {scale}"
            ),
        }),
    }
}
