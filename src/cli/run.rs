//! `lab run`

use super::commands;
use super::interrupt;
use super::notes::Notes;
use super::output::Output;
use super::stop::Stop;
use super::summary;
use crate::experiment::catalogue::{Builds, Entry};
use crate::experiment::judge::{Ruling, judge};
use crate::experiment::manifest::{self, Circumstances, Line, SummaryRow};
use crate::experiment::results::Results;
use crate::experiment::run::{
    self, Bench, Existing, Identity, Opening, Progress, RunError, RunFolder,
};
use crate::experiment::{Experiment, SourceSpec, budget, read};
use crate::memory;
use crate::report::paper::{self, Draws, Material, Paper};
use clap::Args;
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use std::fmt::{self, Write as _};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Run an experiment: tables, figures and a report
///
/// Finished work is kept: the same command after an interruption goes on where it stopped, and after the end shows what was found. Results do
/// not depend on interruptions or on the number of threads.
#[derive(Debug, Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "independent flags of a command line"
)]
#[command(after_help = "\
Examples:
  lab run experiments/bimodal.toml
  lab run experiments/bimodal.toml --quick        a tenth of the replicates, for a first look
  lab run experiments/bimodal.toml --seed 7 --out runs/another-seed

Exit code 1 if a claim of the experiment is not shown.")]
pub struct Run {
    /// The experiment, a TOML file
    experiment: PathBuf,

    /// The folder for the results [default: runs/NAME-HASH]
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Another seed than the file's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Another number of replicates than the file's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    replicates: Option<u64>,

    /// A tenth of the replicates (at least 20): quick to look at, too few for some claims
    #[arg(long, conflicts_with = "replicates")]
    quick: bool,

    /// Go on with an interrupted run; this is what happens without it, too, but then a run that another build of lab began is begun anew
    #[arg(long, conflicts_with = "force")]
    resume: bool,

    /// Compute everything anew and replace the run that is in the folder
    #[arg(long)]
    force: bool,

    /// Start the programs that the experiment names (`command = { .. }`): they can do whatever you can
    #[arg(long)]
    allow_commands: bool,

    /// The summary as JSON
    #[arg(long)]
    json: bool,
}

