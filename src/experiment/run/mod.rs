//! Running an experiment: cells of work, journalled, gathered into results.
//!
//! The unit of work is a cell: one estimator on one block of replicates of one sample size from one source. Each sample has a random
//! stream of its own, named by (seed, replicate), so every estimator sees the same samples, a cell does not depend on any other,
//! and the numbers are the same for any number of threads, after any interruption, and from any machine that shares the work.

mod bench;
mod cell;
mod folder;
mod journal;
mod look;
mod opened;

pub use bench::{Bench, Setting};
pub use cell::{Cell, Part, Record, Replicate};
pub use folder::{Existing, Identity, Opening, RunFolder, fingerprint};

use super::Experiment;
use crate::space::Warning;
use crate::storage::StorageError;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// An estimator that could not do what was asked of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Its position in the experiment.
    pub estimator: usize,
    /// Its name.
    pub name: String,
    /// What went wrong, and where.
    pub what: String,
}

/// Why a run ended without results.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The experiment cannot be carried out on its data.
    #[error("{0}")]
    Input(String),
    /// An estimator failed, and there is no other to go on with.
    #[error("estimator \"{}\" {}", .0.name, .0.what)]
    Estimator(Failure),
    /// Reading or writing failed.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// The folder for the run is taken.
    #[error("{0}")]
    Folder(String),
    /// Someone asked to stop; what was finished is kept.
    #[error(
        "interrupted with {done} of {total} cells finished and saved; the same command goes on from there"
    )]
    Interrupted {
        /// Cells finished.
        done: usize,
        /// Cells in all.
        total: usize,
    },
}

/// Who wants to know how far a run is.
pub trait Progress: Sync {
    /// There are `total` units of work, `done` of which were found in the journal.
    fn begin(&self, total: u64, done: u64);
    /// `units` more are done.
    fn advance(&self, units: u64);
}

/// Nobody.
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _total: u64, _done: u64) {}
    fn advance(&self, _units: u64) {}
}

/// All cells of a run, finished.
pub struct Finished {
    /// The record of each cell.
    pub records: BTreeMap<Cell, Record>,
    /// What the reader should know, and on how many samples it came up.
    pub warnings: BTreeMap<Warning, usize>,
    /// The estimators that failed; none of their cells is among the records.
    pub failures: Vec<Failure>,
}

impl Finished {
    /// The bench without the estimators that failed, and the results numbered as its estimators then are.
    #[must_use]
    pub fn on_what_is_left<const D: usize>(mut self, bench: Bench<D>) -> (Bench<D>, Self) {
        let failed: Vec<usize> = self.failures.iter().map(|f| f.estimator).collect();
        let moved = |mut cell: Cell| {
            cell.estimator -= failed.iter().filter(|&&f| f < cell.estimator).count();
            cell
        };
        self.records = std::mem::take(&mut self.records)
            .into_iter()
            .map(|(cell, record)| (moved(cell), record))
            .collect();
        (bench.without(&failed), self)
    }
}

/// A cell computed; nothing if the run was stopped before it.
type Computed = Result<Option<(Cell, Record)>, RunError>;

