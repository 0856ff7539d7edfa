//! `source`: known densities or a data file.

use super::node::{Entry, Item, Reader, Table, found};
use super::problem::{Problem, Span, printable};
use super::value;
use crate::density::{self, Truth};
use crate::experiment::{Limits, SourceSpec};
use crate::parameter::{Absent, Kind, Parameter, Values, listed, nearest};
use crate::sample::Sample;
use crate::sample::file::{self, Column, Request};
use crate::space::Polygon;
use std::path::Path;
use toml::de::DeValue;

/// A source with what the checks of the rest need to know of it.
pub(super) struct Read {
    pub(super) spec: SourceSpec,
    pub(super) truth: Option<Truth>,
    /// The data of a file.
    pub(super) sample: Option<Data>,
    pub(super) span: Span,
}

/// The data of a file.
pub(super) enum Data {
    Line(Sample<1>),
    Plane(Sample<2>),
}

/// Data of `D` dimensions.
pub(super) trait Holds<const D: usize> {
    /// The data, if they have as many.
    fn sample(&self) -> Option<&Sample<D>>;
}

impl Holds<1> for Data {
    fn sample(&self) -> Option<&Sample<1>> {
        match self {
            Self::Line(sample) => Some(sample),
            Self::Plane(_) => None,
        }
    }
}

impl Holds<2> for Data {
    fn sample(&self) -> Option<&Sample<2>> {
        match self {
            Self::Plane(sample) => Some(sample),
            Self::Line(_) => None,
        }
    }
}

/// What a density may be told beside its kind.
pub(crate) const NAME: &[Parameter] = &[Parameter::optional(
    "name",
    Kind::Text,
    Absent::Unset,
    "what it is called in tables and claims; its kind by default",
)];

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

const FORMS: &str = "{ density = \"NAME\" }, { density = { KIND = { .. } } }, { density = [ .. ] } or { file = \"PATH\", columns = [\"NAME\"] }";

/// Reads `source`; what is wrong has been reported when the list is shorter than the file's.
pub(super) fn sources(reader: &mut Reader, entry: Entry<'_>, folder: &Path) -> Option<Vec<Read>> {
    if let DeValue::String(text) = entry.item.get_ref() {
        let help = if density::names().any(|name| name == text) {
            format!("write source = {{ density = \"{text}\" }}")
        } else {
            "name a density or a file".to_owned()
        };
        reader.report(
            Problem::at(entry.item.span(), "`source` must be a table, not a text")
                .help(help)
                .allowed(FORMS),
        );
        return None;
    }
    let mut table = reader.table(entry.item, "`source`")?;
    let density = table.take("density");
    let file = table.take("file");
    match (density, file) {
        (Some(entry), None) => {
            let unknown = table.finish(reader, &["density"]);
            let read = densities(reader, entry.item)?;
            (!unknown).then_some(read)
        }
        (None, Some(entry)) => data(reader, entry, table, folder).map(|read| vec![read]),
        (Some(_), Some(file)) => {
            reader.report(
                Problem::at(file.key_span(), "`source` is a density already")
                    .allowed(FORMS)
                    .help("one experiment for the density, one for the file"),
            );
            None
        }
        (None, None) => {
            let span = table.span.clone();
            if !table.finish(reader, &["density", "file"]) {
                reader.report(
                    Problem::at(span, "`source` names neither a density nor a file").allowed(FORMS),
                );
            }
            None
        }
    }
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
            },
            truth: Some(truth),
            sample: None,
            span,
        }),
        Err(error) => {
            reader.report(Problem::at(place(error.parameter), error.what));
            None
        }
    }
}

/// `{ file = .., columns = [..], weight = .., domain = [low, high] }`; `table` holds what comes beside `file`.
fn data(
    reader: &mut Reader,
    entry: Entry<'_>,
    mut table: Table<'_>,
    folder: &Path,
) -> Option<Read> {
    let path = reader.text(entry.item, "`file`").map(str::to_owned);
    let name = table
        .take("name")
        .map(|entry| reader.name(entry.item, "the name of a source"));
    let columns = table.need(reader, "columns", "for instance: columns = [\"minutes\"]");
    let columns = columns.and_then(|entry| {
        let list = value::texts(reader, entry.item, "`columns`")?;
        if (1..=2).contains(&list.len()) {
            return Some(list);
        }
        reader.report(
            Problem::at(
                entry.item.span(),
                format!("{} columns: data are on a line or in the plane", list.len()),
            )
            .allowed("one column or two"),
        );
        None
    });
    let weight = match table.take("weight") {
        Some(entry) => {
            let text = reader.text(entry.item, "`weight`").map(str::to_owned);
            Some((text?, entry.item.span()))
        }
        None => None,
    };
    let allowed: Vec<&str> = FILE
        .iter()
        .map(|parameter| parameter.name)
        .chain(["domain"])
        .collect();
    let domain_entry = table.take("domain");
    let domain = match domain_entry {
        Some(entry) => {
            let axes = columns.as_ref().map_or(1, Vec::len);
            Some((domain(reader, entry.item, axes)?, entry.item.span()))
        }
        None => None,
    };
    if table.finish(reader, &allowed) {
        return None;
    }
    let (path, columns) = (folder.join(path?), columns?);
    let name = match name {
        Some(name) => name?,
        None => path.file_stem()?.to_string_lossy().into_owned(),
    };
    let (names, spans): (Vec<String>, Vec<Span>) = columns.into_iter().unzip();
    let weight = weight.map(|(text, _)| text);
    let place = entry.item.span();
    let (limits, domain_span) =
        domain.map_or((None, place.clone()), |(limits, span)| (Some(limits), span));
    let read = hash(&path)
        .map_err(|error| {
            (
                place.clone(),
                format!("cannot read {}: {error}", path.display()),
            )
        })
        .and_then(|hash| {
            let limits = limits.as_ref();
            let within = |what| (domain_span, what);
            let data = match &names[..] {
                [x] => file::read(
                    &path,
                    &Request {
                        columns: [Column::Named(x)],
                        weight: weight.as_deref(),
                        domain: Limits::domain(limits).map_err(within)?,
                    },
                )
                .map(Data::Line),
                names => file::read(
                    &path,
                    &Request {
                        columns: [0, 1].map(|axis: usize| Column::Named(&names[axis])),
                        weight: weight.as_deref(),
                        domain: Limits::domain(limits).map_err(within)?,
                    },
                )
                .map(Data::Plane),
            };
            match data {
                Ok(data) => Ok((hash, data)),
                Err(error) => Err((spans[0].clone(), error.to_string())),
            }
        });
    match read {
        Ok((hash, sample)) => Some(Read {
            spec: SourceSpec::File {
                name,
                path,
                columns: names,
                weight,
                domain: limits,
                hash,
            },
            truth: None,
            sample: Some(sample),
            span: place,
        }),
        Err((span, what)) => {
            reader.report(Problem::at(span, what));
            None
        }
    }
}

