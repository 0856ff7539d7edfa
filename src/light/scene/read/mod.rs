//! TOML → scene, or every problem of the file.
//!
//! ```toml
//! title = "A lamp over a floor"
//! unit  = "m"                                     # of length, for axes of figures
//! open  = true                                    # light may leave; otherwise leaving light is a leak and stops a walk
//!
//! [camera]                                        # optional
//! position = [0.0, 1.0, 5.0]
//! direction = [0.0, 0.0, -1.0]
//! up = [0.0, 1.0, 0.0]
//! field-of-view = 40.0
//!
//! [material.white]
//! lambertian = { reflectance = 0.8 }              # a number, [r, g, b], or { file = "white.csv", column = "white" }
//! [material.glass]
//! dielectric = { index = 1.5 }                    # also mirror = { reflectance }, phong = { reflectance, exponent }
//!
//! [[surface]]
//! name = "floor"
//! material = "white"
//! quad = { origin = [0.0, 0.0, 0.0], u = [2.0, 0.0, 0.0], v = [0.0, 0.0, 2.0] }     # or quad = { corners = [..4..] }
//! facing = [0.0, 1.0, 0.0]                        # on which side the front is; without it, the corners run counter-clockwise seen from it
//! emission = { radiance = 1.0 }
//! ```
//!
//! Other shapes: `triangle = { corners = [..3..] }`, `sphere = { centre, radius, inward = false }`, `mesh = { file = "bunny.obj", scale = 1.0,
//! move = [0, 0, 0] }`. Paths are relative to the folder of the file. Colour is three channels or spectra, not both in one scene.

mod material;
mod shape;
mod spectrum;

use super::{Camera, Scene, SceneError, Surface};
use crate::document::node::{Item, Reader, Table, found};
use crate::document::problem::{Problem, Span, printable};
use crate::document::{self, Problems, syntax};
use crate::light::emission::Emission;
use crate::light::material::Material;
use crate::light::spectrum::Colour;
use crate::light::vector::Vector;
use crate::parameter::{listed, nearest};
use spectrum::Palette;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The most surfaces of a scene; a mesh counts as one.
pub const SURFACES: usize = 10_000;

/// Coordinates beyond this overflow when areas are multiplied.
const FARTHEST: f64 = 1e50;

/// Reads the scene in the file at `path`; `-` is the standard input.
///
/// # Errors
/// With everything that is wrong. [`Problems::is_input_output`] tells a file that could not be read from a wrong one.
pub fn scene(path: &Path) -> Result<Scene, Problems> {
    scene_text(&syntax::text(path, "scene")?, path)
}

/// Reads the scene `text`; paths in it are relative to the folder of `origin`.
///
/// # Errors
/// With everything that is wrong.
pub fn scene_text(text: &str, origin: &Path) -> Result<Scene, Problems> {
    document::read(text, origin, |reader, document, text| {
        whole(reader, document, text, origin)
    })
}

fn whole(
    reader: &mut Reader,
    document: &Spanned<DeTable<'_>>,
    text: &str,
    origin: &Path,
) -> Option<Scene> {
    const KEYS: [&str; 6] = ["title", "unit", "open", "camera", "material", "surface"];
    let folder = origin.parent().unwrap_or(Path::new("")).to_owned();
    let mut top = Table::new(document.get_ref(), 0..text.len().min(1), "a scene");
    let title = top
        .take("title")
        .and_then(|entry| reader.prose(entry.item, "`title`", 2000));
    let unit = top
        .take("unit")
        .and_then(|entry| reader.name(entry.item, "`unit`"));
    let open = top
        .take("open")
        .and_then(|entry| flag(reader, entry.item, "`open`"));
    let camera = top.take("camera").map(|entry| {
        reader
            .table(entry.item, "the camera")
            .and_then(|table| camera(reader, table))
    });
    let mut palette = Palette::new(folder);
    let materials = top
        .take("material")
        .map_or_else(Materials::default, |entry| {
            materials(reader, entry.item, &mut palette)
        });
    let surfaces = top.need(reader, "surface", "begin each with a line [[surface]]");
    top.finish(reader, &KEYS);
    let tables = reader.tables(surfaces?, "a surface");
    if tables.len() > SURFACES {
        reader.report(Problem::at(
            tables[SURFACES].span.clone(),
            format!("a scene has at most {SURFACES} surfaces; put triangles into a mesh"),
        ));
        return None;
    }
    let mut read = Vec::with_capacity(tables.len());
    let mut names: Vec<String> = Vec::new();
    for table in tables {
        read.push(surface(reader, table, &materials, &mut palette, &mut names));
    }
    if !reader.problems.is_empty() {
        return None;
    }
    let surfaces = read.into_iter().collect::<Option<Vec<Surface>>>()?;
    let colour = if palette.has_tables() {
        Colour::Spectral
    } else {
        Colour::Rgb
    };
    match Scene::new(surfaces, colour, open.unwrap_or(false)) {
        Ok(mut scene) => {
            scene.title = title.unwrap_or_default();
            scene.unit = unit.unwrap_or(scene.unit);
            scene.camera = camera.flatten();
            Some(scene)
        }
        Err(error) => {
            let mut problem = Problem::at(0..0, error.to_string());
            if error == SceneError::Dark {
                problem = problem.help("give a surface emission = { radiance = 1.0 }");
            }
            reader.report(problem);
            None
        }
    }
}

