//! Arrays of NumPy's `.npy` format, version 1 to 3.
//!
//! The numbers go from the file through one small buffer straight to their place: the peak of memory is the data and no more.

use super::columns::{Columns, Layout};
use super::{FileError, Origin, Rows};
use crate::memory::{self, Bytes};
use crate::space::Point;
use npyz::{DType, Endianness, NpyHeader, Order, TypeChar};
use rayon::prelude::*;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// Bytes that are read at once.
const CHUNK: usize = 1 << 18;

/// More columns than anybody names; a row must fit into a buffer.
const MOST_COLUMNS: u64 = 1 << 16;

/// Rows that a thread reads at one go, and from how many rows on several threads read: below that, starting them costs more than they save.
const PIECE: usize = 1 << 16;
const MANY: u64 = 1 << 19;

/// Reads from `source`; `file` is its path and length where it is a file on a disk.
pub(super) fn read<const D: usize>(
    mut source: impl Read,
    file: Option<(&Path, u64)>,
    rows: &mut Rows<'_, D>,
) -> Result<(), FileError> {
    let size = file.map(|(_, size)| size);
    let origin = rows.origin;
    let (header, before) = header(&mut source, origin)?;
    let (count, columns) = match *header.shape() {
        [n] => (n, 1),
        [n, k] if (1..=MOST_COLUMNS).contains(&k) => (n, k),
        ref shape => {
            return Err(origin.content(format!(
                "the array has the shape {shape:?}; read are one axis, or two with 1 to {MOST_COLUMNS} columns"
            )));
        }
    };
    let item = Item::of(&header.dtype()).ok_or_else(|| {
        origin.content(format!(
            "the array holds {}; read are '<f8' and '<f4': numpy.save(file, array.astype('<f8'))",
            header.dtype().descr()
        ))
    })?;
    if count == 0 {
        return Ok(());
    }
    let bytes = count
        .saturating_mul(columns)
        .saturating_mul(item.bytes as u64);
    if let Some(size) = size.filter(|size| size.saturating_sub(before) < bytes) {
        return Err(origin.content(format!(
            "the file is cut short: its header promises {count} rows ({}), it holds {}",
            Bytes(bytes),
            Bytes(size.saturating_sub(before))
        )));
    }
    let columns = columns as usize;
    let layout = Columns {
        names: &[],
        count: columns,
    }
    .resolve(rows.request)
    .map_err(|what| origin.content(what))?;
    if header.order() == Order::C || columns == 1 {
        // a length that only the header claims is not believed in advance
        rows.reserve(if size.is_some() {
            count
        } else {
            count.min(1 << 16)
        })?;
        if let Some((path, _)) = file
            && count >= MANY
            && bare(item, columns, &layout)
            && side_by_side(path, before, count as usize, rows)
        {
            return Ok(());
        }
        by_rows(source, count, columns, item, &layout, rows)
    } else {
        by_columns(source, count, columns, item, &layout, rows)
    }
}

/// The header, and how many bytes it took. What would make its reader recurse, overflow or allocate without bound is refused first.
fn header(source: &mut impl Read, origin: &Origin) -> Result<(NpyHeader, u64), FileError> {
    const LONGEST: usize = 1 << 16;
    let damaged =
        |what: &str| origin.content(format!("the header of the array is damaged: {what}"));
    let cut = |error: io::Error| match error.kind() {
        io::ErrorKind::UnexpectedEof => damaged("the file ends in it"),
        _ => origin.system(&error),
    };
    let mut text = vec![0; 8];
    source.read_exact(&mut text).map_err(cut)?;
    let width = match text[6] {
        1 => 2,
        2 | 3 => 4,
        other => {
            return Err(damaged(&format!(
                "version {other} is not known (1, 2 and 3 are)"
            )));
        }
    };
    let mut length = [0; 4];
    source.read_exact(&mut length[..width]).map_err(cut)?;
    text.extend_from_slice(&length[..width]);
    let length = u32::from_le_bytes(length) as usize;
    if length > LONGEST {
        return Err(damaged("it is longer than 64 KiB"));
    }
    let start = text.len();
    text.resize(start + length, 0);
    source.read_exact(&mut text[start..]).map_err(cut)?;

    let mut depth = 0_usize;
    for &byte in &text[start..] {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > 4 {
            return Err(damaged("its brackets are nested too deeply"));
        }
    }
    // so few digits cannot multiply to more than 10¹⁸
    let shape = String::from_utf8_lossy(&text[start..]);
    let shape = shape.find("'shape'").map_or("", |at| &shape[at..]);
    if shape.bytes().filter(u8::is_ascii_digit).count() > 18 {
        return Err(damaged("its shape is larger than any file"));
    }
    let read = text.len() as u64;
    let header = NpyHeader::from_reader(&text[..]).map_err(|e| damaged(&e.to_string()))?;
    Ok((header, read))
}

/// How one number is stored.
#[derive(Clone, Copy)]
struct Item {
    bytes: usize,
    big: bool,
}

impl Item {
    fn of(kind: &DType) -> Option<Self> {
        match kind {
            DType::Plain(plain) if plain.type_char() == TypeChar::Float => {
                let bytes = plain.num_bytes().filter(|bytes| matches!(bytes, 4 | 8))?;
                let big = plain.endianness() == Endianness::Big;
                Some(Self { bytes, big })
            }
            _ => None,
        }
    }

    /// The number at the beginning of `bytes`.
    #[inline]
    fn number(self, bytes: &[u8]) -> f64 {
        if self.bytes == 8 {
            let raw: [u8; 8] = bytes[..8].try_into().expect("eight bytes");
            if self.big {
                f64::from_be_bytes(raw)
            } else {
                f64::from_le_bytes(raw)
            }
        } else {
            let raw: [u8; 4] = bytes[..4].try_into().expect("four bytes");
            f64::from(if self.big {
                f32::from_be_bytes(raw)
            } else {
                f32::from_le_bytes(raw)
            })
        }
    }
}

