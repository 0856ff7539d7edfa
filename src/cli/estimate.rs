//! `lab estimate`

use super::argument;
use super::estimator::Settings;
use super::notes::Notes;
use super::output::{Output, Shortest};
use super::phases::Phases;
use super::stop::Stop;
use crate::estimator::Context;
use crate::report::figure::{Axis, Curves, Role, Series};
use crate::sample::Sample;
use crate::sample::file::{Column, Request, read, read_points};
use crate::space::{Domain, Evaluation, Field, Grid, Point, Targets};
use clap::Args;
use std::path::{Path, PathBuf};

/// Cells of the grid where none is asked for.
const CELLS: usize = 512;

/// Estimate a density from the points of a file
///
/// Reads one column of a CSV file or of a NumPy array, fits an estimator and writes the columns x, density. Without --grid or --at the estimate is
/// given at the centres of 512 equal cells over the range of the data and three bandwidths more on each side (a quarter of the range where
/// the estimator has no bandwidth), cut at the walls of --domain.
#[derive(Debug, Args)]
#[command(after_help = "\
Columns are named by the header, or by number from 1. Estimators are written as in an experiment file:
  'kernel = { bandwidth = 0.3 }'
  'kernel = { shape = \"epanechnikov\", bandwidth = \"silverman\" }'
  'histogram = { width = 0.5, origin = 0 }'

Examples:
  lab estimate data/old_faithful_107/old_faithful_107.csv --column eruption_min \\
      --estimator 'kernel = { bandwidth = 0.25 }' --grid 0:6:600 -o density.svg
  lab estimate points.npy --estimator 'kernel = { bandwidth = \"scott\" }' --explain
  cut -d, -f3 table.csv | lab estimate - --estimator 'histogram = { width = 1 }' --at places.csv

lab list estimators shows all with their parameters.")]
pub struct Estimate {
    /// The data: a CSV file with a header (or of numbers only) or an .npy array; - is stdin
    points: PathBuf,

    /// The column of the data: a name from the header, or a number from 1; not needed if there is only one
    #[arg(long, short, value_name = "NAME")]
    column: Option<String>,

    /// A column of weights; they are scaled to sum to 1
    #[arg(long, short, value_name = "NAME")]
    weight: Option<String>,

    /// The estimator, as in an experiment file
    #[arg(long, short, value_name = "TOML")]
    estimator: String,

    /// Where the data may lie, with walls at finite ends: 0:1, 0: or :1
    #[arg(long, value_name = "LO:HI", value_parser = argument::domain, allow_hyphen_values = true)]
    domain: Option<Domain<1>>,

    /// Estimate at the centres of N equal cells
    #[arg(long, value_name = "LO:HI:N", value_parser = argument::grid, allow_hyphen_values = true)]
    grid: Option<Grid<1>>,

    /// Estimate at the places in this file: its column of the same name, or x, or the only one
    #[arg(long, value_name = "TARGETS", conflicts_with = "grid")]
    at: Option<PathBuf>,

    /// How to compute a kernel sum; by default the cheapest way within the tolerance
    #[arg(long, value_name = "NAME")]
    engine: Option<String>,

    /// Say on stderr how it was computed, and the time of each phase
    #[arg(long)]
    explain: bool,

    /// Where to: a .csv file, or an .svg picture [default: CSV on stdout]
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
}

/// Where the estimate is wanted.
enum Places {
    Grid(Grid<1>),
    Points(Vec<Point<1>>),
}

impl Places {
    fn targets(&self) -> Targets<'_, 1> {
        match self {
            Self::Grid(grid) => Targets::Grid(grid),
            Self::Points(points) => Targets::Points(points),
        }
    }
}

impl Estimate {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let settings = Settings::read(&self.estimator, self.engine.as_deref())?;
        let ending = self.output.as_deref().and_then(Path::extension);
        let drawn = ending.is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
        let mut output = Output::open(self.output.as_deref())?;
        let mut phases = Phases::default();

        let (sample, given) = phases.time("read", || self.read())?;
        // what an estimator puts off until it is asked is done under `evaluate`
        let (estimate, continuous) = phases.time("fit", || -> Result<_, Stop> {
            let context = Context {
                truth: None,
                draws: sample.len(),
            };
            let estimator = settings.build(&context)?;
            let estimate = estimator
                .fit(&sample)
                .map_err(|error| Stop::Input(format!("--estimator: {error}")))?;
            Ok((estimate, estimator.laws().continuous))
        })?;
        let (places, evaluation) = phases.time("evaluate", || -> Result<_, Stop> {
            let places = match given {
                Some(places) => places,
                None => Places::Grid(around(&sample, estimate.smoothing)?),
            };
            let evaluation = estimate.evaluate(places.targets());
            if let Some(bad) = evaluation.values.iter().find(|value| !value.is_finite()) {
                return Err(Stop::Input(format!(
                    "--estimator: the estimate is {bad} somewhere: its scale is beyond what numbers can hold"
                )));
            }
            Ok((places, evaluation))
        })?;
        phases.time("write", || {
            if drawn {
                let picture = picture(
                    &settings,
                    self.column.as_deref(),
                    &sample,
                    &places,
                    &evaluation,
                    continuous,
                );
                output.write_all(picture.as_bytes())?;
            } else {
                table(&mut output, &places, &evaluation)?;
            }
            output.finish()
        })?;

