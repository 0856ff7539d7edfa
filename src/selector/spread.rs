//! Deviation and quartiles of a sample in a few passes, without sorting it.

use super::SelectError;
use crate::sample::{Sample, Summary, Weights};
use crate::space::binning::{Mesh, count};

/// How wide the data lie, in the measures that rules use. The numbers are those of [`Summary`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Spread {
    pub least: f64,
    pub most: f64,
    pub deviation: f64,
    pub interquartile_range: f64,
}

/// Data whose mean and squares are summed at one go.
const BLOCK: usize = 4096;

/// Samples below this are simply copied to find their quartiles.
const SMALL: usize = 1 << 14;

/// Data among which those near a quartile are looked for at one go.
const RUN: usize = 64;

/// Cells that are counted to find the quartiles of large samples.
const CELLS: usize = 4096;

impl Spread {
    /// Measures `sample`. O(n) for equal weights, O(n log n) else.
    ///
    /// # Errors
    /// If the spread is below the resolution of the numbers themselves, or beyond all numbers.
    pub fn of(sample: &Sample<1>) -> Result<Self, SelectError> {
        let (spread, mean) = match sample.weights() {
            Weights::Equal(_) => Self::equal(sample.coordinates()),
            Weights::Each(_) => {
                let summary = Summary::of(sample);
                let spread = Self {
                    least: summary.least,
                    most: summary.most,
                    deviation: summary.deviation,
                    interquartile_range: summary.interquartile_range,
                };
                (spread, summary.mean)
            }
        };
        let Self {
            least,
            most,
            deviation,
            ..
        } = spread;
        if deviation <= 4.0 * f64::EPSILON * least.abs().max(most.abs()) {
            return Err(SelectError::NoSpread {
                points: sample.len(),
                place: mean,
            });
        }
        if !deviation.is_finite() || !(most - least).is_finite() {
            return Err(SelectError::Beyond { least, most });
        }
        Ok(spread)
    }

    fn equal(x: &[f64]) -> (Self, f64) {
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        // number, mean and squares about it, block by block [Chan, Golub & LeVeque 1983]
        let (mut n, mut mean, mut squares) = (0.0, x[0], 0.0);
        for block in x.chunks(BLOCK) {
            // about the mean so far, which costs no digits far from zero
            let (low, high, sum) = survey(block, mean);
            let size = block.len() as f64;
            (least, most) = (least.min(low), most.max(high));
            let shift = sum / size;
            let own = scatter(block, mean + shift);
            squares += own + shift * shift * (n * size / (n + size));
            mean += shift * (size / (n + size));
            n += size;
        }
        let deviation = if x.len() > 1 {
            (squares / (n - 1.0)).sqrt()
        } else {
            0.0
        };
        let spread = Self {
            least,
            most,
            deviation,
            interquartile_range: interquartile_range(x, least, most),
        };
        (spread, mean)
    }
}

/// Numbers that are kept beside each other in vector registers.
const LANES: usize = 8;

/// The least and the largest of `block`, and the sum of their distances from `mean`.
fn survey(block: &[f64], mean: f64) -> (f64, f64, f64) {
    let mut low = [f64::INFINITY; LANES];
    let mut high = [f64::NEG_INFINITY; LANES];
    let mut sum = [0.0; LANES];
    let (chunks, rest) = block.as_chunks::<LANES>();
    for chunk in chunks {
        for i in 0..LANES {
            let x = chunk[i];
            low[i] = if x < low[i] { x } else { low[i] };
            high[i] = if x > high[i] { x } else { high[i] };
            sum[i] += x - mean;
        }
    }
    for (i, &x) in rest.iter().enumerate() {
        (low[i], high[i]) = (low[i].min(x), high[i].max(x));
        sum[i] += x - mean;
    }
    (
        low.into_iter().fold(f64::INFINITY, f64::min),
        high.into_iter().fold(f64::NEG_INFINITY, f64::max),
        sum.iter().sum(),
    )
}

/// The sum of squared distances from `middle`.
fn scatter(block: &[f64], middle: f64) -> f64 {
    let mut sum = [0.0; LANES];
    let (chunks, rest) = block.as_chunks::<LANES>();
    for chunk in chunks {
        for i in 0..LANES {
            sum[i] += (chunk[i] - middle) * (chunk[i] - middle);
        }
    }
    for (i, &x) in rest.iter().enumerate() {
        sum[i] += (x - middle) * (x - middle);
    }
    sum.iter().sum()
}

