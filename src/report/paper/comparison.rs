//! The comparison of estimators as a table of the page, and how their cost grows.

use super::Material;
use super::pictures::{chosen, shows};
use crate::experiment::judge::short;
use crate::experiment::results::{Group, Outcome};
use crate::experiment::run::RunError;
use crate::experiment::table::{self, digits};
use crate::experiment::{Figure, FigureKind, Measure, catalogue};
use crate::random;
use crate::report::page::{Cell, Table};
use crate::sample::Sample;
use crate::space::{Field, Grid, Targets};
use rustix::time::{ClockId, clock_gettime};

/// Sample sizes at which cost is measured.
const SIZES: [usize; 4] = [2_000, 8_000, 32_000, 128_000];

/// Each time is the least of so many.
const ROUNDS: usize = 5;

/// Targets at which each estimate is evaluated.
const TARGETS: usize = 512;

/// A jump below this share of the range of an estimate is rounding.
const CONTINUOUS: f64 = 1e-6;

/// The tables of the page, and the times behind one of their columns.
#[derive(Default)]
pub(super) struct Comparison {
    pub(super) tables: Vec<Table>,
    pub(super) timings: Vec<Vec<String>>,
}

impl Comparison {
    /// Times are not the same twice, so they have a file of their own, beside the tables that are.
    pub(super) fn timings(&self) -> table::Table {
        table::Table {
            file: "timings.csv",
            columns: vec!["source", "estimator", "n", "targets", "cpu_seconds"],
            rows: self.timings.clone(),
        }
    }

    /// What the figures ask for; times are taken here, one estimator after the other.
    ///
    /// # Errors
    /// If a sample cannot be drawn.
    pub(super) fn of<const D: usize>(material: &Material<'_, D>) -> Result<Self, RunError> {
        let mut comparison = Self::default();
        for figure in &material.bench.experiment().figures {
            let FigureKind::ComparisonTable {} = figure.kind else {
                continue;
            };
            for group in &material.results.groups {
                if shows(figure, group, material) {
                    comparison.add(material, figure, group)?;
                }
            }
        }
        Ok(comparison)
    }

    fn add<const D: usize>(
        &mut self,
        material: &Material<'_, D>,
        figure: &Figure,
        group: &Group<D>,
    ) -> Result<(), RunError> {
        let (mut rows, mut costs) = (Vec::new(), Vec::new());
        for (number, outcome) in chosen(figure, group) {
            let times = times(material, group, number)?;
            for (n, seconds) in SIZES.iter().zip(&times) {
                self.timings.push(vec![
                    group.name.clone(),
                    outcome.name.clone(),
                    n.to_string(),
                    TARGETS.to_string(),
                    digits(*seconds),
                ]);
            }
            rows.push(row(material, number, outcome));
            let spec = &material.bench.experiment().estimators[number];
            costs.push(vec![
                Cell::text(&outcome.name),
                Cell::text(catalogue::estimator(&spec.kind).map_or("", |entry| entry.cost)),
                slope(&times).map_or(Cell::Empty, |slope| Cell::text(format!("{slope:.1}"))),
            ]);
        }
        let words = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect();
        let gap = if figure.caption.is_empty() { "" } else { " " };
        self.tables.push(Table {
            title: format!("{}: {}, n = {}", figure.title, group.name, group.draws),
            caption: format!(
                "{}{gap}Mass: ∫f̂ over three times the range, for points between walls at the ends of the grid, spread evenly or crowded beside a wall: what is farther from 1. At a wall: \
                 the estimate of the even points beside it, over the density there. Jump: the largest of the estimate of the first sample, over its range of values. Error: the MISE over \
                 that of a Gaussian kernel, reflected at walls, with the best width for each place.",
                figure.caption,
            ),
            columns: words(&[
                "estimator",
                "mass",
                "at a wall",
                "jump",
                "continuous",
                "negative",
                "error",
            ]),
            rows,
        });
        self.tables.push(Table {
            title: format!("Cost: {}", group.name),
            caption: format!(
                "In n data and m targets as the estimator states it, and the slope of processor time against n from {} to {} with {TARGETS} targets on this machine. What is done \
                 once for all targets hides the growth, and the slope moves by some 0.1 from run to run.",
                SIZES[0],
                SIZES[SIZES.len() - 1]
            ),
            columns: words(&["estimator", "cost as stated", "exponent of n"]),
            rows: costs,
        });
        Ok(())
    }
}

