//! `lab doctor`

use super::argument;
use super::notes::Notes;
use super::output::Output;
use super::stop::Stop;
use crate::doctor::calibration::{Grade, LEVELS, Meaning, band, calibrate};
use crate::doctor::{
    CHECKS, Examination, FAULTS, Fault, LEVEL, POWER, check_level, examine, fault,
};
use crate::experiment::significant;
use crate::parameter::nearest;
use crate::report::figure::{Axis, Multiples, Role, Series, Small};
use clap::Args;
use comfy_table::{Cell, CellAlignment, Table, presets};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Is the laboratory itself well? Self-checks of stated level and power, and known faults to try them on
///
/// Every check draws its own samples, compares an implementation with what theory says, and states what relative error it would find with probability 90 %. A healthy
/// laboratory fails the whole suite for at most 1 % of all seeds. With --plant a wrong implementation takes the place of a right one, and the table shows which checks
/// notice, for what share of the seeds. With -o everything that states a probability (intervals, bounds, tests) is graded over 1000 seeds, or as many as --seeds says, and drawn: how
/// often it came true.
///
/// Exit code 1 when a check fails: for one seed any, for several more seeds than the stated level explains; with a fault planted, when it was caught. With `--plant all` it is 1 when one
/// was not caught. With -o it is 1 when a promise was not kept.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab doctor                                 every check once
  lab doctor --seeds 200                     how often does it cry wolf?
  lab doctor --list                          checks and faults
  lab doctor --plant parity-split            who notices that batches are made of hits, not paths?
  lab doctor --plant all --seeds 20          every fault, the power of the check that finds it best
  lab doctor -o reliability.svg              nominal against actual probabilities")]
pub struct Doctor {
    /// What there is to check and to plant
    #[arg(long, conflicts_with_all = ["plant", "output"])]
    list: bool,

    /// Puts a known fault in place, or each in turn: all
    #[arg(long, value_name = "FAULT", conflicts_with = "output")]
    plant: Option<String>,

    /// The first seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// How many seeds, one after the other [default: 1, with -o 1000]
    #[arg(long, value_name = "N", value_parser = argument::count)]
    seeds: Option<u64>,

    /// A picture of nominal against actual probabilities: an .svg file
    #[arg(short, long, value_name = "FIGURE.svg")]
    output: Option<PathBuf>,

    /// As JSON
    #[arg(long)]
    json: bool,
}

/// The most seeds: more would run for days.
const MOST: u64 = 100_000;

