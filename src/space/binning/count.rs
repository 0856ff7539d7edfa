//! Histograms: how many points, or what mass, each cell of a grid holds.

use super::{BLOCK, CHUNK, ROUNDER, clamp, in_lanes, largest, split};
use crate::space::Grid;
use pulp::{Arch, Simd, WithSimd};

/// What the cells of a grid received, and what fell outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Counts<T> {
    /// Points below the first cell.
    pub below: T,
    /// Points in each cell.
    pub inside: Vec<T>,
    /// Points above the last cell.
    pub above: T,
}

/// How many of `points` lie in each cell of `grid`.
///
/// A cell is closed below and open above, the last one closed on both sides; its edges are the numbers `low + i·width` rounded once, and
/// a point is compared with these very numbers, so that data on a lattice never land on the wrong side of an edge. O(n), about 1 ns a point
/// below 10⁴ cells.
pub fn count(points: &[f64], grid: &Grid<1>) -> Counts<u64> {
    let edges = Edges::of(grid);
    let size = edges.table();
    // two tables used in turn, so that points in the same cell do not wait for each other; one where the cache would not hold both
    let copies = if size <= 1 << 13 { 2 } else { 1 };
    let table = in_lanes(
        points.len(),
        8 * size,
        |lane| {
            Arch::new().dispatch(Count {
                points: &points[lane],
                edges,
                copies,
            })
        },
        |sum, term| *sum += term,
    );
    edges.unpack(table)
}

/// The mass of `points` in each cell of `grid`: the sum of their `weights`, which must be finite and at least 0.
///
/// Cells as for [`count`]; sums as the module says. O(n).
pub fn weigh(points: &[f64], weights: &[f64], grid: &Grid<1>) -> Counts<f64> {
    let edges = Edges::of(grid);
    let unit = largest(weights);
    let table = in_lanes(
        points.len(),
        16 * edges.table(),
        |lane| {
            Arch::new().dispatch(Weigh {
                points: &points[lane.clone()],
                weights: &weights[lane],
                unit,
                edges,
            })
        },
        |sum: &mut [f64; 2], term| {
            sum[0] += term[0];
            sum[1] += term[1];
        },
    );
    edges.unpack(
        table
            .into_iter()
            .map(|[high, low]| (high + low) * unit)
            .collect(),
    )
}

/// The edges of a grid's cells, prepared for the search.
#[derive(Clone, Copy)]
struct Edges {
    low: f64,
    high: f64,
    width: f64,
    inverse: f64,
    cells: usize,
    /// Distance from an edge, in cells, below which the quick formula is not trusted.
    slack: f64,
}

impl Edges {
    fn of(grid: &Grid<1>) -> Self {
        let ([low], [high], [cells]) = (grid.low(), grid.high(), grid.cells());
        let width = grid.width(0);
        // (x - low) / width in floating point is off by a few units of rounding of itself; the edges, by half a unit of theirs
        let slack =
            f64::EPSILON * (4.0 * cells as f64 + 2.0 * low.abs().max(high.abs()) / width + 4.0);
        Self {
            low,
            high,
            width,
            inverse: width.recip(),
            cells,
            slack: slack.max(1e-12),
        }
    }

    fn edge(&self, i: usize) -> f64 {
        if i == self.cells {
            self.high
        } else {
            (i as f64).mul_add(self.width, self.low)
        }
    }

    /// Guard cell, cells, guard cell; rounded up to a power of two for the mask.
    fn table(&self) -> usize {
        (self.cells + 2).next_power_of_two()
    }

    /// The cell of `x` by comparison with the edges: 0 below, `cells + 1` above.
    fn exact(&self, x: f64) -> u32 {
        if x < self.low {
            return 0;
        }
        if x >= self.high {
            let last = self.cells + usize::from(x > self.high);
            return last as u32;
        }
        let mut i = (((x - self.low) / self.width) as usize).min(self.cells - 1);
        while i > 0 && x < self.edge(i) {
            i -= 1;
        }
        while i + 1 < self.cells && x >= self.edge(i + 1) {
            i += 1;
        }
        i as u32 + 1
    }

    #[inline(always)]
    fn locate(&self, points: &[f64], index: &mut [u32; CHUNK]) {
        let (low, inverse, top) = (self.low, self.inverse, self.cells as f64 + 0.25);
        // rounding t - ½ is the floor; near an edge the two sides of the slack differ
        let (up, down) = (self.slack - 0.5, -self.slack - 0.5);
        let mut doubtful = u32::from(self.slack >= 0.2);
        for (i, &x) in index.iter_mut().zip(points) {
            let t = clamp((x - low) * inverse, -0.75, top);
            let above = (t + up + ROUNDER).to_bits() as u32;
            let below = (t + down + ROUNDER).to_bits() as u32;
            doubtful |= above ^ below;
            *i = below.wrapping_add(1);
        }
        if doubtful != 0 {
            self.settle(points, index);
        }
    }

    #[cold]
    #[inline(never)]
    fn settle(&self, points: &[f64], index: &mut [u32; CHUNK]) {
        for (i, &x) in index.iter_mut().zip(points) {
            let t = (x - self.low) * self.inverse;
            if (t - t.round()).abs() <= 2.0 * self.slack || self.slack >= 0.2 {
                *i = self.exact(x);
            }
        }
    }

    fn unpack<T: Copy>(&self, table: Vec<T>) -> Counts<T> {
        let mut inside = table;
        let above = inside[self.cells + 1];
        inside.truncate(self.cells + 1);
        let below = inside.remove(0);
        Counts {
            below,
            inside,
            above,
        }
    }
}

struct Count<'a> {
    points: &'a [f64],
    edges: Edges,
    copies: usize,
}

