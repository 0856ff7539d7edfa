//! An experiment set up: sources opened, estimators built, grids laid.

use super::cell::sampling_stream;
use super::opened::{Opened, Rooms, default_grid, open};
use super::{Cell, RunError, block_length};
use crate::accuracy::Yardstick;
use crate::density::Density;
use crate::estimator::{Context, Estimator};
use crate::experiment::catalogue::{Builds, Entry};
use crate::experiment::{Experiment, FigureKind, SourceSpec, catalogue};
use crate::kernel::{Shape, Symmetry};
use crate::light::reference::Reference;
use crate::random::Stream;
use crate::sample::{Drawn, Sample, Source};
use crate::space::{Field, Grid, Polygon};
use crate::theory::{self, Optimum, Oracle};
use crate::uncertainty::ErrorEstimate;
use std::sync::Arc;

/// What is fixed for one source and one sample size.
pub struct Setting<const D: usize = 1> {
    /// The sample size.
    pub draws: usize,
    /// Where estimates are evaluated.
    pub grid: Grid<D>,
    /// Which cells have their centre in the polygon that bounds the domain, where there is one; nothing else counts, and no other cell does.
    pub mask: Option<Vec<bool>>,
    /// The cells of each region, by name.
    pub regions: Vec<(String, Vec<u32>)>,
    /// The truth at the centres of the grid's cells, where it is known, as errors are measured against it.
    pub yardstick: Option<Yardstick>,
    /// The estimators in the experiment's order.
    pub estimators: Vec<Box<dyn Estimator<D>>>,
    /// The estimates of the error in the experiment's order.
    pub uncertainties: Vec<Box<dyn ErrorEstimate<D>>>,
}

impl<const D: usize> Setting<D> {
    /// The truth at the centres of the grid's cells, where it is known.
    pub fn truth(&self) -> Option<&[f64]> {
        self.yardstick.as_ref().map(Yardstick::truth)
    }

    /// Sets to zero what lies outside the polygon that bounds the domain.
    pub fn restrict(&self, values: &mut [f64]) {
        if let Some(mask) = &self.mask {
            for (value, inside) in values.iter_mut().zip(mask) {
                if !inside {
                    *value = 0.0;
                }
            }
        }
    }
}

/// An experiment ready to run.
pub struct Bench<const D: usize = 1> {
    asked: Experiment,
    experiment: Experiment,
    sources: Vec<Opened<D>>,
    settings: Vec<Vec<Setting<D>>>,
    rooms: Rooms,
}

impl<const D: usize> Bench<D> {
    /// Opens the sources and builds every estimator for every sample size.
    ///
    /// # Errors
    /// If a data file cannot be read or an estimator not be built.
    pub fn new(experiment: Experiment) -> Result<Self, RunError>
    where
        Entry: Builds<D>,
    {
        let mut sources = Vec::new();
        let mut settings = Vec::new();
        let mut rooms = Rooms::default();
        for spec in &experiment.sources {
            let opened = open(spec, &mut rooms)?;
            let sizes = match &opened {
                Opened::Density(_) | Opened::Paths(..) | Opened::Exposed(_) => {
                    experiment.draws.clone()
                }
                Opened::Data(sample) => vec![sample.len()],
            };
            let of_source: Result<Vec<Setting<D>>, RunError> = sizes
                .into_iter()
                .map(|draws| set_up(&experiment, &opened, draws))
                .collect();
            settings.push(of_source?);
            sources.push(opened);
        }
        Ok(Self {
            asked: experiment.clone(),
            experiment,
            sources,
            settings,
            rooms,
        })
    }

    /// The same without some of its estimators, and without what is drawn of them alone; claims stay, to be judged as not shown.
    #[must_use]
    pub fn without(mut self, estimators: &[usize]) -> Self {
        let stays = |position: &usize| !estimators.contains(position);
        let mut position = 0;
        self.experiment.estimators.retain(|_| {
            position += 1;
            stays(&(position - 1))
        });
        for setting in self.settings.iter_mut().flatten() {
            let mut position = 0;
            setting.estimators.retain(|_| {
                position += 1;
                stays(&(position - 1))
            });
        }
        let left = &self.experiment.estimators;
        self.experiment.figures.retain(|figure| match &figure.kind {
            FigureKind::Sweep { of, .. } | FigureKind::Spread { of, .. } => left
                .iter()
                .any(|spec| spec.sweep.as_ref().is_some_and(|sweep| sweep.group == *of)),
            _ => true,
        });
        self
    }

    /// The experiment as it was asked for.
    pub fn asked(&self) -> &Experiment {
        &self.asked
    }

    /// The experiment; without estimators that were left out because they failed.
    pub fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    /// What is fixed for a source and a size, by their positions.
    pub fn setting(&self, source: usize, size: usize) -> &Setting<D> {
        &self.settings[source][size]
    }

    /// The settings of each size of a source.
    pub fn settings(&self, source: usize) -> &[Setting<D>] {
        &self.settings[source]
    }

