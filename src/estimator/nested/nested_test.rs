//! A calibrated test of whether a ball is as full as the ball around it.

use super::ladder::Ladder;
use super::lepski::rungs;
use super::{Choice, LAWS, MAX, MIN, Rule, convention, fit, middle, told};
use crate::estimator::{
    Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws,
};
use crate::neighbour::Searchable;
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::Point;
use crate::theory::Convention;
use statrs::function::beta::beta_reg;

/// Where the density is even, the share that the ball out to the j-th neighbour has of the ball out to the k-th has the Beta(j, k - j) distribution,
/// exactly. A step from j to k is taken unless the two-sided p-value of that is below the level.
///
/// The test sees what biases a round kernel, and nothing else: a slope leaves the share as it is, rightly. It is the calibrated counterpart of bias compensation, whose p is no
/// probability of error. Both directions are here because they matter more than the test: `halves` tries large balls first, as bias compensation does, and one that is
/// accepted by chance hides the ones in between; `upward` goes up a ladder of k growing by √2 and tests each rung against all below it, sharing the level among them (Bonferroni).
///
/// Points count once each here, whatever they weigh.
#[derive(Clone, Copy, Debug)]
pub struct NestedTest {
    range: (usize, usize),
    convention: Convention,
    level: f64,
    direction: Direction,
}

/// In which order balls are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    Upward,
    Halves,
}

impl Direction {
    const ALL: [Self; 2] = [Self::Upward, Self::Halves];
    const NAMES: [&'static str; 2] = ["upward", "halves"];
}

/// The two-sided p-value of the share of the ball out to neighbour `j` in that out to neighbour `k` > j.
pub(super) fn p_value(share: f64, j: usize, k: usize) -> f64 {
    let below = beta_reg(j as f64, (k - j) as f64, share.clamp(0.0, 1.0));
    (2.0 * below.min(1.0 - below)).min(1.0)
}

impl NestedTest {
    fn upward<const D: usize>(self, ladder: &mut Ladder<'_, D>) -> Choice {
        let (least, most) = (ladder.least(), ladder.most());
        let mut below: Vec<(usize, f64)> = Vec::new();
        let mut accepted = least;
        for k in rungs(least, most) {
            let volume = ladder.volume(k);
            let level = self.level / below.len().max(1) as f64;
            let fits = |&(j, inner): &(usize, f64)| p_value(inner / volume, j, k) >= level;
            if !below.iter().all(fits) {
                break;
            }
            accepted = k;
            below.push((k, volume));
        }
        Choice {
            neighbours: accepted,
            steps: below.len() as u32,
            ended: true,
        }
    }

    fn halves<const D: usize>(self, ladder: &mut Ladder<'_, D>) -> Choice {
        let (mut low, mut high) = (ladder.least(), ladder.most());
        let mut steps = 0;
        while high - low > 1 {
            steps += 1;
            let middle = middle(low, high);
            let share = ladder.volume(low) / ladder.volume(middle);
            if p_value(share, low, middle) >= self.level {
                low = middle;
            } else {
                high = middle;
            }
        }
        Choice {
            neighbours: low,
            steps,
            ended: true,
        }
    }
}

impl<const D: usize> Rule<D> for NestedTest {
    fn range(&self) -> (usize, usize) {
        self.range
    }

    fn first(&self, _target: Point<D>, least: usize, most: usize) -> usize {
        match self.direction {
            Direction::Upward => most,
            Direction::Halves => middle(least, most),
        }
    }

    fn choose(&self, _target: Point<D>, ladder: &mut Ladder<'_, D>) -> Choice {
        match self.direction {
            Direction::Upward => self.upward(ladder),
            Direction::Halves => self.halves(ladder),
        }
    }
}

impl<const D: usize> Estimator<D> for NestedTest
where
    Sample<D>: Searchable<D>,
{
    fn laws(&self) -> Laws {
        LAWS
    }

    fn fit(&self, sample: &Sample<D>) -> Result<Estimate<D>, FitError> {
        fit(sample, self.convention, self)
    }
}

impl Described for NestedTest {
    const NAME: &'static str = "nested-test";
    const SUMMARY: &'static str =
        "nearest neighbours, as many at each place as a test of evenness lets pass";
    const COST: &'static str =
        "O(n + m max) where the data are spread evenly, O(n log n + m max log n) else";
    const REFERENCE: &'static str = "David & Nagaraja 2003, Order Statistics, chapter 2: shares of nested balls have Beta distributions";
    const SMOOTHING: Option<&'static str> = Some("max");
    const PARAMETERS: &'static [Parameter] = &[
        MIN,
        MAX,
        convention("unbiased"),
        Parameter::optional(
            "level",
            Kind::Between(0.0, 1.0),
            Absent::Number(0.01),
            "the probability of stopping at a rung where the density is even",
        )
        .swept(),
        Parameter::optional(
            "direction",
            Kind::Choice(&Direction::NAMES),
            Absent::Word("upward"),
            "small balls first, or halving the range",
        ),
    ];
}

impl<const D: usize> Build<D> for NestedTest
where
    Sample<D>: Searchable<D>,
{
    fn build(values: &Values, _context: &Context<D>) -> Result<Self, BuildError> {
        let (range, convention) = told(values)?;
        let direction = values.word("direction").unwrap_or_default();
        let direction = Direction::NAMES.iter().position(|name| *name == direction);
        Ok(Self {
            range,
            convention,
            level: values.number("level").unwrap_or(0.01),
            direction: direction.map_or(Direction::Upward, |at| Direction::ALL[at]),
        })
    }
}
