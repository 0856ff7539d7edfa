//! Adaptive nearest-neighbour estimates: at each place a ladder of nested estimates, and a rule that says how far up to go.
//!
//! The estimates from the 50, the 51, ... nearest points of one place are nested: each has less noise than the one before, and perhaps more bias. A [`Rule`] walks this
//! ladder at one place, looking at nothing but the data there, and names the number of neighbours that it accepts. Everything else (gathering the
//! neighbours once, the estimate of any rung in any convention, weights, channels, ties, places where points coincide) is done here, once for all rules.
//!
//! | rule | what stops it | file |
//! |---|---|---|
//! | bias compensation | a step that is large against the spread of the steps so far, by a throw of dice | `bias_compensated.rs` |
//! | the same as first printed | does not stop | `as_printed.rs` |
//! | intersection of confidence intervals | no value agrees with all intervals so far | `lepski.rs` |
//! | two-stage plug-in | nothing: a pilot estimate said how far | `two_stage.rs` |
//! | nested test | a ball that is too full or too empty for the ball around it | `nested_test.rs` |
//!
//! **Weights and channels.** Which points are neighbours, and how many are taken, does not depend on the channel: it is decided once, and serves the total and every
//! channel. A rule that compares values looks at all channels of a sample that has them.
//!
//! **Cost.** One gathering of the most neighbours that a rule may ask for, O(max), a place, or of fewer where fewer decide and at most one more where they do not; a rung costs O(log max) on average. The same sample and place give the
//! same bits for any number of threads.
//!
//! # References
//! Schregle 2003, Bias compensation for photon maps, Computer Graphics Forum 22; Lepski 1991, Theory of Probability and its Applications 35; Goldenshluger & Nemirovski 1997,
//! Mathematical Methods of Statistics 6 (intersection of intervals).

mod acceptance;
mod as_printed;
mod bias_compensated;
mod ladder;
mod lepski;
mod nested_test;
#[cfg(test)]
mod tests;
mod two_stage;

pub use bias_compensated::BiasCompensated;
pub use lepski::Lepski;
pub use nested_test::NestedTest;
pub use two_stage::TwoStage;

use super::{Estimate, FitError, Laws};
use crate::neighbour::{Nearest, Neighbours, Searchable};
use crate::parameter::{Absent, BuildError, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Evaluation, Field, Point, Targets, Warning};
use crate::theory::Convention;
use ladder::Ladder;
use rayon::prelude::*;
use std::sync::Arc;

/// What a rule decided at one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// How many neighbours.
    pub neighbours: usize,
    /// Steps that the rule took.
    pub steps: u32,
    /// Whether the rule came to an end by itself.
    pub ended: bool,
}

/// Walks the ladder at one place and says where to stop.
pub trait Rule<const D: usize>: Clone + Send + Sync + 'static {
    /// The fewest neighbours it accepts, at least 2, and the most.
    fn range(&self) -> (usize, usize);

    /// How many neighbours it looks at before it decides whether to look further, from `least` to `most`: so many are gathered, and all only where they are asked for. Nothing but the
    /// cost depends on it.
    fn first(&self, _target: Point<D>, _least: usize, most: usize) -> usize {
        most
    }

    /// How many neighbours it accepts: from `ladder.least()` to `ladder.most()`. `target` is for rules that throw dice.
    fn choose(&self, target: Point<D>, ladder: &mut Ladder<'_, D>) -> Choice;
}

/// The estimate with the number of neighbours that a rule chooses at each place.
struct Adaptive<const D: usize, R> {
    finder: Arc<dyn Neighbours<D>>,
    /// What the rule looks at: the channels, or the total where there are none.
    seen: Arc<[Sample<D>]>,
    /// What is estimated.
    shown: Sample<D>,
    convention: Convention,
    rule: R,
}

