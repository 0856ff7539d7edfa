//! From the figures an experiment asks for to drawings.

use super::{
    Draws, Fine, Material, Paper, convergence, coverage, efficiency, errors, local, spread, sweep,
    uncertain,
};
use crate::experiment::results::{Group, Outcome};
use crate::experiment::{Figure, FigureKind, SourceSpec};
use crate::report::figure::{Axis, Curves, ModeCounts, Modes, Multiples, Role, Series, Small, Svg};
use crate::space::{RIPPLE, mode_count};

/// A figure of the report.
pub struct Picture {
    /// Part of its file's name.
    pub slug: String,
    /// Its title.
    pub title: String,
    /// What to see in it.
    pub caption: String,
    /// The drawing.
    pub svg: Svg,
}

/// Beyond this many curves in one frame nobody can tell them apart; they go into panels.
const CROWD: usize = 5;

/// Draws every figure of the experiment.
pub(super) fn draw(material: &Material<'_>, fine: &Fine) -> Vec<Picture> {
    let experiment = material.bench.experiment();
    let mut pictures = Vec::new();
    for figure in &experiment.figures {
        if let FigureKind::Densities {} = figure.kind {
            pictures.push(picture::<1>(
                figure,
                None,
                densities(material, fine, figure),
            ));
            continue;
        }
        let groups: Vec<(usize, &Group)> = material
            .results
            .groups
            .iter()
            .enumerate()
            .filter(|(_, g)| shows(figure, g, material))
            .collect();
        let several = groups.len() > 1;
        if let Some(svg) = together(figure, &groups) {
            pictures.push(picture::<1>(figure, None, svg));
            continue;
        }
        for (index, group) in groups {
            let svg = match &figure.kind {
                FigureKind::Curves { show, panels } => {
                    curves(material, fine, figure, index, show, *panels)
                }
                FigureKind::Efficiency {} => efficiency::draw(material, figure, group),
                FigureKind::LocalBandwidth { kernel } => {
                    local::draw(material, figure, group, kernel)
                }
                FigureKind::Coverage {} => coverage::draw(material, figure, group),
                _ => match common(material, figure, group) {
                    Some(svg) => svg,
                    None => continue,
                },
            };
            pictures.push(picture(figure, several.then_some(group), svg));
        }
    }
    pictures
}

/// One picture of all groups, where that says more than one each.
pub(super) fn together<const D: usize>(
    figure: &Figure,
    groups: &[(usize, &Group<D>)],
) -> Option<Svg> {
    let groups: Vec<&Group<D>> = groups.iter().map(|(_, group)| *group).collect();
    match &figure.kind {
        FigureKind::Errors { measure } => errors::over_sources(figure, &groups, measure),
        _ => None,
    }
}

/// The figures that are alike on a line and in the plane.
pub(super) fn common<const D: usize>(
    material: &Material<'_, D>,
    figure: &Figure,
    group: &Group<D>,
) -> Option<Svg>
where
    Paper: Draws<D>,
{
    let part = figure
        .region
        .as_deref()
        .and_then(|region| group.within(region));
    let group = part.as_ref().unwrap_or(group);
    match &figure.kind {
        FigureKind::Errors { measure } => Some(errors::draw(figure, group, measure)),
        FigureKind::Convergence { measure } => {
            Some(convergence::draw(material, figure, group, measure))
        }
        FigureKind::Modes {} => Some(mode_counts(material, figure, group)),
        FigureKind::Sweep { of, mark } => Some(sweep::draw(material, figure, group, of, mark)),
        FigureKind::Spread { of, at } => Some(spread::draw(material, figure, group, of, at)),
        FigureKind::Uncertainty { at, calibrated } => {
            Some(uncertain::draw(material, figure, group, *at, *calibrated))
        }
        _ => None,
    }
}

/// Whether a figure is about a group: the size it names, or the first.
pub(super) fn shows<const D: usize>(
    figure: &Figure,
    group: &Group<D>,
    material: &Material<'_, D>,
) -> bool {
    figure.draws.map_or(group.size == 0, |draws| {
        draws == group.draws || material.bench.is_fixed(group.source)
    })
}

pub(super) fn picture<const D: usize>(figure: &Figure, of: Option<&Group<D>>, svg: Svg) -> Picture {
    // what is over all sizes is of none
    let over_sizes = matches!(figure.kind, FigureKind::Convergence { .. });
    let title = match of {
        Some(group) if over_sizes => format!("{} — {}", figure.title, group.name),
        Some(group) => format!("{} — {}, n = {}", figure.title, group.name, group.draws),
        None => figure.title.clone(),
    };
    Picture {
        slug: slug(&title),
        title,
        caption: figure.caption.clone(),
        svg,
    }
}

/// Letters and digits of `title` joined by hyphens, at most 60 of them; safe as part of a file's name everywhere.
fn slug(title: &str) -> String {
    let mut slug = String::new();
    for letter in title.chars().flat_map(char::to_lowercase) {
        if letter.is_ascii_alphanumeric() {
            slug.push(letter);
        } else if !slug.ends_with('-') && !slug.is_empty() {
            slug.push('-');
        }
        if slug.len() >= 60 {
            break;
        }
    }
    slug.trim_end_matches('-').to_owned()
}

/// The estimators that a figure shows, as (position, outcome).
pub(super) fn chosen<'a, const D: usize>(
    figure: &'a Figure,
    group: &'a Group<D>,
) -> impl Iterator<Item = (usize, &'a Outcome)> {
    group
        .outcomes
        .iter()
        .enumerate()
        .filter(|(_, o)| figure.estimators.is_empty() || figure.estimators.contains(&o.name))
}

