//! Pointwise moments of an error over samples, in mergeable form, and their split into bias² and variance.
//!
//! # References
//! Chan, Golub & LeVeque 1983, Algorithms for computing the sample variance, eq. 2.1 (merging).

use crate::numeric::Sum;
use pulp::{Arch, Simd, WithSimd};
use serde::{Deserialize, Serialize};

/// Count, mean and sum of squared deviations of the error at each target. Merging in a fixed order gives the same bits always.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    count: u64,
    mean: Vec<f64>,
    squares: Vec<f64>,
}

/// ∫bias² and ∫variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decomposition {
    /// ∫(mean error)², less the share that the variance of the mean contributes; may come out slightly negative.
    pub bias2: f64,
    /// ∫ s², the unbiased sample variance.
    pub variance: f64,
}

impl Tally {
    /// Adds the error of one more estimate, `estimate - truth` at each target.
    ///
    /// # Panics
    /// If the number of targets changes.
    pub fn add(&mut self, estimate: &[f64], truth: &[f64]) {
        if self.count == 0 {
            self.mean = vec![0.0; truth.len()];
            self.squares = vec![0.0; truth.len()];
        }
        assert!(
            estimate.len() == truth.len() && truth.len() == self.mean.len(),
            "one value per target"
        );
        self.count += 1;
        Arch::new().dispatch(Update {
            estimate,
            truth,
            share: (self.count as f64).recip(),
            mean: &mut self.mean,
            squares: &mut self.squares,
        });
    }

    /// Takes in the estimates of another tally.
    ///
    /// # Panics
    /// If both have targets and their numbers differ.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            self.clone_from(other);
            return;
        }
        assert_eq!(self.mean.len(), other.mean.len(), "the same targets");
        let (a, b) = (self.count as f64, other.count as f64);
        for i in 0..self.mean.len() {
            let gap = other.mean[i] - self.mean[i];
            self.mean[i] += gap * b / (a + b);
            self.squares[i] += other.squares[i] + gap * gap * a * b / (a + b);
        }
        self.count += other.count;
    }

    /// The same at some of the targets, and no error at the others.
    pub fn within(&self, inside: &[bool]) -> Self {
        let keep = |values: &[f64]| -> Vec<f64> {
            let kept = values.iter().zip(inside);
            kept.map(|(&v, &inside)| if inside { v } else { 0.0 })
                .collect()
        };
        Self {
            count: self.count,
            mean: keep(&self.mean),
            squares: keep(&self.squares),
        }
    }

    /// How many estimates.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The mean error at each target.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// The standard deviation of the estimate at each target; `None` for fewer than two estimates.
    pub fn deviation(&self) -> Option<Vec<f64>> {
        (self.count > 1).then(|| {
            self.squares
                .iter()
                .map(|s| (s / (self.count - 1) as f64).sqrt())
                .collect()
        })
    }

    /// Splits the mean integrated squared error; `None` for fewer than two estimates.
    pub fn decompose(&self, cell: f64) -> Option<Decomposition> {
        if self.count < 2 {
            return None;
        }
        let n = self.count as f64;
        let variance = self
            .squares
            .iter()
            .map(|s| s / (n - 1.0))
            .collect::<Sum>()
            .value()
            * cell;
        let squared = self.mean.iter().map(|m| m * m).collect::<Sum>().value() * cell;
        Some(Decomposition {
            bias2: squared - variance / n,
            variance,
        })
    }

    /// The split with standard errors, by leaving out one of the `blocks` at a time (jackknife); `None` for fewer than two blocks or for a
    /// remainder of fewer than two estimates.
    pub fn decompose_blocks(blocks: &[&Self], cell: f64) -> Option<(Decomposition, Decomposition)> {
        // what lies before each block and what lies behind it, so that many blocks cost no more than a few merges each
        let running = |blocks: &mut dyn Iterator<Item = &&Self>| -> Vec<Self> {
            let mut all = Self::default();
            let mut so_far = vec![all.clone()];
            for block in blocks {
                all.merge(block);
                so_far.push(all.clone());
            }
            so_far
        };
        let before = running(&mut blocks.iter());
        let whole = before[blocks.len()].decompose(cell)?;
        if blocks.len() < 2 {
            return None;
        }
        let behind = running(&mut blocks.iter().rev());
        let left_out: Vec<Decomposition> = (0..blocks.len())
            .map(|out| {
                let mut rest = before[out].clone();
                rest.merge(&behind[blocks.len() - 1 - out]);
                rest.decompose(cell)
            })
            .collect::<Option<_>>()?;
        let spread = |value: fn(&Decomposition) -> f64| {
            let g = left_out.len() as f64;
            let mean = left_out.iter().map(value).sum::<f64>() / g;
            ((g - 1.0) / g
                * left_out
                    .iter()
                    .map(|d| (value(d) - mean).powi(2))
                    .sum::<f64>())
            .sqrt()
        };
        Some((
            whole,
            Decomposition {
                bias2: spread(|d| d.bias2),
                variance: spread(|d| d.variance),
            },
        ))
    }
}

