//! What a finished run found out: the records of its cells, gathered into measures with intervals and set beside exact values.

use super::catalogue::{Builds, Entry};
use super::character::character;
use super::judge::short;
use super::ladder::{self, Ladder};
use super::run::{Bench, Cell, Failure, Finished, Record, Replicate};
use super::uncertainty::Said;
use super::{Experiment, FigureKind, Measure, Statement};
use crate::accuracy::{Coverage, Interval, Tally, coverage_with_bias, mean_interval};
use crate::numeric::Sum;
use crate::space::{Grid, Point, Warning};
use crate::theory::Moments;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The confidence of the intervals in tables and figures; claims name their own.
pub const CONFIDENCE: f64 = 0.95;

/// Everything that tables, figures and claims are made from.
pub struct Results<const D: usize = 1> {
    /// One entry for each source and sample size, in order.
    pub groups: Vec<Group<D>>,
    /// What the reader should know, and on how many samples it came up.
    pub warnings: BTreeMap<Warning, usize>,
    /// The estimators that failed and are in no group.
    pub failures: Vec<Failure>,
}

/// The results for one source and sample size.
pub struct Group<const D: usize = 1> {
    /// The source, as a position in the experiment.
    pub source: usize,
    /// The sample size, as a position among the source's sizes.
    pub size: usize,
    /// What the source is called.
    pub name: String,
    /// The sample size.
    pub draws: usize,
    /// Where everything was evaluated.
    pub grid: Grid<D>,
    /// Which cells lie in the polygon that bounds the domain, where there is one.
    pub mask: Option<Vec<bool>>,
    /// The cells of each region, by name.
    pub regions: Vec<(String, Vec<u32>)>,
    /// The truth there, where it is known.
    pub truth: Option<Vec<f64>>,
    /// One entry for each estimator, in the experiment's order.
    pub outcomes: Vec<Outcome>,
}

/// The results of one estimator in one group.
pub struct Outcome {
    /// The estimator's name.
    pub name: String,
    /// One entry a replicate.
    pub replicates: Vec<Replicate>,
    /// Pointwise moments of f̂ - f (of f̂ where the truth is not known) over all replicates.
    pub tally: Tally,
    /// The same by blocks, for standard errors by leaving one out.
    pub blocks: Vec<Tally>,
    /// Simulated measures with [`CONFIDENCE`] intervals, exact ones without.
    pub measures: BTreeMap<Measure, Interval>,
    /// The exact mean of the estimate at each target, where theory gives it.
    pub expected: Option<Vec<f64>>,
    /// What the error is to be compared with.
    pub ladder: Ladder,
    /// The exact standard deviation of the estimate at each target, where theory gives it.
    pub spread: Option<Vec<f64>>,
    /// How often intervals about the estimate held what they are about, where the experiment counts that.
    pub coverage: Option<Coverage>,
    /// The engine that computed it, where there was a choice.
    pub engine: Option<String>,
    /// What each estimate of the error said, block by block.
    pub said: Vec<Vec<Said>>,
}

impl<const D: usize> Group<D> {
    /// The outcome of the estimator of that name.
    pub fn outcome(&self, name: &str) -> Option<&Outcome> {
        self.outcomes.iter().find(|outcome| outcome.name == name)
    }

    /// The outcomes of the estimators of these names; all where none is named.
    pub fn outcomes_of(&self, names: &[String]) -> Vec<&Outcome> {
        let wanted = |outcome: &&Outcome| names.is_empty() || names.contains(&outcome.name);
        self.outcomes.iter().filter(wanted).collect()
    }

    /// The centre of a cell in words.
    pub fn place(&self, cell: usize) -> String {
        // a millionth of a cell is rounding
        let unit = 1e-6 * self.grid.width(0);
        let centre = self.grid.centre(cell);
        let words = centre.map(|x| short((x / unit).round() * unit + 0.0));
        words.join(", ")
    }

    /// The integral of the truth over the grid; 1 where the truth is not known.
    pub fn truth_integral(&self) -> f64 {
        self.truth.as_ref().map_or(1.0, |truth| {
            truth.iter().copied().collect::<Sum>().value() * self.grid.cell_measure()
        })
    }
}

