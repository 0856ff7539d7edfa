//! A checked experiment in words: what it resolves to and what it will cost.

use super::PathSpec;
use super::{
    EstimatorSpec, Experiment, FigureKind, GridSpec, Limits, SourceSpec, budget, significant,
};
use crate::memory::Bytes;
use crate::parameter::{Value, Values};
use std::fmt::Write as _;

/// What a file resolved to, with cost and memory, for `lab check`. Times a few small estimates (some milliseconds) to say how long a run takes.
pub fn summary(experiment: &Experiment) -> String {
    let mut out = String::new();
    let mut row = |label: &str, text: &str| {
        let _ = writeln!(out, "{label:<11} {text}");
    };
    row("experiment", &experiment.name);
    row("question", &experiment.question);
    for source in &experiment.sources {
        row("source", &source_line(source));
    }
    if !experiment.draws.is_empty() {
        let sizes: Vec<String> = experiment.draws.iter().map(usize::to_string).collect();
        row("draws", &sizes.join(", "));
    }
    row(
        "replicates",
        &format!("{}, seed {}", experiment.replicates, experiment.seed),
    );
    match &experiment.grid {
        Some(grid) => row("grid", &grid_line(grid)),
        None => row("grid", "chosen from each source"),
    }
    for line in estimator_lines(&experiment.estimators) {
        row("estimator", &line);
    }
    for figure in &experiment.figures {
        row(
            "figure",
            &format!("{} ({})", figure.title, kind(&figure.kind)),
        );
    }
    for claim in &experiment.claims {
        row("claim", &format!("line {}: {}", claim.line, claim.says));
    }
    row("cost", &cost(experiment));
    out
}

fn source_line(source: &SourceSpec) -> String {
    match source {
        SourceSpec::Density {
            name,
            kind,
            values,
            paths,
        } => {
            let told = settings(values);
            let kind = if name == kind {
                String::new()
            } else {
                format!(" ({kind})")
            };
            let paths = paths.map_or_else(String::new, |paths| {
                let PathSpec { hits, spread } = paths;
                format!(", {hits} points a path, spread by {spread}")
            });
            format!(
                "the density {name}{kind}{}{told}{paths}",
                if told.is_empty() { "" } else { ": " }
            )
        }
        SourceSpec::Scene {
            path,
            surface,
            values,
            ..
        } => {
            let told = settings(values);
            format!(
                "photon hits on the surface {surface} of {}{}{told}",
                path.display(),
                if told.is_empty() { "" } else { ": " }
            )
        }
        SourceSpec::File {
            path,
            columns,
            weight,
            domain,
            ..
        } => {
            let several = if columns.len() > 1 {
                "columns"
            } else {
                "column"
            };
            let mut line = format!("{}, {several} {}", path.display(), columns.join(", "));
            if let Some(weight) = weight {
                let _ = write!(line, ", weights {weight}");
            }
            match domain {
                Some(Limits::Box(axes)) => {
                    let axes = axes.iter().map(|[low, high]| format!("[{low}, {high}]"));
                    let _ = write!(line, ", on {}", axes.collect::<Vec<_>>().join(" × "));
                }
                Some(Limits::Polygon { vertices }) => {
                    let _ = write!(line, ", in a polygon of {} corners", vertices.len());
                }
                None => {}
            }
            line
        }
    }
}

fn grid_line(grid: &GridSpec) -> String {
    let cells: Vec<String> = grid.cells.iter().map(usize::to_string).collect();
    let ends = grid.low.iter().zip(&grid.high);
    let ends: Vec<String> = ends.map(|(low, high)| format!("{low} to {high}")).collect();
    format!("{} cells from {}", cells.join(" × "), ends.join(" and "))
}

