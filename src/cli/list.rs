//! `lab list`

use super::notes::Notes;
use super::output::Output;
use super::stop::Stop;
use crate::boundary;
use crate::density;
use crate::engine::{Binned, Direct, Engine, Hermite};
use crate::experiment::catalogue::{ESTIMATORS, Entry};
use crate::experiment::settings::{Promise, promises};
use crate::kernel::{Kernel, Shape};
use crate::parameter::{Absent, Parameter};
use crate::selector;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Show what can be named: densities, estimators, kernels, ...
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab list
  lab list estimators                             with their laws, cost, source and parameters
  lab list densities --json | jq -r '.[].name'")]
pub struct List {
    /// One kind only; with its details
    kind: Option<Family>,

    /// As JSON
    #[arg(long)]
    json: bool,
}

/// What can be listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Family {
    /// Known truths
    Densities,
    /// Ways from a sample to an estimate
    Estimators,
    /// Bumps
    Kernels,
    /// Rules that choose a bandwidth
    Selectors,
    /// Treatments of walls
    Boundaries,
    /// Ways to compute a kernel sum
    Engines,
    /// Files in the folder `experiments`
    Experiments,
    /// Files in the folder `data/scenes`
    Scenes,
}

/// One thing that has a name.
#[derive(Serialize)]
struct Row {
    name: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    aliases: Vec<&'static str>,
    summary: String,
    #[serde(skip_serializing_if = "str::is_empty")]
    cost: &'static str,
    #[serde(skip_serializing_if = "str::is_empty")]
    reference: &'static str,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    laws: Vec<Kept>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parameters: Vec<Setting>,
}

/// What it promises somewhere.
#[derive(Serialize)]
struct Kept {
    /// `line`, `plane` or both.
    space: Vec<&'static str>,
    laws: Vec<Law>,
}

/// One promise.
#[derive(PartialEq, Serialize)]
struct Law {
    name: &'static str,
    /// With a number for the smoothing and defaults for the rest.
    holds: bool,
    /// The settings that change this.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    unless: BTreeMap<&'static str, Vec<String>>,
}

/// One parameter of it.
#[derive(Serialize)]
struct Setting {
    name: &'static str,
    takes: String,
    default: Option<String>,
    help: &'static str,
}

impl Row {
    fn new(name: impl Into<String>, summary: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            aliases: Vec::new(),
            summary: summary.into(),
            cost: "",
            reference: "",
            laws: Vec::new(),
            parameters: Vec::new(),
        }
    }
}

impl List {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let mut output = Output::open(None)?;
        match (self.kind, self.json) {
            (Some(family), true) => output.json(&rows(family, notes)?)?,
            (Some(family), false) => details(&mut output, &rows(family, notes)?)?,
            (None, true) => {
                let mut all = serde_json::Map::new();
                for family in Family::value_variants() {
                    let rows = serde_json::to_value(rows(*family, notes)?)
                        .map_err(|error| Stop::System(error.to_string()))?;
                    all.insert(title(*family), rows);
                }
                output.json(&all)?;
            }
            (None, false) => {
                for (i, family) in Family::value_variants().iter().enumerate() {
                    let gap = if i > 0 { "\n" } else { "" };
                    writeln!(output, "{gap}{}:", title(*family))?;
                    let rows = rows(*family, notes)?;
                    let width = width(rows.iter().map(|row| row.name.as_str()));
                    for row in rows {
                        writeln!(output, "  {:width$}  {}", row.name, row.summary)?;
                    }
                }
            }
        }
        output.finish()
    }
}

fn title(family: Family) -> String {
    let value = family.to_possible_value();
    value.map_or_else(String::new, |value| value.get_name().to_owned())
}

fn width<'a>(names: impl Iterator<Item = &'a str>) -> usize {
    names.map(|name| name.chars().count()).max().unwrap_or(0)
}

