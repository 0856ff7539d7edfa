//! The discrete random walk between patches, its three ways of keeping score, and what theory says of each.
//!
//! A path is born on a patch in proportion to the power that it emits, moves from patch i to j with probability Fᵢⱼ (and is lost otherwise),
//! and survives there with probability ρⱼ. For one patch k the light that it reflects can be scored at each arrival (ρ), at each arrival
//! survived (1) or where the path is absorbed (ρ/(1 - ρ)). All three have the same mean; their second moments obey recurrences of one step.
//!
//! # References
//! Shirley 1991; Pattanaik 1993; Bekaert 1999, Hierarchical and stochastic algorithms for radiosity, ch. 4 (collision, survival, absorption).

use super::system::{FormFactors, Unbalanced};
use crate::random::{Stream, open_unit};

/// When a path scores at a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Score {
    /// At each arrival: ρ.
    Collision,
    /// At each arrival that the path survives: 1.
    Survival,
    /// Where the path is absorbed: ρ/(1 - ρ).
    Absorption,
}

impl Score {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Collision, Self::Survival, Self::Absorption];
}

/// The mean of what a path scores, and the mean of its square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScoreMoments {
    /// E S: times the power of all sources it is what the patch reflects.
    pub mean: f64,
    /// E S².
    pub square: f64,
}

/// A walk between patches.
#[derive(Clone, Debug)]
pub struct DiscreteWalk {
    factors: FormFactors,
    reflectance: Vec<f64>,
    /// The probability of being born on the patches up to each.
    births: Vec<f64>,
}

impl DiscreteWalk {
    /// `power` is what each patch emits, in any unit.
    pub fn new(factors: FormFactors, reflectance: Vec<f64>, power: &[f64]) -> Self {
        let total: f64 = power.iter().sum();
        let mut sum = 0.0;
        let births = power.iter().map(|p| {
            sum += p / total;
            sum
        });
        Self {
            births: births.collect(),
            factors,
            reflectance,
        }
    }

    /// The moments of a path's score at `patch`, from the recurrences for what a path scores after it leaves patch i:
    /// m = F(s + ρm), q = F(t + ρq), with s the mean score of one arrival and t what an arrival adds to the square,
    /// the product of its score with all later ones included. O(patches³).
    ///
    /// # Errors
    /// If paths go on for ever.
    pub fn moments(&self, score: Score, patch: usize) -> Result<ScoreMoments, Unbalanced> {
        let rho = self.reflectance[patch];
        let at_patch = |value: f64| {
            let mut all = vec![0.0; self.factors.count()];
            all[patch] = value;
            all
        };
        let mean = self.after(&at_patch(rho))?;
        let later = mean[patch];
        let added = match score {
            Score::Collision => rho * rho * (1.0 + 2.0 * later),
            Score::Survival => rho * (1.0 + 2.0 * later),
            Score::Absorption => rho * rho / (1.0 - rho),
        };
        let square = self.after(&at_patch(added))?;
        Ok(ScoreMoments {
            mean: self.born(&mean),
            square: self.born(&square),
        })
    }

    /// The expected number of returns to `patch` after an arrival there.
    ///
    /// # Errors
    /// If paths go on for ever.
    pub fn returns(&self, patch: usize) -> Result<f64, Unbalanced> {
        let mut arrivals = vec![0.0; self.factors.count()];
        arrivals[patch] = self.reflectance[patch];
        Ok(self.after(&arrivals)?[patch])
    }

    /// x = F(s + ρx), by way of y = s + ρ F y and x = F y.
    fn after(&self, arrival: &[f64]) -> Result<Vec<f64>, Unbalanced> {
        let inner = self.factors.solve(&self.reflectance, arrival)?;
        Ok(self.factors.gather(&inner))
    }

    fn born(&self, value: &[f64]) -> f64 {
        let mut before = 0.0;
        let each = self.births.iter().zip(value).map(|(&until, v)| {
            let share = until - before;
            before = until;
            share * v
        });
        each.sum()
    }

