//! The plane in buckets: a grid of cells with a table of how many points are in any rectangle of them.

mod axis;
mod ring;

use super::kept::Kept;
use super::{Counter, Found, Metric, Neighbours, Scratch, check};
use crate::sample::Sample;
use crate::space::Point;
use axis::Axis;
use rayon::prelude::*;

/// Points in the order of the cells of a uniform grid, about three a cell.
///
/// A query counts squares about the target with a table of sums until one holds k points, which bounds the k-th distance from both sides and suggests
/// where it is. Then the cells inside a slightly smaller circle are counted row by row without looking at their points, and only the points in
/// the ring about the suggested distance are measured and selected from: O(√k) cells and points. Where the suggestion was wrong the
/// certain bounds are used.
///
/// Building is O(n): one pass to find the cells, one to count, one to place. Not for points that crowd into few cells; [`Cells::new`] declines those.
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
        let points = kept.points();
        let metric = Metric::new(sample.domain());
        let axes = axes(points, &metric)?;
        let [columns, rows] = axes.map(|axis| axis.cells as usize);
        let cells: Vec<u32> = points
            .par_iter()
            .map(|&x| (axes[0].cell(x[0]) * rows + axes[1].cell(x[1])) as u32)
            .collect();
        // each thread has a stretch of cells of its own and looks at all points; how many threads, the result does not tell
        let stretch = (columns * rows).div_ceil(rayon::current_num_threads().min(8));
        let mut starts = vec![0u32; columns * rows + 1];
        starts[1..]
            .par_chunks_mut(stretch)
            .enumerate()
            .for_each(|(part, counts)| {
                let first = (part * stretch) as u32;
                for &cell in &cells {
                    if let Some(count) = counts.get_mut(cell.wrapping_sub(first) as usize) {
                        *count += 1;
                    }
                }
            });
        let squares: f64 = starts.iter().map(|&c| f64::from(c).powi(2)).sum();
        if squares > CROWDED * points.len() as f64 {
            return None;
        }
        let sums = table(&starts[1..], columns, rows);
        for cell in 0..columns * rows {
            starts[cell + 1] += starts[cell];
        }
        let mut placed = vec![[0.0; 2]; points.len()];
        let mut numbers = vec![0u32; points.len()];
        let mut parts = Vec::new();
        let (mut left, mut left_numbers) = (&mut placed[..], &mut numbers[..]);
        for bounds in starts.chunks(stretch) {
            let cells = bounds.len().min(stretch);
            let first = parts.len() * stretch;
            let last = (first + cells).min(columns * rows);
            let many = (starts[last] - starts[first]) as usize;
            let (mine, rest) = left.split_at_mut(many);
            let (my_numbers, other_numbers) = left_numbers.split_at_mut(many);
            (left, left_numbers) = (rest, other_numbers);
            parts.push((&starts[first..last], mine, my_numbers));
        }
        parts
            .into_par_iter()
            .enumerate()
            .for_each(|(part, (starts, placed, numbers))| {
                let first = (part * stretch) as u32;
                let Some(&base) = starts.first() else { return };
                let mut next: Vec<u32> = starts.iter().map(|start| start - base).collect();
                for (i, &cell) in cells.iter().enumerate() {
                    if let Some(next) = next.get_mut(cell.wrapping_sub(first) as usize) {
                        placed[*next as usize] = points[i];
                        numbers[*next as usize] = kept.number(i) as u32;
                        *next += 1;
                    }
                }
            });
        Some(Self {
            points: placed,
            numbers,
            starts,
            sums,
            axes,
            metric,
        })
    }

    /// The same as [`Neighbours::distance`], telling `counter` what it takes.
    ///
    /// # Panics
    /// As that.
    pub fn distance_counted<C: Counter>(
        &self,
        target: Point<2>,
        k: usize,
        scratch: &mut Scratch,
        counter: &mut C,
    ) -> f64 {
        check(k, self.count());
        let home = self.metric.home(target);
        if self.metric.wraps() {
            self.kth::<true, C>(home, k, &mut scratch.bits, counter)
        } else {
            self.kth::<false, C>(home, k, &mut scratch.bits, counter)
        }
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
        self.distance_counted(target, k, scratch, &mut ())
    }

    fn gather(&self, target: Point<2>, k: usize, _scratch: &mut Scratch, found: &mut Vec<Found>) {
        check(k, self.count());
        self.disc(self.metric.home(target), k, found);
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
