//! The trait of everything that has a value at each point.

use super::{Domain, Grid, Point, Raster};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// Where values are wanted.
#[derive(Clone, Copy, Debug)]
pub enum Targets<'a, const D: usize> {
    /// At the centres of the cells of a grid, in the order of the cells.
    Grid(&'a Grid<D>),
    /// At scattered places, in their order.
    Points(&'a [Point<D>]),
}

impl<const D: usize> Targets<'_, D> {
    /// How many values are wanted.
    pub fn len(&self) -> usize {
        match self {
            Self::Grid(grid) => grid.len(),
            Self::Points(points) => points.len(),
        }
    }

    /// Whether none is wanted.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The places themselves.
    pub fn places(&self) -> Box<dyn Iterator<Item = Point<D>> + '_> {
        match self {
            Self::Grid(grid) => Box::new(grid.centres()),
            Self::Points(points) => Box::new(points.iter().copied()),
        }
    }
}

/// Something that the reader of a result should know, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Warning {
    /// What is the matter, in one sentence.
    pub what: String,
    /// What to do, in one sentence.
    pub hint: String,
}

/// Reasons, put into words only where someone asks for them: experiments evaluate millions of estimates.
#[derive(Clone, Default)]
pub struct Explanation(Vec<Arc<dyn fmt::Display + Send + Sync>>);

impl Explanation {
    /// Puts a reason before those there are.
    pub fn begin_with(&mut self, reason: Arc<dyn fmt::Display + Send + Sync>) {
        self.0.insert(0, reason);
    }

    /// All reasons, line by line.
    pub fn lines(&self) -> Vec<String> {
        let told = |reason: &Arc<dyn fmt::Display + Send + Sync>| reason.to_string();
        let lines = self.0.iter().map(told);
        lines
            .flat_map(|told| told.lines().map(str::to_owned).collect::<Vec<_>>())
            .collect()
    }
}

impl fmt::Debug for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.lines()).finish()
    }
}

/// Values at targets, with what is known about them.
#[derive(Clone, Debug, Default)]
pub struct Evaluation {
    /// One value per target, in order.
    pub values: Vec<f64>,
    /// A bound on the error of computation (not of estimation) of each value, relative to the largest possible value
    /// of the field (for a kernel sum: mass × K(0) / h of a single place, or less where the engine states so). Zero for closed forms.
    pub error: f64,
    /// The engine that computed the values, where there was a choice.
    pub engine: Option<&'static str>,
    /// Why that engine.
    pub explanation: Explanation,
    /// How far around each target the data were averaged, where that differs from target to target.
    pub sizes: Option<Vec<f64>>,
    /// The root mean squared error that the estimator itself expects at each target, where it does; not calibrated.
    pub expected_errors: Option<Vec<f64>>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
    /// Why there are no values: they are then not numbers. Only where computing is out of our hands, as with another program.
    pub failure: Option<String>,
}

/// A function on a domain: true density, estimate, raster, irradiance.
///
/// `evaluate` exists because many fields are far cheaper for many targets at once than one by one; it means the same as `at` in
/// a loop, up to the error that its answer states.
pub trait Field<const D: usize>: Send + Sync {
    /// Where the field lives.
    fn domain(&self) -> &Domain<D>;

    /// The value at `x`.
    fn at(&self, x: Point<D>) -> f64;

    /// The values at many targets.
    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        Evaluation {
            values: targets.places().map(|x| self.at(x)).collect(),
            ..Evaluation::default()
        }
    }

    /// The values at the centres of the cells of `grid`.
    fn on(&self, grid: &Grid<D>) -> Raster<D> {
        Raster::new(*grid, self.evaluate(Targets::Grid(grid)).values)
    }
}
