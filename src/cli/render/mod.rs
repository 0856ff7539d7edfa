//! `lab render`

mod page;

use super::argument;
use super::estimator::Settings;
use super::light;
use super::notes::Notes;
use super::output::Output;
use super::run::quoted;
use super::stop::Stop;
use crate::estimator::Context;
use crate::light::camera::Film;
use crate::light::illumination::{Estimated, SIGHT_BYTES, Shot, Traced};
use crate::light::image::{self, Tone};
use crate::light::reference::{PathTracer, Reference};
use crate::light::scene::Scene;
use crate::light::spectrum::Colour;
use crate::report::compared::Shown;
use crate::space::Warning;
use clap::{ArgGroup, Args};
use page::{Origin, page};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// A picture of a scene, lit by an estimator, by the reference or by tracing paths
///
/// Each ray of the scene's camera is followed to a diffuse surface; the irradiance there comes from photons and an estimator of densities, from the
/// reference that estimates are judged by, or from paths traced from that place. A .png is shown through a tone curve, an .exr holds the linear
/// radiosity. An .html is a page that shows the pictures of one or more estimators beside the one by paths, with maps of what is wrong in each.
#[derive(Debug, Args)]
#[command(
    group(ArgGroup::new("light").required(true).multiple(true).args(["estimator", "reference", "paths"])),
    after_help = "\
Examples:
  lab render data/scenes/cornell-box-rgb.toml --photons 1e6 \\
      --estimator 'kernel = { shape = \"epanechnikov\", bandwidth = 0.08, boundary = \"local-linear\" }' -o box.png
  lab render data/scenes/cornell-box-rgb.toml --reference --size 256x256 -o reference.exr
  lab render data/scenes/cornell-box-rgb.toml --paths 64 -o paths.png
  lab render data/scenes/cornell-box-rgb.toml --photons 1e6 --paths 64 --size 256x256 \\
      --estimator 'histogram = { width = 0.05 }' --estimator 'nearest-neighbour = { k = 100 }' -o compared.html")]
pub struct Render {
    /// The scene, a TOML file; - is stdin
    scene: PathBuf,

    /// An estimator as in an experiment file, fitted to the hits on each surface; for a page as often as there are estimators to compare
    #[arg(long, short, value_name = "TOML", requires = "photons")]
    estimator: Vec<String>,

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

    /// Where to: a .png file for screens, an .exr file with linear values, or an .html page that compares
    #[arg(short, long, value_name = "IMAGE")]
    output: PathBuf,
}

/// What kind of file the output is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Screen,
    Linear,
    Page,
}