/// A point whose coordinates are all there is, as a processor of today keeps them.
#[inline]
fn point<const D: usize>(bytes: &[u8]) -> Point<D> {
    let mut point = [0.0; D];
    for axis in 0..D {
        let mut raw = [0; 8];
        raw.copy_from_slice(&bytes[8 * axis..8 * axis + 8]);
        point[axis] = f64::from_le_bytes(raw);
    }
    point
}

fn cut_short(origin: &Origin, row: u64, error: &io::Error) -> FileError {
    if error.kind() == io::ErrorKind::UnexpectedEof {
        origin.content_at(
            Some(row + 1),
            None,
            "the file ends before this row, which its header promises".to_owned(),
        )
    } else {
        origin.system(error)
    }
}

/// Whether a row is a point whose coordinates are all there is, as a processor of today keeps them.
fn bare<const D: usize>(item: Item, columns: usize, layout: &Layout<D>) -> bool {
    let mut axes = layout.axes.iter().enumerate();
    item.bytes == 8
        && !item.big
        && columns == D
        && layout.weight.is_none()
        && axes.all(|(axis, &column)| axis == column)
}

/// Reads bare rows piece by piece, all threads at once. False, and nothing is read, if anything is wrong: then reading them one by one finds out what.
fn side_by_side<const D: usize>(
    path: &Path,
    before: u64,
    count: usize,
    rows: &mut Rows<'_, D>,
) -> bool {
    // the room that was made is given back: this memory is zero without having been written, so that each thread is the first to touch its own
    rows.points = Vec::new();
    let mut points = vec![[0.0; D]; count];
    let domain = &rows.request.domain;
    let right = points
        .par_chunks_mut(PIECE)
        .enumerate()
        .map_init(
            || (File::open(path), vec![0; CHUNK]),
            |(file, buffer), (number, piece)| {
                let Ok(file) = file else { return false };
                let start = before + (number * PIECE * 8 * D) as u64;
                if file.seek(SeekFrom::Start(start)).is_err() {
                    return false;
                }
                let mut right = true;
                for points in piece.chunks_mut(CHUNK / (8 * D)) {
                    let bytes = &mut buffer[..points.len() * 8 * D];
                    if file.read_exact(bytes).is_err() {
                        return false;
                    }
                    for (to, from) in points.iter_mut().zip(bytes.chunks_exact(8 * D)) {
                        *to = point(from);
                        right &= domain.contains(*to) & to.iter().all(|x| x.is_finite());
                    }
                }
                right
            },
        )
        .all(|right| right);
    if right {
        rows.points = points;
    }
    right
}

fn by_rows<const D: usize>(
    mut source: impl Read,
    count: u64,
    columns: usize,
    item: Item,
    layout: &Layout<D>,
    rows: &mut Rows<'_, D>,
) -> Result<(), FileError> {
    let row_bytes = columns * item.bytes;
    let at_once = (CHUNK / row_bytes).max(1) as u64;
    let mut buffer = vec![0; row_bytes * at_once.min(count) as usize];
    let bare = bare(item, columns, layout);
    let mut row = 0;
    while row < count {
        let some = at_once.min(count - row) as usize;
        let bytes = &mut buffer[..some * row_bytes];
        source
            .read_exact(bytes)
            .map_err(|e| cut_short(rows.origin, row, &e))?;
        // what most arrays are; a row that is not legal is found again below, one by one
        if bare && rows.push_all(some, bytes.chunks_exact(row_bytes).map(point))? {
            row += some as u64;
            continue;
        }
        for one in bytes.chunks_exact(row_bytes) {
            let at = |column: usize| item.number(&one[column * item.bytes..]);
            let weight = layout.weight.map_or(1.0, at);
            row += 1;
            rows.push(row, layout, layout.axes.map(at), weight)?;
        }
    }
    Ok(())
}

/// Columns one after the other: those that are wanted are kept until all have passed.
fn by_columns<const D: usize>(
    mut source: impl Read,
    count: u64,
    columns: usize,
    item: Item,
    layout: &Layout<D>,
    rows: &mut Rows<'_, D>,
) -> Result<(), FileError> {
    let origin = rows.origin;
    let wanted: Vec<usize> = layout.axes.iter().copied().chain(layout.weight).collect();
    let last = wanted.iter().copied().max().unwrap_or(0);
    // the columns themselves, and the rows made of them
    memory::check(count.saturating_mul(16 * wanted.len() as u64))
        .map_err(|e| origin.content(format!("too large: {e}")))?;
    let mut kept: Vec<Vec<f64>> = vec![Vec::new(); columns.min(last + 1)];
    let mut buffer = vec![0; CHUNK];
    for (column, keep) in kept.iter_mut().enumerate() {
        let mut left = count;
        while left > 0 {
            let some = left.min((CHUNK / item.bytes) as u64) as usize;
            let bytes = &mut buffer[..some * item.bytes];
            source
                .read_exact(bytes)
                .map_err(|e| cut_short(origin, count - left, &e))?;
            if wanted.contains(&column) {
                keep.extend(bytes.chunks_exact(item.bytes).map(|raw| item.number(raw)));
            }
            left -= some as u64;
        }
    }
    for row in 0..count as usize {
        let weight = layout.weight.map_or(1.0, |column| kept[column][row]);
        let point = layout.axes.map(|column| kept[column][row]);
        rows.push(row as u64 + 1, layout, point, weight)?;
    }
    Ok(())
}
