//! The experiment from its parts.

use super::estimator::{self, Given, Group};
use super::names::Names;
use super::node::{Entry, Reader, Table};
use super::problem::{Problem, printable};
use super::setting::{Setting, Theory};
use super::trial::try_building;
use super::{CLAIMS, DRAWS, ESTIMATORS, FIGURES, REGIONS, REPLICATES};
use super::{claim, figure, grid, region, source};
use crate::experiment::budget::{self, Part};
use crate::experiment::region::RegionSpec;
use crate::experiment::stop::StopRule;
use crate::experiment::{Experiment, GridSpec};
use std::collections::BTreeSet;
use std::path::Path;
use toml::de::DeValue;

/// The keys of the top level with what they mean.
pub(crate) const KEYS: &[(&str, &str)] = &[
    ("question", "the question that the experiment answers"),
    (
        "notes",
        "what the reader should know before the answer; paragraphs separated by empty lines",
    ),
    ("seed", "the seed of all random streams; 1 by default"),
    ("source", "where samples come from"),
    (
        "draws",
        "the sample size n, or a list of them: points of a density, emitted paths in a scene",
    ),
    ("replicates", "how many samples of each size; 1 by default"),
    (
        "grid",
        "where estimates are evaluated and errors integrated; chosen from the source by default",
    ),
    ("region", "parts of the grid that errors are told apart by"),
    (
        "interval",
        "the confidence of an interval about each estimate at each target, whose coverage is then counted; none by default",
    ),
    (
        "estimator",
        "what is compared: a name and one kind with its settings",
    ),
    (
        "stop",
        "when the run has seen enough before all replicates are done",
    ),
    (
        "uncertainty",
        "what one sample says of its own error, held against the true one: a name and one kind with its settings",
    ),
    ("figure", "what to draw"),
    ("claim", "what the run must show"),
];

/// At most so many estimates of the error: each costs as much as the estimate itself.
const UNCERTAINTIES: usize = 20;

/// What comes before the estimators; `None` for what is wrong, which has been reported.
struct Head<'d> {
    question: Option<String>,
    notes: Option<String>,
    seed: Option<u64>,
    sources: Option<Vec<source::Read>>,
    /// Whether the truth is known. Known even of a faulty source, so that nobody is asked for the draws of a file.
    truth: Option<bool>,
    draws: Option<Vec<usize>>,
    replicates: Option<usize>,
    /// None if it is absent or faulty, which has then been reported.
    stop: Option<StopRule>,
    grid: Option<GridSpec>,
    /// Where the numbers stand that decide what the run needs.
    draws_entry: Option<Entry<'d>>,
    replicates_entry: Option<Entry<'d>>,
    grid_entry: Option<Entry<'d>>,
}

fn head<'d>(reader: &mut Reader, top: &mut Table<'d>, folder: &Path) -> Head<'d> {
    let question = top
        .need(
            reader,
            "question",
            "an experiment answers a question: question = \"..\"",
        )
        .and_then(|entry| reader.words(entry.item, "`question`", 2000));
    let notes = match top.take("notes") {
        Some(entry) => reader.prose(entry.item, "`notes`", 100_000),
        None => Some(String::new()),
    };
    let seed = match top.take("seed") {
        Some(entry) => reader.count(entry.item, "`seed`", 0, i64::MAX as u64),
        None => Some(1),
    };
    let source = top.need(
        reader,
        "source",
        "for instance: source = { density = \"bimodal\" }",
    );
    let sources = source.and_then(|entry| source::sources(reader, entry, folder));
    let truth = source.and_then(|entry| {
        let table = entry.item.get_ref().as_table()?;
        match source::KINDS.map(|key| table.contains_key(key)) {
            [true, false, false] | [false, false, true] => Some(true),
            [false, true, false] => Some(false),
            _ => None,
        }
    });
    let draws_entry = top.take("draws");
    let draws = draws(reader, top, draws_entry, truth);
    let replicates_entry = top.take("replicates");
    let replicates = match replicates_entry {
        Some(entry) => reader
            .count(entry.item, "`replicates`", 1, REPLICATES)
            .map(|r| r as usize),
        None => Some(1),
    };
    if let (Some(entry), Some(false), Some(2..)) = (replicates_entry, truth, replicates) {
        reader.report(
            Problem::at(
                entry.item.span(),
                "a data file is one sample: it has no replicates",
            )
            .help("leave `replicates` out"),
        );
    }
    let stop = top
        .take("stop")
        .and_then(|entry| super::stop::stop(reader, entry, truth, replicates));
    let grid_entry = top.take("grid");
    let dimensions = sources
        .as_ref()
        .and_then(|sources| Some(sources.first()?.spec.dimensions()));
    let grid = grid_entry.and_then(|entry| grid::read(reader, entry.item, dimensions));
    Head {
        question,
        notes,
        seed,
        sources,
        truth,
        draws,
        replicates,
        stop,
        grid,
        draws_entry,
        replicates_entry,
        grid_entry,
    }
}