impl<const D: usize> Group<D> {
    /// The results over one of the regions alone: truth and errors are nothing elsewhere. Names of regions have been checked.
    pub fn within(&self, region: &str) -> Option<Self> {
        let number = self.regions.iter().position(|(name, _)| name == region)?;
        let mut inside = vec![false; self.grid.len()];
        for &cell in &self.regions[number].1 {
            inside[cell as usize] = true;
        }
        let keep = |values: &Vec<f64>| -> Vec<f64> {
            let kept = values.iter().zip(&inside);
            kept.map(|(&v, &inside)| if inside { v } else { 0.0 })
                .collect()
        };
        let mut part = Self {
            source: self.source,
            size: self.size,
            name: self.name.clone(),
            draws: self.draws,
            grid: self.grid,
            mask: Some(inside.clone()),
            regions: Vec::new(),
            truth: self.truth.as_ref().map(keep),
            outcomes: Vec::new(),
        };
        for outcome in &self.outcomes {
            let replicates = outcome.replicates.iter().map(|replicate| Replicate {
                errors: replicate.regions[number].errors,
                integral: replicate.regions[number].integral,
                modes: replicate.modes,
                smoothing: replicate.smoothing,
                regions: Vec::new(),
            });
            let mut one = Outcome {
                name: outcome.name.clone(),
                replicates: replicates.collect(),
                tally: outcome.tally.within(&inside),
                blocks: outcome.blocks.iter().map(|b| b.within(&inside)).collect(),
                measures: BTreeMap::new(),
                expected: outcome.expected.as_ref().map(keep),
                spread: outcome.spread.as_ref().map(keep),
                ladder: Ladder::default(),
                coverage: None,
                said: Vec::new(),
                engine: outcome.engine.clone(),
            };
            one.measure(&part);
            part.outcomes.push(one);
        }
        Some(part)
    }
}

impl Outcome {
    /// How often an interval of that half length, in deviations, would hold the truth at target `i` if the estimate were normal with its exact mean and
    /// variance; `None` where they are not known, or the estimate does not vary.
    pub fn normal_coverage<const D: usize>(
        &self,
        group: &Group<D>,
        i: usize,
        reach: f64,
    ) -> Option<f64> {
        let (mean, spread) = (self.expected.as_ref()?[i], self.spread.as_ref()?[i]);
        let bias = (mean - group.truth.as_ref()?[i]) / spread;
        bias.is_finite().then(|| coverage_with_bias(reach, bias))
    }

    /// Fills in the measures, from replicates and from what theory expects.
    fn measure<const D: usize>(&mut self, group: &Group<D>) {
        for measure in Measure::ALL {
            if let Some(interval) = self.interval(measure, CONFIDENCE, group) {
                self.measures.insert(measure, interval);
            }
        }
        let (Some(expected), Some(spread), Some(truth)) =
            (&self.expected, &self.spread, &group.truth)
        else {
            return;
        };
        let cell = group.grid.cell_measure();
        let squares = expected.iter().zip(truth).map(|(e, f)| (e - f).powi(2));
        let bias2 = squares.collect::<Sum>().value() * cell;
        let squares = spread.iter().map(|s| s * s);
        let variance = squares.collect::<Sum>().value() * cell;
        for (measure, value) in [
            (Measure::ExactBias2, bias2),
            (Measure::ExactVariance, variance),
            (Measure::ExactMise, bias2 + variance),
        ] {
            self.measures.insert(measure, Interval::exact(value));
        }
    }

    /// The value of a simulated measure on each replicate; `None` for measures that are not means of such values, or where the truth is
    /// not known.
    pub fn per_replicate(&self, measure: Measure, truth_integral: f64) -> Option<Vec<f64>> {
        let value = |r: &Replicate| match measure {
            Measure::Mise => r.errors.map(|e| e.ise),
            Measure::Miae => r.errors.map(|e| e.iae),
            Measure::Mire => r.errors.map(|e| e.ire),
            Measure::Bias => r.errors.map(|e| e.bias),
            Measure::Energy => Some(r.integral / truth_integral),
            Measure::Modes => Some(r.modes as f64),
            Measure::Smoothing => r.smoothing,
            Measure::OverBest => Some(r.errors?.ise / self.ladder.best?),
            Measure::OverKernel => Some(r.errors?.ise / self.ladder.kernel?),
            Measure::OverLocalKernel => Some(r.errors?.ise / self.ladder.local?),
            _ => None,
        };
        self.replicates.iter().map(value).collect()
    }

    /// An interval for `measure` at `confidence`; an exact value is an interval of no length.
    pub fn interval<const D: usize>(
        &self,
        measure: Measure,
        confidence: f64,
        group: &Group<D>,
    ) -> Option<Interval> {
        if let Some(values) = self.per_replicate(measure, group.truth_integral()) {
            return Some(mean_interval(&values, confidence));
        }
        match measure {
            Measure::Bias2 | Measure::Variance if group.truth.is_some() => {
                let pick = |d: &crate::accuracy::Decomposition| {
                    if measure == Measure::Bias2 {
                        d.bias2
                    } else {
                        d.variance
                    }
                };
                let cell = group.grid.cell_measure();
                let blocks: Vec<&Tally> = self.blocks.iter().collect();
                match Tally::decompose_blocks(&blocks, cell) {
                    Some((whole, error)) => Some(Interval::around(
                        pick(&whole),
                        pick(&error),
                        (blocks.len() - 1) as f64,
                        confidence,
                    )),
                    None => self
                        .tally
                        .decompose(cell)
                        .map(|whole| Interval::exact(pick(&whole))),
                }
            }
            _ => self.measures.get(&measure).copied(),
        }
    }
}

