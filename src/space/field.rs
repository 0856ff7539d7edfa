//! The trait of everything that has a value at each point.

use super::{Domain, Grid, Point, Raster};

/// A function on a domain: true density, estimate, raster, irradiance.
///
/// `on` and `at_points` exist because many fields are far cheaper for many targets at once than one by one; they mean
/// the same as `at` in a loop, up to the tolerance that the implementation states.
pub trait Field<const D: usize>: Send + Sync {
    /// Where the field lives.
    fn domain(&self) -> &Domain<D>;

    /// The value at `x`.
    fn at(&self, x: Point<D>) -> f64;

    /// The values at the centres of the cells of `grid`.
    fn on(&self, grid: &Grid<D>) -> Raster<D> {
        Raster::new(*grid, grid.centres().map(|x| self.at(x)).collect())
    }

    /// The values at scattered `targets`, in their order.
    fn at_points(&self, targets: &[Point<D>]) -> Vec<f64> {
        targets.iter().map(|&x| self.at(x)).collect()
    }
}
