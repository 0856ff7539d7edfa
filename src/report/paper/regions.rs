//! Tables by region: where in the domain each estimator errs.

use crate::experiment::Measure;
use crate::experiment::results::{Group, Outcome};
use crate::report::page::{Cell, Table};

/// The whole grid and each region, by name.
pub(super) fn parts<const D: usize>(group: &Group<D>) -> Vec<(String, Option<Group<D>>)> {
    let named = group.regions.iter().filter_map(|(name, _)| {
        let part = group.within(name)?;
        Some((name.clone(), Some(part)))
    });
    [("whole grid".to_owned(), None)]
        .into_iter()
        .chain(named)
        .collect()
}

/// The area over which relative errors are taken: where the truth is not next to nothing.
pub(super) fn area<const D: usize>(whole: &Group<D>, part: &Group<D>) -> f64 {
    let Some(truth) = &whole.truth else {
        return 0.0;
    };
    let peak = truth.iter().copied().fold(0.0, f64::max);
    let floor = crate::accuracy::RELATIVE_FLOOR * peak;
    let counts = |i: usize| {
        truth[i] > 0.0 && truth[i] >= floor && part.mask.as_ref().is_none_or(|mask| mask[i])
    };
    (0..truth.len()).filter(|&i| counts(i)).count() as f64 * whole.grid.cell_measure()
}

/// The root of the mean squared relative error over an area, with its standard error.
pub(super) fn relative(outcome: &Outcome, area: f64) -> Option<(f64, Option<f64>)> {
    let mire = outcome.measures.get(&Measure::Mire)?;
    if area <= 0.0 {
        return None;
    }
    let root = (mire.value / area).sqrt();
    // d√v = dv / (2 √v)
    let error = mire.standard_error.filter(|_| root > 0.0);
    Some((root, error.map(|error| error / area / (2.0 * root))))
}

/// The tables of a group that has regions.
pub(super) fn tables<const D: usize>(name: &str, group: &Group<D>) -> Vec<Table> {
    if group.regions.is_empty() || group.truth.is_none() {
        return Vec::new();
    }
    let parts = parts(group);
    let table = |title: &str, caption: &str, cell: &dyn Fn(&Group<D>, &Outcome) -> Cell| {
        let rows = (0..group.outcomes.len()).map(|number| {
            let cells = parts.iter().map(|(_, part)| {
                let part = part.as_ref().unwrap_or(group);
                cell(part, &part.outcomes[number])
            });
            [Cell::text(&group.outcomes[number].name)]
                .into_iter()
                .chain(cells)
                .collect()
        });
        Table {
            title: format!("{title}: {name}"),
            caption: caption.to_owned(),
            rows: rows.collect(),
            columns: ["estimator".to_owned()]
                .into_iter()
                .chain(parts.iter().map(|(name, _)| name.clone()))
                .collect(),
        }
    };
    let number = |value: f64, error: Option<f64>| match error {
        Some(error) if error > 1e-4 * value.abs() => Cell::measured(value, error),
        _ => Cell::exact(value),
    };
    vec![
        table(
            "Relative error by region",
            "The root of the mean squared relative error, over the cells of a region and over the samples, ± standard error.",
            &|part, outcome| {
                relative(outcome, area(group, part))
                    .map_or(Cell::Empty, |(value, error)| number(value, error))
            },
        ),
        table(
            "Mean error by region",
            "The mean of estimate less truth over the cells of a region and the samples, with its sign, ± standard error.",
            &|_, outcome| {
                let bias = outcome.measures.get(&Measure::Bias);
                bias.map_or(Cell::Empty, |bias| number(bias.value, bias.standard_error))
            },
        ),
        table(
            "Spread by region",
            "The standard deviation of an estimate over the samples, root mean square over the cells of a region.",
            &|part, outcome| {
                let cells = part.mask.as_ref().map_or(group.grid.len(), |mask| {
                    mask.iter().filter(|inside| **inside).count()
                });
                let area = cells as f64 * group.grid.cell_measure();
                let variance = outcome.measures.get(&Measure::Variance);
                variance.map_or(Cell::Empty, |v| Cell::exact((v.value / area).sqrt()))
            },
        ),
    ]
}
