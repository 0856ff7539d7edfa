//! The pass over the data: to each datum its interval, to each interval its moments.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::super::basis::{Basis, CHUNK, Side};
use super::lattice::{Lattice, Partition, block};
use crate::kernel::{Kernel, KernelSum, Shape};
use crate::memory::zeros;
use crate::sample::Weights;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// What a block of data adds up to.
pub(super) struct Partial<const N: usize> {
    /// Moments of each interval.
    pub rows: Vec<[f64; N]>,
    /// Corrections of each grid point; empty if no datum was in doubt.
    pub corrections: Vec<f64>,
}

/// Adding 2⁵² rounds a small number to an integer and leaves it in the lowest bits.
pub(super) const ROUND: f64 = 4_503_599_627_370_496.0;

/// How data find their intervals.
pub(super) trait Places: Sync {
    /// The number of the interval of each datum of a chunk, in the lowest bits, and its distance from the centre of that interval in units of h,
    /// two data of one interval being seen from one centre to the last bit. True if rounding could have decided on any.
    fn find<const KINKED: bool, const DOUBT: bool>(
        &self,
        points: &[f64; CHUNK],
        index: &mut [u64; CHUNK],
        distance: &mut [f64; CHUNK],
    ) -> bool;
}

/// One pass over a block of data.
struct Sweep<'a, B, P, const N: usize, const DOUBT: bool> {
    basis: B,
    places: &'a P,
    shape: Shape,
    lattice: &'a Lattice<'a>,
    partition: &'a Partition,
    points: &'a [f64],
    weights: Option<&'a [f64]>,
    run: usize,
    /// Cleared, and cleared again afterwards: kept from block to block, as new memory costs as much as filling it.
    table: &'a mut Table<N>,
}

/// What is known of the data of a chunk: interval, and the lifted numbers of [`Basis::lift`].
struct Scratch {
    index: [u64; CHUNK],
    first: [f64; CHUNK],
    second: [f64; CHUNK],
}

/// The moments of the intervals since the last closing, a power of two of rows. One copy: two would spare data that fall into one interval in
/// turn a wait of some nanoseconds, but their tables would not stay in the first cache, which costs more on any other data.
///
/// Rows begin at multiples of their size, so that none lies across two lines of the cache.
struct Table<const N: usize> {
    numbers: Vec<f64>,
    first: usize,
    rows: usize,
}

impl<const N: usize> Table<N> {
    fn new(intervals: usize) -> Self {
        /// `f64`s in a line of the cache.
        const LINE: usize = 8;
        let rows = intervals.next_power_of_two();
        let numbers = zeros(0.0, rows * N + LINE);
        let first = numbers
            .as_ptr()
            .align_offset(LINE * size_of::<f64>())
            .min(LINE);
        Self {
            numbers,
            first,
            rows,
        }
    }

    #[inline(always)]
    fn rows(&mut self) -> &mut [[f64; N]] {
        self.numbers[self.first..self.first + self.rows * N]
            .as_chunks_mut()
            .0
    }
}

impl<B: Basis<N>, P: Places, const N: usize, const DOUBT: bool> WithSimd
    for Sweep<'_, B, P, N, DOUBT>
{
    type Output = Partial<N>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _simd: S) -> Partial<N> {
        let mut partial = Partial {
            rows: zeros([0.0; N], self.partition.centres.len()),
            corrections: Vec::new(),
        };
        let mut scratch = Scratch {
            index: [0; CHUNK],
            first: [0.0; CHUNK],
            second: [0.0; CHUNK],
        };
        let mut since = 0;
        let (chunks, rest) = self.points.as_chunks::<CHUNK>();
        for (number, chunk) in chunks.iter().enumerate() {
            let weights = self
                .weights
                .map(|w| &w[number * CHUNK..(number + 1) * CHUNK]);
            self.add_chunk(chunk, weights, &mut scratch, &mut partial.corrections);
            since += CHUNK;
            if since == self.run {
                close(self.table.rows(), &mut partial.rows);
                since = 0;
            }
        }
        if !rest.is_empty() {
            // filled up with data beyond all windows
            let (mut chunk, mut weights) = ([f64::MIN; CHUNK], [0.0; CHUNK]);
            chunk[..rest.len()].copy_from_slice(rest);
            if let Some(w) = self.weights {
                weights[..rest.len()].copy_from_slice(&w[self.points.len() - rest.len()..]);
            }
            let weights = self.weights.map(|_| &weights[..]);
            self.add_chunk(&chunk, weights, &mut scratch, &mut partial.corrections);
        }
        close(self.table.rows(), &mut partial.rows);
        partial
    }
}

/// Adds the table to the total and clears it.
#[inline(always)]
fn close<const N: usize>(table: &mut [[f64; N]], rows: &mut [[f64; N]]) {
    for i in 0..rows.len() {
        add(&mut rows[i], &table[i]);
        table[i] = [0.0; N];
    }
}

