//! Rows of text.

use super::columns::{Columns, Layout, quoted};
use super::{FileError, Rows};
use csv::{ByteRecord, ErrorKind, ReaderBuilder};
use std::cell::Cell;
use std::io::{self, BufRead, Read};
use std::rc::Rc;

/// No honest row of numbers is longer, and a quote that is never closed would otherwise read the whole file into one cell.
pub(super) const LONGEST_ROW: usize = 16 << 20;

/// Hands out one line at a time, so that whoever has just read a row knows on which line it ends (the positions of the `csv` crate are
/// off after blank lines), and stops inside a row that never ends.
struct Lines<R> {
    inner: R,
    progress: Rc<Progress>,
}

#[derive(Default)]
struct Progress {
    /// Lines begun.
    lines: Cell<u64>,
    inside_line: Cell<bool>,
    bytes_of_row: Cell<usize>,
    odd_quotes: Cell<bool>,
    ended: Cell<bool>,
}

impl<R: BufRead> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let ready = self.inner.fill_buf()?;
        let room = &ready[..ready.len().min(buffer.len())];
        let end = room.iter().position(|&b| b == b'\n');
        let some = end.map_or(room.len(), |end| end + 1);
        buffer[..some].copy_from_slice(&room[..some]);
        self.inner.consume(some);
        let progress = &self.progress;
        progress.ended.set(some == 0);
        if some > 0 {
            let begun = u64::from(!progress.inside_line.replace(end.is_none()));
            progress.lines.set(progress.lines.get() + begun);
        }
        for _ in buffer[..some].iter().filter(|&&b| b == b'"') {
            progress.odd_quotes.set(!progress.odd_quotes.get());
        }
        let bytes = progress.bytes_of_row.get() + some;
        progress.bytes_of_row.set(bytes);
        if bytes > LONGEST_ROW {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                "this row is longer than 16 MiB; is a quote not closed, or is this no table?",
            ));
        }
        Ok(some)
    }
}

pub(super) fn read<const D: usize>(
    mut source: impl BufRead,
    rows: &mut Rows<'_, D>,
) -> Result<(), FileError> {
    let origin = rows.origin;
    let delimiter = delimiter(source.fill_buf().map_err(|e| origin.system(&e))?);
    let progress = Rc::new(Progress::default());
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(delimiter)
        .buffer_capacity(1 << 16)
        .from_reader(Lines {
            inner: source,
            progress: progress.clone(),
        });

    let mut row = ByteRecord::new();
    let mut next = |row: &mut ByteRecord| -> Result<bool, FileError> {
        progress.bytes_of_row.set(0);
        let more = reader.read_byte_record(row);
        more.map_err(|error| match error.into_kind() {
            ErrorKind::Io(e) if e.kind() != io::ErrorKind::InvalidData => origin.system(&e),
            ErrorKind::Io(e) => origin.content_at(Some(progress.lines.get()), None, e.to_string()),
            other => origin.content_at(Some(progress.lines.get()), None, format!("{other:?}")),
        })
    };
    let line = |row: &ByteRecord| {
        let inside = row.as_slice().split(|&b| b == b'\n').count() as u64 - 1;
        // the end of the file inside a quote begins no new line
        let cut =
            progress.ended.get() && progress.odd_quotes.get() && row.as_slice().ends_with(b"\n");
        progress.lines.get() + u64::from(cut) - inside
    };
    if !next(&mut row)? {
        return Err(origin.content("there are no data in the file".to_owned()));
    }
    let headless = row.iter().all(|cell| number(cell).is_ok());
    let names: Vec<String> = if headless {
        Vec::new()
    } else {
        row.iter()
            .map(|cell| String::from_utf8_lossy(cell).trim().to_owned())
            .collect()
    };
    let columns = Columns {
        names: &names,
        count: row.len(),
    };
    let first_line = line(&row);
    let layout = columns
        .resolve(rows.request)
        .map_err(|what| origin.content_at(Some(first_line), None, what))?;
    if headless {
        take(&row, &line, &columns, &layout, rows)?;
    }
    let mut open = None;
    while next(&mut row)? {
        if row.len() != columns.count {
            let what = format!(
                "this row has {} cells, but line {first_line} has {}{}",
                row.len(),
                columns.count,
                unclosed(&row)
            );
            let at = row.len().min(columns.count + 1);
            return Err(origin.content_at(Some(line(&row)), Some(at), what));
        }
        take(&row, &line, &columns, &layout, rows)?;
        // with quotes in pairs a cell over several lines is meant so
        let cell = row.iter().position(|cell| cell.contains(&b'\n'));
        open = cell.map(|cell| (line(&row), cell + 1));
    }
    match open.filter(|_| progress.odd_quotes.get()) {
        None => Ok(()),
        Some((line, cell)) => {
            let what = "the quote that opens this cell is never closed".to_owned();
            Err(origin.content_at(Some(line), Some(cell), what))
        }
    }
}

