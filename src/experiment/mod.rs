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
pub mod character;
mod claim;
pub mod difference;
mod figure;
pub mod judge;
mod ladder;
pub mod manifest;
mod measure;
pub mod program;
pub mod read;
pub mod region;
pub mod results;
pub mod run;
pub mod schema;
pub mod settings;
pub mod stop;
mod summary;
pub mod table;
pub mod uncertainty;

pub use claim::{Claim, Elsewhere, Statement};
pub use figure::{Figure, FigureKind};
pub use ladder::Ladder;
pub use measure::Measure;
pub use summary::summary;

use crate::density;
use crate::parameter::Values;
use crate::space::{Domain, Grid, GridError, Polygon, Side};
use region::RegionSpec;
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
    /// When the run has seen enough before all replicates are done.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop: Option<stop::StopRule>,
    /// Where estimates are evaluated and errors integrated; `None`: chosen for each source from its bulk or range.
    pub grid: Option<GridSpec>,
    /// The confidence of an interval about each estimate at each target, if their coverage is to be counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval: Option<f64>,
    /// The parts of the grid that errors are told apart by, names distinct.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<RegionSpec>,
    /// The estimators, sweeps expanded, names distinct.
    pub estimators: Vec<EstimatorSpec>,
    /// What one sample says of its own error, held against the truth.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub uncertainties: Vec<uncertainty::UncertaintySpec>,
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
        /// Points come in paths about centres of this density, if so.
        #[serde(skip_serializing_if = "Option::is_none")]
        paths: Option<PathSpec>,
    },
    /// A data file.
    File {
        /// What it is called in tables and claims: the stem of the file's name.
        name: String,
        /// The file, relative paths resolved against the experiment's folder.
        path: PathBuf,
        /// The column of each axis: one on a line, two in the plane.
        columns: Vec<String>,
        /// The column of weights, if any.
        weight: Option<String>,
        /// Walls, if the data stop at known places.
        domain: Option<Limits>,
        /// The BLAKE3 hash of the file's bytes: other data are another experiment.
        hash: String,
    },
    /// Photon hits on a surface of a scene.
    Scene {
        /// What it is called in tables and claims: the name of the surface or of the walk.
        name: String,
        /// The scene, relative paths resolved against the experiment's folder.
        path: PathBuf,
        /// The surface, by its name in the scene.
        surface: String,
        /// How photons walk.
        values: Values,
        /// The BLAKE3 hash of the scene's file.
        hash: String,
    },
}

impl SourceSpec {
    /// What the source is called.
    pub fn name(&self) -> &str {
        match self {
            Self::Density { name, .. } | Self::File { name, .. } | Self::Scene { name, .. } => name,
        }
    }

    /// 1 on a line, 2 in the plane.
    pub fn dimensions(&self) -> usize {
        match self {
            Self::Density { kind, .. } => {
                density::entry(kind).map_or(1, density::Entry::dimensions)
            }
            Self::File { columns, .. } => columns.len(),
            Self::Scene { .. } => 2,
        }
    }
}

/// Paths that leave several points each.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PathSpec {
    /// How many points a path leaves.
    pub hits: usize,
    /// The deviation of each from the centre of its path.
    pub spread: f64,
}

/// Where the points of a data file can lie.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Limits {
    /// `[low, high]` for each axis, infinite where open.
    Box(Vec<[f64; 2]>),
    /// The corners of a polygon.
    Polygon {
        /// In order.
        vertices: Vec<[f64; 2]>,
    },
}

impl Limits {
    /// The domain with walls at all finite limits.
    ///
    /// # Errors
    /// If they are not those of a domain of `D` dimensions.
    pub fn domain<const D: usize>(limits: Option<&Self>) -> Result<Domain<D>, String> {
        let side = |limit: f64| {
            if limit.is_finite() {
                Side::Wall
            } else {
                Side::Open
            }
        };
        match limits {
            None => Ok(Domain::whole()),
            Some(Self::Box(axes)) => {
                let axes = <[[f64; 2]; D]>::try_from(&axes[..])
                    .map_err(|_| format!("`domain` has limits for {} axes, not {D}", axes.len()))?;
                let (low, high) = (axes.map(|axis| axis[0]), axes.map(|axis| axis[1]));
                Domain::new(low, high, axes.map(|axis| axis.map(side)))
                    .map_err(|error| error.to_string())
            }
            Some(Self::Polygon { vertices }) => {
                let outline = Polygon::new(vertices.clone()).map_err(|error| error.to_string())?;
                Domain::bounded(outline).ok_or_else(|| "a polygon needs two axes".to_owned())
            }
        }
    }
}

/// Cells on an interval or a rectangle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridSpec {
    /// The lower end of each axis.
    pub low: Vec<f64>,
    /// The upper end of each axis.
    pub high: Vec<f64>,
    /// How many cells each axis has.
    pub cells: Vec<usize>,
}

impl GridSpec {
    /// Cells of a grid on a line that gives only its ends, or nothing.
    pub const CELLS: usize = 512;
    /// Cells of each axis in the plane.
    pub const PLANE: usize = 128;

    /// Cells of an axis where the file does not say.
    pub fn default_cells(dimensions: usize) -> usize {
        if dimensions == 1 {
            Self::CELLS
        } else {
            Self::PLANE
        }
    }

    /// The grid.
    ///
    /// # Errors
    /// If it is not one of `D` dimensions.
    pub fn grid<const D: usize>(&self) -> Result<Grid<D>, GridError> {
        let axis = |values: &[f64]| <[f64; D]>::try_from(values);
        match (
            axis(&self.low),
            axis(&self.high),
            <[usize; D]>::try_from(&self.cells[..]),
        ) {
            (Ok(low), Ok(high), Ok(cells)) => Grid::new(low, high, cells),
            _ => Err(GridError::NoCells {
                axis: self.cells.len().min(self.low.len()).min(self.high.len()),
            }),
        }
    }

    /// Cells in all.
    pub fn len(&self) -> usize {
        self.cells.iter().product()
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Experiment {
    /// 1 on a line, 2 in the plane; the same for all sources.
    pub fn dimensions(&self) -> usize {
        self.sources.first().map_or(1, SourceSpec::dimensions)
    }
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
