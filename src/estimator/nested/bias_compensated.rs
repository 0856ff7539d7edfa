//! Bias compensation.

use super::acceptance::{Acceptance, Dice};
use super::as_printed::AsPrinted;
use super::ladder::Ladder;
use super::{Choice, LAWS, MAX, MIN, Rule, convention, fit, middle, told};
use crate::estimator::{
    Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws,
};
use crate::neighbour::Searchable;
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::Point;
use crate::theory::Convention;

/// Searches the number of neighbours by halving the range from `min` to `max`: a step up to the middle is taken with the probability exp(-e²/(2 s²)), where e is how far the
/// estimate there is from the weighted mean μ of the estimates seen so far, and s² their weighted variance. [Schregle 2003]
///
/// Seen are at first the estimates f₁ ... f_min, then every one that was accepted; the weight of f_j is w(j), so that later ones, which are less noisy, count more:
///
/// ```text
/// μ = Σ w(j) f_j / Σ w(j)      s² = Σ w(j) (f_j - μ)² / Σ w(j)
/// low = min, high = max;  while high - low > 1:
///     mid = ⌊(low + high)/2⌋;  p = exp(-(f_mid - μ)²/(2 s²))
///     with probability p: f_mid joins those seen, low = mid;  else high = mid
/// f̂ = f_low, the last that was accepted
/// ```
///
/// In a sample with channels p is the mean over the channels that have light. The search takes at most ⌈log₂(max - min)⌉ steps.
///
/// **What it is not.** p is no error probability: nested estimates are strongly correlated, and s² is the spread among those seen, not the variance of f_mid. On an even density the search
/// stops long before `max` in nine cases of ten, and the dice add to the variance; `acceptance` says whether they are thrown anew for each sample, belong to the place,
/// or are replaced by p > 1/2. f₁ and f₂ have infinite variance, which is why w must grow.
///
/// `variant = "as-printed"` is the procedure as the lecture's slide has it; see there what happens.
#[derive(Clone, Copy, Debug)]
pub struct BiasCompensated {
    range: (usize, usize),
    convention: Convention,
    weighting: Weighting,
    dice: Dice,
    as_printed: bool,
}

/// How much the estimate from j neighbours counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// j²
    Square,
    /// 1
    Even,
    /// j
    Linear,
    /// j³
    Cube,
    /// exp(0.003 j)
    Exponential,
}

impl Weighting {
    const ALL: [Self; 5] = [
        Self::Square,
        Self::Even,
        Self::Linear,
        Self::Cube,
        Self::Exponential,
    ];
    const NAMES: [&'static str; 5] = ["square", "even", "linear", "cube", "exponential"];

    /// The rate of the exponential. [Schregle 2003]
    const RATE: f64 = 0.003;

    pub(super) fn of(self, j: usize) -> f64 {
        let j = j as f64;
        match self {
            Self::Even => 1.0,
            Self::Linear => j,
            Self::Square => j * j,
            Self::Cube => j * j * j,
            // against overflow where many thousand neighbours are seen
            Self::Exponential => (Self::RATE * j).min(600.0).exp(),
        }
    }
}

/// The weighted mean and variance of what was seen in one channel, by updating. [West 1979]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Seen {
    weight: f64,
    mean: f64,
    squares: f64,
}

impl Seen {
    pub fn add(&mut self, value: f64, weight: f64) {
        self.weight += weight;
        let ahead = value - self.mean;
        let step = ahead * (weight / self.weight);
        self.mean += step;
        self.squares += weight * ahead * (ahead - step);
    }

    /// exp(-e²/(2 s²)) of a value; `None` in a channel that is dark, which says nothing.
    pub fn probability(&self, value: f64) -> Option<f64> {
        let error = value - self.mean;
        let variance = self.squares / self.weight;
        if self.mean == 0.0 && variance == 0.0 && value == 0.0 {
            return None;
        }
        if error == 0.0 {
            return Some(1.0);
        }
        // all seen were equal, and this one is not: 0, as the limit is
        Some((-0.5 * error * error / variance).exp())
    }
}

/// The estimates f₁ ... f_k of every channel, taken in with their weights.
pub(super) fn history<const D: usize>(
    ladder: &mut Ladder<'_, D>,
    k: usize,
    weighting: Weighting,
) -> Vec<Seen> {
    (0..ladder.channels())
        .map(|channel| {
            let mut seen = Seen::default();
            ladder.each_up_to(channel, k, |j, value| {
                // balls without size, where points coincide with the place
                if value.is_finite() {
                    seen.add(value, weighting.of(j));
                }
            });
            seen
        })
        .collect()
}

