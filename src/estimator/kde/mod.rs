//! The kernel estimator: a selector, a kernel, a boundary and an engine plugged together.

mod plane;

use super::width::best;
use super::{Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws, Moments};
use crate::boundary::{self, Boundary, Bump, Equivalent, Ignore, corrected_moments};
use crate::density::Density;
use crate::engine::{EXACT, Engine, LINE, Planned};
use crate::kernel::{Bandwidth, KernelSum, Shape, Symmetry};
use crate::numeric::Sum;
use crate::parameter::{Absent, Kind, Parameter, Values, listed};
use crate::sample::Sample;
use crate::selector::{self, FixedCount, LeastIse, Selector};
use crate::space::{Domain, Evaluation, Field, Point, Targets};
use crate::theory::{Family, kernel_moments};
use rayon::prelude::*;
use std::sync::Arc;

/// Where the bandwidth comes from.
enum Width<const D: usize> {
    Numbers([f64; D]),
    Selected(Box<dyn Selector<D>>),
}

/// f̂(x) = Σ wᵢ K((x - Xᵢ)/h) / h. [Rosenblatt 1956; Parzen 1962; Silverman 1986, eq. 2.2a]
///
/// In the plane the kernel is a product over the axes, as in most software, or radial, a function of the distance \[Silverman 1986, eq. 4.1; Wand & Jones 1995,
/// section 4.2\]; the radial kernels are up to 5 % more efficient (see [`Symmetry::efficiency`]). A width for each axis makes ellipses of discs.
pub struct Kde<const D: usize = 1> {
    shape: Shape,
    symmetry: Symmetry,
    width: Width<D>,
    boundary: Box<dyn Boundary<D>>,
    /// Whether walls are seen to: the exact theory is of estimates that ignore them.
    corrected: bool,
    /// The engine that is forced, if any.
    engine: Option<&'static str>,
    /// What an engine may be off by, relative to the ceiling of the sum.
    tolerance: f64,
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
            // not `max`, which would hide what is not a number; no branch, so that it is done to several at a time
            *value = if *value < 0.0 { 0.0 } else { *value };
        }
        evaluation
    }
}

impl<const D: usize> Kde<D> {
    pub(super) fn promises(&self) -> Laws {
        let walls = self.boundary.promises();
        Laws {
            // what is laid beyond walls that are ignored is there
            mass_conserving: !self.corrected || walls.mass_conserving,
            non_negative: walls.non_negative,
            linear: walls.linear && matches!(self.width, Width::Numbers(_)),
            reproduces_constants: walls.reproduces_constants,
            reproduces_linear: walls.reproduces_lines,
            continuous: self.shape != Shape::Uniform,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: matches!(self.width, Width::Numbers(_)),
        }
    }

    /// Σ wᵢ² (κ(x, Xᵢ) - f̂(x)/m)² n/(n - 1) with m the mass and n the effective size: for equal weights the sample variance of the bumps over n. By
    /// definition, O(n) a place.
    pub(super) fn plug_in(
        &self,
        estimate: &Estimate<D>,
        sample: &Sample<D>,
        places: &[Point<D>],
    ) -> Option<Vec<f64>> {
        let Some(Bandwidth::Fixed(width)) = estimate.bandwidth else {
            return None;
        };
        let bump = Bump {
            shape: self.shape,
            symmetry: self.symmetry,
            width,
        };
        // nothing is known of the chance of what was registered beyond
        if self.boundary.sees_beyond() && sample.margin().next().is_some() {
            return None;
        }
        let (domain, n) = (sample.domain(), sample.effective_size());
        let at = |x: &Point<D>| -> Option<f64> {
            let kernel: Equivalent<'_, D> = if self.corrected && domain.has_walls() {
                if !domain.contains(*x) {
                    return Some(0.0);
                }
                self.boundary.equivalent(&bump, domain, *x)?
            } else {
                Box::new(|y| bump.value(*x, y))
            };
            let (mut weighted, mut squares) = (Sum::default(), [0.0; 3]);
            for (i, y) in sample.points().iter().enumerate() {
                let (w, k) = (sample.weight(i), kernel(*y));
                weighted.add(w * k);
                for (power, sum) in squares.iter_mut().enumerate() {
                    *sum += w * w * k.powi(power as i32);
                }
            }
            let mean = weighted.value() / sample.mass();
            let around = squares[2] - 2.0 * mean * squares[1] + mean * mean * squares[0];
            // one point says nothing about its spread
            Some((around * n / (n - 1.0)).max(0.0)).filter(|v| v.is_finite())
        };
        places.par_iter().map(at).collect()
    }

    /// The estimate from `sample`, computed by one of `engines`.
    pub(super) fn estimate(
        &self,
        sample: &Sample<D>,
        engines: &'static [&'static dyn Engine<D>],
    ) -> Result<Estimate<D>, FitError> {
        let (bandwidth, warnings) = match &self.width {
            Width::Numbers(h) => (Bandwidth::Fixed(*h), Vec::new()),
            Width::Selected(selector) => {
                let selection = selector.select(sample, self.shape)?;
                (selection.bandwidth, selection.warnings)
            }
        };
        let field = |sample: Sample<D>| -> Result<Arc<dyn Field<D>>, FitError> {
            let sum =
                KernelSum::new(sample, self.shape, bandwidth.clone())?.with_symmetry(self.symmetry);
            let compute = |sum| -> Box<dyn Field<D>> {
                let planned = Planned::new(engines, sum, self.tolerance, self.engine);
                Box::new(NonNegative(
                    planned.expect("only known engines are built in"),
                ))
            };
            if sum.sample().mass() <= 0.0 {
                // a dark channel: there is nothing to mirror or to divide
                return Ok(compute(sum).into());
            }
            Ok(boundary::apply(&*self.boundary, sum, &compute)?.into())
        };
        let mut estimate = Estimate::new(field(sample.clone())?).with_channels(
            (0..sample.channels())
                .map(|c| field(sample.channel(c)))
                .collect::<Result<_, _>>()?,
        );
        if let Bandwidth::Fixed(h) = bandwidth {
            // one number only where it is one for all axes
            let same = h.windows(2).all(|pair| pair[0].total_cmp(&pair[1]).is_eq());
            estimate.smoothing = h.first().copied().filter(|_| same);
        }
        estimate.bandwidth = Some(bandwidth);
        estimate.warnings = warnings;
        Ok(estimate)
    }
}

