//! Measured data: columns of a CSV file or of a NumPy array become a sample.
//!
//! | format | told by | columns are named by |
//! |---|---|---|
//! | CSV (`,`; or `;` or tab if the first line has no `,`) | being neither of the others | the header, or their number from 1 |
//! | NumPy `.npy`, one or two axes, `f4` or `f8` | its first bytes | their number from 1 |
//! | Parquet, if built with the feature `parquet` | its first bytes | their names, or their number from 1 |
//!
//! A name that no header cell has but that is a whole number is the number of a column, from 1. A first line of numbers only is data: such a
//! file has no header. A byte order mark, CRLF line ends, quoted cells and blank lines are understood; there are no comment lines.
//!
//! Nothing is guessed about the data themselves: a row of another length, an empty cell, a cell that is not a finite number, a
//! negative weight or a point outside the domain is an error at `file:line:column`, where the column is the **number of the cell** in its row
//! and both count from 1; in an array the line is the row.
//!
//! Files are read as a stream; memory is the numbers asked for, 8 bytes each, and is refused before it is gone.

mod array;
mod columns;
#[cfg(feature = "parquet")]
mod parquet;
mod table;

use super::{Sample, SampleError};
use crate::memory;
use crate::parameter::nearest;
use crate::space::{Domain, Point};
use columns::Layout;
use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// Where in a file something is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file as it was named; `stdin` for the standard input.
    pub file: String,
    /// The line, from 1.
    pub line: Option<u64>,
    /// The number of the cell in its row, from 1.
    pub column: Option<u64>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        for number in [self.line, self.column].into_iter().flatten() {
            write!(f, ":{number}")?;
        }
        Ok(())
    }
}

/// Why a file did not become a sample: one sentence that begins with the place.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The system did not give the file or its bytes.
    #[error("{place}: {what}")]
    System {
        /// Where.
        place: Place,
        /// What the system said.
        what: String,
    },
    /// The bytes are not what they should be.
    #[error("{place}: {what}")]
    Content {
        /// Where.
        place: Place,
        /// What is wrong and what would be right.
        what: String,
    },
}

/// A column as it was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column<'a> {
    /// This name or, failing that, number from 1.
    Named(&'a str),
    /// The first of these names that there is, or else the only column.
    Preferred(&'a [&'a str]),
}

/// What to read: one column for each axis, perhaps a column of weights, and where the points may lie.
#[derive(Clone, Debug)]
pub struct Request<'a, const D: usize> {
    /// The column of each axis.
    pub columns: [Column<'a>; D],
    /// The column of weights; equal weights without one.
    pub weight: Option<&'a str>,
    /// Where the points may lie.
    pub domain: Domain<D>,
}

/// Reads a sample of mass 1 from `path`; `-` is the standard input. O(bytes) time; 8 bytes a number.
///
/// # Errors
/// If the file cannot be read, is not a table of numbers with those columns, or is larger than memory.
pub fn read<const D: usize>(path: &Path, request: &Request<'_, D>) -> Result<Sample<D>, FileError> {
    let (points, weights) = read_rows(path, request)?;
    let sample = match weights {
        None => Sample::equal(points, request.domain.clone()),
        Some(weights) => Sample::normalised(points, weights, request.domain.clone()),
    };
    sample.map_err(|error| {
        let what = match error {
            SampleError::Mass(mass) => {
                format!("the weights sum to {mass}; the sum must be positive and finite")
            }
            other => other.to_string(),
        };
        Origin::of(path).content(what)
    })
}