/// What the horizontal axis of a group's curves is called.
pub(super) fn place_axis<const D: usize>(material: &Material<'_, D>, group: &Group<D>) -> Axis {
    axis_of(material, group, 0).over(group.grid.low()[0], group.grid.high()[0])
}

/// What an axis of a group's domain is called.
pub(super) fn axis_of<const D: usize>(
    material: &Material<'_, D>,
    group: &Group<D>,
    axis: usize,
) -> Axis {
    let label = match &material.bench.experiment().sources[group.source] {
        SourceSpec::Density { .. } => ["x", "y"][axis.min(1)].to_owned(),
        SourceSpec::Scene { .. } => ["u", "v"][axis.min(1)].to_owned(),
        SourceSpec::File { columns, .. } => columns[axis].clone(),
    };
    Axis::new(label, "")
}

fn curves(
    material: &Material<'_>,
    fine: &Fine,
    figure: &Figure,
    index: usize,
    show: &[String],
    panels: bool,
) -> Svg {
    let (group, first) = (&material.results.groups[index], &fine.groups[index]);
    let wants = |what: &str| show.iter().any(|s| s == what);
    let mut series: Vec<Series> = Vec::new();
    if wants("truth") {
        series.extend(first.truth_series());
    }
    for (number, outcome) in chosen(figure, group) {
        if wants("sample") {
            series.push(first.series(number, &outcome.name, number));
        }
        if wants("mean") || wants("band") {
            series.push(average(
                group,
                number,
                outcome,
                wants("band"),
                wants("sample"),
            ));
        }
    }
    let estimates = series.iter().filter(|s| s.role != Role::Truth).count();
    let figure = Curves {
        title: String::new(),
        description: figure.caption.clone(),
        x: place_axis(material, group),
        y: Axis::new("density", ""),
        series,
        rug: if wants("rug") {
            first.data.clone()
        } else {
            Vec::new()
        },
        ..Curves::default()
    };
    if panels || estimates > CROWD {
        let columns = if estimates <= 4 { estimates.min(3) } else { 4 };
        figure.panels(columns.max(1)).draw()
    } else {
        figure.draw()
    }
}

/// The mean of an estimator over the replicates, with a band of one standard deviation on each side if wanted.
fn average(
    group: &Group,
    number: usize,
    outcome: &Outcome,
    band: bool,
    beside_sample: bool,
) -> Series {
    let x: Vec<f64> = group.grid.centres().map(|[x]| x).collect();
    let truth = |i: usize| group.truth.as_ref().map_or(0.0, |truth| truth[i]);
    let mean: Vec<f64> = outcome
        .tally
        .mean()
        .iter()
        .enumerate()
        .map(|(i, error)| error + truth(i))
        .collect();
    let name = if beside_sample {
        format!("{}, mean", outcome.name)
    } else {
        outcome.name.clone()
    };
    let role = match outcome.tally.deviation().filter(|_| band) {
        Some(deviation) => Role::Band {
            colour: number,
            low: mean.iter().zip(&deviation).map(|(m, d)| m - d).collect(),
            high: mean.iter().zip(&deviation).map(|(m, d)| m + d).collect(),
        },
        None => Role::Estimate(number),
    };
    Series {
        name,
        x,
        y: mean,
        role,
    }
}

fn densities(material: &Material<'_>, fine: &Fine, figure: &Figure) -> Svg {
    let panels = material
        .results
        .groups
        .iter()
        .zip(&fine.groups)
        .filter(|(group, _)| shows(figure, group, material));
    let panels: Vec<Small> = panels
        .map(|(group, first)| Small {
            title: group.name.clone(),
            series: first
                .truth_series()
                .into_iter()
                .chain(
                    chosen(figure, group)
                        .map(|(number, outcome)| first.series(number, &outcome.name, number)),
                )
                .collect(),
        })
        .collect();
    let columns = if panels.len() <= 4 {
        panels.len().max(1)
    } else {
        3
    };
    Multiples {
        title: String::new(),
        description: figure.caption.clone(),
        x: Axis::new("x", ""),
        y: Axis::new("density", ""),
        columns,
        shared: false,
        panels,
    }
    .draw()
}

fn mode_counts<const D: usize>(
    material: &Material<'_, D>,
    figure: &Figure,
    group: &Group<D>,
) -> Svg {
    let rows = chosen(figure, group).map(|(number, outcome)| {
        let most = outcome
            .replicates
            .iter()
            .map(|r| r.modes)
            .max()
            .unwrap_or(0);
        let mut replicates = vec![0; most + 1];
        for replicate in &outcome.replicates {
            replicates[replicate.modes] += 1;
        }
        ModeCounts {
            name: outcome.name.clone(),
            colour: number,
            replicates,
        }
    });
    Modes {
        title: String::new(),
        description: figure.caption.clone(),
        truth: material
            .bench
            .field(group.source)
            .map(|truth| mode_count(&truth.on(&group.grid), RIPPLE)),
        rows: rows.collect(),
    }
    .draw()
}

#[cfg(test)]
mod tests {
    use super::slug;

    #[test]
    fn slugs_are_safe_names() {
        assert_eq!(
            slug("One sample, three bandwidths"),
            "one-sample-three-bandwidths"
        );
        assert_eq!(slug("../../etc/<script>"), "etc-script");
        assert!(slug(&"ä very long ".repeat(20)).len() <= 60);
    }
}