/// The distance between the quartiles of type 7: the order statistics at 1 + (n - 1)p, linear in between. \[Hyndman & Fan 1996\]
fn interquartile_range(x: &[f64], least: f64, most: f64) -> f64 {
    let n = x.len();
    let at = |p: f64| {
        let place = p * (n - 1) as f64;
        (place.floor() as usize, place.fract())
    };
    let [low, high] = [at(0.25), at(0.75)];
    let found = neighbours(x, least, most, [low.0, high.0]);
    let between = |[below, above]: [f64; 2], beyond: f64| beyond * (above - below);
    (found[1][0] - found[0][0]) + (between(found[1], high.1) - between(found[0], low.1))
}

/// The order statistics `rank` and `rank` + 1 (or `rank` again at the end), counted from 0, for two ranks in ascending order.
fn neighbours(x: &[f64], least: f64, most: f64, ranks: [usize; 2]) -> [[f64; 2]; 2] {
    let n = x.len();
    let width = (most - least) / CELLS as f64;
    if n < SMALL || !width.is_normal() {
        let mut all = x.to_vec();
        return ranks.map(|rank| among(&mut all, rank));
    }
    let counts = count(
        x,
        Mesh {
            origin: least,
            width,
            first: 0.0,
            count: CELLS,
        },
    );
    // the cells that hold a rank and the next, and half a cell more for the rounding of edges
    let places = ranks.map(|rank| {
        let mut before = counts.below as usize;
        let (mut first, mut last) = (None, CELLS);
        for (cell, &inside) in counts.inside.iter().enumerate() {
            before += inside as usize;
            if first.is_none() && before > rank {
                first = Some(cell);
            }
            if before > rank + 1 {
                last = cell;
                break;
            }
        }
        let low = (first.unwrap_or(CELLS) as f64 - 0.5).mul_add(width, least);
        (low, (last as f64 + 1.5).mul_add(width, least))
    });
    let mut below = [0; 2];
    let mut near = [Vec::new(), Vec::new()];
    // short runs, so that those where nothing is near, which is nearly all, need no branch for each datum
    for run in x.chunks(RUN) {
        for (place, (below, near)) in places.iter().zip(below.iter_mut().zip(&mut near)) {
            let (mut under, mut upto) = (0_u64, 0_u64);
            for x in run {
                under += u64::from(*x < place.0);
                upto += u64::from(*x <= place.1);
            }
            *below += under as usize;
            if upto > under {
                near.extend(run.iter().filter(|x| **x >= place.0 && **x <= place.1));
            }
        }
    }
    [0, 1].map(|k| match ranks[k].checked_sub(below[k]) {
        Some(rank) if rank + 1 < near[k].len() => among(&mut near[k], rank),
        _ => among(&mut x.to_vec(), ranks[k]),
    })
}

fn among(x: &mut [f64], rank: usize) -> [f64; 2] {
    let (_, &mut below, above) = x.select_nth_unstable_by(rank, f64::total_cmp);
    let next = above.iter().copied().fold(f64::INFINITY, f64::min);
    [below, if next.is_finite() { next } else { below }]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Domain;

    #[test]
    fn the_numbers_are_those_of_the_summary() {
        let golden = |n: usize| (0..n).map(|i| (i as f64 * 0.618_033_988_749_895).fract());
        let cases: [Vec<f64>; 7] = [
            golden(5).collect(),
            golden(1003).map(|u| u * u).collect(),
            golden(50_001).map(|u| (9.0 * u).sin()).collect(),
            golden(50_001).map(|u| 1e9 + u).collect(),
            // nearly all in one of the cells
            golden(50_001)
                .map(|u| (u - 0.5).powi(31) * 1e9 + u)
                .collect(),
            golden(40_000).map(|u| (7.0 * u).floor()).collect(),
            golden(30_000)
                .chain([1e300, -1e200])
                .map(|u| u * 1e-5)
                .collect(),
        ];
        for (number, x) in cases.into_iter().enumerate() {
            let points = x.iter().map(|&x| [x]).collect();
            let sample = Sample::equal(points, Domain::whole()).expect("legal");
            let (summary, (spread, mean)) = (Summary::of(&sample), Spread::equal(&x));
            for (got, exact) in [
                (spread.least, summary.least),
                (spread.most, summary.most),
                (spread.interquartile_range, summary.interquartile_range),
            ] {
                // quantiles of the summary are sums of weights
                assert!(
                    (got - exact).abs() <= 1e-9 * exact.abs(),
                    "{number}: {got} {exact}"
                );
            }
            if number != 6 {
                assert!((mean / summary.mean - 1.0).abs() < 1e-12, "{number}");
                let got = spread.deviation / summary.deviation;
                assert!((got - 1.0).abs() < 1e-11, "{number}: {got}");
            }
        }
    }
}
