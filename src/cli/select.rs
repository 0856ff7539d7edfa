//! `lab select`

use super::argument;
use super::notes::Notes;
use super::output::{Output, Shortest};
use super::stop::Stop;
use crate::experiment::significant;
use crate::kernel::{Bandwidth, Kernel, Shape};
use crate::parameter::{listed, nearest};
use crate::report::figure::{Axis, Multiples, Role, Series, Small};
use crate::sample::Sample;
use crate::sample::file::{Column, Request, read};
use crate::selector::{self, CATALOGUE, Entry};
use crate::space::{Domain, Warning};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Choose a bandwidth for the points of a file, by every rule side by side
///
/// Reads one column of a CSV file or of a NumPy array and writes the columns selector, bandwidth, deviation (that of the kernel at this bandwidth, h √k₂),
/// canonical (equal for equally smooth estimates with different kernels), milliseconds and note. With -o FILE.svg also draws the criteria over
/// the bandwidth, with the choices marked.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab select data/old_faithful_107/old_faithful_107.csv --column eruption_min
  lab select data/galaxies_82/galaxies_82.csv -c velocity_km_s --kernel epanechnikov --json
  lab select points.npy --selector sheather-jones --selector lscv -o profile.svg
  lab sample --density bimodal --n 1e4 | lab select - --selector improved-sheather-jones

lab list selectors says what each of them does.")]
pub struct Select {
    /// The data: a CSV file with a header (or of numbers only) or an .npy array; - is stdin
    points: PathBuf,

    /// The column of the data: a name from the header, or a number from 1; not needed if there is only one
    #[arg(long, short, value_name = "NAME")]
    column: Option<String>,

    /// A column of weights; they are scaled to sum to 1
    #[arg(long, short, value_name = "NAME")]
    weight: Option<String>,

    /// A kernel by name (lab list kernels)
    #[arg(long, short, value_name = "NAME", default_value = "gaussian")]
    kernel: String,

    /// A selector by name (lab list selectors); may be repeated [default: all]
    #[arg(long, short, value_name = "NAME", num_args = 1..)]
    selector: Vec<String>,

    /// Where the data may lie, with walls at finite ends: 0:1, 0: or :1
    #[arg(long, value_name = "LO:HI", value_parser = argument::domain, allow_hyphen_values = true)]
    domain: Option<Domain<1>>,

    /// As JSON
    #[arg(long)]
    json: bool,

    /// A picture of the criteria: an .svg file
    #[arg(short, long, value_name = "OUT.svg")]
    output: Option<PathBuf>,
}

/// What one selector says. Without a bandwidth the note says why.
#[derive(Serialize)]
struct Row {
    selector: &'static str,
    bandwidth: Option<f64>,
    /// h √k₂.
    deviation: Option<f64>,
    /// h / δ₀.
    canonical: Option<f64>,
    milliseconds: f64,
    note: String,
}

impl Select {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let shape = self.shape()?;
        let chosen = self.selectors()?;
        let ending = self.output.as_deref().and_then(Path::extension);
        if self.output.is_some() && !ending.is_some_and(|e| e.eq_ignore_ascii_case("svg")) {
            return Err(Stop::Input(
                "--output: allowed is the name of an .svg file; the table goes to stdout"
                    .to_owned(),
            ));
        }
        let picture = self
            .output
            .as_deref()
            .map(|path| Output::open(Some(path)))
            .transpose()?;
        let mut output = Output::open(None)?;
        let sample = read(
            &self.points,
            &Request {
                columns: [self
                    .column
                    .as_deref()
                    .map_or(Column::Preferred(&[]), Column::Named)],
                weight: self.weight.as_deref(),
                domain: self.domain.clone().unwrap_or_else(Domain::whole),
            },
        )?;
        let rows: Vec<Row> = chosen
            .iter()
            .map(|entry| row(entry, &sample, shape))
            .collect();
        if rows.iter().all(|row| row.bandwidth.is_none()) {
            return Err(Stop::Input(rows[0].note.clone()));
        }
        if self.json {
            output.json(&rows)?;
        } else {
            table(&mut output, &rows)?;
        }
        output.finish()?;
        if let Some(mut picture) = picture {
            let drawing = Self::picture(&chosen, &sample, shape, &rows, notes);
            picture.write_all(drawing.as_bytes())?;
            picture.finish()?;
        }
        Ok(())
    }

    fn shape(&self) -> Result<Shape, Stop> {
        Shape::named(&self.kernel)
            .ok_or_else(|| unknown("--kernel", "kernel", &self.kernel, &Shape::NAMES))
    }

    fn selectors(&self) -> Result<Vec<&'static Entry>, Stop> {
        let names: Vec<&str> = CATALOGUE.iter().map(|entry| entry.name).collect();
        let mut chosen: Vec<&'static Entry> = Vec::new();
        for name in &self.selector {
            let entry = selector::entry_of(name)
                .ok_or_else(|| unknown("--selector", "selector", name, &names))?;
            if !chosen.iter().any(|other| other.name == entry.name) {
                chosen.push(entry);
            }
        }
        if chosen.is_empty() {
            chosen.extend(CATALOGUE.iter());
        }
        Ok(chosen)
    }

    /// One panel for each criterion, with upright lines at its own choice, at that of Sheather and Jones and at that of Silverman.
    fn picture(
        chosen: &[&Entry],
        sample: &Sample<1>,
        shape: Shape,
        rows: &[Row],
        notes: Notes,
    ) -> String {
        let widths: Vec<f64> = rows.iter().filter_map(|row| row.bandwidth).collect();
        let (least, most) = widths
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(a, b), &h| (a.min(h), b.max(h)));
        let (low, high) = (least / 2.5, most * 2.0);
        // dear criteria are drawn with fewer places
        let places: u32 = if sample.len() > 100_000 { 40 } else { 120 };
        let grid: Vec<f64> = (0..=places)
            .map(|i| low * (high / low).powf(f64::from(i) / f64::from(places)))
            .collect();
        let mut panels = Vec::new();
        for entry in chosen {
            let criterion = match (entry.build)().criterion(sample, shape) {
                Ok(Some(criterion)) => criterion,
                Ok(None) => continue,
                Err(error) => {
                    notes.say(&error.to_string());
                    continue;
                }
            };
            let y: Vec<f64> = grid.iter().map(|&h| criterion(h)).collect();
            let own = rows.iter().find(|row| row.selector == entry.name);
            let mut series = vec![Series {
                name: "criterion".to_owned(),
                x: grid.clone(),
                y: readable(&y),
                role: Role::Estimate(0),
            }];
            let (bottom, top) = ends(&series[0].y);
            let mark = |name: &str, h: f64, colour| Series {
                name: name.to_owned(),
                x: vec![h, h],
                y: vec![bottom, top],
                role: Role::Estimate(colour),
            };
            if let Some(h) = own.and_then(|row| row.bandwidth) {
                series.push(mark("its choice", h, 1));
            }
            for (colour, name) in [(2, "sheather-jones"), (3, "silverman")] {
                let other = rows.iter().find(|row| row.selector == name);
                if let Some(h) = other.and_then(|row| row.bandwidth) {
                    series.push(mark(name, h, colour));
                }
            }
            panels.push(Small {
                title: entry.name.to_owned(),
                series,
            });
        }
        Multiples {
            title: format!("Criteria for the bandwidth of {} points", sample.len()),
            description: format!(
                "What each selector makes least, over the bandwidth of the {shape} kernel; upright lines mark the bandwidths chosen."
            ),
            x: Axis::new("bandwidth", "").logarithmic().over(low, high),
            y: Axis::new("criterion, above its least", ""),
            columns: 2,
            shared: false,
            panels,
        }
        .draw()
        .to_string()
    }
}

