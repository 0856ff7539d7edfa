//! The drawings of experiments in the plane: maps and cross-sections.

use super::pictures::{axis_of, chosen, common, picture, shows};
use super::room::unfolded;
use super::{Draws, Illustrations, Material, Paper};
use crate::experiment::results::{Group, Outcome};
use crate::experiment::run::RunError;
use crate::experiment::{Figure, FigureKind};
use crate::kernel::Shape;
use crate::report::figure::{Axis, Colours, Curves, HeatMaps, Map, Role, Series, Svg};
use crate::space::{Field, Point, Targets};

/// Places along a cross-section: two to a pixel of the widest figure.
const PLACES: usize = 1440;

impl Draws<2> for Paper {
    fn illustrate(material: &Material<'_, 2>) -> Result<Illustrations, RunError> {
        let groups = &material.results.groups;
        let first: Vec<Vec<Vec<f64>>> = groups
            .iter()
            .map(|group| {
                let grid = group.grid;
                let mut estimates = of_first_sample(material, group, Targets::Grid(&grid))?;
                let setting = material.bench.setting(group.source, group.size);
                for values in &mut estimates {
                    setting.restrict(values);
                }
                Ok(estimates)
            })
            .collect::<Result<_, RunError>>()?;
        let mut pictures = Vec::new();
        for figure in &material.bench.experiment().figures {
            let shown: Vec<(usize, &Group<2>)> = groups
                .iter()
                .enumerate()
                .filter(|(_, group)| shows(figure, group, material))
                .collect();
            let several = shown.len() > 1;
            if let FigureKind::Unfolded { show } = &figure.kind {
                let faces: Vec<(&Group<2>, &[Vec<f64>])> = shown
                    .iter()
                    .map(|&(index, group)| (group, &first[index][..]))
                    .collect();
                let drawn = unfolded(material, figure, &faces, show)?;
                pictures.extend(drawn.map(|svg| picture::<2>(figure, None, svg)));
                continue;
            }
            for (index, group) in shown {
                let of = several.then_some(group);
                match &figure.kind {
                    FigureKind::Maps { show, levels } => {
                        let drawn = maps(material, figure, group, &first[index], show, *levels);
                        pictures.extend(drawn.into_iter().map(|(what, svg)| {
                            let mut picture = picture(figure, of, svg);
                            if let Some(what) = what {
                                picture.title = format!("{}: {what}", picture.title);
                                picture.slug = format!("{}-{what}", picture.slug);
                            }
                            picture
                        }));
                    }
                    FigureKind::Section { from, to } => {
                        let svg = section(material, figure, group, *from, *to)?;
                        pictures.push(picture(figure, of, svg));
                    }
                    _ => pictures.extend(
                        common(material, figure, group).map(|svg| picture(figure, of, svg)),
                    ),
                }
            }
        }
        Ok(Illustrations {
            first,
            pictures,
            slider: None,
        })
    }

    fn typical(
        _material: &Material<'_, 2>,
        _group: &Group<2>,
        _rule: &str,
        _shape: Shape,
    ) -> Option<f64> {
        None
    }
}

/// What each estimator makes of the first sample.
fn of_first_sample(
    material: &Material<'_, 2>,
    group: &Group<2>,
    targets: Targets<'_, 2>,
) -> Result<Vec<Vec<f64>>, RunError> {
    let sample = material.bench.sample(group.source, group.size, 0)?;
    let setting = material.bench.setting(group.source, group.size);
    setting
        .estimators
        .iter()
        .zip(&group.outcomes)
        .map(|(estimator, outcome)| {
            let estimate = estimator.fit(&sample).map_err(|error| {
                RunError::Input(format!(
                    "estimator \"{}\" on the first sample: {error}",
                    outcome.name
                ))
            })?;
            Ok(estimate.evaluate(targets).values)
        })
        .collect()
}

