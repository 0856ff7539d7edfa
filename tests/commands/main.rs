//! Each command does what its help says, and behaves among pipes, files and full disks as a program should.
#![allow(clippy::unwrap_used)]

mod bad_experiments;
mod bad_inputs;
mod estimate;
mod figures;
mod ladder;
mod light;
mod list;
mod oracle;
mod output;
#[cfg(unix)]
mod programs;
mod sample;
mod select;
mod selection;
#[path = "../support/mod.rs"]
mod support;
mod trace;

const KERNEL: &str = "kernel = { bandwidth = 0.3 }";

fn old_faithful() -> String {
    let root = env!("CARGO_MANIFEST_DIR");
    format!("{root}/data/old_faithful_107/old_faithful_107.csv")
}