/// The materials by name; a faulty one is there without its value, so that whoever uses it is not blamed.
#[derive(Default)]
struct Materials {
    known: BTreeMap<String, Option<Arc<Material>>>,
}

fn materials(reader: &mut Reader, item: &Item<'_>, palette: &mut Palette) -> Materials {
    let mut known = BTreeMap::new();
    let DeValue::Table(table) = item.get_ref() else {
        reader.wrong_type(item, "`material`", "a table of materials: [material.NAME]");
        return Materials { known };
    };
    for (name, item) in table {
        let what = format!("the material \"{}\"", printable(name.get_ref()));
        let material = reader
            .table(item, &what)
            .and_then(|table| material::material(reader, table, palette));
        known.insert(name.get_ref().to_string(), material.map(Arc::new));
    }
    Materials { known }
}

fn surface(
    reader: &mut Reader,
    mut table: Table<'_>,
    materials: &Materials,
    palette: &mut Palette,
    names: &mut Vec<String>,
) -> Option<Surface> {
    let name = table
        .need(reader, "name", "a name that no other surface has")
        .and_then(|entry| {
            let name = reader.name(entry.item, "the name of a surface")?;
            if names.contains(&name) {
                reader.report(Problem::at(
                    entry.item.span(),
                    format!("another surface is named \"{}\" already", printable(&name)),
                ));
                return None;
            }
            names.push(name.clone());
            Some(name)
        });
    let material = table
        .need(reader, "material", "the name of a [material.NAME]")
        .and_then(|entry| {
            let wanted = reader.text(entry.item, "`material`")?;
            if let Some(found) = materials.known.get(wanted) {
                return found.clone();
            }
            let known: Vec<&str> = materials.known.keys().map(String::as_str).collect();
            let problem = Problem::at(
                entry.item.span(),
                format!("there is no material \"{}\"", printable(wanted)),
            )
            .suggest(nearest(wanted, known.iter().copied()));
            reader.report(if known.is_empty() {
                problem.help("define it: [material.white] and lambertian = { reflectance = 0.8 }")
            } else {
                problem.allowed(listed(&known))
            });
            None
        });
    let emission = match table.take("emission") {
        Some(entry) => Some(emission(reader, entry.item, palette)?),
        None => None,
    };
    let shape = shape::shape(reader, &mut table, palette.folder());
    table.finish(reader, &shape::SURFACE_KEYS);
    let (shape, material) = (shape?, material?);
    Some(Surface {
        name: name?,
        shape,
        material,
        emission,
    })
}

fn emission(reader: &mut Reader, item: &Item<'_>, palette: &mut Palette) -> Option<Emission> {
    let mut table = reader.table(item, "an emission")?;
    let radiance = table
        .need(reader, "radiance", "power per area and solid angle")
        .and_then(|entry| palette.spectrum(reader, entry.item, "`radiance`", 1e30));
    if table.finish(reader, &["radiance"]) {
        return None;
    }
    Some(Emission {
        radiance: radiance?,
    })
}

