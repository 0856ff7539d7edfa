//! `quad`, `triangle`, `sphere` and `mesh`.

use super::{FARTHEST, flag, kind, vector};
use crate::document::node::{Item, Reader, Table};
use crate::document::problem::{Problem, Span};
use crate::light::scene::object;
use crate::light::scene::shape::{Mesh, Planar, PlanarError, Shape, Sphere};
use crate::light::vector::Vector;
use std::path::Path;
use toml::de::DeValue;

const KINDS: [&str; 4] = ["quad", "triangle", "sphere", "mesh"];

/// What a surface may be told.
pub(super) const SURFACE_KEYS: [&str; 8] = [
    "name", "material", "emission", "facing", "quad", "triangle", "sphere", "mesh",
];

/// The shape that the surface `table` has.
pub(super) fn shape(reader: &mut Reader, table: &mut Table<'_>, folder: &Path) -> Option<Shape> {
    let facing = match table.take("facing") {
        Some(entry) => Some((
            vector(reader, entry.item, "`facing`")?,
            entry.item.span(),
            entry.key_span(),
        )),
        None => None,
    };
    let (name, inner, span) = kind(reader, table, "a surface", &KINDS)?;
    if let (Some((.., key)), "sphere" | "mesh") = (&facing, name.as_str()) {
        let help = if name == "sphere" {
            "a sphere has `inward = true` for that"
        } else {
            "the front of a triangle is where its corners run counter-clockwise"
        };
        reader.report(Problem::at(key.clone(), format!("a {name} takes no `facing`")).help(help));
        return None;
    }
    match name.as_str() {
        "sphere" => sphere(reader, inner, span),
        "mesh" => mesh(reader, inner, span, folder),
        _ => {
            let corners = if name == "quad" {
                quad(reader, inner)?
            } else {
                triangle(reader, inner)?
            };
            let (direction, facing_span) = match facing {
                Some((direction, span, _)) => (Some(direction), span),
                None => (None, span.clone()),
            };
            if direction.is_some_and(|direction| direction.norm() <= 0.0) {
                reader.report(Problem::at(facing_span, "`facing` is 0: it points nowhere"));
                return None;
            }
            match Planar::new(&corners, direction) {
                Ok(planar) => Some(Shape::Planar(planar)),
                Err(error) => {
                    let place = if error == PlanarError::Facing {
                        facing_span
                    } else {
                        span
                    };
                    reader.report(Problem::at(place, error.to_string()));
                    None
                }
            }
        }
    }
}

fn quad(reader: &mut Reader, mut table: Table<'_>) -> Option<Vec<Vector>> {
    const EDGES: [&str; 3] = ["origin", "u", "v"];
    if table.left().iter().any(|entry| entry.key() == "corners") {
        return corners(reader, table, 4);
    }
    let read = EDGES.map(|key| {
        table
            .need(reader, key, "or give the four corners: corners = [..]")
            .and_then(|entry| vector(reader, entry.item, &format!("`{key}`")))
    });
    if table.finish(reader, &["origin", "u", "v", "corners"]) {
        return None;
    }
    let [origin, u, v] = read;
    let (origin, u, v) = (origin?, u?, v?);
    Some(vec![origin, origin + u, origin + u + v, origin + v])
}

fn triangle(reader: &mut Reader, table: Table<'_>) -> Option<Vec<Vector>> {
    corners(reader, table, 3)
}

fn corners(reader: &mut Reader, mut table: Table<'_>, count: usize) -> Option<Vec<Vector>> {
    let allowed = format!("a list of {count} corners [x, y, z]");
    let entry = table.need(reader, "corners", allowed.clone());
    if table.finish(reader, &["corners"]) {
        return None;
    }
    let item = entry?.item;
    let DeValue::Array(list) = item.get_ref() else {
        reader.wrong_type(item, "`corners`", &allowed);
        return None;
    };
    if list.len() != count {
        reader.report(
            Problem::at(item.span(), format!("{} corners, not {count}", list.len()))
                .allowed(allowed),
        );
        return None;
    }
    let read: Vec<Option<Vector>> = list
        .iter()
        .map(|corner| vector(reader, corner, "a corner"))
        .collect();
    read.into_iter().collect()
}

fn positive(reader: &mut Reader, item: &Item<'_>, what: &str) -> Option<f64> {
    let allowed = format!("a number above 0, at most {FARTHEST:e}");
    let x = reader.number(item, what, &allowed)?.real();
    if x > 0.0 && x <= FARTHEST {
        return Some(x);
    }
    reader.report(
        Problem::at(item.span(), format!("{what} must be {allowed}, not {x}")).allowed(allowed),
    );
    None
}

fn sphere(reader: &mut Reader, mut table: Table<'_>, span: Span) -> Option<Shape> {
    let centre = table
        .need(reader, "centre", "three numbers [x, y, z]")
        .and_then(|entry| vector(reader, entry.item, "`centre`"));
    let radius = table
        .need(reader, "radius", "a number above 0")
        .and_then(|entry| positive(reader, entry.item, "`radius`"));
    let inward = match table.take("inward") {
        Some(entry) => flag(reader, entry.item, "`inward`"),
        None => Some(false),
    };
    if table.finish(reader, &["centre", "radius", "inward"]) {
        return None;
    }
    Sphere::new(centre?, radius?, inward?)
        .map(Shape::Sphere)
        .map_err(|error| reader.report(Problem::at(span, error.to_string())))
        .ok()
}

fn mesh(reader: &mut Reader, mut table: Table<'_>, span: Span, folder: &Path) -> Option<Shape> {
    let file = table
        .need(reader, "file", "a Wavefront OBJ file")
        .and_then(|entry| Some((reader.text(entry.item, "`file`")?, entry.item.span())));
    let scale = match table.take("scale") {
        Some(entry) => positive(reader, entry.item, "`scale`"),
        None => Some(1.0),
    };
    let shift = match table.take("move") {
        Some(entry) => vector(reader, entry.item, "`move`"),
        None => Some(Vector::zeros()),
    };
    if table.finish(reader, &["file", "scale", "move"]) {
        return None;
    }
    let ((file, place), scale, shift) = (file?, scale?, shift?);
    let mut triangles = object::triangles(&folder.join(file))
        .map_err(|what| reader.report(Problem::at(place, what)))
        .ok()?;
    for corner in triangles.iter_mut().flatten() {
        *corner = *corner * scale + shift;
    }
    Mesh::new(&triangles)
        .map(Shape::Mesh)
        .map_err(|error| reader.report(Problem::at(span, format!("{file}: {error}"))))
        .ok()
}
