//! The figure of errors against a swept bandwidth.

use super::Material;
use crate::experiment::judge::swept;
use crate::experiment::results::Group;
use crate::experiment::{Figure, Measure};
use crate::kernel::{Bandwidth, Shape};
use crate::report::figure::{Axis, Marker, Measured, Part, Svg, Sweep, Trace};
use crate::selector::{NormalReference, Scott, Selector, Silverman};
use crate::theory;

/// The members of the sweep of that name, as positions, by ascending parameter.
pub(super) fn members(material: &Material<'_>, of: &str) -> Vec<(f64, usize)> {
    let estimators = &material.bench.experiment().estimators;
    let mut members: Vec<(f64, usize)> = estimators
        .iter()
        .enumerate()
        .filter_map(|(number, spec)| {
            let sweep = spec.sweep.as_ref().filter(|sweep| sweep.group == of)?;
            Some((sweep.value, number))
        })
        .collect();
    members.sort_by(|a, b| a.0.total_cmp(&b.0));
    members
}

/// One part of the error along a sweep, simulated and exact.
fn trace(
    material: &Material<'_>,
    group: &Group,
    of: &str,
    (name, part): (&str, Part),
    simulated: Measure,
    exact: Measure,
) -> Trace {
    Trace {
        name: name.to_owned(),
        part,
        exact: swept(material.bench.experiment(), group, of, exact),
        measured: members(material, of)
            .into_iter()
            .filter_map(|(at, number)| {
                let interval = group.outcomes[number].measures.get(&simulated)?;
                Some(Measured {
                    at,
                    value: interval.value,
                    low: interval.low,
                    high: interval.high,
                })
            })
            .collect(),
    }
}

pub(super) fn draw(
    material: &Material<'_>,
    figure: &Figure,
    group: &Group,
    of: &str,
    mark: &[String],
) -> Svg {
    Sweep {
        title: String::new(),
        description: figure.caption.clone(),
        x: Axis::new(parameter(material, of), "").logarithmic(),
        y: Axis::new("integrated squared error", "").logarithmic(),
        traces: traces(material, group, of),
        markers: markers(material, group, of, mark),
        interval: "95 % interval".to_owned(),
        minima: minima(material, group, of),
    }
    .draw()
}

/// MISE and its two parts along a sweep.
pub(super) fn traces(material: &Material<'_>, group: &Group, of: &str) -> Vec<Trace> {
    [
        ("MISE", Part::Total, Measure::Mise, Measure::ExactMise),
        ("bias²", Part::Bias, Measure::Bias2, Measure::ExactBias2),
        (
            "variance",
            Part::Variance,
            Measure::Variance,
            Measure::ExactVariance,
        ),
    ]
    .map(|(name, part, simulated, exact)| {
        trace(material, group, of, (name, part), simulated, exact)
    })
    .to_vec()
}

/// Where the exact MISE has its minima, the deepest first.
fn minima(material: &Material<'_>, group: &Group, of: &str) -> Vec<(f64, f64)> {
    let Some((shape, truth)) = shape_of(material, of).zip(material.bench.truth(group.source))
    else {
        return Vec::new();
    };
    let optimum = theory::KernelError::new(&**truth, shape).optimum(group.draws as f64);
    let others = optimum
        .others
        .iter()
        .map(|minimum| (minimum.at, minimum.value));
    [(optimum.at, optimum.error.mise())]
        .into_iter()
        .chain(others)
        .collect()
}

/// The kernel that a sweep's estimators have in common, where they have one.
fn shape_of(material: &Material<'_>, of: &str) -> Option<Shape> {
    let &(_, number) = members(material, of).first()?;
    let spec = &material.bench.experiment().estimators[number];
    spec.values.word("shape").and_then(Shape::named)
}

/// What the swept parameter is called on an axis.
pub(super) fn parameter(material: &Material<'_>, of: &str) -> String {
    let estimators = &material.bench.experiment().estimators;
    let name = estimators
        .iter()
        .filter_map(|spec| spec.sweep.as_ref())
        .find(|sweep| sweep.group == of)
        .map(|sweep| sweep.parameter.as_str());
    match name {
        Some("bandwidth") | None => "bandwidth h".to_owned(),
        Some(other) => other.to_owned(),
    }
}

/// The places worth marking: optima by theory, and the median choice of rules of thumb over the first samples.
pub(super) fn markers(
    material: &Material<'_>,
    group: &Group,
    of: &str,
    mark: &[String],
) -> Vec<Marker> {
    let Some(shape) = shape_of(material, of) else {
        return Vec::new();
    };
    let oracle = material
        .bench
        .truth(group.source)
        .map(|truth| theory::KernelError::new(&**truth, shape).oracle(group.draws as f64));
    let rule = |selector: &dyn Selector<1>| typical(material, group, selector, shape);
    mark.iter()
        .filter_map(|name| {
            let at = match name.as_str() {
                "h_mise" => oracle.as_ref().map(|oracle| oracle.optimum.at),
                "h_amise" => oracle
                    .as_ref()
                    .and_then(|oracle| oracle.asymptotic.as_ref().ok())
                    .map(theory::Asymptotic::best),
                "silverman" => rule(&Silverman),
                "normal-reference" => rule(&NormalReference),
                "scott" => rule(&Scott),
                _ => None,
            }?;
            let name = match name.as_str() {
                "h_mise" => "h MISE",
                "h_amise" => "h AMISE",
                other => other,
            };
            Some(Marker {
                name: name.to_owned(),
                at,
            })
        })
        .collect()
}

/// The median bandwidth that a rule chooses over the first samples.
fn typical(
    material: &Material<'_>,
    group: &Group,
    selector: &dyn Selector<1>,
    shape: Shape,
) -> Option<f64> {
    const SAMPLES: usize = 25;
    let replicates = material.bench.experiment().replicates.min(SAMPLES);
    let mut chosen: Vec<f64> = (0..replicates)
        .filter_map(|replicate| {
            let sample = material
                .bench
                .sample(group.source, group.size, replicate)
                .ok()?;
            match selector.select(&sample, shape).ok()?.bandwidth {
                Bandwidth::Fixed([h]) => Some(h),
                _ => None,
            }
        })
        .collect();
    chosen.sort_by(f64::total_cmp);
    chosen.get(chosen.len() / 2).copied()
}