/// Reads places, in their order: the targets of an estimate.
///
/// # Errors
/// As [`read`].
pub fn read_points<const D: usize>(
    path: &Path,
    columns: [Column<'_>; D],
) -> Result<Vec<Point<D>>, FileError> {
    let request = Request {
        columns,
        weight: None,
        domain: Domain::whole(),
    };
    Ok(read_rows(path, &request)?.0)
}

type Read2<const D: usize> = (Vec<Point<D>>, Option<Vec<f64>>);

fn read_rows<const D: usize>(path: &Path, request: &Request<'_, D>) -> Result<Read2<D>, FileError> {
    let origin = Origin::of(path);
    let (source, size) = origin.open(path)?;
    let mut reader = BufReader::with_capacity(1 << 16, source);
    let head = reader.fill_buf().map_err(|e| origin.system(&e))?;
    let mut rows = Rows::new(&origin, request);
    if head.starts_with(array::MAGIC) {
        let file = size.map(|size| (path, size));
        array::read(reader, file, &mut rows)?;
    } else if cfg!(feature = "parquet") && head.starts_with(PARQUET) {
        if size.is_none() {
            return Err(
                origin.content("Parquet is read from its end: give a file on a disk".to_owned())
            );
        }
        #[cfg(feature = "parquet")]
        parquet::read(path, &mut rows)?;
    } else if let Some(refusal) = refusal(head) {
        return Err(origin.content(refusal));
    } else {
        table::read(reader, &mut rows)?;
    }
    rows.finish()
}

/// How Parquet files begin.
const PARQUET: &[u8] = b"PAR1";

/// What the first bytes say against reading the file as text.
fn refusal(head: &[u8]) -> Option<String> {
    const MAGIC: [(&[u8], &str, &str); 11] = [
        (
            b"\x1f\x8b",
            "gzip",
            "decompress it first: gunzip -c FILE | lab ... -",
        ),
        (
            b"BZh",
            "bzip2",
            "decompress it first: bunzip2 -c FILE | lab ... -",
        ),
        (
            b"\xfd7zXZ",
            "xz",
            "decompress it first: xz -dc FILE | lab ... -",
        ),
        (
            b"\x28\xb5\x2f\xfd",
            "zstd",
            "decompress it first: zstd -dc FILE | lab ... -",
        ),
        (
            b"\x04\x22\x4d\x18",
            "lz4",
            "decompress it first: lz4 -dc FILE | lab ... -",
        ),
        (b"PK\x03\x04", "zip (.zip, .npz, .xlsx)", "unpack it first"),
        (
            PARQUET,
            "Parquet",
            "write it as .csv or .npy first, or build lab with it: cargo install --path . --features parquet",
        ),
        (b"\x89HDF", "HDF5", "write it as .csv or .npy first"),
        (b"ARROW1", "Arrow", "write it as .csv or .npy first"),
        (b"\xff\xfe", "UTF-16", "save it as UTF-8"),
        (b"\xfe\xff", "UTF-16", "save it as UTF-8"),
    ];
    if head.is_empty() {
        return Some("the file is empty".to_owned());
    }
    for (magic, name, hint) in MAGIC {
        if head.starts_with(magic) {
            return Some(format!("the file is {name}; read are CSV and .npy: {hint}"));
        }
    }
    head.contains(&0).then(|| {
        "the file is binary (it has NUL bytes); read are CSV text and NumPy's .npy".to_owned()
    })
}

/// A file as its user named it, for messages.
struct Origin(String);

impl Origin {
    fn of(path: &Path) -> Self {
        Self(if path == Path::new("-") {
            "stdin".to_owned()
        } else {
            path.display().to_string()
        })
    }

    /// The bytes, and how many there are where that is known.
    fn open(&self, path: &Path) -> Result<(Box<dyn Read>, Option<u64>), FileError> {
        if path == Path::new("-") {
            return Ok((Box::new(io::stdin().lock()), None));
        }
        let file = File::open(path).map_err(|error| {
            let mut what = error.to_string();
            if error.kind() == io::ErrorKind::NotFound
                && let Some(other) = neighbour(path)
            {
                what = format!("{what}; did you mean {}?", other.display());
            }
            self.system(&what)
        })?;
        let about = file.metadata().map_err(|e| self.system(&e))?;
        if about.is_dir() {
            return Err(self.system(&"is a folder; give a file"));
        }
        Ok((Box::new(file), about.is_file().then_some(about.len())))
    }

    fn place(&self, line: Option<u64>, column: Option<usize>) -> Place {
        Place {
            file: self.0.clone(),
            line,
            column: column.map(|c| c as u64),
        }
    }

    fn system(&self, what: &dyn fmt::Display) -> FileError {
        FileError::System {
            place: self.place(None, None),
            what: what.to_string(),
        }
    }

    fn content(&self, what: String) -> FileError {
        self.content_at(None, None, what)
    }

    fn content_at(&self, line: Option<u64>, column: Option<usize>, what: String) -> FileError {
        FileError::Content {
            place: self.place(line, column),
            what,
        }
    }
}

/// A file beside the missing one with nearly its name.
fn neighbour(path: &Path) -> Option<PathBuf> {
    let wanted = path.file_name()?.to_str()?;
    let folder = path.parent()?;
    let listed = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let names: Vec<String> = std::fs::read_dir(listed)
        .ok()?
        .take(10_000)
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    nearest(wanted, names.iter().map(String::as_str)).map(|name| folder.join(name))
}

/// The rows read so far, each checked as it comes.
struct Rows<'a, const D: usize> {
    origin: &'a Origin,
    request: &'a Request<'a, D>,
    points: Vec<Point<D>>,
    weights: Vec<f64>,
}