impl<const D: usize> Results<D> {
    /// Gathers the records of a finished run. Exact values are computed here, on the same grid.
    pub fn gather(bench: &Bench<D>, finished: Finished) -> Self
    where
        Entry: Builds<D>,
    {
        let experiment = bench.experiment();
        let mut records: BTreeMap<(usize, usize, usize), Vec<Record>> = BTreeMap::new();
        for (
            Cell {
                source,
                size,
                estimator,
                ..
            },
            record,
        ) in finished.records
        {
            records
                .entry((source, size, estimator))
                .or_default()
                .push(record);
        }
        let compared = compares(experiment);
        let mut groups = Vec::new();
        for (source, spec) in experiment.sources.iter().enumerate() {
            let ladders = ladder::climb(bench, source);
            for (size, setting) in bench.settings(source).iter().enumerate() {
                let mut group = Group {
                    source,
                    size,
                    name: spec.name().to_owned(),
                    draws: setting.draws,
                    grid: setting.grid,
                    mask: setting.mask.clone(),
                    regions: setting.regions.clone(),
                    truth: setting.truth().map(<[f64]>::to_vec),
                    outcomes: Vec::new(),
                };
                let exact: Vec<Option<Vec<Moments>>> = (0..experiment.estimators.len())
                    .into_par_iter()
                    .map(|e| exact(bench, source, size, e))
                    .collect();
                for (e, known) in exact.into_iter().zip(ladders[size].clone()).enumerate() {
                    let blocks = records.remove(&(source, size, e)).unwrap_or_default();
                    let mut outcome = gather_one(experiment, e, blocks, known, &group);
                    if compared {
                        characterise(bench, &group, e, &mut outcome);
                    }
                    group.outcomes.push(outcome);
                }
                groups.push(group);
            }
        }
        Self {
            groups,
            warnings: finished.warnings,
            failures: finished.failures,
        }
    }
}

/// Whether a figure or a claim asks what estimators are like.
fn compares(experiment: &Experiment) -> bool {
    let by_figure = experiment
        .figures
        .iter()
        .any(|figure| matches!(figure.kind, FigureKind::ComparisonTable {}));
    let by_claim = experiment
        .claims
        .iter()
        .any(|claim| match &claim.statement {
            Statement::Below { measure, .. } | Statement::Equals { measure, .. } => {
                measure.is_probe()
            }
            _ => false,
        });
    by_figure || by_claim
}

/// Adds what the probes say.
fn characterise<const D: usize>(
    bench: &Bench<D>,
    group: &Group<D>,
    estimator: usize,
    outcome: &mut Outcome,
) {
    let estimator = &bench.setting(group.source, group.size).estimators[estimator];
    let Ok(first) = bench.sample(group.source, group.size, 0) else {
        return;
    };
    if let Some(found) = character(&**estimator, &group.grid, group.draws, &first) {
        for (measure, value) in [
            (Measure::Mass, found.mass),
            (Measure::Wall, found.wall),
            (Measure::Jump, found.jump),
        ] {
            outcome.measures.insert(measure, Interval::exact(value));
        }
    }
}

/// Exact moments by theory at the targets; nothing outside the polygon that bounds the domain.
fn exact<const D: usize>(
    bench: &Bench<D>,
    source: usize,
    size: usize,
    estimator: usize,
) -> Option<Vec<Moments>> {
    let setting = bench.setting(source, size);
    let density = bench.independent(source)?;
    let places: Vec<Point<D>> = setting.grid.centres().collect();
    let mut moments =
        setting.estimators[estimator].expectation(&**density, setting.draws, &places)?;
    if let Some(mask) = &setting.mask {
        let outside = Moments {
            mean: 0.0,
            variance: 0.0,
        };
        let cells = moments.iter_mut().zip(mask);
        cells
            .filter(|(_, inside)| !**inside)
            .for_each(|(m, _)| *m = outside);
    }
    Some(moments)
}

fn gather_one<const D: usize>(
    experiment: &Experiment,
    estimator: usize,
    records: Vec<Record>,
    (exact, ladder): (Option<Vec<Moments>>, Ladder),
    group: &Group<D>,
) -> Outcome {
    let mut outcome = Outcome {
        name: experiment.estimators[estimator].name.clone(),
        replicates: Vec::new(),
        tally: Tally::default(),
        blocks: Vec::new(),
        measures: BTreeMap::new(),
        expected: None,
        ladder,
        spread: None,
        coverage: None,
        engine: None,
        said: vec![Vec::new(); experiment.uncertainties.len()],
    };
    for record in records {
        outcome.replicates.extend(record.replicates);
        outcome.tally.merge(&record.tally);
        outcome.blocks.push(record.tally);
        outcome.engine = outcome.engine.or(record.engine);
        for (all, said) in outcome.said.iter_mut().zip(record.said) {
            all.push(said);
        }
        if let Some(coverage) = &record.coverage {
            outcome.coverage.get_or_insert_default().merge(coverage);
        }
    }
    if let Some(exact) = exact {
        outcome.expected = Some(exact.iter().map(|m| m.mean).collect());
        outcome.spread = Some(exact.iter().map(|m| m.variance.sqrt()).collect());
    }
    outcome.measure(group);
    outcome
}
