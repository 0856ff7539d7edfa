//! The tables of the report page. What is on disk has more digits and more rows.

use super::Material;
use crate::accuracy::compare;
use crate::experiment::Measure;
use crate::experiment::results::{CONFIDENCE, Group, Outcome};
use crate::kernel::{Kernel, Shape};
use crate::report::page::{Cell, Table};

/// Pairs are compared in the page for at most so many estimators.
const PAIRED: usize = 5;

/// Beyond so many groups their tables are joined, one row a group and estimator, and pairs are left to the file.
const APART: usize = 3;

/// The tables about all groups.
pub(super) fn all<const D: usize>(material: &Material<'_, D>) -> Vec<Table> {
    let groups = &material.results.groups;
    if groups.len() <= APART {
        return groups
            .iter()
            .flat_map(|group| of(material, group))
            .collect();
    }
    let mut joined: Vec<Table> = Vec::new();
    for group in groups {
        let name = format!("{}, n = {}", group.name, group.draws);
        let name_of_all = "all samples";
        let errors = group.truth.is_some().then(|| errors(name_of_all, group));
        // columns are those of all groups
        let oracles = oracles(name_of_all, group, true);
        let parts = parts(name_of_all, material, group);
        for mut table in errors.into_iter().chain(oracles).chain([parts]) {
            for row in &mut table.rows {
                row.insert(0, Cell::text(&name));
            }
            if let Some(known) = joined.iter_mut().find(|known| known.title == table.title) {
                known.rows.append(&mut table.rows);
            } else {
                table.columns.insert(0, "sample".to_owned());
                joined.push(table);
            }
        }
    }
    joined
}

/// The tables about one group.
fn of<const D: usize>(material: &Material<'_, D>, group: &Group<D>) -> Vec<Table> {
    let name = format!("{}, n = {}", group.name, group.draws);
    let mut tables = Vec::new();
    if group.truth.is_some() {
        tables.push(errors(&name, group));
        tables.extend(oracles(&name, group, false));
    }
    tables.extend(super::regions::tables(&name, group));
    tables.push(parts(&name, material, group));
    tables.extend(pairs(&name, group));
    tables
}

/// A standard error below this share of its value says nothing that the reader of a page could use; the files keep it.
const NEGLIGIBLE: f64 = 1e-4;

/// A column: its heading, and what stands in it for an estimator.
type Column<'a> = (&'a str, Box<dyn Fn(usize, &Outcome) -> Cell + 'a>);

fn table<const D: usize>(
    title: String,
    caption: &str,
    group: &Group<D>,
    columns: &[Column<'_>],
) -> Table {
    let rows = group.outcomes.iter().enumerate().map(|(number, outcome)| {
        let cells = columns.iter().map(|(_, cell)| cell(number, outcome));
        [Cell::text(&outcome.name)]
            .into_iter()
            .chain(cells)
            .collect()
    });
    Table {
        title,
        caption: caption.to_owned(),
        rows: rows.collect(),
        columns: ["estimator"]
            .into_iter()
            .chain(columns.iter().map(|(heading, _)| *heading))
            .map(str::to_owned)
            .collect(),
    }
}

fn measured(heading: &str, measure: Measure) -> Column<'_> {
    let cell = move |_: usize, outcome: &Outcome| {
        outcome
            .measures
            .get(&measure)
            .map_or(Cell::Empty, |m| match m.standard_error {
                Some(error) if error > NEGLIGIBLE * m.value.abs() => Cell::measured(m.value, error),
                _ => Cell::exact(m.value),
            })
    };
    (heading, Box::new(cell))
}

fn errors<const D: usize>(name: &str, group: &Group<D>) -> Table {
    let columns = [
        measured("MISE", Measure::Mise),
        measured("exact", Measure::ExactMise),
        measured("MIAE", Measure::Miae),
        measured("MIRE", Measure::Mire),
        measured("energy", Measure::Energy),
        measured("modes", Measure::Modes),
    ];
    table(
        format!("Errors: {name}"),
        "Means over the replicates ± standard errors; the exact MISE is theory on the same grid, without simulation. MIRE where the truth is at least 1 % of its peak. Energy: the integral of the \
         estimate over the grid relative to the truth's.",
        group,
        &columns,
    )
}

