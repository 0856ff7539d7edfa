//! The unit of work: one estimator on one block of replicates.

use super::{Bench, Failure, RunError, Setting};
use crate::accuracy::{Coverage, Errors, Tally, reach};
use crate::estimator::{Estimate, Estimator};
use crate::experiment::uncertainty::Said;
use crate::numeric::{Sum, sum};
use crate::random;
use crate::sample::Sample;
use crate::space::{Field, Point, RIPPLE, Raster, Targets, Warning, mode_count};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Which cell: positions in the experiment's lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Cell {
    /// The source.
    pub source: usize,
    /// The sample size, as a position in the source's list of sizes.
    pub size: usize,
    /// The estimator.
    pub estimator: usize,
    /// The block of replicates.
    pub block: usize,
}

/// What one estimate on one sample gave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Replicate {
    /// Its errors, where the truth is known.
    pub errors: Option<Errors>,
    /// ∫f̂ over the grid.
    pub integral: f64,
    /// Local maxima on the grid.
    pub modes: usize,
    /// The bandwidth or width used, where there is one.
    pub smoothing: Option<f64>,
    /// The same errors and integral over each region.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<Part>,
}

/// What one estimate gave over one region.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Its errors, where the truth is known.
    pub errors: Option<Errors>,
    /// ∫f̂ over the region.
    pub integral: f64,
}

/// What a cell gave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// One entry a replicate, in order.
    pub replicates: Vec<Replicate>,
    /// Pointwise moments of f̂ - f (of f̂ itself where the truth is not known).
    pub tally: Tally,
    /// What the reader should know, and on how many samples it came up.
    pub warnings: Vec<(Warning, usize)>,
    /// The engine used, where there was a choice.
    pub engine: Option<String>,
    /// What each estimate of the error said.
    #[serde(default)]
    pub said: Vec<Said>,
    /// How often intervals about the estimate held what they are about, where the experiment asks for them and the estimator has them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coverage: Option<Coverage>,
}

/// The replicates of a block.
pub(super) fn replicates<const D: usize>(bench: &Bench<D>, block: usize) -> Range<usize> {
    let length = super::block_length(bench.experiment());
    block * length..((block + 1) * length).min(bench.experiment().replicates)
}

/// Computes a cell; `None` if `stop` was raised before its end.
pub(super) fn compute<const D: usize>(
    bench: &Bench<D>,
    cell: Cell,
    stop: &AtomicBool,
) -> Result<Option<Record>, RunError> {
    let setting = bench.setting(cell.source, cell.size);
    let estimator = &setting.estimators[cell.estimator];
    let measure = setting.grid.cell_measure();
    let mut record = Record {
        replicates: Vec::new(),
        tally: Tally::default(),
        warnings: Vec::new(),
        engine: None,
        said: vec![Said::default(); setting.uncertainties.len()],
        coverage: None,
    };
    let mut intervals = Intervals::new(bench, cell);
    for replicate in replicates(bench, cell.block) {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let sample = bench.sample(cell.source, cell.size, replicate)?;
        let estimate = estimator.fit(&sample).map_err(|error| {
            let name = &bench.experiment().estimators[cell.estimator].name;
            let source = bench.experiment().sources[cell.source].name();
            RunError::Estimator(Failure {
                estimator: cell.estimator,
                name: name.clone(),
                what: format!(
                    "on sample {replicate} of {} points from \"{source}\": {error}",
                    sample.len()
                ),
            })
        })?;
        let evaluation = estimate.evaluate(Targets::Grid(&setting.grid));
        if let Some(why) = evaluation.failure {
            return Err(RunError::Estimator(Failure {
                estimator: cell.estimator,
                name: bench.experiment().estimators[cell.estimator].name.clone(),
                what: format!("on sample {replicate}: {why}"),
            }));
        }
        for warning in evaluation.warnings {
            match record
                .warnings
                .iter_mut()
                .find(|(known, _)| *known == warning)
            {
                Some((_, count)) => *count += 1,
                None => record.warnings.push((warning, 1)),
            }
        }
        record.engine = record.engine.or(evaluation.engine.map(str::to_owned));
        let mut values = evaluation.values;
        setting.restrict(&mut values);
        let raster = Raster::new(setting.grid, values);
        let values = raster.values();
        let total = sum(values);
        // a sum that is a number has terms that are
        if !total.is_finite()
            && let Some(place) = values.iter().position(|v| !v.is_finite())
        {
            let x = place_name(setting.grid.centre(place));
            let name = &bench.experiment().estimators[cell.estimator].name;
            return Err(RunError::Estimator(Failure {
                estimator: cell.estimator,
                name: name.clone(),
                what: format!("gave {} at {x} on sample {replicate}", values[place]),
            }));
        }
        record.replicates.push(Replicate {
            errors: setting
                .yardstick
                .as_ref()
                .map(|yardstick| yardstick.errors(values, measure)),
            integral: total * measure,
            modes: mode_count(&raster, RIPPLE.max(2.0 * evaluation.error)),
            smoothing: estimate.smoothing,
            regions: parts(setting, values),
        });
        for (said, uncertainty) in record.said.iter_mut().zip(&setting.uncertainties) {
            let squared = uncertainty.squared(&**estimator, &sample, Targets::Grid(&setting.grid));
            let mut squared = squared.map_err(|error| {
                RunError::Estimator(Failure {
                    estimator: cell.estimator,
                    name: bench.experiment().estimators[cell.estimator].name.clone(),
                    what: format!("on sample {replicate}: {error}"),
                })
            })?;
            setting.restrict(&mut squared);
            said.add(&squared, measure);
        }
        if let Some(intervals) = &mut intervals {
            intervals.note(&estimate, &sample, values, setting.truth());
        }
        match setting.truth() {
            Some(truth) => record.tally.add(values, truth),
            None => record.tally.add(values, &vec![0.0; values.len()]),
        }
    }
    record.coverage = intervals.and_then(|intervals| intervals.found);
    Ok(Some(record))
}

