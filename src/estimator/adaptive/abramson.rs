//! Abramson's square-root law.

use crate::density::Density;
use crate::engine::{EXACT, Engine, LINE, Planned};
use crate::estimator::kde::SYMMETRY;
use crate::estimator::{
    Build, BuildError, Context, Described, Estimate, Estimator, Family, FitError, Laws, Moments,
};
use crate::kernel::{Bandwidth, KernelSum, Shape, Symmetry};
use crate::numeric::{Sum, sign_change};
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::selector::{NormalReference, Scott, Selector, Silverman};
use crate::space::{Domain, Evaluation, Field, Point, Targets, Warning};
use crate::theory::{FixedPilot, WidthLaw, adaptive_moments, geometric_mean, kernel_moments};
use std::sync::Arc;

/// f̂(x) = Σ wᵢ K((x - Xᵢ)/hᵢ)/hᵢ with hᵢ = h (p(Xᵢ)/g)^(-α), p a pilot estimate, g the geometric mean of p over the data, α = 1/2.
///
/// With α = 1/2 the bias falls as h⁴ instead of h²: h⁴ (k₄/24) (1/f)'''' g² + o(h⁴), where f is smooth and not small. The pilot need not be good; where
/// it is small the widths would grow beyond bounds and their bumps disturb places far away, which destroys the rate [Terrell & Scott 1992], so that p counts as
/// no less than `clip` times g. Mass is kept exactly, and nothing is negative.
///
/// In the plane a datum has one width for both axes, hᵢ = h (p(Xᵢ)/g)^(-α) with the same α, and K is a product or radial; the pilot may have a width for each axis.
///
/// Pilot and estimate are computed by the engines: O(n log n + m) for polynomial kernels on the line, O(n · (cells within reach) + m) on a grid in the plane.
pub struct Abramson<const D: usize = 1> {
    pub(super) shape: Shape,
    pub(super) symmetry: Symmetry,
    pub(super) width: Width<D>,
    pub(super) pilot: Pilot<D>,
    pub(super) law: WidthLaw,
}

/// Where a bandwidth comes from.
pub(super) enum Width<const D: usize> {
    Number(f64),
    Selected(Box<dyn Selector<D>>),
}

/// What the widths follow.
pub(super) enum Pilot<const D: usize> {
    /// A kernel estimate of the same data with this bandwidth.
    Estimate(Width<D>),
    /// The same with the bandwidth of the estimate.
    Tied,
    /// The known truth, with its geometric mean.
    Truth(Arc<dyn Density<D>>, f64),
}

impl<const D: usize> Width<D> {
    /// What the file says: a number or a rule; `None` for another word.
    pub(super) fn given(
        values: &Values,
        name: &str,
        rule: impl Fn(&str) -> Option<Box<dyn Selector<D>>>,
    ) -> Option<Self> {
        if let Some(h) = values.number(name) {
            return Some(Self::Number(h));
        }
        values.word(name).and_then(rule).map(Self::Selected)
    }

    fn of(
        &self,
        sample: &Sample<D>,
        shape: Shape,
        warnings: &mut Vec<Warning>,
    ) -> Result<[f64; D], FitError> {
        match self {
            Self::Number(h) => Ok([*h; D]),
            Self::Selected(selector) => {
                let selection = selector.select(sample, shape)?;
                for warning in selection.warnings {
                    if !warnings.contains(&warning) {
                        warnings.push(warning);
                    }
                }
                match selection.bandwidth {
                    Bandwidth::Fixed(h) => Ok(h),
                    _ => Err(FitError::Degenerate(format!(
                        "the rule {} gives a bandwidth that varies",
                        selector.name()
                    ))),
                }
            }
        }
    }

    pub(super) fn fixed(&self) -> Option<f64> {
        match self {
            Self::Number(h) => Some(*h),
            Self::Selected(_) => None,
        }
    }
}

impl<const D: usize> Abramson<D> {
    /// All of its kind but for h, where the pilot is one that theory can follow.
    pub(super) fn kind(&self) -> Option<Family> {
        let (shape, symmetry) = (self.shape, self.symmetry);
        if self.law.exponent == 0.0 {
            return Some(match symmetry {
                Symmetry::Product => Family::Kernel(shape),
                Symmetry::Radial => Family::RadialKernel(shape),
            });
        }
        let pilot = match &self.pilot {
            Pilot::Truth(..) => FixedPilot::Truth,
            Pilot::Tied => FixedPilot::Tied,
            Pilot::Estimate(width) => FixedPilot::Smoothed(width.fixed()?),
        };
        Some(Family::Adaptive {
            shape,
            symmetry,
            law: self.law,
            pilot,
        })
    }

