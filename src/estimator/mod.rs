//! Sample → estimate: the methods whose trustworthiness is the question.
//!
//! Fitting gives a new value and nothing is half-ready: what can be done once (choosing a width, sorting, binning) is done in [`Estimator::fit`].
//! To add an estimator: one file here with its [`Described`] constants, one line in `experiment/catalogue.rs`, one experiment that asks why
//! it should exist.

mod adaptive;
mod balloon;
mod bins;
mod cells;
mod command;
mod frequency_polygon;
mod frequency_polygon_plane;
mod generalised_histogram;
mod generalised_histogram_plane;
mod generalised_nearest_neighbour;
mod histogram;
mod histogram_plane;
mod kde;
mod laws;
mod naive;
mod nearest_neighbour;
mod nested;
mod normal;
mod normal_mixture;
mod normal_mixture_plane;
mod series;
mod shifted_histogram;
mod shifted_histogram_plane;
mod texture;
mod width;

pub use crate::parameter::BuildError;
pub use crate::theory::{Family, Moments};
pub use adaptive::Abramson;
pub use command::Command;
pub use frequency_polygon::FrequencyPolygon;
pub use frequency_polygon_plane::FrequencyPolygonPlane;
pub use generalised_histogram::GeneralisedHistogram;
pub use generalised_histogram_plane::GeneralisedHistogramPlane;
pub use generalised_nearest_neighbour::GeneralisedNearestNeighbour;
pub use histogram::Histogram;
pub use histogram_plane::HistogramPlane;
pub use kde::Kde;
pub use laws::Laws;
pub use naive::Naive;
pub use nearest_neighbour::NearestNeighbour;
pub use nested::{BiasCompensated, Lepski, NestedTest, TwoStage};
pub use normal::Normal;
pub use normal_mixture::NormalMixtureFit;
pub use series::{CosineSeries, FourierSeries, HermiteSeries, LegendreSeries};
pub use shifted_histogram::ShiftedHistogram;
pub use shifted_histogram_plane::ShiftedHistogramPlane;
pub use texture::VariableKernel;

use crate::boundary::BoundaryError;
use crate::density::Density;
use crate::kernel::{Bandwidth, WidthError};
use crate::parameter::{Parameter, Values};
use crate::sample::Sample;
use crate::selector::SelectError;
use crate::space::{Domain, Evaluation, Field, Point, Targets, Warning};
use std::sync::Arc;

