//! The drawings of experiments in the plane: maps and cross-sections.

use super::camera::seen;
use super::pictures::{axis_of, chosen, common, picture, shows, together};
use super::room::unfolded;
use super::section::section;
use super::{Draws, Illustrations, Material, Paper};
use crate::experiment::results::{Group, Outcome};
use crate::experiment::run::RunError;
use crate::experiment::{Figure, FigureKind};
use crate::kernel::Shape;
use crate::report::figure::{Colours, HeatMaps, Map, Svg};
use crate::space::{Evaluation, Field, Targets};

impl Draws<2> for Paper {
    fn illustrate(material: &Material<'_, 2>) -> Result<Illustrations, RunError> {
        let groups = &material.results.groups;
        let (mut first, mut sizes, mut costs) = (Vec::new(), Vec::new(), Vec::new());
        for group in groups {
            let grid = group.grid;
            let setting = material.bench.setting(group.source, group.size);
            let (mut values, mut radii, mut seconds) = (Vec::new(), Vec::new(), Vec::new());
            for (mut evaluation, cost) in of_first_sample(material, group, Targets::Grid(&grid))? {
                setting.restrict(&mut evaluation.values);
                values.push(evaluation.values);
                radii.push(evaluation.sizes);
                seconds.push(cost);
            }
            first.push(values);
            sizes.push(radii);
            costs.push(seconds);
        }
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
            if let FigureKind::Camera { .. } = figure.kind {
                pictures.extend(seen(material, figure, &shown)?);
                continue;
            }
            if let Some(svg) = together(figure, &shown) {
                pictures.push(picture::<2>(figure, None, svg));
                continue;
            }
            for (index, group) in shown {
                let of = several.then_some(group);
                match &figure.kind {
                    FigureKind::Maps { show, levels } => {
                        let known = (&first[index][..], &sizes[index][..]);
                        let drawn = maps(material, figure, group, known, show, *levels);
                        pictures.extend(drawn.into_iter().map(|(what, svg)| {
                            let mut picture = picture(figure, of, svg);
                            if let Some(what) = what {
                                picture.title = format!("{}: {what}", picture.title);
                                picture.slug = format!("{}-{what}", picture.slug);
                            }
                            picture
                        }));
                    }
                    FigureKind::Section { .. } => {
                        let svg = section(material, figure, group)?;
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
            costs,
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

/// What each estimator makes of the first sample, and the seconds it took.
pub(super) fn of_first_sample(
    material: &Material<'_, 2>,
    group: &Group<2>,
    targets: Targets<'_, 2>,
) -> Result<Vec<(Evaluation, f64)>, RunError> {
    let sample = material.bench.sample(group.source, group.size, 0)?;
    let setting = material.bench.setting(group.source, group.size);
    setting
        .estimators
        .iter()
        .zip(&group.outcomes)
        .map(|(estimator, outcome)| {
            let begin = std::time::Instant::now();
            let estimate = estimator.fit(&sample).map_err(|error| {
                RunError::Input(format!(
                    "estimator \"{}\" on the first sample: {error}",
                    outcome.name
                ))
            })?;
            let evaluation = estimate.evaluate(targets);
            Ok((evaluation, begin.elapsed().as_secs_f64()))
        })
        .collect()
}

/// One drawing of densities, one of errors and one of sizes, whose colours mean something else; a word tells them apart where there are both.
fn maps(
    material: &Material<'_, 2>,
    figure: &Figure,
    group: &Group<2>,
    (first, sizes): (&[Vec<f64>], &[Option<Vec<f64>>]),
    show: &[String],
    levels: bool,
) -> Vec<(Option<&'static str>, Svg)> {
    let wants = |what: &str| show.iter().any(|word| word == what);
    let (mut densities, mut errors, mut radii) = (Vec::new(), Vec::new(), Vec::new());
    let map = |title: String, values: Vec<f64>| Map {
        title,
        values: masked(group, values),
        ..Map::default()
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
        if let Some(sizes) = sizes[number].as_ref().filter(|_| wants("size")) {
            radii.push(map(outcome.name.clone(), sizes.clone()));
        }
    }
    let sorts = [&densities, &errors, &radii];
    let apart = sorts.iter().filter(|maps| !maps.is_empty()).count() > 1;
    [
        (densities, Colours::Amount, "density", "densities"),
        (errors, Colours::Signed, "mean estimate − truth", "errors"),
        (
            radii,
            Colours::Amount,
            "radius of the neighbourhood",
            "sizes",
        ),
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
            columns,
            maps,
            ..HeatMaps::default()
        };
        (apart.then_some(what), drawing.draw())
    })
    .collect()
}

/// The mean over replicates.
pub(super) fn mean(group: &Group<2>, outcome: &Outcome) -> Vec<f64> {
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
