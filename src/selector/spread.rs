//! Deviation and quartiles of a sample in one pass, without sorting it.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::SelectError;
use crate::sample::{Sample, Summary, Weights};
use pulp::{Arch, Simd, WithSimd};

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

/// One datum of so many is looked at to know about where the quartiles of large samples are.
const STEP: usize = 32;

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
        let n = x.len();
        let [low, high] = [0.25, 0.75].map(|p| {
            let place = p * (n - 1) as f64;
            (place.floor() as usize, place.fract())
        });
        let brackets = (n >= SMALL).then(|| brackets(x, [low.0, high.0]));
        let pass = Arch::new().dispatch(Pass { x, brackets });
        let deviation = if n > 1 {
            (pass.squares / (n - 1) as f64).sqrt()
        } else {
            0.0
        };
        // the quartiles of type 7: the order statistics at 1 + (n - 1)p, linear in between [Hyndman & Fan 1996]
        let mut near = pass.near;
        let [first, third] = [(0, low), (1, high)].map(|(k, (rank, beyond))| {
            let Near {
                below,
                ref mut found,
            } = near[k];
            let [below, above] = match rank.checked_sub(below) {
                Some(rank) if rank + 1 < found.len() => among(found, rank),
                _ => among(&mut x.to_vec(), rank),
            };
            (below, beyond * (above - below))
        });
        let spread = Self {
            least: pass.least,
            most: pass.most,
            deviation,
            interquartile_range: (third.0 - first.0) + (third.1 - first.1),
        };
        (spread, pass.mean)
    }
}

/// Numbers that are kept beside each other in vector registers.
const LANES: usize = 16;

/// Between which values the order statistics `ranks` and those after them lie, very likely: five deviations of the rank to both sides in a sample of
/// the data taken at even steps.
fn brackets(x: &[f64], ranks: [usize; 2]) -> [[f64; 2]; 2] {
    let mut some: Vec<f64> = x.iter().copied().step_by(STEP).collect();
    let size = some.len();
    ranks.map(|rank| {
        let share = (rank + 1) as f64 / x.len() as f64;
        let margin = 5.0 * (share * (1.0 - share) * size as f64).sqrt() + 2.0;
        let place = share * size as f64;
        let mut at = |place: f64| {
            let place = place.clamp(0.0, (size - 1) as f64) as usize;
            *some.select_nth_unstable_by(place, f64::total_cmp).1
        };
        [at(place - margin), at(place + margin)]
    })
}

/// The data of a bracket.
#[derive(Default)]
struct Near {
    /// Data below the bracket.
    below: usize,
    /// Data within it.
    found: Vec<f64>,
}

/// What one pass over the data finds.
struct Found {
    least: f64,
    most: f64,
    mean: f64,
    /// About the mean.
    squares: f64,
    near: [Near; 2],
}

/// One pass over the data, compiled for wide registers.
struct Pass<'a> {
    x: &'a [f64],
    brackets: Option<[[f64; 2]; 2]>,
}

impl WithSimd for Pass<'_> {
    type Output = Found;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Found {
        let mut all = Found {
            least: f64::INFINITY,
            most: f64::NEG_INFINITY,
            mean: self.x[0],
            squares: 0.0,
            near: [Near::default(), Near::default()],
        };
        // number, mean and squares about it, block by block [Chan, Golub & LeVeque 1983]
        let mut n = 0.0;
        for block in self.x.chunks(BLOCK) {
            // about the mean so far, which costs no digits far from zero
            let (low, high, sum) = survey(block, all.mean);
            let size = block.len() as f64;
            (all.least, all.most) = (all.least.min(low), all.most.max(high));
            let shift = sum / size;
            let own = scatter(block, all.mean + shift);
            all.squares += own + shift * shift * (n * size / (n + size));
            all.mean += shift * (size / (n + size));
            n += size;
            if let Some(brackets) = self.brackets {
                for k in 0..2 {
                    gather(block, brackets[k], &mut all.near[k]);
                }
            }
        }
        all
    }
}

/// The least and the largest of `block`, and the sum of their distances from `mean`.
#[inline(always)]
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
    for i in 0..rest.len() {
        let x = rest[i];
        (low[i], high[i]) = (low[i].min(x), high[i].max(x));
        sum[i] += x - mean;
    }
    let mut all = (low[0], high[0], sum[0]);
    for i in 1..LANES {
        all = (all.0.min(low[i]), all.1.max(high[i]), all.2 + sum[i]);
    }
    all
}

/// The sum of squared distances from `middle`.
#[inline(always)]
fn scatter(block: &[f64], middle: f64) -> f64 {
    let mut sum = [0.0; LANES];
    let (chunks, rest) = block.as_chunks::<LANES>();
    for chunk in chunks {
        for i in 0..LANES {
            sum[i] += (chunk[i] - middle) * (chunk[i] - middle);
        }
    }
    for i in 0..rest.len() {
        sum[i] += (rest[i] - middle) * (rest[i] - middle);
    }
    let mut all = 0.0;
    for i in 0..LANES {
        all += sum[i];
    }
    all
}

/// Counts the data below a bracket and keeps those within.
#[inline(always)]
fn gather(block: &[f64], [low, high]: [f64; 2], near: &mut Near) {
    let mut below = [0_u64; LANES];
    let (chunks, rest) = block.as_chunks::<LANES>();
    for chunk in chunks {
        let mut within = 0_u64;
        for i in 0..LANES {
            below[i] += u64::from(chunk[i] < low);
            within += u64::from(chunk[i] >= low) & u64::from(chunk[i] <= high);
        }
        // no branch for each datum, and none is taken where nothing is near
        if within > 0 {
            let (mut kept, mut count) = ([0.0; LANES], 0);
            for i in 0..LANES {
                kept[count % LANES] = chunk[i];
                count += usize::from(chunk[i] >= low) & usize::from(chunk[i] <= high);
            }
            near.found.extend_from_slice(&kept[..count]);
        }
    }
    for i in 0..rest.len() {
        below[i] += u64::from(rest[i] < low);
        if rest[i] >= low && rest[i] <= high {
            near.found.push(rest[i]);
        }
    }
    for i in 0..LANES {
        near.below += below[i] as usize;
    }
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
