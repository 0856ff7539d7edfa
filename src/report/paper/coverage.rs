//! The figure of how often intervals hold what they are about.

use super::Material;
use super::pictures::{chosen, place_axis};
use crate::accuracy::reach;
use crate::experiment::Figure;
use crate::experiment::results::{Group, Outcome};
use crate::report::figure::{Axis, Multiples, Role, Series, Small, Svg};

/// One panel an estimator: the shares that hold the mean and the truth along the line, and what is expected of a normal estimate with the exact bias.
pub(super) fn draw(material: &Material<'_>, figure: &Figure, group: &Group) -> Svg {
    let confidence = material.bench.experiment().interval.unwrap_or(0.95);
    let x: Vec<f64> = group.grid.centres().map(|[x]| x).collect();
    let curve = |name: &str, y: Vec<f64>, role: Role| Series {
        name: name.to_owned(),
        x: x.clone(),
        y,
        role,
    };
    let panel = |outcome: &Outcome| -> Option<Small> {
        let coverage = outcome.coverage.as_ref()?;
        let share = |held: &[u64]| -> Vec<f64> {
            (held.iter())
                .map(|held| *held as f64 / coverage.count as f64)
                .collect()
        };
        let normal: Option<Vec<f64>> = (0..x.len())
            .map(|i| outcome.normal_coverage(group, i, reach(confidence)))
            .collect();
        let mut series: Vec<Series> = Vec::new();
        series.extend(normal.map(|y| curve("truth, theory", y, Role::Estimate(2))));
        if !coverage.truth.is_empty() {
            series.push(curve(
                "truth, measured",
                share(&coverage.truth),
                Role::Estimate(1),
            ));
        }
        if !coverage.mean.is_empty() {
            series.push(curve(
                "mean, measured",
                share(&coverage.mean),
                Role::Estimate(0),
            ));
        }
        Some(Small {
            title: outcome.name.clone(),
            series,
        })
    };
    let panels: Vec<Small> = chosen(figure, group)
        .filter_map(|(_, outcome)| panel(outcome))
        .collect();
    // shares near one are to be told apart, so that the axis does not begin at 0
    let least = (panels.iter())
        .flat_map(|panel| {
            panel
                .series
                .iter()
                .flat_map(|series| series.y.iter().copied())
        })
        .fold(0.9, f64::min);
    Multiples {
        title: String::new(),
        description: figure.caption.clone(),
        x: place_axis(material, group),
        y: Axis::new(format!("share, nominal {confidence}"), "").over((least - 0.02).max(0.0), 1.0),
        columns: panels.len().clamp(1, 2),
        shared: true,
        panels,
    }
    .draw()
}
