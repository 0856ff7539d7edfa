//! Results as tidy CSV: one row an observation, named columns, shortest digits that read back exactly.

use super::Experiment;
use super::judge::Verdict;
use super::results::{Outcome, Results};
use super::uncertainty::Quantity;
use crate::accuracy::{compare, coverage_with_bias, reach, share_interval};
use crate::experiment::Measure;
use crate::experiment::results::CONFIDENCE;
use crate::storage::{StorageError, write_atomically};
use std::fmt::Write;
use std::path::Path;

/// A table before it becomes a file.
pub struct Table {
    /// The file's name.
    pub file: &'static str,
    /// The names of the columns.
    pub columns: Vec<&'static str>,
    /// The rows.
    pub rows: Vec<Vec<String>>,
}

/// The shortest decimal that reads back as the same number; empty for what does not exist.
pub fn digits(value: Option<f64>) -> String {
    value
        .filter(|v| v.is_finite())
        .map_or_else(String::new, |v| format!("{v:?}"))
}

impl Table {
    /// Writes the table into `folder`, whole or not at all.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), StorageError> {
        let path = folder.join(self.file);
        let bytes = self.to_csv().map_err(StorageError::at(&path, "encoding"))?;
        write_atomically(&path, &bytes)
    }

    fn to_csv(&self) -> std::io::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(&self.columns)?;
        for row in &self.rows {
            writer.write_record(row)?;
        }
        writer
            .into_inner()
            .map_err(|error| std::io::Error::other(error.to_string()))
    }
}

/// One row for each source, size, estimator and measure: value, standard error, interval, exact value.
pub fn summary<const D: usize>(results: &Results<D>) -> Table {
    let mut rows = Vec::new();
    for group in &results.groups {
        for outcome in &group.outcomes {
            for (&measure, interval) in &outcome.measures {
                let exact =
                    exact_counterpart(measure).and_then(|exact| outcome.measures.get(&exact));
                rows.push(vec![
                    group.name.clone(),
                    group.draws.to_string(),
                    outcome.name.clone(),
                    measure.name().to_owned(),
                    digits(Some(interval.value)),
                    digits(interval.standard_error),
                    digits(interval.standard_error.map(|_| interval.low)),
                    digits(interval.standard_error.map(|_| interval.high)),
                    digits(exact.map(|e| e.value)),
                    outcome.replicates.len().to_string(),
                ]);
            }
        }
    }
    let columns = vec![
        "source",
        "n",
        "estimator",
        "measure",
        "value",
        "standard_error",
        "low",
        "high",
        "exact",
        "replicates",
    ];
    Table {
        file: "summary.csv",
        columns,
        rows,
    }
}

/// One row for each source, size, region, estimator and measure, where the experiment names regions.
pub fn regions<const D: usize>(results: &Results<D>) -> Table {
    let mut rows = Vec::new();
    for group in &results.groups {
        for (region, cells) in &group.regions {
            let Some(part) = group.within(region) else {
                continue;
            };
            for outcome in &part.outcomes {
                for (measure, interval) in &outcome.measures {
                    if matches!(measure, Measure::Modes | Measure::Smoothing) {
                        continue;
                    }
                    rows.push(vec![
                        group.name.clone(),
                        group.draws.to_string(),
                        region.clone(),
                        cells.len().to_string(),
                        outcome.name.clone(),
                        measure.name().to_owned(),
                        digits(Some(interval.value)),
                        digits(interval.standard_error),
                        digits(interval.standard_error.map(|_| interval.low)),
                        digits(interval.standard_error.map(|_| interval.high)),
                    ]);
                }
            }
        }
    }
    let columns = vec![
        "source",
        "n",
        "region",
        "cells",
        "estimator",
        "measure",
        "value",
        "standard_error",
        "low",
        "high",
    ];
    Table {
        file: "regions.csv",
        columns,
        rows,
    }
}

/// The exact measure that a simulated one estimates.
pub fn exact_counterpart(measure: Measure) -> Option<Measure> {
    match measure {
        Measure::Mise => Some(Measure::ExactMise),
        Measure::Bias2 => Some(Measure::ExactBias2),
        Measure::Variance => Some(Measure::ExactVariance),
        _ => None,
    }
}

