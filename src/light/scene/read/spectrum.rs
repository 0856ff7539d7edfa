//! Numbers for colours: one, three, or a column of a file.

use crate::document::node::{Item, Reader};
use crate::document::problem::{Problem, Span};
use crate::light::spectrum::{Spectrum, Table};
use crate::sample::file::{Column, read_points};
use std::path::{Path, PathBuf};
use toml::de::DeValue;

/// How the colours of a scene have been given so far.
pub(super) struct Palette {
    folder: PathBuf,
    channels: Option<Span>,
    tables: Option<Span>,
}

impl Palette {
    pub(super) fn new(folder: PathBuf) -> Self {
        Self {
            folder,
            channels: None,
            tables: None,
        }
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(super) fn has_tables(&self) -> bool {
        self.tables.is_some()
    }

    /// A number, three, or `{ file = .., column = .. }`, from 0 to `most`.
    pub(super) fn spectrum(
        &mut self,
        reader: &mut Reader,
        item: &Item<'_>,
        what: &str,
        most: f64,
    ) -> Option<Spectrum> {
        let spectrum = match item.get_ref() {
            DeValue::Array(list) => {
                if list.len() != 3 {
                    reader.report(
                        Problem::at(
                            item.span(),
                            format!("{what} has {} numbers", list.len()),
                        )
                        .allowed("a number, three numbers [red, green, blue], or { file = .., column = .. }"),
                    );
                    return None;
                }
                let mut values = [0.0; 3];
                for (value, item) in values.iter_mut().zip(list.iter()) {
                    *value = bounded(reader, item, &format!("each of {what}"), most)?;
                }
                self.channels.get_or_insert(item.span());
                Spectrum::Rgb(values)
            }
            DeValue::Table(_) => {
                let table = self.table(reader, item, what, most)?;
                self.tables.get_or_insert(item.span());
                Spectrum::Table(table)
            }
            _ => Spectrum::Flat(bounded(reader, item, what, most)?),
        };
        if self.channels.is_some() && self.tables.is_some() {
            reader.report(
                Problem::at(
                    item.span(),
                    format!("{what} is given in the other way than colours before it"),
                )
                .help("a scene has either three channels throughout or spectra throughout; plain numbers go with both"),
            );
            return None;
        }
        Some(spectrum)
    }

    fn table(&self, reader: &mut Reader, item: &Item<'_>, what: &str, most: f64) -> Option<Table> {
        let mut table = reader.table(item, what)?;
        let file = table
            .need(reader, "file", "a CSV file with the column wavelength_nm")
            .and_then(|entry| Some((reader.text(entry.item, "`file`")?, entry.item.span())));
        let column = table
            .need(reader, "column", "the column with the values")
            .and_then(|entry| reader.text(entry.item, "`column`"));
        if table.finish(reader, &["file", "column"]) {
            return None;
        }
        let ((file, place), column) = (file?, column?);
        let columns = [Column::Named("wavelength_nm"), Column::Named(column)];
        let read = read_points(&self.folder.join(file), columns)
            .map_err(|error| error.to_string())
            .and_then(|rows| Table::new(rows).map_err(|error| format!("{file}: {error}")));
        let read = read.and_then(|table| {
            let largest = table.largest();
            if largest > most {
                return Err(format!(
                    "{file}: `{column}` reaches {largest}; {what} is at most {most}"
                ));
            }
            Ok(table)
        });
        read.map_err(|what| reader.report(Problem::at(place, what)))
            .ok()
    }
}

fn bounded(reader: &mut Reader, item: &Item<'_>, what: &str, most: f64) -> Option<f64> {
    let allowed = format!("a number from 0 to {most}");
    let x = reader.number(item, what, &allowed)?.real();
    if x >= 0.0 && x <= most {
        return Some(x);
    }
    let mut problem =
        Problem::at(item.span(), format!("{what} must be {allowed}, not {x}")).allowed(allowed);
    if most <= 1.0 && x > 1.0 {
        problem = problem.help("no surface returns more light than arrives");
    }
    reader.report(problem);
    None
}
