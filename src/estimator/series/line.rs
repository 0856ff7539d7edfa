//! The Hermite series on the line.

use super::terms::{TAPER, TERMS};
use super::{Length, fit};
use crate::density::Density;
use crate::estimator::normal::{likeliest, resolved};
use crate::estimator::{
    Build, BuildError, Context, Described, Estimate, Estimator, Family, FitError, Laws, Moments,
};
use crate::numeric::orthogonal::{Hermite, Placed};
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::Point;
use crate::theory::{System, series_moments};

/// A series of Hermite functions about the mean of the data, in units of their deviation; or about `location`, in units of `scale`.
///
/// With one term the estimate is a multiple of a normal density of deviation `scale`: functions that fade like exp(-u²/2) fit best where the
/// density does. The mass is not kept: no function is constant. O(n J + m J) for J terms.
pub struct HermiteSeries {
    length: Length,
    location: Option<f64>,
    scale: Option<f64>,
}

impl HermiteSeries {
    /// Where the functions are, where that is the same for all samples.
    fn fixed(&self) -> Option<Placed<Hermite>> {
        Some(Placed::about(self.location?, 0.0, self.scale?))
    }
}

impl Estimator<1> for HermiteSeries {
    fn laws(&self) -> Laws {
        let fixed = self.length.fixed().is_some();
        Laws {
            mass_conserving: false,
            // one bell
            non_negative: self.length.fixed() == Some(1),
            linear: fixed && self.fixed().is_some(),
            continuous: true,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: fixed,
        }
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let placed = if let Some(placed) = self.fixed() {
            placed
        } else {
            let (centre, offset, deviation) = likeliest(sample);
            if self.scale.is_none() && !resolved(sample, deviation) {
                return Err(FitError::Degenerate(format!(
                    "all {} points are at {}: their deviation is no scale for a series; give `scale`",
                    sample.len(),
                    centre + offset
                )));
            }
            let (centre, offset) = self.location.map_or((centre, offset), |x| (x, 0.0));
            Placed::about(centre, offset, self.scale.unwrap_or(deviation))
        };
        let positive = self.laws().non_negative;
        fit(sample, placed, self.length, positive, Vec::new())
    }

    fn expectation(
        &self,
        truth: &dyn Density<1>,
        draws: usize,
        places: &[Point<1>],
    ) -> Option<Vec<Moments>> {
        let (placed, terms) = (self.fixed()?, self.length.fixed()?);
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
            system: System::Hermite,
            place: [self.location, self.scale],
            taper: self.length.taper,
        })
    }
}

impl Described for HermiteSeries {
    const NAME: &'static str = "hermite-series";
    const SUMMARY: &'static str =
        "a sum of Hermite functions: a normal density and corrections to it";
    const COST: &'static str = "O(n J + m J) for J terms";
    const REFERENCE: &'static str = "Schwartz 1967; Walter 1977, Annals of Statistics 5";
    const SMOOTHING: Option<&'static str> = Some("terms");
    const PARAMETERS: &'static [Parameter] = &[
        TERMS,
        TAPER,
        Parameter::optional(
            "location",
            Kind::Real,
            Absent::Unset,
            "where the functions are centred, if not at the mean of the data",
        )
        .place(),
        Parameter::optional(
            "scale",
            Kind::Positive,
            Absent::Unset,
            "the deviation of the lowest term, if not that of the data",
        )
        .length(),
    ];
}

impl Build<1> for HermiteSeries {
    fn build(values: &Values, context: &Context<1>) -> Result<Self, BuildError> {
        let (location, scale) = (values.number("location"), values.number("scale"));
        let truth = context.truth.as_ref().and_then(|truth| truth.univariate());
        let length = Length::given(values, truth, context.draws, |truth| {
            // the best for functions placed by the truth, as data place them on average
            let (mean, deviation) = truth.mean_and_deviation();
            Ok(Placed::<Hermite>::about(
                location.unwrap_or(mean),
                0.0,
                scale.unwrap_or(deviation),
            ))
        })?;
        Ok(Self {
            length,
            location,
            scale,
        })
    }
}