/// What is found at one place.
struct Value {
    density: f64,
    /// The radius of the ball.
    radius: f64,
    choice: Option<Choice>,
    /// So many points are at the place itself that the rule had to begin beyond them.
    crowded: bool,
}

/// The estimate from `sample` by `rule`.
fn fit<const D: usize, R: Rule<D>>(
    sample: &Sample<D>,
    convention: Convention,
    rule: &R,
) -> Result<Estimate<D>, FitError>
where
    Sample<D>: Searchable<D>,
{
    let bytes = 80 * sample.len() as u64;
    crate::memory::check(bytes).map_err(|error| FitError::TooLarge(error.to_string()))?;
    let finder = sample.neighbours();
    let count = finder.count();
    let (min, max) = rule.range();
    if count < 3 {
        return Err(FitError::Degenerate(format!(
            "an adaptive nearest-neighbour estimate takes at least 3 points of positive weight, and the sample has {count}"
        )));
    }
    let first = (0..sample.len())
        .find(|&i| sample.weight(i) > 0.0)
        .expect("a sample has positive mass");
    let spread = finder.distance(
        sample.points()[first],
        count,
        &mut crate::neighbour::Scratch::default(),
    );
    if spread == 0.0 {
        return Err(FitError::Degenerate(format!(
            "all {count} points are at one place: no ball about it has a size, and the density there is infinite"
        )));
    }
    let channels: Vec<Sample<D>> = (0..sample.channels()).map(|c| sample.channel(c)).collect();
    let seen: Arc<[Sample<D>]> = if channels.is_empty() {
        Arc::new([sample.clone()])
    } else {
        channels.clone().into()
    };
    let field = |shown: Sample<D>| -> Arc<dyn Field<D>> {
        Arc::new(Adaptive {
            finder: finder.clone(),
            seen: seen.clone(),
            shown,
            convention,
            rule: rule.clone(),
        })
    };
    let mut estimate = Estimate::new(field(sample.clone()))
        .with_channels(channels.into_iter().map(field).collect());
    if count <= min {
        estimate.warnings.push(Warning {
            what: format!(
                "the sample has {count} points of positive weight, no more than the least number of neighbours: there is nothing to choose"
            ),
            hint: format!("use fewer than {count} for `min`, or more points"),
        });
    } else if count <= max {
        estimate.warnings.push(Warning {
            what: format!(
                "the sample has {count} points of positive weight, no more than `max`: up to {} neighbours are taken",
                count - 1
            ),
            hint: format!("choose `max` below {count}, or use more points"),
        });
    }
    Ok(estimate)
}

impl<const D: usize, R: Rule<D>> Adaptive<D, R> {
    fn value(&self, target: Point<D>, nearest: &mut Nearest) -> Value {
        let all = self.finder.count();
        let (min, max) = self.rule.range();
        // one more than may be taken, for the mean radius
        let first = self.rule.first(target, min, max).clamp(min, max);
        let first = (first + 1).min(all);
        nearest.gather(&*self.finder, target, first);
        let mut here = 0;
        if nearest.squared(min.min(first)) == 0.0 {
            self.finder.within(target, 0.0, &mut |_, _| here += 1);
            if here == all {
                // only where all distances are below 1e-162
                return Value {
                    density: f64::MAX,
                    radius: 0.0,
                    choice: None,
                    crowded: true,
                };
            }
        }
        let mut ladder = Ladder::new(
            nearest,
            (&*self.finder, target),
            &self.seen,
            self.convention,
            (min, max),
            here,
        );
        if ladder.is_endless() {
            return Value {
                density: 0.0, // so far away that the ball has no finite size
                radius: f64::INFINITY,
                choice: None,
                crowded: here > 0,
            };
        }
        let choice = self.rule.choose(target, &mut ladder);
        let (density, radius) = ladder.show(&self.shown, choice.neighbours);
        Value {
            density: density.min(f64::MAX),
            radius,
            choice: Some(choice),
            crowded: here > 0,
        }
    }

