//! Putting many points into cells on a line, at the speed of memory.
//!
//! | function | what a cell receives | for | file |
//! |---|---|---|---|
//! | [`count`], [`weigh`] | how many points, what mass, of a [`Mesh`] | histograms | `count.rs` |
//! | [`linear`] | mass shared between the two nearest nodes | convolution by transform | `linear.rs` |
//! | [`moments`] | Σ w uᵏ about the centre of the cell | Hermite expansions | `moments.rs` |
//!
//! All work on plain slices in memory order. What makes them fast (about 1 to 3 ns a point on one thread):
//! - the cell of a number is read from the mantissa of `t + 1.5·2⁵²`, which rounds to an integer without a slow saturating cast;
//! - a first loop over a short chunk computes cells in vector registers, a second one scatters them;
//! - points outside are clamped into guard cells, so that the scatter has no branch.
//!
//! # Same bits for any number of threads
//! Points are cut into fixed lanes, each summed in order, and the lanes are added in order. Counts are integers. Nothing depends on the
//! number of threads or on the alignment of the data.
//!
//! # Sums of weights
//! A weight is scaled by the largest one and split into a multiple of 2⁻³⁰ and a rest. Sums of the first parts are exact below
//! 2²³ largest weights; the rests are so small that the rounding of their sum cannot be seen. So a million equal weights in one cell sum
//! to a million times the weight, where plain addition loses four digits.

mod count;
mod linear;
mod moments;

pub use count::{Counts, Mesh, count, weigh};
pub use linear::{Nodes, linear};
pub use moments::{Lattice, moments};

use rayon::prelude::*;
use std::ops::Range;

/// Adding this to |t| < 2⁵¹ rounds t to the nearest integer, which then stands in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// Points located before they are scattered: two buffers of this length stay in the first-level cache.
const CHUNK: usize = 512;

/// Points summed before a table is flushed into the total of its lane; bounds the rounding of long sums.
const BLOCK: usize = 1 << 17;

/// The most lanes: enough for as many threads, few enough that their tables stay small.
const MOST_LANES: usize = 16;

/// Bytes that the tables of all lanes may take together, as long as two lanes remain.
const TABLE_BUDGET: usize = 12 << 20;

/// Cuts `points` indices into fixed ranges, a number that depends only on `points` and on the size of one table.
fn lanes(points: usize, table_bytes: usize) -> Vec<Range<usize>> {
    let blocks = points.div_ceil(BLOCK).max(1);
    let most = (TABLE_BUDGET / table_bytes.max(1)).clamp(2, MOST_LANES);
    let lane = blocks.div_ceil(blocks.min(most)) * BLOCK;
    (0..points)
        .step_by(lane)
        .map(|start| start..(start + lane).min(points))
        .collect()
}

/// The least and the greatest of some numbers; infinity and its opposite of none. O(n), at the speed of memory.
pub fn range(points: &[f64]) -> (f64, f64) {
    const LANES: usize = 8;
    const NOTHING: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);
    let wider = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
    points
        .par_chunks(BLOCK)
        .map(|block| {
            // several at a time, and comparisons written so that each is one instruction
            let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
            let (chunks, rest) = block.as_chunks::<LANES>();
            for chunk in chunks {
                for i in 0..LANES {
                    let x = chunk[i];
                    low[i] = if x < low[i] { x } else { low[i] };
                    high[i] = if x > high[i] { x } else { high[i] };
                }
            }
            let ends = low.into_iter().zip(high);
            ends.chain(rest.iter().map(|&x| (x, x)))
                .fold(NOTHING, wider)
        })
        .reduce(|| NOTHING, wider)
}

/// Runs `table` on each lane, in parallel, and adds the tables in the order of the lanes.
fn in_lanes<T: Send>(
    points: usize,
    table_bytes: usize,
    table: impl Fn(Range<usize>) -> Vec<T> + Send + Sync,
    add: impl Fn(&mut T, T),
) -> Vec<T> {
    let lanes = lanes(points, table_bytes);
    if let [only] = lanes.as_slice() {
        return table(only.clone());
    }
    let mut tables = lanes
        .into_par_iter()
        .map(table)
        .collect::<Vec<_>>()
        .into_iter();
    let mut total = tables.next().unwrap_or_default();
    for next in tables {
        for (sum, term) in total.iter_mut().zip(next) {
            add(sum, term);
        }
    }
    total
}

/// The largest weight, or one if all are zero.
fn largest(weights: &[f64]) -> f64 {
    let largest = weights
        .par_chunks(BLOCK)
        .map(|block| block.iter().copied().fold(0.0, f64::max))
        .reduce(|| 0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// Splits 0 ≤ v ≤ 1 into a multiple of 2⁻³⁰ and a rest.
#[inline(always)]
fn split(v: f64) -> (f64, f64) {
    const COARSE: f64 = ROUNDER / (1u64 << 30) as f64;
    let high = (v + COARSE) - COARSE;
    (high, v - high)
}

/// `t` kept within bounds; written so that it becomes two vector instructions.
#[inline(always)]
fn clamp(t: f64, low: f64, high: f64) -> f64 {
    let t = if t > low { t } else { low };
    if t < high { t } else { high }
}