    /// What each width is a multiple of, times what. O(n log n).
    fn stretches(
        &self,
        sample: &Sample<D>,
        own: f64,
        engines: &'static [&'static dyn Engine<D>],
        warnings: &mut Vec<Warning>,
    ) -> Result<Vec<f64>, FitError> {
        let n = sample.len();
        if self.law.exponent == 0.0 {
            return Ok(vec![1.0; n]);
        }
        let (values, mean) = match &self.pilot {
            Pilot::Truth(truth, mean) => {
                let values: Vec<f64> = sample.points().iter().map(|x| truth.at(*x)).collect();
                (values, *mean)
            }
            pilot => {
                let h = match pilot {
                    Pilot::Estimate(width) => width.of(sample, self.shape, warnings)?,
                    _ => [own; D],
                };
                let sum = KernelSum::new(sample.clone(), self.shape, Bandwidth::Fixed(h))?
                    .with_symmetry(self.symmetry);
                // what a datum contributes to the pilot at its own place: no less is there, whatever an engine rounds to
                let peak = self.symmetry.peak::<D>(self.shape);
                let own = h.iter().fold(peak, |value, h| value / h);
                let planned = Planned::new(engines, sum, EXACT, None)
                    .map_err(|error| FitError::Engine(error.to_string()))?;
                let mut values = planned.evaluate(Targets::Points(sample.points())).values;
                let mut logarithms = Sum::default();
                for (i, value) in values.iter_mut().enumerate() {
                    let weight = sample.weight(i);
                    *value = value.max(weight * own);
                    if weight > 0.0 {
                        logarithms.add(weight * value.ln());
                    }
                }
                (values, (logarithms.value() / sample.mass()).exp())
            }
        };
        Ok((0..n)
            .map(|i| {
                let stretch = self.law.stretch(values[i], mean);
                // a point without weight adds nothing, whatever its width
                if sample.weight(i) > 0.0 { stretch } else { 1.0 }
            })
            .collect())
    }

    pub(super) fn promises(&self) -> Laws {
        let fixed = self.width.fixed().is_some();
        let (adapts, sees) = match &self.pilot {
            _ if self.law.exponent == 0.0 => (false, true),
            Pilot::Tied => (true, fixed),
            Pilot::Truth(..) => (false, true),
            Pilot::Estimate(width) => (true, width.fixed().is_some()),
        };
        Laws {
            mass_conserving: true,
            non_negative: true,
            linear: fixed && !adapts,
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: self.shape != Shape::Uniform,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            // rules for widths look at the effective size
            repeatable: fixed && sees,
        }
    }

    pub(super) fn estimate(
        &self,
        sample: &Sample<D>,
        engines: &'static [&'static dyn Engine<D>],
    ) -> Result<Estimate<D>, FitError> {
        let mut warnings = Vec::new();
        let widths = self.width.of(sample, self.shape, &mut warnings)?;
        let h = widths[0];
        if widths.iter().any(|other| other.total_cmp(&h).is_ne()) {
            return Err(FitError::Degenerate(
                "Abramson's estimator has one width for all axes: give a number, or a rule that chooses one, such as `silverman`".to_owned(),
            ));
        }
        let widths: Arc<[f64]> = self
            .stretches(sample, h, engines, &mut warnings)?
            .into_iter()
            .map(|stretch| h * stretch)
            .collect();
        let bandwidth = Bandwidth::PerPoint(widths);
        let field = |sample: Sample<D>| -> Result<Arc<dyn Field<D>>, FitError> {
            let sum =
                KernelSum::new(sample, self.shape, bandwidth.clone())?.with_symmetry(self.symmetry);
            let planned = Planned::new(engines, sum, EXACT, None)
                .map_err(|error| FitError::Engine(error.to_string()))?;
            Ok(Arc::new(NonNegative(planned)))
        };
        let mut estimate = Estimate::new(field(sample.clone())?).with_channels(
            (0..sample.channels())
                .map(|c| field(sample.channel(c)))
                .collect::<Result<_, _>>()?,
        );
        estimate.smoothing = Some(h);
        estimate.bandwidth = Some(bandwidth);
        estimate.warnings = warnings;
        Ok(estimate)
    }
}

/// A sum of bumps that are nowhere negative: what an engine rounds to below zero is zero.
struct NonNegative<const D: usize>(Planned<D>);

impl<const D: usize> Field<D> for NonNegative<D> {
    fn domain(&self) -> &Domain<D> {
        self.0.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        self.0.at(x)
    }

    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        let mut evaluation = self.0.evaluate(targets);
        for value in &mut evaluation.values {
            // not `max`, which would hide what is not a number
            if *value < 0.0 {
                *value = 0.0;
            }
        }
        evaluation
    }
}

impl Estimator<1> for Abramson {
    fn laws(&self) -> Laws {
        self.promises()
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        self.estimate(sample, LINE)
    }

