//! `lab diff`

use super::notes::Notes;
use super::output::Output;
use super::stop::Stop;
use crate::experiment::difference::{
    self, Difference, DifferenceError, Differences, Key, Verdict, differences,
};
use crate::experiment::significant;
use clap::Args;
use comfy_table::{Cell, CellAlignment, Table, presets};
use std::path::PathBuf;

/// How much two runs differ, with confidence intervals
///
/// Compares what the folders of two finished runs have in common: the same source, sample size and name of an estimator. Where both runs drew the same samples (the same source and seed)
/// the replicates are compared one by one, so that what samples have in common cancels; else as independent samples. Intervals hold for all differences at once.
///
/// Exit code 1 if any difference is significant: the runs do not agree. Differences that the numbers leave open are none. What is in one run only is told, and is no failure.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab diff runs/bimodal-1a2b3c4d runs/bimodal-5e6f7a8b
  lab diff before after --measure mise            has a change moved the error?
  lab diff before after --json")]
pub struct Diff {
    /// The folder of a finished run
    #[arg(value_name = "RUN_A")]
    a: PathBuf,

    /// The folder of another
    #[arg(value_name = "RUN_B")]
    b: PathBuf,

    /// Only this measure; may be repeated [default: all]
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(difference::NAMES))]
    measure: Vec<String>,

    /// The probability that all intervals hold
    #[arg(long, value_name = "P", default_value_t = 0.99, value_parser = share)]
    confidence: f64,

    /// Numbers that agree to within this, relative, are the same
    #[arg(long, value_name = "REL", default_value_t = 1e-9, value_parser = share)]
    tolerance: f64,

    /// As JSON
    #[arg(long)]
    json: bool,
}

/// A number strictly between 0 and 1.
fn share(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if number > 0.0 && number < 1.0 {
        Ok(number)
    } else {
        Err("allowed are numbers between 0 and 1".to_owned())
    }
}

impl Diff {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let found = differences(
            [&self.a, &self.b],
            &self.measure,
            self.confidence,
            self.tolerance,
        );
        let found = found.map_err(|error| match error {
            DifferenceError::Storage(error) => Stop::System(error.to_string()),
            other => Stop::Input(other.to_string()),
        })?;
        let mut output = Output::open(None)?;
        if self.json {
            output.json(&found)?;
        } else {
            writeln!(output, "{}", table(&found))?;
        }
        output.finish()?;
        for remark in &found.remarks {
            notes.say(remark);
        }
        for (which, only) in [("A", &found.only_a), ("B", &found.only_b)] {
            if !only.is_empty() {
                notes.say(&format!("only in {which}: {}", listed(only)));
            }
        }
        let count = |verdict: Verdict| {
            found
                .rows
                .iter()
                .filter(|row| row.verdict == verdict)
                .count()
        };
        let differ = count(Verdict::Differs);
        notes.say(&format!(
            "{} comparisons: {} the same, {} open, {differ} differ (all intervals at once hold with confidence {})",
            found.rows.len(),
            count(Verdict::Same),
            count(Verdict::Open),
            self.confidence
        ));
        if differ > 0 {
            Err(Stop::Failed)
        } else {
            Ok(())
        }
    }
}

fn table(found: &Differences) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header([
        "source",
        "n",
        "estimator",
        "measure",
        "A",
        "B",
        "B - A",
        "low",
        "high",
        "",
        "verdict",
    ]);
    for row in &found.rows {
        let Difference { key, .. } = row;
        let number = |value: f64| right(significant(value, 4));
        let some =
            |value: Option<f64>| right(value.map_or_else(String::new, |v| significant(v, 3)));
        table.add_row([
            Cell::new(&key.source),
            right(key.n.to_string()),
            Cell::new(&key.estimator),
            Cell::new(row.measure),
            number(row.a),
            number(row.b),
            some(Some(row.difference)),
            some(row.low),
            some(row.high),
            Cell::new(if row.paired { "paired" } else { "" }),
            Cell::new(match row.verdict {
                Verdict::Same => "same",
                Verdict::Open => "open",
                Verdict::Differs => "differs",
            }),
        ]);
    }
    table
}

fn right(text: String) -> Cell {
    Cell::new(text).set_alignment(CellAlignment::Right)
}

fn listed(keys: &[Key]) -> String {
    const SHOWN: usize = 6;
    let mut names: Vec<String> = keys
        .iter()
        .take(SHOWN)
        .map(|key| format!("\"{}\" on {} at n = {}", key.estimator, key.source, key.n))
        .collect();
    if keys.len() > SHOWN {
        names.push(format!("and {} more", keys.len() - SHOWN));
    }
    names.join(", ")
}