/// One line an estimator; one for all members of a sweep.
fn estimator_lines(estimators: &[EstimatorSpec]) -> Vec<String> {
    let mut lines = Vec::new();
    let mut rest = estimators;
    while let Some(first) = rest.first() {
        let Some(sweep) = &first.sweep else {
            lines.push(format!(
                "\"{}\": {} {{ {} }}",
                first.name,
                first.kind,
                settings(&first.values)
            ));
            rest = &rest[1..];
            continue;
        };
        let members = rest
            .iter()
            .take_while(|other| {
                other
                    .sweep
                    .as_ref()
                    .is_some_and(|of| of.group == sweep.group)
            })
            .count();
        let swept: Vec<f64> = rest[..members]
            .iter()
            .filter_map(|member| Some(member.sweep.as_ref()?.value))
            .collect();
        let low = swept.iter().copied().fold(f64::INFINITY, f64::min);
        let high = swept.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        lines.push(format!(
            "\"{}\": {} {{ {} }}, {members} values of {} from {} to {}",
            sweep.group,
            first.kind,
            settings_but(&first.values, Some(&sweep.parameter)),
            sweep.parameter,
            significant(low, 4),
            significant(high, 4)
        ));
        rest = &rest[members..];
    }
    lines
}

fn settings(values: &Values) -> String {
    settings_but(values, None)
}

fn settings_but(values: &Values, hidden: Option<&str>) -> String {
    values
        .iter()
        .filter(|(name, _)| Some(*name) != hidden)
        .map(|(name, value)| format!("{name} = {}", shown(value)))
        .collect::<Vec<_>>()
        .join(", ")
}

fn shown(value: &Value) -> String {
    match value {
        Value::Number(x) => x.to_string(),
        Value::Count(x) => x.to_string(),
        Value::Word(word) => format!("\"{word}\""),
        Value::Flag(flag) => flag.to_string(),
        Value::Words(words) => format!("{words:?}"),
        Value::Rows(rows) => {
            let rows: Vec<String> = rows
                .iter()
                .map(|row| format!("{{ {} }}", settings(row)))
                .collect();
            format!("[{}]", rows.join(", "))
        }
    }
}

fn kind(kind: &FigureKind) -> &'static str {
    match kind {
        FigureKind::Curves { .. } => "curves",
        FigureKind::Errors { .. } => "errors",
        FigureKind::Modes {} => "modes",
        FigureKind::Sweep { .. } => "sweep",
        FigureKind::Spread { .. } => "spread",
        FigureKind::Convergence { .. } => "convergence",
        FigureKind::Coverage {} => "coverage",
        FigureKind::LocalBandwidth { .. } => "local-bandwidth",
        FigureKind::Densities {} => "densities",
        FigureKind::Efficiency {} => "efficiency",
        FigureKind::Uncertainty { .. } => "uncertainty",
        FigureKind::ComparisonTable {} => "comparison-table",
        FigureKind::Maps { .. } => "maps",
        FigureKind::Unfolded { .. } => "unfolded",
        FigureKind::Camera { .. } => "camera",
        FigureKind::Section { .. } => "section",
    }
}

fn cost(experiment: &Experiment) -> String {
    let budget = budget::budget(experiment);
    let mut line = format!(
        "{} estimates in {} cells of work, {} of memory",
        budget.fits,
        budget.cells,
        Bytes(budget.memory_bytes as u64)
    );
    if let Some(seconds) = budget::seconds(experiment) {
        let _ = write!(line, ", about {} on this machine", duration(seconds));
    }
    line
}

fn duration(seconds: f64) -> String {
    if seconds < 0.1 {
        "0.1 s or less".to_owned()
    } else if seconds < 120.0 {
        format!("{} s", significant(seconds, 2))
    } else if seconds < 7200.0 {
        format!("{} minutes", significant(seconds / 60.0, 2))
    } else if seconds < 172_800.0 {
        format!("{} hours", significant(seconds / 3600.0, 2))
    } else {
        format!("{} days", significant(seconds / 86_400.0, 2))
    }
}