/// Does what is not in the journal of `folder` yet.
///
/// An estimator that fails is left out, and the others go on. Its cells are not kept, so that it is tried again if the run is continued.
///
/// # Errors
/// If every estimator fails, the journal cannot be written, or `stop` was raised; finished cells stay in the journal.
pub fn run<const D: usize>(
    bench: &Bench<D>,
    folder: &RunFolder,
    stop: &AtomicBool,
    progress: &dyn Progress,
) -> Result<Finished, RunError> {
    let cells = bench.cells();
    let mut records: BTreeMap<Cell, Record> = BTreeMap::new();
    for &cell in &cells {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        if let Some(record) = journal::load(folder.journal(), cell) {
            records.insert(cell, record);
        }
    }
    let units =
        |cells: &mut dyn Iterator<Item = &Cell>| cells.map(|cell| bench.units(cell)).sum::<u64>();
    progress.begin(units(&mut cells.iter()), units(&mut records.keys()));

    let finished = AtomicUsize::new(records.len());
    let failed: Vec<AtomicBool> = bench
        .experiment()
        .estimators
        .iter()
        .map(|_| AtomicBool::new(false))
        .collect();
    let compute = |cell: Cell| {
        // what has failed once is not tried again, which may take long
        if stop.load(Ordering::Relaxed) || failed[cell.estimator].load(Ordering::Relaxed) {
            return Ok(None);
        }
        let computed = cell::compute(bench, cell, stop).inspect_err(|error| {
            if let RunError::Estimator(failure) = error {
                failed[failure.estimator].store(true, Ordering::Relaxed);
            }
        });
        let Some(record) = computed? else {
            return Ok(None);
        };
        journal::save(folder.journal(), cell, &record)?;
        finished.fetch_add(1, Ordering::Relaxed);
        progress.advance(bench.units(&cell));
        Ok(Some((cell, record)))
    };
    let mut failures: Vec<Failure> = Vec::new();
    let mut enough = None;
    let looks = look::looks(bench);
    let mut reached = 0;
    for (number, &look) in looks.iter().enumerate() {
        reached = look;
        let open: Vec<Cell> = cells
            .iter()
            .filter(|cell| cell.block < look && !records.contains_key(cell))
            .copied()
            .collect();
        let outcomes: Vec<Computed> = open.into_par_iter().map(compute).collect();
        for outcome in outcomes {
            match outcome {
                Ok(Some((cell, record))) => {
                    records.insert(cell, record);
                }
                Ok(None) => {}
                Err(RunError::Estimator(failure)) => {
                    if failures.iter().all(|f| f.estimator != failure.estimator) {
                        failures.push(failure);
                    }
                }
                Err(error) => return Err(error),
            }
        }
        if number + 1 < looks.len() && failures.is_empty() && !stop.load(Ordering::Relaxed) {
            enough = look::enough(bench, &records, look, looks.len());
            if enough.is_some() {
                break;
            }
        }
    }
    // what a look left out is not missing, and what an earlier run did beyond it does not count
    records.retain(|cell, _| cell.block < reached);
    let cells: Vec<Cell> = cells
        .into_iter()
        .filter(|cell| cell.block < reached)
        .collect();
    let lost = |cell: &Cell| failures.iter().any(|f| f.estimator == cell.estimator);
    records.retain(|cell, _| !lost(cell));
    if records.len() < cells.iter().filter(|cell| !lost(cell)).count() {
        return Err(RunError::Interrupted {
            done: finished.into_inner(),
            total: cells.len(),
        });
    }
    if failures.len() == bench.experiment().estimators.len() && !failures.is_empty() {
        return Err(RunError::Estimator(failures.swap_remove(0)));
    }
    let warnings = warnings(enough, &failures, &records);
    Ok(Finished {
        records,
        warnings,
        failures,
    })
}

/// Everything that the reader should know, and on how many samples it came up.
fn warnings(
    enough: Option<Warning>,
    failures: &[Failure],
    records: &BTreeMap<Cell, Record>,
) -> BTreeMap<Warning, usize> {
    let mut warnings = BTreeMap::new();
    if let Some(enough) = enough {
        warnings.insert(enough, 1);
    }
    for failure in failures {
        let warning = Warning {
            what: format!(
                "estimator \"{}\" failed {}; it is left out",
                failure.name, failure.what
            ),
            hint: "mend it and run again with --force; the others are not affected".to_owned(),
        };
        warnings.insert(warning, 1);
    }
    for record in records.values() {
        for (warning, count) in &record.warnings {
            *warnings.entry(warning.clone()).or_insert(0) += count;
        }
    }
    warnings
}

/// The number of replicates in one cell.
fn block_length(experiment: &Experiment) -> usize {
    super::budget::block_length(experiment.replicates)
}
