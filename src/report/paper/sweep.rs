//! The figure of errors against a swept bandwidth.

use super::{Draws, Material, Paper};
use crate::experiment::judge::swept;
use crate::experiment::results::Group;
use crate::experiment::{Figure, Measure};
use crate::kernel::{Shape, Symmetry};
use crate::report::figure::{Axis, Marker, Measured, Part, Svg, Sweep, Trace};
use crate::theory::{self, Oracle};

/// The members of the sweep of that name, as positions, by ascending parameter.
pub(super) fn members<const D: usize>(material: &Material<'_, D>, of: &str) -> Vec<(f64, usize)> {
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
fn trace<const D: usize>(
    material: &Material<'_, D>,
    group: &Group<D>,
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

pub(super) fn draw<const D: usize>(
    material: &Material<'_, D>,
    figure: &Figure,
    group: &Group<D>,
    of: &str,
    mark: &[String],
) -> Svg
where
    Paper: Draws<D>,
{
    Sweep {
        title: String::new(),
        description: figure.caption.clone(),
        x: Axis::new(parameter(material, of), "").logarithmic(),
        y: Axis::new("integrated squared error", "").logarithmic(),
        traces: traces(material, group, of)
            .into_iter()
            .chain(leading(material, group, of, mark))
            .collect(),
        markers: markers(material, group, of, mark),
        interval: "95 % interval".to_owned(),
        minima: minima(material, group, of),
    }
    .draw()
}

/// The leading terms of the MISE along a sweep of bandwidths, if they are asked for and exist.
fn leading<const D: usize>(
    material: &Material<'_, D>,
    group: &Group<D>,
    of: &str,
    mark: &[String],
) -> Option<Trace> {
    if !mark.iter().any(|name| name == "amise") {
        return None;
    }
    let kernel = kernel_of(material, of)?;
    let oracle = material.bench.oracle(group.source, kernel, group.draws)?;
    let asymptotic = oracle.asymptotic.ok()?;
    Some(Trace {
        name: "AMISE".to_owned(),
        part: Part::Other(3),
        exact: members(material, of)
            .into_iter()
            .map(|(h, _)| (h, asymptotic.at(h).mise()))
            .collect(),
        measured: Vec::new(),
    })
}

/// MISE and its two parts along a sweep.
pub(super) fn traces<const D: usize>(
    material: &Material<'_, D>,
    group: &Group<D>,
    of: &str,
) -> Vec<Trace> {
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
fn minima<const D: usize>(
    material: &Material<'_, D>,
    group: &Group<D>,
    of: &str,
) -> Vec<(f64, f64)> {
    let oracle = kernel_of(material, of)
        .and_then(|kernel| material.bench.oracle(group.source, kernel, group.draws));
    let Some(Oracle { optimum, .. }) = oracle else {
        return Vec::new();
    };
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
fn kernel_of<const D: usize>(material: &Material<'_, D>, of: &str) -> Option<(Shape, Symmetry)> {
    let &(_, number) = members(material, of).first()?;
    let values = &material.bench.experiment().estimators[number].values;
    let shape = values.word("shape").and_then(Shape::named)?;
    let symmetry = values.word("symmetry").and_then(Symmetry::named);
    Some((shape, symmetry.unwrap_or_default()))
}

/// What the swept parameter is called on an axis.
pub(super) fn parameter<const D: usize>(material: &Material<'_, D>, of: &str) -> String {
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
pub(super) fn markers<const D: usize>(
    material: &Material<'_, D>,
    group: &Group<D>,
    of: &str,
    mark: &[String],
) -> Vec<Marker>
where
    Paper: Draws<D>,
{
    let Some(kernel) = kernel_of(material, of) else {
        return Vec::new();
    };
    let oracle = material.bench.oracle(group.source, kernel, group.draws);
    mark.iter()
        .filter_map(|name| {
            let at = match name.as_str() {
                "h_mise" => oracle.as_ref().map(|oracle| oracle.optimum.at),
                "h_amise" => oracle
                    .as_ref()
                    .and_then(|oracle| oracle.asymptotic.as_ref().ok())
                    .map(theory::Asymptotic::best),
                "amise" => None,
                rule => Paper::typical(material, group, rule, kernel.0),
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