fn details(output: &mut Output, rows: &[Row]) -> Result<(), Stop> {
    for row in rows {
        let aliases = if row.aliases.is_empty() {
            String::new()
        } else {
            format!(" (also {})", row.aliases.join(", "))
        };
        writeln!(output, "{}{aliases}\n    {}", row.name, row.summary)?;
        for (label, text) in [("cost", row.cost), ("source", row.reference)] {
            if !text.is_empty() {
                writeln!(output, "    {label}: {text}")?;
            }
        }
        for kept in &row.laws {
            laws(output, kept)?;
        }
        let width = width(row.parameters.iter().map(|setting| setting.name));
        for setting in &row.parameters {
            let Setting {
                name, takes, help, ..
            } = setting;
            let default = match &setting.default {
                Some(value) => format!("; default {value}"),
                None => String::new(),
            };
            writeln!(output, "    - {name:width$}  {takes}{default}")?;
            writeln!(output, "      {:width$}  {help}", "")?;
        }
    }
    Ok(())
}

/// What holds, then each exception on a line of its own.
fn laws(output: &mut Output, kept: &Kept) -> Result<(), Stop> {
    let space = match kept.space[..] {
        ["line"] => "on a line",
        ["plane"] => "in the plane",
        _ => "on a line and in the plane",
    };
    let holding: Vec<&str> = kept
        .laws
        .iter()
        .filter(|law| law.holds)
        .map(|law| law.name)
        .collect();
    let holding = if holding.is_empty() {
        "none".to_owned()
    } else {
        holding.join(", ")
    };
    writeln!(output, "    laws {space}: {holding}")?;
    for law in kept.laws.iter().filter(|law| !law.unless.is_empty()) {
        let settings: Vec<String> = law
            .unless
            .iter()
            .map(|(parameter, values)| format!("{parameter} = {}", values.join(" | ")))
            .collect();
        let but = if law.holds { "not " } else { "" };
        writeln!(
            output,
            "      {but}{} with {}",
            law.name,
            settings.join(", ")
        )?;
    }
    Ok(())
}

/// What an estimator promises on the line and in the plane, together where it is the same.
fn kept(entry: &Entry) -> Vec<Kept> {
    let laws = |promises: Vec<Promise>| -> Vec<Law> {
        promises
            .into_iter()
            .map(|promise| Law {
                name: promise.law,
                holds: promise.holds,
                unless: promise.unless.into_iter().collect(),
            })
            .collect()
    };
    let (line, plane) = (laws(promises::<1>(entry)), laws(promises::<2>(entry)));
    let all = if line == plane {
        vec![(vec!["line", "plane"], line)]
    } else {
        vec![(vec!["line"], line), (vec!["plane"], plane)]
    };
    all.into_iter()
        .filter(|(_, laws)| !laws.is_empty())
        .map(|(space, laws)| Kept { space, laws })
        .collect()
}

fn rows(family: Family, notes: Notes) -> Result<Vec<Row>, Stop> {
    Ok(match family {
        Family::Densities => density::entries()
            .map(|entry| Row {
                aliases: entry.names[1..].to_vec(),
                reference: entry.reference,
                parameters: settings(entry.parameters),
                ..Row::new(entry.names[0], entry.summary)
            })
            .collect(),
        Family::Estimators => ESTIMATORS
            .iter()
            .map(|entry| Row {
                cost: entry.cost,
                reference: entry.reference,
                laws: kept(entry),
                parameters: settings(entry.parameters),
                ..Row::new(entry.name, entry.summary)
            })
            .collect(),
        Family::Kernels => Shape::ALL.into_iter().map(kernel).collect(),
        Family::Selectors => selectors(),
        Family::Boundaries => boundary::NAMES
            .into_iter()
            .zip(boundary::SUMMARIES)
            .map(|(name, summary)| Row::new(name, summary))
            .collect(),
        Family::Engines => engines(),
        Family::Experiments => files(
            Path::new("experiments"),
            "question",
            "(not a legal experiment: see lab check)",
            notes,
        )?,
        Family::Scenes => files(
            Path::new("data/scenes"),
            "title",
            "(without a title)",
            notes,
        )?,
    })
}

