//! The figure of errors with intervals.

use super::pictures::chosen;
use crate::experiment::results::{Group, Outcome};
use crate::experiment::table::exact_counterpart;
use crate::experiment::{Figure, Measure};
use crate::report::figure::{Axis, Comparison, Row, Svg};

/// One row an estimator.
pub(super) fn draw<const D: usize>(figure: &Figure, group: &Group<D>, measure: &str) -> Svg {
    let measure = named(measure);
    let rows = chosen(figure, group).filter_map(|(number, outcome)| {
        let name = outcome.name.clone();
        row(name, number, outcome, measure)
    });
    comparison(figure, measure, rows.collect())
}

/// One row a source, where it is one estimator that is compared on several.
pub(super) fn over_sources<const D: usize>(
    figure: &Figure,
    groups: &[&Group<D>],
    measure: &str,
) -> Option<Svg> {
    let measure = named(measure);
    let mut rows = Vec::new();
    for (number, group) in groups.iter().enumerate() {
        let part = figure
            .region
            .as_deref()
            .and_then(|region| group.within(region));
        let group = part.as_ref().unwrap_or(group);
        let mut shown = chosen(figure, group);
        let (Some((_, outcome)), None) = (shown.next(), shown.next()) else {
            return None;
        };
        rows.extend(row(group.name.clone(), number, outcome, measure));
    }
    (groups.len() > 1).then(|| comparison(figure, measure, rows))
}

fn named(measure: &str) -> Measure {
    Measure::ALL
        .into_iter()
        .find(|m| m.name() == measure)
        .unwrap_or(Measure::Mise)
}

fn row(name: String, colour: usize, outcome: &Outcome, measure: Measure) -> Option<Row> {
    let interval = outcome.measures.get(&measure)?;
    Some(Row {
        name,
        colour,
        value: interval.value,
        low: interval.low,
        high: interval.high,
        exact: exact_counterpart(measure)
            .and_then(|exact| outcome.measures.get(&exact))
            .map(|exact| exact.value),
    })
}

fn comparison(figure: &Figure, measure: Measure, rows: Vec<Row>) -> Svg {
    Comparison {
        title: String::new(),
        description: figure.caption.clone(),
        axis: Axis::new(measure.name().to_uppercase(), ""),
        interval: "95 % interval".to_owned(),
        rows,
    }
    .draw()
}
