//! An experiment set up: sources opened, estimators built, grids laid.

use super::cell::sampling_stream;
use super::{Cell, RunError, block_length};
use crate::density::{Density, Univariate};
use crate::estimator::{Context, Estimator};
use crate::experiment::catalogue::Builds;
use crate::experiment::{Experiment, GridSpec, SourceSpec, catalogue};
use crate::sample::{Sample, Summary, file};
use crate::space::{Domain, Grid, Side};
use std::sync::Arc;

/// What is fixed for one source and one sample size.
pub struct Setting {
    /// The sample size.
    pub draws: usize,
    /// Where estimates are evaluated.
    pub grid: Grid<1>,
    /// The truth at the centres of the grid's cells, where it is known.
    pub truth: Option<Vec<f64>>,
    /// The estimators in the experiment's order.
    pub estimators: Vec<Box<dyn Estimator<1>>>,
}

enum Opened {
    Density(Arc<dyn Univariate>),
    Data(Sample<1>),
}

/// An experiment ready to run.
pub struct Bench {
    experiment: Experiment,
    sources: Vec<Opened>,
    settings: Vec<Vec<Setting>>,
}

impl Bench {
    /// Opens the sources and builds every estimator for every sample size.
    ///
    /// # Errors
    /// If a data file cannot be read or an estimator not be built.
    pub fn new(experiment: Experiment) -> Result<Self, RunError> {
        let mut sources = Vec::new();
        let mut settings = Vec::new();
        for spec in &experiment.sources {
            let opened = open(spec)?;
            let sizes = match &opened {
                Opened::Density(_) => experiment.draws.clone(),
                Opened::Data(sample) => vec![sample.len()],
            };
            let of_source: Result<Vec<Setting>, RunError> = sizes
                .into_iter()
                .map(|draws| set_up(&experiment, &opened, draws))
                .collect();
            settings.push(of_source?);
            sources.push(opened);
        }
        Ok(Self {
            experiment,
            sources,
            settings,
        })
    }

    /// The experiment.
    pub fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    /// What is fixed for a source and a size, by their positions.
    pub fn setting(&self, source: usize, size: usize) -> &Setting {
        &self.settings[source][size]
    }

    /// The settings of each size of a source.
    pub fn settings(&self, source: usize) -> &[Setting] {
        &self.settings[source]
    }

    /// The density of a source, where it is known.
    pub fn truth(&self, source: usize) -> Option<&Arc<dyn Univariate>> {
        match &self.sources[source] {
            Opened::Density(density) => Some(density),
            Opened::Data(_) => None,
        }
    }

    /// Sample number `replicate` of a size from a source; the same for every estimator.
    ///
    /// # Errors
    /// If what was drawn is not a sample.
    pub fn sample(
        &self,
        source: usize,
        size: usize,
        replicate: usize,
    ) -> Result<Sample<1>, RunError> {
        match &self.sources[source] {
            Opened::Data(sample) => Ok(sample.clone()),
            Opened::Density(density) => {
                let draws = self.settings[source][size].draws;
                let name = self.experiment.sources[source].name();
                let mut random = sampling_stream(self.experiment.seed, replicate);
                let points = (0..draws).map(|_| density.draw(&mut random)).collect();
                Sample::equal(points, density.domain().clone())
                    .map_err(|error| RunError::Input(format!("a sample from \"{name}\": {error}")))
            }
        }
    }

    /// Every cell, in order.
    pub fn cells(&self) -> Vec<Cell> {
        let blocks = self
            .experiment
            .replicates
            .div_ceil(block_length(&self.experiment));
        let mut cells = Vec::new();
        for (source, sizes) in self.settings.iter().enumerate() {
            for size in 0..sizes.len() {
                for estimator in 0..self.experiment.estimators.len() {
                    cells.extend((0..blocks).map(|block| Cell {
                        source,
                        size,
                        estimator,
                        block,
                    }));
                }
            }
        }
        cells
    }

    /// The work in a cell, in points and targets touched; only good for progress.
    pub(super) fn units(&self, cell: &Cell) -> u64 {
        let setting = self.setting(cell.source, cell.size);
        (super::cell::replicates(self, cell.block).len() * (setting.draws + setting.grid.len()))
            as u64
    }
}

fn open(spec: &SourceSpec) -> Result<Opened, RunError> {
    match spec {
        SourceSpec::Density { kind, values, .. } => {
            let built = catalogue::density(kind, values)
                .map_err(|error| RunError::Input(error.to_string()))?;
            let line = built.line().ok_or_else(|| {
                RunError::Input(format!("the density {kind} is one of the plane"))
            })?;
            Ok(Opened::Density(line))
        }
        SourceSpec::File {
            path,
            column,
            weight,
            domain,
            ..
        } => {
            let [low, high] = domain.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            let side = |bound: f64| {
                if bound.is_finite() {
                    Side::Wall
                } else {
                    Side::Open
                }
            };
            let domain = Domain::new([low], [high], [[side(low), side(high)]])
                .map_err(|error| RunError::Input(error.to_string()))?;
            let request = file::Request {
                columns: [file::Column::Named(column)],
                weight: weight.as_deref(),
                domain,
            };
            file::read(path, &request)
                .map(Opened::Data)
                .map_err(|error| RunError::Input(error.to_string()))
        }
    }
}

fn set_up(experiment: &Experiment, source: &Opened, draws: usize) -> Result<Setting, RunError> {
    let grid = match experiment.grid {
        Some(GridSpec { low, high, cells }) => Grid::new([low], [high], [cells]),
        None => default_grid(source),
    }
    .map_err(|error| RunError::Input(error.to_string()))?;
    let density = match source {
        Opened::Density(density) => Some(density.clone()),
        Opened::Data(_) => None,
    };
    let truth = density
        .as_ref()
        .map(|density| density.on(&grid).into_values());
    let context = Context {
        truth: density.map(|density| density as Arc<dyn Density<1>>),
        draws,
    };
    let estimators: Result<_, _> = experiment
        .estimators
        .iter()
        .map(|spec| {
            let entry = catalogue::estimator(&spec.kind)
                .ok_or_else(|| RunError::Input(format!("no estimator is called {}", spec.kind)))?;
            entry
                .build(&spec.values, &context)
                .map_err(|error| RunError::Input(format!("estimator \"{}\": {error}", spec.name)))
        })
        .collect();
    Ok(Setting {
        draws,
        grid,
        truth,
        estimators: estimators?,
    })
}

/// Cells over all but 10⁻⁴ of the mass at each end, widened by a fifth of that on both sides so that what an estimator lays beyond shows.
fn default_grid(source: &Opened) -> Result<Grid<1>, crate::space::GridError> {
    let (low, high) = match source {
        Opened::Density(density) => {
            let ([low], [high]) = density.bulk(1e-4);
            (low, high)
        }
        Opened::Data(sample) => {
            let summary = Summary::of(sample);
            // data all at one place still deserve a picture
            let spread = if summary.most > summary.least {
                0.0
            } else {
                0.5 * summary.least.abs().max(1.0)
            };
            (summary.least - spread, summary.most + spread)
        }
    };
    let margin = 0.2 * (high - low);
    Grid::new([low - margin], [high + margin], [GridSpec::CELLS])
}
