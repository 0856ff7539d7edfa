//! `lab render`

use super::argument;
use super::estimator::Settings;
use super::light;
use super::notes::Notes;
use super::output::Output;
use super::stop::Stop;
use crate::estimator::Context;
use crate::light::camera::Film;
use crate::light::illumination::{Estimated, Shot, Traced};
use crate::light::image::{self, Image, Tone};
use crate::light::reference::{PathTracer, Reference};
use crate::light::scene::Scene;
use crate::light::spectrum::Colour;
use clap::{ArgGroup, Args};
use std::path::PathBuf;
use std::sync::Arc;

/// A picture of a scene, lit by an estimator, by the reference or by tracing paths
///
/// Each ray of the scene's camera is followed to a diffuse surface; the irradiance there comes from photons and an estimator of densities, from the
/// reference that estimates are judged by, or from paths traced from that place. A .png is shown through a tone curve, an .exr holds the linear
/// radiosity.
#[derive(Debug, Args)]
#[command(
    group(ArgGroup::new("light").required(true).args(["estimator", "reference", "paths"])),
    after_help = "\
Examples:
  lab render data/scenes/cornell-box-rgb.toml --photons 1e6 \\
      --estimator 'kernel = { shape = \"epanechnikov\", bandwidth = 0.08, boundary = \"local-linear\" }' -o box.png
  lab render data/scenes/cornell-box-rgb.toml --reference --size 256x256 -o reference.exr
  lab render data/scenes/cornell-box-rgb.toml --paths 64 -o paths.png")]
pub struct Render {
    /// The scene, a TOML file; - is stdin
    scene: PathBuf,

    /// An estimator as in an experiment file, fitted to the hits on each surface
    #[arg(long, short, value_name = "TOML", requires = "photons")]
    estimator: Option<String>,

    /// How many photons leave the lamps
    #[arg(long, value_name = "N", value_parser = argument::count, requires = "estimator")]
    photons: Option<u64>,

    /// The reference: the balance of light where there is one, otherwise many paths from each place
    #[arg(long)]
    reference: bool,

    /// So many paths from each place
    #[arg(long, value_name = "N", value_parser = argument::count)]
    paths: Option<u64>,

    /// Pixels in a row and rows
    #[arg(long, value_name = "WxH", value_parser = argument::cells, default_value = "512x512")]
    size: [usize; 2],

    /// Rays for each pixel: N by N
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=16))]
    rays: u8,

    /// The seed of photons and paths
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,

    /// Where to: a .png file for screens, or an .exr file with linear values
    #[arg(short, long, value_name = "IMAGE")]
    output: PathBuf,
}

impl Render {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let ending = self
            .output
            .extension()
            .map(std::ffi::OsStr::to_ascii_lowercase);
        let linear = match ending.as_ref().and_then(|ending| ending.to_str()) {
            Some("png") => false,
            Some("exr") => true,
            _ => {
                return Err(Stop::Input(format!(
                    "-o {}: pictures are written to files that end in .png or .exr",
                    self.output.display()
                )));
            }
        };
        let settings = self.estimator.as_deref();
        let settings = settings
            .map(|text| Settings::read(text, None))
            .transpose()?;
        let scene = light::scene(&self.scene)?;
        let Some(camera) = scene.camera else {
            return Err(Stop::Input(format!(
                "{} has no camera; give it a table [camera]",
                self.scene.display()
            )));
        };
        // a sight takes 150 bytes, and its light and place as much again
        let rays = self.size[0] as u64 * self.size[1] as u64 * u64::from(self.rays).pow(2);
        crate::memory::check(400 * rays)
            .map_err(|error| Stop::Input(format!("--size: {error}")))?;
        let mut out = Output::open(Some(&self.output))?;
        let bar = light::bar(notes, "rays of the camera");
        let film = Film::new(camera, self.size[0], self.size[1]);
        let shot = Shot::take(&scene, &film, usize::from(self.rays), self.seed);
        bar.set_message("light");
        let image = match (settings, self.paths) {
            (Some(settings), _) => self.estimated(&settings, &scene, &shot, notes)?,
            (None, Some(paths)) => shot.lit_by(&Traced {
                tracer: PathTracer::new(&scene).ok_or_else(|| self.by_wavelength())?,
                paths: usize::try_from(paths).unwrap_or(usize::MAX),
                seed: self.seed,
            }),
            (None, None) if scene.colour == Colour::Spectral => return Err(self.by_wavelength()),
            (None, None) => shot.lit_by(&Reference::new(scene.clone())),
        };
        bar.finish_and_clear();
        let file = if linear {
            image::exr(&image)
        } else {
            image::png(&image, &Tone::of(&image))
        };
        out.write_all(&file.map_err(|error| Stop::System(error.to_string()))?)?;
        out.finish()
    }

    fn by_wavelength(&self) -> Stop {
        Stop::Input(format!(
            "{} knows colour by wavelength; pictures by the reference and by paths are for red, green and blue; take an estimator",
            self.scene.display()
        ))
    }

    fn estimated(
        &self,
        settings: &Settings,
        scene: &Arc<Scene>,
        shot: &Shot,
        notes: Notes,
    ) -> Result<Image, Stop> {
        let photons = self.photons.unwrap_or(1);
        let estimator = settings.build::<2>(&Context {
            truth: None,
            draws: usize::try_from(photons).unwrap_or(usize::MAX),
        })?;
        let hits = light::walk(scene, photons, self.seed, true)?;
        let estimated = Estimated::fit(&*estimator, scene.surfaces().len(), hits);
        let estimated = estimated.map_err(|error| Stop::Input(error.to_string()))?;
        for warning in estimated.warnings() {
            notes.warn(&warning);
        }
        Ok(shot.lit_by(&estimated))
    }
}
