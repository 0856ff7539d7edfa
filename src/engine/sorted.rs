//! Compact kernels at scattered targets, exact, from data sorted once.
//!
//! The data are brought into ascending *blocks* of about sixteen - one counting pass on evenly spaced bins, with a true sort only inside
//! bins that are crowded - and each block keeps its moments. The blocks that lie entirely in the window of a target are summed by the
//! [`Ladder`]; the one or two that an end of the window cuts are evaluated by the definition, datum by datum, so that what is in and
//! what is out is decided exactly as there.

use super::basis::{Basis, Powers, Side, Waves};
use super::bound::expansion_error;
use super::interval::supported;
use super::ladder::{Item, Ladder};
use super::{Engine, Quote, Unsupported};
use crate::kernel::{Form, Kernel, KernelSum, Shape};
use crate::sample::Weights;
use crate::space::{Domain, Evaluation, Field, Point, Targets};
use rayon::prelude::*;

/// Sorted prefix moments: exact sums of compact kernels anywhere on a line. O(n) to O(n log n) once, then O(1) to O(log n) a target;
/// memory for a second copy of the data.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sorted;

/// Data per block: as many as can be evaluated in the time that finding them takes.
const BLOCK: usize = 16;

/// Bins with more data than this are sorted and cut.
const CROWDED: usize = 3 * BLOCK;

impl Engine<1> for Sorted {
    fn name(&self) -> &'static str {
        "sorted"
    }

    fn quote(
        &self,
        sum: &KernelSum<1>,
        targets: Targets<'_, 1>,
        _tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        supported(sum)?;
        let n = sum.sample().len() as f64;
        Ok(Quote {
            error: error(sum),
            nanoseconds: 5_000.0 + 20.0 * n + 150.0 * targets.len() as f64,
        })
    }

    fn prepare(
        &self,
        sum: KernelSum<1>,
        _tolerance: f64,
    ) -> Result<Box<dyn Field<1>>, Unsupported> {
        let h = supported(&sum)?;
        match sum.shape().form() {
            Form::Polynomial(c) if c.len() <= 2 => prepared(sum, h, Powers::<2>::new(c)),
            Form::Polynomial(c) if c.len() <= 4 => prepared(sum, h, Powers::<4>::new(c)),
            Form::Polynomial(c) => prepared(sum, h, Powers::<8>::new(c)),
            Form::Cosine => prepared(sum, h, Waves),
            Form::Gaussian => unreachable!("refused above"),
        }
    }
}

fn error(sum: &KernelSum<1>) -> f64 {
    // a block that lies in a window is at most as long as the window
    expansion_error(sum, 1.0, CROWDED)
}

struct Prepared<B, const N: usize> {
    sum: KernelSum<1>,
    h: f64,
    /// All points, block by block, each with its weight unless all are equal.
    points: Vec<f64>,
    weights: Vec<f64>,
    /// Where each block begins in `points`, and one more.
    starts: Vec<usize>,
    bins: Bins,
    /// The first block of each bin, and one more.
    directory: Vec<u32>,
    ladder: Ladder<B, N>,
    /// What a sum of kernels is multiplied by.
    factor: f64,
    kink: bool,
}

/// Evenly spaced bins over the range of the data.
#[derive(Clone, Copy, Debug)]
struct Bins {
    low: f64,
    inverse: f64,
    count: usize,
}

impl Bins {
    fn new(points: &[f64]) -> Self {
        let (low, high) = points
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| {
                (low.min(x), high.max(x))
            });
        let count = (points.len() / BLOCK).max(1);
        // halves, so that the range of the data may be wider than a number can say
        let inverse = 0.5 * count as f64 / (0.5 * high - 0.5 * low);
        Self {
            low,
            inverse: if inverse.is_finite() { inverse } else { 0.0 },
            count,
        }
    }

    /// The bin of `x`: ascending in x, the first or the last beyond the data.
    #[inline]
    fn of(&self, x: f64) -> usize {
        // a cast takes what is below zero to zero
        (((x - self.low) * self.inverse) as usize).min(self.count - 1)
    }
}