impl Doctor {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        if self.list {
            return self.show_list();
        }
        let seeds = self
            .seeds
            .unwrap_or(if self.output.is_some() { 1000 } else { 1 });
        if seeds > MOST {
            return Err(Stop::Input(format!("--seeds: allowed are 1 to {MOST}")));
        }
        let seeds = seeds as usize;
        if self.output.is_some() {
            return self.reliability(seeds);
        }
        match self.plant.as_deref() {
            Some("all") => self.every_fault(seeds, notes),
            Some(name) => self.examination(seeds, Some(known(name)?), notes),
            None => self.examination(seeds, None, notes),
        }
    }

    fn show_list(&self) -> Result<(), Stop> {
        let mut output = Output::open(None)?;
        if self.json {
            let checks = CHECKS
                .iter()
                .map(|check| json!({ "name": check.name, "states": check.states }));
            let faults = FAULTS.iter().map(
                |fault| json!({ "name": fault.name, "summary": fault.summary, "caught_by": fault.caught_by }),
            );
            output.json(&json!({ "level": LEVEL, "power": POWER, "checks": checks.collect::<Vec<_>>(), "faults": faults.collect::<Vec<_>>() }))?;
        } else {
            let mut checks = table(&["check", "states that"]);
            for check in CHECKS {
                checks.add_row([check.name, check.states]);
            }
            let mut faults = table(&["fault", "what is wrong", "found by"]);
            for fault in FAULTS {
                faults.add_row([fault.name, fault.summary, fault.caught_by]);
            }
            writeln!(output, "{checks}\n\n{faults}")?;
        }
        output.finish()
    }

    fn examination(&self, seeds: usize, planted: Option<&Fault>, notes: Notes) -> Result<(), Stop> {
        let examination = examine(self.seed, seeds, planted);
        let mut output = Output::open(None)?;
        if self.json {
            output.json(&report(&examination, planted))?;
        } else {
            let heading = ["check", "alarms", "least p", "finds", "the worst of it"];
            let mut rows = table(&heading);
            for (number, check) in CHECKS.iter().enumerate() {
                let alarms = examination.alarms_of(number);
                let worst = examination
                    .findings
                    .iter()
                    .map(|findings| &findings[number])
                    .min_by(|a, b| a.p_value.total_cmp(&b.p_value));
                let Some(worst) = worst else { continue };
                let finds = 100.0 * examination.detectable(number);
                rows.add_row([
                    Cell::new(check.name),
                    right(format!("{alarms} of {seeds}")),
                    right(significant(worst.p_value, 2)),
                    right(format!("{} %", significant(finds, 2))),
                    Cell::new(&worst.detail),
                ]);
            }
            writeln!(output, "{rows}")?;
        }
        output.finish()?;
        let alarms = examination.alarms();
        let ill = examination.is_ill();
        match planted {
            Some(fault) => {
                let who = caught_by(&examination);
                if who.is_empty() {
                    notes.say(&format!("{}: not caught by any check", fault.name));
                } else {
                    notes.say(&format!(
                        "{}: {}; caught by {}",
                        fault.name,
                        fault.summary,
                        who.join(", ")
                    ));
                }
            }
            None => notes.say(&format!(
                "{} checks, {alarms} of {seeds} seeds with an alarm; at most {} % are expected of a healthy laboratory, each check being held at p = {}: {}",
                CHECKS.len(),
                100.0 * LEVEL,
                significant(check_level(), 2),
                if ill { "not well" } else { "well" }
            )),
        }
        let failed = if planted.is_some() { alarms > 0 } else { ill };
        if failed { Err(Stop::Failed) } else { Ok(()) }
    }

    fn every_fault(&self, seeds: usize, notes: Notes) -> Result<(), Stop> {
        let mut rows = table(&["fault", "what is wrong", "found by", "power"]);
        let mut list = Vec::new();
        let mut missed = Vec::new();
        for fault in FAULTS {
            let examination = examine(self.seed, seeds, Some(fault));
            // of those that find it equally often, the one that is there for it
            let there_for_it = |check: usize| CHECKS[check].name == fault.caught_by;
            let best = (0..CHECKS.len())
                .max_by_key(|&check| (examination.alarms_of(check), there_for_it(check)));
            let Some(best) = best else { continue };
            let power = examination.alarms_of(best) as f64 / seeds as f64;
            if power < 0.5 {
                missed.push(fault.name);
            }
            rows.add_row([
                Cell::new(fault.name),
                Cell::new(fault.summary),
                Cell::new(if power > 0.0 {
                    CHECKS[best].name
                } else {
                    "nobody"
                }),
                right(format!("{} %", significant(100.0 * power, 3))),
            ]);
            list.push(report(&examination, Some(fault)));
        }
        let mut output = Output::open(None)?;
        if self.json {
            output.json(&list)?;
        } else {
            writeln!(output, "{rows}")?;
        }
        output.finish()?;
        if missed.is_empty() {
            notes.say(&format!("all {} faults are caught", FAULTS.len()));
            return Ok(());
        }
        notes.say(&format!(
            "missed in half of the seeds or more: {}",
            missed.join(", ")
        ));
        Err(Stop::Failed)
    }

    fn reliability(&self, seeds: usize) -> Result<(), Stop> {
        let svg = |path: &PathBuf| {
            path.extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("svg"))
        };
        if !self.output.as_ref().is_some_and(svg) {
            return Err(Stop::Input(
                "--output: allowed is the name of an .svg file; the table goes to stdout"
                    .to_owned(),
            ));
        }
        let mut picture = Output::open(self.output.as_deref())?;
        let grades = calibrate(self.seed, seeds);
        write!(picture, "{}", diagram(&grades, seeds))?;
        picture.finish()?;
        let mut output = Output::open(None)?;
        if self.json {
            let list = grades.iter().map(|grade| {
                json!({ "promise": grade.name, "claimed": grade.meaning != Meaning::NotClaimed, "nominal": LEVELS, "actual": grade.actual, "p_value": grade.p_value, "kept": grade.is_kept() })
            });
            output.json(&list.collect::<Vec<_>>())?;
        } else {
            let mut heading = vec!["what is stated".to_owned()];
            heading.extend(
                LEVELS
                    .iter()
                    .map(|level| format!("{} %", significant(100.0 * level, 3))),
            );
            heading.push("kept".to_owned());
            let mut rows = table(&heading.iter().map(String::as_str).collect::<Vec<_>>());
            for grade in &grades {
                let mut row = vec![Cell::new(grade.name)];
                row.extend(
                    grade
                        .actual
                        .iter()
                        .map(|a| right(format!("{:.1}", 100.0 * a))),
                );
                row.push(Cell::new(match (grade.meaning, grade.is_kept()) {
                    (Meaning::NotClaimed, _) => "not claimed",
                    (_, true) => "yes",
                    (_, false) => "no",
                }));
                rows.add_row(row);
            }
            writeln!(output, "{rows}")?;
        }
        output.finish()?;
        if grades.iter().all(Grade::is_kept) {
            Ok(())
        } else {
            Err(Stop::Failed)
        }
    }
}