fn row<const D: usize>(material: &Material<'_, D>, number: usize, outcome: &Outcome) -> Vec<Cell> {
    // one yardstick for all
    let error = outcome.measures.get(&Measure::OverLocalKernel);
    let error = error.map_or(Cell::Empty, |over| match over.standard_error {
        Some(error) => Cell::measured(over.value, error),
        None => Cell::exact(over.value),
    });
    let laws = material.bench.setting(0, 0).estimators[number].laws();
    let value = |measure: Measure| outcome.measures.get(&measure).map(|m| m.value);
    let plain = |measure: Measure| value(measure).map_or(Cell::Empty, |v| Cell::text(rounded(v)));
    let word = |holds: bool| Cell::text(if holds { "yes" } else { "no" });
    vec![
        Cell::text(&outcome.name),
        plain(Measure::Mass),
        plain(Measure::Wall),
        plain(Measure::Jump),
        value(Measure::Jump).map_or(Cell::Empty, |jump| word(jump < CONTINUOUS)),
        word(!laws.non_negative),
        error,
    ]
}

/// Three decimals, and what is rounding is 0.
fn rounded(value: f64) -> String {
    if value.abs() < CONTINUOUS {
        "0".to_owned()
    } else if value.abs() < 1e-3 {
        short(value)
    } else {
        format!("{value:.3}")
    }
}

/// Seconds of processor time, over all threads, so that waiting for a busy machine does not count.
fn clock() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Seconds to fit and to evaluate at each size; nothing where it refuses.
fn times<const D: usize>(
    material: &Material<'_, D>,
    group: &Group<D>,
    number: usize,
) -> Result<Vec<Option<f64>>, RunError> {
    let Some(truth) = material.bench.truth(group.source) else {
        return Ok(Vec::new());
    };
    let estimator = &material.bench.setting(group.source, group.size).estimators[number];
    let refused = |error: &dyn std::fmt::Display| RunError::Input(error.to_string());
    let grid = Grid::new(group.grid.low(), group.grid.high(), {
        let side = (TARGETS as f64).powf(1.0 / D as f64).round() as usize;
        [side; D]
    })
    .map_err(|error| refused(&error))?;
    SIZES
        .iter()
        .map(|&n| {
            let mut random = random::stream(1, "timing", n as u64);
            let points = (0..n).map(|_| truth.draw(&mut random)).collect();
            let sample =
                Sample::equal(points, truth.domain().clone()).map_err(|error| refused(&error))?;
            let mut least: Option<f64> = None;
            for _ in 0..ROUNDS {
                let start = clock();
                let Ok(estimate) = estimator.fit(&sample) else {
                    return Ok(None);
                };
                let evaluation = estimate.evaluate(Targets::Grid(&grid));
                let seconds = clock() - start;
                std::hint::black_box(evaluation.values.len());
                least = Some(least.map_or(seconds, |least| least.min(seconds)));
                // what takes long is not short by chance
                if seconds > 0.5 {
                    break;
                }
            }
            Ok(least)
        })
        .collect()
}

/// The slope of log time against log n, by least squares.
fn slope(times: &[Option<f64>]) -> Option<f64> {
    let points: Vec<(f64, f64)> = SIZES
        .iter()
        .zip(times)
        .filter_map(|(&n, seconds)| Some(((n as f64).ln(), (*seconds)?.ln())))
        .collect();
    let count = points.len() as f64;
    let mean = |pick: fn(&(f64, f64)) -> f64| points.iter().map(pick).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let (above, below) = points.iter().fold((0.0, 0.0), |(above, below), p| {
        (above + (p.0 - x) * (p.1 - y), below + (p.0 - x).powi(2))
    });
    (points.len() > 2).then(|| above / below)
}