    fn warnings(values: &[Value]) -> Vec<Warning> {
        let many = values.len();
        let mut warnings = Vec::new();
        let crowded = values.iter().filter(|value| value.crowded).count();
        if crowded > 0 {
            warnings.push(Warning {
                what: format!(
                    "at {crowded} of {many} places so many points coincide that the least ball has no size: there the rule began at the first neighbour farther away"
                ),
                hint: "undo the rounding of the data, or choose `min` above the number of points at one place".to_owned(),
            });
        }
        let endless = values
            .iter()
            .filter(|value| value.choice.is_some_and(|choice| !choice.ended))
            .count();
        if endless > 0 {
            warnings.push(Warning {
                what: format!(
                    "at {endless} of {many} places the rule went round in circles and was stopped"
                ),
                hint: "the rule as printed does not terminate; use the corrected one".to_owned(),
            });
        }
        warnings
    }
}

impl<const D: usize, R: Rule<D>> Field<D> for Adaptive<D, R> {
    fn domain(&self) -> &Domain<D> {
        self.shown.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        self.value(x, &mut Nearest::default()).density
    }

    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        /// Long enough to be worth sending to a thread, short enough to share the work evenly.
        const BLOCK: usize = 64;
        let places: Vec<Point<D>> = targets.places().collect();
        let blocks: Vec<Vec<Value>> = places
            .par_chunks(BLOCK)
            .map_init(Nearest::default, |nearest, block| {
                block.iter().map(|&x| self.value(x, nearest)).collect()
            })
            .collect();
        let values: Vec<Value> = blocks.into_iter().flatten().collect();
        Evaluation {
            warnings: Self::warnings(&values),
            sizes: Some(values.iter().map(|value| value.radius).collect()),
            values: values.into_iter().map(|value| value.density).collect(),
            engine: Some(self.finder.name()),
            ..Evaluation::default()
        }
    }
}

/// ⌊(low + high)/2⌋.
fn middle(low: usize, high: usize) -> usize {
    low + (high - low) / 2
}

/// What holds of every adaptive estimate, apart from what dice that are thrown by the place do.
const LAWS: Laws = Laws {
    mass_conserving: false,
    non_negative: true,
    linear: false,
    reproduces_constants: false,
    reproduces_linear: false,
    continuous: false,
    deterministic: true,
    scale_equivariant: true,
    translation_equivariant: true,
    repeatable: false,
};

/// The fewest neighbours.
const MIN: Parameter = Parameter::required(
    "min",
    Kind::Count {
        least: 2,
        most: 1_000_000_000,
    },
    "the fewest neighbours that are taken",
);

/// The most neighbours.
const MAX: Parameter = Parameter::required(
    "max",
    Kind::Count {
        least: 2,
        most: 1_000_000_000,
    },
    "the most neighbours that are taken, not below `min`",
)
.swept();

/// How neighbours become a density.
const fn convention(default: &'static str) -> Parameter {
    Parameter::optional(
        "convention",
        Kind::Choice(&Convention::NAMES),
        Absent::Word(default),
        "(k - 1)/(n V), k/(n V), or k over the ball of the mean radius of neighbours k and k + 1",
    )
}

/// The values of [`MIN`], [`MAX`] and [`convention`].
fn told(values: &Values) -> Result<((usize, usize), Convention), BuildError> {
    let count = |name: &str| {
        let count = values.count(name).unwrap_or(2);
        usize::try_from(count).unwrap_or(usize::MAX)
    };
    let (min, max) = (count("min"), count("max"));
    if max < min {
        return Err(BuildError {
            parameter: "max",
            what: format!("`max` = {max} is below `min` = {min}"),
        });
    }
    let convention = values
        .word("convention")
        .and_then(Convention::named)
        .unwrap_or(Convention::Unbiased);
    Ok(((min, max), convention))
}
