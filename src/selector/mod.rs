//! Sample → bandwidth.

mod bin_width;
mod plane;
mod rules;

pub use bin_width::{BinWidth, freedman_diaconis, frequency_polygon, scott, shifted_histogram};
pub use plane::NormalScale;
pub use rules::{NormalReference, Scott, Silverman};

use crate::kernel::{Bandwidth, Shape};
use crate::sample::Sample;
use crate::space::Warning;

/// Why no bandwidth could be chosen.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SelectError {
    /// The data have no spread to measure.
    #[error(
        "all {points} points are at {place}: the data have no spread from which a width could be chosen; give a number"
    )]
    NoSpread {
        /// Points in the sample.
        points: usize,
        /// Where they all are.
        place: f64,
    },
}

/// A bandwidth, with what the reader should know about how it came about.
#[derive(Clone, Debug)]
pub struct Selection<const D: usize> {
    /// The width.
    pub bandwidth: Bandwidth<D>,
    /// Fallbacks taken, minima at the edge, and the like.
    pub warnings: Vec<Warning>,
}

/// A rule that chooses a bandwidth from the data alone.
pub trait Selector<const D: usize>: Send + Sync {
    /// The name in files and tables.
    fn name(&self) -> &'static str;

    /// Chooses for `sample` and a kernel of `shape`. Rules use the effective size, never the bare count.
    ///
    /// # Errors
    /// If the data do not determine a width.
    fn select(&self, sample: &Sample<D>, shape: Shape) -> Result<Selection<D>, SelectError>;
}
