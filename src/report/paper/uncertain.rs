//! The figure `uncertainty`: what estimates of the error say, along a line, beside the true error.

use super::Material;
use super::pictures::{axis_of, chosen};
use crate::experiment::Figure;
use crate::experiment::results::{Group, Outcome};
use crate::experiment::uncertainty::{Quantity, UncertaintyKind};
use crate::report::figure::{Axis, Multiples, Role, Series, Small, Svg};

/// Roots of mean squared errors, true and estimated, one panel an estimator: on a line everywhere, in the plane along the row of cells nearest to `at` on the second axis.
/// With `calibrated` local differences are multiplied by the root of their fitted factor.
pub(super) fn draw<const D: usize>(
    material: &Material<'_, D>,
    figure: &Figure,
    group: &Group<D>,
    at: Option<f64>,
    calibrated: bool,
) -> Svg {
    let (x, places) = line(group, at);
    let of = |values: &[f64], factor: f64| -> Vec<f64> {
        places
            .iter()
            .map(|&place| (factor * values[place]).sqrt())
            .collect()
    };
    let panel = |(_, outcome): (usize, &Outcome)| {
        let mut series = Vec::new();
        for (number, spec) in material.bench.experiment().uncertainties.iter().enumerate() {
            let Some((squared, errors)) = outcome.squared_errors(number) else {
                continue;
            };
            if series.is_empty() {
                series.push(Series {
                    name: "true error".to_owned(),
                    x: x.clone(),
                    y: of(&errors, 1.0),
                    role: Role::Truth,
                });
            }
            // batches state a variance and have no factor left open
            let open = calibrated && matches!(spec.kind, UncertaintyKind::Differences { .. });
            let factor = outcome
                .uncertainty(number, Quantity::Factor, 0.95, group)
                .filter(|_| open)
                .map_or(1.0, |found| found.value);
            series.push(Series {
                name: spec.name.clone(),
                x: x.clone(),
                y: of(&squared, factor),
                role: Role::Estimate(number),
            });
        }
        Small {
            title: outcome.name.clone(),
            series,
        }
    };
    let panels: Vec<Small> = chosen(figure, group).map(panel).collect();
    Multiples {
        title: String::new(),
        description: figure.caption.clone(),
        x: axis_of(material, group, 0),
        y: Axis::new("root mean squared error", ""),
        columns: match panels.len() {
            0 | 1 => 1,
            2 | 4 => 2,
            _ => 3,
        },
        shared: false,
        panels,
    }
    .draw()
}

/// The abscissae of a row of cells, and the numbers of its cells.
fn line<const D: usize>(group: &Group<D>, at: Option<f64>) -> (Vec<f64>, Vec<usize>) {
    let grid = &group.grid;
    let cells = grid.cells();
    let x: Vec<f64> = (0..cells[0]).map(|i| grid.coordinate(0, i)).collect();
    let places = if D == 1 {
        (0..cells[0]).collect()
    } else {
        let last = D - 1;
        let middle = 0.5 * (grid.low()[last] + grid.high()[last]);
        let along = (at.unwrap_or(middle) - grid.low()[last]) / grid.width(last);
        let row = (along.max(0.0) as usize).min(cells[last] - 1);
        (0..cells[0]).map(|i| i * cells[last] + row).collect()
    };
    (x, places)
}
