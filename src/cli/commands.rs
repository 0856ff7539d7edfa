//! Leave to start programs.

use super::stop::Stop;
use crate::estimator::{Command, Described};
use crate::experiment::EstimatorSpec;
use crate::parameter::listed;

/// Refuses estimators that are programs, naming them.
///
/// # Errors
/// If there are any.
pub fn refuse(estimators: &[EstimatorSpec]) -> Result<(), Stop> {
    let mut programs: Vec<String> = estimators
        .iter()
        .filter(|spec| spec.kind == Command::NAME)
        .map(line)
        .collect();
    programs.dedup();
    if programs.is_empty() {
        return Ok(());
    }
    Err(Stop::Input(format!(
        "this starts programs, which can do whatever you can: {}; add --allow-commands if you trust them",
        listed(&programs)
    )))
}

/// The command line of a program, without what could disturb a terminal.
fn line(spec: &EstimatorSpec) -> String {
    let mut line = spec.values.word("program").unwrap_or_default().to_owned();
    for argument in spec.values.words("arguments") {
        line.push(' ');
        line.push_str(argument);
    }
    line.escape_debug().to_string()
}
