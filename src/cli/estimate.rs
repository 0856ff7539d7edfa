//! `lab estimate`

use super::argument::{self, Each};
use super::estimator::Settings;
use super::notes::Notes;
use super::output::{Output, Shortest};
use super::phases::Phases;
use super::sketch::{Draws, Sketch};
use super::stop::Stop;
use crate::accuracy::reach;
use crate::estimator::Context;
use crate::experiment::GridSpec;
use crate::experiment::catalogue::{Builds, Entry};
use crate::sample::Sample;
use crate::sample::file::{Column, Request, read, read_points};
use crate::space::{Domain, Evaluation, Field, Grid, Point, Targets};
use clap::Args;
use std::num::NonZeroU16;
use std::path::{Path, PathBuf};

/// Estimate a density from the points of a file
///
/// Reads one column of a CSV file or of a NumPy array, or two for data in the plane, fits an estimator and writes the columns x, density or
/// x, y, density (and lower, upper with --interval). Without --grid or --at the estimate is
/// given at the centres of 512 equal cells (128 by 128 in the plane) over the range of the data and three bandwidths more on each side (a quarter of the range where
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
  lab estimate hits.csv --column u --column v --estimator 'histogram = { width = 0.05 }' --domain 0:1,0:1 -o map.svg
  cut -d, -f3 table.csv | lab estimate - --estimator 'histogram = { width = 1 }' --at places.csv

lab list estimators shows all with their parameters.")]
pub struct Estimate {
    /// The data: a CSV file with a header (or of numbers only) or an .npy array; - is stdin
    points: PathBuf,

    /// The column of the data: a name from the header, or a number from 1; not needed if there is only one. Twice for data in the plane
    #[arg(long, short, value_name = "NAME")]
    column: Vec<String>,

    /// A column of weights; they are scaled to sum to 1
    #[arg(long, short, value_name = "NAME")]
    weight: Option<String>,

    /// The estimator, as in an experiment file
    #[arg(long, short, value_name = "TOML")]
    estimator: String,

    /// Where the data may lie, with walls at finite ends: 0:1, 0: or :1; in the plane 0:1,0:1
    #[arg(long, value_name = "LO:HI[,LO:HI]", value_parser = argument::domains, allow_hyphen_values = true)]
    domain: Option<Each<Domain<1>>>,

    /// Estimate at the centres of N equal cells; in the plane of N by M
    #[arg(long, value_name = "LO:HI:N[,LO:HI:M]", value_parser = argument::grids, allow_hyphen_values = true)]
    grid: Option<Each<Grid<1>>>,

    /// Estimate at the places in this file: its columns of the same names, or x (and y), or the only one
    #[arg(long, value_name = "TARGETS", conflicts_with = "grid")]
    at: Option<PathBuf>,

    /// Add the columns lower and upper: an interval of this confidence at each place, such as 0.95. It is about the mean of the estimate, that is the density as
    /// the kernel smooths it: how far that is from the density itself it does not know
    #[arg(long, value_name = "CONFIDENCE", value_parser = argument::confidence)]
    interval: Option<f64>,

    /// How to compute a kernel sum; by default the cheapest way within the tolerance
    #[arg(long, value_name = "NAME")]
    engine: Option<String>,

    /// Say on stderr how it was computed, and the time of each phase
    #[arg(long)]
    explain: bool,

    /// Estimate so many times, for measuring with --explain: the first time pays for new memory and sleeping processors
    #[arg(
        long,
        value_name = "TIMES",
        default_value = "1",
        hide_default_value = true
    )]
    repeat: NonZeroU16,

    /// Where to: a .csv file, or an .svg picture [default: CSV on stdout]
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
}

/// Where the estimate is wanted.
pub(super) enum Places<const D: usize> {
    Grid(Grid<D>),
    Points(Vec<Point<D>>),
}

impl<const D: usize> Places<D> {
    pub(super) fn targets(&self) -> Targets<'_, D> {
        match self {
            Self::Grid(grid) => Targets::Grid(grid),
            Self::Points(points) => Targets::Points(points),
        }
    }
}

