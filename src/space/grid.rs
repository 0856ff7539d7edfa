//! A uniform grid of cells, seen at their centres.

use super::Point;

/// Why a grid cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// Bounds that are not finite, or not in order.
    #[error(
        "a grid needs finite bounds with low < high on each axis; axis {axis} has {low} and {high}"
    )]
    Bounds {
        /// The axis at fault, from 0.
        axis: usize,
        /// Its lower bound.
        low: f64,
        /// Its upper bound.
        high: f64,
    },
    /// No cells on an axis.
    #[error("a grid needs at least one cell on each axis; axis {axis} has none")]
    NoCells {
        /// The axis at fault, from 0.
        axis: usize,
    },
    /// More cells than fit in memory.
    #[error("a grid of {cells:?} cells is larger than the limit of {limit}")]
    TooManyCells {
        /// The cells asked for on each axis.
        cells: [usize; 2],
        /// The most that one grid may have.
        limit: usize,
    },
    /// Cells so thin that their centres are not distinct numbers.
    #[error(
        "axis {axis}: {cells} cells between {low} and {high} are thinner than the numbers there can tell apart"
    )]
    Unresolvable {
        /// The axis at fault, from 0.
        axis: usize,
        /// The cells asked for.
        cells: usize,
        /// Its lower bound.
        low: f64,
        /// Its upper bound.
        high: f64,
    },
}

/// The most cells one grid may have: 2²⁸, two GiB of `f64`.
pub const CELL_LIMIT: usize = 1 << 28;

/// `cells[axis]` equal cells between `low` and `high`; values sit at the **centres** of the cells.
///
/// Cells are numbered with the last axis fastest. Always true: finite bounds in order, at least one cell an axis, centres distinct.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid<const D: usize> {
    low: Point<D>,
    high: Point<D>,
    cells: [usize; D],
}

impl<const D: usize> Grid<D> {
    /// A grid of `cells` cells an axis on the box from `low` to `high`.
    ///
    /// # Errors
    /// If the bounds are not finite and in order, an axis has no cell, or the cells are too many or too thin.
    pub fn new(low: Point<D>, high: Point<D>, cells: [usize; D]) -> Result<Self, GridError> {
        let mut total = 1usize;
        for axis in 0..D {
            let (l, h, m) = (low[axis], high[axis], cells[axis]);
            if !(l.is_finite() && h.is_finite() && (h - l).is_finite() && l < h) {
                return Err(GridError::Bounds {
                    axis,
                    low: l,
                    high: h,
                });
            }
            if m == 0 {
                return Err(GridError::NoCells { axis });
            }
            total = total.saturating_mul(m);
            if total > CELL_LIMIT {
                let mut shown = [1; 2];
                for (s, c) in shown.iter_mut().zip(cells) {
                    *s = c;
                }
                return Err(GridError::TooManyCells {
                    cells: shown,
                    limit: CELL_LIMIT,
                });
            }
            let width = (h - l) / m as f64;
            if width < 4.0 * f64::EPSILON * l.abs().max(h.abs()) || width < f64::MIN_POSITIVE {
                return Err(GridError::Unresolvable {
                    axis,
                    cells: m,
                    low: l,
                    high: h,
                });
            }
        }
        Ok(Self { low, high, cells })
    }

    /// The lower corner.
    pub fn low(&self) -> Point<D> {
        self.low
    }

    /// The upper corner.
    pub fn high(&self) -> Point<D> {
        self.high
    }

    /// Cells on each axis.
    pub fn cells(&self) -> [usize; D] {
        self.cells
    }

    /// Cells in all.
    pub fn len(&self) -> usize {
        self.cells.iter().product()
    }

    /// Never: a grid has at least one cell.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The width of a cell on `axis`.
    pub fn width(&self, axis: usize) -> f64 {
        (self.high[axis] - self.low[axis]) / self.cells[axis] as f64
    }

    /// The length, area, ... of one cell.
    pub fn cell_measure(&self) -> f64 {
        (0..D).map(|axis| self.width(axis)).product()
    }

    /// The centre of cell `i` on `axis`: `low + (i + 1/2) width`.
    pub fn coordinate(&self, axis: usize, i: usize) -> f64 {
        (i as f64 + 0.5).mul_add(self.width(axis), self.low[axis])
    }

    /// The centre of the cell with the given number (last axis fastest).
    pub fn centre(&self, number: usize) -> Point<D> {
        let mut rest = number;
        let mut x = [0.0; D];
        for axis in (0..D).rev() {
            x[axis] = self.coordinate(axis, rest % self.cells[axis]);
            rest /= self.cells[axis];
        }
        x
    }

    /// All centres in the order of their numbers.
    pub fn centres(&self) -> impl Iterator<Item = Point<D>> + '_ {
        (0..self.len()).map(|number| self.centre(number))
    }
}