impl WithSimd for Count<'_> {
    type Output = Vec<u64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<u64> {
        let Self {
            points,
            edges,
            copies,
        } = self;
        let size = edges.table();
        let mut even = vec![0u32; size];
        let mut odd = vec![0u32; if copies == 2 { size } else { 0 }];
        let mut total = vec![0u64; size];
        let mut index = [0u32; CHUNK];
        // flushed long before a count of 32 bits is full
        for block in points.chunks(1 << 31) {
            for chunk in block.chunks(CHUNK) {
                edges.locate(chunk, &mut index);
                let cells = &index[..chunk.len()];
                if copies == 2 {
                    let (even, odd) = (even.as_mut_slice(), odd.as_mut_slice());
                    for pair in cells.chunks(2) {
                        even[pair[0] as usize & (size - 1)] += 1;
                        if let Some(&second) = pair.get(1) {
                            odd[second as usize & (size - 1)] += 1;
                        }
                    }
                } else {
                    let even = even.as_mut_slice();
                    for &cell in cells {
                        even[cell as usize & (size - 1)] += 1;
                    }
                }
            }
            for table in [&mut even, &mut odd] {
                for (sum, count) in total.iter_mut().zip(table) {
                    *sum += u64::from(*count);
                    *count = 0;
                }
            }
        }
        total
    }
}

struct Weigh<'a> {
    points: &'a [f64],
    weights: &'a [f64],
    unit: f64,
    edges: Edges,
}

impl WithSimd for Weigh<'_> {
    type Output = Vec<[f64; 2]>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<[f64; 2]> {
        let Self {
            points,
            weights,
            unit,
            edges,
        } = self;
        let size = edges.table();
        let mut table = vec![[0.0; 2]; size];
        let mut index = [0u32; CHUNK];
        for (points, weights) in points.chunks(BLOCK).zip(weights.chunks(BLOCK)) {
            for (chunk, weights) in points.chunks(CHUNK).zip(weights.chunks(CHUNK)) {
                edges.locate(chunk, &mut index);
                let table = table.as_mut_slice();
                for (&cell, &weight) in index.iter().zip(weights) {
                    let (high, low) = split(weight / unit);
                    let row = &mut table[cell as usize & (size - 1)];
                    row[0] += high;
                    row[1] += low;
                }
            }
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn grid(low: f64, high: f64, cells: usize) -> Grid<1> {
        Grid::new([low], [high], [cells]).expect("legal")
    }

    /// The definition: the number of edges not above x.
    fn judge(points: &[f64], grid: &Grid<1>) -> Counts<u64> {
        let edges = Edges::of(grid);
        let mut inside = vec![0; edges.cells];
        let (mut below, mut above) = (0, 0);
        for &x in points {
            if x < grid.low()[0] {
                below += 1;
            } else if x > grid.high()[0] {
                above += 1;
            } else {
                let cell = (1..edges.cells).filter(|&i| edges.edge(i) <= x).count();
                inside[cell] += 1;
            }
        }
        Counts {
            below,
            inside,
            above,
        }
    }

    #[test]
    fn a_lattice_of_data_on_the_edges_goes_up() {
        // 0.1 i is rarely a binary number, and dividing it by 0.1 rounds either way
        let grid = grid(0.0, 1000.0, 10_000);
        let points: Vec<f64> = (0..10_000)
            .map(|i| f64::from(i).mul_add(0.1, 0.0))
            .collect();
        let counts = count(&points, &grid);
        assert!(
            counts.inside.iter().all(|&c| c == 1),
            "each edge opens its cell"
        );
        assert_eq!(count(&[1000.0], &grid).inside[9999], 1);
    }

    #[test]
    fn a_million_ties_are_counted_and_weighed() {
        let grid = grid(0.0, 4.0, 4);
        let points = vec![1.5; 1_000_003];
        assert_eq!(count(&points, &grid).inside, [0, 1_000_003, 0, 0]);
        let mass = weigh(&points, &vec![0.1; points.len()], &grid).inside[1];
        assert!((mass / 100_000.3 - 1.0).abs() < 1e-15, "{mass}");
    }

    #[test]
    fn threads_do_not_change_a_bit() {
        let points: Vec<f64> = (0..700_001)
            .map(|i| (f64::from(i) * 0.618).fract())
            .collect();
        let weights: Vec<f64> = points.iter().map(|x| 1.0 / (x + 1e-3)).collect();
        let grid = grid(0.1, 0.9, 37);
        let run = |threads| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("threads")
                .install(|| weigh(&points, &weights, &grid))
        };
        let one = run(1);
        assert_eq!(one, run(2));
        assert_eq!(one, run(7));
    }

    proptest! {
        #[test]
        fn counts_are_those_of_comparisons(
            low in -1e3..1e3_f64, offset in prop::sample::select(vec![0.0, 1e9]), width in 1e-3..10.0_f64,
            cells in 1usize..40, unit in prop::collection::vec(-0.2..1.2_f64, 1..200), on_edges in any::<bool>(),
        ) {
            let low = low + offset;
            let grid = grid(low, low + width * cells as f64, cells);
            let points: Vec<f64> = unit.iter().map(|u| {
                let t = u * cells as f64;
                if on_edges { t.round().mul_add(grid.width(0), low) } else { t.mul_add(grid.width(0), low) }
            }).collect();
            let expected = judge(&points, &grid);
            prop_assert_eq!(&count(&points, &grid), &expected);
            let mass = weigh(&points, &vec![0.5; points.len()], &grid);
            for (m, c) in mass.inside.iter().zip(&expected.inside) {
                prop_assert!((m - 0.5 * *c as f64).abs() < 1e-12);
            }
        }
    }
}