impl<'a, const D: usize> Rows<'a, D> {
    fn new(origin: &'a Origin, request: &'a Request<'a, D>) -> Self {
        Self {
            origin,
            request,
            points: Vec::new(),
            weights: Vec::new(),
        }
    }

    fn weighted(&self) -> bool {
        self.request.weight.is_some()
    }

    /// Makes room for `more` rows, if there is memory for them.
    fn reserve(&mut self, more: u64) -> Result<(), FileError> {
        let each = 8 * (D as u64 + u64::from(self.weighted()));
        let fits = memory::check(more.saturating_mul(each));
        if let (Ok(()), Ok(more)) = (&fits, usize::try_from(more)) {
            let mut room = self.points.try_reserve_exact(more).is_ok();
            if self.weighted() {
                room &= self.weights.try_reserve_exact(more).is_ok();
            }
            if room {
                return Ok(());
            }
        }
        let figure = fits.err().map_or_else(
            || "there is no memory for them".to_owned(),
            |e| e.to_string(),
        );
        Err(self.origin.content(format!(
            "too large: {} rows of data so far and {more} more: {figure}",
            self.points.len()
        )))
    }

    /// Takes a row that stands at `line`; the layout says where in it a fault is.
    #[inline]
    fn push(
        &mut self,
        line: u64,
        layout: &Layout<D>,
        point: Point<D>,
        weight: f64,
    ) -> Result<(), FileError> {
        let inside = self.request.domain.contains(point) && point.iter().all(|x| x.is_finite());
        if !(inside && (0.0..f64::INFINITY).contains(&weight)) {
            return Err(self.fault(line, layout, point, weight));
        }
        if self.points.len() == self.points.capacity() {
            self.reserve((self.points.len() as u64 / 2).max(4096))?;
        }
        self.points.push(point);
        if layout.weight.is_some() {
            self.weights.push(weight);
        }
        Ok(())
    }

    /// Takes `count` rows without weights if all of them are legal, at the speed of memory; takes none and says so if one is not.
    fn push_all(
        &mut self,
        count: usize,
        points: impl Iterator<Item = Point<D>>,
    ) -> Result<bool, FileError> {
        let before = self.points.len();
        if self.points.capacity() - before < count {
            self.reserve((before as u64 / 2).max(count as u64))?;
        }
        self.points.extend(points);
        let mut legal = true;
        for point in &self.points[before..] {
            for x in point {
                legal &= x.is_finite();
            }
            legal &= self.request.domain.contains(*point);
        }
        if !legal {
            self.points.truncate(before);
        }
        Ok(legal)
    }

    #[cold]
    fn fault(&self, line: u64, layout: &Layout<D>, point: Point<D>, weight: f64) -> FileError {
        let domain = &self.request.domain;
        for axis in 0..D {
            let x = point[axis];
            let what = if !x.is_finite() {
                format!("{x} is not a finite number")
            } else if x < domain.low()[axis] || x > domain.high()[axis] {
                format!(
                    "{x} lies outside the domain, {} to {}",
                    domain.low()[axis],
                    domain.high()[axis]
                )
            } else {
                continue;
            };
            let column = layout.axes[axis] + 1;
            return self.origin.content_at(Some(line), Some(column), what);
        }
        let what =
            format!("the weight {weight} is not allowed: weights are finite and not negative");
        let column = layout.weight.map(|w| w + 1);
        self.origin.content_at(Some(line), column, what)
    }

    fn finish(mut self) -> Result<Read2<D>, FileError> {
        if self.points.is_empty() {
            return Err(self
                .origin
                .content("there are no data in the file".to_owned()));
        }
        self.points.shrink_to_fit();
        let weights = self.weighted().then_some(self.weights);
        Ok((self.points, weights))
    }
}

#[cfg(test)]
mod tests;
