//! What an experiment will cost, known before anything is drawn.

use super::catalogue::{Builds, Entry};
use super::{Experiment, GridSpec, SourceSpec, catalogue};
use crate::density;
use crate::estimator::{Command, Context, Described};
use crate::memory::Bytes;
use crate::random;
use crate::sample::Sample;
use crate::space::{Field, Grid, Targets};
use std::time::Instant;

/// The most evaluations of one run: at 10⁸ a second, the order of what two cores do, four months.
pub const EVALUATIONS: f64 = 1e15;

/// What a run needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Units of work: estimators × sources × sample sizes × blocks of replicates.
    pub cells: u64,
    /// Estimates made: estimators × sources × sample sizes × replicates.
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

/// Bytes for each point of a sample: the point, its sorted copy, and the scratch of the engines.
const PER_POINT: f64 = 6.0 * 8.0;
/// Bytes for each grid cell of a block of replicates: pointwise mean and square.
const PER_CELL: f64 = 2.0 * 8.0;
/// Bytes for each estimate: its errors, integral, modes and smoothing.
const PER_ESTIMATE: f64 = 12.0 * 8.0;

/// The number of replicates in one block of work: sixteen blocks for error estimates by leaving out one, but none so long that an interruption
/// would lose much. A function of the experiment alone, so that blocks are the same on every run.
pub fn block_length(replicates: usize) -> usize {
    replicates.div_ceil(16).clamp(1, 250)
}

/// The budget of an experiment. O(1).
pub fn budget(experiment: &Experiment) -> Budget {
    let sizes: Vec<f64> = if experiment.draws.is_empty() {
        vec![file_rows(experiment)]
    } else {
        experiment.draws.iter().map(|n| *n as f64).collect()
    };
    let grid = experiment
        .grid
        .as_ref()
        .map_or_else(|| default_cells(experiment), GridSpec::len) as f64;
    let estimators = experiment.estimators.len() as f64;
    let sources = experiment.sources.len() as f64;
    let replicates = experiment.replicates as f64;
    let blocks = (replicates / block_length(experiment.replicates) as f64).ceil();
    let threads = threads().min(blocks * estimators);
    let settings = estimators * sources * sizes.len() as f64;
    let points: f64 = sizes.iter().sum();
    let largest_sample = sizes.iter().copied().fold(0.0, f64::max);
    let largest = Largest {
        samples: largest_sample * PER_POINT * experiment.dimensions() as f64 * threads,
        fields: settings * blocks * grid * PER_CELL,
        records: settings * replicates * PER_ESTIMATE,
    };
    Budget {
        cells: (settings * blocks) as u64,
        fits: settings * replicates,
        evaluations: estimators * sources * replicates * (points + grid * sizes.len() as f64),
        memory_bytes: largest.samples + largest.fields + largest.records,
        largest,
    }
}

fn threads() -> f64 {
    std::thread::available_parallelism().map_or(1.0, |n| n.get() as f64)
}

/// Cells of a grid that the file does not give.
fn default_cells(experiment: &Experiment) -> usize {
    let dimensions = experiment.dimensions();
    GridSpec::default_cells(dimensions).pow(dimensions as u32)
}

/// The seconds that a run will take on all cores, from the time that some of its estimators take now on small samples of the first source;
/// `None` for data files, which are fitted once. Good to a factor of two or three: costs are taken to grow in proportion to points and cells.
pub fn seconds(experiment: &Experiment) -> Option<f64> {
    match experiment.dimensions() {
        1 => timed::<1>(experiment),
        _ => timed::<2>(experiment),
    }
}

fn timed<const D: usize>(experiment: &Experiment) -> Option<f64>
where
    Entry: Builds<D>,
{
    const POINTS: usize = 1000;
    const TRIED: usize = 12;
    let SourceSpec::Density { kind, values, .. } = experiment.sources.first()? else {
        return None;
    };
    let truth = Entry::truth(density::entry(kind)?.build(values).ok()?)?;
    let draws = experiment.draws.iter().copied().max()?.min(POINTS);
    let mut random = random::stream(experiment.seed, "cost", 0);
    let points: Vec<_> = (0..draws).map(|_| truth.draw(&mut random)).collect();
    let sample = Sample::equal(points, truth.domain().clone()).ok()?;
    let most = GridSpec::default_cells(D);
    let cells: [usize; D] = match &experiment.grid {
        Some(grid) => grid.cells[..].try_into().ok()?,
        None => [most; D],
    };
    let cells = cells.map(|cells| cells.min(most));
    let (low, high) = truth.bulk(1e-4);
    let grid = Grid::new(low, high, cells).ok()?;
    let step = experiment.estimators.len().div_ceil(TRIED).max(1);
    let (mut tried, mut took) = (0.0, 0.0);
    for spec in experiment.estimators.iter().step_by(step) {
        // checking a file starts no programs
        if spec.kind == Command::NAME {
            continue;
        }
        let context = Context {
            truth: Some(truth.clone()),
            draws,
        };
        let estimator = catalogue::estimator(&spec.kind)?
            .build(&spec.values, &context)
            .ok()?;
        // The better of two: the first pays for cold caches.
        let mut least = f64::INFINITY;
        for _ in 0..2 {
            let start = Instant::now();
            let Ok(estimate) = estimator.fit(&sample) else {
                continue;
            };
            let values = estimate.evaluate(Targets::Grid(&grid)).values;
            std::hint::black_box(values);
            least = least.min(start.elapsed().as_secs_f64());
        }
        if least.is_finite() {
            tried += (draws + grid.len()) as f64;
            took += least;
        }
    }
    (tried > 0.0).then(|| took / tried * budget(experiment).evaluations / threads())
}

/// Data files were read when the experiment was: their size is bounded by memory already.
fn file_rows(experiment: &Experiment) -> f64 {
    experiment
        .sources
        .iter()
        .filter_map(|source| match source {
            SourceSpec::File { path, .. } => std::fs::metadata(path).ok(),
            SourceSpec::Density { .. } | SourceSpec::Scene { .. } => None,
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
