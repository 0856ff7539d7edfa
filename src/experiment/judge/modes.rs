//! Claims about how many modes estimates show.
//!
//! The share and the median of the samples at hand are estimates themselves: what must agree with the claim is the whole interval around them.

use super::short;
use crate::accuracy::{fewest_for_median, median_interval, share_interval};
use crate::experiment::results::Outcome;

pub(super) fn median_modes(outcome: &Outcome, expected: u64, confidence: f64) -> (bool, String) {
    let mut counts: Vec<f64> = outcome.replicates.iter().map(|r| r.modes as f64).collect();
    counts.sort_unstable_by(f64::total_cmp);
    let expected = expected as f64;
    let agrees = |modes: f64| (modes - expected).abs() < 0.25;
    if let [only] = counts[..] {
        return (agrees(only), format!("{only}, expected {expected}"));
    }
    let Some(interval) = median_interval(&counts, confidence) else {
        return (
            false,
            format!(
                "the median of {} samples has no interval at confidence {confidence}; it takes {}",
                counts.len(),
                fewest_for_median(confidence)
            ),
        );
    };
    let percentile = |p: f64| counts[((counts.len() - 1) as f64 * p).round() as usize];
    let detail = format!(
        "median {} (interval {} to {}), 5 to 95 % of the samples: {} to {}; expected {expected}",
        interval.value,
        interval.low,
        interval.high,
        percentile(0.05),
        percentile(0.95)
    );
    (agrees(interval.low) && agrees(interval.high), detail)
}

pub(super) fn share_of_modes(
    outcome: &Outcome,
    count: usize,
    share: f64,
    margin: f64,
    confidence: f64,
) -> (bool, String) {
    let hits = outcome.replicates.iter().filter(|r| r.modes == count);
    let interval = share_interval(hits.count(), outcome.replicates.len(), confidence);
    let detail = format!(
        "{} of the samples (interval {} to {}), expected {share} ± {margin}",
        short(interval.value),
        short(interval.low),
        short(interval.high)
    );
    let inside = share - margin <= interval.low && interval.high <= share + margin;
    (inside, detail)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::Tally;
    use crate::experiment::run::Replicate;
    use std::collections::BTreeMap;

    /// An outcome whose samples have these numbers of modes.
    fn outcome(modes: impl IntoIterator<Item = usize>) -> Outcome {
        Outcome {
            name: "A".to_owned(),
            replicates: modes
                .into_iter()
                .map(|modes| Replicate {
                    errors: None,
                    integral: 1.0,
                    modes,
                    smoothing: None,
                    regions: Vec::new(),
                })
                .collect(),
            tally: Tally::default(),
            blocks: Vec::new(),
            measures: BTreeMap::new(),
            expected: None,
            ladder: crate::experiment::Ladder::default(),
            spread: None,
            coverage: None,
            engine: None,
            said: Vec::new(),
        }
    }

    /// `hits` of `samples` samples with two modes, the rest with one.
    fn two_or_one(hits: usize, samples: usize) -> Outcome {
        outcome((0..samples).map(|i| if i < hits { 2 } else { 1 }))
    }

    #[test]
    fn a_share_inside_the_margin_by_luck_alone_is_not_shown() {
        // 32 of 40 is 0.8 exactly, but 40 samples leave anything from 0.59 to 0.93 open
        assert!(!share_of_modes(&two_or_one(32, 40), 2, 0.8, 0.05, 0.99).0);
        assert!(share_of_modes(&two_or_one(3200, 4000), 2, 0.8, 0.05, 0.99).0);
        assert!(!share_of_modes(&two_or_one(3000, 4000), 2, 0.8, 0.05, 0.99).0);
    }

    #[test]
    fn a_median_that_chance_could_have_moved_is_not_shown() {
        // 11 of 20 have two modes: the median is 2, and might as well be 1
        assert!(!median_modes(&two_or_one(11, 20), 2, 0.99).0);
        assert!(median_modes(&two_or_one(1100, 1900), 2, 0.99).0);
        assert!(!median_modes(&two_or_one(1100, 1900), 1, 0.99).0);
    }

    #[test]
    fn few_samples_show_no_median_and_one_data_set_is_what_it_is() {
        let (holds, detail) = median_modes(&outcome([2; 7]), 2, 0.99);
        assert!(!holds && detail.contains("it takes 8"), "{detail}");
        assert!(median_modes(&outcome([2; 8]), 2, 0.99).0);
        assert!(median_modes(&outcome([2]), 2, 0.99).0);
        assert!(!median_modes(&outcome([3]), 2, 0.99).0);
    }
}
