//! The pass over the data: to each datum its interval, to each interval its moments.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::super::basis::{Basis, CHUNK, Side};
use super::lattice::{Lattice, Partition, block};
use crate::kernel::{Kernel, KernelSum, Shape};
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

/// One pass over a block of data.
struct Sweep<'a, B, const N: usize, const DOUBT: bool> {
    basis: B,
    shape: Shape,
    lattice: &'a Lattice<'a>,
    partition: &'a Partition,
    /// The centres of the intervals, their number rounded up to a power of two.
    centres: &'a [f64],
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

/// The moments of the intervals since the last closing. One copy: two would spare data that fall into one interval in turn a wait of some
/// nanoseconds, but their tables would not stay in the first cache, which costs more on any other data.
///
/// Rows begin at multiples of their size, so that none lies across two lines of the cache. Where the basis fills one number less than its
/// row has, the last one is the centre of the interval: it is wanted at the same time.
struct Table<const N: usize> {
    numbers: Vec<f64>,
    first: usize,
}

impl<const N: usize> Table<N> {
    /// Whether the last number of a row is the centre: not so for bases of one or two functions, which fill theirs.
    const CENTRED: bool = N >= 4;

    fn new(centres: &[f64]) -> Self {
        /// `f64`s in a line of the cache.
        const LINE: usize = 8;
        let numbers = vec![0.0; centres.len() * N + LINE];
        let first = numbers
            .as_ptr()
            .align_offset(LINE * size_of::<f64>())
            .min(LINE);
        let mut table = Self { numbers, first };
        if Self::CENTRED {
            for (row, centre) in table.rows(centres.len()).iter_mut().zip(centres) {
                row[N - 1] = *centre;
            }
        }
        table
    }

    #[inline(always)]
    fn rows(&mut self, count: usize) -> &mut [[f64; N]] {
        self.numbers[self.first..self.first + count * N]
            .as_chunks_mut()
            .0
    }
}

impl<B: Basis<N>, const N: usize, const DOUBT: bool> WithSimd for Sweep<'_, B, N, DOUBT> {
    type Output = Partial<N>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _simd: S) -> Partial<N> {
        let intervals = self.partition.centres.len();
        let mut partial = Partial {
            rows: Vec::new(),
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
                close(self.table.rows(intervals), &mut partial.rows);
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
        close(self.table.rows(intervals), &mut partial.rows);
        partial
    }
}

/// Adds the table to the total and clears it.
#[inline(always)]
fn close<const N: usize>(table: &mut [[f64; N]], rows: &mut Vec<[f64; N]>) {
    rows.resize(table.len(), [0.0; N]);
    let filled = N - usize::from(Table::<N>::CENTRED);
    for (row, more) in rows.iter_mut().zip(table) {
        for k in 0..filled {
            row[k] += more[k];
            more[k] = 0.0;
        }
    }
}

impl<B: Basis<N>, const N: usize, const DOUBT: bool> Sweep<'_, B, N, DOUBT> {
    #[inline(always)]
    fn add_chunk(
        &mut self,
        points: &[f64; CHUNK],
        weights: Option<&[f64]>,
        scratch: &mut Scratch,
        corrections: &mut Vec<f64>,
    ) {
        if self.classify(points, &mut scratch.index) {
            self.settle(points, weights, &scratch.index, corrections);
        }
        if B::LIFTS {
            let (centres, scale) = (&self.partition.centres[..], self.lattice.scale);
            for i in 0..CHUNK {
                scratch.first[i] = (points[i] - centres[scratch.index[i] as u32 as usize]) * scale;
            }
            self.basis.lift(&mut scratch.first, &mut scratch.second);
        }
        match weights {
            None => self.scatter(points, |_| 1.0, scratch),
            Some(w) => self.scatter(points, |i| w[i], scratch),
        }
    }

    #[inline(always)]
    fn scatter(&mut self, points: &[f64; CHUNK], weight: impl Fn(usize) -> f64, scratch: &Scratch) {
        // by value, so that the compiler need not fear that the table overlaps them
        let (basis, scale) = (self.basis, self.lattice.scale);
        let size = self.centres.len();
        let (centres, table) = (&self.centres[..size], &mut self.table.rows(size)[..size]);
        for i in 0..CHUNK {
            // a mask is cheaper than a check
            let interval = scratch.index[i] as usize & (size - 1);
            let total = &mut table[interval];
            let mut row = if B::LIFTS {
                basis.row(scratch.first[i], scratch.second[i])
            } else {
                let centre = if Table::<N>::CENTRED {
                    total[N - 1]
                } else {
                    centres[interval]
                };
                basis.row((points[i] - centre) * scale, 0.0)
            };
            for moment in &mut row {
                *moment *= weight(i);
            }
            if Table::<N>::CENTRED {
                row[N - 1] = 0.0;
            }
            add(total, &row);
        }
    }

    /// The interval of each datum: how many breakpoints of each progression it has passed, added up. True if any is in doubt.
    #[inline(always)]
    fn classify(&self, points: &[f64; CHUNK], index: &mut [u64; CHUNK]) -> bool {
        /// Adding 2⁵² rounds a small number to an integer and leaves it in the lowest bits.
        const ROUND: f64 = 4_503_599_627_370_496.0;
        let Lattice {
            first,
            inverse,
            reach,
            doubt,
            ..
        } = *self.lattice;
        let most = self.lattice.grid.len() as f64;
        let limit = 0.5 - doubt;
        let shifts = [0.5 + reach, 0.5 - reach, 0.5];
        let mut doubtful = 0;
        for i in 0..CHUNK {
            let t = (points[i] - first) * inverse;
            let mut total = 0_u64;
            let mut worst = 0.0;
            for shift in &shifts[..if B::KINKED { 3 } else { 2 }] {
                // comparisons written so that each is one instruction
                let passed = t + shift;
                let passed = if passed > 0.0 { passed } else { 0.0 };
                let passed = if passed < most { passed } else { most };
                let rounded = passed + ROUND;
                total = total.wrapping_add(rounded.to_bits());
                if DOUBT {
                    let off = (passed - (rounded - ROUND)).abs();
                    worst = if off > worst { off } else { worst };
                }
            }
            if DOUBT {
                doubtful |= u64::from(worst > limit);
            }
            index[i] = total;
        }
        doubtful != 0
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
                let nearest = position.round();
                if (position - nearest).abs() > self.lattice.doubt
                    || !(0.0..cells as f64).contains(&nearest)
                    || (family == 1 && !B::KINKED)
                {
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
pub(super) fn sweep<B: Basis<N>, const N: usize, const DOUBT: bool>(
    sum: &KernelSum<1>,
    lattice: &Lattice<'_>,
    partition: &Partition,
    basis: B,
) -> Partial<N> {
    let size = block(partition.centres.len());
    let mut centres = partition.centres.clone();
    centres.resize(centres.len().next_power_of_two(), 0.0);
    let arch = Arch::new();
    let blocks: Vec<Partial<N>> = sum
        .sample()
        .coordinates()
        .par_chunks(size)
        .enumerate()
        .map_init(
            || Table::new(&centres),
            |table, (number, points)| {
                let start = number * size;
                let weights = match sum.sample().weights() {
                    Weights::Equal(_) => None,
                    Weights::Each(weights) => Some(&weights[start..start + points.len()]),
                };
                arch.dispatch(Sweep::<B, N, DOUBT> {
                    basis,
                    shape: sum.shape(),
                    lattice,
                    partition,
                    centres: &centres,
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
    for (sum, term) in total.iter_mut().zip(more) {
        *sum += term;
    }
}