/// One row for each target and what an interval about the estimate there should hold: how often it does, with an interval for that share, and how often it
/// would if the estimate were normal with its exact mean and variance. Without rows where no coverage is counted.
pub fn coverage<const D: usize>(experiment: &Experiment, results: &Results<D>) -> Table {
    let mut rows = Vec::new();
    let reach = experiment.interval.map_or(f64::NAN, reach);
    for group in &results.groups {
        for outcome in &group.outcomes {
            let Some(coverage) = &outcome.coverage else {
                continue;
            };
            let targets = [("mean", &coverage.mean), ("truth", &coverage.truth)];
            for (target, held) in targets {
                for (i, held) in held.iter().enumerate() {
                    let share = share_interval(*held as usize, coverage.count as usize, CONFIDENCE);
                    let mut row = vec![
                        group.name.clone(),
                        group.draws.to_string(),
                        outcome.name.clone(),
                    ];
                    row.extend(group.grid.centre(i).map(|x| digits(Some(x))));
                    let normal = match target {
                        "mean" => Some(coverage_with_bias(reach, 0.0)),
                        _ => outcome.normal_coverage(group, i, reach),
                    };
                    row.extend([
                        target.to_owned(),
                        digits(Some(share.value)),
                        digits(Some(share.low)),
                        digits(Some(share.high)),
                        digits(normal),
                        coverage.count.to_string(),
                    ]);
                    rows.push(row);
                }
            }
        }
    }
    let mut columns = vec!["source", "n", "estimator"];
    columns.extend(&["x", "y"][..D.min(2)]);
    columns.extend(["target", "share", "low", "high", "normal", "replicates"]);
    Table {
        file: "coverage.csv",
        columns,
        rows,
    }
}

/// The file of [`replicates`].
pub const REPLICATES: &str = "replicates.csv";

/// One row for each replicate of each estimator, as the text of its file at once: there may be millions.
pub fn replicates<const D: usize>(results: &Results<D>) -> String {
    let mut text = "source,n,estimator,replicate,ise,iae,ire,integral,modes,smoothing\n".to_owned();
    for group in &results.groups {
        for outcome in &group.outcomes {
            let start = format!(
                "{},{},{},",
                field(&group.name),
                group.draws,
                field(&outcome.name)
            );
            for (number, replicate) in outcome.replicates.iter().enumerate() {
                let errors = replicate.errors;
                text.push_str(&start);
                // to a string nothing can fail
                let _ = write!(text, "{number}");
                append(&mut text, errors.map(|e| e.ise));
                append(&mut text, errors.map(|e| e.iae));
                append(&mut text, errors.map(|e| e.ire));
                append(&mut text, Some(replicate.integral));
                let _ = write!(text, ",{}", replicate.modes);
                append(&mut text, replicate.smoothing);
                text.push('\n');
            }
        }
    }
    text
}