/// One more estimate of a share of all, target by target. [Welford 1962]
struct Update<'a> {
    estimate: &'a [f64],
    truth: &'a [f64],
    share: f64,
    mean: &'a mut [f64],
    squares: &'a mut [f64],
}

impl WithSimd for Update<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let known = self.mean.iter_mut().zip(self.squares);
        let new = self.estimate.iter().zip(self.truth);
        for ((mean, squares), (estimate, truth)) in known.zip(new) {
            let error = estimate - truth;
            let ahead = error - *mean;
            *mean += ahead * self.share;
            *squares += ahead * (error - *mean);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Decomposition, Tally};

    fn tally(errors: &[f64]) -> Tally {
        let mut tally = Tally::default();
        for &e in errors {
            tally.add(&[e, 2.0 * e], &[0.0, 0.0]);
        }
        tally
    }

    #[test]
    fn merging_equals_adding() {
        let errors = [1.0, -2.0, 0.5, 4.0, 4.0, -1.0, 0.25];
        let mut merged = tally(&errors[..3]);
        merged.merge(&tally(&errors[3..]));
        let whole = tally(&errors);
        for (a, b) in merged
            .mean
            .iter()
            .chain(&merged.squares)
            .zip(whole.mean.iter().chain(&whole.squares))
        {
            assert!((a - b).abs() < 1e-13);
        }
    }

    #[test]
    fn the_split_is_unbiased() {
        // errors ±1 about a bias of 0.5: over all samples of two, bias² averages 0.25 and variance 1
        let mut bias2 = 0.0;
        let mut variance = 0.0;
        for (a, b) in [(1.5, 1.5), (1.5, -0.5), (-0.5, 1.5), (-0.5, -0.5)] {
            let mut tally = Tally::default();
            tally.add(&[a], &[0.0]);
            tally.add(&[b], &[0.0]);
            let split = tally.decompose(1.0).expect("two estimates");
            bias2 += split.bias2 / 4.0;
            variance += split.variance / 4.0;
        }
        assert!(
            (bias2 - 0.25).abs() < 1e-14 && (variance - 1.0).abs() < 1e-14,
            "{bias2} {variance}"
        );
    }

    /// Leaving out one block after the other by the definition.
    #[test]
    fn leaving_out_one_block_is_merging_the_others() {
        let errors: Vec<f64> = (0..23).map(|i| (f64::from(i) * 1.7).sin() + 0.3).collect();
        let blocks: Vec<Tally> = errors.chunks(4).map(tally).collect();
        let blocks: Vec<&Tally> = blocks.iter().collect();
        let (whole, spread) = Tally::decompose_blocks(&blocks, 0.5).expect("six blocks");
        let rest = |out: usize| {
            let mut rest = Tally::default();
            let others = (0..blocks.len()).filter(|&b| b != out);
            others.for_each(|b| rest.merge(blocks[b]));
            rest.decompose(0.5).expect("several")
        };
        assert!((whole.bias2 - rest(99).bias2).abs() < 1e-15);
        let of = |value: fn(&Decomposition) -> f64| {
            let left: Vec<f64> = (0..6).map(|out| value(&rest(out))).collect();
            let mean = left.iter().sum::<f64>() / 6.0;
            (5.0 / 6.0 * left.iter().map(|v| (v - mean).powi(2)).sum::<f64>()).sqrt()
        };
        assert!((spread.bias2 / of(|d| d.bias2) - 1.0).abs() < 1e-12);
        assert!((spread.variance / of(|d| d.variance) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn one_estimate_has_no_variance() {
        assert!(tally(&[1.0]).decompose(1.0).is_none());
    }
}
