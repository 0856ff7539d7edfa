//! Running an experiment: cells of work, journalled, gathered into results.
//!
//! The unit of work is a cell: one estimator on one block of replicates of one sample size from one source. Each sample has a random
//! stream of its own, named by (seed, replicate), so every estimator sees the same samples, a cell does not depend on any other,
//! and the numbers are the same for any number of threads, after any interruption, and from any machine that shares the work.

mod bench;
mod cell;
mod folder;
mod journal;

pub use bench::{Bench, Setting};
pub use cell::{Cell, Record, Replicate};
pub use folder::{Existing, Identity, Opening, RunFolder, fingerprint};

use super::Experiment;
use crate::space::Warning;
use crate::storage::StorageError;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Why a run ended without results.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The experiment cannot be carried out on its data.
    #[error("{0}")]
    Input(String),
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
}

/// Does what is not in the journal of `folder` yet.
///
/// # Errors
/// If a sample cannot be fitted, the journal cannot be written, or `stop` was raised; finished cells stay in the journal.
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

    let open: Vec<Cell> = cells
        .iter()
        .filter(|cell| !records.contains_key(cell))
        .copied()
        .collect();
    let finished = AtomicUsize::new(records.len());
    let outcomes: Vec<Result<Option<(Cell, Record)>, RunError>> = open
        .into_par_iter()
        .map(|cell| {
            if stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let Some(record) = cell::compute(bench, cell, stop)? else {
                return Ok(None);
            };
            journal::save(folder.journal(), cell, &record)?;
            finished.fetch_add(1, Ordering::Relaxed);
            progress.advance(bench.units(&cell));
            Ok(Some((cell, record)))
        })
        .collect();
    for outcome in outcomes {
        if let Some((cell, record)) = outcome? {
            records.insert(cell, record);
        }
    }
    if records.len() < cells.len() {
        return Err(RunError::Interrupted {
            done: finished.into_inner(),
            total: cells.len(),
        });
    }
    let mut warnings = BTreeMap::new();
    for record in records.values() {
        for (warning, count) in &record.warnings {
            *warnings.entry(warning.clone()).or_insert(0) += count;
        }
    }
    Ok(Finished { records, warnings })
}

/// The number of replicates in one cell.
fn block_length(experiment: &Experiment) -> usize {
    super::budget::block_length(experiment.replicates)
}
