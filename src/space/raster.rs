//! Values on the cells of a grid.

use super::{Domain, Field, Grid, Point};
use crate::numeric::Sum;

/// One value per cell of a [`Grid`]: a sampled field, and itself a field (constant on each cell, zero outside).
#[derive(Clone, Debug, PartialEq)]
pub struct Raster<const D: usize> {
    grid: Grid<D>,
    domain: Domain<D>,
    values: Vec<f64>,
}

impl<const D: usize> Raster<D> {
    /// Puts `values` on the cells of `grid`.
    ///
    /// # Panics
    /// If the number of values is not the number of cells.
    pub fn new(grid: Grid<D>, values: Vec<f64>) -> Self {
        assert_eq!(grid.len(), values.len(), "one value per cell");
        Self {
            grid,
            domain: Domain::whole(),
            values,
        }
    }

    /// The cells.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// The values in the order of the cells, last axis fastest.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Gives the values away.
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    /// Midpoint rule over the grid: Σ value × cell measure.
    pub fn integral(&self) -> f64 {
        self.values.iter().copied().collect::<Sum>().value() * self.grid.cell_measure()
    }
}

impl<const D: usize> Field<D> for Raster<D> {
    fn domain(&self) -> &Domain<D> {
        &self.domain
    }

    fn at(&self, x: Point<D>) -> f64 {
        let mut number = 0;
        for axis in 0..D {
            let cells = self.grid.cells()[axis];
            let t = (x[axis] - self.grid.low()[axis]) / self.grid.width(axis);
            if !(0.0..=cells as f64).contains(&t) {
                return 0.0;
            }
            number = number * cells + (t as usize).min(cells - 1);
        }
        self.values[number]
    }
}
