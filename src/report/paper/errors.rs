//! The figure of errors with intervals.

use super::Material;
use super::pictures::chosen;
use crate::experiment::results::Group;
use crate::experiment::table::exact_counterpart;
use crate::experiment::{Figure, Measure};
use crate::report::figure::{Axis, Comparison, Row, Svg};

pub(super) fn draw<const D: usize>(
    _material: &Material<'_, D>,
    figure: &Figure,
    group: &Group<D>,
    measure: &str,
) -> Svg {
    let measure = Measure::ALL
        .into_iter()
        .find(|m| m.name() == measure)
        .unwrap_or(Measure::Mise);
    let rows = chosen(figure, group).filter_map(|(number, outcome)| {
        let interval = outcome.measures.get(&measure)?;
        Some(Row {
            name: outcome.name.clone(),
            colour: number,
            value: interval.value,
            low: interval.low,
            high: interval.high,
            exact: exact_counterpart(measure)
                .and_then(|exact| outcome.measures.get(&exact))
                .map(|exact| exact.value),
        })
    });
    Comparison {
        title: String::new(),
        description: figure.caption.clone(),
        axis: Axis::new(measure.name().to_uppercase(), ""),
        interval: "95 % interval".to_owned(),
        rows: rows.collect(),
    }
    .draw()
}
