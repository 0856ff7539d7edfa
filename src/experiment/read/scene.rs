//! `source = { scene = .., surface = .. }`: photon hits on surfaces of a scene.

use super::data::hash;
use super::source::Read;
use crate::document::Problem;
use crate::document::Span;
use crate::document::node::{Entry, Item, Reader, Table, found};
use crate::document::problem::printable;
use crate::document::value;
use crate::experiment::SourceSpec;
use crate::light::photons::{Photons, WALK};
use crate::light::reference::Reference;
use crate::light::scene::{Scene, read};
use crate::parameter::{Kind, Parameter, Values, listed, nearest};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::de::DeValue;

/// What stands beside `scene`.
pub(crate) const SURFACE: Parameter = Parameter::required(
    "surface",
    Kind::Texts,
    "the surface whose hits are the sample, by its name in the scene; a list makes a source of each",
);
/// The file of a scene, where a table tells more.
pub(crate) const FILE: Parameter = Parameter::required(
    "file",
    Kind::Text,
    "the scene; a relative path starts at the folder of the experiment",
);

/// One walk of photons in one scene.
struct Walk {
    name: String,
    path: PathBuf,
    scene: Arc<Scene>,
    hash: String,
    values: Values,
    /// Where each given value stands.
    spans: BTreeMap<&'static str, Span>,
    span: Span,
}

/// `{ scene = "PATH" | { file = "PATH", .. } | [ .. ], surface = .. }`; `table` holds what comes beside `scene`.
pub(super) fn scenes(
    reader: &mut Reader,
    entry: Entry<'_>,
    mut table: Table<'_>,
    folder: &Path,
) -> Option<Vec<Read>> {
    let surfaces = table.need(reader, "surface", "for instance: surface = \"floor\"");
    let surfaces = surfaces.and_then(|entry| value::texts(reader, entry.item, "`surface`"));
    let unknown = table.finish(reader, &["scene", "surface"]);
    let items: Vec<&Item<'_>> = match entry.item.get_ref() {
        DeValue::Array(list) if list.is_empty() => {
            reader.report(
                Problem::at(entry.item.span(), "`scene` is an empty list")
                    .allowed("at least one scene"),
            );
            return None;
        }
        DeValue::Array(list) => list.iter().collect(),
        _ => vec![entry.item],
    };
    let walks: Vec<Option<Walk>> = items
        .into_iter()
        .map(|item| walk(reader, item, folder))
        .collect();
    let walks: Vec<Walk> = walks.into_iter().collect::<Option<_>>()?;
    let surfaces = surfaces?;
    let mut sources: Vec<Read> = Vec::new();
    let mut sound = !unknown;
    for walk in &walks {
        let reference = Arc::new(Reference::new(walk.scene.clone()));
        for (surface, span) in &surfaces {
            if !known(reader, &walk.scene, surface, span) {
                sound = false;
                continue;
            }
            let position = walk
                .scene
                .surface(surface)
                .map_or(0, |(position, _)| position);
            if let Err(error) = Photons::new(reference.clone(), position, &walk.values) {
                sound = false;
                let place = walk.spans.get(error.parameter).unwrap_or(&walk.span);
                reader.report(Problem::at(place.clone(), error.what));
                continue;
            }
            let name = match (walks.len() > 1, surfaces.len() > 1) {
                (true, true) => format!("{}, {surface}", walk.name),
                (true, false) => walk.name.clone(),
                (false, _) => surface.clone(),
            };
            if sources.iter().any(|other| other.spec.name() == name) {
                sound = false;
                reader.report(
                    Problem::at(
                        walk.span.clone(),
                        format!("there is a source \"{}\" already", printable(&name)),
                    )
                    .help("tell them apart: { file = \"..\", name = \"..\" }"),
                );
                continue;
            }
            sources.push(Read {
                spec: SourceSpec::Scene {
                    name,
                    path: walk.path.clone(),
                    surface: surface.clone(),
                    values: walk.values.clone(),
                    hash: walk.hash.clone(),
                },
                truth: None,
                sample: None,
                scene: Some(walk.scene.clone()),
                span: walk.span.clone(),
            });
        }
    }
    sound.then_some(sources)
}

/// Whether the scene has the surface, and hits on it have coordinates; reported if not.
fn known(reader: &mut Reader, scene: &Scene, surface: &str, span: &Span) -> bool {
    match scene.surface(surface) {
        Some((_, found)) if found.domain().is_some() => return true,
        Some(_) => reader.report(
            Problem::at(
                span.clone(),
                format!(
                    "the surface \"{}\" is a mesh: its points have no pair of coordinates",
                    printable(surface)
                ),
            )
            .help("name a quad, a triangle or a sphere"),
        ),
        None => {
            let names: Vec<&str> = scene.surfaces().iter().map(|s| s.name.as_str()).collect();
            reader.report(
                Problem::at(
                    span.clone(),
                    format!("the scene has no surface \"{}\"", printable(surface)),
                )
                .suggest(nearest(surface, names.iter().copied()))
                .allowed(listed(&names)),
            );
        }
    }
    false
}

/// `"PATH"`, or `{ file = "PATH", name = .., .. }` with what photons are told.
fn walk(reader: &mut Reader, item: &Item<'_>, folder: &Path) -> Option<Walk> {
    let (file, span, name, values, spans) = match item.get_ref() {
        DeValue::String(text) => (
            text.to_string(),
            item.span(),
            None,
            Values::defaults(WALK),
            BTreeMap::new(),
        ),
        DeValue::Table(_) => {
            let mut table = reader.table(item, "a scene")?;
            let file = table.need(reader, "file", FILE.help);
            let name = match table.take("name") {
                Some(entry) => Some(reader.name(entry.item, "the name of a source")?),
                None => None,
            };
            let read = value::values(reader, WALK, table, "a scene");
            let entry = file?;
            let file = reader.text(entry.item, "`file`")?.to_owned();
            if !read.complete {
                return None;
            }
            (file, entry.item.span(), name, read.values, read.spans)
        }
        _ => {
            reader.report(
                Problem::at(
                    item.span(),
                    format!(
                        "a scene must be the path of its file or a table, not {}",
                        found(item)
                    ),
                )
                .allowed("\"PATH\", or { file = \"PATH\", .. }"),
            );
            return None;
        }
    };
    let path = folder.join(file);
    let opened = hash(&path)
        .map_err(|error| format!("cannot read {}: {error}", path.display()))
        .and_then(|hash| match read::scene(&path) {
            Ok(scene) => Ok((Arc::new(scene), hash)),
            Err(problems) => Err(first(&problems)),
        });
    match opened {
        Ok((scene, hash)) => Some(Walk {
            name: name.unwrap_or_else(|| {
                path.file_stem()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned()
            }),
            path,
            scene,
            hash,
            values,
            spans,
            span,
        }),
        Err(what) => {
            reader.report(Problem::at(span, what));
            None
        }
    }
}

/// The first problem of another file in a sentence, with its place there.
fn first(problems: &crate::document::Problems) -> String {
    let list = problems.list();
    let Some(problem) = list.first() else {
        return problems.to_string();
    };
    let more = match list.len() {
        0 | 1 => String::new(),
        more => format!(" (and {} more)", more - 1),
    };
    format!(
        "{}:{}:{}: {}{more}",
        problems.origin(),
        problem.line,
        problem.column,
        problem.message
    )
}
