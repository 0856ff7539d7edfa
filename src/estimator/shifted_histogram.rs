//! The averaged shifted histogram: a histogram without the whim of its origin.

use super::cells::{ORIGIN_Y, WIDTH_Y};
use super::width::{Binned, Rule, Width};
use super::{
    Build, BuildError, Context, Described, Estimate, Estimator, Family, FitError, Laws, Moments,
};
use crate::density::Density;
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::selector;
use crate::space::{Domain, Field, Point};
use crate::theory::shifted_histogram_moments;

/// The mean of m histograms whose origins are width/m apart.
///
/// f̂(x) = (1/width) Σ_{|i| < m} (1 - |i|/m) νₖ₊ᵢ, with νⱼ the mass in the narrow bin j of width/m and k the narrow bin of x. For m = 1 the histogram; for
/// m → ∞ the kernel estimate with the triangular kernel and the bandwidth `width`. [Scott 1985, eq. 2.4; Scott 1992, section 5.1]
///
/// O(n + m·targets).
pub struct ShiftedHistogram {
    width: Width,
    shifts: u32,
    origin: f64,
}

struct Fitted {
    narrow: Binned,
    shifts: f64,
}

impl Field<1> for Fitted {
    fn domain(&self) -> &Domain<1> {
        &self.narrow.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        let Binned { bins, width, .. } = &self.narrow;
        let total: f64 = bins
            .around(bins.number(x), self.shifts - 1.0)
            .map(|(i, mass)| (self.shifts - i.abs()) * mass)
            .sum();
        total / self.shifts / width
    }
}

impl Estimator<1> for ShiftedHistogram {
    fn laws(&self) -> Laws {
        Laws {
            continuous: false,
            ..self.width.laws()
        }
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let shifts = f64::from(self.shifts);
        self.width
            .fit(sample, shifts, self.origin, |narrow| Fitted {
                narrow,
                shifts,
            })
    }

    fn expectation(
        &self,
        truth: &dyn Density<1>,
        draws: usize,
        places: &[Point<1>],
    ) -> Option<Vec<Moments>> {
        let width = self.width.number()?;
        let at = |&[x]: &Point<1>| {
            shifted_histogram_moments(truth, width, self.shifts, self.origin, draws as f64, x)
        };
        Some(places.iter().map(at).collect())
    }

    fn family(&self) -> Option<Family> {
        let &Self { shifts, origin, .. } = self;
        Some(Family::ShiftedHistogram { shifts, origin })
    }
}

impl Described for ShiftedHistogram {
    const NAME: &'static str = "shifted-histogram";
    const SUMMARY: &'static str = "the mean of histograms with shifted origins";
    const COST: &'static str = "O(n + shifts m)";
    const REFERENCE: &'static str = "Scott 1985, Annals of Statistics 13; Scott 1992, chapter 5";
    const SMOOTHING: Option<&'static str> = Some("width");
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::required(
            "width",
            Kind::PositiveOr(&["normal-reference", "oracle", "amise"]),
            "the width of a bin of each histogram, in the unit of the data: the bandwidth of the triangular kernel that the mean tends to",
        )
        .length()
        .swept(),
        Parameter::optional(
            "shifts",
            Kind::Count {
                least: 1,
                most: 4096,
            },
            Absent::Number(16.0),
            "how many histograms are averaged",
        ),
        Parameter::optional(
            "origin",
            Kind::Real,
            Absent::Number(0.0),
            "an edge of a bin of the first histogram, in the unit of the data",
        )
        .place(),
        WIDTH_Y,
        ORIGIN_Y,
    ];
}

impl Build<1> for ShiftedHistogram {
    fn build(values: &Values, context: &Context<1>) -> Result<Self, BuildError> {
        let rules: &[(_, Rule)] = &[("normal-reference", selector::shifted_histogram)];
        let shifts = values.count("shifts").map_or(16, |shifts| shifts as u32);
        let origin = values.number("origin").unwrap_or(0.0);
        let family = Family::ShiftedHistogram { shifts, origin };
        Ok(Self {
            width: Width::given(values, context, rules, family)?,
            shifts,
            origin,
        })
    }
}
