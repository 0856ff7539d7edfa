//! Data of the plane in the upright cells of a lattice: what binned estimators of the plane share.

use super::FitError;
use crate::density::Density;
use crate::numeric::Sum;
use crate::parameter::{Absent, Kind, Parameter};
use crate::sample::Sample;
use crate::space::Point;
use crate::theory::Moments;
use std::cmp::Ordering;

/// The width on the second axis.
pub(super) const WIDTH_Y: Parameter = Parameter::optional(
    "width-y",
    Kind::Positive,
    Absent::Unset,
    "the width of a bin on the second axis; that on the first by default",
)
.length()
.only_in(2);

/// The origin on the second axis.
pub(super) const ORIGIN_Y: Parameter = Parameter::optional(
    "origin-y",
    Kind::Real,
    Absent::Unset,
    "the second coordinate of a corner of a bin; equal to `origin` by default",
)
.place()
.only_in(2);

/// Where the cells lie: [origin + k width, origin + (k + 1) width) on each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    pub widths: [f64; 2],
    pub origin: Point<2>,
}

impl Lattice {
    /// The numbers of the cell of `x`, as whole `f64`s, which stay in order far beyond the range of integers. **One formula** for data and targets.
    pub fn number(&self, x: Point<2>) -> [f64; 2] {
        [0, 1].map(|k: usize| ((x[k] - self.origin[k]) / self.widths[k]).floor())
    }

    /// From -1 to 1 across the cell of that number, without the rounding of an edge far from zero.
    pub fn across(&self, number: [f64; 2], x: Point<2>) -> [f64; 2] {
        [0, 1].map(|k: usize| {
            let place = (x[k] - self.origin[k]) / self.widths[k] - number[k];
            (2.0 * place - 1.0).clamp(-1.0, 1.0)
        })
    }

    pub fn area(&self) -> f64 {
        self.widths[0] * self.widths[1]
    }

    /// Mean and variance of Σ c N / n over cells with coefficients c, N being counts of `draws` points of `truth`: multinomial.
    pub fn moments(
        &self,
        truth: &dyn Density<2>,
        draws: usize,
        cells: impl Iterator<Item = ([f64; 2], f64)>,
    ) -> Moments {
        let (mut mean, mut square) = (Sum::default(), Sum::default());
        for (number, c) in cells {
            let edge =
                |k: usize, step: f64| (number[k] + step).mul_add(self.widths[k], self.origin[k]);
            let low = [edge(0, 0.0), edge(1, 0.0)];
            let share = truth.probability(low, [edge(0, 1.0), edge(1, 1.0)]);
            mean.add(c * share);
            square.add(c * c * share);
        }
        let mean = mean.value();
        Moments {
            mean,
            variance: ((square.value() - mean * mean) / draws as f64).max(0.0),
        }
    }
}

/// Sums over the data of each cell that holds any, in the order of the cells.
pub(super) struct Cells {
    numbers: Vec<[f64; 2]>,
    /// `rows` sums a cell.
    sums: Vec<f64>,
    rows: usize,
}

fn order(a: &[f64; 2], b: &[f64; 2]) -> Ordering {
    // adding 0 makes -0 and 0 the same cell
    (a[0] + 0.0)
        .total_cmp(&(b[0] + 0.0))
        .then((a[1] + 0.0).total_cmp(&(b[1] + 0.0)))
}

impl Cells {
    /// Σ w r for each of the `rows` functions r that `values` writes for a place across the cell. O(n log n) time and O(n) memory, however many cells the range holds.
    pub fn of(
        sample: &Sample<2>,
        lattice: &Lattice,
        rows: usize,
        values: impl Fn([f64; 2], &mut [f64]),
    ) -> Result<Self, FitError> {
        let mut placed: Vec<([f64; 2], usize)> = Vec::with_capacity(sample.len());
        for (i, &x) in sample.points().iter().enumerate() {
            if sample.weight(i) <= 0.0 {
                continue;
            }
            let number = lattice.number(x);
            if !number.iter().all(|k| k.is_finite()) {
                return Err(FitError::TooLarge(format!(
                    "the point ({}, {}) cannot be numbered in bins of {} by {}; choose larger widths",
                    x[0], x[1], lattice.widths[0], lattice.widths[1]
                )));
            }
            placed.push((number, i));
        }
        placed.sort_unstable_by(|a, b| order(&a.0, &b.0).then(a.1.cmp(&b.1)));
        let (mut numbers, mut sums) = (Vec::new(), Vec::new());
        let mut row = vec![0.0; rows];
        for cell in placed.chunk_by(|a, b| order(&a.0, &b.0).is_eq()) {
            let mut totals = vec![Sum::default(); rows];
            for &(number, i) in cell {
                values(lattice.across(number, sample.points()[i]), &mut row);
                for (total, value) in totals.iter_mut().zip(&row) {
                    total.add(sample.weight(i) * value);
                }
            }
            numbers.push(cell[0].0);
            sums.extend(totals.into_iter().map(Sum::value));
        }
        Ok(Self {
            numbers,
            sums,
            rows,
        })
    }

    /// The mass of each cell.
    pub fn masses(sample: &Sample<2>, lattice: &Lattice) -> Result<Self, FitError> {
        Self::of(sample, lattice, 1, |_, row| row[0] = 1.0)
    }

    /// The sums of one cell, if it holds data.
    pub fn get(&self, number: [f64; 2]) -> Option<&[f64]> {
        let place = self.numbers.binary_search_by(|known| order(known, &number));
        place
            .ok()
            .map(|at| &self.sums[at * self.rows..(at + 1) * self.rows])
    }

    /// The first sum of each cell that holds data in column `i` and in rows from `low` to `high`, with its row.
    pub fn column(&self, i: f64, low: f64, high: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let first = self
            .numbers
            .partition_point(|known| order(known, &[i, low]).is_lt());
        (first..self.numbers.len())
            .map(|at| (self.numbers[at], self.sums[at * self.rows]))
            .take_while(move |(number, _)| order(number, &[i, high]).is_le())
            .map(|(number, sum)| (number[1], sum))
    }
}
