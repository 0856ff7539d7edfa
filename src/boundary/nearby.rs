//! Finding the points that a target near a wall can feel.

use super::Bump;
use crate::kernel::KernelSum;
use crate::space::Point;

/// The points of a sample in cells not smaller than the reach of the kernel, so that those within reach of a place lie in its cell or one beside it.
///
/// O(n) to build; a visit costs what there is to see. Memory for a second copy of the data.
pub(super) struct Nearby<const D: usize> {
    low: Point<D>,
    inverse: [f64; D],
    cells: [usize; D],
    /// Where each cell begins in `points`, and one more; the last axis is the fastest.
    starts: Vec<usize>,
    points: Vec<(Point<D>, f64)>,
}

impl<const D: usize> Nearby<D> {
    /// Sorts the points of `sum`, all of whose bumps are like `bump`, into cells.
    pub(super) fn new(sum: &KernelSum<D>, bump: &Bump<D>) -> Self {
        let sample = sum.sample();
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for point in sample.points() {
            for axis in 0..D {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        // no more cells than points, whatever the width
        let most = (sample.len() as f64).powf(1.0 / D as f64).ceil();
        let reach = bump.reach();
        let cells: [usize; D] = std::array::from_fn(|axis| {
            let across = (high[axis] - low[axis]) / reach[axis];
            across.floor().clamp(1.0, most) as usize
        });
        let inverse = std::array::from_fn(|axis| {
            let inverse = cells[axis] as f64 / (high[axis] - low[axis]);
            if inverse.is_finite() { inverse } else { 0.0 }
        });
        let mut nearby = Self {
            low,
            inverse,
            cells,
            starts: vec![0; cells.iter().product::<usize>() + 1],
            points: Vec::new(),
        };
        let numbers: Vec<usize> = sample.points().iter().map(|x| nearby.cell(*x)).collect();
        for cell in &numbers {
            nearby.starts[cell + 1] += 1;
        }
        for cell in 1..nearby.starts.len() {
            nearby.starts[cell] += nearby.starts[cell - 1];
        }
        let mut next = nearby.starts.clone();
        nearby.points = vec![([0.0; D], 0.0); sample.len()];
        for (i, (point, cell)) in sample.points().iter().zip(&numbers).enumerate() {
            nearby.points[next[*cell]] = (*point, sample.weight(i));
            next[*cell] += 1;
        }
        nearby
    }

    fn along(&self, axis: usize, x: f64) -> usize {
        // a cast takes what is below zero to zero
        (((x - self.low[axis]) * self.inverse[axis]) as usize).min(self.cells[axis] - 1)
    }

    fn cell(&self, x: Point<D>) -> usize {
        (0..D).fold(0, |cell, axis| {
            cell * self.cells[axis] + self.along(axis, x[axis])
        })
    }

    /// Shows all points within reach of `x`, and some more, with their weights, in an order that depends on nothing but the data.
    pub(super) fn visit(&self, x: Point<D>, mut see: impl FnMut(Point<D>, f64)) {
        let around: [(usize, usize); D] = std::array::from_fn(|axis| {
            let middle = self.along(axis, x[axis]);
            (
                middle.saturating_sub(1),
                (middle + 1).min(self.cells[axis] - 1),
            )
        });
        let mut at: [usize; D] = std::array::from_fn(|axis| around[axis].0);
        loop {
            // runs along the last axis are contiguous
            let row = (0..D).fold(0, |cell, axis| cell * self.cells[axis] + at[axis]);
            let across = around[D - 1].1 - around[D - 1].0;
            for (point, weight) in &self.points[self.starts[row]..self.starts[row + across + 1]] {
                see(*point, *weight);
            }
            let Some(axis) = (0..D - 1).rev().find(|axis| at[*axis] < around[*axis].1) else {
                return;
            };
            at[axis] += 1;
            for later in axis + 1..D {
                at[later] = around[later].0;
            }
        }
    }
}
