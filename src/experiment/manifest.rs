//! What a run was, completely: enough to replay it and to know what to trust it for.

use super::judge::Verdict;
use super::program::{self, REVISION, VERSION};
use super::results::Results;
use super::run::fingerprint;
use super::{Experiment, Measure};
use crate::random::GENERATOR;
use crate::storage::{StorageError, write_atomically};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// How a run was carried out; what is not part of the experiment and does not change its numbers.
#[derive(Clone, Debug)]
pub struct Circumstances {
    /// The command that repeats it.
    pub command: String,
    /// Threads used.
    pub threads: usize,
    /// Seconds from beginning to end, of this call alone when it continued an earlier one.
    pub seconds: f64,
    /// Whether it was a quick run with fewer replicates than the file asks for.
    pub quick: bool,
}

#[derive(Serialize)]
struct Manifest<'a> {
    program: &'static str,
    version: &'static str,
    revision: &'static str,
    build: &'static str,
    fingerprint: String,
    command: &'a str,
    quick: bool,
    threads: usize,
    seconds: f64,
    random_generator: &'static str,
    engines: BTreeMap<&'a str, Vec<&'a str>>,
    claims_hold: bool,
    verdicts: Vec<Line>,
    warnings: Vec<String>,
    summary: Vec<SummaryRow>,
    experiment: &'a Experiment,
}

/// A verdict as the manifest keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// The claim in words.
    pub claim: String,
    /// Whether it holds.
    pub holds: bool,
    /// The numbers.
    pub detail: String,
    /// Whether theory alone decides it, so that the number of replicates does not matter.
    pub theory: bool,
}

impl Line {
    /// The verdicts on all claims, and that an estimator fits the data on each that failed to.
    pub fn all<const D: usize>(
        experiment: &Experiment,
        results: &Results<D>,
        verdicts: &[Verdict],
    ) -> Vec<Self> {
        let claims = verdicts.iter().map(|verdict| verdict.line(experiment));
        let failures = results.failures.iter().map(|failure| Self {
            claim: format!("\"{}\" can be computed", failure.name),
            holds: false,
            detail: format!("failed {}", failure.what),
            theory: true,
        });
        claims.chain(failures).collect()
    }
}

/// An estimator's results in one line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SummaryRow {
    /// The source.
    pub source: String,
    /// The sample size.
    pub draws: usize,
    /// The estimator.
    pub estimator: String,
    /// The bandwidth or width used, on average.
    pub smoothing: Option<f64>,
    /// The simulated MISE.
    pub mise: Option<f64>,
    /// Its standard error.
    pub standard_error: Option<f64>,
    /// The exact MISE.
    pub exact: Option<f64>,
    /// Integrated bias², simulated.
    pub bias2: Option<f64>,
    /// Integrated variance, simulated.
    pub variance: Option<f64>,
    /// ∫f̂ / ∫f.
    pub energy: Option<f64>,
    /// The mean number of modes.
    pub modes: f64,
}

impl SummaryRow {
    /// One row an estimator and group.
    pub fn all<const D: usize>(results: &Results<D>) -> Vec<Self> {
        let mut rows = Vec::new();
        for group in &results.groups {
            for outcome in &group.outcomes {
                let value = |measure| {
                    outcome
                        .measures
                        .get(&measure)
                        .map(|interval| interval.value)
                };
                rows.push(Self {
                    source: group.name.clone(),
                    draws: group.draws,
                    estimator: outcome.name.clone(),
                    smoothing: value(Measure::Smoothing),
                    mise: value(Measure::Mise),
                    standard_error: outcome
                        .measures
                        .get(&Measure::Mise)
                        .and_then(|mise| mise.standard_error),
                    exact: value(Measure::ExactMise),
                    bias2: value(Measure::Bias2),
                    variance: value(Measure::Variance),
                    energy: value(Measure::Energy),
                    modes: value(Measure::Modes).unwrap_or_default(),
                });
            }
        }
        rows
    }
}

/// The verdicts of a finished run, read back.
#[derive(Clone, Debug, Deserialize)]
pub struct Past {
    /// One line a claim.
    pub verdicts: Vec<Line>,
    /// One line an estimator and group.
    pub summary: Vec<SummaryRow>,
}

/// Writes `manifest.json` into `folder`.
///
/// # Errors
/// If it cannot be written.
pub fn write<const D: usize>(
    folder: &Path,
    experiment: &Experiment,
    results: &Results<D>,
    verdicts: &[Verdict],
    circumstances: &Circumstances,
) -> Result<(), StorageError> {
    let mut engines: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for outcome in results.groups.iter().flat_map(|group| &group.outcomes) {
        if let Some(engine) = &outcome.engine {
            let used = engines.entry(&outcome.name).or_default();
            if !used.contains(&engine.as_str()) {
                used.push(engine);
            }
        }
    }
    let verdicts = Line::all(experiment, results, verdicts);
    let manifest = Manifest {
        program: "lab",
        version: VERSION,
        revision: REVISION,
        build: program::build(),
        fingerprint: fingerprint(experiment, circumstances.quick),
        command: &circumstances.command,
        quick: circumstances.quick,
        threads: circumstances.threads,
        seconds: circumstances.seconds,
        random_generator: GENERATOR,
        engines,
        claims_hold: verdicts.iter().all(|line| line.holds),
        verdicts,
        warnings: results
            .warnings
            .iter()
            .map(|(warning, count)| format!("{} ({count} samples)", warning.what))
            .collect(),
        summary: SummaryRow::all(results),
        experiment,
    };
    let path = folder.join("manifest.json");
    let text = serde_json::to_string_pretty(&manifest)
        .map_err(std::io::Error::other)
        .map_err(StorageError::at(&path, "encoding"))?;
    write_atomically(&path, (text + "\n").as_bytes())
}

/// Reads the verdicts of the finished run in `folder`.
///
/// # Errors
/// If there is no manifest, or it is not one.
pub fn read(folder: &Path) -> Result<Past, StorageError> {
    let path = folder.join("manifest.json");
    let bytes = crate::storage::read(&path)?;
    serde_json::from_slice(&bytes)
        .map_err(std::io::Error::other)
        .map_err(StorageError::at(&path, "reading"))
}