impl Estimator<1> for Kde {
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
        let Width::Numbers([h]) = self.width else {
            return None;
        };
        if truth.domain().wraps() {
            return None;
        }
        if !self.corrected || !truth.domain().has_walls() {
            let at = |&[x]: &Point<1>| kernel_moments(truth, self.shape, h, draws as f64, x);
            return Some(places.iter().map(at).collect());
        }
        if !self.boundary.promises().linear {
            return None;
        }
        let bump = Bump {
            shape: self.shape,
            symmetry: Symmetry::Product,
            width: [h],
        };
        let at = |&[x]: &Point<1>| corrected_moments(&*self.boundary, &bump, truth, draws, x);
        places.iter().map(at).collect()
    }

    fn variance(
        &self,
        estimate: &Estimate<1>,
        sample: &Sample<1>,
        places: &[Point<1>],
    ) -> Option<Vec<f64>> {
        (!sample.domain().wraps()).then(|| self.plug_in(estimate, sample, places))?
    }

    fn family(&self) -> Option<Family> {
        (!self.corrected).then_some(Family::Kernel(self.shape))
    }
}

/// Free choice, or one of the engines of the line or of the plane by name.
const ENGINES: [&str; 11] = [
    "auto", "direct", "interval", "sorted", "hermite", "binned", "relay", "scatter", "gather",
    "splat", "mesh",
];

/// The engine that `values` ask for, if any and if there is one of that name among `engines`.
fn engine<const D: usize>(
    values: &Values,
    engines: &[&'static dyn Engine<D>],
) -> Result<Option<&'static str>, BuildError> {
    let Some(word) = values.word("engine").filter(|word| *word != "auto") else {
        return Ok(None);
    };
    let names: Vec<&'static str> = engines.iter().map(|engine| engine.name()).collect();
    let found = names.iter().find(|name| **name == word);
    found.copied().map(Some).ok_or_else(|| BuildError {
        parameter: "engine",
        what: format!(
            "no engine {} is called `{word}`; there are {}",
            if D == 1 {
                "of the line"
            } else {
                "of the plane"
            },
            listed(&names)
        ),
    })
}

/// Kernels of the plane; on the line there is nothing to choose.
pub(super) const SYMMETRY: Parameter = Parameter::optional(
    "symmetry",
    Kind::Choice(&Symmetry::NAMES),
    Absent::Unset,
    "a kernel of each axis (product, if not given) or one of the distance (radial)",
)
.only_in(2);

/// The width on the second axis.
pub(super) const BANDWIDTH_Y: Parameter = Parameter::optional(
    "bandwidth-y",
    Kind::Positive,
    Absent::Unset,
    "h on the second axis, in the unit of the data; as on the first if not given",
)
.length()
.only_in(2);

/// What the rule "walter" is told.
const EXPECTED: Parameter = Parameter::optional(
    "expected",
    Kind::Positive,
    Absent::Unset,
    "with bandwidth = \"walter\": how many points the support holds if they are even; 20 if not given",
)
.only_in(2);

/// The bandwidth of the kernel estimator and its kin.
pub(super) const BANDWIDTH: Parameter = Parameter::required(
    "bandwidth",
    Kind::PositiveOr(&selector::WORDS),
    "h, in the unit of the data: half the support of a compact kernel, the deviation of the Gaussian",
)
.length()
.swept();

