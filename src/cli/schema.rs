//! `lab schema`

use super::output::Output;
use super::stop::Stop;
use crate::experiment::schema::json_schema;
use clap::Args;

/// Print the JSON Schema of experiment files, for editors
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab schema > experiment.schema.json
  and as the first line of an experiment, for editors with taplo:  #:schema ../experiment.schema.json")]
pub struct Schema {}

impl Schema {
    pub fn run() -> Result<(), Stop> {
        let mut output = Output::open(None)?;
        output.json(&json_schema())?;
        output.finish()
    }
}
