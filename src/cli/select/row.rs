//! What one selector says, as a row of a table.

use super::super::output::{Output, Shortest};
use super::super::stop::Stop;
use crate::experiment::significant;
use crate::kernel::{Bandwidth, Kernel, Shape};
use crate::selector::{SelectError, Selection};
use crate::space::Warning;
use serde::Serialize;
use std::time::Instant;

/// Which columns there are.
#[derive(Clone, Copy)]
pub(super) enum Columns {
    /// Bandwidth, deviation, canonical, for this kernel.
    Line(Shape),
    /// The bandwidths of both axes.
    Plane,
}

/// What one selector says. Without a bandwidth the note says why.
#[derive(Serialize)]
pub(super) struct Row {
    pub selector: &'static str,
    pub bandwidth: Option<f64>,
    /// On the second axis of the plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    bandwidth_y: Option<f64>,
    /// h √k₂, on the line.
    #[serde(skip_serializing_if = "Option::is_none")]
    deviation: Option<f64>,
    /// h / δ₀, on the line.
    #[serde(skip_serializing_if = "Option::is_none")]
    canonical: Option<f64>,
    milliseconds: f64,
    pub note: String,
}

/// All warnings as one text.
pub(super) fn told(warnings: &[Warning]) -> String {
    let one = |Warning { what, hint }: &Warning| format!("{what}; {hint}");
    warnings.iter().map(one).collect::<Vec<_>>().join(". ")
}

impl Row {
    pub(super) fn of<const D: usize>(
        selector: &'static str,
        select: impl FnOnce() -> Result<Selection<D>, SelectError>,
        columns: Columns,
    ) -> Self {
        let start = Instant::now();
        let selected = select();
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        let (widths, note) = match &selected {
            Ok(selection) => {
                let widths: &[f64] = match &selection.bandwidth {
                    Bandwidth::Fixed(h) => h,
                    _ => &[],
                };
                (widths, told(&selection.warnings))
            }
            Err(error) => (&[][..], error.to_string()),
        };
        let bandwidth = widths.first().copied();
        let on_line = |of: fn(f64, Shape) -> f64| match columns {
            Columns::Line(shape) => bandwidth.map(|h| of(h, shape)),
            Columns::Plane => None,
        };
        Self {
            selector,
            bandwidth,
            bandwidth_y: widths.get(1).copied(),
            deviation: on_line(|h, shape| h * shape.variance().sqrt()),
            canonical: on_line(|h, shape| h / shape.canonical_scale()),
            milliseconds,
            note,
        }
    }
}

pub(super) fn table(output: &mut Output, rows: &[Row], columns: Columns) -> Result<(), Stop> {
    let header: &[u8] = match columns {
        Columns::Line(_) => b"selector,bandwidth,deviation,canonical,milliseconds,note\n",
        Columns::Plane => b"selector,bandwidth,bandwidth_y,milliseconds,note\n",
    };
    output.write_all(header)?;
    for row in rows {
        write!(output, "{}", row.selector)?;
        let numbers: &[Option<f64>] = match columns {
            Columns::Line(_) => &[row.bandwidth, row.deviation, row.canonical],
            Columns::Plane => &[row.bandwidth, row.bandwidth_y],
        };
        for number in numbers {
            match number {
                Some(number) => write!(output, ",{}", Shortest(*number))?,
                None => output.write_all(b",")?,
            }
        }
        write!(output, ",{}", significant(row.milliseconds, 3))?;
        noted(output, &row.note)?;
    }
    Ok(())
}

/// The last cell of a row, which may hold commas.
pub(super) fn noted(output: &mut Output, note: &str) -> Result<(), Stop> {
    if note.is_empty() {
        output.write_all(b",\n")?;
    } else {
        writeln!(output, ",\"{}\"", note.replace('"', "\"\""))?;
    }
    Ok(())
}
