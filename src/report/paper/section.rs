//! Cross-sections: truth, estimates, errors or sizes along a straight line through the plane.

use super::Material;
use super::pictures::chosen;
use super::plane::{mean, of_first_sample};
use crate::experiment::results::{Group, Outcome};
use crate::experiment::run::RunError;
use crate::experiment::{Figure, FigureKind};
use crate::report::figure::{Axis, Curves, Role, Series, Svg};
use crate::space::{Evaluation, Point, Targets};

/// Places along a cross-section: two to a pixel of the widest figure.
const PLACES: usize = 1440;

/// The way along a line.
struct Way {
    from: Point<2>,
    to: Point<2>,
    /// The axis that the line runs along, if it does.
    axis: Option<usize>,
    length: f64,
}

impl Way {
    fn new(from: Point<2>, to: Point<2>) -> Self {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        Self {
            from,
            to,
            axis: (0..2).find(|&k| (to[1 - k] - from[1 - k]).abs() < 1e-12 * length),
            length,
        }
    }

    fn shares() -> impl Iterator<Item = f64> {
        (0..PLACES).map(|i| (i as f64 + 0.5) / PLACES as f64)
    }

    fn place(&self, share: f64) -> Point<2> {
        [0, 1].map(|k: usize| share.mul_add(self.to[k] - self.from[k], self.from[k]))
    }

    /// Where a share of the way is drawn: over the axis along which the line runs, else over the way.
    fn drawn(&self, share: f64) -> f64 {
        self.axis
            .map_or(share * self.length, |k| self.place(share)[k])
    }

    fn label(&self) -> String {
        let (from, to) = (self.from, self.to);
        match self.axis {
            Some(k) => format!("{} at {} = {}", ["x", "y"][k], ["y", "x"][k], from[1 - k]),
            None => format!(
                "distance along the line from ({}, {}) to ({}, {})",
                from[0], from[1], to[0], to[1]
            ),
        }
    }

    /// The cells that the line passes through, each with the share of the way where it is nearest to the centre.
    fn cells(&self, group: &Group<2>) -> Vec<(f64, usize)> {
        let grid = &group.grid;
        let mut crossed: Vec<(f64, usize, f64)> = Vec::new();
        for share in Self::shares() {
            let place = self.place(share);
            let index = [0, 1].map(|k: usize| (place[k] - grid.low()[k]) / grid.width(k));
            let inside = |k: usize| index[k] >= 0.0 && index[k] < grid.cells()[k] as f64;
            if !(inside(0) && inside(1)) {
                continue;
            }
            let cell = index[0] as usize * grid.cells()[1] + index[1] as usize;
            let centre = grid.centre(cell);
            let away = (place[0] - centre[0]).hypot(place[1] - centre[1]);
            match crossed.last_mut() {
                Some(last) if last.1 == cell => {
                    if away < last.2 {
                        *last = (share, cell, away);
                    }
                }
                _ => crossed.push((share, cell, away)),
            }
        }
        crossed
            .into_iter()
            .map(|(share, cell, _)| (share, cell))
            .collect()
    }
}

/// The drawing of a figure that is a section.
pub(super) fn section(
    material: &Material<'_, 2>,
    figure: &Figure,
    group: &Group<2>,
) -> Result<Svg, RunError> {
    let FigureKind::Section {
        from,
        to,
        show,
        panels,
    } = &figure.kind
    else {
        unreachable!("asked for a section")
    };
    let way = Way::new(*from, *to);
    let named = |what: &str| show.iter().any(|word| word == what);
    let wants = |what: &str| show.is_empty() || named(what);
    let mut series = Vec::new();
    if wants("truth") {
        series.extend(truth(material, group, &way));
    }
    let of_sample = [wants("sample"), named("size"), named("expected-error")];
    if of_sample.contains(&true) {
        let places: Vec<Point<2>> = Way::shares().map(|share| way.place(share)).collect();
        let estimates = of_first_sample(material, group, Targets::Points(&places))?;
        for (number, outcome) in chosen(figure, group) {
            let evaluation = &estimates[number].0;
            series.extend(sampled(&way, number, outcome, evaluation, of_sample));
        }
    }
    for (number, outcome) in chosen(figure, group) {
        if named("mean") || named("band") {
            series.push(averaged(
                group,
                &way,
                (number, outcome),
                named("band"),
                wants("sample"),
            ));
        }
        if named("error") {
            series.push(erring(
                group,
                &way,
                (number, outcome),
                named("expected-error"),
            ));
        }
    }
    let value = if named("size") {
        "radius of the neighbourhood"
    } else if named("error") || named("expected-error") {
        "root mean squared error"
    } else {
        "density"
    };
    let ends = [way.drawn(0.0), way.drawn(1.0)];
    let curves = Curves {
        title: String::new(),
        description: figure.caption.clone(),
        x: Axis::new(way.label(), "").over(ends[0].min(ends[1]), ends[0].max(ends[1])),
        y: Axis::new(value, ""),
        series,
        ..Curves::default()
    };
    let estimates = |series: &&Series| series.role != Role::Truth;
    let many = curves.series.iter().filter(estimates).count();
    Ok(if *panels {
        curves.panels(many.clamp(1, 3)).draw()
    } else {
        curves.draw()
    })
}

