//! What an experiment will cost, known before anything is drawn.

use super::{Experiment, SourceSpec};
use crate::memory::Bytes;

/// The most evaluations of one run: at 10⁸ a second, the order of what two cores do, four months.
pub const EVALUATIONS: f64 = 1e15;

/// What a run needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Estimators × sources × sample sizes: the rows of the table for each measure.
    pub cells: u64,
    /// Estimates made: cells × replicates.
    pub fits: f64,
    /// Points read and grid cells filled over all estimates.
    pub evaluations: f64,
    /// The most memory held at once.
    pub memory_bytes: f64,
    largest: Largest,
}

/// The parts of the memory, so that the largest can be blamed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Largest {
    samples: f64,
    fields: f64,
    records: f64,
}

/// What makes an experiment too large.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The sample sizes.
    Draws,
    /// The replicates.
    Replicates,
    /// The grid.
    Grid,
}

/// Why an experiment is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}")]
pub struct Refusal {
    /// What to make smaller.
    pub part: Part,
    /// What it would need.
    pub what: String,
}

/// Numbers held for each point of a sample: the point, its sorted copy, prefix sums and scratch of the engines.
const PER_POINT: f64 = 8.0 * 8.0;
/// Numbers held for each grid cell of an estimator and size: mean, square, first sample, truth, exact moments.
const PER_CELL: f64 = 8.0 * 8.0;
/// Numbers kept of each estimate: one a measure.
const PER_ESTIMATE: f64 = 8.0 * 8.0;

/// The budget of an experiment. O(1).
pub fn budget(experiment: &Experiment) -> Budget {
    let sizes: Vec<f64> = if experiment.draws.is_empty() {
        vec![file_rows(experiment)]
    } else {
        experiment.draws.iter().map(|n| *n as f64).collect()
    };
    let grid = experiment
        .grid
        .map_or(super::read::DEFAULT_CELLS as f64, |grid| grid.cells as f64);
    let estimators = experiment.estimators.len() as f64;
    let sources = experiment.sources.len() as f64;
    let replicates = experiment.replicates as f64;
    let threads = std::thread::available_parallelism().map_or(1.0, |n| n.get() as f64);
    let settings = estimators * sources * sizes.len() as f64;
    let points: f64 = sizes.iter().sum();
    let evaluations = estimators * sources * replicates * (points + grid * sizes.len() as f64);
    let largest_sample = sizes.iter().copied().fold(0.0, f64::max);
    let largest = Largest {
        samples: largest_sample * PER_POINT * threads.min(replicates),
        fields: settings * grid * PER_CELL,
        records: settings * replicates * PER_ESTIMATE,
    };
    Budget {
        cells: settings as u64,
        fits: settings * replicates,
        evaluations,
        memory_bytes: largest.samples + largest.fields + largest.records,
        largest,
    }
}

/// Data files were read when the experiment was: their size is bounded by memory already.
fn file_rows(experiment: &Experiment) -> f64 {
    experiment
        .sources
        .iter()
        .filter_map(|source| match source {
            SourceSpec::File { path, .. } => std::fs::metadata(path).ok(),
            SourceSpec::Density { .. } => None,
        })
        // A number takes some four bytes of text at least.
        .map(|data| data.len() as f64 / 4.0)
        .sum()
}

impl Budget {
    /// Whether it can be had, with so many bytes of memory.
    ///
    /// # Errors
    /// If it cannot, with what it would need.
    pub fn check(&self, available: u64) -> Result<(), Refusal> {
        if self.memory_bytes > available as f64 {
            let Largest {
                samples,
                fields,
                records,
            } = self.largest;
            let (part, of) = if samples >= fields && samples >= records {
                (Part::Draws, "samples")
            } else if fields >= records {
                (Part::Grid, "estimates on the grid")
            } else {
                (Part::Replicates, "errors of each replicate")
            };
            return Err(Refusal {
                part,
                what: format!(
                    "this would need {} of memory, most of it for the {of}; {} are available",
                    Bytes(self.memory_bytes as u64),
                    Bytes(available)
                ),
            });
        }
        if self.evaluations > EVALUATIONS {
            return Err(Refusal {
                part: Part::Replicates,
                what: format!(
                    "this would take {:.1e} evaluations; the limit is {EVALUATIONS:.0e}",
                    self.evaluations
                ),
            });
        }
        Ok(())
    }
}
