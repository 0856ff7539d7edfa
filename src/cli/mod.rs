//! The command line: one file per command.
//!
//! Data go to the standard output or to `-o`, everything else to the standard error. Exit codes: 0 done, 1 a claim failed, 2 bad input,
//! 3 the system failed, 130 interrupted. A reader that goes away early is no failure.

mod argument;
mod check;
mod commands;
mod completions;
mod diff;
mod doctor;
mod estimate;
mod estimator;
mod interrupt;
mod irradiance;
mod light;
mod list;
mod notes;
mod oracle;
mod output;
mod phases;
mod render;
mod run;
mod sample;
mod schema;
mod select;
mod sketch;
mod stop;
mod summary;
mod trace;

use clap::{Parser, Subcommand};
use notes::Notes;
use std::process::ExitCode;
use stop::Stop;

/// A laboratory for density estimators: which one to trust, at what bandwidth, at what cost
#[derive(Debug, Parser)]
#[command(name = "lab", version, max_term_width = 100, subcommand_required = true, arg_required_else_help = true, after_help = EXAMPLES)]
struct Lab {
    #[command(subcommand)]
    command: Command,

    /// Threads to compute with; results do not depend on it [default: one a core]
    #[arg(long, global = true, value_name = "N", value_parser = argument::threads)]
    threads: Option<usize>,

    /// Say nothing but errors
    #[arg(long, short, global = true)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  lab list                                        what there is
  lab check experiments/bimodal.toml              is it right, and what will it cost?
  lab run experiments/bimodal.toml                tables, figures, a report
  lab oracle --density bimodal --n 200            the best bandwidth, exactly
  lab select points.csv --column x                every rule for a bandwidth, side by side
  lab sample --density bimodal --n 200 | lab estimate - --estimator 'kernel = { bandwidth = 0.3 }'
  lab trace data/scenes/cornell-box-rgb.toml --photons 1e5 -o hits.csv
  lab estimate data/old_faithful_107/old_faithful_107.csv --column eruption_min \\
      --estimator 'kernel = { shape = \"epanechnikov\", bandwidth = \"silverman\" }' -o density.csv

Exit codes: 0 done, 1 a claim failed, 2 bad input, 3 the system failed, 130 interrupted.";

#[derive(Debug, Subcommand)]
enum Command {
    Run(run::Run),
    Check(check::Check),
    List(list::List),
    Estimate(estimate::Estimate),
    Select(select::Select),
    Oracle(oracle::Oracle),
    Sample(sample::Sample),
    Diff(diff::Diff),
    Doctor(doctor::Doctor),
    Trace(trace::Trace),
    Irradiance(irradiance::Irradiance),
    Render(render::Render),
    Schema(schema::Schema),
    Completions(completions::Completions),
}

impl Command {
    fn run(self, notes: Notes) -> Result<(), Stop> {
        match self {
            Self::Run(run) => run.run(notes),
            Self::Check(check) => check.run(),
            Self::List(list) => list.run(notes),
            Self::Estimate(estimate) => estimate.run(notes),
            Self::Select(select) => select.run(notes),
            Self::Oracle(oracle) => oracle.run(notes),
            Self::Sample(sample) => sample.run(),
            Self::Diff(diff) => diff.run(notes),
            Self::Doctor(doctor) => doctor.run(notes),
            Self::Trace(trace) => trace.run(notes),
            Self::Irradiance(irradiance) => irradiance.run(notes),
            Self::Render(render) => render.run(notes),
            Self::Schema(_) => schema::Schema::run(),
            Self::Completions(completions) => completions.run(),
        }
    }
}

/// Runs the command that the arguments of the process ask for.
pub fn main() -> ExitCode {
    interrupt::listen();
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(stop) => {
            if let Some(message) = stop.message() {
                notes::error(message);
            }
            ExitCode::from(stop.code())
        }
    }
}

fn run() -> Result<(), Stop> {
    let lab = match Lab::try_parse() {
        Ok(lab) => lab,
        // help and version are data; a wrong usage says so itself
        Err(usage) => {
            let shown = usage.print();
            return if usage.use_stderr() {
                Err(Stop::Usage)
            } else {
                shown.map_err(|error| Stop::writing(&"stdout", &error))
            };
        }
    };
    if let Some(threads) = lab.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()
            .map_err(|error| {
                Stop::System(format!("{threads} threads cannot be started: {error}"))
            })?;
    }
    lab.command.run(Notes { quiet: lab.quiet })
}