/// A name as CSV takes it.
fn field(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

/// A comma and [`digits`].
fn append(text: &mut String, value: Option<f64>) {
    let _ = match value.filter(|v| v.is_finite()) {
        Some(value) => write!(text, ",{value:?}"),
        None => text.write_char(','),
    };
}

/// Estimators compared two at a time on the same samples, for every pair of at most this many estimators; sweeps of hundreds would drown the reader.
const COMPARED: usize = 16;

/// One row for each pair of estimators and error: the paired difference and ratio of means.
pub fn pairs<const D: usize>(results: &Results<D>) -> Table {
    let mut rows = Vec::new();
    for group in results
        .groups
        .iter()
        .filter(|group| group.truth.is_some() && group.outcomes.len() <= COMPARED)
    {
        for (i, a) in group.outcomes.iter().enumerate() {
            for b in &group.outcomes[i + 1..] {
                for measure in [Measure::Mise, Measure::Miae, Measure::Mire] {
                    rows.extend(pair(group.name.clone(), group.draws, measure, a, b));
                }
            }
        }
    }
    let columns = vec![
        "source",
        "n",
        "measure",
        "estimator",
        "versus",
        "difference",
        "standard_error",
        "low",
        "high",
        "ratio",
        "ratio_standard_error",
    ];
    Table {
        file: "pairs.csv",
        columns,
        rows,
    }
}

fn pair(
    source: String,
    draws: usize,
    measure: Measure,
    a: &Outcome,
    b: &Outcome,
) -> Option<Vec<String>> {
    let paired = compare(
        &a.per_replicate(measure, 1.0)?,
        &b.per_replicate(measure, 1.0)?,
        CONFIDENCE,
    );
    let difference = paired.difference;
    Some(vec![
        source,
        draws.to_string(),
        measure.name().to_owned(),
        a.name.clone(),
        b.name.clone(),
        digits(Some(difference.value)),
        digits(difference.standard_error),
        digits(difference.standard_error.map(|_| difference.low)),
        digits(difference.standard_error.map(|_| difference.high)),
        digits(Some(paired.ratio)),
        digits(paired.ratio_error),
    ])
}

/// One row for each target: the truth, and for each estimator the estimate of the first sample, the mean over replicates, its standard deviation, and the exact mean.
///
/// `first[group][estimator]` are the estimates of each group's first sample.
pub fn curves<const D: usize>(results: &Results<D>, first: &[&[Vec<f64>]]) -> Table {
    let mut rows = Vec::new();
    for (group, estimates) in results.groups.iter().zip(first) {
        for (outcome, estimate) in group.outcomes.iter().zip(*estimates) {
            let deviation = outcome.tally.deviation();
            for (i, &value) in estimate.iter().enumerate() {
                let truth = group.truth.as_ref().map(|truth| truth[i]);
                let place = group.grid.centre(i);
                let mut row = vec![
                    group.name.clone(),
                    group.draws.to_string(),
                    outcome.name.clone(),
                ];
                row.extend(place.map(|coordinate| digits(Some(coordinate))));
                row.extend([
                    digits(truth),
                    digits(Some(value)),
                    digits(Some(outcome.tally.mean()[i] + truth.unwrap_or(0.0))),
                    digits(deviation.as_ref().map(|d| d[i])),
                    digits(outcome.expected.as_ref().map(|e| e[i])),
                ]);
                rows.push(row);
            }
        }
    }
    let axes = &["x", "y"][..D.min(2)];
    let mut columns = vec!["source", "n", "estimator"];
    columns.extend(axes);
    columns.extend(["truth", "first_sample", "mean", "deviation", "expected"]);
    Table {
        file: "curves.csv",
        columns,
        rows,
    }
}

/// One row for each estimator, estimate of the error and quantity.
pub fn uncertainties<const D: usize>(experiment: &Experiment, results: &Results<D>) -> Table {
    let mut rows = Vec::new();
    for group in &results.groups {
        for outcome in &group.outcomes {
            for (at, spec) in experiment.uncertainties.iter().enumerate() {
                for quantity in Quantity::ALL {
                    let Some(found) = outcome.uncertainty(at, quantity, CONFIDENCE, group) else {
                        continue;
                    };
                    rows.push(vec![
                        group.name.clone(),
                        group.draws.to_string(),
                        outcome.name.clone(),
                        spec.name.clone(),
                        quantity.name().to_owned(),
                        digits(Some(found.value)),
                        digits(found.standard_error),
                        digits(found.standard_error.map(|_| found.low)),
                        digits(found.standard_error.map(|_| found.high)),
                    ]);
                }
            }
        }
    }
    let columns = vec![
        "source",
        "n",
        "estimator",
        "uncertainty",
        "quantity",
        "value",
        "standard_error",
        "low",
        "high",
    ];
    Table {
        file: "uncertainty.csv",
        columns,
        rows,
    }
}

/// One row for each claim: what it says, whether it holds, and the numbers.
pub fn claims(experiment: &Experiment, verdicts: &[Verdict]) -> Table {
    let rows = verdicts
        .iter()
        .map(|verdict| {
            let claim = &experiment.claims[verdict.claim];
            vec![
                claim.says.clone(),
                verdict.outcome.name().to_owned(),
                verdict.detail.clone(),
            ]
        })
        .collect();
    Table {
        file: "claims.csv",
        columns: vec!["claim", "verdict", "detail"],
        rows,
    }
}

#[cfg(test)]
mod tests {
    use super::field;

    #[test]
    fn names_come_back_from_their_quotes() {
        for name in ["plain", "a, b", "say \"h\"", "two\nlines", "", "ü"] {
            let text = format!("{},1\n", field(name));
            let mut reader = csv::ReaderBuilder::new()
                .has_headers(false)
                .from_reader(text.as_bytes());
            let record = reader.records().next().expect("one").expect("legal");
            assert_eq!(&record[0], name);
        }
    }
}