impl Estimate {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        match self.dimensions()? {
            1 => self.run_in::<1>(notes),
            _ => self.run_in::<2>(notes),
        }
    }

    /// How many axes the data have: as many as there are columns, limits or grids.
    fn dimensions(&self) -> Result<usize, Stop> {
        let told = [
            (
                "--column",
                (!self.column.is_empty()).then_some(self.column.len()),
            ),
            ("--domain", self.domain.as_ref().map(|each| each.0.len())),
            ("--grid", self.grid.as_ref().map(|each| each.0.len())),
        ];
        let mut told = told
            .iter()
            .filter_map(|(name, axes)| Some((*name, (*axes)?)));
        let Some((first, axes)) = told.next() else {
            return Ok(1);
        };
        if let Some((other, theirs)) = told.find(|(_, theirs)| *theirs != axes) {
            return Err(Stop::Input(format!(
                "{first} is about {axes} of the axes and {other} about {theirs}; give one --column, LO:HI and LO:HI:N for each axis"
            )));
        }
        if axes > 2 {
            return Err(Stop::Input(format!(
                "{axes} columns: data are on a line or in the plane"
            )));
        }
        Ok(axes)
    }

    fn run_in<const D: usize>(&self, notes: Notes) -> Result<(), Stop>
    where
        Entry: Builds<D>,
        for<'a> Sketch<'a>: Draws<D>,
    {
        let settings = Settings::read(&self.estimator, self.engine.as_deref())?;
        let ending = self.output.as_deref().and_then(Path::extension);
        let drawn = ending.is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
        if drawn && D == 2 && self.at.is_some() {
            return Err(Stop::Input(
                "a map needs a grid: give --grid instead of --at, or write a .csv file".to_owned(),
            ));
        }
        if drawn && self.interval.is_some() {
            return Err(Stop::Input(
                "--interval adds columns to a table: write a .csv file".to_owned(),
            ));
        }
        let mut output = Output::open(self.output.as_deref())?;
        let mut phases = Phases::default();

        let (sample, mut given) = phases.time("read", || self.read())?;
        let mut left = self.repeat.get();
        let (estimator, estimate, places, evaluation) = loop {
            // what an estimator puts off until it is asked is done under `evaluate`
            let (estimator, estimate) = phases.time("fit", || -> Result<_, Stop> {
                let context = Context {
                    truth: None,
                    draws: sample.len(),
                };
                let estimator = settings.build(&context)?;
                let estimate = estimator
                    .fit(&sample)
                    .map_err(|error| Stop::Input(format!("--estimator: {error}")))?;
                Ok((estimator, estimate))
            })?;
            let (places, evaluation) = phases.time("evaluate", || -> Result<_, Stop> {
                let places = if let Some(places) = given.take() {
                    places
                } else {
                    let width = estimate.smoothing.filter(|_| settings.smooths_by_length());
                    Places::Grid(around(&sample, width)?)
                };
                let evaluation = estimate.evaluate(places.targets());
                if let Some(why) = &evaluation.failure {
                    return Err(Stop::Input(format!("--estimator: {why}")));
                }
                if let Some(bad) = evaluation.values.iter().find(|value| !value.is_finite()) {
                    return Err(Stop::Input(format!(
                        "--estimator: the estimate is {bad} somewhere: its scale is beyond what numbers can hold"
                    )));
                }
                Ok((places, evaluation))
            })?;
            left -= 1;
            if left == 0 {
                break (estimator, estimate, places, evaluation);
            }
            given = Some(places);
        };
        let interval = match self.interval {
            Some(confidence) => phases.time("interval", || {
                let places: Vec<Point<D>> = places.targets().places().collect();
                let variance = estimator.variance(&estimate, &sample, &places);
                let reach = reach(confidence);
                let half: Option<Vec<f64>> =
                    variance.map(|v| v.iter().map(|v| reach * v.sqrt()).collect());
                half.map(Some).ok_or_else(|| {
                    Stop::Input("--interval: no interval is known for this estimator and these data; it is for kernel estimates with one bandwidth from two points or more".to_owned())
                })
            })?,
            None => None,
        };
        phases.time("write", || {
            if drawn {
                let picture = Sketch {
                    name: settings.name(),
                    columns: &self.column,
                    continuous: estimator.laws().continuous,
                }
                .draw(&sample, &places, &evaluation.values);
                output.write_all(picture.as_bytes())?;
            } else {
                table(&mut output, &places, &evaluation, interval.as_deref())?;
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

    fn read<const D: usize>(&self) -> Result<(Sample<D>, Option<Places<D>>), Stop> {
        const AXES: [&str; 2] = ["x", "y"];
        let column = |axis: usize| self.column.get(axis).map(String::as_str);
        let axes: [usize; D] = std::array::from_fn(|axis| axis);
        // a line may be the only column; the axes of a plane have names
        let preferred =
            |axis: usize| Column::Preferred(if D == 1 { &[] } else { &AXES[axis..=axis] });
        let request = Request {
            columns: axes.map(|axis| column(axis).map_or_else(|| preferred(axis), Column::Named)),
            weight: self.weight.as_deref(),
            domain: self.domain()?,
        };
        if self.points == Path::new("-") && self.at.as_deref() == Some(Path::new("-")) {
            return Err(Stop::Input(
                "points and targets cannot both come from stdin".to_owned(),
            ));
        }
        let sample = read(&self.points, &request)?;
        let places = match (&self.grid, &self.at) {
            (Some(Each(grids)), _) => {
                let grid = Grid::new(
                    axes.map(|axis| grids[axis].low()[0]),
                    axes.map(|axis| grids[axis].high()[0]),
                    axes.map(|axis| grids[axis].cells()[0]),
                );
                Some(Places::Grid(
                    grid.map_err(|error| Stop::Input(format!("--grid: {error}")))?,
                ))
            }
            (None, Some(path)) => {
                let names = axes.map(|axis| [column(axis).unwrap_or(AXES[axis]), AXES[axis]]);
                let wanted = std::array::from_fn(|axis| Column::Preferred(&names[axis]));
                Some(Places::Points(read_points(path, wanted)?))
            }
            (None, None) => None,
        };
        Ok((sample, places))
    }

    fn domain<const D: usize>(&self) -> Result<Domain<D>, Stop> {
        let Some(Each(domains)) = &self.domain else {
            return Ok(Domain::whole());
        };
        let axes: [usize; D] = std::array::from_fn(|axis| axis);
        Domain::new(
            axes.map(|axis| domains[axis].low()[0]),
            axes.map(|axis| domains[axis].high()[0]),
            axes.map(|axis| domains[axis].sides()[0]),
        )
        .map_err(|error| Stop::Input(format!("--domain: {error}")))
    }
}

/// The range of the data and something more on each side, within the domain.
fn around<const D: usize>(sample: &Sample<D>, width: Option<f64>) -> Result<Grid<D>, Stop> {
    let (mut low, mut high) = ([0.0; D], [0.0; D]);
    let domain = sample.domain();
    for axis in 0..D {
        let (least, most) = sample
            .points()
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x[axis]), high.max(x[axis]))
            });
        let margin = width.map_or(0.25 * (most - least), |h| 3.0 * h);
        low[axis] = (least - margin).max(domain.low()[axis]);
        high[axis] = (most + margin).min(domain.high()[axis]);
        let cells = [GridSpec::default_cells(D)];
        Grid::new([low[axis]], [high[axis]], cells).map_err(|error| {
            Stop::Input(format!(
                "no grid fits round the data, {least} to {most}: {error}; give one with --grid LO:HI:N"
            ))
        })?;
    }
    Grid::new(low, high, [GridSpec::default_cells(D); D])
        .map_err(|error| Stop::Input(format!("no grid fits round the data: {error}")))
}

fn table<const D: usize>(
    output: &mut Output,
    places: &Places<D>,
    evaluation: &Evaluation,
    half: Option<&[f64]>,
) -> Result<(), Stop> {
    let bounds = if half.is_some() { ",lower,upper" } else { "" };
    let axes = if D == 1 { "x" } else { "x,y" };
    writeln!(output, "{axes},density{bounds}")?;
    for (i, (place, &density)) in (places.targets().places().zip(&evaluation.values)).enumerate() {
        for coordinate in place {
            write!(output, "{},", Shortest(coordinate))?;
        }
        write!(output, "{}", Shortest(density))?;
        if let Some(half) = half {
            let (lower, upper) = (density - half[i], density + half[i]);
            write!(output, ",{},{}", Shortest(lower), Shortest(upper))?;
        }
        writeln!(output)?;
    }
    Ok(())
}

fn explain<const D: usize>(
    notes: Notes,
    sample: &Sample<D>,
    smoothing: Option<f64>,
    places: &Places<D>,
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
    for line in evaluation.explanation.lines() {
        notes.say(&format!("  {line}"));
    }
    notes.say(&format!(
        "error at most {:.1e} of the largest possible value",
        evaluation.error
    ));
}
