//! Parquet files whose columns are numbers, with Snappy or without compression.
//!
//! Group of rows by group: the peak of memory is the data and the wanted columns of one group.

use super::columns::{Columns, Layout, quoted};
use super::{FileError, Origin, Rows};
use crate::memory;
use parquet::basic::{ConvertedType, LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;
use std::fs::File;
use std::path::Path;

/// Rows that are read at once.
const BATCH: usize = 1 << 14;

/// Reads from a file on a disk: the list of columns stands at its end.
pub(super) fn read<const D: usize>(path: &Path, rows: &mut Rows<'_, D>) -> Result<(), FileError> {
    let origin = rows.origin;
    let damaged = |error: ParquetError| {
        origin.content(format!("the file is Parquet and cannot be read: {error}"))
    };
    let file = File::open(path).map_err(|error| origin.system(&error))?;
    let reader = SerializedFileReader::new(file).map_err(damaged)?;
    let about = reader.metadata().file_metadata();
    let columns = about.schema_descr().columns();
    let names: Vec<String> = columns
        .iter()
        .map(|column| column.path().string())
        .collect();
    let layout = Columns {
        names: &names,
        count: names.len(),
    }
    .resolve(rows.request)
    .map_err(|what| origin.content(what))?;
    let wanted: Vec<usize> = layout.axes.iter().copied().chain(layout.weight).collect();
    for &column in &wanted {
        if !numbers(&columns[column]) {
            return Err(origin.content(format!(
                "column {} holds no plain numbers; read are FLOAT, DOUBLE, INT32 and INT64, one a row",
                quoted(&names[column])
            )));
        }
    }
    let mut line = 0;
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(damaged)?;
        let count = u64::try_from(group.metadata().num_rows()).map_err(|_| {
            origin.content("the file is Parquet and promises fewer than no rows".to_owned())
        })?;
        memory::check(count.saturating_mul(8 * wanted.len() as u64))
            .map_err(|error| origin.content(format!("too large: {error}")))?;
        let values: Vec<Vec<f64>> = wanted
            .iter()
            .map(|&column| {
                let reader = group.get_column_reader(column).map_err(damaged)?;
                let unsigned = unsigned(&columns[column]);
                let values = column_of(reader, unsigned, count).map_err(damaged)?;
                whole(&values, count, line, column, origin)?;
                Ok(values)
            })
            .collect::<Result<_, FileError>>()?;
        push(count, &values, &mut line, &layout, rows)?;
    }
    Ok(())
}

fn push<const D: usize>(
    count: u64,
    values: &[Vec<f64>],
    line: &mut u64,
    layout: &Layout<D>,
    rows: &mut Rows<'_, D>,
) -> Result<(), FileError> {
    for row in 0..count as usize {
        let point = std::array::from_fn(|axis| values[axis][row]);
        let weight = layout.weight.map_or(1.0, |_| values[D][row]);
        *line += 1;
        rows.push(*line, layout, point, weight)?;
    }
    Ok(())
}

/// Whether a column has a number in each row, or at most one.
fn numbers(column: &ColumnDescriptor) -> bool {
    let kind = column.physical_type();
    let plain = matches!(kind, Type::FLOAT | Type::DOUBLE | Type::INT32 | Type::INT64);
    // dates, times and decimals are whole numbers of something
    let whole = |logical: &LogicalType| matches!(logical, LogicalType::Integer(_));
    let meant = column.logical_type_ref().is_none_or(whole)
        && (column.converted_type() == ConvertedType::NONE
            || unsigned(column)
            || matches!(
                column.converted_type(),
                ConvertedType::INT_8
                    | ConvertedType::INT_16
                    | ConvertedType::INT_32
                    | ConvertedType::INT_64
            ));
    plain && meant && column.max_rep_level() == 0 && column.max_def_level() <= 1
}

fn unsigned(column: &ColumnDescriptor) -> bool {
    matches!(
        column.converted_type(),
        ConvertedType::UINT_8
            | ConvertedType::UINT_16
            | ConvertedType::UINT_32
            | ConvertedType::UINT_64
    )
}

/// Refuses a column with fewer values than rows, or with more; an empty cell is not a number.
fn whole(
    values: &[f64],
    count: u64,
    before: u64,
    column: usize,
    origin: &Origin,
) -> Result<(), FileError> {
    if values.len() as u64 == count {
        return Ok(());
    }
    let (row, what) = if (values.len() as u64) < count {
        let row = before + values.len() as u64 + 1;
        (
            row,
            "the file ends before this cell, which its list of columns promises",
        )
    } else {
        let row = before + count + 1;
        (
            row,
            "the column goes on here, where its group of rows has ended",
        )
    };
    Err(origin.content_at(Some(row), Some(column + 1), what.to_owned()))
}

