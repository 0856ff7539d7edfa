//! The plane in buckets: a grid of cells with a table of how many points are in any rectangle of them.

mod axis;
mod ring;

use super::kept::Kept;
use super::{Metric, Neighbours, Scratch, check};
use crate::sample::Sample;
use crate::space::Point;
use axis::Axis;

/// Points in the order of the cells of a uniform grid, about three a cell.
///
/// A query counts squares about the target with a table of sums until one holds k points, which bounds the k-th distance from both sides and suggests
/// where it is. Then the cells inside a slightly smaller circle are counted row by row without looking at their points, and only the points in
/// the ring about the suggested distance are measured and selected from: O(√k) cells and points. Where the suggestion was wrong the
/// certain bounds are used.
///
/// Building is O(n): one pass to count, one to place. Not for points that crowd into few cells; [`Cells::new`] declines those.
pub struct Cells {
    /// In the order of the cells.
    points: Vec<Point<2>>,
    /// Their numbers in the sample.
    numbers: Vec<u32>,
    /// The points of cell i, last axis fastest, are those from `starts[i]` to `starts[i + 1]`.
    starts: Vec<u32>,
    /// Points in all cells below and left of each corner of cells.
    sums: Vec<u32>,
    axes: [Axis; 2],
    metric: Metric<2>,
}

/// Points a cell, where they are spread evenly.
const OCCUPANCY: f64 = 3.0;

/// The number of others in its cell that a point may have on average; more, and rings hold too many points.
const CROWDED: f64 = 100.0;

impl Cells {
    /// The finder for `sample`, or `None` where the points are too unevenly spread for it (or too far for squares of distances).
    pub fn new(sample: &Sample<2>) -> Option<Self> {
        let kept = Kept::new(sample);
        let metric = Metric::new(sample.domain());
        let axes = axes(&kept.points, &metric)?;
        let [columns, rows] = axes.map(|axis| axis.cells as usize);
        let cell = |x: Point<2>| axes[0].cell(x[0]) * rows + axes[1].cell(x[1]);

        let mut starts = vec![0u32; columns * rows + 1];
        let cells: Vec<u32> = kept
            .points
            .iter()
            .map(|&x| {
                let cell = cell(x);
                starts[cell] += 1;
                cell as u32
            })
            .collect();
        let squares: f64 = starts.iter().map(|&c| f64::from(c).powi(2)).sum();
        if squares > CROWDED * kept.points.len() as f64 {
            return None;
        }
        let sums = table(&starts, columns, rows);
        // each start runs from the end of its cell down to its beginning, so the points are taken backwards to keep their order
        let mut total = 0;
        for start in &mut starts {
            total += *start;
            *start = total;
        }
        let mut points = vec![[0.0; 2]; kept.points.len()];
        let mut numbers = vec![0u32; kept.points.len()];
        for (i, &cell) in cells.iter().enumerate().rev() {
            let start = &mut starts[cell as usize];
            *start -= 1;
            points[*start as usize] = kept.points[i];
            numbers[*start as usize] = kept.number(i) as u32;
        }
        Some(Self {
            points,
            numbers,
            starts,
            sums,
            axes,
            metric,
        })
    }

    fn rows(&self) -> usize {
        self.axes[1].cells as usize
    }

    /// Points in a rectangle of cells of the grid.
    fn inside(&self, columns: (usize, usize), rows: (usize, usize)) -> usize {
        let at = |column: usize, row: usize| self.sums[column * (self.rows() + 1) + row] as usize;
        at(columns.1, rows.1) + at(columns.0, rows.0)
            - at(columns.0, rows.1)
            - at(columns.1, rows.0)
    }
}

/// The grid: the whole domain where it wraps round, else where the points are.
fn axes(points: &[Point<2>], metric: &Metric<2>) -> Option<[Axis; 2]> {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for x in points {
        for axis in 0..2 {
            low[axis] = low[axis].min(x[axis]);
            high[axis] = high[axis].max(x[axis]);
        }
    }
    for axis in 0..2 {
        if metric.period(axis).is_finite() {
            low[axis] = metric.low()[axis];
            high[axis] = low[axis] + metric.period(axis);
        }
    }
    let spans = [high[0] - low[0], high[1] - low[1]];
    let extent = spans[0].max(spans[1]);
    // where squares would overflow or lose digits
    if low.iter().chain(&high).any(|x| x.abs() > 1e150) || extent < 1e-130 {
        return None;
    }
    let total = (points.len() as f64 / OCCUPANCY).max(1.0);
    // square cells as far as the box allows
    let columns = (total * spans[0] / spans[1]).sqrt();
    let columns = if columns.is_nan() { 1.0 } else { columns };
    let columns = columns.round().clamp(1.0, total.floor());
    let rows = (total / columns).round().max(1.0);
    Some([
        Axis::new(low[0], spans[0], columns as usize, metric.period(0)),
        Axis::new(low[1], spans[1], rows as usize, metric.period(1)),
    ])
}

/// Points below and left of each corner.
fn table(counts: &[u32], columns: usize, rows: usize) -> Vec<u32> {
    let mut sums = vec![0u32; (columns + 1) * (rows + 1)];
    for column in 0..columns {
        let mut along = 0;
        for row in 0..rows {
            along += counts[column * rows + row];
            sums[(column + 1) * (rows + 1) + row + 1] = sums[column * (rows + 1) + row + 1] + along;
        }
    }
    sums
}

impl Neighbours<2> for Cells {
    fn name(&self) -> &'static str {
        "cells"
    }

    fn count(&self) -> usize {
        self.points.len()
    }

    fn metric(&self) -> &Metric<2> {
        &self.metric
    }

    fn distance(&self, target: Point<2>, k: usize, scratch: &mut Scratch) -> f64 {
        check(k, self.count());
        let home = self.metric.home(target);
        if self.metric.wraps() {
            self.kth::<true>(home, k, &mut scratch.bits)
        } else {
            self.kth::<false>(home, k, &mut scratch.bits)
        }
    }

    fn within(&self, target: Point<2>, squared: f64, show: &mut dyn FnMut(usize, f64)) {
        let home = self.metric.home(target);
        self.stripes(home, 0.0, squared, |outer, _| {
            for i in outer.0..outer.1 {
                let d = self.metric.squared(home, self.points[i]);
                if d <= squared {
                    show(self.numbers[i] as usize, d);
                }
            }
        });
    }
}
