//! The frequency polygon: straight lines between the tops of a histogram's bars.

use super::bins::Bins;
use super::width::{self, Rule, Width};
use super::{Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws, Moments};
use crate::density::Density;
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::selector;
use crate::space::{Domain, Field, Point};
use crate::theory::{NoAsymptotics, polygon_moments};
use std::sync::Arc;

/// Linear interpolation between the values of a histogram at the centres of its bins, empty bins included.
///
/// f̂(x) = (1 - t) f₀ + t f₁ for x at the fraction t of the way between two neighbouring centres. It loses a histogram's jumps and with them its slow rate:
/// the error falls like n^(-4/5) instead of n^(-2/3). [Scott 1985, Journal of the American Statistical Association 80]
///
/// O(n + m).
pub struct FrequencyPolygon {
    width: Width,
    origin: f64,
}

struct Fitted {
    bins: Bins,
    width: f64,
    origin: f64,
    domain: Domain<1>,
}

impl Field<1> for Fitted {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        // how many widths x lies beyond the centre of bin 0
        let place = (x - self.origin) / self.width - 0.5;
        if place.is_infinite() {
            return 0.0;
        }
        let left = place.floor() + 0.0;
        let share = place - left;
        let (f0, f1) = (self.bins.mass(left), self.bins.mass(left + 1.0));
        ((1.0 - share) * f0 + share * f1) / self.width
    }
}

impl Estimator<1> for FrequencyPolygon {
    fn laws(&self) -> Laws {
        self.width.laws()
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let (width, warnings) = self.width.of(sample)?;
        width::binned(
            sample,
            warnings,
            width,
            width,
            self.origin,
            |bins, domain| {
                Arc::new(Fitted {
                    bins,
                    width,
                    origin: self.origin,
                    domain,
                })
            },
        )
    }

    fn expectation(
        &self,
        truth: &dyn Density<1>,
        draws: usize,
        places: &[Point<1>],
    ) -> Option<Vec<Moments>> {
        let width = self.width.number()?;
        let at = |&[x]: &Point<1>| polygon_moments(truth, width, self.origin, draws as f64, x);
        Some(places.iter().map(at).collect())
    }
}

impl Described for FrequencyPolygon {
    const NAME: &'static str = "frequency-polygon";
    const SUMMARY: &'static str = "straight lines between the middles of a histogram's bars";
    const COST: &'static str = "O(n + m)";
    const REFERENCE: &'static str =
        "Scott 1985, Journal of the American Statistical Association 80; Scott 1992, chapter 4";
    const SMOOTHING: Option<&'static str> = Some("width");
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::required(
            "width",
            Kind::PositiveOr(&["normal-reference", "amise"]),
            "the width of a bin, in the unit of the data",
        )
        .length()
        .swept(),
        Parameter::optional(
            "origin",
            Kind::Real,
            Absent::Number(0.0),
            "an edge of a bin, in the unit of the data",
        )
        .place(),
    ];
}

impl Build<1> for FrequencyPolygon {
    fn build(values: &Values, context: &Context<1>) -> Result<Self, BuildError> {
        let rules: &[(_, Rule)] = &[("normal-reference", selector::frequency_polygon)];
        let width = Width::given(values, context, rules, |_, truth, draws| {
            // 2 (15 / (49 R(f″) n))^(1/5) [Scott 1992, eq. 4.10]
            let curvature = truth.roughness(2);
            if curvature.is_finite() {
                Ok(2.0 * (15.0 / (49.0 * curvature * draws)).powf(0.2))
            } else {
                Err(NoAsymptotics::Curvature)
            }
        })?;
        Ok(Self {
            width,
            origin: values.number("origin").unwrap_or(0.0),
        })
    }
}