fn prepared<B: Basis<N> + 'static, const N: usize>(
    sum: KernelSum<1>,
    h: f64,
    basis: B,
) -> Result<Box<dyn Field<1>>, Unsupported> {
    let data = sum.sample().coordinates();
    if u32::try_from(data.len()).is_err() {
        return Err(Unsupported("more than 2³² data".to_owned()));
    }
    let bins = Bins::new(data);
    let each = match sum.sample().weights() {
        Weights::Equal(_) => None,
        Weights::Each(weights) => Some(&weights[..]),
    };
    let Binned {
        mut points,
        mut weights,
        starts: bin_starts,
    } = Binned::new(data, each, bins);
    // sort inside the crowded bins
    for bin in bin_starts.windows(2) {
        let range = bin[0] as usize..bin[1] as usize;
        if range.len() > CROWDED {
            sort(
                &mut points[range.clone()],
                weights.get_mut(range).unwrap_or_default(),
            );
        }
    }
    // cut into blocks
    let mut starts = Vec::with_capacity(bins.count + data.len() / BLOCK + 1);
    let mut directory = Vec::with_capacity(bins.count + 1);
    for bin in bin_starts.windows(2) {
        directory.push(starts.len() as u32);
        let (first, end) = (bin[0] as usize, bin[1] as usize);
        if end - first <= CROWDED {
            if end > first {
                starts.push(first);
            }
        } else {
            starts.extend((first..end).step_by(BLOCK));
        }
    }
    directory.push(starts.len() as u32);
    starts.push(data.len());
    let scale = h.recip();
    let items = starts
        .par_windows(2)
        .map(|cut| {
            let range = cut[0]..cut[1];
            item(
                &basis,
                scale,
                &points[range.clone()],
                weights.get(range).unwrap_or_default(),
            )
        })
        .collect();
    let factor = match sum.sample().weights() {
        Weights::Equal(weight) => weight / h,
        Weights::Each(_) => scale,
    };
    let kink = sum.shape() == Shape::Triangular;
    let window = if kink { h } else { 2.0 * h };
    Ok(Box::new(Prepared {
        h,
        points,
        weights,
        starts,
        bins,
        directory,
        ladder: Ladder::new(basis, scale, window, items),
        factor,
        kink,
        sum,
    }))
}

/// The moments of one block.
fn item<B: Basis<N>, const N: usize>(
    basis: &B,
    scale: f64,
    points: &[f64],
    weights: &[f64],
) -> Item<N> {
    let (low, high) = points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| {
            (low.min(x), high.max(x))
        });
    let centre = 0.5 * low + 0.5 * high;
    let mut moments = [0.0; N];
    // a longer block never lies in a window, and its moments could be beyond all numbers
    if (high - low) * scale <= 2.5 {
        for (i, x) in points.iter().enumerate() {
            let row = basis.at((x - centre) * scale);
            let weight = weights.get(i).copied().unwrap_or(1.0);
            for k in 0..N {
                moments[k] += weight * row[k];
            }
        }
    }
    Item {
        low,
        high,
        centre,
        moments,
    }
}

/// Sorts points, and weights with them if there are any.
fn sort(points: &mut [f64], weights: &mut [f64]) {
    if weights.is_empty() {
        points.par_sort_unstable_by(f64::total_cmp);
        return;
    }
    let mut pairs: Vec<(f64, f64)> = points
        .iter()
        .copied()
        .zip(weights.iter().copied())
        .collect();
    // stable: equal points keep the order of the data, for any number of threads
    pairs.par_sort_by(|a, b| a.0.total_cmp(&b.0));
    for (i, (x, w)) in pairs.into_iter().enumerate() {
        points[i] = x;
        weights[i] = w;
    }
}

/// Data in the order of their bins, in the order of the data within a bin.
struct Binned {
    points: Vec<f64>,
    weights: Vec<f64>,
    /// Where each bin begins, and one more.
    starts: Vec<u32>,
}

/// Bins that are filled together: so few that each has its own place in the cache.
const COARSE: usize = 1 << 11;

impl Binned {
    /// Two counting passes: into groups of bins first, so that the second pass stays within a cache.
    fn new(data: &[f64], each: Option<&[f64]>, bins: Bins) -> Self {
        let n = data.len();
        let group = bins.count.div_ceil(COARSE).next_power_of_two();
        let shift = group.trailing_zeros();
        let groups = bins.count.div_ceil(group);
        let mut group_starts = vec![0_u32; groups + 1];
        for &x in data {
            group_starts[(bins.of(x) >> shift) + 1] += 1;
        }
        for g in 0..groups {
            group_starts[g + 1] += group_starts[g];
        }
        let mut next = group_starts.clone();
        let mut coarse = vec![0.0; n];
        let mut coarse_weights = vec![0.0; if each.is_some() { n } else { 0 }];
        for (i, &x) in data.iter().enumerate() {
            let place = &mut next[bins.of(x) >> shift];
            coarse[*place as usize] = x;
            if let Some(each) = each {
                coarse_weights[*place as usize] = each[i];
            }
            *place += 1;
        }
        let mut binned = Self {
            points: vec![0.0; n],
            weights: vec![0.0; coarse_weights.len()],
            starts: vec![0; bins.count + 1],
        };
        let mut next = vec![0_u32; group];
        for g in 0..groups {
            let (first, end) = (group_starts[g] as usize, group_starts[g + 1] as usize);
            let low = g << shift;
            next.fill(0);
            for &x in &coarse[first..end] {
                next[bins.of(x) - low] += 1;
            }
            let mut start = first as u32;
            for (b, count) in next.iter_mut().enumerate() {
                if low + b < bins.count {
                    binned.starts[low + b] = start;
                }
                (*count, start) = (start, start + *count);
            }
            for i in first..end {
                let place = &mut next[bins.of(coarse[i]) - low];
                binned.points[*place as usize] = coarse[i];
                if each.is_some() {
                    binned.weights[*place as usize] = coarse_weights[i];
                }
                *place += 1;
            }
        }
        binned.starts[bins.count] = n as u32;
        binned
    }
}

