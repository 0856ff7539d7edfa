//! When a run has seen enough: the question is settled before all replicates are done.
//!
//! # Valid though one looks again and again
//! The run looks at its numbers after 2, 4, 8, ... blocks of replicates, L looks in all, and stops at the first look that settles the question. Each look uses intervals that miss with probability
//! at most (1 - confidence)/L, over all that is compared at once; so by the union bound the probability that any look states something false is at most 1 - confidence, however often one looks and
//! whenever one stops (alpha spending in equal parts, \[Bonferroni; Lan & DeMets 1983\]). What the run ends with is one of these looks. Looking after every replicate at a fixed level instead would state something false
//! with probability 1 in the end.
//!
//! Looks are at block boundaries, which depend on the experiment alone, so a run stops at the same replicate for any number of threads and after any interruption.

use crate::accuracy::{compare, mean_interval};
use serde::Serialize;

/// What must be known before a run may end early.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopRule {
    /// Every MISE to within this share of itself: half the interval over the value.
    RelativeError {
        /// The share.
        within: f64,
        /// The probability that all intervals hold.
        confidence: f64,
    },
    /// The order of all estimators by MISE, for every source and size.
    Rank {
        /// The probability that the whole order is right.
        confidence: f64,
    },
}

/// After how many blocks of so many to look: 2, 4, 8, ... and at the end.
pub fn looks(blocks: usize) -> Vec<usize> {
    let mut looks: Vec<usize> = (1..usize::BITS)
        .map(|power| 1 << power)
        .take_while(|&after| after < blocks)
        .collect();
    looks.push(blocks);
    looks
}

impl StopRule {
    /// The confidence of what is stated in the end.
    pub fn confidence(self) -> f64 {
        match self {
            Self::RelativeError { confidence, .. } | Self::Rank { confidence } => confidence,
        }
    }

    /// Whether the question is settled by the squared errors so far, `groups[group][estimator][replicate]`, at one of so many looks; the replicates of a group's estimators are of the same samples.
    /// Says how, if it is.
    pub fn settled(self, groups: &[Vec<Vec<f64>>], looks: usize) -> Option<String> {
        let spent = (1.0 - self.confidence()) / looks.max(1) as f64;
        match self {
            Self::RelativeError { within, .. } => {
                let number: usize = groups.iter().map(Vec::len).sum();
                let each = 1.0 - spent / number.max(1) as f64;
                let mut worst = 0.0_f64;
                for errors in groups.iter().flatten() {
                    let interval = mean_interval(errors, each);
                    interval.standard_error?;
                    worst = worst.max((interval.high - interval.value) / interval.value);
                }
                (worst <= within).then(|| {
                    format!(
                        "every MISE is known to within {:.2} % of itself",
                        100.0 * worst
                    )
                })
            }
            Self::Rank { .. } => {
                let pairs: usize = groups.iter().map(|g| g.len() * (g.len() - 1) / 2).sum();
                let each = 1.0 - spent / pairs.max(1) as f64;
                for group in groups {
                    for (i, a) in group.iter().enumerate() {
                        for b in &group[i + 1..] {
                            let difference = compare(a, b, each).difference;
                            difference.standard_error?;
                            if difference.low <= 0.0 && difference.high >= 0.0 {
                                return None;
                            }
                        }
                    }
                }
                Some(format!(
                    "all {pairs} pairs of estimators are told apart by their MISE"
                ))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{open_unit, stream};

    /// Skewed errors of two estimators on the same samples, B's mean larger by `more`.
    fn pair(seed: u64, replicates: usize, more: f64) -> Vec<Vec<f64>> {
        let mut random = stream(seed, "stop", 0);
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for _ in 0..replicates {
            let common = -open_unit(&mut random).ln();
            a.push(common - 0.3 * open_unit(&mut random).ln());
            b.push(common - 0.3 * open_unit(&mut random).ln() + more);
        }
        vec![a, b]
    }

    /// At which look a run of 16 blocks of 25 ends, if before its end, when `looks` are paid for.
    fn ends(rule: StopRule, all: &[Vec<f64>], paid: usize) -> Option<usize> {
        looks(16).into_iter().find(|&after| {
            let seen: Vec<Vec<f64>> = all.iter().map(|e| e[..25 * after].to_vec()).collect();
            rule.settled(&[seen], paid).is_some()
        })
    }

    #[test]
    fn looks_double_and_end_with_all() {
        assert_eq!(looks(16), [2, 4, 8, 16]);
        assert_eq!(looks(20), [2, 4, 8, 16, 20]);
        assert_eq!(looks(1), [1]);
    }

    #[test]
    fn equal_estimators_are_ranked_no_more_often_than_stated_and_peeking_unpaid_more_often() {
        let rule = StopRule::Rank { confidence: 0.95 };
        let seeds = 1500;
        let wrong = |paid| {
            let ranked =
                (0..seeds).filter(|&seed| ends(rule, &pair(seed, 400, 0.0), paid).is_some());
            ranked.count() as f64 / seeds as f64
        };
        let (paid, unpaid) = (wrong(4), wrong(1));
        let error = (0.05 * 0.95 / seeds as f64).sqrt();
        assert!(paid <= 0.05 + 3.0 * error, "{paid}");
        // the planted fault: four looks at the level of one
        assert!(unpaid > 0.05 + 6.0 * error, "{unpaid}");
    }

    #[test]
    fn a_clear_difference_ends_early_and_a_small_one_late() {
        let rule = StopRule::Rank { confidence: 0.99 };
        assert_eq!(ends(rule, &pair(1, 400, 0.5), 4), Some(2));
        assert!(ends(rule, &pair(1, 400, 0.08), 4).is_none_or(|after| after > 2));
    }

    #[test]
    fn the_interval_at_the_end_covers_as_often_as_stated() {
        let rule = StopRule::RelativeError {
            within: 0.2,
            confidence: 0.95,
        };
        let (mut ended, mut covered) = (0, 0);
        for seed in 0..1000 {
            let all = pair(seed, 400, 0.0);
            let Some(after) = ends(rule, &all[..1], 4) else {
                continue;
            };
            ended += 1;
            let interval = mean_interval(&all[0][..25 * after], 1.0 - 0.05 / 4.0);
            covered += usize::from(interval.low <= 1.3 && 1.3 <= interval.high);
        }
        assert!(ended > 900, "{ended}");
        assert!(
            covered as f64 >= 0.95 * f64::from(ended) - 21.0,
            "{covered} of {ended}"
        );
    }
}
