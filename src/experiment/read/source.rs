//! `source`: known densities, a data file, or photons in a scene.

use super::data::{Data, data};
use super::node::{Entry, Item, Reader, found};
use super::problem::{Problem, Span, printable};
use super::scene;
use super::value;
use crate::density::{self, Truth};
use crate::experiment::{PathSpec, SourceSpec};
use crate::light::scene::Scene;
use crate::parameter::{Absent, Kind, Parameter, Values, listed, nearest};
use crate::sample::Clustered;
use std::path::Path;
use std::sync::Arc;
use toml::de::DeValue;

/// A source with what the checks of the rest need to know of it.
pub(super) struct Read {
    pub(super) spec: SourceSpec,
    pub(super) truth: Option<Truth>,
    /// The data of a file.
    pub(super) sample: Option<Data>,
    /// Where photons walk.
    pub(super) scene: Option<Arc<Scene>>,
    pub(super) span: Span,
}

/// What a density may be told beside its kind.
pub(crate) const NAME: &[Parameter] = &[Parameter::optional(
    "name",
    Kind::Text,
    Absent::Unset,
    "what it is called in tables and claims; its kind by default",
)];

/// `paths`.
pub(crate) const PATHS: &[Parameter] = &[
    Parameter::required(
        "hits",
        Kind::Count {
            least: 1,
            most: 1_000_000,
        },
        "how many points each path leaves",
    ),
    Parameter::required(
        "spread",
        Kind::Positive,
        "the deviation of each point from the centre of its path",
    ),
];

/// What `paths` means.
pub(crate) const PATHS_HELP: &str = "points come in paths, several near a centre that is drawn from the density; for mixtures of normals on a line, whose components become wider by that";

/// What a data file may be told, but for its walls.
pub(crate) const FILE: &[Parameter] = &[
    Parameter::required(
        "file",
        Kind::Text,
        "the data, CSV or NumPy's .npy; a relative path starts at the folder of the experiment",
    ),
    Parameter::required(
        "columns",
        Kind::Texts,
        "the column of the data, or the two columns of data in the plane: names in the header, or numbers from 1",
    ),
    Parameter::optional(
        "weight",
        Kind::Text,
        Absent::Unset,
        "the column of weights; equal weights by default",
    ),
    Parameter::optional(
        "name",
        Kind::Text,
        Absent::Unset,
        "what it is called in tables and claims; the stem of the file's name by default",
    ),
];

/// What `domain` means.
pub(crate) const DOMAIN: &str = "where the data can lie: [low, high], infinite where there is no wall; in the plane [[low, high], [low, high]] or { vertices = [[x, y], ..] }; without walls by default";

/// The keys of which `source` has one.
pub(super) const KINDS: [&str; 3] = ["density", "file", "scene"];

const FORMS: &str = "{ density = \"NAME\" }, { density = { KIND = { .. } } }, { density = [ .. ] }, { file = \"PATH\", columns = [\"NAME\"] } or { scene = \"PATH\", surface = \"NAME\" }";

/// Reads `source`; what is wrong has been reported when the list is shorter than the file's.
pub(super) fn sources(reader: &mut Reader, entry: Entry<'_>, folder: &Path) -> Option<Vec<Read>> {
    if let DeValue::String(text) = entry.item.get_ref() {
        let help = if density::names().any(|name| name == text) {
            format!("write source = {{ density = \"{text}\" }}")
        } else {
            "name a density, a file or a scene".to_owned()
        };
        reader.report(
            Problem::at(entry.item.span(), "`source` must be a table, not a text")
                .help(help)
                .allowed(FORMS),
        );
        return None;
    }
    let mut table = reader.table(entry.item, "`source`")?;
    let mut given: Vec<Entry<'_>> = KINDS.iter().filter_map(|key| table.take(key)).collect();
    given.sort_by_key(|entry| entry.key_span().start);
    match given[..] {
        [entry] => match entry.key() {
            "density" => {
                let paths = table.take("paths");
                let unknown = table.finish(reader, &["density", "paths"]);
                let mut read = densities(reader, entry.item)?;
                if let Some(paths) = paths {
                    cluster(reader, paths, &mut read)?;
                }
                (!unknown).then_some(read)
            }
            "file" => data(reader, entry, table, folder).map(|read| vec![read]),
            _ => scene::scenes(reader, entry, table, folder),
        },
        [first, second, ..] => {
            let (first, second_key) = (first.key(), second.key());
            reader.report(
                Problem::at(second.key_span(), format!("`source` is a {first} already"))
                    .allowed(FORMS)
                    .help(format!(
                        "one experiment for the {first}, one for the {second_key}"
                    )),
            );
            None
        }
        [] => {
            let span = table.span.clone();
            if !table.finish(reader, &KINDS) {
                reader.report(
                    Problem::at(
                        span,
                        "`source` names neither a density nor a file nor a scene",
                    )
                    .allowed(FORMS),
                );
            }
            None
        }
    }
}

/// Makes points come in paths.
fn cluster(reader: &mut Reader, entry: Entry<'_>, sources: &mut [Read]) -> Option<()> {
    let mut table = reader.table(entry.item, "`paths`")?;
    table.span = entry.key_span();
    let read = value::values(reader, PATHS, table, "`paths`");
    if !read.complete {
        return None;
    }
    let told = PathSpec {
        hits: read.values.count("hits")? as usize,
        spread: read.values.number("spread")?,
    };
    for source in sources {
        let line = source.truth.clone().and_then(Truth::line);
        let centres = line.as_ref().and_then(|line| line.normal_components());
        let clustered = centres.map(|centres| Clustered::new(centres, told.hits, told.spread));
        let what = match clustered {
            Some(Ok(clustered)) => {
                source.truth = Some(Truth::Line(Arc::new(clustered.density().clone())));
                if let SourceSpec::Density { paths, .. } = &mut source.spec {
                    *paths = Some(told);
                }
                continue;
            }
            Some(Err(error)) => error.to_string(),
            None => format!(
                "\"{}\" is not a mixture of normals on a line, which `paths` needs",
                printable(source.spec.name())
            ),
        };
        reader.report(Problem::at(entry.key_span(), what));
        return None;
    }
    Some(())
}

