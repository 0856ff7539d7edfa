//! The only place where a name in a file meets a type.

use super::uncertainty::UncertaintyKind;
use crate::accuracy::{Directions, LocalError};
use crate::density::{self, Density, Truth};
use crate::estimator::{self, Build, BuildError, Context, Described, Estimator};
use crate::parameter::{Parameter, Values};
use crate::sample::{Clustered, Exposed, Source};
use crate::uncertainty::{Differences, ErrorEstimate};
use std::sync::Arc;

/// An estimator built from its settings, or what is wrong with them.
pub type Built<const D: usize> = Result<Box<dyn Estimator<D>>, BuildError>;

/// How an estimator is built from checked values.
pub type Builder<const D: usize> = fn(&Values, &Context<D>) -> Built<D>;

/// An estimator as the catalogue knows it.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Its name in files, tables and legends.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// Cost in n points and m targets.
    pub cost: &'static str,
    /// Author, year, equation.
    pub reference: &'static str,
    /// What it may be told.
    pub parameters: &'static [Parameter],
    /// The parameter that decides how smooth the estimate is.
    pub smoothing: Option<&'static str>,
    /// Builds it for data on a line.
    pub line: Option<Builder<1>>,
    /// Builds it for data in the plane.
    pub plane: Option<Builder<2>>,
}

/// What code that serves both dimensions asks of an [`Entry`].
pub trait Builds<const D: usize> {
    /// How it is built in `D` dimensions, if it exists there.
    fn builder(&self) -> Option<Builder<D>>;

    /// Builds it from checked values.
    ///
    /// # Errors
    /// If it does not exist in `D` dimensions, the values do not go together, or they need what is not known.
    fn build(&self, values: &Values, context: &Context<D>) -> Built<D>;

    /// A density, if it has `D` dimensions.
    fn truth(truth: Truth) -> Option<Arc<dyn Density<D>>>;

    /// A source whose points come in paths, if it has `D` dimensions.
    fn clustered(source: Clustered) -> Option<Arc<dyn Source<D>>>;

    /// An estimate of the error.
    fn error_estimate(kind: &UncertaintyKind) -> Box<dyn ErrorEstimate<D>>;

    /// A source in the plane, if that is where `D` dimensions are.
    fn exposed(source: Arc<dyn Exposed<2>>) -> Option<Arc<dyn Exposed<D>>>;
}

impl Builds<1> for Entry {
    fn builder(&self) -> Option<Builder<1>> {
        self.line
    }

    fn build(&self, values: &Values, context: &Context<1>) -> Built<1> {
        self.checked(self.line, values, context, "on a line")
    }

    fn clustered(source: Clustered) -> Option<Arc<dyn Source<1>>> {
        Some(Arc::new(source))
    }

    fn error_estimate(kind: &UncertaintyKind) -> Box<dyn ErrorEstimate<1>> {
        match kind.halves() {
            Some(halves) => Box::new(halves),
            None => Box::new(differences(kind)),
        }
    }

    fn truth(truth: Truth) -> Option<Arc<dyn Density<1>>> {
        truth.line().map(|density| density as Arc<dyn Density<1>>)
    }

    fn exposed(_: Arc<dyn Exposed<2>>) -> Option<Arc<dyn Exposed<1>>> {
        None
    }
}

impl Builds<2> for Entry {
    fn builder(&self) -> Option<Builder<2>> {
        self.plane
    }

    fn build(&self, values: &Values, context: &Context<2>) -> Built<2> {
        self.checked(self.plane, values, context, "in the plane")
    }

    fn clustered(_source: Clustered) -> Option<Arc<dyn Source<2>>> {
        None
    }

    fn error_estimate(kind: &UncertaintyKind) -> Box<dyn ErrorEstimate<2>> {
        match kind.halves() {
            Some(halves) => Box::new(halves),
            None => Box::new(differences(kind)),
        }
    }

    fn truth(truth: Truth) -> Option<Arc<dyn Density<2>>> {
        truth.plane().map(|density| density as Arc<dyn Density<2>>)
    }

    fn exposed(source: Arc<dyn Exposed<2>>) -> Option<Arc<dyn Exposed<2>>> {
        Some(source)
    }
}

/// Local differences as told; the default for what is something else.
fn differences(kind: &UncertaintyKind) -> Differences {
    match kind {
        UncertaintyKind::Differences { directions, region } => Differences(LocalError {
            directions: if *directions == 4 {
                Directions::Four
            } else {
                Directions::Eight
            },
            region: *region,
        }),
        UncertaintyKind::Halves { .. } => Differences::default(),
    }
}

