//! How well an estimate of the squared error follows the squared error itself.

use super::{Interval, Paired, compare};

/// How estimates ê²(xᵢ) of the squared error at many places compare with the true e²(xᵢ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Spearman's rank correlation of the two.
    pub rank_correlation: f64,
    /// M of e² ≈ M ê²: the ratio of the sums, which is the least-squares slope through the origin with weights 1/ê².
    pub factor: f64,
}

impl Calibration {
    /// Of estimates against truths, place by place; `None` for fewer than three places, or where one of the two is the same everywhere or sums to nothing.
    ///
    /// # Panics
    /// If there is not one estimate a place.
    pub fn of(estimated: &[f64], actual: &[f64]) -> Option<Self> {
        assert_eq!(estimated.len(), actual.len(), "one estimate a place");
        let (said, was) = (estimated.iter().sum::<f64>(), actual.iter().sum::<f64>());
        let factor = was / said;
        Some(Self {
            rank_correlation: rank_correlation(estimated, actual)?,
            factor,
        })
        .filter(|_| said > 0.0 && factor.is_finite())
    }

    /// The factor M with its interval, from the sums of ê² and of e² over the places, one of each a replicate; `None` for fewer than two replicates.
    ///
    /// # Panics
    /// If there is not one of each a replicate.
    pub fn factor_interval(estimated: &[f64], actual: &[f64], confidence: f64) -> Option<Interval> {
        if estimated.len() < 2 || estimated.iter().sum::<f64>() <= 0.0 {
            return None;
        }
        let Paired {
            ratio, ratio_error, ..
        } = compare(actual, estimated, confidence);
        let freedom = estimated.len() as f64 - 1.0;
        Some(Interval::around(ratio, ratio_error?, freedom, confidence))
    }
}

/// Spearman's rank correlation: that of the ranks, equal values sharing the mean of theirs. `None` for fewer than three pairs, or if one list is constant.
///
/// # Panics
/// If the lists are of different lengths.
pub fn rank_correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    assert_eq!(a.len(), b.len(), "pairs");
    if a.len() < 3 {
        return None;
    }
    let (a, b) = (ranks(a), ranks(b));
    let mean = 0.5 * (a.len() as f64 + 1.0);
    let product = |p: &[f64], q: &[f64]| -> f64 {
        p.iter().zip(q).map(|(p, q)| (p - mean) * (q - mean)).sum()
    };
    let spread = product(&a, &a) * product(&b, &b);
    (spread > 0.0).then(|| product(&a, &b) / spread.sqrt())
}

/// Ranks from 1, ties sharing the mean.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut ranks = vec![0.0; values.len()];
    let mut before = 0;
    for tied in order.chunk_by(|&i, &j| values[i].total_cmp(&values[j]).is_eq()) {
        let rank = before as f64 + 0.5 * (tied.len() as f64 + 1.0);
        before += tied.len();
        for &i in tied {
            ranks[i] = rank;
        }
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_share_ties() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, 2.0]), [3.5, 1.0, 3.5, 2.0]);
    }

    #[test]
    fn what_is_monotone_correlates_fully_and_the_factor_is_the_ratio() {
        let estimated = [1.0, 2.0, 3.0, 4.0];
        let actual = [0.5, 1.0, 1.5, 2.0];
        let found = Calibration::of(&estimated, &actual).expect("four places");
        assert!((found.rank_correlation - 1.0).abs() < 1e-15);
        assert!((found.factor - 0.5).abs() < 1e-15);
        let backwards = [4.0, 3.0, 2.0, 1.0];
        assert!((rank_correlation(&estimated, &backwards).expect("four") + 1.0).abs() < 1e-15);
        // by hand: d² = 4 of n = 4 gives 1 - 6·4/60
        let turned = [2.0, 1.0, 4.0, 3.0];
        assert!((rank_correlation(&estimated, &turned).expect("four") - 0.6).abs() < 1e-15);
        assert!(rank_correlation(&estimated, &[1.0; 4]).is_none());
    }

    #[test]
    fn the_factor_has_an_interval() {
        let actual: Vec<f64> = (0..40).map(|i| 1.0 + 0.1 * f64::from(i % 3 - 1)).collect();
        let m = Calibration::factor_interval(&[2.0; 40], &actual, 0.95).expect("forty");
        assert!(
            m.low < 0.5 && 0.5 < m.high && m.high - m.low < 0.05,
            "{m:?}"
        );
    }
}
