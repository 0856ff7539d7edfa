//! Intervals told by one rounding: the grid's cells, shifted by h, and where in a cell windows are left.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::super::basis::CHUNK;
use super::lattice::{Lattice, Partition};
use super::sweep::{Places, ROUND};

/// The line cut at all xⱼ - h, as if the grid went on for ever: cell a lies between the a-th and the next. All windows are left, and all centres
/// passed, at the same place of their cell, so that a cell consists of the same two (three) intervals everywhere.
///
/// A datum is in *one* cell and in *one* part of it, whatever rounding does: where xⱼ - h and xᵢ + h are the same place, no datum can be
/// found to have entered without having left and counted as one that has left without having entered, which would be the same number of
/// breakpoints, but another centre. The centre is that of the cell, computed from its number rather than looked up.
#[derive(Clone, Copy)]
pub(super) struct Regular {
    first: f64,
    inverse: f64,
    scale: f64,
    /// What makes the rounded position of a datum the number of windows entered.
    entered: f64,
    /// Where data beyond all windows are put, to both sides.
    least: f64,
    most: f64,
    /// Where in a cell, seen from its middle, windows are left.
    left: f64,
    /// Where centres are passed.
    passed: f64,
    /// The centre of the data of a cell is `start` + a · `width`.
    start: f64,
    width: f64,
    doubt: f64,
    /// Cells before the last that a datum has entered when it leaves.
    overlap: usize,
    /// Cells before the last that a datum has entered when it passes a centre.
    half_overlap: usize,
    cells: usize,
    kink: bool,
}

impl Regular {
    /// None where windows are so much wider than the grid that a cell for each place of their ends would be a waste.
    pub fn new(lattice: &Lattice<'_>) -> Option<Self> {
        let cells = lattice.grid.len();
        let reach = lattice.reach;
        let overlap = (2.0 * reach).floor();
        if overlap > cells as f64 {
            return None;
        }
        let left = 2.0 * reach - overlap - 0.5;
        let passed = if lattice.kink {
            reach - reach.floor() - 0.5
        } else {
            left
        };
        // where rounding is in no doubt
        let far = |place: f64| (place - left).abs().min((place - passed).abs());
        let least = [0.0, 0.15, 0.3]
            .into_iter()
            .max_by(|a, b| far(*a).total_cmp(&far(*b)))
            .unwrap_or(0.0);
        let width = lattice.grid.width(0);
        let half = lattice.h.min(0.5 * width);
        Some(Self {
            first: lattice.first,
            inverse: lattice.inverse,
            scale: lattice.scale,
            entered: 0.5 + reach,
            least,
            most: cells as f64 + overlap + 1.0 + least,
            left,
            passed,
            start: lattice.first - (lattice.h - half) - width,
            width,
            doubt: lattice.doubt,
            overlap: overlap as usize,
            half_overlap: reach.floor() as usize,
            cells,
            kink: lattice.kink,
        })
    }

    /// Intervals of a cell.
    fn parts(self) -> usize {
        2 + usize::from(self.kink)
    }

    /// Intervals in all: those of the cells 0 (nothing entered) to the last (all left).
    pub fn rows(self) -> usize {
        self.parts() * (self.cells + self.overlap + 2)
    }

    /// Of each part of a cell: whether centres are passed, whether windows are left, and where it begins.
    fn part(self, part: usize) -> (bool, bool, f64) {
        let left_first = !self.kink || self.left <= self.passed;
        let [near, far] = if left_first {
            [self.left, self.passed]
        } else {
            [self.passed, self.left]
        };
        match part {
            0 => (false, false, 0.0),
            1 => (!left_first, left_first, near + 0.5),
            _ => (true, true, far + 0.5),
        }
    }

    pub fn partition(self, lattice: &Lattice<'_>) -> Partition {
        let rows = self.rows();
        let parts = self.parts();
        let (mut edges, mut counts) = (Vec::with_capacity(rows + 1), Vec::with_capacity(rows));
        let mut centres = Vec::with_capacity(rows);
        let from = lattice.first - lattice.h;
        let count = |a: usize, overlap: usize, passed: bool| {
            (a + usize::from(passed))
                .saturating_sub(overlap + 1)
                .min(self.cells) as u32
        };
        for row in 0..rows {
            let (a, part) = (row / parts, row % parts);
            let (passed, left, begins) = self.part(part);
            edges.push(from + (a as f64 - 1.0 + begins) * self.width);
            centres.push(self.start + a as f64 * self.width);
            counts.push([
                a.min(self.cells) as u32,
                count(a, self.half_overlap, passed),
                count(a, self.overlap, left),
            ]);
        }
        edges.push(from + (rows / parts) as f64 * self.width);
        let [passes, leaves] =
            [|p: (bool, bool, f64)| p.0, |p: (bool, bool, f64)| p.1].map(|wanted| {
                (0..parts)
                    .position(|part| wanted(self.part(part)))
                    .unwrap_or(0)
            });
        let windows = (1..=self.cells)
            .map(|a| {
                [
                    a * parts,
                    (a + self.half_overlap) * parts + passes,
                    (a + self.overlap) * parts + leaves,
                ]
                .map(|row| row as u32)
            })
            .collect();
        Partition {
            edges,
            centres,
            counts,
            windows,
        }
    }
}

impl Places for Regular {
    #[inline(always)]
    fn find<const KINKED: bool, const DOUBT: bool>(
        &self,
        points: &[f64; CHUNK],
        index: &mut [u64; CHUNK],
        distance: &mut [f64; CHUNK],
    ) -> bool {
        let here = *self;
        let limit = 0.5 - here.doubt;
        let mut doubtful = 0;
        for i in 0..CHUNK {
            let x = points[i];
            // comparisons written so that each is one instruction
            let t = (x - here.first) * here.inverse + here.entered;
            let t = if t > here.least { t } else { here.least };
            let t = if t < here.most { t } else { here.most };
            let rounded = t + ROUND;
            let cell = rounded - ROUND;
            let place = t - cell;
            let part = u64::from(place >= here.left);
            let number = rounded.to_bits();
            index[i] = if KINKED {
                number.wrapping_mul(3) + part + u64::from(place >= here.passed)
            } else {
                number.wrapping_mul(2) + part
            };
            if DOUBT {
                doubtful |= u64::from(place.abs() > limit);
                doubtful |= u64::from((place - here.left).abs() < here.doubt);
                if KINKED {
                    doubtful |= u64::from((place - here.passed).abs() < here.doubt);
                }
            }
            distance[i] = (x - (here.start + cell * here.width)) * here.scale;
        }
        doubtful != 0
    }
}
