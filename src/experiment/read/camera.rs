//! `camera` of a `[[figure]]`.

use super::node::Reader;
use super::problem::{Problem, printable};
use super::setting::Setting;
use super::value::Located;
use crate::experiment::{FigureKind, SourceSpec};
use crate::light::illumination::SIGHT_BYTES;
use crate::light::photons::counts_all;
use crate::light::spectrum::Colour;
use crate::memory;

pub(super) fn camera(
    reader: &mut Reader,
    located: &Located,
    setting: &Setting<'_>,
) -> Option<FigureKind> {
    let count = |name| {
        let count = located.values.count(name)?;
        usize::try_from(count).ok()
    };
    let [width, height, rays] = [count("width")?, count("height")?, count("rays")?];
    let bytes = SIGHT_BYTES * (width * height * rays * rays) as u64;
    if let Err(error) = memory::check(bytes) {
        let name = ["rays", "width", "height"]
            .into_iter()
            .find(|name| located.given(name));
        let place = located.place(name.unwrap_or("width"));
        reader.report(Problem::at(
            place,
            format!("the picture is too large: {error}"),
        ));
        return None;
    }
    for (spec, scene) in setting.rooms? {
        let SourceSpec::Scene { path, values, .. } = spec else {
            continue;
        };
        let path = path.display();
        let problem = if scene.camera.is_none() {
            Problem::at(located.span.clone(), format!("{path} has no camera"))
                .help("give the scene a table [camera]")
        } else if scene.colour == Colour::Spectral {
            Problem::at(
                located.span.clone(),
                format!("{path} knows colour by wavelength"),
            )
            .help("the pictures that judge are for scenes in red, green and blue")
        } else if let Some(mesh) = scene.surfaces().iter().find(|s| s.domain().is_none()) {
            Problem::at(
                located.span.clone(),
                format!(
                    "the surface \"{}\" of {path} is a mesh, on which nothing is estimated: it would be black",
                    printable(&mesh.name)
                ),
            )
            .help("pictures by paths show meshes: lab render SCENE.toml --paths 64 -o picture.png")
        } else if !counts_all(values) {
            Problem::at(
                located.span.clone(),
                format!("a picture shows all light, and not every hit of {path} counts"),
            )
            .help("leave out `light` and `score`, or give the picture an experiment of its own")
        } else {
            continue;
        };
        reader.report(problem);
        return None;
    }
    if setting.rooms.is_some_and(<[_]>::is_empty) {
        reader.report(
            Problem::at(
                located.span.clone(),
                "the figure `camera` is for photons in a scene, and the source is another",
            )
            .help("for instance: source = { scene = \"PATH\", surface = \"NAME\" }"),
        );
        return None;
    }
    let reference = located.values.flag("reference") == Some(true);
    if reference && located.given("paths") {
        reader.report(
            Problem::at(
                located.place("paths"),
                "the picture that judges is lit by the reference, which has no paths to count",
            )
            .help("give one of `paths` and `reference`"),
        );
        return None;
    }
    let paths = count("paths").filter(|_| !reference);
    Some(FigureKind::Camera {
        width,
        height,
        rays,
        paths,
    })
}
