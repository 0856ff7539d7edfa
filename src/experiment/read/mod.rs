//! TOML text → checked experiment, or every problem of the text at once.
//!
//! Reading goes on after a problem: what can still be understood is checked too, so that one look at the messages mends the file. Each problem
//! says where it is, what is allowed there and, where a word looks misspelt, what was probably meant.
//!
//! | file | what it reads |
//! |---|---|
//! | `whole` | the experiment from its parts |
//! | `trial` | building every estimator before the run |
//! | `source`, `data`, `grid`, `region`, `estimator`, `figure`, `section`, `claim` | the parts |
//! | `form`, `sweep` | what claims take; several values for one parameter |
//! | `single` | one estimator or density outside of an experiment |
//! | `names`, `setting` | what figures and claims refer to |
//! | `evidence` | whether a claim can be shown, and could fail |
//!
//! Text, tables, values and problems are the business of [`crate::document`].
//!
//! Nothing in a file is executed, and the only other files opened are the data files that it names.

mod camera;
pub(crate) mod claim;
mod data;
pub(crate) mod estimator;
mod evidence;
pub(crate) mod figure;
pub(crate) mod form;
pub(crate) mod grid;
mod names;
mod rate;
pub(crate) mod region;
pub(crate) mod scene;
mod section;
mod setting;
mod single;
pub(crate) mod source;
pub(crate) mod stop;
pub(crate) mod sweep;
mod trial;
pub(crate) mod uncertainty;
pub(crate) mod whole;

pub use crate::document::{LARGEST, Problem, Problems, Span};

use super::catalogue::{Builds, Entry};
use super::{EstimatorSpec, Experiment};
use crate::density::Truth;
use crate::document::{node, problem, syntax as document, value};
use crate::estimator::{Context, Estimator};
use std::path::Path;

/// The largest sample.
pub const DRAWS: u64 = 1_000_000_000;
/// The most samples of each size.
pub const REPLICATES: u64 = 10_000_000;
/// The most cells of a grid.
pub const CELLS: u64 = 10_000_000;
/// The most estimators, sweeps expanded.
pub const ESTIMATORS: usize = 10_000;
/// The most regions.
pub const REGIONS: usize = 100;
/// The most figures.
pub const FIGURES: usize = 100;
/// The most claims.
pub const CLAIMS: usize = 1000;

/// Reads the experiment in the file at `path`; `-` is the standard input.
///
/// # Errors
/// With everything that is wrong. [`Problems::is_input_output`] tells a file that could not be read from a wrong one.
pub fn experiment(path: &Path) -> Result<Experiment, Problems> {
    let text = document::text(path, "experiment")?;
    experiment_text(&text, path)
}

/// Reads the experiment `text`; paths in it are relative to the folder of `origin`, whose stem is the experiment's name.
///
/// # Errors
/// With everything that is wrong.
pub fn experiment_text(text: &str, origin: &Path) -> Result<Experiment, Problems> {
    crate::document::read(text, origin, |reader, document, text| {
        whole::experiment(reader, document, text, origin)
    })
}

/// Reads one estimator from an inline table: `{ kernel = { bandwidth = 0.3 } }`, or without the outer braces. No sweeps.
///
/// # Errors
/// With everything that is wrong, located in `text` under the name `origin`.
pub fn estimator(text: &str, origin: &str) -> Result<EstimatorSpec, Problems> {
    single::estimator::<1>(text, origin, None).map(|(spec, _)| spec)
}

/// Reads one estimator and builds it, so that settings that do not go together are located too.
///
/// # Errors
/// As [`estimator`], and if it cannot be built in `context`.
pub fn estimator_in<const D: usize>(
    text: &str,
    origin: &str,
    context: &Context<D>,
) -> Result<(EstimatorSpec, Box<dyn Estimator<D>>), Problems>
where
    Entry: Builds<D>,
{
    let (spec, built) = single::estimator(text, origin, Some(context))?;
    let built = built.ok_or_else(|| Problems::whole(origin, "the estimator was not built"))?;
    Ok((spec, built))
}

/// Reads one density with its parameters: `{ beta = { a = 2, b = 3 } }`, or without the outer braces.
///
/// # Errors
/// With everything that is wrong, located in `text` under the name `origin`.
pub fn density(text: &str, origin: &str) -> Result<Truth, Problems> {
    single::density(text, origin)
}
