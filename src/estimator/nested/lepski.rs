//! Lepski's rule: the largest ball whose estimate agrees with those of all smaller ones.

use super::ladder::Ladder;
use super::{Choice, LAWS, MAX, MIN, Rule, convention, fit, told};
use crate::estimator::{
    Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws,
};
use crate::neighbour::Searchable;
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::Point;
use crate::theory::Convention;

/// Goes up a ladder of k growing by √2 and takes the last k at which the intervals f_k (1 ± c/√k) of all rungs so far still have a point in common.
///
/// f_k has the relative standard deviation 1/√k where the density is even, so as long as the bias is below that the intervals meet; where the bias takes over, the new
/// interval leaves the others behind. The one number c is how many deviations an interval has; 1.5 is a good compromise, larger values smooth more.
/// With unequal weights k is the number of equally heavy points that would tell as much. Channels are decided together, by their total.
///
/// No dice, no search by halves: rungs are seen from the bottom, so that a large ball that happens to agree is not reached over one that did not. [Lepski 1991; Goldenshluger & Nemirovski 1997]
#[derive(Clone, Copy, Debug)]
pub struct Lepski {
    range: (usize, usize),
    convention: Convention,
    deviations: f64,
}

/// The rungs of a ladder from `low` to `high`, each √2 times the one before, the last one `high` itself.
pub(super) fn rungs(low: usize, high: usize) -> impl Iterator<Item = usize> {
    let mut next = Some(low);
    std::iter::from_fn(move || {
        let here = next?;
        next = (here < high).then(|| {
            let up = (here as f64 * std::f64::consts::SQRT_2).round() as usize;
            up.max(here + 1).min(high)
        });
        Some(here)
    })
}

impl<const D: usize> Rule<D> for Lepski {
    fn range(&self) -> (usize, usize) {
        self.range
    }

    fn choose(&self, _target: Point<D>, ladder: &mut Ladder<'_, D>) -> Choice {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut accepted = ladder.least();
        let mut steps = 0;
        for k in rungs(ladder.least(), ladder.most()) {
            let f: f64 = (0..ladder.channels())
                .map(|channel| ladder.estimate(channel, k))
                .sum();
            let relative = self.deviations / ladder.effective(k).sqrt();
            low = low.max(f * (1.0 - relative));
            high = high.min(f * (1.0 + relative));
            if low > high {
                break;
            }
            accepted = k;
            steps += 1;
        }
        Choice {
            neighbours: accepted,
            steps,
            ended: true,
        }
    }
}

impl<const D: usize> Estimator<D> for Lepski
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

impl Described for Lepski {
    const NAME: &'static str = "lepski";
    const SUMMARY: &'static str =
        "nearest neighbours, as many at each place as the estimates from fewer of them agree with";
    const COST: &'static str =
        "O(n + m max) where the data are spread evenly, O(n log n + m max log n) else";
    const REFERENCE: &'static str =
        "Lepski 1991; Goldenshluger & Nemirovski 1997 (intersection of confidence intervals)";
    const SMOOTHING: Option<&'static str> = Some("max");
    const PARAMETERS: &'static [Parameter] = &[
        MIN,
        MAX,
        convention("unbiased"),
        Parameter::optional(
            "deviations",
            Kind::Positive,
            Absent::Number(1.5),
            "half of an interval in standard deviations of an estimate where the density is even",
        )
        .swept(),
    ];
}

impl<const D: usize> Build<D> for Lepski
where
    Sample<D>: Searchable<D>,
{
    fn build(values: &Values, _context: &Context<D>) -> Result<Self, BuildError> {
        let (range, convention) = told(values)?;
        Ok(Self {
            range,
            convention,
            deviations: values.number("deviations").unwrap_or(1.5),
        })
    }
}
