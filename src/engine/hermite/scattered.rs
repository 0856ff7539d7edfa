//! Expansions of occupied cells only, for data or targets spread over far more bandwidths than there are points.

use super::expansion::{Terms, locate};
use super::setting::{ORDER, Setting};
use crate::numeric::Sum;
use crate::numeric::special::normal_density;
use rayon::prelude::*;

/// The occupied coarse cells in order.
pub(super) struct Scattered {
    setting: Setting,
    numbers: Vec<f64>,
    terms: Vec<Terms>,
}

impl Scattered {
    /// Collects the points within reach of targets between `low` and `high`. O(n log n), for the sort.
    pub fn collect(
        setting: &Setting,
        points: &[f64],
        weights: Option<&[f64]>,
        low: f64,
        high: f64,
    ) -> Self {
        let margin = (setting.reach + 1.0) * setting.bandwidth;
        let mut order: Vec<(f64, usize)> = points
            .par_iter()
            .enumerate()
            .filter(|&(_, &x)| x >= low - margin && x <= high + margin)
            .map(|(i, &x)| (locate(setting, x).0, i))
            .collect();
        // no two are equal, so the order does not depend on how the sort is spread over threads
        order.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        #[expect(clippy::float_cmp, reason = "cell numbers are whole")]
        let groups: Vec<&[(f64, usize)]> = order.chunk_by(|a, b| a.0 == b.0).collect();
        let terms = groups
            .par_iter()
            .map(|group| expand(setting, points, weights, group))
            .collect();
        Self {
            setting: *setting,
            numbers: groups.iter().map(|group| group[0].0).collect(),
            terms,
        }
    }

    /// The sum at `x`. O(log cells + cells within reach).
    pub fn at(&self, x: f64) -> f64 {
        let (cell, offset) = locate(&self.setting, x);
        let neighbours = self.setting.neighbours() as f64;
        let step = self.setting.coarse() / self.setting.bandwidth;
        let start = self
            .numbers
            .partition_point(|&number| number < cell - neighbours);
        let mut total = 0.0;
        for (number, terms) in self.numbers[start..].iter().zip(&self.terms[start..]) {
            if *number > cell + neighbours {
                break;
            }
            let u = offset - (number - cell) * step;
            let (mut next, mut after) = (0.0, 0.0);
            for n in (0..ORDER).rev() {
                let now = terms[n] + u * next - (n + 1) as f64 * after;
                after = next;
                next = now;
            }
            total += next * normal_density(u);
        }
        total
    }
}

/// aₙ = Σ w sⁿ/n! over the points of one cell, s their distance from its centre over h.
fn expand(
    setting: &Setting,
    points: &[f64],
    weights: Option<&[f64]>,
    group: &[(f64, usize)],
) -> Terms {
    let mut sums = [Sum::default(); ORDER];
    for &(_, i) in group {
        let (_, s) = locate(setting, points[i]);
        let mut power = weights.map_or(1.0, |w| w[i]);
        for (n, sum) in sums.iter_mut().enumerate() {
            sum.add(power);
            power *= s / (n + 1) as f64;
        }
    }
    sums.map(Sum::value)
}
