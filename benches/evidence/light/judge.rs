//! Means with their errors, and what families of comparisons say together.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// The level of every family.
pub const LEVEL: f64 = 0.01;

/// A mean with its standard error, and how many values it is of; 0: a number without error.
#[derive(Clone, Copy, Debug)]
pub struct Mean {
    pub value: f64,
    pub error: f64,
    pub count: usize,
}

impl Mean {
    pub fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count();
        let n = count as f64;
        let value = values.clone().sum::<f64>() / n;
        let square: f64 = values.map(|v| (v - value).powi(2)).sum();
        Self {
            value,
            error: (square / (n - 1.0) / n).sqrt(),
            count,
        }
    }

    pub fn exactly(value: f64) -> Self {
        Self {
            value,
            error: 0.0,
            count: 0,
        }
    }

    /// The difference in standard errors, as a standard normal number: Student's where there are few values. [Welch 1947]
    pub fn off(self, other: Self) -> f64 {
        let [a, b] = [self, other].map(|m| (m.error.powi(2), m.count as f64 - 1.0));
        let square = a.0 + b.0;
        if square <= 0.0 {
            return if (self.value - other.value).abs() <= 1e-12 {
                0.0
            } else {
                f64::INFINITY
            };
        }
        let share = |(s, freedom): (f64, f64)| if s > 0.0 { s * s / freedom } else { 0.0 };
        let freedom = square * square / (share(a) + share(b));
        let t = (self.value - other.value) / square.sqrt();
        let student = StudentsT::new(0.0, 1.0, freedom).expect("freedom");
        // by the lower tail, which keeps its digits
        let z = Normal::standard().inverse_cdf(student.cdf(-t.abs()).max(1e-300));
        z.abs().copysign(t)
    }

    /// The probability of a mean at least as far from `expected` as this, where a share of `margin` is allowed.
    pub fn beyond(self, expected: f64, margin: f64) -> f64 {
        let off = ((self.value - expected).abs() - margin * expected).max(0.0);
        if off <= 0.0 {
            return 1.0;
        }
        Normal::standard().sf(off / self.error)
    }
}

/// The least p-value of a family after Holm; whether all stand. [Holm 1979]
pub fn holm(family: &[f64]) -> (f64, bool) {
    let mut sorted = family.to_vec();
    sorted.sort_by(f64::total_cmp);
    let m = sorted.len() as f64;
    let adjusted = sorted.iter().enumerate().map(|(i, p)| p * (m - i as f64));
    let least = adjusted.fold(f64::INFINITY, f64::min).min(1.0);
    (least, least >= LEVEL)
}

pub fn two_sided(z: f64) -> f64 {
    2.0 * Normal::standard().cdf(-z.abs())
}

/// The probability that differences of mean 0 are, all together, as large as these; `differences[k][b]` is cell k in batch b, batches are independent.
///
/// The statistic is Σₖ (Σ_b d)²/Σ_b d², a sum over cells in which none counts for more than there are batches, however rare and bright its hits. If the
/// differences are symmetric, flipping the signs of whole batches gives it the distribution that it has without a difference, whatever the variances and
/// however the cells depend on each other. [Fisher 1935] Its first two moments over all flips are known: with A_bc = Σₖ u_bk u_ck of the normalised
/// differences u, tr A and 2 Σ_{b ≠ c} A_bc². A scaled χ² has the same. [Box 1954]
pub fn together(differences: &[Vec<f64>]) -> f64 {
    let Some(batches) = differences.first().map(Vec::len) else {
        return 1.0;
    };
    let mut form = vec![0.0; batches * batches];
    let (mut statistic, mut cells) = (0.0, 0.0);
    for cell in differences {
        let square: f64 = cell.iter().map(|d| d * d).sum();
        if square <= 0.0 {
            continue;
        }
        cells += 1.0;
        statistic += cell.iter().sum::<f64>().powi(2) / square;
        for (b, row) in form.chunks_mut(batches).enumerate() {
            for (sum, d) in row.iter_mut().zip(cell) {
                *sum += cell[b] * d / square;
            }
        }
    }
    if cells <= 0.0 {
        return 1.0;
    }
    let all: f64 = form.iter().map(|a| a * a).sum();
    let diagonal: f64 = (0..batches).map(|b| form[b * (batches + 1)].powi(2)).sum();
    let variance = 2.0 * (all - diagonal);
    let scale = variance / (2.0 * cells);
    let freedom = cells / scale;
    ChiSquared::new(freedom)
        .expect("freedom")
        .sf(statistic / scale)
}
