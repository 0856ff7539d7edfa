//! Bias compensation as the lecture's slide prints it, kept to show what its misprints do.

use super::acceptance::Dice;
use super::bias_compensated::{Weighting, values};
use super::ladder::Ladder;
use super::{Choice, Rule};
use crate::space::Point;

/// The slide's text, word for word:
///
/// ```text
/// while N_min < N_max:
///     N_mid = (N_max - N_min)/2                          the middle of the range is min + that
///     m[f] = Σ w(j) f_j,   s² = Σ w(j) (f_j - m)²        the weights are not divided by their sum
///     e = f(x, N_mid) - m[f]
///     with probability exp(-e²/(2 s²)):  N_min = N_mid,  else  N_max = N_mid
/// return f(x, N_mid)                                     which may just have been rejected
/// ```
///
/// N_mid = (N_max - N_min)/2 is below N_min whenever N_max < 3 N_min, so an accepted step goes *down*, and the range may grow. With N_max = N_min + 1 the loop goes on as
/// long as steps are accepted with N_mid = N_min. A counter of [`AsPrinted::LIMIT`] steps ends it, and [`Choice::ended`] says so.
#[derive(Clone, Copy, Debug)]
pub(super) struct AsPrinted {
    range: (usize, usize),
    weighting: Weighting,
    dice: Dice,
}

impl AsPrinted {
    /// More steps than any halving of a range of whole numbers takes: who is not done then goes round in circles.
    pub const LIMIT: u32 = 64;

    pub fn new(range: (usize, usize), weighting: Weighting, dice: Dice) -> Self {
        Self {
            range,
            weighting,
            dice,
        }
    }
}

/// Sums that are not divided.
#[derive(Clone, Copy, Default)]
struct Undivided {
    weight: f64,
    first: f64,
    second: f64,
}

impl Undivided {
    fn add(&mut self, value: f64, weight: f64) {
        self.weight += weight;
        self.first += weight * value;
        self.second += weight * value * value;
    }

    /// With m = Σ w f: Σ w (f - m)² = Σ w f² - 2 m Σ w f + m² Σ w.
    fn probability(&self, value: f64) -> f64 {
        let m = self.first;
        let spread = m.mul_add(m * self.weight, self.second) - 2.0 * m * m;
        let error = value - m;
        if error == 0.0 {
            1.0
        } else {
            (-0.5 * error * error / spread).exp()
        }
    }
}

impl<const D: usize> Rule<D> for AsPrinted {
    fn range(&self) -> (usize, usize) {
        self.range
    }

    fn choose(&self, target: Point<D>, ladder: &mut Ladder<'_, D>) -> Choice {
        let (mut low, mut high) = (ladder.least(), ladder.most());
        let mut seen = vec![Undivided::default(); ladder.channels()];
        for (channel, seen) in seen.iter_mut().enumerate() {
            ladder.each_up_to(channel, low, |j, value| {
                if value.is_finite() {
                    seen.add(value, self.weighting.of(j));
                }
            });
        }
        let mut dice = self.dice.at(target, || ladder.volume(high));
        let (mut steps, mut middle) = (0, low);
        while low < high && steps < Self::LIMIT {
            steps += 1;
            // there is no estimate from no neighbour, nor from so few that their ball has no size
            middle = ((high - low) / 2).max(1);
            while ladder.volume(middle) == 0.0 {
                middle += 1;
            }
            let here = values(ladder, middle);
            let p = seen
                .iter()
                .zip(&here)
                .map(|(s, &v)| s.probability(v))
                .sum::<f64>()
                / here.len() as f64;
            if dice.accept(p) {
                for (seen, value) in seen.iter_mut().zip(here) {
                    seen.add(value, self.weighting.of(middle));
                }
                low = middle;
            } else {
                high = middle;
            }
        }
        Choice {
            neighbours: middle,
            steps,
            ended: low >= high,
        }
    }
}
