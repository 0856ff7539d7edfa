//! The kernel estimator: a selector, a kernel, a boundary and an engine plugged together.

use super::width::best;
use super::{Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws, Moments};
use crate::boundary::{self, Boundary, Bump, Ignore, corrected_moments};
use crate::density::Density;
use crate::engine::{EXACT, LINE, Planned};
use crate::kernel::{Bandwidth, KernelSum, Shape, Symmetry};
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::selector::{NormalReference, Scott, Selector, Silverman};
use crate::space::{Domain, Evaluation, Field, Point, Targets};
use crate::theory::{Family, kernel_moments};
use std::sync::Arc;

/// Where the bandwidth comes from.
enum Width {
    Number(f64),
    Selected(Box<dyn Selector<1>>),
}

/// f̂(x) = Σ wᵢ K((x - Xᵢ)/h) / h. [Rosenblatt 1956; Parzen 1962; Silverman 1986, eq. 2.2a]
pub struct Kde {
    shape: Shape,
    width: Width,
    boundary: Box<dyn Boundary<1>>,
    /// Whether walls are seen to: the exact theory is of estimates that ignore them.
    corrected: bool,
    /// The engine that is forced, if any.
    engine: Option<&'static str>,
    /// What an engine may be off by, relative to the ceiling of the sum.
    tolerance: f64,
}

/// A sum of bumps that are nowhere negative: what an engine rounds to below zero is zero.
struct NonNegative(Planned<1>);

impl Field<1> for NonNegative {
    fn domain(&self) -> &Domain<1> {
        self.0.domain()
    }

    fn at(&self, x: Point<1>) -> f64 {
        self.0.at(x)
    }

    fn evaluate(&self, targets: Targets<'_, 1>) -> Evaluation {
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

impl Estimator<1> for Kde {
    fn laws(&self) -> Laws {
        Laws {
            mass_conserving: true,
            non_negative: true,
            linear: matches!(self.width, Width::Number(_)),
            continuous: self.shape != Shape::Uniform,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: matches!(self.width, Width::Number(_)),
        }
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let (bandwidth, warnings) = match &self.width {
            Width::Number(h) => (Bandwidth::Fixed([*h]), Vec::new()),
            Width::Selected(selector) => {
                let selection = selector.select(sample, self.shape)?;
                (selection.bandwidth, selection.warnings)
            }
        };
        let field = |sample: Sample<1>| -> Result<Arc<dyn Field<1>>, FitError> {
            let sum = KernelSum::new(sample, self.shape, bandwidth.clone())?;
            let compute = |sum| -> Box<dyn Field<1>> {
                let planned = Planned::new(LINE, sum, self.tolerance, self.engine);
                Box::new(NonNegative(
                    planned.expect("only known engines are built in"),
                ))
            };
            Ok(self.boundary.correct(sum, &compute)?.into())
        };
        let mut estimate = Estimate::new(field(sample.clone())?).with_channels(
            (0..sample.channels())
                .map(|c| field(sample.channel(c)))
                .collect::<Result<_, _>>()?,
        );
        if let Bandwidth::Fixed([h]) = bandwidth {
            estimate.smoothing = Some(h);
        }
        estimate.bandwidth = Some(bandwidth);
        estimate.warnings = warnings;
        Ok(estimate)
    }

    fn expectation(
        &self,
        truth: &dyn Density<1>,
        draws: usize,
        places: &[Point<1>],
    ) -> Option<Vec<Moments>> {
        let Width::Number(h) = self.width else {
            return None;
        };
        if !self.corrected || !truth.domain().has_walls() {
            let at = |&[x]: &Point<1>| kernel_moments(truth, self.shape, h, draws as f64, x);
            return Some(places.iter().map(at).collect());
        }
        let bump = Bump {
            shape: self.shape,
            symmetry: Symmetry::Product,
            width: [h],
        };
        let at = |&[x]: &Point<1>| corrected_moments(&*self.boundary, &bump, truth, draws, x);
        places.iter().map(at).collect()
    }

    fn family(&self) -> Option<Family> {
        (!self.corrected).then_some(Family::Kernel(self.shape))
    }
}

/// Free choice, or one of the engines of the line by name.
const ENGINES: [&str; 6] = ["auto", "direct", "interval", "sorted", "hermite", "binned"];

/// The bandwidth of the kernel estimator and its kin.
pub(super) const BANDWIDTH: Parameter = Parameter::required(
    "bandwidth",
    Kind::PositiveOr(&["silverman", "normal-reference", "scott", "oracle", "amise"]),
    "h, in the unit of the data: half the support of a compact kernel, the deviation of the Gaussian",
)
.length()
.swept();

impl Described for Kde {
    const NAME: &'static str = "kernel";
    const SUMMARY: &'static str = "a bump of one shape and width on each point";
    const COST: &'static str =
        "O(n + m) on a grid, O((n + m) log n) at points; O(n m) by definition";
    const REFERENCE: &'static str = "Rosenblatt 1956; Parzen 1962; Silverman 1986, eq. 2.2a";
    const SMOOTHING: Option<&'static str> = Some("bandwidth");
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::optional(
            "shape",
            Kind::Choice(&Shape::NAMES),
            Absent::Word("gaussian"),
            "the kernel",
        ),
        BANDWIDTH,
        Parameter::optional(
            "engine",
            Kind::Choice(&ENGINES),
            Absent::Word("auto"),
            "how the sum is computed, never what it is; auto: the fastest that is exact enough",
        ),
        Parameter::optional(
            "tolerance",
            Kind::Positive,
            Absent::Number(EXACT),
            "what computing may be off by, relative to the value if all points were at one place",
        ),
        Parameter::optional(
            "boundary",
            Kind::Choice(&boundary::NAMES),
            Absent::Word("ignore"),
            "what to do about the mass that kernels lay beyond the walls of the domain",
        ),
    ];
}

impl Build<1> for Kde {
    fn build(values: &Values, context: &Context<1>) -> Result<Self, BuildError> {
        let shape = values
            .word("shape")
            .and_then(Shape::named)
            .unwrap_or(Shape::Gaussian);
        Self::new(shape, values, context)
    }
}

impl Kde {
    /// The estimator with the kernel `shape` and everything else from `values`.
    pub(super) fn new(
        shape: Shape,
        values: &Values,
        context: &Context<1>,
    ) -> Result<Self, BuildError> {
        let width = match (values.number("bandwidth"), values.word("bandwidth")) {
            (Some(h), _) => Width::Number(h),
            (None, Some("silverman")) => Width::Selected(Box::new(Silverman)),
            (None, Some("normal-reference")) => Width::Selected(Box::new(NormalReference)),
            (None, Some("scott")) => Width::Selected(Box::new(Scott)),
            (None, word) => Width::Number(best(
                context,
                "bandwidth",
                word.unwrap_or_default(),
                Family::Kernel(shape),
            )?),
        };
        Ok(Self {
            shape,
            width,
            corrected: values.word("boundary").is_some_and(|word| word != "ignore"),
            boundary: values
                .word("boundary")
                .and_then(boundary::named)
                .unwrap_or(Box::new(Ignore)),
            engine: values
                .word("engine")
                .and_then(|word| ENGINES[1..].iter().find(|name| **name == word).copied()),
            tolerance: values.number("tolerance").unwrap_or(EXACT),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_engine_of_the_line_can_be_asked_for() {
        let names: Vec<&str> = LINE.iter().map(|engine| engine.name()).collect();
        assert_eq!(ENGINES[1..], names);
    }
}
