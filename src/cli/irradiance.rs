//! `lab irradiance`

use super::argument;
use super::estimator::Settings;
use super::light;
use super::notes::Notes;
use super::output::{Output, Shortest};
use super::stop::Stop;
use crate::estimator::Context;
use crate::light::illumination::channels;
use crate::report::figure::{Axis, Colours, HeatMaps, Map};
use crate::space::{Domain, Grid, Targets};
use clap::Args;
use std::path::{Path, PathBuf};

/// Estimate the irradiance on a surface of a scene from the hits of photons
///
/// Photons walk from the lamps; their hits on the surface are weighted points like any others, and an estimator of densities makes power per area of them.
/// How much it smooths is chosen once from all colours together. Written are the centres of the cells and the irradiance in each channel there.
#[derive(Debug, Args)]
#[command(after_help = "\
Estimators are written as in an experiment file; lengths are those of the scene.

Examples:
  lab irradiance data/scenes/cornell-box-rgb.toml --photons 1e6 --surface floor \\
      --estimator 'kernel = { shape = \"epanechnikov\", bandwidth = 0.1, boundary = \"local-linear\" }' --cells 64x64 -o floor.svg
  lab irradiance data/scenes/cornell-box-rgb.toml --photons 1e5 --surface back --estimator 'nearest-neighbour = { k = 50 }' --cells 32x32
  lab list estimators                             what there is, with parameters")]
pub struct Irradiance {
    /// The scene, a TOML file; - is stdin
    scene: PathBuf,

    /// How many photons leave the lamps
    #[arg(long, value_name = "N", value_parser = argument::count)]
    photons: u64,

    /// The surface, by its name in the scene
    #[arg(long, value_name = "NAME")]
    surface: String,

    /// The estimator, as in an experiment file
    #[arg(long, short, value_name = "TOML")]
    estimator: String,

    /// Cells along u and v
    #[arg(long, value_name = "NxM", value_parser = argument::cells, default_value = "32x32")]
    cells: [usize; 2],

    /// The seed of the walk
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,

    /// Where to: a .csv file, or an .svg picture [default: CSV on stdout]
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
}

impl Irradiance {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let settings = Settings::read(&self.estimator, None)?;
        let scene = light::scene(&self.scene)?;
        let surface = light::surface(&scene, &self.surface)?;
        let Some(domain) = scene.surfaces()[surface].domain().cloned() else {
            return Err(Stop::Input(format!(
                "--surface: \"{}\" is a mesh, whose points have no pair of coordinates",
                self.surface
            )));
        };
        let grid = Grid::new(domain.low(), domain.high(), self.cells)
            .map_err(|error| Stop::Input(format!("--cells: {error}")))?;
        let estimator = settings.build::<2>(&Context {
            truth: None,
            draws: usize::try_from(self.photons).unwrap_or(usize::MAX),
        })?;
        let drawn = self
            .output
            .as_deref()
            .and_then(Path::extension)
            .is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
        let mut out = Output::open(self.output.as_deref())?;
        let bar = light::bar(notes, "photons");
        let hits = light::walk(&scene, self.photons, self.seed, false)?;
        bar.finish_and_clear();
        let values = match hits(surface) {
            None => {
                notes.say(&format!("no photon hit \"{}\"", self.surface));
                vec![[0.0; 3]; grid.len()]
            }
            Some(sample) => {
                let estimate = estimator.fit(&sample);
                let estimate = estimate.map_err(|error| Stop::Input(error.to_string()))?;
                for warning in &estimate.warnings {
                    notes.warn(warning);
                }
                channels(&estimate, Targets::Grid(&grid))
            }
        };
        let mask = domain.mask(&grid);
        let inside = |cell: usize| mask.as_ref().is_none_or(|mask| mask[cell]);
        if drawn {
            let svg = self.draw(settings.name(), &grid, &domain, &values, inside);
            out.write_all(svg.as_bytes())?;
            return out.finish();
        }
        out.write_all(b"i,j,u,v,irradiance_r,irradiance_g,irradiance_b\n")?;
        for (cell, value) in values.iter().enumerate().filter(|(cell, _)| inside(*cell)) {
            let [u, v] = grid.centre(cell);
            let (i, j) = (cell / self.cells[1], cell % self.cells[1]);
            let [u, v, r, g, b] = [u, v, value[0], value[1], value[2]].map(Shortest);
            writeln!(out, "{i},{j},{u},{v},{r},{g},{b}")?;
        }
        out.finish()
    }

    /// A map of each channel, all on one scale.
    fn draw(
        &self,
        estimator: &str,
        grid: &Grid<2>,
        domain: &Domain<2>,
        values: &[[f64; 3]],
        inside: impl Fn(usize) -> bool,
    ) -> String {
        let maps = ["red", "green", "blue"].into_iter().enumerate();
        let maps = maps.map(|(channel, name)| Map {
            title: name.to_owned(),
            value: String::new(),
            values: (0..values.len())
                .map(|cell| {
                    if inside(cell) {
                        values[cell][channel]
                    } else {
                        f64::NAN
                    }
                })
                .collect(),
        });
        HeatMaps {
            title: format!("{}: {estimator}", self.surface),
            description: format!(
                "The irradiance on {} from {} photons.",
                self.surface, self.photons
            ),
            x: Axis::new("u", ""),
            y: Axis::new("v", ""),
            low: grid.low(),
            high: grid.high(),
            cells: grid.cells(),
            label: "irradiance".to_owned(),
            colours: Colours::Amount,
            outline: domain
                .outline()
                .map_or_else(Vec::new, |o| o.vertices().to_vec()),
            columns: 3,
            maps: maps.collect(),
            ..HeatMaps::default()
        }
        .draw()
        .to_string()
    }
}
