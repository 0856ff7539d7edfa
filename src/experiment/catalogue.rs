//! The only place where a name in a file meets a type.

use crate::density::{self, Univariate};
use crate::estimator::{self, BuildError, Context, Described, Estimator};
use crate::parameter::{Parameter, Values};
use std::sync::Arc;

/// An estimator built from its settings, or what is wrong with them.
pub type Built = Result<Box<dyn Estimator<1>>, BuildError>;

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
    /// Builds it from checked values.
    pub build: fn(&Values, &Context) -> Built,
}

const fn entry<E: Described>() -> Entry {
    Entry {
        name: E::NAME,
        summary: E::SUMMARY,
        cost: E::COST,
        reference: E::REFERENCE,
        parameters: E::PARAMETERS,
        smoothing: E::SMOOTHING,
        build: |values, context| Ok(Box::new(E::build(values, context)?)),
    }
}

/// Every estimator; to add one, add a line.
pub const ESTIMATORS: &[Entry] = &[
    entry::<estimator::Histogram>(),
    entry::<estimator::ShiftedHistogram>(),
    entry::<estimator::FrequencyPolygon>(),
    entry::<estimator::Naive>(),
    entry::<estimator::Kde>(),
    entry::<estimator::Normal>(),
];

/// The estimator of that name.
pub fn estimator(name: &str) -> Option<&'static Entry> {
    ESTIMATORS.iter().find(|entry| entry.name == name)
}

/// The density of that name, told `values`.
///
/// # Errors
/// If there is none, or the values do not make one.
pub fn density(name: &str, values: &Values) -> Result<Arc<dyn Univariate>, BuildError> {
    let unknown = || BuildError {
        parameter: "density",
        what: format!("no density is called {name}"),
    };
    (density::entry(name).ok_or_else(unknown)?.build)(values)
}
