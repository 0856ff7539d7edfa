//! The grid as the data see it, and the intervals into which its breakpoints cut the line.

use super::super::Unsupported;
use super::super::basis::CHUNK;
use super::super::bound::{expansion_error, expansion_terms, flatness};
use super::regular::Regular;
use crate::kernel::{KernelSum, Shape};
use crate::space::Grid;

/// Beyond this many cells the tables of intervals would be larger than a GiB.
const MOST_CELLS: usize = 1 << 21;

/// The grid as the data see it: positions t = (x - x₀) / width, windows of `reach` to both sides.
pub(in crate::engine) struct Lattice<'a> {
    pub grid: &'a Grid<1>,
    pub h: f64,
    pub first: f64,
    pub inverse: f64,
    /// 1 / h.
    pub scale: f64,
    pub reach: f64,
    /// Half the width, in t, of the zone around a breakpoint in which rounding could decide; 0 where the kernel is so flat at its
    /// ends that either decision is right to rounding.
    pub doubt: f64,
    /// What data on the wrong side of a breakpoint cost at most, relative to the ceiling.
    misplaced: f64,
    pub kink: bool,
}

/// What a datum that is assigned to the wrong side of a breakpoint may cost, relative to the peak of the kernel.
const NEGLIGIBLE: f64 = 4e-13;

impl<'a> Lattice<'a> {
    pub(in crate::engine) fn new(
        grid: &'a Grid<1>,
        h: f64,
        shape: Shape,
    ) -> Result<Self, Unsupported> {
        let (width, cells) = (grid.width(0), grid.len());
        if cells > MOST_CELLS {
            return Err(Unsupported(format!(
                "{cells} cells are more than its tables may hold ({MOST_CELLS})"
            )));
        }
        let reach = h / width;
        let span = grid.low()[0].abs().max(grid.high()[0].abs()) / width;
        // half an epsilon each: of t, its difference, factor, product and sum with the reach; of places, those of the grid's first and j-th
        // point; of the reach, itself twice, the two steps of u, and two sums; and a quarter more for what comes of all these together
        let doubt = f64::EPSILON * (2.5 * cells as f64 + 1.25 * span + 5.0 * reach);
        // not < : NaN and infinity are refused too
        if !(doubt < 0.25 && width.recip().is_finite()) {
            return Err(Unsupported(
                "cells are so thin beside h or beside their place that rounding could move data across them".to_owned(),
            ));
        }
        // K / K(0) within ε of its end is at most (2ε)ˢ
        let cost = (2.0 * doubt / reach).powi(flatness(shape));
        let negligible = cost < NEGLIGIBLE;
        let kink = shape == Shape::Triangular;
        Ok(Self {
            grid,
            h,
            first: grid.coordinate(0, 0),
            inverse: width.recip(),
            scale: h.recip(),
            reach,
            doubt: if negligible { 0.0 } else { doubt },
            misplaced: if negligible { cost } else { 0.0 },
            kink,
        })
    }

    pub(in crate::engine) fn intervals(&self) -> usize {
        (2 + usize::from(self.kink)) * self.grid.len() + 1
    }

    /// Half the longest interval, in units of h.
    pub(in crate::engine) fn half_interval(&self) -> f64 {
        // intervals are at most a cell or a window long; those that lie under all windows may be as long as the windows
        let wide = self.grid.len() as f64 <= 2.0 * self.reach;
        if wide {
            1.0
        } else {
            (0.5 / self.reach).min(1.0)
        }
    }

    /// Data between two closings, which end the chains of additions before their roundings add up: a multiple of [`CHUNK`].
    pub(super) fn run(&self, sum: &KernelSum<1>) -> usize {
        let terms = expansion_terms(sum, self.half_interval());
        let allowed = (4096.0 / terms).min(1e9) as usize;
        let rows = self.rows();
        allowed
            .clamp(1024, block(rows))
            .max(rows / 2)
            .next_multiple_of(CHUNK)
    }

    /// How many intervals the pass over the data tells apart.
    fn rows(&self) -> usize {
        Regular::new(self).map_or_else(|| self.intervals(), Regular::rows)
    }

    /// Bound on the error relative to the ceiling: the roundings of the longest chain of additions, and what may be misplaced.
    pub(super) fn error(&self, sum: &KernelSum<1>) -> f64 {
        let (n, run, block) = (sum.sample().len(), self.run(sum), block(self.rows()));
        let chain = run.min(n) + block.min(n) / run + n / block;
        expansion_error(sum, self.half_interval(), chain) + self.misplaced
    }

    /// Positions of a datum against the progressions of breakpoints: windows entered, centres passed, windows left.
    pub(super) fn positions(&self, x: f64) -> [f64; 3] {
        let t = (x - self.first) * self.inverse;
        [t + self.reach, t, t - self.reach]
    }
}

/// The intervals in ascending order, and those under the window of each grid point.
pub(in crate::engine) struct Partition {
    /// Where interval k begins; it ends where k + 1 begins. The first and the last, beyond all windows, have no length.
    pub edges: Vec<f64>,
    pub centres: Vec<f64>,
    /// Of each interval: windows entered, centres passed, windows left, so that it lies under the windows `left..entered`.
    pub counts: Vec<[u32; 3]>,
    /// Of each grid point: the first interval of its window, the first right of itself, the first beyond.
    pub windows: Vec<[u32; 3]>,
}

impl Partition {
    pub(in crate::engine) fn new(lattice: &Lattice<'_>) -> Self {
        let cells = lattice.grid.len();
        let rows = (2 + usize::from(lattice.kink)) * cells + 1;
        let shifts = [-lattice.reach, 0.0, lattice.reach];
        let (mut edges, mut counts) = (Vec::with_capacity(rows + 1), Vec::with_capacity(rows));
        let mut windows = vec![[0; 3]; cells];
        let mut next = [0_u32, if lattice.kink { 0 } else { cells as u32 }, 0];
        counts.push(next);
        // a merge of two or three sorted lists
        while counts.len() < rows {
            let mut least = 2;
            for family in [1, 0] {
                if (next[family] as usize) < cells
                    && f64::from(next[family]) + shifts[family]
                        <= f64::from(next[least]) + shifts[least]
                {
                    least = family;
                }
            }
            let j = next[least] as usize;
            let x = lattice.grid.coordinate(0, j);
            edges.push(x + [-lattice.h, 0.0, lattice.h][least]);
            next[least] += 1;
            windows[j][least] = counts.len() as u32;
            counts.push(next);
        }
        edges.insert(0, edges[0]);
        edges.push(edges[rows - 1]);
        let centres = edges
            .windows(2)
            .map(|e| e[0] + 0.5 * (e[1] - e[0]))
            .collect();
        Self {
            edges,
            centres,
            counts,
            windows,
        }
    }
}

/// Data per block, the unit of parallel work: enough that closing a block costs nothing beside filling it; a function of the sizes alone, never of the threads.
pub(super) fn block(intervals: usize) -> usize {
    (16 * intervals).max(1 << 18).next_multiple_of(CHUNK)
}
