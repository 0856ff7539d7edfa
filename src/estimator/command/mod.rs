//! Any program as an estimator: R, Python or anything else enters the same tables.
//!
//! # What the program is told and must answer
//! It is started once for each set of targets, which in an experiment is once for each sample, in the folder in which the laboratory was started. It reads its
//! standard input to the end and writes one density for each target, in their order, to its standard output.
//!
//! The first line of the input is `n m D` as text: n points with weights, m targets, D dimensions. Then
//! - with `format = "csv"`: n lines `x,w` (in the plane `x,y,w`), then m lines `x` (`x,y`), in full precision; the answer is m lines with a number each;
//! - with `format = "binary"`: n·(D + 1) and then m·D numbers of 8 bytes, little end first, in the same order, right after the line end; the answer is m such numbers.
//!
//! Weights sum to the mass of the sample, 1 in statistics, and the answer integrates to it if it keeps mass. What it writes to its standard error is shown if it fails.
//!
//! # When it fails
//! It cannot be started, exits with a code other than 0, takes longer than `timeout` seconds (it and what it started is then killed), answers more or fewer than
//! m numbers or something that is no finite number: the values are not numbers, and [`Evaluation::failure`](crate::space::Evaluation::failure) says
//! why. An experiment reports that and goes on with its other estimators.
//!
//! # Safety
//! A file that names a program can do whatever the program can: run only files that you trust. Nothing is started when a file is read or checked, and
//! runs ask for leave (`--allow-commands`).

mod exchange;

use super::{Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws};
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Evaluation, Field, Point, Targets};
use exchange::Call;
use std::sync::Arc;
use std::time::Duration;

/// A program that estimates; the module says how it is spoken to.
#[derive(Clone, Debug)]
pub struct Command {
    program: String,
    arguments: Vec<String>,
    timeout: Duration,
    format: Format,
}

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// As text, separated by commas.
    Csv,
    /// As eight bytes each, little end first.
    Binary,
}

struct Fitted<const D: usize> {
    command: Command,
    sample: Sample<D>,
}

impl<const D: usize> Fitted<D> {
    fn ask(&self, places: &[Point<D>]) -> Result<Vec<f64>, String> {
        if self.sample.mass() == 0.0 || places.is_empty() {
            // a channel without mass is dark, and no program need say so
            return Ok(vec![0.0; places.len()]);
        }
        let Command {
            program,
            arguments,
            timeout,
            format,
        } = &self.command;
        let call = Call {
            program,
            arguments,
            timeout: *timeout,
            input: self.input(places),
            most: match format {
                // no number needs as many characters, ends of lines included
                Format::Csv => 64 * places.len() + (1 << 16),
                Format::Binary => 8 * places.len(),
            },
        };
        let answer = call.make()?;
        let values = match format {
            Format::Csv => text(&answer)?,
            Format::Binary => numbers(&answer)?,
        };
        if values.len() != places.len() {
            return Err(format!(
                "it answered {} numbers for {} targets",
                values.len(),
                places.len()
            ));
        }
        match values.iter().position(|value| !value.is_finite()) {
            Some(i) => Err(format!(
                "it answered {} for target {} at {:?}",
                values[i],
                i + 1,
                places[i]
            )),
            None => Ok(values),
        }
    }

    fn input(&self, places: &[Point<D>]) -> Vec<u8> {
        let points = self.sample.points();
        let mut input = format!("{} {} {D}\n", points.len(), places.len()).into_bytes();
        let mut line = |numbers: &mut dyn Iterator<Item = f64>| match self.command.format {
            Format::Binary => numbers.for_each(|x| input.extend(x.to_le_bytes())),
            Format::Csv => {
                for (i, x) in numbers.enumerate() {
                    if i > 0 {
                        input.push(b',');
                    }
                    // the fewest digits that lead back to the same number
                    input.extend(format!("{x:?}").into_bytes());
                }
                input.push(b'\n');
            }
        };
        for (i, point) in points.iter().enumerate() {
            line(&mut point.iter().copied().chain([self.sample.weight(i)]));
        }
        for place in places {
            line(&mut place.iter().copied());
        }
        input
    }
}