fn camera(reader: &mut Reader, mut table: Table<'_>) -> Option<Camera> {
    const KEYS: [&str; 4] = ["position", "direction", "up", "field-of-view"];
    let span = table.span.clone();
    let mut three = |reader: &mut Reader, key: &str| {
        table
            .need(reader, key, "three numbers [x, y, z]")
            .and_then(|entry| vector(reader, entry.item, &format!("`{key}`")))
    };
    let position = three(reader, "position");
    let direction = three(reader, "direction");
    let up = three(reader, "up");
    let field = table
        .need(
            reader,
            "field-of-view",
            "the angle across the picture, in degrees",
        )
        .and_then(|entry| {
            let allowed = "a number of degrees between 0 and 180";
            let angle = reader.real(entry.item, "`field-of-view`")?;
            if angle > 0.0 && angle < 180.0 {
                return Some(angle);
            }
            reader.report(
                Problem::at(
                    entry.item.span(),
                    format!("`field-of-view` must be {allowed}, not {angle}"),
                )
                .allowed(allowed),
            );
            None
        });
    if table.finish(reader, &KEYS) {
        return None;
    }
    let (direction, up) = (direction?, up?);
    let across = direction.cross(&up);
    if across.norm() <= 1e-9 * direction.norm() * up.norm() {
        reader.report(Problem::at(
            span,
            "the camera looks along its own `up`, or one of the two is 0",
        ));
        return None;
    }
    let direction = direction.normalize();
    Some(Camera {
        position: position?,
        direction,
        up: across.normalize().cross(&direction),
        field_of_view: field?,
    })
}

/// Three numbers.
fn vector(reader: &mut Reader, item: &Item<'_>, what: &str) -> Option<Vector> {
    let DeValue::Array(list) = item.get_ref() else {
        reader.wrong_type(item, what, "three numbers [x, y, z]");
        return None;
    };
    if list.len() != 3 {
        reader.report(
            Problem::at(
                item.span(),
                format!("{what} must be three numbers, not {}", list.len()),
            )
            .allowed("three numbers [x, y, z]"),
        );
        return None;
    }
    let mut numbers = [0.0; 3];
    let mut complete = true;
    for (number, item) in numbers.iter_mut().zip(list.iter()) {
        match reader.real(item, &format!("each of {what}")) {
            Some(x) if x.abs() <= FARTHEST => *number = x,
            Some(x) => {
                reader.report(
                    Problem::at(item.span(), format!("{what} is too far away: {x:e}"))
                        .allowed(format!("numbers up to {FARTHEST:e}")),
                );
                complete = false;
            }
            None => complete = false,
        }
    }
    complete.then(|| Vector::from(numbers))
}

fn flag(reader: &mut Reader, item: &Item<'_>, what: &str) -> Option<bool> {
    let flag = item.get_ref().as_bool();
    if flag.is_none() {
        reader.wrong_type(item, what, "true or false");
    }
    flag
}

/// The one key of a table that names a kind, of those in `kinds`.
fn kind<'d>(
    reader: &mut Reader,
    table: &mut Table<'d>,
    what: &str,
    kinds: &[&str],
) -> Option<(String, Table<'d>, Span)> {
    let present: Vec<String> = table
        .left()
        .iter()
        .map(|entry| entry.key().to_owned())
        .filter(|key| kinds.contains(&key.as_str()))
        .collect();
    match &present[..] {
        [one] => {
            let entry = table.take(one)?;
            let inner = reader.table(entry.item, &format!("`{one}`"))?;
            Some((one.clone(), inner, entry.item.span()))
        }
        [] => {
            let misspelt = table
                .left()
                .iter()
                .any(|entry| nearest(entry.key(), kinds.iter().copied()).is_some());
            if !misspelt {
                let kinds = listed(kinds);
                reader.report(
                    Problem::at(table.span.clone(), format!("{what} needs one of {kinds}"))
                        .doubtful(),
                );
            }
            None
        }
        [first, second, ..] => {
            let entry = table.take(second)?;
            reader.report(Problem::at(
                entry.key_span(),
                format!(
                    "{what} is both `{first}` and `{second}`, {}",
                    found(entry.item)
                ),
            ));
            table.take(first);
            None
        }
    }
}