    /// The density that a source's points follow, where there is one: what theory starts from.
    pub fn truth(&self, source: usize) -> Option<&Arc<dyn Density<D>>> {
        self.sources[source].density()
    }

    /// What estimates from a source should be, where it is known: the density, or the field of a source that has none.
    pub fn field(&self, source: usize) -> Option<&dyn Field<D>> {
        self.sources[source].field()
    }

    /// Whether a source is a fixed data set, with a size of its own.
    pub fn is_fixed(&self, source: usize) -> bool {
        matches!(self.sources[source], Opened::Data(_))
    }

    /// Where a source's points lie in space, if they do: the origin of their coordinates and the directions of both axes.
    pub fn frame(&self, source: usize) -> Option<[[f64; 3]; 3]> {
        match &self.sources[source] {
            Opened::Exposed(source) => source.frame(),
            _ => None,
        }
    }

    /// The scene in which a source's points are where photons arrived, and the truth about it; `None` for other sources.
    pub fn room(&self, source: usize) -> Option<&Arc<Reference>> {
        match &self.experiment.sources[source] {
            SourceSpec::Scene { path, .. } => self.rooms.get(path),
            _ => None,
        }
    }

    /// The random stream of sample number `replicate`.
    pub fn stream(&self, replicate: usize) -> Stream {
        sampling_stream(self.experiment.seed, replicate)
    }

    /// The density of a source whose points are independent of each other: what exact theory is about.
    pub fn independent(&self, source: usize) -> Option<&Arc<dyn Density<D>>> {
        match &self.sources[source] {
            Opened::Paths(..) => None,
            _ => self.truth(source),
        }
    }

    /// The polygon that bounds the domain of a source, where there is one: its corners, else nothing.
    pub fn outline(&self, source: usize) -> &[[f64; 2]] {
        let outline = self.sources[source].domain().outline();
        outline.map_or(&[], Polygon::vertices)
    }

    /// What theory says of kernel estimates from a source with samples of `draws` points, where it says anything.
    pub fn oracle(
        &self,
        source: usize,
        (shape, symmetry): (Shape, Symmetry),
        draws: usize,
    ) -> Option<Oracle> {
        theory::kernel_oracle(&**self.independent(source)?, shape, symmetry, draws as f64)
    }

    /// The best of all estimators that differ from number `estimator` in their bandwidth or width alone, by theory.
    pub fn best_of_family(&self, source: usize, size: usize, estimator: usize) -> Option<Optimum> {
        let setting = self.setting(source, size);
        let family = setting.estimators[estimator].family()?;
        family.is_of_estimates().then_some(())?;
        family.optimum_of(&**self.independent(source)?, setting.draws as f64)
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
    ) -> Result<Sample<D>, RunError> {
        match &self.sources[source] {
            Opened::Data(sample) => Ok(sample.clone()),
            Opened::Paths(_, paths) => self.drawn(&**paths, (source, size), replicate),
            Opened::Exposed(exposed) => self.drawn(&**exposed, (source, size), replicate),
            Opened::Density(density) => {
                let draws = self.settings[source][size].draws;
                let name = self.experiment.sources[source].name();
                let mut random = sampling_stream(self.experiment.seed, replicate);
                Drawn(density.clone())
                    .sample(draws, &mut random)
                    .map_err(|error| RunError::Input(format!("a sample from \"{name}\": {error}")))
            }
        }
    }

    fn drawn<S: Source<D> + ?Sized>(
        &self,
        from: &S,
        (source, size): (usize, usize),
        replicate: usize,
    ) -> Result<Sample<D>, RunError> {
        let draws = self.settings[source][size].draws;
        let mut random = sampling_stream(self.experiment.seed, replicate);
        from.sample(draws, &mut random).map_err(|error| {
            let name = self.experiment.sources[source].name();
            RunError::Input(format!("a sample from \"{name}\": {error}"))
        })
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

fn set_up<const D: usize>(
    experiment: &Experiment,
    source: &Opened<D>,
    draws: usize,
) -> Result<Setting<D>, RunError>
where
    Entry: Builds<D>,
{
    let grid = match &experiment.grid {
        Some(spec) => spec.grid(),
        None => default_grid(source),
    }
    .map_err(|error| RunError::Input(error.to_string()))?;
    let truth = source.field().map(|truth| truth.on(&grid).into_values());
    let context = Context {
        truth: source.density().cloned(),
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
    let mask = source.domain().mask(&grid);
    let regions: Vec<(String, Vec<u32>)> = experiment
        .regions
        .iter()
        .map(|region| (region.name.clone(), region.cells(&grid, mask.as_deref())))
        .collect();
    if let Some((name, _)) = regions.iter().find(|(_, cells)| cells.is_empty()) {
        return Err(RunError::Input(format!(
            "no cell of the grid has its centre in the region \"{name}\""
        )));
    }
    Ok(Setting {
        draws,
        mask,
        regions,
        grid,
        yardstick: truth.map(Yardstick::new),
        estimators: estimators?,
        uncertainties: experiment
            .uncertainties
            .iter()
            .map(|spec| Entry::error_estimate(&spec.kind))
            .collect(),
    })
}
