//! `lab check`

use super::output::Output;
use super::stop::Stop;
use crate::experiment::{read, summary};
use clap::Args;
use std::path::PathBuf;

/// Check an experiment file: every error at once; nothing is computed
///
/// Says what the file resolves to, with everything that it leaves out, and what a run would cost in time and memory.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab check experiments/bimodal.toml
  lab check experiments/bimodal.toml --json | jq .estimators
  lab check - < draft.toml")]
pub struct Check {
    /// The experiment, a TOML file; - is stdin
    experiment: PathBuf,

    /// The resolved experiment as JSON
    #[arg(long)]
    json: bool,
}

impl Check {
    pub fn run(&self) -> Result<(), Stop> {
        let experiment =
            read::experiment(&self.experiment).map_err(|problems| Stop::problems(&problems))?;
        let mut output = Output::open(None)?;
        if self.json {
            output.json(&experiment)?;
        } else {
            output.write_all(summary(&experiment).as_bytes())?;
        }
        output.finish()
    }
}