impl<const D: usize> Described for Kde<D>
where
    Self: Estimator<D>,
{
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
        BANDWIDTH_Y,
        EXPECTED,
        SYMMETRY,
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
        let word = values.word("bandwidth");
        let chosen = match (word, &context.truth) {
            (Some("oracle-ise"), Some(truth)) => Some(Box::new(LeastIse {
                truth: truth.clone(),
            }) as Box<dyn Selector<1>>),
            (Some(FixedCount::NAME), _) => Some(Box::new(FixedCount::new(
                FixedCount::DEFAULT,
                Symmetry::Product,
            )) as Box<dyn Selector<1>>),
            _ => word.and_then(selector::named),
        };
        let width = match (values.number("bandwidth"), chosen) {
            (Some(h), _) => Width::Numbers([h]),
            (None, Some(selector)) => Width::Selected(selector),
            (None, None) if word.is_some_and(|word| selector::plane_entry_of(word).is_some()) => {
                return Err(BuildError {
                    parameter: "bandwidth",
                    what: format!(
                        "\"{}\" is a rule of the plane: on the line give `lscv`",
                        word.unwrap_or_default()
                    ),
                });
            }
            (None, None) => Width::Numbers([best(
                context,
                "bandwidth",
                word.unwrap_or_default(),
                Family::Kernel(shape),
            )?]),
        };
        Ok(Self {
            shape,
            symmetry: Symmetry::Product,
            width,
            corrected: values.word("boundary").is_some_and(|word| word != "ignore"),
            boundary: values
                .word("boundary")
                .and_then(boundary::named)
                .unwrap_or(Box::new(Ignore)),
            engine: engine(values, LINE)?,
            tolerance: values.number("tolerance").unwrap_or(EXACT),
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::engine::PLANE;
    use crate::parameter::Value;
    use crate::space::Grid;

    #[test]
    fn every_engine_can_be_asked_for() {
        let line = LINE.iter().map(|engine| engine.name());
        let plane = PLANE.iter().map(|engine| engine.name());
        let mut names: Vec<&str> = line.chain(plane).collect();
        let mut choices = ENGINES[1..].to_vec();
        names.sort_unstable();
        names.dedup();
        choices.sort_unstable();
        assert_eq!(choices, names);
    }

    fn values(set: &[(&'static str, Value)]) -> Values {
        let mut values = Values::defaults(Kde::<2>::PARAMETERS);
        for (name, value) in set {
            values.set(name, value.clone());
        }
        values
    }

    fn built(set: &[(&'static str, Value)]) -> Result<Kde<2>, BuildError> {
        let context = Context {
            truth: None,
            draws: 50,
        };
        <Kde<2> as Build<2>>::build(&values(set), &context)
    }

    fn word(word: &str) -> Value {
        Value::Word(word.to_owned())
    }

    fn sample() -> Sample<2> {
        let points = (0..300)
            .map(|i| {
                let t = f64::from(i);
                [(t * 0.618_034).fract(), 3.0 * (t * 0.414_214).fract()]
            })
            .collect();
        Sample::equal(points, Domain::whole()).unwrap()
    }

    #[test]
    fn the_plane_has_a_width_for_each_axis_and_two_symmetries() {
        let grid = Grid::new([-2.0, -5.0], [3.0, 8.0], [200, 260]).unwrap();
        let number = |h: f64| Value::Number(h);
        for symmetry in Symmetry::NAMES {
            let kde = built(&[
                ("shape", word("epanechnikov")),
                ("bandwidth", number(0.5)),
                ("bandwidth-y", number(1.5)),
                ("symmetry", word(symmetry)),
            ])
            .unwrap();
            let estimate = kde.fit(&sample()).unwrap();
            let mass = estimate.on(&grid).integral();
            assert!((mass - 1.0).abs() < 1e-3, "{symmetry}: {mass}");
            assert_eq!(estimate.smoothing, None);
            let expected =
                KernelSum::new(sample(), Shape::Epanechnikov, Bandwidth::Fixed([0.5, 1.5]))
                    .unwrap()
                    .with_symmetry(Symmetry::named(symmetry).unwrap());
            let place = [0.9, 2.8];
            assert!((estimate.at(place) / expected.at(place) - 1.0).abs() < 1e-12);
        }
        let one = built(&[("bandwidth", number(0.5))]).unwrap();
        assert_eq!(one.fit(&sample()).unwrap().smoothing, Some(0.5));
    }

    #[test]
    fn rules_choose_both_widths_and_what_is_unknown_in_the_plane_is_said() {
        let ruled = built(&[("bandwidth", word("scott"))]).unwrap();
        let estimate = ruled.fit(&sample()).unwrap();
        let Some(Bandwidth::Fixed([h, k])) = estimate.bandwidth else {
            panic!("two numbers")
        };
        assert!((k / h - 3.0).abs() < 0.1, "{h} {k}");
        assert!(!ruled.laws().linear);
        let refused = |set: &[(&'static str, Value)]| built(set).err().unwrap();
        let both = refused(&[
            ("bandwidth", word("scott")),
            ("bandwidth-y", Value::Number(1.0)),
        ]);
        assert_eq!(both.parameter, "bandwidth-y");
        let oracle = refused(&[("bandwidth", word("amise"))]);
        assert!(oracle.what.contains("not known"), "{}", oracle.what);
        let engine = refused(&[
            ("bandwidth", Value::Number(1.0)),
            ("engine", word("sorted")),
        ]);
        assert!(engine.what.contains("`splat`"), "{}", engine.what);
    }
}
