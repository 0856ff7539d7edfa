//! Where functions live: points, domains, grids and the functions on them.
//!
//! Everything that has a value at each point is a [`Field`]: a true density, a fitted estimate, irradiance on a wall. So an
//! error is a distance between two fields and one drawing routine draws them all. Dimension is a type parameter; the
//! same code serves the line and the plane, and what exists only on a line implements its trait for `1` only.
//!
//! There is one grid convention, cell centres, for histograms, binning, transforms, quadrature and pixels.

pub mod binning;
mod domain;
mod field;
mod grid;
mod lattice;
mod modes;
mod polygon;
mod raster;
mod ring;
mod summed_area;
mod summits;

pub use domain::{Domain, DomainError, Side};
pub use field::{Evaluation, Explanation, Field, Targets, Warning};
pub use grid::{Grid, GridError};
pub use lattice::Lattice;
pub use modes::{Mode, RIPPLE, modes};
pub use polygon::{Polygon, PolygonError};
pub use raster::Raster;
pub use ring::{
    clip, clipped_to_box, distance_to_segment, moments as polygon_moments, within_convex,
};
pub use summed_area::{SummedArea, Window};
pub use summits::mode_count;

/// A place in `D` dimensions.
pub type Point<const D: usize> = [f64; D];
