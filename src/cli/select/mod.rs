//! `lab select`

mod neighbours;
mod profile;
mod row;

use super::argument::{self, Each};
use super::notes::Notes;
use super::output::Output;
use super::stop::Stop;
use crate::kernel::{Shape, Symmetry};
use crate::parameter::{listed, nearest};
use crate::sample::Sample;
use crate::sample::file::{Column, Request, read};
use crate::selector::{self, CATALOGUE, Selector};
use crate::space::Domain;
use clap::Args;
use profile::{Panel, Profile};
use row::{Columns, Row};
use std::path::{Path, PathBuf};

/// Choose a bandwidth for the points of a file, by every rule side by side
///
/// Reads one column of a CSV file or of a NumPy array and writes the columns selector, bandwidth, deviation (that of the kernel at this bandwidth, h √k₂),
/// canonical (equal for equally smooth estimates with different kernels), milliseconds and note. With two columns the data are in the plane, and the columns are selector,
/// bandwidth, bandwidth_y, milliseconds and note. With --neighbours it is the k of the k-nearest-neighbour estimator that is chosen. With -o FILE.svg also draws the criteria over
/// the bandwidth, with the choices marked.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab select data/old_faithful_107/old_faithful_107.csv --column eruption_min
  lab select data/galaxies_82/galaxies_82.csv -c velocity_km_s --kernel epanechnikov --json
  lab select points.npy --selector sheather-jones --selector lscv -o profile.svg
  lab select data/faithful_272/faithful_272.csv -c eruptions -c waiting --symmetry radial -o plane.svg
  lab select data/galaxies_82/galaxies_82.csv -c velocity_km_s --neighbours
  lab sample --density bimodal --n 1e4 | lab select - --selector improved-sheather-jones

lab list selectors says what each of them does.")]
pub struct Select {
    /// The data: a CSV file with a header (or of numbers only) or an .npy array; - is stdin
    points: PathBuf,

    /// The column of the data: a name from the header, or a number from 1; not needed if there is only one. Twice for data in the plane
    #[arg(long, short, value_name = "NAME")]
    column: Vec<String>,

    /// A column of weights; they are scaled to sum to 1
    #[arg(long, short, value_name = "NAME")]
    weight: Option<String>,

    /// A kernel by name (lab list kernels)
    #[arg(long, short, value_name = "NAME", default_value = "gaussian")]
    kernel: String,

    /// In the plane: a kernel of each axis or one of the distance [default: product]
    #[arg(long, value_name = "product|radial")]
    symmetry: Option<String>,

    /// Choose the number k of nearest neighbours instead of a bandwidth
    #[arg(long, conflicts_with_all = ["kernel", "symmetry"])]
    neighbours: bool,

    /// A selector by name (lab list selectors); may be repeated [default: all]
    #[arg(long, short, value_name = "NAME", num_args = 1..)]
    selector: Vec<String>,

    /// Where the data may lie, with walls at finite ends: 0:1, 0: or :1; in the plane 0:1,0:1
    #[arg(long, value_name = "LO:HI[,LO:HI]", value_parser = argument::domains, allow_hyphen_values = true)]
    domain: Option<Each<Domain<1>>>,

    /// As JSON
    #[arg(long)]
    json: bool,

    /// A picture of the criteria: an .svg file
    #[arg(short, long, value_name = "OUT.svg")]
    output: Option<PathBuf>,
}

