//! The figure of errors against the sample size.

use super::Material;
use super::pictures::chosen;
use crate::experiment::judge::slope;
use crate::experiment::results::{CONFIDENCE, Group};
use crate::experiment::table::exact_counterpart;
use crate::experiment::{Figure, Measure};
use crate::report::figure::{Axis, Measured, Part, Svg, Sweep, Trace};
use crate::report::text::minus;

/// A measure of every estimator at all sizes of the source of `group`, with the slope of its exact values, or else of the simulated ones, at its end.
pub(super) fn draw<const D: usize>(
    material: &Material<'_, D>,
    figure: &Figure,
    group: &Group<D>,
    measure: &str,
) -> Svg {
    let measure = Measure::ALL
        .into_iter()
        .find(|m| m.name() == measure)
        .unwrap_or(Measure::Mise);
    let exact = exact_counterpart(measure);
    let groups: Vec<&Group<D>> = (material.results.groups.iter())
        .filter(|other| other.source == group.source)
        .collect();
    let traces = chosen(figure, group).map(|(number, outcome)| {
        let name = outcome.name.as_str();
        let of = |measure: Measure| {
            groups.iter().filter_map(move |group| {
                let interval = group.outcome(name)?.measures.get(&measure)?;
                Some((group.draws as f64, *interval))
            })
        };
        let known: Vec<(f64, f64)> = exact
            .map(|exact| of(exact).map(|(n, interval)| (n, interval.value)).collect())
            .unwrap_or_default();
        let measured: Vec<Measured> = of(measure)
            .map(|(at, interval)| Measured {
                at,
                value: interval.value,
                low: interval.low,
                high: interval.high,
            })
            .collect();
        let slope = exact
            .and_then(|exact| slope(&groups, name, exact, CONFIDENCE))
            .or_else(|| slope(&groups, name, measure, CONFIDENCE));
        Trace {
            name: match slope {
                Some(slope) => Sweep::name_with(name, &minus(&format!("{:.3}", slope.value))),
                None => name.to_owned(),
            },
            part: Part::Other(number),
            exact: known,
            measured,
        }
    });
    Sweep {
        title: String::new(),
        description: figure.caption.clone(),
        x: Axis::new("sample size n", "").logarithmic(),
        y: Axis::new(measure.name().to_uppercase(), "").logarithmic(),
        traces: traces.collect(),
        interval: "95 % interval".to_owned(),
        ..Sweep::default()
    }
    .draw()
}
