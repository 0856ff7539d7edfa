//! The figure of an estimate at one place against a swept parameter: its mean and its spread.

use super::Material;
use super::sweep::{members, parameter};
use crate::experiment::Figure;
use crate::experiment::results::{Group, Outcome};
use crate::report::figure::{Axis, Measured, Part, Svg, Sweep, Trace};
use crate::space::Point;

/// The mean of the estimate in the cell nearest to a place, one deviation on each side, and the truth there.
pub(super) fn draw<const D: usize>(
    material: &Material<'_, D>,
    figure: &Figure,
    group: &Group<D>,
    of: &str,
    place: &[f64],
) -> Svg {
    let cell = nearest(group, place);
    let members = members(material, of);
    let truth = group.truth.as_ref().map(|truth| truth[cell]);
    let measured = |&(at, number): &(f64, usize)| {
        let outcome = &group.outcomes[number];
        let value = outcome.tally.mean()[cell] + truth.unwrap_or(0.0);
        let spread = outcome.tally.deviation().map_or(0.0, |all| all[cell]);
        Measured {
            at,
            value,
            low: value - spread,
            high: value + spread,
        }
    };
    let exact = |deviations: f64| -> Vec<(f64, f64)> {
        members
            .iter()
            .filter_map(|&(at, number)| {
                let (mean, spread) = moments(&group.outcomes[number], cell)?;
                let value = if deviations == 0.0 {
                    mean
                } else {
                    deviations.mul_add(spread, mean)
                };
                value.is_finite().then_some((at, value))
            })
            .collect()
    };
    let mut traces = vec![Trace {
        name: "mean".to_owned(),
        part: Part::Bias,
        exact: exact(0.0),
        measured: members.iter().map(measured).collect(),
    }];
    for (name, deviations) in [("+ 1 deviation", 1.0), ("− 1 deviation", -1.0)] {
        let exact = exact(deviations);
        if !exact.is_empty() {
            traces.push(Trace {
                name: name.to_owned(),
                part: Part::Variance,
                exact,
                measured: Vec::new(),
            });
        }
    }
    if let (Some(truth), [first, .., last]) = (truth, &members[..]) {
        traces.push(Trace {
            name: "truth".to_owned(),
            part: Part::Total,
            exact: vec![(first.0, truth), (last.0, truth)],
            measured: Vec::new(),
        });
    }
    let positive = truth.is_none_or(|truth| truth > 0.0)
        && traces[0].measured.iter().all(|mean| mean.value > 0.0);
    let y = Axis::new(at(&group.grid.centre(cell)), "");
    Sweep {
        title: String::new(),
        description: figure.caption.clone(),
        x: Axis::new(parameter(material, of), "").logarithmic(),
        // the spread of few and of many differ by orders of magnitude
        y: if positive { y.logarithmic() } else { y },
        traces,
        interval: "± one deviation".to_owned(),
        ..Sweep::default()
    }
    .draw()
}

/// The exact mean and deviation in a cell, where they are known.
fn moments(outcome: &Outcome, cell: usize) -> Option<(f64, f64)> {
    Some((
        outcome.expected.as_ref()?[cell],
        outcome.spread.as_ref()?[cell],
    ))
}

/// The cell whose centre is nearest to a place.
fn nearest<const D: usize>(group: &Group<D>, place: &[f64]) -> usize {
    let squared = |cell: usize| -> f64 {
        let centre = group.grid.centre(cell);
        centre.iter().zip(place).map(|(a, b)| (a - b).powi(2)).sum()
    };
    (0..group.grid.len())
        .min_by(|&a, &b| squared(a).total_cmp(&squared(b)))
        .unwrap_or(0)
}

fn at<const D: usize>(place: &Point<D>) -> String {
    let place: Vec<String> = place
        .iter()
        .map(|&x| crate::experiment::significant(x, 4))
        .collect();
    match &place[..] {
        [x] => format!("estimate at x = {x}"),
        _ => format!("estimate at ({})", place.join(", ")),
    }
}