    /// One path: what it scores at each patch is added to `scores`. O(length of the path × patches).
    pub fn walk(&self, score: Score, random: &mut Stream, scores: &mut [f64]) {
        let pick = |u: f64, until: &[f64]| until.partition_point(|&p| p <= u);
        let mut at = pick(open_unit(random), &self.births).min(self.births.len() - 1);
        loop {
            let mut left = open_unit(random);
            let next = self.factors.row(at).iter().position(|share| {
                left -= share;
                left < 0.0
            });
            let Some(next) = next else {
                return;
            };
            let rho = self.reflectance[next];
            let survives = open_unit(random) < rho;
            scores[next] += match (score, survives) {
                (Score::Collision, _) => rho,
                (Score::Survival, true) => 1.0,
                (Score::Absorption, false) => rho / (1.0 - rho),
                (Score::Survival, false) | (Score::Absorption, true) => 0.0,
            };
            if !survives {
                return;
            }
            at = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::form_factor::{parallel, perpendicular};
    use super::super::system::FormFactors;
    use super::{DiscreteWalk, Score};
    use crate::random;

    /// A cube's faces, the floor (0) shining, with reflectances that differ.
    fn walk() -> DiscreteWalk {
        let (opposite, beside) = (parallel(1.0, 1.0, 1.0), perpendicular(1.0, 1.0, 1.0));
        let share = |i: usize, j: usize| match (i, j) {
            (i, j) if i == j => 0.0,
            (i, j) if i + j == 5 => opposite,
            _ => beside,
        };
        let factors = FormFactors::new(6, (0..36).map(|k| share(k / 6, k % 6)).collect());
        DiscreteWalk::new(
            factors,
            vec![0.3, 0.7, 0.6, 0.5, 0.8, 0.7],
            &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        )
    }

    #[test]
    fn the_mean_is_the_solution_of_the_system_and_survival_costs_one_over_rho() {
        let walk = walk();
        // B = M + ρ F B with M = 1 on the floor; reflected is B - M
        let solved = walk
            .factors
            .solve(&walk.reflectance, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
            .expect("absorbs");
        for patch in 0..6 {
            let reflected = solved[patch] - f64::from(u8::from(patch == 0));
            let [collision, survival, absorption] =
                Score::ALL.map(|score| walk.moments(score, patch).expect("ends"));
            for moments in [collision, survival, absorption] {
                assert!(
                    (moments.mean - reflected).abs() < 1e-12,
                    "{moments:?} {reflected}"
                );
            }
            let rho = walk.reflectance[patch];
            assert!((survival.square / collision.square - 1.0 / rho).abs() < 1e-12);
            // collision beats absorption just where paths return often
            let returns = walk.returns(patch).expect("ends");
            let better = 1.0 / (1.0 - rho) < 1.0 + 2.0 * returns;
            assert_eq!(
                better,
                absorption.square < collision.square,
                "patch {patch}"
            );
        }
    }

    /// Paths agree with the recurrences, and the ratio of the second moments is 1/ρ within 2 %.
    #[test]
    fn paths_have_these_moments() {
        const PATHS: usize = 200_000;
        let (walk, patch) = (walk(), 1);
        let mut squares = Vec::new();
        for score in Score::ALL {
            let mut random = random::stream(3, "discrete", score as u64);
            let (mut sum, mut square, mut fourth) = (0.0, 0.0, 0.0);
            let mut scores = vec![0.0; 6];
            for _ in 0..PATHS {
                scores.fill(0.0);
                walk.walk(score, &mut random, &mut scores);
                let s: f64 = scores[patch];
                sum += s;
                square += s * s;
                fourth += s.powi(4);
            }
            let n = PATHS as f64;
            let (mean, square, fourth) = (sum / n, square / n, fourth / n);
            let exact = walk.moments(score, patch).expect("ends");
            let off = (mean - exact.mean) / ((square - mean * mean) / n).sqrt();
            assert!(off.abs() < 4.0, "{score:?}: {mean} {exact:?}");
            let off = (square - exact.square) / ((fourth - square * square) / n).sqrt();
            assert!(off.abs() < 4.0, "{score:?}: {square} {exact:?}");
            squares.push(square);
        }
        let ratio = squares[1] / squares[0] * walk.reflectance[patch];
        assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    }
}
