//! `source = { file = .. }`: data of one axis or two.

use super::node::{Entry, Item, Reader, Table};
use super::problem::{Problem, Span};
use super::source::{FILE, Read};
use super::value;
use crate::experiment::{Limits, SourceSpec};
use crate::sample::Sample;
use crate::sample::file::{self, Column, Request};
use crate::space::Polygon;
use std::path::Path;
use toml::de::DeValue;

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

/// `{ file = .., columns = [..], weight = .., domain = [low, high] }`; `table` holds what comes beside `file`.
pub(super) fn data(
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
            let opened = opened(&path, &names, weight.as_deref(), limits.as_ref());
            let at = |fault| match fault {
                Fault::Limits(what) => (domain_span, what),
                Fault::Data(what) => (spans[0].clone(), what),
            };
            Ok((hash, opened.map_err(at)?))
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
            scene: None,
            span: place,
        }),
        Err((span, what)) => {
            reader.report(Problem::at(span, what));
            None
        }
    }
}

/// What keeps a file from being data.
enum Fault {
    Limits(String),
    Data(String),
}

/// The data in the columns `names` of a file.
fn opened(
    path: &Path,
    names: &[String],
    weight: Option<&str>,
    limits: Option<&Limits>,
) -> Result<Data, Fault> {
    let failed = |error: file::FileError| Fault::Data(error.to_string());
    if let [x] = names {
        let request = Request {
            columns: [Column::Named(x)],
            weight,
            domain: Limits::domain(limits).map_err(Fault::Limits)?,
        };
        return file::read(path, &request).map(Data::Line).map_err(failed);
    }
    let request = Request {
        columns: [0, 1].map(|axis: usize| Column::Named(&names[axis])),
        weight,
        domain: Limits::domain(limits).map_err(Fault::Limits)?,
    };
    file::read(path, &request).map(Data::Plane).map_err(failed)
}

/// `[low, high]` on a line; `[[low, high], [low, high]]` or `{ vertices = [[x, y], ..] }` in the plane.
fn domain(reader: &mut Reader, item: &Item<'_>, axes: usize) -> Option<Limits> {
    const EXPECTED: &str =
        "[[low, high], [low, high]], the limits of each axis, or { vertices = [[x, y], ..] }";
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
pub(super) fn hash(path: &Path) -> std::io::Result<String> {
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