impl Head<'_> {
    /// 1 on a line, 2 in the plane.
    fn dimensions(&self) -> Option<usize> {
        Some(self.sources.as_ref()?.first()?.spec.dimensions())
    }
}

/// The regions, and the names of those that are sound.
fn regions(
    reader: &mut Reader,
    top: &mut Table<'_>,
    head: &Head<'_>,
) -> (Option<Vec<RegionSpec>>, Vec<String>) {
    let mut known = Vec::new();
    let regions = parts(reader, top, "region", REGIONS, |reader, table| {
        region::region(
            reader,
            table,
            head.dimensions(),
            head.grid.as_ref(),
            &mut known,
        )
    });
    (regions, known)
}

/// Reads all of the document; `None` if anything of the result is missing, which has then been reported.
#[expect(
    clippy::too_many_lines,
    reason = "one part of the file after the other"
)]
pub(super) fn experiment(
    reader: &mut Reader,
    document: &toml::Spanned<toml::de::DeTable<'_>>,
    text: &str,
    origin: &Path,
) -> Option<Experiment> {
    let mut top = Table::new(document.get_ref(), 0..0, "the experiment");
    let folder = origin.parent().unwrap_or(Path::new(""));
    let head = head(reader, &mut top, folder);
    let interval = top
        .take("interval")
        .and_then(|entry| interval(reader, entry));
    let (groups, names) = estimators(reader, &mut top);
    let theory = match (&head.sources, &head.draws) {
        (Some(sources), Some(draws)) => {
            try_building(reader, &groups, sources, draws, head.grid.as_ref())
        }
        _ => Theory::default(),
    };
    let uncertainties = parts(
        reader,
        &mut top,
        "uncertainty",
        UNCERTAINTIES,
        super::uncertainty::uncertainty,
    );
    let uncertain: Vec<String> = uncertainties
        .iter()
        .flatten()
        .map(|spec| spec.name.clone())
        .collect();
    if let Some((at, _)) =
        (uncertain.iter().enumerate()).find(|(at, name)| uncertain[..*at].contains(name))
    {
        reader.report(
            Problem::at(
                top.span.clone(),
                format!(
                    "there is an uncertainty \"{}\" already",
                    printable(&uncertain[at])
                ),
            )
            .help("give each a `name` of its own"),
        );
    }
    let dimensions = head.dimensions();
    let (regions, known) = regions(reader, &mut top, &head);
    let rooms: Option<Vec<_>> = head.sources.as_ref().map(|sources| {
        let rooms = sources.iter();
        rooms
            .filter_map(|read| Some((&read.spec, read.scene.as_deref()?)))
            .collect()
    });
    let setting = Setting {
        rooms: rooms.as_deref(),
        uncertainties: &uncertain,
        names: &names,
        regions: &known,
        sources: head
            .sources
            .as_ref()
            .map(|sources| sources.iter().map(|read| read.spec.name()).collect()),
        draws: head.draws.as_deref(),
        replicates: head.replicates,
        dimensions,
        truth: head.truth,
        interval: interval.is_some(),
        power: head.sources.iter().flatten().fold(None, |least, read| {
            let power = read.truth.clone()?.line()?.roughness(0);
            Some(least.map_or(power, |least: f64| least.min(power)))
        }),
        theory: &theory,
    };
    let figures = parts(reader, &mut top, "figure", FIGURES, |reader, table| {
        figure::figure(reader, table, &setting)
    });
    let claims = parts(reader, &mut top, "claim", CLAIMS, |reader, table| {
        let before = &text[..table.span.start.min(text.len())];
        let line = before.matches('\n').count() + 1;
        claim::claim(reader, table, &setting, line)
    });
    let allowed: Vec<&str> = KEYS.iter().map(|(key, _)| *key).collect();
    top.finish(reader, &allowed);
    let experiment = Experiment {
        name: origin
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned())
            .filter(|stem| stem != "-" && !stem.is_empty())
            .unwrap_or_else(|| "experiment".to_owned()),
        question: head.question?,
        notes: head.notes?,
        seed: head.seed?,
        sources: head.sources?.into_iter().map(|read| read.spec).collect(),
        draws: head.draws?,
        replicates: head.replicates?,
        stop: head.stop,
        grid: head.grid,
        interval,
        regions: regions?,
        estimators: groups.into_iter().flat_map(|group| group.members).collect(),
        uncertainties: uncertainties?,
        figures: figures?,
        claims: claims?,
    };
    if reader.problems.is_empty() {
        let budget = budget::budget(&experiment);
        if let Err(refusal) = budget.check(crate::memory::available()) {
            let entry = match refusal.part {
                Part::Draws => head.draws_entry,
                Part::Replicates => head.replicates_entry,
                Part::Grid => head.grid_entry,
            };
            let span = entry.map_or(0..0, |entry| entry.item.span());
            reader.report(Problem::at(span, refusal.what));
        }
    }
    Some(experiment)
}

