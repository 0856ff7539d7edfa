//! Question → table: experiment files, what they resolve to, and running them.
//!
//! ```text
//! TOML text ─read─> Experiment (checked, resolved) ─run─> cells (journalled) ─gather─> Results ─judge─> verdicts
//! ```
//!
//! An [`Experiment`] holds only checked values; every error of a file is found in [`read`] before a sample is drawn. What the file leaves out
//! is filled in there, so that the experiment written to the manifest says everything.

pub mod budget;
pub mod catalogue;
mod claim;
mod figure;
pub mod judge;
pub mod manifest;
pub mod program;
pub mod read;
pub mod results;
pub mod run;
pub mod schema;
mod summary;
pub mod table;

pub use claim::{Claim, Measure, Statement};
pub use figure::{Figure, FigureKind};
pub use summary::summary;

use crate::parameter::Values;
use serde::Serialize;
use std::path::PathBuf;

/// A checked, fully resolved experiment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Experiment {
    /// The stem of the file's name.
    pub name: String,
    /// The question that the experiment answers.
    pub question: String,
    /// What the reader should know before the answer; paragraphs separated by empty lines.
    pub notes: String,
    /// The seed of all random streams.
    pub seed: u64,
    /// Where samples come from; at least one, names distinct.
    pub sources: Vec<SourceSpec>,
    /// Sample sizes; empty for data files, whose size is their own.
    pub draws: Vec<usize>,
    /// How many samples of each size; 1 for data files.
    pub replicates: usize,
    /// Where estimates are evaluated and errors integrated; `None`: chosen for each source from its bulk or range.
    pub grid: Option<GridSpec>,
    /// The estimators, sweeps expanded, names distinct.
    pub estimators: Vec<EstimatorSpec>,
    /// What to draw.
    pub figures: Vec<Figure>,
    /// What the run must show.
    pub claims: Vec<Claim>,
}

/// Where samples come from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum SourceSpec {
    /// A known density.
    Density {
        /// What it is called in tables and claims.
        name: String,
        /// Its kind in the catalogue of densities.
        kind: String,
        /// Its parameters.
        values: Values,
    },
    /// A data file.
    File {
        /// What it is called in tables and claims: the stem of the file's name.
        name: String,
        /// The file, relative paths resolved against the experiment's folder.
        path: PathBuf,
        /// The column of the data.
        column: String,
        /// The column of weights, if any.
        weight: Option<String>,
        /// Walls, if the data stop at known places: `[low, high]`, infinite where open.
        domain: Option<[f64; 2]>,
        /// The BLAKE3 hash of the file's bytes: other data are another experiment.
        hash: String,
    },
}

impl SourceSpec {
    /// What the source is called.
    pub fn name(&self) -> &str {
        match self {
            Self::Density { name, .. } | Self::File { name, .. } => name,
        }
    }
}

/// Cells on an interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GridSpec {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// How many cells.
    pub cells: usize,
}

impl GridSpec {
    /// Cells of a grid that gives only its ends, or nothing.
    pub const CELLS: usize = 512;
}

/// One estimator of an experiment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EstimatorSpec {
    /// What it is called in tables, legends and claims.
    pub name: String,
    /// Its kind in the catalogue.
    pub kind: String,
    /// Its parameters.
    pub values: Values,
    /// The sweep it is a member of, if any.
    pub sweep: Option<SweepMember>,
}

/// A place in a sweep.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepMember {
    /// The name of the `[[estimator]]` that was swept.
    pub group: String,
    /// The parameter that varies.
    pub parameter: String,
    /// Its value here.
    pub value: f64,
}

/// `x` to so many significant digits, without trailing zeros.
pub fn significant(x: f64, digits: usize) -> String {
    let rounded: f64 = format!("{x:.*e}", digits.saturating_sub(1))
        .parse()
        .unwrap_or(x);
    let size = rounded.abs();
    if size != 0.0 && !(1e-5..1e9).contains(&size) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn digits_are_the_fewest() {
        assert_eq!(significant(0.1, 4), "0.1");
        assert_eq!(significant(0.123_456, 4), "0.1235");
        assert_eq!(significant(12_345.6, 4), "12350");
        assert_eq!(significant(1.5e-9, 4), "1.5e-9");
        assert_eq!(significant(2.0, 4), "2");
    }
}