/// One drawing of densities and one of errors, whose colours mean something else; a word tells them apart where there are both.
fn maps(
    material: &Material<'_, 2>,
    figure: &Figure,
    group: &Group<2>,
    first: &[Vec<f64>],
    show: &[String],
    levels: bool,
) -> Vec<(Option<&'static str>, Svg)> {
    let wants = |what: &str| show.iter().any(|word| word == what);
    let (mut densities, mut errors) = (Vec::new(), Vec::new());
    let map = |title: String, values: Vec<f64>| Map {
        title,
        values: masked(group, values),
    };
    if let Some(truth) = group.truth.as_ref().filter(|_| wants("truth")) {
        densities.push(map("truth".to_owned(), truth.clone()));
    }
    let both = wants("sample") && wants("mean");
    for (number, outcome) in chosen(figure, group) {
        if wants("sample") {
            densities.push(map(outcome.name.clone(), first[number].clone()));
        }
        if wants("mean") {
            let name = if both {
                format!("{}, mean", outcome.name)
            } else {
                outcome.name.clone()
            };
            densities.push(map(name, mean(group, outcome)));
        }
        if wants("error") {
            errors.push(map(outcome.name.clone(), outcome.tally.mean().to_vec()));
        }
    }
    let apart = !densities.is_empty() && !errors.is_empty();
    [
        (densities, Colours::Amount, "density", "densities"),
        (errors, Colours::Signed, "mean estimate − truth", "errors"),
    ]
    .into_iter()
    .filter(|(maps, ..)| !maps.is_empty())
    .map(|(maps, colours, label, what)| {
        let columns = match maps.len() {
            0..=3 => maps.len(),
            4 => 2,
            _ => 3,
        };
        let drawing = HeatMaps {
            title: String::new(),
            description: figure.caption.clone(),
            x: axis_of(material, group, 0),
            y: axis_of(material, group, 1),
            low: group.grid.low(),
            high: group.grid.high(),
            cells: group.grid.cells(),
            label: label.to_owned(),
            colours,
            levels,
            outline: material.bench.outline(group.source).to_vec(),
            across: Vec::new(),
            columns,
            maps,
        };
        (apart.then_some(what), drawing.draw())
    })
    .collect()
}

/// The mean over replicates.
fn mean(group: &Group<2>, outcome: &Outcome) -> Vec<f64> {
    let truth = |i: usize| group.truth.as_ref().map_or(0.0, |truth| truth[i]);
    let errors = outcome.tally.mean().iter().enumerate();
    errors.map(|(i, error)| error + truth(i)).collect()
}

/// Nothing outside the polygon that bounds the domain.
fn masked(group: &Group<2>, mut values: Vec<f64>) -> Vec<f64> {
    if let Some(mask) = &group.mask {
        for (value, inside) in values.iter_mut().zip(mask) {
            if !inside {
                *value = f64::NAN;
            }
        }
    }
    values
}

/// Truth and estimates of the first sample over the way along a line.
fn section(
    material: &Material<'_, 2>,
    figure: &Figure,
    group: &Group<2>,
    from: Point<2>,
    to: Point<2>,
) -> Result<Svg, RunError> {
    let along = |t: f64| [0, 1].map(|k: usize| t.mul_add(to[k] - from[k], from[k]));
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let shares: Vec<f64> = (0..PLACES)
        .map(|i| (i as f64 + 0.5) / PLACES as f64)
        .collect();
    let places: Vec<Point<2>> = shares.iter().map(|t| along(*t)).collect();
    let x: Vec<f64> = shares.iter().map(|t| t * length).collect();
    let estimates = of_first_sample(material, group, Targets::Points(&places))?;
    let truth = material.bench.field(group.source).map(|truth| Series {
        name: "truth".to_owned(),
        x: x.clone(),
        y: places.iter().map(|place| truth.at(*place)).collect(),
        role: Role::Truth,
    });
    let estimates = chosen(figure, group).map(|(number, outcome)| Series {
        name: outcome.name.clone(),
        x: x.clone(),
        y: estimates[number].clone(),
        role: Role::Estimate(number),
    });
    let label = format!(
        "distance along the line from ({}, {}) to ({}, {})",
        from[0], from[1], to[0], to[1]
    );
    Ok(Curves {
        title: String::new(),
        description: figure.caption.clone(),
        x: Axis::new(label, "").over(0.0, length),
        y: Axis::new("density", ""),
        series: truth.into_iter().chain(estimates).collect(),
        ..Curves::default()
    }
    .draw())
}