/// The intervals about the estimates of a cell.
struct Intervals<'a, const D: usize> {
    estimator: &'a dyn Estimator<D>,
    places: Vec<Point<D>>,
    /// Half of their length, in deviations.
    reach: f64,
    /// What the estimates expect.
    mean: Option<Vec<f64>>,
    found: Option<Coverage>,
}

impl<'a, const D: usize> Intervals<'a, D> {
    /// `None` where the experiment does not ask for them.
    fn new(bench: &'a Bench<D>, cell: Cell) -> Option<Self> {
        let confidence = bench.experiment().interval?;
        let setting = bench.setting(cell.source, cell.size);
        let estimator = &*setting.estimators[cell.estimator];
        let places: Vec<Point<D>> = setting.grid.centres().collect();
        let moments = bench
            .independent(cell.source)
            .and_then(|truth| estimator.expectation(&**truth, setting.draws, &places));
        Some(Self {
            estimator,
            reach: reach(confidence),
            mean: moments.map(|moments| moments.iter().map(|m| m.mean).collect()),
            places,
            found: None,
        })
    }

    fn note(
        &mut self,
        estimate: &Estimate<D>,
        sample: &Sample<D>,
        values: &[f64],
        truth: Option<&[f64]>,
    ) {
        let variance = self.estimator.variance(estimate, sample, &self.places);
        let Some(variance) = variance else { return };
        let half: Vec<f64> = variance.iter().map(|v| self.reach * v.sqrt()).collect();
        let found = self.found.get_or_insert_default();
        found.add(values, &half, self.mean.as_deref(), truth);
    }
}

/// Errors and integral over each region.
fn parts<const D: usize>(setting: &Setting<D>, values: &[f64]) -> Vec<Part> {
    let measure = setting.grid.cell_measure();
    let one = |(_, cells): &(String, Vec<u32>)| {
        let numbers = || cells.iter().map(|&cell| cell as usize);
        let yardstick = setting.yardstick.as_ref();
        Part {
            errors: yardstick.map(|yardstick| yardstick.errors_over(numbers(), values, measure)),
            integral: numbers().map(|i| values[i]).collect::<Sum>().value() * measure,
        }
    };
    setting.regions.iter().map(one).collect()
}

/// The stream that draws replicate number `replicate`: common to all estimators, sizes and sources, so that comparisons are paired.
pub(super) fn sampling_stream(seed: u64, replicate: usize) -> random::Stream {
    random::stream(seed, "sample", replicate as u64)
}

/// A place in words.
fn place_name<const D: usize>(place: Point<D>) -> String {
    let coordinates = place.iter().zip(["x", "y"]);
    coordinates
        .map(|(value, axis)| format!("{axis} = {value}"))
        .collect::<Vec<_>>()
        .join(", ")
}