/// A selector with its name.
type Named<const D: usize> = (&'static str, Box<dyn Selector<D>>);

impl Select {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let ending = self.output.as_deref().and_then(Path::extension);
        if self.output.is_some() && !ending.is_some_and(|e| e.eq_ignore_ascii_case("svg")) {
            return Err(Stop::Input(
                "--output: allowed is the name of an .svg file; the table goes to stdout"
                    .to_owned(),
            ));
        }
        let axes = self.column.len().max(1);
        if axes > 2 {
            return Err(Stop::Input(format!(
                "{axes} columns: data are on a line or in the plane"
            )));
        }
        if let Some(Each(sides)) = self.domain.as_ref().filter(|each| each.0.len() != axes) {
            return Err(Stop::Input(format!(
                "--domain is about {} of the axes and --column about {axes}; give one LO:HI for each column",
                sides.len()
            )));
        }
        match (axes, self.neighbours) {
            (1, false) => self.on_the_line(notes),
            (1, true) => neighbours::run::<1>(self, notes),
            (_, false) => self.in_the_plane(notes),
            (_, true) => neighbours::run::<2>(self, notes),
        }
    }

    fn on_the_line(&self, notes: Notes) -> Result<(), Stop> {
        if self.symmetry.is_some() {
            return Err(Stop::Input(
                "--symmetry has no meaning on a line; give two columns for data in the plane"
                    .to_owned(),
            ));
        }
        let names: Vec<&str> = CATALOGUE.iter().map(|entry| entry.name).collect();
        let chosen = self.chosen(&names, |name| {
            let entry = selector::entry_of(name)?;
            Some((entry.name, (entry.build)()))
        })?;
        let shape = self.shape()?;
        self.show(notes, &chosen, shape, Columns::Line(shape))
    }

    fn in_the_plane(&self, notes: Notes) -> Result<(), Stop> {
        let symmetry = match &self.symmetry {
            None => Symmetry::default(),
            Some(name) => Symmetry::named(name)
                .ok_or_else(|| unknown("--symmetry", "symmetry", name, &Symmetry::NAMES))?,
        };
        let names: Vec<&str> = selector::PLANE.iter().map(|entry| entry.name).collect();
        let chosen = self.chosen(&names, |name| {
            let entry = selector::plane_entry_of(name)?;
            Some((entry.name, (entry.build)(symmetry)))
        })?;
        self.show(notes, &chosen, self.shape()?, Columns::Plane)
    }

    fn shape(&self) -> Result<Shape, Stop> {
        Shape::named(&self.kernel)
            .ok_or_else(|| unknown("--kernel", "kernel", &self.kernel, &Shape::NAMES))
    }

    /// The selectors asked for, each once; all of `names` if none is.
    fn chosen<T>(
        &self,
        names: &[&'static str],
        build: impl Fn(&str) -> Option<(&'static str, T)>,
    ) -> Result<Vec<(&'static str, T)>, Stop> {
        let mut chosen: Vec<(&'static str, T)> = Vec::new();
        for name in &self.selector {
            let found =
                build(name).ok_or_else(|| unknown("--selector", "selector", name, names))?;
            if !chosen.iter().any(|other| other.0 == found.0) {
                chosen.push(found);
            }
        }
        if chosen.is_empty() {
            chosen.extend(names.iter().filter_map(|name| build(name)));
        }
        Ok(chosen)
    }

    fn read<const D: usize>(&self) -> Result<Sample<D>, Stop> {
        let domain = match &self.domain {
            None => Domain::whole(),
            Some(Each(sides)) => {
                let side = |axis: usize| sides.get(axis).unwrap_or(&sides[0]);
                let low = std::array::from_fn(|axis| side(axis).low()[0]);
                let high = std::array::from_fn(|axis| side(axis).high()[0]);
                let sides = std::array::from_fn(|axis| side(axis).sides()[0]);
                Domain::new(low, high, sides).map_err(|error| Stop::Input(error.to_string()))?
            }
        };
        let column = |axis: usize| self.column.get(axis).map(String::as_str);
        Ok(read(
            &self.points,
            &Request {
                columns: std::array::from_fn(|axis| {
                    column(axis).map_or(Column::Preferred(&[]), Column::Named)
                }),
                weight: self.weight.as_deref(),
                domain,
            },
        )?)
    }

    /// The picture, opened before anything is computed.
    fn picture(&self) -> Result<Option<Output>, Stop> {
        self.output
            .as_deref()
            .map(|path| Output::open(Some(path)))
            .transpose()
    }

    fn show<const D: usize>(
        &self,
        notes: Notes,
        chosen: &[Named<D>],
        shape: Shape,
        columns: Columns,
    ) -> Result<(), Stop> {
        let picture = self.picture()?;
        let mut output = Output::open(None)?;
        let sample = self.read::<D>()?;
        let rows: Vec<Row> = chosen
            .iter()
            .map(|(name, selector)| Row::of(name, || selector.select(&sample, shape), columns))
            .collect();
        if rows.iter().all(|row| row.bandwidth.is_none()) {
            return Err(Stop::Input(rows[0].note.clone()));
        }
        if self.json {
            output.json(&rows)?;
        } else {
            row::table(&mut output, &rows, columns)?;
        }
        output.finish()?;
        if let Some(mut picture) = picture {
            let drawing = profile(chosen, &sample, shape, &rows, notes);
            picture.write_all(drawing.as_bytes())?;
            picture.finish()?;
        }
        Ok(())
    }
}

/// One panel for each criterion, with upright lines at its own choice and at those that readers know.
fn profile<const D: usize>(
    chosen: &[Named<D>],
    sample: &Sample<D>,
    shape: Shape,
    rows: &[Row],
    notes: Notes,
) -> String {
    let width = |name: &str| {
        let row = rows.iter().find(|row| row.selector == name)?;
        row.bandwidth.map(|h| (row.selector.to_owned(), h))
    };
    let panels = chosen
        .iter()
        .filter_map(|(name, selector)| match selector.criterion(sample, shape) {
            Ok(criterion) => Some(Panel {
                title: (*name).to_owned(),
                criterion: criterion?,
                own: width(name).map(|(_, h)| h),
            }),
            Err(error) => {
                notes.say(&error.to_string());
                None
            }
        })
        .collect();
    let others = if D == 1 {
        ["sheather-jones", "silverman"]
    } else {
        ["normal-reference", "silverman"]
    };
    let axis = if D == 1 {
        "bandwidth"
    } else {
        "bandwidth of the first axis, the other in proportion"
    };
    Profile {
        title: format!("Criteria for the bandwidth of {} points", sample.len()),
        description: format!(
            "What each selector makes least, over the bandwidth of the {shape} kernel; upright lines mark the bandwidths chosen."
        ),
        axis,
        // dear criteria are drawn with fewer places
        places: if sample.len() > 100_000 || D > 1 { 40 } else { 120 },
        widths: rows.iter().filter_map(|row| row.bandwidth).collect(),
        others: others.iter().filter_map(|name| width(name)).collect(),
        panels,
    }
    .draw()
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
