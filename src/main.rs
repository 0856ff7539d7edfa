//! `lab`, the command line of the laboratory.

use std::process::ExitCode;

fn main() -> ExitCode {
    density_lab::cli::main()
}
