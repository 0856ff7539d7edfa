//! Series on an interval: cosines, Legendre polynomials, Fourier's functions.

use super::terms::{TAPER, TERMS};
use super::{Length, fit, plane};
use crate::density::Density;
use crate::estimator::{
    Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws, Moments,
};
use crate::numeric::orthogonal::{Basis, Cosine, Fourier, Legendre, Placed};
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Point, Warning};
use crate::theory::{self, Family, Taper, series_moments, series_moments_in_plane};
use std::marker::PhantomData;

/// A series in a compact system on the domain of the data, or from `low` to `high`.
///
/// The estimate is zero outside the interval. O(n J + m J) for J terms.
pub struct IntervalSeries<B> {
    basis: PhantomData<B>,
    length: Length,
    low: Option<f64>,
    high: Option<f64>,
}

/// The series of cosines: of the density reflected at both ends. Its slope is zero there, and its error O(1/J) where that of the density is not.
pub type CosineSeries = IntervalSeries<Cosine>;

/// The series of Legendre polynomials: no condition at the ends, but more variance there.
pub type LegendreSeries = IntervalSeries<Legendre>;

/// The series of sines and cosines of whole periods: for data that wrap round. Where the density differs at the two ends, the estimate tends to the mean
/// of both there and overshoots beside it, however many terms.
pub type FourierSeries = IntervalSeries<Fourier>;

/// What the catalogue says about a system.
pub trait System: Basis {
    /// The name of the series.
    const NAME: &'static str;
    /// One sentence.
    const SUMMARY: &'static str;
    /// Author, year.
    const REFERENCE: &'static str;
    /// Whether Fejér's taper makes sums nowhere negative.
    const FEJER_IS_POSITIVE: bool;
    /// What theory calls it.
    const SYSTEM: theory::System;
    /// Whether the first two functions are a constant and a line.
    const HAS_LINES: bool;
}

impl System for Cosine {
    const NAME: &'static str = "cosine-series";
    const SUMMARY: &'static str =
        "a sum of cosines on an interval: the density reflected at both ends";
    const REFERENCE: &'static str = "Čencov 1962; Kronmal & Tarter 1968";
    const FEJER_IS_POSITIVE: bool = true;
    const SYSTEM: theory::System = theory::System::Cosine;
    const HAS_LINES: bool = false;
}

impl System for Legendre {
    const NAME: &'static str = "legendre-series";
    const SUMMARY: &'static str = "a sum of Legendre polynomials on an interval";
    const REFERENCE: &'static str = "Čencov 1962; Hall 1982, Annals of Statistics 10";
    const FEJER_IS_POSITIVE: bool = false;
    const SYSTEM: theory::System = theory::System::Legendre;
    const HAS_LINES: bool = true;
}

impl System for Fourier {
    const NAME: &'static str = "fourier-series";
    const SUMMARY: &'static str = "a sum of whole waves on an interval that wraps round";
    const REFERENCE: &'static str = "Kronmal & Tarter 1968; Hall 1981, Annals of Statistics 9";
    const FEJER_IS_POSITIVE: bool = true;
    const SYSTEM: theory::System = theory::System::Fourier;
    const HAS_LINES: bool = false;
}

/// A function of which a taper leaves this share is there: what reproduces lines does so to half a percent.
const WHOLE: f64 = 0.995;

impl<B: System> IntervalSeries<B> {
    /// The interval on one axis of a domain, if it has two ends in order.
    fn interval<const D: usize>(&self, domain: &Domain<D>, axis: usize) -> Option<[f64; 2]> {
        let (low, high) = (domain.low()[axis], domain.high()[axis]);
        let (low, high) = (self.low.unwrap_or(low), self.high.unwrap_or(high));
        let length = high - low;
        (length > 0.0 && length.is_finite() && length.recip().is_finite()).then_some([low, high])
    }

    /// Whether the kernel that the waves make is nowhere negative: a constant alone is not, nor are 1 + 2λ cos θ with λ ≤ ½ and Fejér's.
    fn positive(&self) -> bool {
        let taper = self.length.taper;
        match self.length.fixed() {
            Some(1) => true,
            Some(2) if B::FEJER_IS_POSITIVE => taper.weight(1, 2) <= 0.5,
            _ => B::FEJER_IS_POSITIVE && taper == Taper::Fejer,
        }
    }

    /// Whether the second function of an axis is there for certain, and whole.
    fn keeps_the_second(&self) -> bool {
        match self.length.fixed() {
            Some(terms) => terms >= 2 && self.length.taper.weight(1, terms) >= WHOLE,
            // whatever is chosen, data on a slope ask for it
            None => self.length.taper == Taper::None,
        }
    }

    fn promises(&self) -> Laws {
        let fixed = self.length.fixed().is_some();
        Laws {
            // data outside a window are left out
            mass_conserving: self.whole(),
            non_negative: self.positive(),
            linear: fixed,
            // the constant is one of the functions, and even data have no share in the others
            reproduces_constants: true,
            reproduces_linear: B::HAS_LINES && self.keeps_the_second(),
            // it ends at the ends
            continuous: false,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: fixed,
        }
    }

    /// What to say of data that the series leaves out.
    fn outside<const D: usize>(
        &self,
        sample: &Sample<D>,
        inside: impl Fn(Point<D>) -> bool,
    ) -> Vec<Warning> {
        let beyond = |(i, x): (usize, &Point<D>)| sample.weight(i) > 0.0 && !inside(*x);
        if self.whole() || !sample.points().iter().enumerate().any(beyond) {
            return Vec::new();
        }
        vec![Warning {
            what: "some data lie outside the interval of the series; the estimate is zero there and misses their mass".to_owned(),
            hint: "move `low` or `high` outwards if that is not wanted".to_owned(),
        }]
    }

