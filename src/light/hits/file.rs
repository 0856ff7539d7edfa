//! Hits as rows of a file.
//!
//! | format | row |
//! |---|---|
//! | CSV | `surface,u,v,x,y,z,flux_r,flux_g,flux_b,bounce`: the surface by name, fluxes as linear sRGB whatever the colour of the scene |
//! | NumPy, a structured array | `surface`, `bounce`, `path`, `part` (numbers), `u`, `v`, `place` (3), `flux_rgb` or `flux_xyz` (3), `direction` (3) |
//! | Parquet, if built with the feature `parquet` | the same numbers, each a column: `surface`, `bounce`, `path`, `part`, `u`, `v`, `x`, `y`, `z`, `flux_r` ... or `flux_x` ..., `direction_x` ... |
//!
//! Rows are in the order of paths. Over wavelengths a single photon lies outside of the triangle of sRGB, so that one of its three fluxes in a CSV file
//! may be negative; the array holds X, Y and Z, which are not.

use super::{Hits, Record, folded, inside, linear_rgb};
use crate::light::scene::Scene;
use crate::light::spectrum::Colour;
use crate::light::vector::Vector;
use crate::storage::{self, StorageError};
use std::io::Write;
use std::path::Path;

/// How hits are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// CSV.
    Table,
    /// A NumPy array.
    Array,
    /// Columns of a Parquet file, if built with the feature `parquet`: groups of rows that are those of an array.
    Columns,
}

/// Why a file gave no hits.
#[derive(Debug, thiserror::Error)]
pub enum HitsError {
    /// It could not be read.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// It holds something else.
    #[error("{path}: {what}")]
    Content {
        /// The file.
        path: String,
        /// What is wrong.
        what: String,
    },
}

/// Bytes of a row of an array.
pub(super) const ROW: usize = 56;

impl Format {
    /// What the ending of a path asks for: an array for `.npy`, columns for `.parquet`, a table otherwise.
    pub fn of(path: &Path) -> Self {
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("npy") => Self::Array,
            Some("parquet") => Self::Columns,
            _ => Self::Table,
        }
    }

    /// What comes before the rows; nothing before columns.
    pub fn head(self, colour: Colour, rows: u64) -> Vec<u8> {
        match self {
            Self::Table => b"surface,u,v,x,y,z,flux_r,flux_g,flux_b,bounce\n".to_vec(),
            Self::Columns => Vec::new(),
            Self::Array => {
                let about = format!(
                    "{{'descr': {}, 'fortran_order': False, 'shape': ({rows},), }}",
                    description(colour)
                );
                // magic, version 1.0, the length in two bytes, and all of it a multiple of 64 bytes that ends a line [NumPy NEP 1]
                let length = (10 + about.len() + 1).div_ceil(64) * 64 - 10;
                let mut head = b"\x93NUMPY\x01\x00".to_vec();
                head.extend((length as u16).to_le_bytes());
                head.extend(about.bytes());
                head.resize(10 + length - 1, b' ');
                head.push(b'\n');
                head
            }
        }
    }

    /// Appends a row.
    pub fn row(self, scene: &Scene, record: &Record, out: &mut Vec<u8>) {
        let surface = &scene.surfaces()[record.surface as usize];
        let [u, v] = inside(&surface.shape, record);
        let place = surface.shape.place(record.part as usize, u, v);
        match self {
            Self::Table => {
                name(&surface.name, out);
                let flux = linear_rgb(scene.colour, record.flux);
                let numbers = [u, v, place.x, place.y, place.z]
                    .into_iter()
                    .chain(flux)
                    .map(|x| x as f32);
                for x in numbers {
                    out.push(b',');
                    number(x, out);
                }
                // writing to memory does not fail
                let _ = writeln!(out, ",{}", record.bounce);
            }
            Self::Array | Self::Columns => {
                out.extend(record.surface.to_le_bytes());
                out.extend(record.bounce.to_le_bytes());
                out.extend(record.path.to_le_bytes());
                out.extend(record.part.to_le_bytes());
                let direction = record.direction();
                let three = |v: Vector| [v.x as f32, v.y as f32, v.z as f32];
                let numbers = [record.u, record.v]
                    .into_iter()
                    .chain(three(place))
                    .chain(record.flux)
                    .chain(three(direction));
                for x in numbers {
                    out.extend(x.to_le_bytes());
                }
            }
        }
    }
}

fn description(colour: Colour) -> String {
    let flux = match colour {
        Colour::Rgb => "flux_rgb",
        Colour::Spectral => "flux_xyz",
    };
    format!(
        "[('surface', '<u2'), ('bounce', '<u2'), ('path', '<u4'), ('part', '<u4'), ('u', '<f4'), ('v', '<f4'), ('place', '<f4', (3,)), ('{flux}', '<f4', (3,)), ('direction', '<f4', (3,))]"
    )
}

