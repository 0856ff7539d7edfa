//! The generalised histogram: each bin holds a polynomial instead of a constant.

use super::bins::Bins;
use super::cells::{ORIGIN_Y, WIDTH_Y};
use super::{Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws, Moments};
use crate::density::Density;
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Field, Point};
use crate::theory::generalised_histogram_moments;
use std::sync::Arc;

/// An orthogonal series in each bin [origin + k·width, origin + (k + 1)·width): f̂(x) = Σⱼ (2j + 1) Pⱼ(t) Mⱼ / width for j up to the degree, with t from
/// -1 to 1 across the bin of x and Mⱼ = Σ wᵢ Pⱼ(tᵢ) over its data.
///
/// Degree 0 is the histogram, bit for bit. A higher degree sees the slope and the bend inside a bin, so that the bins may be wider; it reproduces what is a
/// polynomial of that degree in each bin without bias, may fall below zero, and still jumps at the edges.
///
/// O(n + m), as the histogram.
pub struct GeneralisedHistogram {
    width: f64,
    origin: f64,
    degree: usize,
}

/// The highest degree.
pub(super) const HIGHEST: usize = 3;

/// P₁, P₂ and P₃.
pub(super) fn legendre(t: f64) -> [f64; HIGHEST] {
    let square = t * t;
    [t, 1.5 * square - 0.5, t * (2.5 * square - 1.5)]
}

struct Fitted {
    bins: Bins,
    /// M₁, M₂ and M₃ of each bin that is kept; empty for degree 0.
    moments: Vec<[f64; HIGHEST]>,
    degree: usize,
    width: f64,
    origin: f64,
    domain: Domain<1>,
}

impl Fitted {
    /// From -1 to 1 across bin `number`, without the rounding of an edge far from zero.
    fn across(origin: f64, width: f64, number: f64, x: f64) -> f64 {
        (2.0 * ((x - origin) / width - number) - 1.0).clamp(-1.0, 1.0)
    }

    fn of(sample: &Sample<1>, width: f64, origin: f64, degree: usize) -> Result<Self, FitError> {
        let bins = Bins::of(sample, origin, width)?;
        let mut moments = vec![[0.0; HIGHEST]; if degree > 0 { bins.len() } else { 0 }];
        if degree > 0 {
            for (i, &x) in sample.coordinates().iter().enumerate() {
                let (weight, number) = (sample.weight(i), bins.number(x));
                if weight > 0.0
                    && let Some(index) = bins.index(number)
                {
                    let rows = legendre(Self::across(origin, width, number, x));
                    for (moment, value) in moments[index].iter_mut().zip(rows) {
                        *moment += weight * value;
                    }
                }
            }
        }
        Ok(Self {
            bins,
            moments,
            degree,
            width,
            origin,
            domain: sample.domain().clone(),
        })
    }
}

impl Field<1> for Fitted {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        let number = self.bins.number(x);
        let mut sum = self.bins.mass(number);
        if self.degree > 0
            && let Some(index) = self.bins.index(number)
        {
            let rows = legendre(Self::across(self.origin, self.width, number, x));
            for j in 0..self.degree {
                sum += (2.0 * j as f64 + 3.0) * rows[j] * self.moments[index][j];
            }
        }
        sum / self.width
    }
}

impl Estimator<1> for GeneralisedHistogram {
    fn laws(&self) -> Laws {
        Laws {
            mass_conserving: true,
            non_negative: self.degree == 0,
            linear: true,
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: false,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: true,
        }
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let of = |sample: &Sample<1>| Fitted::of(sample, self.width, self.origin, self.degree);
        let total = of(sample)?;
        let warnings = total.bins.warnings();
        let channels = (0..sample.channels())
            .map(|c| Ok(Arc::new(of(&sample.channel(c))?) as Arc<dyn Field<1>>))
            .collect::<Result<_, FitError>>()?;
        let mut estimate = Estimate::new(Arc::new(total)).with_channels(channels);
        estimate.smoothing = Some(self.width);
        estimate.warnings = warnings;
        Ok(estimate)
    }

