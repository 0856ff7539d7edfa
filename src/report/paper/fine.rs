//! The estimates of each group's first sample, finely enough for print.

use crate::estimator::FitError;
use crate::experiment::results::{Group, Results};
use crate::experiment::run::{Bench, RunError};
use crate::report::figure::{Role, Series};
use crate::space::{Evaluation, Field, Grid, Targets};

/// How many cells a printed curve has: four to a pixel of the widest figure, so that a jump looks like one.
const CELLS: usize = 2880;

/// The estimates of one group's first sample.
pub struct First {
    /// Where they were evaluated.
    pub grid: Grid<1>,
    /// The truth, where it is known.
    pub truth: Option<Vec<f64>>,
    /// One curve an estimator.
    pub estimates: Vec<Vec<f64>>,
    /// The same on the grid that errors were measured on.
    pub coarse: Vec<Vec<f64>>,
    /// Whether each estimator's curves are step functions.
    pub stepped: Vec<bool>,
    /// The data.
    pub data: Vec<f64>,
}

/// The estimates of the first sample of every group.
pub struct Fine {
    /// One entry a group.
    pub groups: Vec<First>,
}

fn evaluate(bench: &Bench, group: &Group, grid: &Grid<1>) -> Result<Vec<Vec<f64>>, RunError> {
    let sample = bench.sample(group.source, group.size, 0)?;
    let setting = bench.setting(group.source, group.size);
    let estimators = setting.estimators.iter().zip(&group.outcomes);
    estimators
        .map(|(estimator, outcome)| {
            let refused = |error| {
                RunError::Input(format!(
                    "estimator \"{}\" on the first sample: {error}",
                    outcome.name
                ))
            };
            let estimate = estimator.fit(&sample).map_err(refused)?;
            let Evaluation {
                values, failure, ..
            } = estimate.evaluate(Targets::Grid(grid));
            match failure {
                // it did not when the cells were computed
                Some(why) => Err(refused(FitError::Engine(why))),
                None => Ok(values),
            }
        })
        .collect()
}

impl Fine {
    /// Draws every group's first sample again and estimates from it.
    ///
    /// # Errors
    /// If that fails; it did not when the cells were computed.
    pub fn of(bench: &Bench, results: &Results) -> Result<Self, RunError> {
        let groups = results.groups.iter().map(|group| {
            let (low, high) = (group.grid.low(), group.grid.high());
            let grid = Grid::new(low, high, [CELLS]).unwrap_or(group.grid);
            let setting = bench.setting(group.source, group.size);
            Ok(First {
                grid,
                truth: bench
                    .field(group.source)
                    .map(|density| density.on(&grid).into_values()),
                estimates: evaluate(bench, group, &grid)?,
                coarse: evaluate(bench, group, &group.grid)?,
                stepped: setting
                    .estimators
                    .iter()
                    .map(|estimator| !estimator.laws().continuous)
                    .collect(),
                data: bench
                    .sample(group.source, group.size, 0)?
                    .coordinates()
                    .to_vec(),
            })
        });
        Ok(Self {
            groups: groups.collect::<Result<_, RunError>>()?,
        })
    }
}

impl First {
    /// The places of the curves.
    pub fn x(&self) -> Vec<f64> {
        self.grid.centres().map(|[x]| x).collect()
    }

    /// The truth as a series.
    pub fn truth_series(&self) -> Option<Series> {
        let y = self.truth.clone()?;
        Some(Series {
            name: "truth".to_owned(),
            x: self.x(),
            y,
            role: Role::Truth,
        })
    }

    /// The estimate of estimator `number` as a series in colour `colour`: steps where it has steps.
    pub fn series(&self, number: usize, name: &str, colour: usize) -> Series {
        let y = &self.estimates[number];
        if !self.stepped[number] {
            return Series {
                name: name.to_owned(),
                x: self.x(),
                y: y.clone(),
                role: Role::Estimate(colour),
            };
        }
        let half = 0.5 * self.grid.width(0);
        let mut edges = vec![self.grid.low()[0]];
        let mut heights: Vec<f64> = Vec::new();
        for (i, &value) in y.iter().enumerate() {
            let same = heights
                .last()
                .is_some_and(|&last| (last - value).abs() <= 1e-12 * last.abs().max(value.abs()));
            if !same {
                if i > 0 {
                    edges.push(self.grid.coordinate(0, i) - half);
                }
                heights.push(value);
            }
        }
        edges.push(self.grid.high()[0]);
        Series {
            name: name.to_owned(),
            x: edges,
            y: heights,
            role: Role::Steps(colour),
        }
    }
}
