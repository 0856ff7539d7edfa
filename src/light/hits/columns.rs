//! Hits as columns of a Parquet file, group by group.

use super::file::ROW;
use crate::light::spectrum::Colour;
use parquet::basic::Compression;
use parquet::data_type::{FloatType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::ColumnPath;
use std::io::{self, Write};
use std::sync::Arc;

/// Where the numbers stand in a row of an array, in the order of the columns.
const SHORT: [usize; 2] = [0, 2];
const LONG: [usize; 2] = [4, 8];
const REAL: [usize; 11] = [12, 16, 20, 24, 28, 32, 36, 40, 44, 48, 52];

fn schema(colour: Colour) -> String {
    let flux = match colour {
        Colour::Rgb => ["flux_r", "flux_g", "flux_b"],
        Colour::Spectral => ["flux_x", "flux_y", "flux_z"],
    };
    let short = ["surface", "bounce"].map(|n| format!("REQUIRED INT32 {n} (INTEGER(16,false));"));
    let long = ["path", "part"].map(|n| format!("REQUIRED INT32 {n} (INTEGER(32,false));"));
    let directions = ["direction_x", "direction_y", "direction_z"];
    let real = (["u", "v", "x", "y", "z"].into_iter())
        .chain(flux)
        .chain(directions);
    let real = real.map(|name| format!("REQUIRED FLOAT {name};"));
    let all: String = short.into_iter().chain(long).chain(real).collect();
    format!("message hits {{ {all} }}")
}

/// What went wrong below Parquet, if it did.
fn plain(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    }
}

/// Writes hits in columns.
pub struct Columns<W: Write + Send> {
    writer: SerializedFileWriter<W>,
}

impl<W: Write + Send> Columns<W> {
    /// A file without hits.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn new(sink: W, colour: Colour) -> io::Result<Self> {
        let schema = parse_message_type(&schema(colour)).map_err(plain)?;
        // few numbers stand for surfaces and bounces; the others are all different
        let few = |name: &str| ColumnPath::from(name);
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_dictionary_enabled(false)
            .set_column_dictionary_enabled(few("surface"), true)
            .set_column_dictionary_enabled(few("bounce"), true)
            .build();
        let writer = SerializedFileWriter::new(sink, Arc::new(schema), Arc::new(properties));
        Ok(Self {
            writer: writer.map_err(plain)?,
        })
    }

    /// A group of hits, given as the rows that [`Format::row`](super::Format::row) makes.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn group(&mut self, rows: &[u8]) -> io::Result<()> {
        if rows.is_empty() {
            return Ok(());
        }
        let mut group = self.writer.next_row_group().map_err(plain)?;
        let four = |row: &[u8], at: usize| [row[at], row[at + 1], row[at + 2], row[at + 3]];
        for at in SHORT {
            let short = |row: &[u8]| i32::from(u16::from_le_bytes([row[at], row[at + 1]]));
            whole(&mut group, rows, short).map_err(plain)?;
        }
        for at in LONG {
            whole(&mut group, rows, |row| i32::from_le_bytes(four(row, at))).map_err(plain)?;
        }
        for at in REAL {
            let values = rows.chunks_exact(ROW);
            let values: Vec<f32> = values
                .map(|row| f32::from_le_bytes(four(row, at)))
                .collect();
            if let Some(mut column) = group.next_column().map_err(plain)? {
                let into = column.typed::<FloatType>();
                into.write_batch(&values, None, None).map_err(plain)?;
                column.close().map_err(plain)?;
            }
        }
        group.close().map_err(plain)?;
        Ok(())
    }

    /// The list of columns, at the end.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(self) -> io::Result<()> {
        self.writer.close().map_err(plain)?;
        Ok(())
    }
}

fn whole<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    rows: &[u8],
    number: impl Fn(&[u8]) -> i32,
) -> Result<(), ParquetError> {
    let values: Vec<i32> = rows.chunks_exact(ROW).map(number).collect();
    if let Some(mut column) = group.next_column()? {
        column
            .typed::<Int32Type>()
            .write_batch(&values, None, None)?;
        column.close()?;
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::Columns;
    use crate::light::hits::{Format, inside};
    use crate::light::scene;
    use crate::light::walk::{Power, Walk};
    use crate::sample::file::{Column, Request, read};
    use crate::space::Domain;
    use std::path::Path;

    #[test]
    fn hits_come_back_as_a_sample_of_columns() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes");
        let scene = scene::read::scene(&folder.join("cornell-box-rgb.toml")).unwrap();
        let walk = Walk::new(&scene, Power::Same, 700, 3).unwrap();
        let records = walk.trace(0).records;
        let mut bytes = Vec::new();
        let mut columns = Columns::new(&mut bytes, scene.colour).unwrap();
        // two groups, and one of nothing
        for part in [&records[..100], &[], &records[100..]] {
            let mut rows = Vec::new();
            for record in part {
                Format::Columns.row(&scene, record, &mut rows);
            }
            columns.group(&rows).unwrap();
        }
        columns.finish().unwrap();
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("hits.parquet");
        std::fs::write(&path, &bytes).unwrap();
        let ask = |columns: [&str; 2], weight| {
            let request = Request {
                columns: columns.map(|name| Column::Named(name)),
                weight,
                domain: Domain::whole(),
            };
            read::<2>(&path, &request).unwrap()
        };
        let (uv, path_and_surface) = (
            ask(["u", "v"], Some("flux_g")),
            ask(["path", "surface"], None),
        );
        let z = ask(["direction_z", "z"], None);
        assert_eq!(uv.len(), records.len());
        let green: f64 = records.iter().map(|r| f64::from(r.flux[1])).sum();
        let bits = |x: [f64; 2]| x.map(f64::to_bits);
        for (i, record) in records.iter().enumerate() {
            let place = [record.u, record.v].map(f64::from);
            assert_eq!(bits(uv.points()[i]), bits(place));
            let share = f64::from(record.flux[1]) / green;
            assert!((uv.weight(i) - share).abs() < 1e-12);
            let numbers = [f64::from(record.path), f64::from(record.surface)];
            assert_eq!(bits(path_and_surface.points()[i]), bits(numbers));
            let shape = &scene.surfaces()[record.surface as usize].shape;
            let [u, v] = inside(shape, record);
            let height = shape.place(record.part as usize, u, v).z as f32;
            let known = [record.direction().z as f32, height].map(f64::from);
            assert_eq!(bits(z.points()[i]), bits(known));
        }
    }
}