/// The confidence of intervals; `None` for what is wrong, which has been reported.
fn interval(reader: &mut Reader, entry: Entry<'_>) -> Option<f64> {
    let confidence = reader.real(entry.item, "`interval`")?;
    let legal = (0.5..=0.9999).contains(&confidence);
    if !legal {
        reader.report(
            Problem::at(
                entry.item.span(),
                format!("{confidence} is no confidence for an interval"),
            )
            .allowed("a number from 0.5 to 0.9999"),
        );
    }
    legal.then_some(confidence)
}

fn draws(
    reader: &mut Reader,
    top: &Table<'_>,
    entry: Option<Entry<'_>>,
    truth: Option<bool>,
) -> Option<Vec<usize>> {
    let Some(entry) = entry else {
        if truth == Some(true) {
            reader.report(
                Problem::at(
                    top.span.clone(),
                    "the experiment needs `draws`: the sample size",
                )
                .help("for instance: draws = 200, or draws = [100, 1000, 10000]")
                .doubtful(),
            );
            return None;
        }
        return Some(Vec::new());
    };
    if truth == Some(false) {
        reader.report(
            Problem::at(
                entry.key_span(),
                "a data file has a size of its own: `draws` is for densities and scenes",
            )
            .help("leave `draws` out"),
        );
        return None;
    }
    let DeValue::Array(list) = entry.item.get_ref() else {
        return reader
            .count(entry.item, "`draws`", 1, DRAWS)
            .map(|n| vec![n as usize]);
    };
    if list.is_empty() {
        reader.report(
            Problem::at(entry.item.span(), "`draws` is an empty list")
                .allowed("at least one sample size"),
        );
        return None;
    }
    let mut read = Vec::new();
    let mut sound = true;
    for item in list {
        match reader.count(item, "each of `draws`", 1, DRAWS) {
            Some(n) if read.contains(&(n as usize)) => {
                reader.report(Problem::at(
                    item.span(),
                    format!("the sample size {n} is in the list twice"),
                ));
                sound = false;
            }
            Some(n) => read.push(n as usize),
            None => sound = false,
        }
    }
    sound.then_some(read)
}

fn estimators(reader: &mut Reader, top: &mut Table<'_>) -> (Vec<Group>, Names) {
    let mut names = Names::default();
    let mut groups: Vec<Group> = Vec::new();
    let Some(entry) = top.take("estimator") else {
        reader.report(
            Problem::at(top.span.clone(), "the experiment compares no estimators")
                .help("for instance: [[estimator]] and below it kernel = { bandwidth = 0.3 }")
                .doubtful(),
        );
        names.doubt();
        return (groups, names);
    };
    let tables = reader.tables(entry, "an estimator");
    if tables.is_empty() {
        names.doubt();
        if reader.problems.is_empty() {
            reader.report(Problem::at(
                entry.item.span(),
                "the list of estimators is empty",
            ));
        }
    }
    let mut seen: BTreeSet<String> = BTreeSet::new();
    let mut all = 0;
    for table in tables {
        let (given, group) = estimator::group(reader, table);
        names.add(&given, group.as_ref());
        let span = match (&group, &given) {
            (Some(group), _) => group.name_span.clone(),
            (None, Given::Name(_, span)) => span.clone(),
            (None, _) => continue,
        };
        let label = group.as_ref().map(|group| &group.name);
        let labels: BTreeSet<String> = label
            .or(match &given {
                Given::Name(name, _) => Some(name),
                _ => None,
            })
            .into_iter()
            .chain(
                group
                    .iter()
                    .flat_map(|group| group.members.iter().map(|m| &m.name)),
            )
            .cloned()
            .collect();
        if let Some(twice) = labels.iter().find(|name| seen.contains(*name)) {
            reader.report(
                Problem::at(
                    span,
                    format!("there is an estimator \"{}\" already", printable(twice)),
                )
                .help("give each a `name` of its own"),
            );
        }
        seen.extend(labels);
        let Some(group) = group else { continue };
        all += group.members.len();
        if all > ESTIMATORS {
            reader.report(
                Problem::at(
                    group.name_span.clone(),
                    format!("{all} estimators, sweeps expanded, are too many"),
                )
                .allowed(format!("at most {ESTIMATORS}")),
            );
            break;
        }
        groups.push(group);
    }
    (groups, names)
}

/// Reads `[[key]]`; `None` if any of them is wrong.
fn parts<'d, T>(
    reader: &mut Reader,
    top: &mut Table<'d>,
    key: &str,
    most: usize,
    mut read: impl FnMut(&mut Reader, Table<'d>) -> Option<T>,
) -> Option<Vec<T>> {
    let Some(entry) = top.take(key) else {
        return Some(Vec::new());
    };
    let tables = reader.tables(entry, &format!("a {key}"));
    if tables.len() > most {
        reader.report(
            Problem::at(
                tables[most].span.clone(),
                format!("{} times [[{key}]] is too many", tables.len()),
            )
            .allowed(format!("at most {most}")),
        );
        return None;
    }
    let read: Vec<Option<T>> = tables
        .into_iter()
        .map(|table| read(reader, table))
        .collect();
    read.into_iter().collect()
}
