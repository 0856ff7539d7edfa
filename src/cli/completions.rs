//! `lab completions`

use super::Lab;
use super::output::Output;
use super::stop::Stop;
use clap::{Args, CommandFactory};
use clap_complete::{Shell, generate};

/// Print the completions of a shell
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab completions bash > ~/.local/share/bash-completion/completions/lab
  lab completions zsh > ~/.zfunc/_lab
  lab completions fish > ~/.config/fish/completions/lab.fish")]
pub struct Completions {
    /// The shell
    shell: Shell,
}

impl Completions {
    pub fn run(&self) -> Result<(), Stop> {
        // into memory first: the generator panics where a writer fails
        let mut script = Vec::new();
        generate(self.shell, &mut Lab::command(), "lab", &mut script);
        let mut output = Output::open(None)?;
        output.write_all(&script)?;
        output.finish()
    }
}