impl<B: Basis<N>, const N: usize> Prepared<B, N> {
    /// The first block for which `past` holds; `past` is false, then true along the blocks, and turns near `x`.
    #[inline]
    fn first_block(&self, x: f64, past: impl Fn(&Item<N>) -> bool) -> usize {
        let items = self.ladder.items();
        let bin = self.bins.of(x);
        let (low, high) = (
            self.directory[bin] as usize,
            self.directory[bin + 1] as usize,
        );
        let mut found = low + items[low..high].partition_point(|item| !past(item));
        // rounding may have led to a neighbouring bin
        while found > 0 && past(&items[found - 1]) {
            found -= 1;
        }
        while found < items.len() && !past(&items[found]) {
            found += 1;
        }
        found
    }

    /// Σ w K((x - X)/h) over one block, datum by datum.
    fn by_definition<K: Kernel>(&self, kernel: K, block: usize, x: f64) -> f64 {
        let range = self.starts[block]..self.starts[block + 1];
        let points = &self.points[range.clone()];
        match self.weights.get(range) {
            Some(weights) if !weights.is_empty() => points
                .iter()
                .zip(weights)
                .map(|(point, weight)| weight * kernel.value((x - point) / self.h))
                .sum(),
            _ => points
                .iter()
                .map(|point| kernel.value((x - point) / self.h))
                .sum(),
        }
    }

    fn value<K: Kernel>(&self, kernel: K, x: f64) -> f64 {
        let items = self.ladder.items();
        let h = self.h;
        // u falls along the data, rounded or not
        let mut first = self.first_block(x - h, |item| (x - item.high) / h <= 1.0);
        let mut end = self.first_block(x + h, |item| (x - item.low) / h < -1.0);
        if first >= end {
            return 0.0;
        }
        let mut total = 0.0;
        // the blocks that an end of the window cuts
        if (x - items[first].low) / h > 1.0 || (x - items[first].high) / h < -1.0 {
            total += self.by_definition(kernel, first, x);
            first += 1;
        }
        if first < end && (x - items[end - 1].high) / h < -1.0 {
            end -= 1;
            total += self.by_definition(kernel, end, x);
        }
        if self.kink {
            let middle = self.first_block(x, |item| item.high > x).clamp(first, end);
            total += self.ladder.sum(first, middle, x, Side::Right);
            // the block around the kink
            let beyond = if middle < end && items[middle].low < x {
                total += self.by_definition(kernel, middle, x);
                middle + 1
            } else {
                middle
            };
            total += self.ladder.sum(beyond, end, x, Side::Left);
        } else {
            total += self.ladder.sum(first, end, x, Side::Right);
        }
        total.max(0.0) * self.factor
    }
}

/// The sum at each of some places, with the kernel known to the compiler.
struct Values<'a, B, const N: usize> {
    prepared: &'a Prepared<B, N>,
    places: Vec<Point<1>>,
}

impl<B: Basis<N>, const N: usize> crate::kernel::Use for Values<'_, B, N> {
    type Output = Vec<f64>;

    fn with<K: Kernel>(self, kernel: K) -> Vec<f64> {
        self.places
            .into_par_iter()
            .with_min_len(256)
            .map(|[x]| self.prepared.value(kernel, x))
            .collect()
    }
}

impl<B: Basis<N>, const N: usize> Field<1> for Prepared<B, N> {
    fn domain(&self) -> &Domain<1> {
        self.sum.domain()
    }

    fn at(&self, x: Point<1>) -> f64 {
        self.value(self.sum.shape(), x[0])
    }

    fn evaluate(&self, targets: Targets<'_, 1>) -> Evaluation {
        let values = self.sum.shape().apply(Values {
            prepared: self,
            places: targets.places().collect(),
        });
        Evaluation {
            values,
            error: error(&self.sum),
            engine: Some("sorted"),
            ..Evaluation::default()
        }
    }
}
