//! `grid`: where estimates are evaluated.

use super::node::{Item, Reader};
use super::problem::Problem;
use super::{CELLS, value};
use crate::experiment::GridSpec;
use crate::parameter::{Absent, Kind, Parameter, Value};
use crate::space::GridError;
use toml::de::DeValue;

/// `grid`.
pub(crate) const GRID: &[Parameter] = &[
    Parameter::required(
        "low",
        Kind::Real,
        "the lower end; in the plane of each axis: [x, y]",
    ),
    Parameter::required(
        "high",
        Kind::Real,
        "the upper end; in the plane of each axis: [x, y]",
    ),
    Parameter::optional(
        "cells",
        Kind::Count {
            least: 1,
            most: CELLS,
        },
        Absent::Number(GridSpec::CELLS as f64),
        "how many cells; in the plane on each axis: [x, y], 128 by default",
    ),
];

/// Reads a grid of so many dimensions. Where those are not known, as the source is at fault, it is read as the kind that it looks like, for what else is wrong
/// with it.
pub(super) fn read(
    reader: &mut Reader,
    item: &Item<'_>,
    dimensions: Option<usize>,
) -> Option<GridSpec> {
    let low = item.get_ref().get("low");
    let looks = if low.is_some_and(|low| low.get_ref().is_array()) {
        2
    } else {
        1
    };
    match dimensions.unwrap_or(looks) {
        1 => on_a_line(reader, item),
        dimensions => in_the_plane(reader, item, dimensions),
    }
}

fn on_a_line(reader: &mut Reader, item: &Item<'_>) -> Option<GridSpec> {
    let table = reader.table(item, "`grid`")?;
    let read = value::values(reader, GRID, table, "`grid`");
    if !read.complete {
        return None;
    }
    let spec = GridSpec {
        low: vec![read.values.number("low")?],
        high: vec![read.values.number("high")?],
        cells: vec![read.values.count("cells")? as usize],
    };
    if let Err(error) = spec.grid::<1>() {
        let place = match error {
            GridError::Bounds { .. } => "high",
            _ => "cells",
        };
        reader.report(Problem::at(read.place(place), error.to_string()));
        return None;
    }
    Some(spec)
}

/// `low`, `high` and `cells` are lists of a value for each axis, or one for all.
fn in_the_plane(reader: &mut Reader, item: &Item<'_>, dimensions: usize) -> Option<GridSpec> {
    let mut table = reader.table(item, "`grid`")?;
    let mut read = Vec::new();
    for parameter in GRID {
        let entry = match parameter.absent {
            Absent::Required => table.need(reader, parameter.name, parameter.help),
            _ => table.take(parameter.name),
        };
        read.push(entry.map(|entry| {
            (
                entry.item.span(),
                axes(reader, parameter, entry.item, dimensions),
            )
        }));
    }
    let allowed: Vec<&str> = GRID.iter().map(|parameter| parameter.name).collect();
    if table.finish(reader, &allowed) {
        return None;
    }
    let [low, high, cells] = <[_; 3]>::try_from(read).ok()?;
    let ((_, low), (high_span, high)) = (low?, high?);
    let (cells_span, cells) = cells.unwrap_or_else(|| {
        let each = GridSpec::default_cells(dimensions) as f64;
        (item.span(), Some(vec![each; dimensions]))
    });
    let spec = GridSpec {
        low: low?,
        high: high?,
        cells: cells?.into_iter().map(|cells| cells as usize).collect(),
    };
    let error = spec.grid::<2>().err().map(|error| error.to_string());
    let many = (spec.cells.iter().map(|c| *c as f64).product::<f64>() > CELLS as f64)
        .then(|| format!("a grid may have {CELLS} cells in all"));
    if let Some(what) = many.or(error) {
        let ordered = spec
            .low
            .iter()
            .zip(&spec.high)
            .all(|(low, high)| low < high);
        let span = if ordered { cells_span } else { high_span };
        reader.report(Problem::at(span, what));
        return None;
    }
    Some(spec)
}

/// A value for each axis: a list of them, or one for all.
fn axes(
    reader: &mut Reader,
    parameter: &Parameter,
    item: &Item<'_>,
    dimensions: usize,
) -> Option<Vec<f64>> {
    let number = |reader: &mut Reader, item: &Item<'_>| {
        Some(match value::value(reader, parameter, item)? {
            Value::Count(count) => count as f64,
            Value::Number(number) => number,
            _ => return None,
        })
    };
    let DeValue::Array(list) = item.get_ref() else {
        return number(reader, item).map(|value| vec![value; dimensions]);
    };
    if list.len() != dimensions {
        reader.report(
            Problem::at(
                item.span(),
                format!(
                    "`{}` has {} values for {dimensions} axes",
                    parameter.name,
                    list.len()
                ),
            )
            .allowed(format!("a list of {dimensions}, or one value for all axes")),
        );
        return None;
    }
    let read: Vec<Option<f64>> = list.iter().map(|item| number(reader, item)).collect();
    read.into_iter().collect()
}