/// Why a sample could not be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// The bandwidth rule failed.
    #[error(transparent)]
    Select(#[from] SelectError),
    /// The bandwidth is not legal.
    #[error(transparent)]
    Width(#[from] WidthError),
    /// The walls cannot be treated as asked.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
    /// The engine that was asked for cannot do it.
    #[error("{0}")]
    Engine(String),
    /// Too large to be computed.
    #[error("{0}")]
    TooLarge(String),
    /// The sample does not determine the estimate.
    #[error("{0}")]
    Degenerate(String),
}

/// What was computed and what was chosen on the way.
pub struct Estimate<const D: usize> {
    field: Arc<dyn Field<D>>,
    channels: Vec<Arc<dyn Field<D>>>,
    /// The smoothing parameter used (bandwidth, bin width), where there is one number for it.
    pub smoothing: Option<f64>,
    /// The bandwidth used, for kernel estimates.
    pub bandwidth: Option<Bandwidth<D>>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

impl<const D: usize> Estimate<D> {
    /// An estimate that is `field`.
    pub fn new(field: Arc<dyn Field<D>>) -> Self {
        Self {
            field,
            channels: Vec::new(),
            smoothing: None,
            bandwidth: None,
            warnings: Vec::new(),
        }
    }

    /// The same with a field for each channel of the sample, made with the geometry of the total.
    #[must_use]
    pub fn with_channels(mut self, channels: Vec<Arc<dyn Field<D>>>) -> Self {
        self.channels = channels;
        self
    }

    /// The estimate in one channel.
    pub fn channel(&self, channel: usize) -> Option<&dyn Field<D>> {
        self.channels.get(channel).map(|field| &**field)
    }
}

impl<const D: usize> Field<D> for Estimate<D> {
    fn domain(&self) -> &Domain<D> {
        self.field.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        self.field.at(x)
    }

    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        let mut evaluation = self.field.evaluate(targets);
        evaluation.warnings.extend(self.warnings.iter().cloned());
        evaluation
    }
}

/// A density estimator with all its settings.
pub trait Estimator<const D: usize>: Send + Sync {
    /// What holds of every estimate it makes.
    fn laws(&self) -> Laws;

    /// The estimate from `sample`.
    ///
    /// # Errors
    /// If the sample does not determine the estimate, or it cannot be computed.
    fn fit(&self, sample: &Sample<D>) -> Result<Estimate<D>, FitError>;

    /// The exact mean and variance of the estimate at each of `places` over samples of `draws` points from `truth`, by quadrature
    /// instead of simulation; `None` where no such theory is known (data-driven widths). `truth` comes with its line-only side in one dimension.
    fn expectation(
        &self,
        truth: &dyn Density<D>,
        draws: usize,
        places: &[Point<D>],
    ) -> Option<Vec<Moments>> {
        let _ = (truth, draws, places);
        None
    }

    /// The variance of `estimate`, which this estimator has made of `sample`, at each of `places`, estimated from the very sample: what an interval about
    /// the estimate is made from. `None` where no such estimate is known. Widths that were chosen from the data count as if they had been given.
    fn variance(
        &self,
        estimate: &Estimate<D>,
        sample: &Sample<D>,
        places: &[Point<D>],
    ) -> Option<Vec<f64>> {
        let _ = (estimate, sample, places);
        None
    }

    /// All that it is but for its bandwidth or width, where theory knows the exact error of each member and so the best one; whether
    /// the width is a number or chosen from the data does not matter.
    fn family(&self) -> Option<Family> {
        None
    }
}

/// What is known when an estimator is built from its settings: needed by settings such as an oracle's bandwidth.
#[derive(Clone)]
pub struct Context<const D: usize> {
    /// The density that samples come from, where it is known; [`Density::univariate`] gives what only exists on a line.
    pub truth: Option<Arc<dyn Density<D>>>,
    /// The size of the samples.
    pub draws: usize,
}

/// What the catalogue says about an estimator, kept in the estimator's own file; once, whether it lives on the line, in the plane or in both.
pub trait Described {
    /// Its name in files, tables and legends.
    const NAME: &'static str;
    /// One sentence.
    const SUMMARY: &'static str;
    /// Cost in n points and m targets.
    const COST: &'static str;
    /// Author, year, equation.
    const REFERENCE: &'static str;
    /// What it may be told.
    const PARAMETERS: &'static [Parameter];
    /// The parameter that decides how smooth the estimate is, where there is one.
    const SMOOTHING: Option<&'static str>;
}

/// An estimator that can be made from what a file says, in `D` dimensions. One that lives in both implements this for both: on one type if
/// its settings are the same, on two if not, with [`Described`] on the one that the catalogue names first.
pub trait Build<const D: usize>: Described + Estimator<D> + Sized + 'static {
    /// Builds it from checked values.
    ///
    /// # Errors
    /// If the values do not go together, or need a truth that is not known.
    fn build(values: &Values, context: &Context<D>) -> Result<Self, BuildError>;
}

/// For tests: an estimator with these settings and the others as they are by default.
#[cfg(test)]
pub(crate) fn built<const D: usize, E: Build<D>>(
    settings: &[(&'static str, crate::parameter::Value)],
) -> E {
    let mut values = Values::defaults(E::PARAMETERS);
    for (name, value) in settings {
        values.set(name, value.clone());
    }
    let context = Context {
        truth: None,
        draws: 100,
    };
    E::build(&values, &context).expect("legal settings")
}
