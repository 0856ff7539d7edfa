//! `[[region]]`.

use super::node::{Reader, Table};
use super::problem::Problem;
use super::value;
use crate::experiment::GridSpec;
use crate::experiment::region::{RegionSpec, Ring};
use crate::parameter::{Absent, Kind, Parameter};
use crate::space::Grid;

const fn end(name: &'static str, help: &'static str) -> Parameter {
    Parameter::optional(name, Kind::Real, Absent::Unset, help)
}

/// `[[region]]`.
pub(crate) const REGION: &[Parameter] = &[
    Parameter::required("name", Kind::Text, "what it is called in tables and claims"),
    end("x", "the centre of a ring; in the plane with `y`"),
    end("y", "the centre of a ring").only_in(2),
    Parameter::optional(
        "from",
        Kind::Positive,
        Absent::Unset,
        "at least so far from the centre; 0 by default",
    ),
    Parameter::optional(
        "to",
        Kind::Positive,
        Absent::Unset,
        "at most so far from the centre; any distance by default",
    ),
    end("low-x", "no place below; none by default"),
    end("high-x", "no place above; none by default"),
    end("low-y", "no place below; none by default").only_in(2),
    end("high-y", "no place above; none by default").only_in(2),
];

/// Reads one `[[region]]` of so many dimensions.
pub(super) fn region(
    reader: &mut Reader,
    table: Table<'_>,
    dimensions: Option<usize>,
    grid: Option<&GridSpec>,
    known: &mut Vec<String>,
) -> Option<RegionSpec> {
    let span = table.span.clone();
    let read = value::values(reader, REGION, table, "a region");
    if !read.complete {
        return None;
    }
    let values = &read.values;
    let name = values.word("name")?.to_owned();
    let dimensions = dimensions?;
    let mut refuse = |key: &str, what: String| {
        let span = if read.given(key) {
            read.place(key)
        } else {
            span.clone()
        };
        reader.report(Problem::at(span, what));
        None
    };
    if name.trim().is_empty() {
        return refuse("name", "the name of a region is empty".to_owned());
    }
    if known.contains(&name) {
        return refuse("name", format!("there is a region \"{name}\" already"));
    }
    if dimensions == 1
        && let Some(key) = ["y", "low-y", "high-y"]
            .into_iter()
            .find(|key| read.given(key))
    {
        return refuse(key, format!("`{key}` has no meaning on a line"));
    }
    let axes = &["x", "y"][..dimensions];
    let centre: Vec<f64> = axes.iter().filter_map(|axis| values.number(axis)).collect();
    let (from, to) = (values.number("from"), values.number("to"));
    let ring = if centre.len() == dimensions {
        let (from, to) = (from.unwrap_or(0.0), to.unwrap_or(f64::INFINITY));
        if to < from {
            return refuse("to", format!("`to` = {to} is below `from` = {from}"));
        }
        if from == 0.0 && to.is_infinite() {
            return refuse(
                "x",
                "a centre says nothing without `from` or `to`".to_owned(),
            );
        }
        Some(Ring { centre, from, to })
    } else if !centre.is_empty() || from.is_some() || to.is_some() {
        return refuse(
            "from",
            format!("a ring needs its centre: `{}`", axes.join("` and `")),
        );
    } else {
        None
    };
    let limit = |end: &str, axis: &str, absent: f64| {
        values.number(&format!("{end}-{axis}")).unwrap_or(absent)
    };
    let limits: Vec<[f64; 2]> = axes
        .iter()
        .map(|axis| {
            [
                limit("low", axis, f64::NEG_INFINITY),
                limit("high", axis, f64::INFINITY),
            ]
        })
        .collect();
    let spec = RegionSpec { name, limits, ring };
    if let Some(grid) = grid
        && !holds(&spec, grid)
    {
        return refuse(
            "name",
            format!(
                "no cell of the grid has its centre in the region \"{}\"",
                spec.name
            ),
        );
    }
    known.push(spec.name.clone());
    Some(spec)
}

/// Whether any cell of the grid has its centre in the region.
fn holds(spec: &RegionSpec, grid: &GridSpec) -> bool {
    fn any<const D: usize>(spec: &RegionSpec, grid: &Grid<D>) -> bool {
        grid.centres().any(|x| spec.contains(x))
    }
    match spec.limits.len() {
        1 => grid.grid::<1>().is_ok_and(|grid| any(spec, &grid)),
        _ => grid.grid::<2>().is_ok_and(|grid| any(spec, &grid)),
    }
}