/// The fault of that name, or what there is.
fn known(name: &str) -> Result<&'static Fault, Stop> {
    fault(name).ok_or_else(|| {
        let names = || FAULTS.iter().map(|fault| fault.name);
        let guess = nearest(name, names())
            .map_or_else(String::new, |guess| format!("; did you mean \"{guess}\"?"));
        Stop::Input(format!(
            "--plant: no fault \"{}\"{guess}\nallowed are all, {}",
            name.escape_debug(),
            names().collect::<Vec<_>>().join(", ")
        ))
    })
}

/// The checks that raised an alarm, with how often.
fn caught_by(examination: &Examination) -> Vec<String> {
    let seeds = examination.seeds.len();
    CHECKS
        .iter()
        .enumerate()
        .map(|(number, check)| (check.name, examination.alarms_of(number)))
        .filter(|(_, alarms)| *alarms > 0)
        .map(|(name, alarms)| format!("{name} ({alarms} of {seeds})"))
        .collect()
}

/// Everything about an examination.
fn report(examination: &Examination, planted: Option<&Fault>) -> Value {
    let seeds = examination.seeds.len();
    let checks: Vec<Value> = CHECKS
        .iter()
        .enumerate()
        .map(|(number, check)| {
            let findings = examination
                .findings
                .iter()
                .map(|findings| &findings[number]);
            json!({
                "check": check.name,
                "alarms": examination.alarms_of(number),
                "power": examination.alarms_of(number) as f64 / seeds as f64,
                "detectable": examination.detectable(number),
                "p_values": findings.map(|finding| finding.p_value).collect::<Vec<_>>(),
            })
        })
        .collect();
    json!({
        "planted": planted.map(|fault| fault.name),
        "first_seed": examination.seeds.first(),
        "seeds": seeds,
        "seeds_with_alarm": examination.alarms(),
        "level": LEVEL,
        "power_of_detectable": POWER,
        "checks": checks,
    })
}

/// Actual over nominal probability, one panel a statement, with a band about the diagonal.
fn diagram(grades: &[Grade], seeds: usize) -> impl std::fmt::Display {
    let nominal: Vec<f64> = LEVELS.iter().map(|level| 100.0 * level).collect();
    let edge = |sign: f64| {
        let edge = LEVELS
            .iter()
            .map(|level| 100.0 * (level + sign * band(*level, seeds)));
        edge.map(|edge| edge.clamp(0.0, 100.0)).collect()
    };
    let panels = grades.iter().map(|grade| Small {
        title: grade.name.to_owned(),
        series: vec![
            Series {
                name: format!("as stated, with what {seeds} seeds leave open"),
                x: nominal.clone(),
                y: nominal.clone(),
                role: Role::Band {
                    colour: 1,
                    low: edge(-1.0),
                    high: edge(1.0),
                },
            },
            Series {
                name: "as it came true".to_owned(),
                x: nominal.clone(),
                y: grade.actual.iter().map(|actual| 100.0 * actual).collect(),
                role: Role::Estimate(0),
            },
        ],
    });
    Multiples {
        title: "How often what is stated with a probability came true".to_owned(),
        description: "Actual over nominal probability of every statement of the laboratory that has one, with a band about the diagonal".to_owned(),
        x: Axis::new("nominal probability", "%").over(0.0, 100.0),
        y: Axis::new("actual", "%").over(0.0, 100.0),
        columns: 3,
        shared: true,
        panels: panels.collect(),
    }
    .draw()
}

fn table(heading: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(heading.iter().map(Cell::new));
    table
}

fn right(text: String) -> Cell {
    Cell::new(text).set_alignment(CellAlignment::Right)
}
