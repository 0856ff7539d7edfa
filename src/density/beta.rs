//! The beta density: walls that it leaves with a jump, a kink, or any smoother power.

use super::{Builder, Density, Entry, Univariate};
use crate::numeric::root;
use crate::parameter::{Absent, BuildError, Kind, Parameter, Values};
use crate::random::Stream;
use crate::space::{Domain, Field, Point};
use rand_distr::Distribution;
use statrs::function::beta::beta_reg;
use std::sync::Arc;

/// f = xᵃ⁻¹ (1 - x)ᵇ⁻¹ / B(a, b) on \[0, 1\], for 1 ≤ a, b ≤ 1000: bounded, so that its squared errors are finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Beta {
    a: f64,
    b: f64,
    /// ln B(a, b)
    logarithm: f64,
    sampler: rand_distr::Beta<f64>,
    domain: Domain<1>,
}

impl Beta {
    /// The beta density with those two shapes; `None` unless both are from 1 to 1000.
    pub fn new(a: f64, b: f64) -> Option<Self> {
        let legal = (1.0..=1000.0).contains(&a) && (1.0..=1000.0).contains(&b);
        let sampler = legal.then(|| rand_distr::Beta::new(a, b).ok()).flatten()?;
        Some(Self {
            a,
            b,
            logarithm: logarithm_of_beta(a, b),
            sampler,
            domain: Domain::unit(),
        })
    }

    /// xᵖ (1 - x)ᵠ / B(a, b).
    fn powers(&self, x: f64, p: f64, q: f64) -> f64 {
        // a zero power of zero is 1 here, as in `powf`, but not in the logarithm
        let part = |power: f64, log: f64| if power == 0.0 { 0.0 } else { power * log };
        (part(p, x.ln()) + part(q, (-x).ln_1p()) - self.logarithm).exp()
    }

    /// The lower quantile, p ≤ 1/2, by bisection.
    fn lower_quantile(a: f64, b: f64, p: f64) -> f64 {
        if p <= 0.0 {
            return 0.0;
        }
        root(|x| beta_reg(a, b, x) - p, 0.0, 1.0).unwrap_or(0.0)
    }
}

/// ln B(a, b).
fn logarithm_of_beta(a: f64, b: f64) -> f64 {
    libm::lgamma(a) + libm::lgamma(b) - libm::lgamma(a + b)
}

impl Field<1> for Beta {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        if self.domain.contains([x]) {
            self.powers(x, self.a - 1.0, self.b - 1.0)
        } else {
            0.0
        }
    }
}

impl Density<1> for Beta {
    /// Two or more random words a draw, by Cheng's rejection (`rand_distr`), which is far cheaper than inverting; on average below four.
    fn draw(&self, random: &mut Stream) -> Point<1> {
        [self.sampler.sample(random)]
    }

    fn probability(&self, [low]: Point<1>, [high]: Point<1>) -> f64 {
        let (l, h) = (low.clamp(0.0, 1.0), high.clamp(0.0, 1.0));
        if l > self.a / (self.a + self.b) {
            beta_reg(self.b, self.a, 1.0 - l) - beta_reg(self.b, self.a, 1.0 - h)
        } else {
            beta_reg(self.a, self.b, h) - beta_reg(self.a, self.b, l)
        }
    }

    fn breaks(&self, _axis: usize) -> Vec<f64> {
        // x^1.5 has no third derivative at 0: panels that shrink towards the wall restore the accuracy of the quadratures
        let ladder = |shape: f64| {
            let broken = shape.fract() != 0.0 && shape < 16.0;
            let steps = if broken {
                (28.0 / shape).ceil() as i32
            } else {
                0
            };
            (1..=steps).map(|i| 0.25_f64.powi(i))
        };
        let mut cuts = vec![0.0, 1.0];
        cuts.extend(ladder(self.a));
        cuts.extend(ladder(self.b).map(|from_the_end| 1.0 - from_the_end));
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        cuts
    }

    fn finest_scale(&self, _axis: usize) -> f64 {
        (2.0 * self.mean_and_deviation().1).min(1.0)
    }

    fn bulk(&self, tail: f64) -> (Point<1>, Point<1>) {
        let tail = tail.clamp(1e-300, 0.5);
        (
            [Self::lower_quantile(self.a, self.b, tail)],
            // rounding near 1 must not cut into the bulk
            [(1.0 - Self::lower_quantile(self.b, self.a, tail))
                .next_up()
                .min(1.0)],
        )
    }

    fn level(&self) -> Option<f64> {
        ((self.a - 1.0).abs() < f64::EPSILON && (self.b - 1.0).abs() < f64::EPSILON).then_some(1.0)
    }