impl Entry {
    const fn of<E: Described>() -> Self {
        Self {
            name: E::NAME,
            summary: E::SUMMARY,
            cost: E::COST,
            reference: E::REFERENCE,
            parameters: E::PARAMETERS,
            smoothing: E::SMOOTHING,
            line: None,
            plane: None,
        }
    }

    const fn line<E: Build<1>>(self) -> Self {
        Self {
            line: Some(|values, context| Ok(Box::new(E::build(values, context)?))),
            ..self
        }
    }

    const fn plane<E: Build<2>>(self) -> Self {
        Self {
            plane: Some(|values, context| Ok(Box::new(E::build(values, context)?))),
            ..self
        }
    }

    fn checked<const D: usize>(
        &self,
        builder: Option<Builder<D>>,
        values: &Values,
        context: &Context<D>,
        place: &str,
    ) -> Built<D> {
        let Some(build) = builder else {
            return Err(BuildError {
                parameter: self.smoothing.unwrap_or_default(),
                what: format!("the estimator `{}` does not exist {place}", self.name),
            });
        };
        let elsewhere = |parameter: &&Parameter| {
            parameter.only.is_some_and(|only| only != D) && values.get(parameter.name).is_some()
        };
        if let Some(parameter) = self.parameters.iter().find(elsewhere) {
            return Err(BuildError {
                parameter: parameter.name,
                what: format!("`{}` has no meaning {place}", parameter.name),
            });
        }
        build(values, context)
    }
}

/// An estimator of the line. All that there are live in the plane too; the next may not.
#[allow(dead_code)]
const fn line<E: Build<1>>() -> Entry {
    Entry::of::<E>().line::<E>()
}

/// An estimator of the plane.
const fn plane<E: Build<2>>() -> Entry {
    Entry::of::<E>().plane::<E>()
}

/// An estimator of both: one type twice, or two types, described by the first.
const fn both<L: Build<1>, P: Build<2>>() -> Entry {
    Entry::of::<L>().line::<L>().plane::<P>()
}

/// Every estimator; to add one, add a line.
pub const ESTIMATORS: &[Entry] = &[
    both::<estimator::Histogram, estimator::HistogramPlane>(),
    both::<estimator::ShiftedHistogram, estimator::ShiftedHistogramPlane>(),
    both::<estimator::FrequencyPolygon, estimator::FrequencyPolygonPlane>(),
    both::<estimator::Naive, estimator::Naive<2>>(),
    both::<estimator::Kde, estimator::Kde<2>>(),
    both::<estimator::NearestNeighbour, estimator::NearestNeighbour>(),
    both::<estimator::GeneralisedNearestNeighbour, estimator::GeneralisedNearestNeighbour>(),
    both::<estimator::GeneralisedHistogram, estimator::GeneralisedHistogramPlane>(),
    both::<estimator::BiasCompensated, estimator::BiasCompensated>(),
    both::<estimator::Lepski, estimator::Lepski>(),
    both::<estimator::NestedTest, estimator::NestedTest>(),
    both::<estimator::TwoStage, estimator::TwoStage>(),
    plane::<estimator::VariableKernel>(),
    both::<estimator::CosineSeries, estimator::CosineSeries>(),
    both::<estimator::LegendreSeries, estimator::LegendreSeries>(),
    both::<estimator::FourierSeries, estimator::FourierSeries>(),
    both::<estimator::HermiteSeries, estimator::HermiteSeries>(),
    both::<estimator::Abramson, estimator::Abramson<2>>(),
    both::<estimator::Command, estimator::Command>(),
    both::<estimator::Normal, estimator::Normal>(),
    both::<estimator::NormalMixtureFit, estimator::NormalMixtureFit>(),
];

/// The estimator of that name.
pub fn estimator(name: &str) -> Option<&'static Entry> {
    ESTIMATORS.iter().find(|entry| entry.name == name)
}

/// The density of that name, told `values`.
///
/// # Errors
/// If there is none, or the values do not make one.
pub fn density(name: &str, values: &Values) -> Result<Truth, BuildError> {
    let unknown = || BuildError {
        parameter: "density",
        what: format!("no density is called {name}"),
    };
    density::entry(name).ok_or_else(unknown)?.build(values)
}
