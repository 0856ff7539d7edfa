//! `lab sample`

use super::argument;
use super::output::Output;
use super::stop::Stop;
use crate::density::{self, Univariate};
use crate::parameter::nearest;
use crate::random::stream;
use clap::Args;
use npyz::WriterBuilder;
use std::path::PathBuf;
use std::sync::Arc;

/// The most points of one file; more are written by nobody on purpose.
const MOST: u64 = 1_000_000_000;

/// Bytes of a number in a CSV file, roughly.
const DIGITS: u64 = 20;

/// Draw points from a known density
///
/// The points are those that an experiment with the same seed draws as its first replicate. They are written as they are drawn, so that memory
/// does not limit their number.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab sample --density bimodal --n 200
  lab sample --density claw --n 1e7 --seed 7 -o claw.npy
  lab list densities                              the names")]
pub struct Sample {
    /// A density by name
    #[arg(long, value_name = "NAME")]
    density: String,

    /// How many points
    #[arg(long, value_name = "N", value_parser = argument::count)]
    n: u64,

    /// The seed of the random stream
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,

    /// Where to: a .csv file with the column x, or an .npy array [default: CSV on stdout]
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
}

impl Sample {
    pub fn run(&self) -> Result<(), Stop> {
        let density = known(&self.density)?;
        if self.n > MOST {
            return Err(Stop::Input(format!(
                "--n {}: at most {MOST} points are written at once; so many would be a file of {}",
                self.n,
                crate::memory::Bytes(self.n.saturating_mul(DIGITS)),
            )));
        }
        let array = self
            .output
            .as_ref()
            .is_some_and(|path| path.extension().is_some_and(|ending| ending == "npy"));
        let mut output = Output::open(self.output.as_deref())?;
        let mut random = stream(self.seed, "sample", 0);
        let mut draw = || density.draw(&mut random)[0];
        if array {
            let mut head = Vec::new();
            npyz::WriteOptions::<f64>::new()
                .default_dtype()
                .shape(&[self.n])
                .writer(&mut head)
                .write_header_only()
                .expect("a vector takes every byte");
            output.write_all(&head)?;
            for _ in 0..self.n {
                output.write_all(&draw().to_le_bytes())?;
            }
        } else {
            output.write_all(b"x\n")?;
            for _ in 0..self.n {
                output.number(draw())?;
                output.write_all(b"\n")?;
            }
        }
        output.finish()
    }
}

/// The density of that name, or what could have been meant.
pub fn known(name: &str) -> Result<Arc<dyn Univariate>, Stop> {
    if let Some(density) = density::named(name) {
        return Ok(density);
    }
    let what = if density::entry(name).is_some() {
        format!("the density \"{name}\" needs parameters, which only an experiment file can give")
    } else {
        let guess = nearest(name, density::names())
            .map(|other| format!("; did you mean \"{other}\"?"))
            .unwrap_or_default();
        format!("no density \"{}\"{guess}", name.escape_debug())
    };
    let alone: Vec<&str> = density::entries()
        .filter(|entry| entry.stands_alone())
        .map(|entry| entry.names[0])
        .collect();
    Err(Stop::Input(format!(
        "{what}\nallowed are {}",
        alone.join(", ")
    )))
}
