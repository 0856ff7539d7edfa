//! What nearest-neighbour estimators share: the ball about each target that holds k points, and what is in it.

use super::{Estimate, FitError};
use crate::neighbour::{Metric, Neighbours, Scratch, Searchable, at_each};
use crate::sample::{Sample, Weights};
use crate::space::{Domain, Evaluation, Field, Point, Targets, Warning};
use std::sync::Arc;

/// The ball about a target out to its neighbour of some rank.
pub(super) struct Ball<'a, const D: usize> {
    target: Point<D>,
    /// The squared distance of the neighbour that counts, positive.
    squared: f64,
    /// Which neighbour it is: k, or the first away from the target where k points or more are at the target itself.
    pub rank: usize,
    finder: &'a dyn Neighbours<D>,
    weights: &'a Sample<D>,
}

/// What lies in a ball, each datum with its weight times what a profile says at its distance.
pub(super) struct Content {
    /// The sum over what is nearer than the neighbour that counts.
    pub inside: f64,
    /// The weight and number of all at the very distance of that neighbour, itself included.
    pub edge: f64,
    pub tied: usize,
    /// How many are nearer.
    pub nearer: usize,
    /// The sum over what is farther.
    pub outside: f64,
}

impl<const D: usize> Ball<'_, D> {
    pub fn radius(&self) -> f64 {
        self.squared.sqrt()
    }

    pub fn metric(&self) -> &Metric<D> {
        self.finder.metric()
    }

    /// The distance to the next neighbour, if there is one.
    pub fn next(&self, scratch: &mut Scratch) -> Option<f64> {
        let next = self.rank + 1;
        (next <= self.finder.count())
            .then(|| self.finder.distance(self.target, next, scratch).sqrt())
    }

    /// The mass of as many nearest points as the rank says. Of those that are equally far, it is not said which is which, so each gives the same share.
    pub fn mass(&self) -> f64 {
        if let Weights::Equal(each) = self.weights.weights() {
            return self.rank as f64 * each;
        }
        let content = self.content(1.0, |_| 1.0);
        let share = (self.rank - content.nearer) as f64 / content.tied as f64;
        share.mul_add(content.edge, content.inside)
    }

    /// What lies within `reach` radii (1 or more), weighted by `profile` of the distance over the radius.
    pub fn content(&self, reach: f64, profile: impl Fn(f64) -> f64) -> Content {
        let mut content = Content {
            inside: 0.0,
            edge: 0.0,
            tied: 0,
            nearer: 0,
            outside: 0.0,
        };
        let radius = self.radius();
        let limit = if reach > 1.0 {
            self.squared * (reach * reach)
        } else {
            self.squared
        };
        self.finder.within(self.target, limit, &mut |i, squared| {
            let weight = self.weights.weight(i);
            if squared < self.squared {
                content.nearer += 1;
                content.inside += weight * profile(squared.sqrt() / radius);
            } else if squared > self.squared {
                content.outside += weight * profile(squared.sqrt() / radius);
            } else {
                content.tied += 1;
                content.edge += weight;
            }
        });
        content
    }
}

/// What an estimator makes of a ball.
pub(super) trait Rule<const D: usize>: Copy + Send + Sync + 'static {
    /// The density at the target.
    fn density(self, ball: &Ball<'_, D>, scratch: &mut Scratch) -> f64;
}

struct Balloon<const D: usize, R> {
    finder: Arc<dyn Neighbours<D>>,
    /// The weights that are summed: those of the total or of one channel. The finder is always of the total.
    weights: Sample<D>,
    k: usize,
    rule: R,
}

/// The estimate from `sample` with the `k`-th neighbour and `rule`; `least` points are needed.
pub(super) fn fit<const D: usize, R: Rule<D>>(
    sample: &Sample<D>,
    k: usize,
    least: usize,
    rule: R,
) -> Result<Estimate<D>, FitError>
where
    Sample<D>: Searchable<D>,
{
    // four structures of a point each, and the sort
    let bytes = 80 * sample.len() as u64;
    crate::memory::check(bytes).map_err(|error| FitError::TooLarge(error.to_string()))?;
    let finder = sample.neighbours();
    let count = finder.count();
    if count < least {
        let beside = if least > k { ", and one more" } else { "" };
        return Err(FitError::Degenerate(format!(
            "k = {k} neighbours{beside} are asked for, and the sample has {count} points of positive weight; k may be from 2 to {}",
            (count + k).saturating_sub(least)
        )));
    }
    let first = (0..sample.len())
        .find(|&i| sample.weight(i) > 0.0)
        .expect("a sample has positive mass");
    let spread = finder.distance(sample.points()[first], count, &mut Scratch::default());
    if spread == 0.0 {
        return Err(FitError::Degenerate(format!(
            "all {count} points are at one place: the {k}-th neighbour there is at distance 0, and the density infinite"
        )));
    }
    let field = |weights: Sample<D>| -> Arc<dyn Field<D>> {
        Arc::new(Balloon {
            finder: finder.clone(),
            weights,
            k,
            rule,
        })
    };
    let channels = (0..sample.channels()).map(|c| field(sample.channel(c)));
    Ok(Estimate::new(field(sample.clone())).with_channels(channels.collect()))
}

impl<const D: usize, R: Rule<D>> Balloon<D, R> {
    /// The value, and whether k points or more are at the target itself.
    fn value(&self, target: Point<D>, scratch: &mut Scratch) -> (f64, bool) {
        let mut rank = self.k;
        let mut squared = self.finder.distance(target, rank, scratch);
        let crowded = squared == 0.0;
        if crowded {
            let mut here = 0;
            self.finder.within(target, 0.0, &mut |_, _| here += 1);
            if here == self.finder.count() {
                // only where all distances are below 1e-162
                return (f64::MAX, true);
            }
            rank = here + 1;
            squared = self.finder.distance(target, rank, scratch);
        }
        let ball = Ball {
            target,
            squared,
            rank,
            finder: &*self.finder,
            weights: &self.weights,
        };
        if squared.is_infinite() {
            return (0.0, crowded); // so far away that the ball has no finite size
        }
        (self.rule.density(&ball, scratch).min(f64::MAX), crowded)
    }
}

impl<const D: usize, R: Rule<D>> Field<D> for Balloon<D, R> {
    fn domain(&self) -> &Domain<D> {
        self.weights.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        self.value(x, &mut Scratch::default()).0
    }

    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        let places: Vec<Point<D>> = targets.places().collect();
        let values = at_each(&places, |x, scratch| self.value(x, scratch));
        let crowded = values.iter().filter(|(_, crowded)| *crowded).count();
        let mut warnings = Vec::new();
        if crowded > 0 {
            warnings.push(Warning {
                what: format!(
                    "at {crowded} of {} places at least k = {} points are at the place itself, where the distance to the k-th is 0: \
                     there the first neighbour farther away was taken instead",
                    places.len(),
                    self.k
                ),
                hint: format!(
                    "take k above the number of points at one place, or undo the rounding of the data; the values there say only that the density is high (finder: {})",
                    self.finder.name()
                ),
            });
        }
        Evaluation {
            values: values.into_iter().map(|(value, _)| value).collect(),
            engine: Some(self.finder.name()),
            warnings,
            ..Evaluation::default()
        }
    }
}
