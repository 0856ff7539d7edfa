//! Sums of moments over any run of consecutive items, in constant time and without subtracting.
//!
//! Differences of one long prefix sum would cancel: moments about a common origin grow with the distance from it. Here the items are
//! grouped into *cells* not longer than half a window, and each item knows the moments of its cell up to and from itself, about the
//! centre of the cell. The items under a window then are the end of one cell, a few whole cells and the beginning of another: a sum of
//! positive parts, each seen from less than one and a half bandwidths away.

use super::basis::{Basis, Side};
use super::pieces::pieces;
use crate::numeric::Sum;
use rayon::prelude::*;

/// Some data close together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item<const N: usize> {
    /// No datum is below.
    pub low: f64,
    /// No datum is above.
    pub high: f64,
    /// Where the moments are seen from.
    pub centre: f64,
    /// The moments, distances in units of h.
    pub moments: [f64; N],
}

#[derive(Clone, Copy, Debug)]
struct Rung<const N: usize> {
    cell: u32,
    /// Moments of the cell up to and including this item, about the centre of the cell.
    upto: [f64; N],
    /// Moments of the cell from this item on.
    from: [f64; N],
}

#[derive(Clone, Copy, Debug)]
struct Cell {
    centre: f64,
    first: usize,
    /// One past the last item.
    end: usize,
}

/// Items in ascending order, ready for sums over runs of them. O(items) to build.
pub(super) struct Ladder<B, const N: usize> {
    basis: B,
    scale: f64,
    items: Vec<Item<N>>,
    rungs: Vec<Rung<N>>,
    cells: Vec<Cell>,
}

/// Runs of so few items are added one by one: no dearer, and exact to the last bits.
const FEW: usize = 4;

/// The rungs of one cell from the moments of its items about its centre.
fn climb<const N: usize>(rungs: &mut [Rung<N>], items: impl Iterator<Item = [f64; N]>, cell: u32) {
    let mut total = [Sum::default(); N];
    for (rung, moments) in rungs.iter_mut().zip(items) {
        total
            .iter_mut()
            .zip(moments)
            .for_each(|(sum, m)| sum.add(m));
        // kept for the way back, where it is overwritten by the sum
        rung.from = moments;
        rung.upto = total.map(Sum::value);
        rung.cell = cell;
    }
    total = [Sum::default(); N];
    for rung in rungs.iter_mut().rev() {
        total
            .iter_mut()
            .zip(rung.from)
            .for_each(|(sum, m)| sum.add(m));
        rung.from = total.map(Sum::value);
    }
}

impl<B: Basis<N>, const N: usize> Ladder<B, N> {
    /// Items in ascending order; `scale` is 1/h; `window` the length that all later runs span.
    pub(super) fn new(basis: B, scale: f64, window: f64, items: Vec<Item<N>>) -> Self {
        let mut cells = Vec::new();
        let mut first = 0;
        while first < items.len() {
            let low = items[first].low;
            // an item longer than half a window is a cell of its own
            let more = items[first + 1..]
                .iter()
                .take_while(|item| item.high - low <= 0.5 * window)
                .count();
            let end = first + 1 + more;
            let centre = low + 0.5 * (items[end - 1].high - low);
            cells.push(Cell { centre, first, end });
            first = end;
        }
        let blank = Rung {
            cell: 0,
            upto: [0.0; N],
            from: [0.0; N],
        };
        let mut rungs = vec![blank; items.len()];
        pieces(&mut rungs, cells.iter().map(|cell| cell.end - cell.first))
            .zip(&cells)
            .enumerate()
            .with_min_len(8)
            .for_each(|(number, (rungs, cell))| {
                let seen = |item: &Item<N>| {
                    basis.shift(&item.moments, (item.centre - cell.centre) * scale)
                };
                let items = &items[cell.first..cell.end];
                climb(rungs, items.iter().map(seen), number as u32);
            });
        Self {
            basis,
            scale,
            items,
            rungs,
            cells,
        }
    }

    /// The items.
    pub(super) fn items(&self) -> &[Item<N>] {
        &self.items
    }

    /// Σ w K((x - X)/h) over the data of the items `first..end`, all of which lie in the piece of the kernel on `side` of their targets.
    #[inline]
    pub(super) fn sum(&self, first: usize, end: usize, x: f64, side: Side) -> f64 {
        if end <= first {
            return 0.0;
        }
        if end - first <= FEW {
            return self.one_by_one(first, end, x, side);
        }
        let from = |moments: &[f64; N], cell: u32| {
            let y = (x - self.cells[cell as usize].centre) * self.scale;
            self.basis.value(moments, y, side)
        };
        let (left, right) = (&self.rungs[first], &self.rungs[end - 1]);
        if left.cell == right.cell {
            let cell = &self.cells[left.cell as usize];
            return if first == cell.first {
                from(&right.upto, right.cell)
            } else if end == cell.end {
                from(&left.from, left.cell)
            } else {
                // only a run shorter than the windows that the cells were made for
                self.one_by_one(first, end, x, side)
            };
        }
        let mut total = from(&left.from, left.cell);
        for cell in left.cell + 1..right.cell {
            total += from(&self.rungs[self.cells[cell as usize].first].from, cell);
        }
        total + from(&right.upto, right.cell)
    }

    fn one_by_one(&self, first: usize, end: usize, x: f64, side: Side) -> f64 {
        self.items[first..end]
            .iter()
            .map(|item| {
                self.basis
                    .value(&item.moments, (x - item.centre) * self.scale, side)
            })
            .sum()
    }
}