/// How far each value is above the least, without the heights that would flatten the valley: what exceeds four times the median.
fn readable(y: &[f64]) -> Vec<f64> {
    let (bottom, _) = ends(y);
    let mut above: Vec<f64> = y.iter().map(|y| y - bottom).collect();
    let mut sorted: Vec<f64> = above.iter().copied().filter(|y| y.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let cut = 4.0
        * sorted
            .get(sorted.len() / 2)
            .copied()
            .unwrap_or(f64::INFINITY);
    for value in &mut above {
        if value.is_nan() || *value > cut {
            *value = f64::NAN;
        }
    }
    above
}

fn ends(y: &[f64]) -> (f64, f64) {
    y.iter()
        .filter(|y| y.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &y| {
            (a.min(y), b.max(y))
        })
}

fn unknown(option: &str, what: &str, name: &str, allowed: &[&str]) -> Stop {
    let guess = nearest(name, allowed.iter().copied())
        .map(|name| format!(" did you mean `{name}`?"))
        .unwrap_or_default();
    Stop::Input(format!(
        "{option}: no {what} \"{}\";{guess} allowed are {}",
        name.escape_debug(),
        listed(allowed)
    ))
}

fn row(entry: &Entry, sample: &Sample<1>, shape: Shape) -> Row {
    let start = Instant::now();
    let selected = (entry.build)().select(sample, shape);
    let milliseconds = start.elapsed().as_secs_f64() * 1e3;
    let (bandwidth, note) = match selected {
        Ok(selection) => {
            let h = match selection.bandwidth {
                Bandwidth::Fixed([h]) => Some(h),
                _ => None,
            };
            let told = |Warning { what, hint }: &Warning| format!("{what}; {hint}");
            let notes: Vec<String> = selection.warnings.iter().map(told).collect();
            (h, notes.join(". "))
        }
        Err(error) => (None, error.to_string()),
    };
    Row {
        selector: entry.name,
        bandwidth,
        deviation: bandwidth.map(|h| h * shape.variance().sqrt()),
        canonical: bandwidth.map(|h| h / shape.canonical_scale()),
        milliseconds,
        note,
    }
}

fn table(output: &mut Output, rows: &[Row]) -> Result<(), Stop> {
    output.write_all(b"selector,bandwidth,deviation,canonical,milliseconds,note\n")?;
    for row in rows {
        write!(output, "{}", row.selector)?;
        for number in [row.bandwidth, row.deviation, row.canonical] {
            match number {
                Some(number) => write!(output, ",{}", Shortest(number))?,
                None => output.write_all(b",")?,
            }
        }
        write!(output, ",{}", significant(row.milliseconds, 3))?;
        // notes hold commas
        if row.note.is_empty() {
            output.write_all(b",\n")?;
        } else {
            writeln!(output, ",\"{}\"", row.note.replace('"', "\"\""))?;
        }
    }
    Ok(())
}