    fn univariate(&self) -> Option<&dyn Univariate> {
        Some(self)
    }
}

impl Univariate for Beta {
    fn distribution(&self, x: f64) -> f64 {
        beta_reg(self.a, self.b, x.clamp(0.0, 1.0))
    }

    /// By bisection in the nearer tail: some 60 evaluations.
    fn quantile(&self, p: f64) -> f64 {
        if !(0.0..=1.0).contains(&p) {
            f64::NAN
        } else if p <= 0.5 {
            Self::lower_quantile(self.a, self.b, p)
        } else {
            1.0 - Self::lower_quantile(self.b, self.a, 1.0 - p)
        }
    }

    fn derivative(&self, order: u32, x: f64) -> f64 {
        if !self.domain.contains([x]) {
            return 0.0;
        }
        let (p, q) = (self.a - 1.0, self.b - 1.0);
        let term = |factor: f64, down_x: f64, down_y: f64| {
            if factor == 0.0 {
                0.0
            } else {
                factor * self.powers(x, p - down_x, q - down_y)
            }
        };
        match order {
            0 => self.at([x]),
            1 => term(p, 1.0, 0.0) - term(q, 0.0, 1.0),
            _ => {
                term(p * (p - 1.0), 2.0, 0.0) - term(2.0 * p * q, 1.0, 1.0)
                    + term(q * (q - 1.0), 0.0, 2.0)
            }
        }
    }

    /// f² is proportional to a beta density of shapes P = 2a - 1, Q = 2b - 1, and (f⁽ʳ⁾/f)² a polynomial in 1/x and 1/(1 - x), whose
    /// expectations under it are quotients of Gamma functions, that is products.
    fn roughness(&self, order: u32) -> f64 {
        let (p, q) = (self.a - 1.0, self.b - 1.0);
        let (big_p, big_q) = (2.0 * self.a - 1.0, 2.0 * self.b - 1.0);
        let expectation = |i: i32, j: i32| {
            let product = |from: f64, factors: i32| -> f64 {
                (1..=factors).map(|k| from - f64::from(k)).product()
            };
            product(big_p + big_q, i + j) / (product(big_p, i) * product(big_q, j))
        };
        let square = (logarithm_of_beta(big_p, big_q) - 2.0 * self.logarithm).exp();
        let least = self.a.min(self.b);
        match order {
            0 => square,
            // a jump at a = 1; x^(2a - 4) not integrable for a ≤ 3/2
            1 if least > 1.5 => {
                square
                    * (p * p * expectation(2, 0) - 2.0 * p * q * expectation(1, 1)
                        + q * q * expectation(0, 2))
            }
            // a kink at a = 2; x^(2a - 6) not integrable for a ≤ 5/2
            2 if least > 2.5 => {
                let (u, v, w) = (p * (p - 1.0), -2.0 * p * q, q * (q - 1.0));
                square
                    * (u * u * expectation(4, 0)
                        + 2.0 * u * v * expectation(3, 1)
                        + (v * v + 2.0 * u * w) * expectation(2, 2)
                        + 2.0 * v * w * expectation(1, 3)
                        + w * w * expectation(0, 4))
            }
            _ => f64::INFINITY,
        }
    }

    fn mean_and_deviation(&self) -> (f64, f64) {
        let sum = self.a + self.b;
        (self.a / sum, (self.a * self.b / (sum + 1.0)).sqrt() / sum)
    }
}

pub(super) const ENTRIES: &[Entry] = &[Entry {
    names: &["beta"],
    summary: "any bounded power of the distance from each of two walls",
    reference: "Johnson, Kotz & Balakrishnan 1995, chapter 25",
    parameters: &[
        Parameter::optional(
            "a",
            Kind::Positive,
            Absent::Number(2.0),
            "the shape at 0: f falls like x^(a - 1); from 1 (a jump) to 1000",
        ),
        Parameter::optional(
            "b",
            Kind::Positive,
            Absent::Number(2.0),
            "the shape at 1: f falls like (1 - x)^(b - 1); from 1 (a jump) to 1000",
        ),
    ],
    build: Builder::Line(build),
}];

fn build(values: &Values) -> Result<Arc<dyn Univariate>, BuildError> {
    let (a, b) = (
        values.number("a").unwrap_or(2.0),
        values.number("b").unwrap_or(2.0),
    );
    match Beta::new(a, b) {
        Some(density) => Ok(Arc::new(density)),
        None => Err(BuildError {
            parameter: if (1.0..=1000.0).contains(&a) {
                "b"
            } else {
                "a"
            },
            what: format!(
                "the shapes of the beta density must be from 1 to 1000, so that it is bounded and its squared errors are finite; got {a} and {b}"
            ),
        }),
    }
}