fn truth(material: &Material<'_, 2>, group: &Group<2>, way: &Way) -> Option<Series> {
    let truth = material.bench.field(group.source)?;
    Some(Series {
        name: "truth".to_owned(),
        x: Way::shares().map(|share| way.drawn(share)).collect(),
        y: Way::shares()
            .map(|share| truth.at(way.place(share)))
            .collect(),
        role: Role::Truth,
    })
}

/// Estimate, size and expected error on the first sample, as far as they are wanted and known.
fn sampled(
    way: &Way,
    number: usize,
    outcome: &Outcome,
    evaluation: &Evaluation,
    [estimate, size, error]: [bool; 3],
) -> Vec<Series> {
    let one = |name: String, y: &Vec<f64>| Series {
        name,
        x: Way::shares().map(|share| way.drawn(share)).collect(),
        y: y.clone(),
        role: Role::Estimate(number),
    };
    let mut series = Vec::new();
    if estimate {
        series.push(one(outcome.name.clone(), &evaluation.values));
    }
    if let Some(sizes) = evaluation.sizes.as_ref().filter(|_| size) {
        series.push(one(outcome.name.clone(), sizes));
    }
    if let Some(errors) = evaluation.expected_errors.as_ref().filter(|_| error) {
        series.push(one(format!("{}, expected", outcome.name), errors));
    }
    series
}

/// The mean over replicates, with a band of one standard deviation on each side if wanted.
fn averaged(
    group: &Group<2>,
    way: &Way,
    (number, outcome): (usize, &Outcome),
    band: bool,
    beside_sample: bool,
) -> Series {
    let cells = way.cells(group);
    let mean = mean(group, outcome);
    let y: Vec<f64> = cells.iter().map(|&(_, cell)| mean[cell]).collect();
    let role = match outcome.tally.deviation().filter(|_| band) {
        Some(deviation) => {
            let beside = |sign: f64| {
                let shifted = cells.iter().zip(&y);
                shifted
                    .map(|((_, cell), mean)| sign.mul_add(deviation[*cell], *mean))
                    .collect()
            };
            Role::Band {
                colour: number,
                low: beside(-1.0),
                high: beside(1.0),
            }
        }
        None => Role::Estimate(number),
    };
    let name = outcome.name.clone();
    Series {
        name: if beside_sample {
            format!("{name}, mean")
        } else {
            name
        },
        x: cells.iter().map(|(share, _)| way.drawn(*share)).collect(),
        y,
        role,
    }
}

/// The root mean squared error over replicates.
fn erring(
    group: &Group<2>,
    way: &Way,
    (number, outcome): (usize, &Outcome),
    beside_expected: bool,
) -> Series {
    let cells = way.cells(group);
    let deviation = outcome.tally.deviation();
    let error = |cell: usize| {
        let spread = deviation.as_ref().map_or(0.0, |deviation| deviation[cell]);
        outcome.tally.mean()[cell].hypot(spread)
    };
    let name = outcome.name.clone();
    Series {
        name: if beside_expected {
            format!("{name}, actual")
        } else {
            name
        },
        x: cells.iter().map(|(share, _)| way.drawn(*share)).collect(),
        y: cells.iter().map(|&(_, cell)| error(cell)).collect(),
        // thin over a thick line of the same colour would hide it: a colour of its own where both are drawn
        role: Role::Estimate(if beside_expected { number + 1 } else { number }),
    }
}