fn densities(reader: &mut Reader, item: &Item<'_>) -> Option<Vec<Read>> {
    let DeValue::Array(list) = item.get_ref() else {
        return Some(vec![one(reader, item)?]);
    };
    if list.is_empty() {
        reader.report(
            Problem::at(item.span(), "`density` is an empty list").allowed("at least one density"),
        );
        return None;
    }
    let read: Vec<Option<Read>> = list.iter().map(|item| one(reader, item)).collect();
    let read: Vec<Read> = read.into_iter().collect::<Option<_>>()?;
    let mut sound = true;
    for (at, source) in read.iter().enumerate() {
        if read[..at]
            .iter()
            .any(|other| other.spec.name() == source.spec.name())
        {
            sound = false;
            reader.report(
                Problem::at(
                    source.span.clone(),
                    format!("there is a source \"{}\" already", source.spec.name()),
                )
                .help("tell them apart: { name = \"..\", KIND = { .. } }"),
            );
        }
    }
    let dimensions = |source: &Read| source.spec.dimensions();
    if let Some(other) = read[1..]
        .iter()
        .find(|other| dimensions(other) != dimensions(&read[0]))
    {
        sound = false;
        reader.report(
            Problem::at(
                other.span.clone(),
                format!(
                    "\"{}\" and \"{}\" are not both on a line or both in the plane",
                    read[0].spec.name(),
                    other.spec.name()
                ),
            )
            .help("give each an experiment of its own"),
        );
    }
    sound.then_some(read)
}

/// One density: a name, or `{ KIND = { parameters }, name = ".." }`.
pub(super) fn one(reader: &mut Reader, item: &Item<'_>) -> Option<Read> {
    match item.get_ref() {
        DeValue::String(text) => {
            let Some(entry) = density::entry(text) else {
                reader.report(unknown(text, item.span()));
                return None;
            };
            if !entry.stands_alone() {
                let needed: Vec<String> = entry
                    .parameters
                    .iter()
                    .map(|parameter| format!("{} = ..", parameter.name))
                    .collect();
                reader.report(
                    Problem::at(
                        item.span(),
                        format!("the density \"{text}\" needs parameters"),
                    )
                    .help(format!(
                        "write density = {{ {text} = {{ {} }} }}",
                        needed.join(", ")
                    )),
                );
                return None;
            }
            let values = Values::defaults(entry.parameters);
            build(reader, entry, text, values, |_| item.span(), item.span())
        }
        DeValue::Table(_) => {
            let mut table = reader.table(item, "`density`")?;
            let name = match table.take("name") {
                Some(entry) => Some(reader.name(entry.item, "the name of a source")?),
                None => None,
            };
            let span = table.span.clone();
            let left = table.left();
            if left.len() > 1 {
                reader.report(
                    Problem::at(left[1].key_span(), "one kind of density a table")
                        .help("several densities stand in a list: density = [{ .. }, { .. }]"),
                );
                return None;
            }
            let Some(&kind) = left.first() else {
                reader.report(
                    Problem::at(span, "this table names no kind of density")
                        .allowed(printed_names()),
                );
                return None;
            };
            let Some(entry) = density::entry(kind.key()) else {
                reader.report(unknown(kind.key(), kind.key_span()));
                return None;
            };
            let mut settings = reader.table(kind.item, &format!("`{}`", kind.key()))?;
            settings.span = kind.key_span();
            let read = value::values(
                reader,
                entry.parameters,
                settings,
                &format!("`{}`", kind.key()),
            );
            if !read.complete {
                return None;
            }
            let name = name.unwrap_or_else(|| kind.key().to_owned());
            let place = |parameter: &str| read.place(parameter);
            build(
                reader,
                entry,
                &name,
                read.values.clone(),
                place,
                item.span(),
            )
        }
        _ => {
            reader.report(
                Problem::at(
                    item.span(),
                    format!(
                        "a density must be a name or a table {{ KIND = {{ .. }} }}, not {}",
                        found(item)
                    ),
                )
                .allowed(FORMS),
            );
            None
        }
    }
}

fn unknown(name: &str, span: Span) -> Problem {
    Problem::at(span, format!("there is no density \"{}\"", printable(name)))
        .suggest(nearest(name, density::names()))
        .allowed(printed_names())
}

/// The densities, each by the name that is printed.
fn printed_names() -> String {
    let names: Vec<&str> = density::entries().map(|entry| entry.names[0]).collect();
    listed(&names)
}

fn build(
    reader: &mut Reader,
    entry: &'static density::Entry,
    name: &str,
    values: Values,
    place: impl Fn(&str) -> Span,
    span: Span,
) -> Option<Read> {
    match entry.build(&values) {
        Ok(truth) => Some(Read {
            spec: SourceSpec::Density {
                name: name.to_owned(),
                kind: entry.names[0].to_owned(),
                values,
                paths: None,
            },
            truth: Some(truth),
            sample: None,
            scene: None,
            span,
        }),
        Err(error) => {
            reader.report(Problem::at(place(error.parameter), error.what));
            None
        }
    }
}