/// How far errors are from what an oracle could reach; `None` where theory knows nothing of that. Without `wanting` there is no column in which nothing is known.
fn oracles<const D: usize>(name: &str, group: &Group<D>, wanting: bool) -> Option<Table> {
    const RUNGS: [(&str, Measure); 3] = [
        ("over best", Measure::OverBest),
        ("over kernel", Measure::OverKernel),
        ("over local kernel", Measure::OverLocalKernel),
    ];
    let known = |measure: Measure| {
        let mut outcomes = group.outcomes.iter();
        outcomes.any(|outcome| outcome.measures.contains_key(&measure))
    };
    if !RUNGS.iter().any(|(_, measure)| known(*measure)) {
        return None;
    }
    let rungs = RUNGS.iter().filter(|(_, m)| wanting || known(*m));
    let columns: Vec<Column<'_>> = [("MISE", Measure::Mise)]
        .iter()
        .chain(rungs)
        .map(|(heading, measure)| measured(heading, *measure))
        .collect();
    Some(table(
        format!("Against oracles: {name}"),
        "The MISE, and how many times it is what one could reach who knows the density. Over best: the same kind of estimate with its best bandwidth, width, k or number of terms, over the whole line or plane, or \
         on a line over the grid where that has walls or is cut short. Over kernel: a Gaussian kernel with its best bandwidth, reflected at walls, in a polygon cut and normalised. Over local kernel: that kernel with \
         the best bandwidth at each place.",
        group,
        &columns,
    ))
}

fn parts<const D: usize>(name: &str, material: &Material<'_, D>, group: &Group<D>) -> Table {
    let kernels: Vec<Option<Shape>> = (0..group.outcomes.len())
        .map(|number| kernel_of(material, number))
        .collect();
    let mut columns = vec![measured("h", Measure::Smoothing)];
    if kernels.iter().any(Option::is_some) {
        columns.push(scaled("h √k₂", &kernels, |kernel| {
            kernel.variance().sqrt()
        }));
        columns.push(scaled("h / δ₀", &kernels, |kernel| {
            kernel.canonical_scale().recip()
        }));
    }
    let bandwidths = "Bandwidths also as the kernel's deviation h √k₂ and as the canonical bandwidth h / δ₀, in which kernels compare; for histograms h is the full width of a bin.";
    if group.truth.is_none() {
        columns.extend([
            measured("integral", Measure::Energy),
            measured("modes", Measure::Modes),
        ]);
        let caption = format!(
            "No true density is known, so there are no errors. {bandwidths} The integral is over the grid."
        );
        return table(name.to_owned(), &caption, group, &columns);
    }
    columns.extend([
        measured("bias²", Measure::Bias2),
        measured("exact", Measure::ExactBias2),
        measured("variance", Measure::Variance),
        measured("exact", Measure::ExactVariance),
    ]);
    let caption = format!(
        "Integrated squared bias and integrated variance, whose sum is the MISE. {bandwidths}"
    );
    table(
        format!("Bandwidth, bias and variance: {name}"),
        &caption,
        group,
        &columns,
    )
}

fn scaled<'a>(
    heading: &'a str,
    kernels: &'a [Option<Shape>],
    scale: impl Fn(Shape) -> f64 + 'a,
) -> Column<'a> {
    let cell = move |number: usize, outcome: &Outcome| {
        let h = outcome.measures.get(&Measure::Smoothing).map(|m| m.value);
        h.zip(kernels[number])
            .map_or(Cell::Empty, |(h, kernel)| Cell::exact(h * scale(kernel)))
    };
    (heading, Box::new(cell))
}

/// The kernel of an estimator, where it has one.
fn kernel_of<const D: usize>(material: &Material<'_, D>, number: usize) -> Option<Shape> {
    let spec = &material.bench.experiment().estimators[number];
    match spec.kind.as_str() {
        "naive" => Some(Shape::Uniform),
        _ => spec.values.word("shape").and_then(Shape::named),
    }
}

fn pairs<const D: usize>(name: &str, group: &Group<D>) -> Option<Table> {
    let few = (2..=PAIRED).contains(&group.outcomes.len());
    if group.truth.is_none() || !few || group.outcomes.first()?.replicates.len() < 2 {
        return None;
    }
    let mut rows = Vec::new();
    for (i, a) in group.outcomes.iter().enumerate() {
        for b in &group.outcomes[i + 1..] {
            let mut row = vec![Cell::text(&a.name), Cell::text(&b.name)];
            for measure in [Measure::Mise, Measure::Miae, Measure::Mire] {
                let paired = compare(
                    &a.per_replicate(measure, 1.0)?,
                    &b.per_replicate(measure, 1.0)?,
                    CONFIDENCE,
                );
                row.push(match paired.ratio_error {
                    Some(error) if error > 0.0 => Cell::measured(paired.ratio, error),
                    _ => Cell::exact(paired.ratio),
                });
            }
            rows.push(row);
        }
    }
    Some(Table {
        title: format!("In pairs: {name}"),
        caption: "Ratio of mean errors on the same samples ± standard error.".to_owned(),
        columns: [
            "estimator",
            "against",
            "MISE ratio",
            "MIAE ratio",
            "MIRE ratio",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
    })
}
