//! Sums over rectangles of cells, four reads each.

use super::{Grid, Point, Raster};

/// The prefix sums of values on the cells of a grid in the plane: the sum over any rectangle of cells is four reads and three additions. \[Crow 1984\]
///
/// Counts, and any integers whose total stays below 2⁵³, are summed exactly. Other values are good to 2⁻⁵³ of the total, not of the sum over the rectangle.
///
/// Cost: one pass over the cells to build, O(1) a rectangle, one number a cell.
///
/// ```
/// use density_lab::space::{Grid, SummedArea};
/// let texels = Grid::new([0.0, 0.0], [1.0, 1.0], [4, 4])?;
/// let table = SummedArea::new(texels, &[1.0; 16]);
/// assert_eq!(table.sum([1, 1], [3, 4]), 6.0); // rows 1 and 2, columns 1 to 3
/// # Ok::<(), density_lab::space::GridError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SummedArea {
    grid: Grid<2>,
    /// (cells₀ + 1) × (cells₁ + 1): the sum over all cells before, with a row and a column of zeros.
    prefix: Vec<f64>,
}

/// What lies in a square window about a cell, cut off at the end of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The sum over its cells.
    pub sum: f64,
    /// How many cells it has.
    pub cells: usize,
}

impl SummedArea {
    /// Of `values` on the cells of `grid`, the last axis fastest.
    ///
    /// # Panics
    /// If there is not one value a cell.
    pub fn new(grid: Grid<2>, values: &[f64]) -> Self {
        assert_eq!(grid.len(), values.len(), "one value per cell");
        let [rows, columns] = grid.cells();
        let stride = columns + 1;
        let mut prefix = vec![0.0; (rows + 1) * stride];
        for row in 0..rows {
            let mut along = 0.0;
            for column in 0..columns {
                along += values[row * columns + column];
                let above = prefix[row * stride + column + 1];
                prefix[(row + 1) * stride + column + 1] = above + along;
            }
        }
        Self { grid, prefix }
    }

    /// Of how many of `points` lie in each cell, or of their weights. Points outside the grid do not count; the outermost edge belongs to the last cell.
    pub fn of_points(grid: Grid<2>, points: &[Point<2>], weight: impl Fn(usize) -> f64) -> Self {
        let [rows, columns] = grid.cells();
        let mut values = vec![0.0; grid.len()];
        let place = |x: f64, axis: usize, cells: usize| {
            let t = (x - grid.low()[axis]) / grid.width(axis);
            // NaN is nowhere
            (0.0..=cells as f64)
                .contains(&t)
                .then(|| (t as usize).min(cells - 1))
        };
        for (i, point) in points.iter().enumerate() {
            if let (Some(row), Some(column)) =
                (place(point[0], 0, rows), place(point[1], 1, columns))
            {
                values[row * columns + column] += weight(i);
            }
        }
        Self::new(grid, &values)
    }

    /// The cells.
    pub fn grid(&self) -> &Grid<2> {
        &self.grid
    }

    /// The sum over the cells from `low` to before `high`; zero for an empty rectangle.
    ///
    /// # Panics
    /// If `high` is beyond the grid.
    #[inline]
    pub fn sum(&self, low: [usize; 2], high: [usize; 2]) -> f64 {
        if low[0] >= high[0] || low[1] >= high[1] {
            return 0.0;
        }
        let stride = self.grid.cells()[1] + 1;
        let at = |row: usize, column: usize| self.prefix[row * stride + column];
        (at(high[0], high[1]) - at(low[0], high[1])) - (at(high[0], low[1]) - at(low[0], low[1]))
    }

    /// The sum over all cells.
    pub fn total(&self) -> f64 {
        self.sum([0; 2], self.grid.cells())
    }

    /// The window of 2 `half` + 1 cells a side about `cell`, as far as there are cells.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub fn window(&self, cell: [usize; 2], half: usize) -> Window {
        let low = cell.map(|c| c.saturating_sub(half));
        let mut high = self.grid.cells();
        for axis in 0..2 {
            assert!(cell[axis] < high[axis], "a cell of the grid");
            high[axis] = high[axis].min(cell[axis].saturating_add(half).saturating_add(1));
        }
        Window {
            sum: self.sum(low, high),
            cells: (high[0] - low[0]) * (high[1] - low[1]),
        }
    }

    /// The mean of the values over the window about each cell: a moving average.
    pub fn smoothed(&self, half: usize) -> Raster<2> {
        let [rows, columns] = self.grid.cells();
        let mut values = Vec::with_capacity(self.grid.len());
        for row in 0..rows {
            for column in 0..columns {
                let window = self.window([row, column], half);
                values.push(window.sum / window.cells as f64);
            }
        }
        Raster::new(self.grid, values)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::random::stream;
    use rand::RngExt;

    #[test]
    fn every_rectangle_is_the_sum_that_a_loop_gives() {
        let grid = Grid::new([0.0, -1.0], [2.0, 1.0], [7, 5]).unwrap();
        let mut random = stream(3, "summed area", 0);
        let values: Vec<f64> = (0..35)
            .map(|_| f64::from(random.random_range(0..1000)))
            .collect();
        let table = SummedArea::new(grid, &values);
        for (a, b) in (0..=7).flat_map(|a| (0..=7).map(move |b| (a, b))) {
            for (c, d) in (0..=5).flat_map(|c| (0..=5).map(move |d| (c, d))) {
                let mut sum = 0.0;
                for row in a..b.max(a) {
                    sum += values[row * 5 + c..row * 5 + d.max(c)].iter().sum::<f64>();
                }
                assert_eq!(table.sum([a, c], [b, d]).to_bits(), sum.to_bits());
            }
        }
    }

    #[test]
    fn points_are_counted_where_they_lie_and_edges_once() {
        let grid = Grid::new([0.0; 2], [1.0; 2], [2, 2]).unwrap();
        let points = [[0.0, 0.0], [0.5, 0.0], [1.0, 1.0], [1.1, 0.5], [0.2, 0.9]];
        let table = SummedArea::of_points(grid, &points, |_| 1.0);
        let cell = |i, j| table.sum([i, j], [i + 1, j + 1]);
        assert_eq!(
            [cell(0, 0), cell(0, 1), cell(1, 0), cell(1, 1)].map(|c| c as u32),
            [1, 1, 1, 1]
        );
        assert_eq!(table.total() as u32, 4);
    }

    #[test]
    fn windows_end_where_the_grid_does() {
        let grid = Grid::new([0.0; 2], [1.0; 2], [4, 3]).unwrap();
        let table = SummedArea::new(grid, &[1.0; 12]);
        assert_eq!(table.window([0, 0], 1).cells, 4);
        assert_eq!(table.window([1, 1], 1).cells, 9);
        assert_eq!(table.window([2, 2], usize::MAX).cells, 12);
        assert!(
            table
                .smoothed(2)
                .values()
                .iter()
                .all(|v| (v - 1.0).abs() < 1e-15)
        );
    }
}