impl Render {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let form = self.form()?;
        let read = |text: &String| Settings::read(text, None);
        let settings: Vec<Settings> = self.estimator.iter().map(read).collect::<Result<_, _>>()?;
        let scene = light::scene(&self.scene)?;
        let Some(camera) = scene.camera else {
            return Err(Stop::Input(format!(
                "{} has no camera; give it a table [camera]",
                self.scene.display()
            )));
        };
        let rays = self.size[0] as u64 * self.size[1] as u64 * u64::from(self.rays).pow(2);
        crate::memory::check(SIGHT_BYTES * rays)
            .map_err(|error| Stop::Input(format!("--size: {error}")))?;
        let mut out = Output::open(Some(&self.output))?;
        let bar = light::bar(notes, "rays of the camera");
        let film = Film::new(camera, self.size[0], self.size[1]);
        let shot = Shot::take(&scene, &film, usize::from(self.rays), self.seed);
        bar.set_message("light");
        let file = if form == Form::Page {
            let truth = self.without_photons(&scene, &shot)?;
            let shown = self.estimated(&settings, &scene, &shot, notes)?;
            page(&truth, &shown, self.origin(&scene)).into_bytes()
        } else {
            let image = if settings.is_empty() {
                self.without_photons(&scene, &shot)?.image
            } else {
                let mut shown = self.estimated(&settings, &scene, &shot, notes)?;
                shown.swap_remove(0).image
            };
            let file = if form == Form::Linear {
                image::exr(&image)
            } else {
                image::png(&image, &Tone::of(&image))
            };
            file.map_err(|error| Stop::System(error.to_string()))?
        };
        bar.finish_and_clear();
        out.write_all(&file)?;
        out.finish()
    }

    /// The kind of file, which must go with what makes the light.
    fn form(&self) -> Result<Form, Stop> {
        let ending = self
            .output
            .extension()
            .map(std::ffi::OsStr::to_ascii_lowercase);
        let form = match ending.as_ref().and_then(|ending| ending.to_str()) {
            Some("png") => Form::Screen,
            Some("exr") => Form::Linear,
            Some("html") => Form::Page,
            _ => {
                return Err(Stop::Input(format!(
                    "-o {}: pictures are written to files that end in .png or .exr, comparisons to .html",
                    self.output.display()
                )));
            }
        };
        let judges = usize::from(self.reference) + usize::from(self.paths.is_some());
        let told = match form {
            Form::Page if self.estimator.is_empty() || judges != 1 => {
                "a page compares estimators with one of --paths and --reference: give at least one --estimator and one of these"
            }
            Form::Screen | Form::Linear if self.estimator.len() + judges != 1 => {
                "one picture has one light: give one --estimator, --reference or --paths; an .html page compares several"
            }
            _ => return Ok(form),
        };
        Err(Stop::Input(format!("-o {}: {told}", self.output.display())))
    }

    fn by_wavelength(&self) -> Stop {
        Stop::Input(format!(
            "{} knows colour by wavelength; pictures by the reference and by paths are for red, green and blue; take an estimator",
            self.scene.display()
        ))
    }

    /// The picture by paths or by the reference.
    fn without_photons(&self, scene: &Arc<Scene>, shot: &Shot) -> Result<Shown, Stop> {
        let begin = Instant::now();
        if scene.colour == Colour::Spectral {
            return Err(self.by_wavelength());
        }
        let (name, image) = match self.paths {
            Some(paths) => {
                let traced = Traced {
                    tracer: PathTracer::new(scene).ok_or_else(|| self.by_wavelength())?,
                    paths: usize::try_from(paths).unwrap_or(usize::MAX),
                    seed: self.seed,
                };
                (
                    format!("traced, {paths} paths a place"),
                    shot.lit_by(&traced),
                )
            }
            None => (
                "the reference".to_owned(),
                shot.lit_by(&Reference::new(scene.clone())),
            ),
        };
        Ok(Shown {
            name,
            image,
            seconds: begin.elapsed().as_secs_f64(),
        })
    }

    /// The picture of each estimator from the same hits.
    fn estimated(
        &self,
        settings: &[Settings],
        scene: &Arc<Scene>,
        shot: &Shot,
        notes: Notes,
    ) -> Result<Vec<Shown>, Stop> {
        let photons = self.photons.unwrap_or(1);
        let context = Context {
            truth: None,
            draws: usize::try_from(photons).unwrap_or(usize::MAX),
        };
        let estimators = settings
            .iter()
            .map(|settings| settings.build::<2>(&context))
            .collect::<Result<Vec<_>, _>>()?;
        for mesh in scene.surfaces().iter().filter(|s| s.domain().is_none()) {
            notes.warn(&Warning {
                what: format!(
                    "the surface \"{}\" is a mesh, on which nothing is estimated: it is black in pictures by estimators",
                    mesh.name.escape_debug()
                ),
                hint: "--paths and --reference show it".to_owned(),
            });
        }
        let begin = Instant::now();
        let hits = light::walk(scene, photons, self.seed, true)?;
        let walk = begin.elapsed().as_secs_f64();
        let mut shown = Vec::new();
        for (number, estimator) in estimators.iter().enumerate() {
            let begin = Instant::now();
            let estimated = Estimated::fit(&**estimator, scene.surfaces().len(), &hits);
            let estimated = estimated.map_err(|error| Stop::Input(error.to_string()))?;
            for warning in estimated.warnings() {
                notes.warn(&warning);
            }
            shown.push(Shown {
                name: self.name(number),
                image: shot.lit_by(&estimated),
                seconds: walk + begin.elapsed().as_secs_f64(),
            });
        }
        Ok(shown)
    }

    /// The kind of an estimator, numbered where there are several.
    fn name(&self, number: usize) -> String {
        let text = &self.estimator[number];
        let kind = text.split('=').next().unwrap_or(text).trim();
        if self.estimator.len() > 1 {
            format!("{}: {kind}", number + 1)
        } else {
            kind.to_owned()
        }
    }

    fn origin(&self, scene: &Scene) -> Origin {
        let file = self.scene.display().to_string();
        let title = if scene.title.is_empty() {
            file.clone()
        } else {
            scene.title.clone()
        };
        let [width, height] = self.size;
        let mut command = format!("lab render {}", quoted(&file));
        for estimator in &self.estimator {
            let _ = write!(command, " --estimator {}", quoted(estimator));
        }
        let photons = self.photons.unwrap_or(1);
        let judge = match self.paths {
            Some(paths) => format!("--paths {paths}"),
            None => "--reference".to_owned(),
        };
        let _ = write!(
            command,
            " --photons {photons} {judge} --size {width}x{height} --rays {} --seed {} -o {}",
            self.rays,
            self.seed,
            quoted(&self.output.display().to_string())
        );
        let estimators = self.estimator.iter().enumerate().map(|(number, text)| {
            let words: Vec<&str> = text.split_whitespace().collect();
            (self.name(number), words.join(" "))
        });
        let facts: [(String, String); 4] = [
            ("scene", file),
            ("photons", photons.to_string()),
            ("rays a pixel", u32::from(self.rays).pow(2).to_string()),
            ("seed", self.seed.to_string()),
        ]
        .map(|(name, value): (&str, String)| (name.to_owned(), value));
        Origin {
            scene: format!("“{title}”"),
            facts: facts.into_iter().chain(estimators).collect(),
            command,
        }
    }
}