    fn expectation(
        &self,
        truth: &dyn Density<1>,
        draws: usize,
        places: &[Point<1>],
    ) -> Option<Vec<Moments>> {
        let at = |&[x]: &Point<1>| {
            generalised_histogram_moments(
                truth,
                self.width,
                self.origin,
                self.degree,
                draws as f64,
                x,
            )
        };
        Some(places.iter().map(at).collect())
    }
}

impl Described for GeneralisedHistogram {
    const NAME: &'static str = "generalised-histogram";
    const SUMMARY: &'static str = "a histogram with a polynomial in each bin instead of a constant";
    const COST: &'static str = "O(n + m)";
    const REFERENCE: &'static str =
        "Čencov 1962; Silverman 1986, section 2.7, with a basis on each bin";
    const SMOOTHING: Option<&'static str> = Some("width");
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::required(
            "width",
            Kind::Positive,
            "the width of a bin, in the unit of the data",
        )
        .length()
        .swept(),
        Parameter::optional(
            "degree",
            Kind::Count {
                least: 0,
                most: HIGHEST as u64,
            },
            Absent::Number(1.0),
            "the degree of the polynomial in a bin: 0 constant (a histogram), 1 linear, 2, 3 cubic",
        ),
        Parameter::optional(
            "origin",
            Kind::Real,
            Absent::Number(0.0),
            "an edge of a bin, in the unit of the data",
        )
        .place(),
        WIDTH_Y,
        ORIGIN_Y,
    ];
}

impl Build<1> for GeneralisedHistogram {
    fn build(values: &Values, _context: &Context<1>) -> Result<Self, BuildError> {
        Ok(Self {
            width: values.number("width").unwrap_or(1.0),
            origin: values.number("origin").unwrap_or(0.0),
            degree: values.count("degree").unwrap_or(1) as usize,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Histogram;
    use super::*;
    use crate::numeric::GaussLegendre;
    use crate::parameter::Value;

    fn sample() -> Sample<1> {
        let points = (0..300).map(|i| [(f64::from(i) * 0.618).fract() * 3.0 - 1.0]);
        let weights = (0..300).map(|i| f64::from(i % 4)).collect();
        Sample::normalised(points.collect(), weights, Domain::whole()).expect("legal")
    }

    fn fitted(degree: u64, sample: &Sample<1>) -> Estimate<1> {
        let estimator = GeneralisedHistogram {
            width: 0.37,
            origin: 0.11,
            degree: degree as usize,
        };
        estimator.fit(sample).expect("estimable")
    }

    #[test]
    fn degree_zero_is_the_histogram_bit_for_bit() {
        let mut values = Values::defaults(Histogram::PARAMETERS);
        values.set("width", Value::Number(0.37));
        values.set("origin", Value::Number(0.11));
        let context = Context {
            truth: None,
            draws: 300,
        };
        let histogram = Histogram::build(&values, &context).expect("legal");
        let histogram = histogram.fit(&sample()).expect("estimable");
        let general = fitted(0, &sample());
        for i in 0..1000 {
            let x = [f64::from(i).mul_add(0.005, -2.0)];
            assert_eq!(general.at(x).to_bits(), histogram.at(x).to_bits());
        }
    }

    /// The projection on polynomials: the estimate of the data of a bin integrates every polynomial of its degree as the data sum it.
    #[test]
    fn moments_of_each_bin_are_those_of_its_data() {
        let sample = sample();
        let rule = GaussLegendre::new(8);
        for degree in 0..=3_u64 {
            let estimate = fitted(degree, &sample);
            for bin in -3..6 {
                let (low, high) = (
                    f64::from(bin).mul_add(0.37, 0.11),
                    f64::from(bin + 1).mul_add(0.37, 0.11),
                );
                for power in 0..=degree as i32 {
                    let integral = rule.integrate(|x| x.powi(power) * estimate.at([x]), low, high);
                    let sum: f64 = sample
                        .coordinates()
                        .iter()
                        .enumerate()
                        .filter(|(_, x)| low <= **x && **x < high)
                        .map(|(i, x)| sample.weight(i) * x.powi(power))
                        .sum();
                    assert!((integral - sum).abs() < 1e-13, "{degree} {bin} {power}");
                }
            }
        }
    }
}