/// All values of a column of a group, but few beyond the `promised`; not a number where a cell is empty.
fn column_of(
    reader: ColumnReader,
    unsigned: bool,
    promised: u64,
) -> Result<Vec<f64>, ParquetError> {
    match reader {
        ColumnReader::FloatColumnReader(reader) => drained(reader, promised, |&x| f64::from(x)),
        ColumnReader::DoubleColumnReader(reader) => drained(reader, promised, |&x| x),
        ColumnReader::Int32ColumnReader(reader) if unsigned => {
            drained(reader, promised, |&x| f64::from(x.cast_unsigned()))
        }
        ColumnReader::Int32ColumnReader(reader) => drained(reader, promised, |&x| f64::from(x)),
        ColumnReader::Int64ColumnReader(reader) if unsigned => {
            drained(reader, promised, |&x| x.cast_unsigned() as f64)
        }
        ColumnReader::Int64ColumnReader(reader) => drained(reader, promised, |&x| x as f64),
        _ => Err(ParquetError::General(
            "a column changes its type".to_owned(),
        )),
    }
}

fn drained<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    promised: u64,
    number: impl Fn(&T::T) -> f64,
) -> Result<Vec<f64>, ParquetError> {
    let mut all = Vec::new();
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    loop {
        values.clear();
        levels.clear();
        let (rows, _, _) = reader.read_records(BATCH, Some(&mut levels), None, &mut values)?;
        // memory was asked for as many as were promised
        if rows == 0 || all.len() as u64 > promised {
            return Ok(all);
        }
        if levels.is_empty() {
            all.extend(values.iter().map(&number));
        } else {
            let mut present = values.iter();
            all.extend(levels.iter().map(|&level| match level {
                0 => f64::NAN,
                _ => present.next().map_or(f64::NAN, &number),
            }));
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use crate::sample::file::{Column, Request, read};
    use crate::space::Domain;
    use parquet::data_type::{DoubleType, FloatType, Int32Type};
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    use std::sync::Arc;

    fn written(path: &std::path::Path) {
        let schema = "message m { REQUIRED DOUBLE x; OPTIONAL FLOAT gap; REQUIRED INT32 w (INTEGER(32,false)); REQUIRED BINARY name; REQUIRED INT32 day (DATE); }";
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let file = std::fs::File::create(path).unwrap();
        let mut writer = SerializedFileWriter::new(file, schema, Arc::default()).unwrap();
        for group in [[0.25, 0.5], [1e300, -3.0]] {
            let mut rows = writer.next_row_group().unwrap();
            let mut column = rows.next_column().unwrap().unwrap();
            column
                .typed::<DoubleType>()
                .write_batch(&group, None, None)
                .unwrap();
            column.close().unwrap();
            let mut column = rows.next_column().unwrap().unwrap();
            let gap = column.typed::<FloatType>();
            gap.write_batch(&[1.5], Some(&[1, 0]), None).unwrap();
            column.close().unwrap();
            let mut column = rows.next_column().unwrap().unwrap();
            column
                .typed::<Int32Type>()
                .write_batch(&[-1, 1], None, None)
                .unwrap();
            column.close().unwrap();
            let mut column = rows.next_column().unwrap().unwrap();
            let names = [b"a".to_vec().into(), b"b".to_vec().into()];
            column
                .typed::<parquet::data_type::ByteArrayType>()
                .write_batch(&names, None, None)
                .unwrap();
            column.close().unwrap();
            let mut column = rows.next_column().unwrap().unwrap();
            column
                .typed::<Int32Type>()
                .write_batch(&[20_000, 20_001], None, None)
                .unwrap();
            column.close().unwrap();
            rows.close().unwrap();
        }
        writer.close().unwrap();
    }

    #[test]
    fn columns_are_read_by_name_over_groups_and_faults_are_located() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sample.parquet");
        written(&path);
        let ask = |column, weight| {
            let request = Request {
                columns: [Column::Named(column)],
                weight,
                domain: Domain::whole(),
            };
            read::<1>(&path, &request).map_err(|error| error.to_string())
        };
        let sample = ask("x", Some("w")).unwrap();
        assert_eq!(sample.points(), [[0.25], [0.5], [1e300], [-3.0]]);
        // 2³² - 1 and 1, not -1 and 1
        let share = sample.weight(0) / sample.weight(1);
        assert!((share / 4_294_967_295.0 - 1.0).abs() < 1e-12, "{share}");
        for (column, says) in [
            ("gap", ":2:2: NaN is not a finite number"),
            ("name", "holds no plain numbers"),
            ("day", "holds no plain numbers"),
            ("y", "no column"),
        ] {
            let error = ask(column, None).unwrap_err();
            assert!(error.contains(says), "{error}");
        }
        let bytes = std::fs::read(&path).unwrap();
        for cut in [4, 40, bytes.len() / 2, bytes.len() - 3] {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            assert!(ask("x", None).unwrap_err().contains("Parquet"), "{cut}");
        }
    }
}