fn kernel(shape: Shape) -> Row {
    let support = if shape.reach() > 1.0 {
        "the whole line"
    } else {
        "|u| <= 1"
    };
    Row::new(
        shape.name(),
        format!(
            "support {support}, variance {:.4}, roughness {:.4}, efficiency {:.4}",
            shape.variance(),
            shape.roughness(),
            shape.efficiency()
        ),
    )
}

fn selectors() -> Vec<Row> {
    let named = selector::CATALOGUE.iter().map(|entry| Row {
        cost: entry.cost,
        reference: entry.reference,
        ..Row::new(entry.name, entry.summary)
    });
    let on_line = |name: &str| selector::entry_of(name).is_some();
    let plane = selector::PLANE.iter().map(move |entry| Row {
        cost: entry.cost,
        reference: entry.reference,
        ..Row::new(
            format!(
                "{}{}",
                entry.name,
                if on_line(entry.name) {
                    " (in the plane)"
                } else {
                    ""
                }
            ),
            entry.summary,
        )
    });
    let others = selector::OTHERS.iter().map(|entry| Row {
        cost: entry.cost,
        reference: entry.reference,
        ..Row::new(
            format!("{} = {}", entry.parameter, entry.name),
            entry.summary,
        )
    });
    let known = [
        Row::new("oracle", "the least exact MISE, where the truth is known"),
        Row::new(
            "oracle-ise",
            "the least ISE for each sample, where the truth is known",
        ),
        Row::new(
            "amise",
            "the least asymptotic MISE, where the truth is known",
        ),
    ];
    named.chain(known).chain(plane).chain(others).collect()
}

fn engines() -> Vec<Row> {
    let named = |engine: &dyn Engine<1>, summary| Row::new(engine.name(), summary);
    vec![
        named(&Direct, "the definition, point by point; any kernel, n m"),
        named(
            &Binned::default(),
            "Gaussian on a grid, from shares in fine cells, to a proved tolerance; n + nodes",
        ),
        named(
            &Hermite,
            "Gaussian anywhere, exactly, from moments in cells; n + m",
        ),
    ]
}

/// The TOML files in `folder` with the text of `key`, or `otherwise`.
fn files(folder: &Path, key: &str, otherwise: &str, notes: Notes) -> Result<Vec<Row>, Stop> {
    if !folder.is_dir() {
        notes.say(&format!("there is no folder `{}` here", folder.display()));
        return Ok(Vec::new());
    }
    let entries = std::fs::read_dir(folder).map_err(|e| Stop::reading(folder, &e))?;
    let mut rows = Vec::new();
    for entry in entries {
        let path = entry.map_err(|e| Stop::reading(folder, &e))?.path();
        if path.extension().is_none_or(|ending| ending != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).map_err(|e| Stop::reading(&path, &e))?;
        let summary = toml::from_str::<toml::Table>(&text)
            .ok()
            .and_then(|table| Some(table.get(key)?.as_str()?.to_owned()))
            .unwrap_or_else(|| otherwise.to_owned());
        rows.push(Row::new(path.display().to_string(), summary));
    }
    rows.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(rows)
}

fn settings(parameters: &[Parameter]) -> Vec<Setting> {
    parameters
        .iter()
        .map(|parameter| Setting {
            name: parameter.name,
            takes: takes(parameter),
            default: match parameter.absent {
                Absent::Required | Absent::Unset => None,
                Absent::Number(x) => Some(x.to_string()),
                Absent::Word(word) => Some(format!("\"{word}\"")),
                Absent::Flag(flag) => Some(flag.to_string()),
            },
            help: parameter.help,
        })
        .collect()
}

fn takes(parameter: &Parameter) -> String {
    if parameter.sweeps {
        format!("{}; a list for a sweep", parameter.kind)
    } else {
        parameter.kind.to_string()
    }
}