        for warning in &evaluation.warnings {
            notes.warn(warning);
        }
        if self.explain {
            explain(notes, &sample, estimate.smoothing, &places, &evaluation);
            phases.lines().for_each(|line| notes.say(&line));
        }
        Ok(())
    }

    fn read(&self) -> Result<(Sample<1>, Option<Places>), Stop> {
        let column = self.column.as_deref();
        let request = Request {
            columns: [column.map_or(Column::Preferred(&[]), Column::Named)],
            weight: self.weight.as_deref(),
            domain: self.domain.clone().unwrap_or_else(Domain::whole),
        };
        if self.points == Path::new("-") && self.at.as_deref() == Some(Path::new("-")) {
            return Err(Stop::Input(
                "points and targets cannot both come from stdin".to_owned(),
            ));
        }
        let sample = read(&self.points, &request)?;
        let places = match (&self.grid, &self.at) {
            (Some(grid), _) => Some(Places::Grid(*grid)),
            (None, Some(path)) => {
                let names = [column.unwrap_or("x"), "x"];
                Some(Places::Points(read_points(
                    path,
                    [Column::Preferred(&names)],
                )?))
            }
            (None, None) => None,
        };
        Ok((sample, places))
    }
}

/// The range of the data and something more on each side, within the domain.
fn around(sample: &Sample<1>, smoothing: Option<f64>) -> Result<Grid<1>, Stop> {
    let (least, most) = sample
        .coordinates()
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| {
            (low.min(x), high.max(x))
        });
    let margin = smoothing.map_or(0.25 * (most - least), |h| 3.0 * h);
    let domain = sample.domain();
    let low = (least - margin).max(domain.low()[0]);
    let high = (most + margin).min(domain.high()[0]);
    Grid::new([low], [high], [CELLS]).map_err(|error| {
        Stop::Input(format!(
            "no grid fits round the data, {least} to {most}: {error}; give one with --grid LO:HI:N"
        ))
    })
}

fn table(output: &mut Output, places: &Places, evaluation: &Evaluation) -> Result<(), Stop> {
    output.write_all(b"x,density\n")?;
    for ([x], &density) in places.targets().places().zip(&evaluation.values) {
        writeln!(output, "{},{}", Shortest(x), Shortest(density))?;
    }
    Ok(())
}

/// The estimate over its data.
fn picture(
    settings: &Settings,
    column: Option<&str>,
    sample: &Sample<1>,
    places: &Places,
    evaluation: &Evaluation,
    continuous: bool,
) -> String {
    // more ticks than this are a grey bar at any size
    const TICKS: usize = 100_000;
    let mut curve: Vec<(f64, f64)> = places
        .targets()
        .places()
        .map(|[x]| x)
        .zip(evaluation.values.iter().copied())
        .collect();
    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut x, y): (Vec<f64>, Vec<f64>) = curve.into_iter().unzip();
    let role = match places {
        Places::Grid(grid) if !continuous => {
            x = (0..=grid.len())
                .map(|i| (i as f64).mul_add(grid.width(0), grid.low()[0]))
                .collect();
            Role::Steps(0)
        }
        _ => Role::Estimate(0),
    };
    Curves {
        title: settings.name().to_owned(),
        description: format!("The estimated density of {} points.", sample.len()),
        x: Axis::new(column.unwrap_or("x"), ""),
        y: Axis::new("density", ""),
        series: vec![Series {
            name: "estimate".to_owned(),
            x,
            y,
            role,
        }],
        rug: sample
            .coordinates()
            .iter()
            .step_by(sample.len().div_ceil(TICKS))
            .copied()
            .collect(),
        ..Curves::default()
    }
    .draw()
    .to_string()
}

fn explain(
    notes: Notes,
    sample: &Sample<1>,
    smoothing: Option<f64>,
    places: &Places,
    evaluation: &Evaluation,
) {
    notes.say(&format!("points {}", sample.len()));
    notes.say(&format!("targets {}", places.targets().len()));
    if let Some(smoothing) = smoothing {
        notes.say(&format!("smoothing {}", Shortest(smoothing)));
    }
    if let Some(engine) = evaluation.engine {
        notes.say(&format!("engine {engine}"));
    }
    for line in &evaluation.explanation {
        notes.say(&format!("  {line}"));
    }
    notes.say(&format!(
        "error at most {:.1e} of the largest possible value",
        evaluation.error
    ));
}