fn text(answer: &[u8]) -> Result<Vec<f64>, String> {
    let answer =
        std::str::from_utf8(answer).map_err(|_| "it answered what is no text".to_owned())?;
    answer
        .lines()
        .map(str::trim)
        .enumerate()
        .filter(|(_, line)| !line.is_empty())
        .map(|(i, line)| {
            line.parse().map_err(|_| {
                let shown: String = line.chars().take(40).collect();
                format!("line {} of its answer is no number: {shown:?}", i + 1)
            })
        })
        .collect()
}

fn numbers(answer: &[u8]) -> Result<Vec<f64>, String> {
    let (whole, rest) = answer.as_chunks::<8>();
    if !rest.is_empty() {
        return Err(format!(
            "it answered {} bytes, which are no whole numbers of 8 bytes",
            answer.len()
        ));
    }
    Ok(whole
        .iter()
        .map(|bytes| f64::from_le_bytes(*bytes))
        .collect())
}

impl<const D: usize> Field<D> for Fitted<D> {
    fn domain(&self) -> &Domain<D> {
        self.sample.domain()
    }

    /// Starts the program for one place: not a number if it fails. Ask for many places at once instead.
    fn at(&self, x: Point<D>) -> f64 {
        self.ask(&[x]).map_or(f64::NAN, |values| values[0])
    }

    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        let places: Vec<Point<D>> = targets.places().collect();
        match self.ask(&places) {
            Ok(values) => Evaluation {
                values,
                ..Evaluation::default()
            },
            Err(why) => Evaluation {
                values: vec![f64::NAN; places.len()],
                failure: Some(format!("the program `{}`: {why}", self.command.program)),
                ..Evaluation::default()
            },
        }
    }
}

impl<const D: usize> Estimator<D> for Command {
    /// Nothing is known of a program.
    fn laws(&self) -> Laws {
        Laws {
            mass_conserving: false,
            non_negative: false,
            linear: false,
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: false,
            deterministic: false,
            scale_equivariant: false,
            translation_equivariant: false,
            repeatable: false,
        }
    }

    fn fit(&self, sample: &Sample<D>) -> Result<Estimate<D>, FitError> {
        let field = |sample| -> Arc<dyn Field<D>> {
            Arc::new(Fitted {
                command: self.clone(),
                sample,
            })
        };
        Ok(Estimate::new(field(sample.clone())).with_channels(
            (0..sample.channels())
                .map(|c| field(sample.channel(c)))
                .collect(),
        ))
    }
}

impl Described for Command {
    const NAME: &'static str = "command";
    const SUMMARY: &'static str = "a program of yours: points in, densities out";
    const COST: &'static str = "what the program costs, once for each sample";
    const REFERENCE: &'static str = "the program's own";
    const SMOOTHING: Option<&'static str> = None;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::required(
            "program",
            Kind::Text,
            "the program to start: a name to be found as a shell finds it, or a path",
        ),
        Parameter::optional(
            "arguments",
            Kind::Texts,
            Absent::Unset,
            "what it is given on its command line; paths are relative to where `lab` is started",
        ),
        Parameter::optional(
            "timeout",
            Kind::Positive,
            Absent::Number(60.0),
            "seconds after which it is killed",
        ),
        Parameter::optional(
            "format",
            Kind::Choice(&["csv", "binary"]),
            Absent::Word("csv"),
            "how numbers are written: text, or 8 bytes each, little end first",
        ),
    ];
}

impl<const D: usize> Build<D> for Command {
    fn build(values: &Values, _context: &Context<D>) -> Result<Self, BuildError> {
        let program = values.word("program").unwrap_or_default();
        if program.trim().is_empty() {
            return Err(BuildError {
                parameter: "program",
                what: "`program` is empty; name a program".to_owned(),
            });
        }
        // a day is longer than anyone waits
        let seconds = values.number("timeout").unwrap_or(60.0).min(86_400.0);
        Ok(Self {
            program: program.to_owned(),
            arguments: values.words("arguments").to_vec(),
            timeout: Duration::from_secs_f64(seconds),
            format: if values.word("format") == Some("binary") {
                Format::Binary
            } else {
                Format::Csv
            },
        })
    }
}

#[cfg(all(test, unix))]
mod tests;
