//! The report page of a run.

use super::fine::First;
use super::pictures::{Picture, place_axis};
use super::sweep::{members, parameter, traces};
use super::{Fine, Material, tables, verdict};
use crate::experiment::judge::{Ruling, short};
use crate::experiment::program::{REVISION, VERSION};
use crate::experiment::results::Group;
use crate::experiment::{Measure, SourceSpec};
use crate::random::GENERATOR;
use crate::report::figure::{Axis, Sweep};
use crate::report::page::{self, Errors, Figure, Page, Slider, Step, Table, Verdict, Warning};
use crate::report::text::minus;

pub(super) fn compose<const D: usize>(
    material: &Material<'_, D>,
    slider: Option<Slider>,
    pictures: Vec<Picture>,
    costs: &[Vec<f64>],
    comparisons: Vec<Table>,
) -> String {
    let experiment = material.bench.experiment();
    let mut tables = comparisons;
    tables.extend(tables::all(material));
    Page {
        question: experiment.question.clone(),
        notes: experiment.notes.clone(),
        claims: claims(material),
        facts: facts(material),
        warnings: warnings(material),
        slider,
        figures: pictures
            .into_iter()
            .map(|p| Figure {
                title: p.title,
                caption: p.caption,
                svg: p.svg,
            })
            .collect(),
        tables,
        verdict: verdict::paragraphs(material, costs)
            .iter()
            .map(|said| minus(said))
            .collect(),
        command: material.circumstances.command.clone(),
        versions: vec![
            ("lab".to_owned(), VERSION.to_owned()),
            ("revision of the sources".to_owned(), REVISION.to_owned()),
            ("random numbers".to_owned(), GENERATOR.to_owned()),
        ],
    }
    .render()
}

fn claims<const D: usize>(material: &Material<'_, D>) -> Vec<Verdict> {
    let experiment = material.bench.experiment();
    let verdicts = material.verdicts.iter().map(|verdict| Verdict {
        text: experiment.claims[verdict.claim].says.clone(),
        outcome: match verdict.outcome {
            Ruling::Holds => page::Outcome::Pass,
            // too few replicates were run to say more
            Ruling::Fails if material.circumstances.quick => page::Outcome::Undecided,
            Ruling::Fails => page::Outcome::Fail,
        },
        detail: minus(&verdict.detail),
    });
    verdicts.collect()
}

