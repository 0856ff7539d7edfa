//! What must hold of the light, with as many photons as it takes: too dear for the tests, so run by hand.
//!
//! ```sh
//! cargo run --release --example evidence-light            # all of it: some minutes on two cores
//! cargo run --release --example evidence-light -- 0.1     # a tenth of the photons
//! ```
//!
//! Every line names what is measured, the value, what it must be, and the verdict; a line that fails makes the exit code 1. Everything is compared by
//! independent batches of paths, since hits of one path are not independent; batches have Student's distribution, and families of comparisons are judged by
//! Holm's procedure at the level 0.01, so that a right program fails one of these lines once in a hundred runs. Faults of a per cent or two are planted
//! and must be caught: with a tenth of the photons some are not.

#![allow(missing_docs)]

mod cells;
mod cornell;
mod judge;
mod known;

use density_lab::light::scene::{Scene, read};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

pub struct Report {
    failed: bool,
    scale: f64,
}

impl Report {
    pub fn say(&mut self, what: &str, value: &str, holds: bool) {
        self.failed |= !holds;
        let verdict = if holds { "ok    " } else { "FAILED" };
        println!("{verdict} {what}: {value}");
    }

    /// A planted fault must have a small p-value.
    pub fn catches(&mut self, fault: &str, p: f64) {
        self.say(
            &format!("planted: {fault}"),
            &format!("p = {p:.1e}"),
            p < judge::LEVEL,
        );
    }

    pub fn line(&self, text: &str) {
        println!("       {text}");
    }

    pub fn paths(&self, count: f64) -> u64 {
        (count * self.scale).max(4000.0) as u64
    }
}

fn place(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("data/scenes")
        .join(name)
}

/// A scene that comes with the project.
///
/// # Panics
/// If it cannot be read.
pub fn scene(name: &str) -> Arc<Scene> {
    match read::scene(&place(name)) {
        Ok(scene) => Arc::new(scene),
        Err(problems) => panic!("{problems}"),
    }
}

/// The same with something changed.
///
/// # Panics
/// If there is nothing to change, or the result is no scene.
pub fn scene_with(name: &str, from: &str, to: &str) -> Scene {
    let text = std::fs::read_to_string(place(name)).expect("readable");
    assert!(text.contains(from), "{from}");
    match read::scene_text(&text.replace(from, to), &place(name)) {
        Ok(scene) => scene,
        Err(problems) => panic!("{problems}"),
    }
}

fn main() -> ExitCode {
    let scale = std::env::args()
        .nth(1)
        .map_or(1.0, |text| text.parse().expect("a share of the photons"));
    let mut report = Report {
        failed: false,
        scale,
    };
    known::cube(&mut report);
    known::furnace(&mut report);
    known::sphere(&mut report);
    cornell::schemes(&mut report);
    cornell::blocks(&mut report);
    cornell::spectral(&mut report);
    if report.failed {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}