impl<B: Basis<N>, P: Places, const N: usize, const DOUBT: bool> Sweep<'_, B, P, N, DOUBT> {
    #[inline(always)]
    fn add_chunk(
        &mut self,
        points: &[f64; CHUNK],
        weights: Option<&[f64]>,
        scratch: &mut Scratch,
        corrections: &mut Vec<f64>,
    ) {
        let Scratch { index, first, .. } = scratch;
        let doubtful = if B::KINKED {
            self.places.find::<true, DOUBT>(points, index, first)
        } else {
            self.places.find::<false, DOUBT>(points, index, first)
        };
        if doubtful {
            self.settle(points, weights, &scratch.index, corrections);
        }
        if B::LIFTS {
            self.basis.lift(&mut scratch.first, &mut scratch.second);
        }
        match weights {
            None => self.scatter(|_| 1.0, scratch),
            Some(w) => self.scatter(|i| w[i], scratch),
        }
    }

    #[inline(always)]
    fn scatter(&mut self, weight: impl Fn(usize) -> f64, scratch: &Scratch) {
        // by value, so that the compiler need not fear that the table overlaps it
        let basis = self.basis;
        let table = self.table.rows();
        let mask = table.len() - 1;
        for i in 0..CHUNK {
            // a mask is cheaper than a check
            let total = &mut table[scratch.index[i] as usize & mask];
            let mut row = basis.row(scratch.first[i], scratch.second[i]);
            for k in 0..N {
                row[k] *= weight(i);
            }
            add(total, &row);
        }
    }

    /// Lets the definition decide on the data near a breakpoint, and notes what that changes.
    #[cold]
    #[inline(never)]
    fn settle(
        &self,
        points: &[f64; CHUNK],
        weights: Option<&[f64]>,
        index: &[u64; CHUNK],
        corrections: &mut Vec<f64>,
    ) {
        let cells = self.lattice.grid.len();
        corrections.resize(cells, 0.0);
        let one = self.basis.at(0.0);
        for i in 0..CHUNK {
            let x = points[i];
            let [entered, passed, left] = self.partition.counts[index[i] as u32 as usize];
            let mut settled = [usize::MAX; 3];
            for (family, position) in self.lattice.positions(x).into_iter().enumerate() {
                if !(position > -0.5 && position < cells as f64 - 0.5)
                    || (family == 1 && !B::KINKED)
                {
                    continue;
                }
                // this is looked at for all data of a chunk: `round` would be a call
                let nearest = (position + ROUND) - ROUND;
                if (position - nearest).abs() > self.lattice.doubt {
                    continue;
                }
                let j = nearest as usize;
                if settled.contains(&j) {
                    continue;
                }
                settled[family] = j;
                let u = (self.lattice.grid.coordinate(0, j) - x) / self.lattice.h;
                let j = j as u32;
                let assigned = if left <= j && j < entered {
                    let side = if B::KINKED && j < passed {
                        Side::Left
                    } else {
                        Side::Right
                    };
                    self.basis.value(&one, u, side)
                } else {
                    0.0
                };
                let weight = weights.map_or(1.0, |w| w[i]);
                corrections[j as usize] += weight * (self.shape.value(u) - assigned);
            }
        }
    }
}

/// The moments of all intervals and the corrections of all grid points.
pub(super) fn sweep<B: Basis<N>, P: Places, const N: usize, const DOUBT: bool>(
    sum: &KernelSum<1>,
    lattice: &Lattice<'_>,
    partition: &Partition,
    places: &P,
    basis: B,
) -> Partial<N> {
    let size = block(partition.centres.len());
    let arch = Arch::new();
    let blocks: Vec<Partial<N>> = sum
        .sample()
        .coordinates()
        .par_chunks(size)
        .enumerate()
        .map_init(
            || Table::new(partition.centres.len()),
            |table, (number, points)| {
                let start = number * size;
                let weights = match sum.sample().weights() {
                    Weights::Equal(_) => None,
                    Weights::Each(weights) => Some(&weights[start..start + points.len()]),
                };
                arch.dispatch(Sweep::<B, P, N, DOUBT> {
                    basis,
                    places,
                    shape: sum.shape(),
                    lattice,
                    partition,
                    points,
                    weights,
                    run: lattice.run(sum),
                    table,
                })
            },
        )
        .collect();
    // in the order of the data, whoever finished first
    let mut blocks = blocks.into_iter();
    let mut total = blocks.next().expect("a sample has at least one point");
    for block in blocks {
        for (row, more) in total.rows.iter_mut().zip(&block.rows) {
            add(row, more);
        }
        if !block.corrections.is_empty() {
            total.corrections.resize(lattice.grid.len(), 0.0);
            for (sum, more) in total.corrections.iter_mut().zip(&block.corrections) {
                *sum += more;
            }
        }
    }
    total
}

#[inline(always)]
fn add<const N: usize>(total: &mut [f64; N], more: &[f64; N]) {
    // by number: iterators are functions, and what is not inlined is not compiled for wide registers
    for k in 0..N {
        total[k] += more[k];
    }
}