fn facts<const D: usize>(material: &Material<'_, D>) -> Vec<(String, String)> {
    let experiment = material.bench.experiment();
    let mut facts: Vec<(&str, String)> = Vec::new();
    let sources = experiment.sources.iter().map(|source| match source {
        SourceSpec::Density { name, .. } => format!("density {name}"),
        SourceSpec::Scene { path, surface, .. } => {
            let file = path.file_name().unwrap_or_default().to_string_lossy();
            format!("photon hits on {surface} of {file}")
        }
        SourceSpec::File {
            path,
            columns,
            weight,
            ..
        } => {
            let file = path.file_name().unwrap_or_default().to_string_lossy();
            let weight = weight
                .as_ref()
                .map_or_else(String::new, |weight| format!(", weighted by {weight}"));
            format!(
                "{file}, {} {}{weight}",
                if columns.len() > 1 {
                    "columns"
                } else {
                    "column"
                },
                columns.join(" and ")
            )
        }
    });
    facts.push(("Source", sources.collect::<Vec<_>>().join("; ")));
    let mut sizes: Vec<String> = material
        .results
        .groups
        .iter()
        .map(|group| group.draws.to_string())
        .collect();
    sizes.dedup();
    facts.push(("Sample size n", sizes.join(", ")));
    if material
        .results
        .groups
        .iter()
        .any(|group| group.truth.is_some())
    {
        let quick = if material.circumstances.quick {
            " (a quick run: fewer than the file asks for)"
        } else {
            ""
        };
        facts.push(("Replicates", format!("{}{quick}", experiment.replicates)));
        facts.push(("Seed", experiment.seed.to_string()));
    }
    let mut grids: Vec<String> = material.results.groups.iter().map(grid::<D>).collect();
    grids.dedup();
    facts.push((
        "Grid",
        if grids.len() == 1 {
            grids.remove(0)
        } else {
            "one per source, chosen from its bulk".to_owned()
        },
    ));
    let mut engines: Vec<&str> = material
        .results
        .groups
        .iter()
        .flat_map(|g| &g.outcomes)
        .filter_map(|o| o.engine.as_deref())
        .collect();
    engines.sort_unstable();
    engines.dedup();
    if !engines.is_empty() {
        facts.push(("Engines", engines.join(", ")));
    }
    facts
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

fn grid<const D: usize>(group: &Group<D>) -> String {
    let cells: Vec<String> = group.grid.cells().iter().map(usize::to_string).collect();
    let ends = group.grid.low().into_iter().zip(group.grid.high());
    let ends: Vec<String> = ends
        .map(|(low, high)| format!("{} to {}", short(low), short(high)))
        .collect();
    minus(&format!(
        "{} cells from {}",
        cells.join(" × "),
        ends.join(" and ")
    ))
}

fn warnings<const D: usize>(material: &Material<'_, D>) -> Vec<Warning> {
    let warnings = material
        .results
        .warnings
        .iter()
        .map(|(warning, count)| Warning {
            text: if *count > 1 {
                format!("{} (on {count} estimates)", warning.what)
            } else {
                warning.what.clone()
            },
            hint: warning.hint.clone(),
        });
    warnings.collect()
}

/// The slider for the first sweep of the experiment.
pub(super) fn slider(material: &Material<'_>, fine: &Fine) -> Option<Slider> {
    let experiment = material.bench.experiment();
    let of = &experiment
        .estimators
        .iter()
        .find_map(|spec| spec.sweep.as_ref())?
        .group;
    let (group, first) = (material.results.groups.first()?, fine.groups.first()?);
    let members = members(material, of);
    let steps: Vec<Step> = members
        .iter()
        .map(|&(bandwidth, number)| step(group, first, bandwidth, number))
        .collect();
    let mise = |step: &Step| {
        step.exact
            .or(step.measured)
            .map_or(f64::INFINITY, |errors| errors.mise.0)
    };
    let start = (0..steps.len())
        .min_by(|&a, &b| mise(&steps[a]).total_cmp(&mise(&steps[b])))
        .unwrap_or(0);
    Some(Slider {
        caption: format!(
            "{of}: the first sample of {} points from {}",
            group.draws, group.name
        ),
        x: place_axis(material, group),
        y: Axis::new("density", ""),
        grid: group.grid.centres().map(|[x]| x).collect(),
        truth: group.truth.clone(),
        data: first.data.clone(),
        start,
        errors: group.truth.is_some().then(|| Sweep {
            description: "Errors against the swept parameter".to_owned(),
            x: Axis::new(parameter(material, of), "").logarithmic(),
            y: Axis::new("integrated squared error", "").logarithmic(),
            traces: traces(material, group, of),
            ..Sweep::default()
        }),
        steps,
    })
}

fn step(group: &Group, first: &First, bandwidth: f64, number: usize) -> Step {
    let outcome = &group.outcomes[number];
    let value = |measure| {
        outcome
            .measures
            .get(&measure)
            .map(|m| (m.value, m.standard_error))
    };
    let errors = |mise, bias2, variance| {
        Some(Errors {
            mise: value(mise)?,
            bias2: value(bias2)?,
            variance: value(variance)?,
        })
    };
    Step {
        bandwidth,
        estimate: first.coarse[number].clone(),
        exact: errors(
            Measure::ExactMise,
            Measure::ExactBias2,
            Measure::ExactVariance,
        ),
        measured: errors(Measure::Mise, Measure::Bias2, Measure::Variance),
        ise: outcome
            .replicates
            .first()
            .and_then(|replicate| replicate.errors)
            .map(|errors| errors.ise),
    }
}