/// The mean probability over the channels that have light.
pub(super) fn probability(seen: &[Seen], values: &[f64]) -> f64 {
    let (mut sum, mut lit) = (0.0, 0.0);
    for (seen, &value) in seen.iter().zip(values) {
        if let Some(p) = seen.probability(value) {
            sum += p;
            lit += 1.0;
        }
    }
    if lit > 0.0 { sum / lit } else { 1.0 }
}

/// The values of every channel at a rung.
pub(super) fn values<const D: usize>(ladder: &mut Ladder<'_, D>, k: usize) -> Vec<f64> {
    (0..ladder.channels())
        .map(|channel| ladder.estimate(channel, k))
        .collect()
}

impl<const D: usize> Rule<D> for BiasCompensated {
    fn range(&self) -> (usize, usize) {
        self.range
    }

    fn first(&self, _target: Point<D>, least: usize, most: usize) -> usize {
        // most searches turn down here
        middle(least, most)
    }

    fn choose(&self, target: Point<D>, ladder: &mut Ladder<'_, D>) -> Choice {
        let (mut low, mut high) = (ladder.least(), ladder.most());
        let mut seen = history(ladder, low, self.weighting);
        let mut dice = self.dice.at(target, || ladder.volume(high));
        let mut steps = 0;
        while high - low > 1 {
            steps += 1;
            let middle = middle(low, high);
            let here = values(ladder, middle);
            if dice.accept(probability(&seen, &here)) {
                for (seen, value) in seen.iter_mut().zip(here) {
                    seen.add(value, self.weighting.of(middle));
                }
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

impl BiasCompensated {
    /// With the weights of the reference implementation, the mean radius and dice that belong to the place; 2 ≤ `min` ≤ `max`.
    pub fn new(min: usize, max: usize) -> Self {
        Self {
            range: (min, max),
            convention: Convention::MeanRadius,
            weighting: Weighting::Square,
            dice: Dice::new(Acceptance::Seeded, 0),
            as_printed: false,
        }
    }
}

impl<const D: usize> Estimator<D> for BiasCompensated
where
    Sample<D>: Searchable<D>,
{
    fn laws(&self) -> Laws {
        let rigid = !self.dice.depends_on_place() || self.range.0 == self.range.1;
        Laws {
            // another name of the place is another throw
            scale_equivariant: rigid,
            translation_equivariant: rigid,
            ..LAWS
        }
    }

    fn fit(&self, sample: &Sample<D>) -> Result<Estimate<D>, FitError> {
        if self.as_printed {
            let rule = AsPrinted::new(self.range, self.weighting, self.dice);
            return fit(sample, self.convention, &rule);
        }
        fit(sample, self.convention, self)
    }
}

impl Described for BiasCompensated {
    const NAME: &'static str = "bias-compensated";
    const SUMMARY: &'static str =
        "nearest neighbours whose number is searched at each place until the estimate drifts";
    const COST: &'static str =
        "O(n + m max) where the data are spread evenly, O(n log n + m max log n) else";
    const REFERENCE: &'static str = "Schregle 2003, Bias compensation for photon maps";
    const SMOOTHING: Option<&'static str> = Some("max");
    const PARAMETERS: &'static [Parameter] = &[
        MIN,
        MAX,
        convention("mean-radius"),
        Parameter::optional(
            "weights",
            Kind::Choice(&Weighting::NAMES),
            Absent::Word("square"),
            "how much the estimate from j neighbours counts: j², 1, j, j³ or exp(0.003 j)",
        ),
        Parameter::optional(
            "acceptance",
            Kind::Choice(&Acceptance::NAMES),
            Absent::Word("seeded"),
            "whether a step of probability p is taken: dice that belong to the place, dice thrown anew for each sample, or p > 1/2",
        ),
        Parameter::optional(
            "seed",
            Kind::Count {
                least: 0,
                most: 1_000_000_000,
            },
            Absent::Number(0.0),
            "which dice",
        ),
        Parameter::optional(
            "variant",
            Kind::Choice(&["corrected", "as-printed"]),
            Absent::Word("corrected"),
            "\"as-printed\" is the slide's text, which does not terminate or returns what it rejected",
        ),
    ];
}

impl<const D: usize> Build<D> for BiasCompensated
where
    Sample<D>: Searchable<D>,
{
    fn build(values: &Values, _context: &Context<D>) -> Result<Self, BuildError> {
        let (range, convention) = told(values)?;
        let weighting = values.word("weights").unwrap_or_default();
        let weighting = Weighting::NAMES.iter().position(|name| *name == weighting);
        let acceptance = values.word("acceptance").and_then(Acceptance::named);
        let seed = values.count("seed").unwrap_or(0);
        Ok(Self {
            range,
            convention,
            weighting: weighting.map_or(Weighting::Square, |at| Weighting::ALL[at]),
            dice: Dice::new(acceptance.unwrap_or(Acceptance::Seeded), seed),
            as_printed: values.word("variant") == Some("as-printed"),
        })
    }
}
