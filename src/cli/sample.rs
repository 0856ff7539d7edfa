//! `lab sample`

use super::argument;
use super::output::Output;
use super::stop::Stop;
use crate::density::{self, Truth};
use crate::experiment::read;
use crate::parameter::{Absent, nearest};
use crate::random::stream;
use clap::Args;
use npyz::WriterBuilder;
use std::path::PathBuf;

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
  lab sample --density 'beta = { a = 2, b = 3 }' --n 200
  lab list densities                              the names")]
pub struct Sample {
    /// A density by name, or with its parameters as in an experiment file
    #[arg(long, value_name = "DENSITY")]
    density: String,

    /// How many points
    #[arg(long, value_name = "N", value_parser = argument::count)]
    n: u64,

    /// The seed of the random stream
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,

    /// Where to: a .csv file with the column x (x and y in the plane), or an .npy array [default: CSV on stdout]
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
        let dimensions: u64 = match density {
            Truth::Line(_) => 1,
            Truth::Plane(_) => 2,
        };
        let mut draw = |numbers: &mut Vec<f64>| {
            numbers.clear();
            match &density {
                Truth::Line(density) => numbers.extend(density.draw(&mut random)),
                Truth::Plane(density) => numbers.extend(density.draw(&mut random)),
            }
        };
        let mut point = Vec::new();
        if array {
            let mut head = Vec::new();
            // numbers on a line are an array of one axis
            let both = [self.n, dimensions];
            let shape = &both[..if dimensions == 1 { 1 } else { 2 }];
            npyz::WriteOptions::<f64>::new()
                .default_dtype()
                .shape(shape)
                .writer(&mut head)
                .write_header_only()
                .expect("a vector takes every byte");
            output.write_all(&head)?;
            for _ in 0..self.n {
                draw(&mut point);
                for number in &point {
                    output.write_all(&number.to_le_bytes())?;
                }
            }
        } else {
            output.write_all(if dimensions == 1 {
                &b"x\n"[..]
            } else {
                b"x,y\n"
            })?;
            for _ in 0..self.n {
                draw(&mut point);
                for (axis, &number) in point.iter().enumerate() {
                    if axis > 0 {
                        output.write_all(b",")?;
                    }
                    output.number(number)?;
                }
                output.write_all(b"\n")?;
            }
        }
        output.finish()
    }
}

/// The density of that name, or written as `KIND = { parameters }` with or without braces around it; or what could have been meant.
pub fn known(text: &str) -> Result<Truth, Stop> {
    if text.contains(['=', '{']) {
        return read::density(text, "--density").map_err(|problems| Stop::problems(&problems));
    }
    let name = text;
    if let Some(density) = density::truth(name) {
        return Ok(density);
    }
    let what = if let Some(entry) = density::entry(name) {
        let needed: Vec<String> = entry
            .parameters
            .iter()
            .filter(|parameter| parameter.absent == Absent::Required)
            .map(|parameter| format!("{} = ..", parameter.name))
            .collect();
        format!(
            "the density \"{name}\" needs parameters: --density '{name} = {{ {} }}'",
            needed.join(", ")
        )
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