impl Run {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let experiment = self.resolve()?;
        let identity = Identity::of(&experiment, self.quick);
        let place = self
            .out
            .clone()
            .unwrap_or_else(|| RunFolder::default_place(&experiment.name, &identity));
        let existing = match (self.force, self.resume) {
            (true, _) => Existing::Replace,
            (false, true) => Existing::Resume,
            (false, false) => Existing::Continue,
        };
        let lines = match RunFolder::open(&place, &identity, existing).map_err(stop)? {
            Opening::Finished(path) => {
                notes.say(&format!(
                    "{} was finished before; --force computes it anew",
                    path.display()
                ));
                let past =
                    manifest::read(&path).map_err(|error| Stop::System(error.to_string()))?;
                self.print(&experiment, &past.verdicts, &past.summary, &path)?;
                past.verdicts
            }
            // the only place where the number of dimensions decides
            Opening::Open(folder) => match experiment.dimensions() {
                1 => self.compute::<1>(experiment, folder, notes)?,
                _ => self.compute::<2>(experiment, folder, notes)?,
            },
        };
        // a quick run has too few replicates to condemn what is simulated
        let stands = |line: &Line| line.holds || (self.quick && !line.theory);
        if lines.iter().all(stands) {
            Ok(())
        } else {
            Err(Stop::Failed)
        }
    }

    fn resolve(&self) -> Result<Experiment, Stop> {
        let mut experiment =
            read::experiment(&self.experiment).map_err(|problems| Stop::problems(&problems))?;
        if !self.allow_commands {
            commands::refuse(&experiment.estimators)?;
        }
        if let Some(seed) = self.seed {
            experiment.seed = seed;
        }
        if let Some(replicates) = self.replicates {
            experiment.replicates = replicates as usize;
        }
        let overridden = self.replicates.is_some() || self.quick;
        let data = experiment
            .sources
            .iter()
            .any(|source| matches!(source, SourceSpec::File { .. }));
        if self.replicates.is_some() && data {
            return Err(Stop::Input(
                "--replicates is for densities: a data file is one sample".to_owned(),
            ));
        }
        if self.quick {
            experiment.replicates = (experiment.replicates / 10)
                .max(20)
                .min(experiment.replicates);
        }
        if overridden {
            let budget = budget::budget(&experiment);
            budget
                .check(memory::available())
                .map_err(|refusal| Stop::Input(refusal.to_string()))?;
        }
        Ok(experiment)
    }

    fn compute<const D: usize>(
        &self,
        experiment: Experiment,
        folder: RunFolder,
        notes: Notes,
    ) -> Result<Vec<Line>, Stop>
    where
        Entry: Builds<D>,
        Paper: Draws<D>,
    {
        if let Some(remark) = folder.remark() {
            notes.say(remark);
        }
        let start = Instant::now();
        let bench = Bench::<D>::new(experiment).map_err(stop)?;
        let bar = Bar::new(notes);
        let finished = run::run(&bench, &folder, interrupt::graceful(), &bar);
        bar.clear();
        let (bench, finished) = finished.map_err(stop)?.on_what_is_left(bench);
        // all samples are saved; what follows is theory and paper, which may take long, too
        interrupt::at_once();
        let results = Results::gather(&bench, finished);
        let verdicts = judge(&bench, &results);
        let circumstances = Circumstances {
            command: self.command(bench.experiment()),
            threads: rayon::current_num_threads(),
            seconds: start.elapsed().as_secs_f64(),
            quick: self.quick,
        };
        let material = Material {
            bench: &bench,
            results: &results,
            verdicts: &verdicts,
            circumstances: &circumstances,
        };
        paper::write(&material, &folder).map_err(stop)?;
        for (warning, count) in &results.warnings {
            notes.warn(warning);
            notes.say(&format!("  (on {count} samples)"));
        }
        let place = folder.finish().map_err(stop)?;
        let lines = Line::all(bench.experiment(), &results, &verdicts);
        debug_assert!(
            verdicts
                .iter()
                .zip(&lines)
                .all(|(v, l)| (v.outcome == Ruling::Holds) == l.holds)
        );
        self.print(
            bench.experiment(),
            &lines,
            &SummaryRow::all(&results),
            &place,
        )?;
        Ok(lines)
    }

    fn print(
        &self,
        experiment: &Experiment,
        lines: &[Line],
        rows: &[SummaryRow],
        place: &Path,
    ) -> Result<(), Stop> {
        let mut output = Output::open(None)?;
        let text = if self.json {
            summary::json(experiment, lines, rows, place)
        } else {
            summary::text(experiment, lines, rows, place)
        };
        output.write_all(text.as_bytes())?;
        output.finish()
    }

    /// The command that repeats this run, from the folder it was given in.
    fn command(&self, experiment: &Experiment) -> String {
        let mut command = format!("lab run {}", quoted(&self.experiment.display().to_string()));
        if let Some(seed) = self.seed {
            let _ = write!(command, " --seed {seed}");
        }
        if self.replicates.is_some() {
            let _ = write!(command, " --replicates {}", experiment.replicates);
        }
        if self.quick {
            command += " --quick";
        }
        if self.allow_commands {
            command += " --allow-commands";
        }
        command
    }
}

/// A word as a shell takes it.
pub(super) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:,@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

fn stop(error: RunError) -> Stop {
    match error {
        RunError::Input(what) | RunError::Folder(what) => Stop::Input(what),
        failed @ RunError::Estimator(_) => Stop::Input(failed.to_string()),
        RunError::Storage(error) => Stop::System(error.to_string()),
        interrupted @ RunError::Interrupted { .. } => Stop::Interrupted(interrupted.to_string()),
    }
}

/// The work that is left, on a terminal.
pub struct Bar(ProgressBar);

impl Bar {
    /// A bar on a terminal; otherwise none.
    pub fn new(notes: Notes) -> Self {
        if notes.quiet || !std::io::stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        // not a word about the time that is left before anything is known of it
        let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} gone{left}")
            .map(|style| {
                style.with_key("left", |state: &ProgressState, out: &mut dyn fmt::Write| {
                    if state.eta() > Duration::ZERO && state.fraction() < 1.0 {
                        let _ = write!(out, ", {:#} to go", HumanDuration(state.eta()));
                    }
                })
            });
        Self(style.map_or_else(
            |_| ProgressBar::no_length(),
            |style| ProgressBar::no_length().with_style(style),
        ))
    }
}

impl Bar {
    /// Takes it away.
    pub fn clear(&self) {
        self.0.finish_and_clear();
    }
}

impl Progress for Bar {
    fn begin(&self, total: u64, done: u64) {
        self.0.set_length(total);
        self.0.set_position(done);
        // what was found in the journal took no time and must not make the rest look quick
        self.0.reset_eta();
    }

    fn advance(&self, units: u64) {
        self.0.inc(units);
    }
}