/// A name as a cell: quoted where it must be.
fn name(text: &str, out: &mut Vec<u8>) {
    if text.contains([',', '"', '\n', '\r']) {
        out.push(b'"');
        out.extend(text.replace('"', "\"\"").bytes());
        out.push(b'"');
    } else {
        out.extend(text.bytes());
    }
}

/// The shortest decimal that reads back as the same single-precision number.
fn number(x: f32, out: &mut Vec<u8>) {
    let size = x.abs();
    // writing to memory does not fail
    let _ = if size <= 0.0 || (1e-4..1e9).contains(&size) {
        write!(out, "{x}")
    } else {
        write!(out, "{x:e}")
    };
}

/// Reads an array of hits that `lab trace` wrote for this scene; `paths` is the number of photons N of that walk.
///
/// # Errors
/// If the file cannot be read, or does not hold hits on this scene.
pub fn read(path: &Path, scene: &Scene, paths: u64) -> Result<Hits, HitsError> {
    let fault = |what: &str| HitsError::Content {
        path: path.display().to_string(),
        what: what.to_owned(),
    };
    let bytes = storage::read(path)?;
    let length = match bytes.get(..10) {
        Some(head) if head.starts_with(b"\x93NUMPY\x01") => {
            10 + usize::from(u16::from_le_bytes([head[8], head[9]]))
        }
        _ => return Err(fault("no NumPy array of version 1")),
    };
    let about = bytes.get(10..length).unwrap_or_default();
    let expected = format!("{{'descr': {}, ", description(scene.colour));
    if !about.starts_with(expected.as_bytes()) {
        return Err(fault(
            "no array of hits of this scene, as `lab trace` writes it",
        ));
    }
    let rows = &bytes[length..];
    if rows.len() % ROW != 0 {
        return Err(fault("the last hit is cut off"));
    }
    let mut hits = Hits::new(scene.surfaces().len(), paths);
    for row in rows.chunks_exact(ROW) {
        let short = |at: usize| u16::from_le_bytes([row[at], row[at + 1]]);
        let four = |at: usize| [row[at], row[at + 1], row[at + 2], row[at + 3]];
        let real = |at: usize| f32::from_le_bytes(four(at));
        let surface = usize::from(short(0));
        if surface >= scene.surfaces().len() {
            return Err(fault("a hit on a surface that the scene does not have"));
        }
        let [x, y, z] = [44, 48, 52].map(|at| f64::from(real(at)));
        let mut record = Record::new(
            [f64::from(real(12)), f64::from(real(16))],
            [real(32), real(36), real(40)],
            (u32::from_le_bytes(four(4)), short(2)),
            (surface, u32::from_le_bytes(four(8)) as usize),
            folded(Vector::new(x, y, z)),
        );
        // written in single precision, kept in single precision
        record.u = real(12);
        record.v = real(16);
        if !record.u.is_finite() || !record.v.is_finite() || !record.flux.iter().all(|x| *x >= 0.0)
        {
            return Err(fault("a hit that is not finite, or has less than no light"));
        }
        hits.extend(&[record]);
    }
    Ok(hits)
}

#[cfg(test)]
mod tests {
    use super::{Format, ROW, read};
    use crate::light::scene;
    use crate::light::walk::{Power, Walk};
    use std::path::Path;

    #[test]
    fn an_array_comes_back_and_others_can_read_it() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes");
        let scene = scene::read::scene(&folder.join("cornell-box.toml")).expect("a scene");
        let walk = Walk::new(&scene, Power::Same, 500, 3).expect("a walk");
        let trace = walk.trace(0);
        let mut bytes = Format::Array.head(scene.colour, trace.records.len() as u64);
        assert_eq!(bytes.len() % 64, 0);
        let head = bytes.len();
        for record in &trace.records {
            Format::Array.row(&scene, record, &mut bytes);
        }
        assert_eq!(bytes.len(), head + ROW * trace.records.len());
        let file = npyz::NpyFile::new(&bytes[..]).expect("an array");
        assert_eq!(file.shape(), [trace.records.len() as u64]);
        assert!(file.dtype().descr().contains("flux_xyz"));
        let place = tempfile::tempdir().expect("a folder");
        let path = place.path().join("hits.npy");
        std::fs::write(&path, &bytes).expect("writable");
        let hits = read(&path, &scene, 500).expect("hits");
        assert_eq!(hits.len(), trace.records.len());
        for surface in 0..scene.surfaces().len() {
            let written: Vec<_> = trace
                .records
                .iter()
                .filter(|record| usize::from(record.surface) == surface)
                .collect();
            for (a, b) in hits.on(surface).iter().zip(written) {
                assert_eq!(
                    (a.u.to_bits(), a.flux, a.path, a.bounce),
                    (b.u.to_bits(), b.flux, b.path, b.bounce)
                );
                assert!((a.direction() - b.direction()).norm() < 1e-4);
            }
        }
        for cut in [5, head - 1, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..cut]).expect("writable");
            assert!(read(&path, &scene, 500).is_err(), "{cut}");
        }
    }
}