/// `,`, unless the first line has none but has `;` or a tab.
fn delimiter(head: &[u8]) -> u8 {
    let first = head.split(|&b| b == b'\n').next().unwrap_or_default();
    [b',', b';', b'\t']
        .into_iter()
        .find(|mark| first.contains(mark))
        .unwrap_or(b',')
}

fn unclosed(row: &ByteRecord) -> &'static str {
    if row.iter().any(|cell| cell.contains(&b'\n')) {
        "; a cell goes over several lines: is a quote not closed?"
    } else {
        ""
    }
}

fn take<const D: usize>(
    row: &ByteRecord,
    line: &dyn Fn(&ByteRecord) -> u64,
    columns: &Columns<'_>,
    layout: &Layout<D>,
    rows: &mut Rows<'_, D>,
) -> Result<(), FileError> {
    let origin = rows.origin;
    let cell = |index: usize| {
        number(&row[index]).map_err(|fault| {
            let what = format!(
                "{} in {}{}",
                fault.say(&row[index]),
                columns.label(index),
                unclosed(row)
            );
            origin.content_at(Some(line(row)), Some(index + 1), what)
        })
    };
    let mut point = [0.0; D];
    for axis in 0..D {
        point[axis] = cell(layout.axes[axis])?;
    }
    let weight = match layout.weight {
        Some(index) => cell(index)?,
        None => 1.0,
    };
    rows.push(line(row), layout, point, weight)
}

/// What is wrong with a cell.
enum Fault {
    Missing,
    NotText,
    NotNumber,
    NotFinite,
}

impl Fault {
    fn say(&self, cell: &[u8]) -> String {
        let text = String::from_utf8_lossy(cell);
        let shown = quoted(text.trim());
        match self {
            Self::Missing if text.trim().is_empty() => {
                "a value is missing (the cell is empty); remove the row or fill it".to_owned()
            }
            Self::Missing => format!("a value is missing ({shown}); remove the row or fill it"),
            Self::NotText => format!("{shown} is not UTF-8 text"),
            Self::NotNumber if text.contains(',') => {
                format!("{shown} is not a number (the decimal mark is a point)")
            }
            Self::NotNumber => format!("{shown} is not a number"),
            Self::NotFinite => {
                format!("{shown} is not a finite number (the largest is about 1.8e308)")
            }
        }
    }
}

/// The finite number in a cell.
fn number(cell: &[u8]) -> Result<f64, Fault> {
    let text = std::str::from_utf8(cell)
        .map_err(|_| Fault::NotText)?
        .trim();
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(x) if x.is_nan() => Err(Fault::Missing),
        Ok(_) => Err(Fault::NotFinite),
        Err(_) => Err(match text.to_ascii_lowercase().as_str() {
            "" | "na" | "n/a" | "null" | "none" | "." | "-" | "?" => Fault::Missing,
            _ => Fault::NotNumber,
        }),
    }
}
