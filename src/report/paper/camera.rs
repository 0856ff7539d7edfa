//! Pictures of a scene by each estimator beside one that needs no photons, and what is wrong in each.

use super::Material;
use super::pictures::{Picture, chosen, picture};
use crate::experiment::results::Group;
use crate::experiment::run::RunError;
use crate::experiment::{Figure, FigureKind, SourceSpec};
use crate::light::camera::Film;
use crate::light::illumination::{Estimated, Shot, Traced};
use crate::light::photons;
use crate::light::reference::{PathTracer, Reference};
use crate::parameter::Values;
use crate::report::compared::{Shown, compare};
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Two drawings for each walk through a scene that the groups are samples of, whatever surfaces they are on.
pub(super) fn seen(
    material: &Material<'_, 2>,
    figure: &Figure,
    groups: &[(usize, &Group<2>)],
) -> Result<Vec<Picture>, RunError> {
    let mut walks: Vec<(&Path, &Values, &Group<2>, &Arc<Reference>)> = Vec::new();
    for (_, group) in groups {
        let source = &material.bench.experiment().sources[group.source];
        let SourceSpec::Scene { path, values, .. } = source else {
            continue;
        };
        let known = walks.iter().any(|walk| (walk.0, walk.1) == (path, values));
        if let Some(room) = material.bench.room(group.source).filter(|_| !known) {
            walks.push((path, values, group, room));
        }
    }
    let several = walks.len() > 1;
    let mut drawn = Vec::new();
    for (path, values, group, room) in walks {
        let mut pictures = walk(material, figure, (values, group, room))?;
        if several {
            // a walk is of no surface: its scene names it, and numbers tell apart what is walked in one scene
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let number = drawn.len() / 2 + 1;
            for picture in &mut pictures {
                picture.title = format!("{} — {name} ({number})", picture.title);
                picture.slug = format!("{}-{number}", picture.slug);
            }
        }
        drawn.extend(pictures);
    }
    Ok(drawn)
}

fn walk(
    material: &Material<'_, 2>,
    figure: &Figure,
    (values, group, room): (&Values, &Group<2>, &Arc<Reference>),
) -> Result<Vec<Picture>, RunError> {
    let told = |error: &dyn std::error::Error| RunError::Input(error.to_string());
    let scene = room.scene();
    let (
        Some(camera),
        &FigureKind::Camera {
            width,
            height,
            rays,
            paths,
        },
    ) = (scene.camera, &figure.kind)
    else {
        return Ok(Vec::new());
    };
    let seed = material.bench.experiment().seed;
    let film = Film::new(camera, width, height);
    let shot = Shot::take(scene, &film, rays, seed);
    let begin = Instant::now();
    let (name, image) = match paths.zip(PathTracer::new(scene)) {
        Some((paths, tracer)) => {
            let traced = Traced {
                tracer,
                paths,
                seed,
            };
            (
                format!("traced, {paths} paths a place"),
                shot.lit_by(&traced),
            )
        }
        None => ("the reference".to_owned(), shot.lit_by(&**room)),
    };
    let truth = Shown {
        name,
        image,
        seconds: begin.elapsed().as_secs_f64(),
    };
    // the very walk of the first sample, but what is returned of the light that arrives
    let mut random = material.bench.stream(0);
    let power = photons::power(values).map_err(|error| told(&error))?;
    let (hits, _) = photons::walk(scene, power, group.draws, &mut random)
        .and_then(|walk| walk.returned().run())
        .map_err(|error| told(&error))?;
    let setting = material.bench.setting(group.source, group.size);
    let mut shown = Vec::new();
    let mut remarks = String::new();
    for (number, outcome) in chosen(figure, group) {
        let begin = Instant::now();
        let estimator = &*setting.estimators[number];
        let sample = |surface| hits.sample(scene, surface)?.ok();
        match Estimated::fit(estimator, scene.surfaces().len(), sample) {
            Ok(estimated) => {
                for warning in estimated.warnings() {
                    let _ = write!(remarks, " “{}”: {}.", outcome.name, warning.what);
                }
                shown.push(Shown {
                    name: outcome.name.clone(),
                    image: shot.lit_by(&estimated),
                    seconds: begin.elapsed().as_secs_f64(),
                });
            }
            // a small surface may have too few hits for it: the others are worth showing
            Err(error) => {
                let _ = write!(remarks, " “{}” is not shown: {error}.", outcome.name);
            }
        }
    }
    let compared = compare(&truth, &shown);
    let mut pictures = picture::<2>(figure, None, compared.pictures);
    let mut wrong = picture::<2>(figure, None, compared.errors);
    wrong.title = format!("{}: what is wrong", pictures.title);
    wrong.slug = format!("{}-errors", pictures.slug);
    wrong.caption = format!(
        "Luminance less that of the picture {}, in per cent of its average: blue is too dark, red too bright, what is beyond ±{} % has the last colour; lamps are left out. Beside each name stands the root of the mean square.{remarks}",
        if paths.is_some() {
            "by paths"
        } else {
            "by the reference"
        },
        compared.limit,
    );
    pictures.caption = format!(
        "{}{}{} photons, and each estimator lights the picture by their hits on every surface. The first picture, {}, knows nothing of them.{remarks}",
        figure.caption,
        if figure.caption.is_empty() { "" } else { " " },
        group.draws,
        truth.name,
    );
    Ok(if shown.is_empty() {
        vec![pictures]
    } else {
        vec![pictures, wrong]
    })
}