    fn whole(&self) -> bool {
        self.low.is_none() && self.high.is_none()
    }
}

impl<B: System> Estimator<1> for IntervalSeries<B> {
    fn laws(&self) -> Laws {
        self.promises()
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let [low, high] = self
            .interval(sample.domain(), 0)
            .ok_or_else(|| no_ends(sample))?;
        let placed = Placed::<B>::between(low, high);
        let warnings = self.outside(sample, |[x]| placed.contains(x));
        fit(sample, placed, self.length, self.positive(), warnings)
    }

    fn expectation(
        &self,
        truth: &dyn Density<1>,
        draws: usize,
        places: &[Point<1>],
    ) -> Option<Vec<Moments>> {
        let [low, high] = self.interval(truth.domain(), 0)?;
        let placed = Placed::<B>::between(low, high);
        let terms = self.length.fixed()?;
        let taper = self.length.taper;
        Some(series_moments(
            truth,
            &placed,
            terms,
            taper,
            draws as f64,
            places.as_flattened(),
        ))
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Series {
            system: B::SYSTEM,
            place: [self.low, self.high],
            taper: self.length.taper,
        })
    }
}

impl<B: System> Estimator<2> for IntervalSeries<B> {
    fn laws(&self) -> Laws {
        self.promises()
    }

    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        let domain = sample.domain();
        if domain.outline().is_some() {
            return Err(FitError::Degenerate(
                "a series in the plane lives on a rectangle, and the domain of the data is a polygon; choose another estimator".to_owned(),
            ));
        }
        let placed = [0, 1].map(|axis| {
            self.interval(domain, axis)
                .map(|[low, high]| Placed::<B>::between(low, high))
        });
        let [Some(first), Some(second)] = placed else {
            return Err(no_ends(sample));
        };
        let warnings = self.outside(sample, |[x, y]| first.contains(x) && second.contains(y));
        plane::fit(
            sample,
            [first, second],
            self.length,
            self.positive(),
            warnings,
        )
    }

    fn expectation(
        &self,
        truth: &dyn Density<2>,
        draws: usize,
        places: &[Point<2>],
    ) -> Option<Vec<Moments>> {
        if truth.domain().outline().is_some() {
            return None;
        }
        let [low, high] = self.interval(truth.domain(), 0)?;
        let [below, above] = self.interval(truth.domain(), 1)?;
        let placed = [
            Placed::<B>::between(low, high),
            Placed::between(below, above),
        ];
        let terms = self.length.fixed()?;
        let taper = self.length.taper;
        Some(series_moments_in_plane(
            truth,
            &placed,
            terms,
            taper,
            draws as f64,
            places,
        ))
    }
}

/// What to say where a domain has no ends.
fn no_ends<const D: usize>(sample: &Sample<D>) -> FitError {
    let place = |pick: fn(f64, f64) -> f64, from: f64| {
        (0..sample.len())
            .filter(|&i| sample.weight(i) > 0.0)
            .flat_map(|i| sample.points()[i])
            .fold(from, pick)
    };
    FitError::Degenerate(format!(
        "a series of this kind lives on an interval, and the domain of the data has no two ends; give the ends as `low` and `high` (the data lie between {} and {})",
        place(f64::min, f64::INFINITY),
        place(f64::max, f64::NEG_INFINITY)
    ))
}

impl<B: System> Described for IntervalSeries<B> {
    const NAME: &'static str = B::NAME;
    const SUMMARY: &'static str = B::SUMMARY;
    const COST: &'static str = "O(n J + m J) for J terms; in the plane O(n J² + m J) on a grid";
    const REFERENCE: &'static str = B::REFERENCE;
    const SMOOTHING: Option<&'static str> = Some("terms");
    const PARAMETERS: &'static [Parameter] = &[
        TERMS,
        TAPER,
        Parameter::optional(
            "low",
            Kind::Real,
            Absent::Unset,
            "the lower end of the interval on each axis, if it is not that of the domain",
        )
        .place(),
        Parameter::optional(
            "high",
            Kind::Real,
            Absent::Unset,
            "the upper end of the interval on each axis, if it is not that of the domain",
        )
        .place(),
    ];
}

impl<B: System, const D: usize> Build<D> for IntervalSeries<B>
where
    Self: Estimator<D>,
{
    fn build(values: &Values, context: &Context<D>) -> Result<Self, BuildError> {
        let (low, high) = (values.number("low"), values.number("high"));
        if let (Some(low), Some(high)) = (low, high)
            && low >= high
        {
            return Err(BuildError {
                parameter: "low",
                what: format!("`low` must be below `high`, and {low} is not below {high}"),
            });
        }
        let mut series = Self {
            basis: PhantomData,
            length: Length {
                terms: super::Terms::CrossValidation,
                taper: Taper::None,
            },
            low,
            high,
        };
        let truth = context.truth.as_ref().and_then(|truth| truth.univariate());
        series.length = Length::given(values, truth, context.draws, |truth| {
            series
                .interval(truth.domain(), 0)
                .map(|[low, high]| Placed::<B>::between(low, high))
                .ok_or_else(|| BuildError {
                    parameter: "terms",
                    what: "\"oracle\" needs an interval, and the domain of the density has no two ends; give `low` and `high`".to_owned(),
                })
        })?;
        Ok(series)
    }
}