/// `[low, high]` on a line; `[[low, high], [low, high]]` or `{ vertices = [[x, y], ..] }` in the plane.
fn domain(reader: &mut Reader, item: &Item<'_>, axes: usize) -> Option<Limits> {
    if axes == 1 {
        return limits(reader, item).map(|limits| Limits::Box(vec![limits]));
    }
    if item.get_ref().is_table() {
        let mut table = reader.table(item, "`domain`")?;
        let entry = table.need(
            reader,
            "vertices",
            "for instance: { vertices = [[0, 0], [1, 0], [0, 1]] }",
        )?;
        if table.finish(reader, &["vertices"]) {
            return None;
        }
        let DeValue::Array(list) = entry.item.get_ref() else {
            reader.wrong_type(entry.item, "`vertices`", "a list of [x, y]");
            return None;
        };
        let corner = |item: &Item<'_>| {
            pair(
                reader,
                item,
                "each of `vertices`",
                "two finite numbers [x, y]",
            )
        };
        let vertices: Vec<Option<[f64; 2]>> = list.iter().map(corner).collect();
        let vertices: Vec<[f64; 2]> = vertices.into_iter().collect::<Option<_>>()?;
        if let Err(error) = Polygon::new(vertices.clone()) {
            reader.report(Problem::at(entry.item.span(), error.to_string()));
            return None;
        }
        return Some(Limits::Polygon { vertices });
    }
    const EXPECTED: &str =
        "[[low, high], [low, high]], the limits of each axis, or { vertices = [[x, y], ..] }";
    let DeValue::Array(list) = item.get_ref() else {
        reader.wrong_type(item, "`domain`", EXPECTED);
        return None;
    };
    if list.len() != axes || list.iter().any(|item| !item.get_ref().is_array()) {
        reader.report(
            Problem::at(item.span(), "`domain` must give the limits of both axes")
                .allowed(EXPECTED),
        );
        return None;
    }
    let both: Vec<Option<[f64; 2]>> = list.iter().map(|item| limits(reader, item)).collect();
    both.into_iter().collect::<Option<_>>().map(Limits::Box)
}

/// The limits of one axis.
fn limits(reader: &mut Reader, item: &Item<'_>) -> Option<[f64; 2]> {
    const EXPECTED: &str = "[low, high] with low < high, -inf and inf where there is no wall";
    let [low, high] = pair(reader, item, "`domain`", EXPECTED)?;
    if low.is_nan() || high.is_nan() || low >= high {
        reader.report(
            Problem::at(
                item.span(),
                format!("`domain` must have low < high; it has {low} and {high}"),
            )
            .allowed(EXPECTED),
        );
        return None;
    }
    Some([low, high])
}

fn pair(reader: &mut Reader, item: &Item<'_>, what: &str, expected: &str) -> Option<[f64; 2]> {
    let DeValue::Array(list) = item.get_ref() else {
        reader.wrong_type(item, what, expected);
        return None;
    };
    let [low, high] = &list[..] else {
        reader.report(
            Problem::at(
                item.span(),
                format!("{what} must be two numbers, not {}", list.len()),
            )
            .allowed(expected),
        );
        return None;
    };
    let low = reader.number(low, &format!("the lower end of {what}"), "a number or -inf");
    let high = reader.number(high, &format!("the upper end of {what}"), "a number or inf");
    Some([low?.real(), high?.real()])
}

/// The BLAKE3 hash of the file's bytes.
fn hash(path: &Path) -> std::io::Result<String> {
    let data = std::fs::metadata(path)?;
    if !data.is_file() {
        // A device may never end.
        let what = if data.is_dir() {
            "it is a folder"
        } else {
            "it is not a regular file"
        };
        return Err(std::io::Error::other(what));
    }
    let mut hasher = blake3::Hasher::new();
    std::io::copy(&mut std::fs::File::open(path)?, &mut hasher)?;
    Ok(hasher.finalize().to_hex().to_string())
}