    fn expectation(
        &self,
        truth: &dyn Density<1>,
        draws: usize,
        places: &[Point<1>],
    ) -> Option<Vec<Moments>> {
        let (h, draws) = (self.width.fixed()?, draws as f64);
        let at = |x: f64| match &self.pilot {
            _ if self.law.exponent == 0.0 => Some(kernel_moments(truth, self.shape, h, draws, x)),
            Pilot::Truth(pilot, mean) => {
                let width = |y: f64| h * self.law.stretch(pilot.at([y]), *mean);
                // the clip bends the width where the pilot passes clip · g
                let cuts = clip_cuts(&**pilot, self.law.clip * mean);
                Some(adaptive_moments(truth, self.shape, width, &cuts, draws, x))
            }
            Pilot::Estimate(_) | Pilot::Tied => None,
        };
        places.iter().map(|&[x]| at(x)).collect()
    }

    fn family(&self) -> Option<Family> {
        self.kind()
    }
}

/// Where `pilot` passes `level`, as well as a thousand places can see.
fn clip_cuts(pilot: &dyn Density<1>, level: f64) -> Vec<f64> {
    const STEPS: usize = 1000;
    let ([low], [high]) = pilot.bulk(1e-18);
    let above = |y: f64| pilot.at([y]) - level;
    (0..STEPS)
        .filter_map(|i| {
            let place = |i: usize| low + (high - low) * i as f64 / STEPS as f64;
            sign_change(above, place(i), place(i + 1))
        })
        .collect()
}

fn rule(word: &str) -> Option<Box<dyn Selector<1>>> {
    Some(match word {
        "silverman" => Box::new(Silverman),
        "normal-reference" => Box::new(NormalReference),
        "scott" => Box::new(Scott),
        _ => return None,
    })
}

pub(super) fn law(values: &Values) -> WidthLaw {
    WidthLaw {
        exponent: values.number("exponent").unwrap_or(0.5),
        clip: values.number("clip").unwrap_or(0.1),
    }
}

const RULES: &[&str] = &["silverman", "normal-reference", "scott"];

impl<const D: usize> Described for Abramson<D>
where
    Self: Estimator<D>,
{
    const NAME: &'static str = "abramson";
    const SUMMARY: &'static str =
        "a bump on each point, wider where a pilot estimate is low: bias of order h⁴";
    const COST: &'static str = "O(n log n + m) for polynomial kernels on a line; O(n · (cells within reach) + m) in the plane";
    const REFERENCE: &'static str =
        "Abramson 1982; Silverman 1986, section 5.3; Terrell & Scott 1992";
    const SMOOTHING: Option<&'static str> = Some("bandwidth");
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::optional(
            "shape",
            Kind::Choice(&Shape::NAMES),
            Absent::Word("gaussian"),
            "the kernel, of the pilot too",
        ),
        SYMMETRY,
        Parameter::required(
            "bandwidth",
            Kind::PositiveOr(RULES),
            "h, the bandwidth where the pilot has its geometric mean, in the unit of the data; in the plane one for both axes",
        )
        .length()
        .swept(),
        Parameter::optional(
            "pilot",
            Kind::PositiveOr(&["silverman", "normal-reference", "scott", "tied", "truth"]),
            Absent::Word("normal-reference"),
            "the bandwidth of the pilot estimate; tied: that of the estimate; truth: the known density is the pilot",
        )
        .length(),
        Parameter::optional(
            "exponent",
            Kind::Fraction,
            Absent::Number(0.5),
            "α in width ∝ pilot^(-α); 1/2 is Abramson's, 0 a fixed width",
        ),
        Parameter::optional(
            "clip",
            Kind::Fraction,
            Absent::Number(0.1),
            "the pilot counts as no less than this share of its geometric mean",
        ),
    ];
}

impl Build<1> for Abramson {
    fn build(values: &Values, context: &Context<1>) -> Result<Self, BuildError> {
        let shape = values
            .word("shape")
            .and_then(Shape::named)
            .unwrap_or(Shape::Gaussian);
        let pilot = if let Some(width) = Width::given(values, "pilot", rule) {
            Pilot::Estimate(width)
        } else if values.word("pilot") == Some("tied") {
            Pilot::Tied
        } else {
            let truth = context.truth.clone().ok_or_else(|| BuildError {
                    parameter: "pilot",
                    what: "\"truth\" is the known density, and the density of measured data is not known; give a bandwidth or a rule".to_owned(),
                })?;
            let mean = geometric_mean(&*truth);
            Pilot::Truth(truth, mean)
        };
        Ok(Self {
            shape,
            symmetry: Symmetry::Product,
            width: Width::given(values, "bandwidth", rule).unwrap_or(Width::Number(1.0)),
            pilot,
            law: law(values),
        })
    }
}
