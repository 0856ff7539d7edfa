//! Compact kernels at scattered targets, exact, from data sorted once.
//!
//! The data are brought into ascending [`blocks`] of about thirty, and each block keeps its moments. The blocks that lie entirely in the window of a target are summed by the
//! [`Ladder`]; the one or two that an end of the window cuts are evaluated by the definition, datum by datum, so that what is in and
//! what is out is decided exactly as there.

mod blocks;

use super::basis::{Basis, Powers, Side, Waves};
use super::bound::expansion_error;
use super::interval::supported;
use super::ladder::{Item, Ladder};
use super::{Engine, Quote, Unsupported};
use crate::kernel::{Form, Kernel, KernelSum};
use crate::sample::Weights;
use crate::space::{Domain, Evaluation, Field, Point, Targets};
use blocks::{Blocks, CROWDED, range};
use rayon::prelude::*;

/// Sorted prefix moments: exact sums of compact kernels anywhere on a line. O(n) to O(n log n) once, then O(1) to O(log n) a target;
/// memory for a second copy of the data.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sorted;

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
    blocks: Blocks,
    ladder: Ladder<B, N>,
    /// What a sum of kernels is multiplied by.
    factor: f64,
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
    let each = match sum.sample().weights() {
        Weights::Equal(_) => None,
        Weights::Each(weights) => Some(&weights[..]),
    };
    let scale = h.recip();
    let (blocks, items) = Blocks::new(data, each, &|points: &[f64], weights: &[f64]| {
        item(&basis, scale, points, weights)
    });
    let factor = match sum.sample().weights() {
        Weights::Equal(weight) => weight / h,
        Weights::Each(_) => scale,
    };
    let window = if B::KINKED { h } else { 2.0 * h };
    Ok(Box::new(Prepared {
        h,
        blocks,
        ladder: Ladder::new(basis, scale, window, items),
        factor,
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
    let (low, high) = range(points);
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

impl<B: Basis<N>, const N: usize> Prepared<B, N> {
    /// The first block for which `past` holds; `past` is false, then true along the blocks, and turns near `x`.
    #[inline]
    fn first_block(&self, x: f64, past: impl Fn(&Item<N>) -> bool) -> usize {
        let items = self.ladder.items();
        let near = self.blocks.near(x);
        let mut found = near.start + items[near].partition_point(|item| !past(item));
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
        let (points, weights) = self.blocks.block(block);
        if weights.is_empty() {
            points
                .iter()
                .map(|point| kernel.value((x - point) / self.h))
                .sum()
        } else {
            points
                .iter()
                .zip(weights)
                .map(|(point, weight)| weight * kernel.value((x - point) / self.h))
                .sum()
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
        if B::KINKED {
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
