//! Estimates of the error from one sample, as an experiment names them, and what came of them.

use super::results::{Group, Outcome};
use crate::accuracy::{Calibration, Interval, Tally, rank_correlation};
use crate::numeric::Sum;
use crate::uncertainty::{Halves, Split};
use serde::{Deserialize, Serialize};

/// An estimate of the squared error that is held against the true one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UncertaintySpec {
    /// What it is called in tables and claims.
    pub name: String,
    /// Which.
    pub kind: UncertaintyKind,
}

/// The estimates of the error.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum UncertaintyKind {
    /// Batches of the sample.
    Halves {
        /// How many.
        batches: usize,
        /// What goes into one batch together: `path` or `point`.
        by: String,
    },
    /// Differences to shifted windows.
    Differences {
        /// 4 or 8.
        directions: usize,
        /// Half the side of the region, in cells.
        region: usize,
    },
}

impl UncertaintyKind {
    /// The halves, if it is they.
    pub fn halves(&self) -> Option<Halves> {
        match self {
            Self::Halves { batches, by } => Some(Halves {
                batches: *batches,
                split: Split::named(by)?,
            }),
            Self::Differences { .. } => None,
        }
    }
}

/// What an estimate of the error said over a block of replicates.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Said {
    /// ∫ê² of each replicate.
    pub integrals: Vec<f64>,
    /// The sum of ê² over the replicates, at each target.
    pub squared: Vec<f64>,
}

impl Said {
    /// Takes in one replicate.
    pub fn add(&mut self, squared: &[f64], cell: f64) {
        if self.squared.is_empty() {
            self.squared = vec![0.0; squared.len()];
        }
        for (sum, value) in self.squared.iter_mut().zip(squared) {
            *sum += value;
        }
        let integral: Sum = squared.iter().copied().collect();
        self.integrals.push(integral.value() * cell);
    }
}

/// What can be asked of an estimate of the error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Mean ∫ê² over ∫var f̂: 1 for an unbiased estimate of the random error.
    Ratio,
    /// The deviation of ∫ê² over replicates, relative to its mean.
    Spread,
    /// MISE over mean ∫ê²: how much of the error is not seen.
    Unseen,
    /// Spearman's rank correlation over the targets of mean ê² with the true mean squared error.
    Rank,
    /// M, the true mean squared error over mean ê², over all targets together.
    Factor,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Ratio,
        Self::Spread,
        Self::Unseen,
        Self::Rank,
        Self::Factor,
    ];

    /// The names in files and tables, in the order of [`Quantity::ALL`].
    pub const NAMES: [&'static str; 5] = ["ratio", "spread", "unseen", "rank", "factor"];

    /// The name.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// The quantity of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.name() == name)
    }
}

/// What is compared: the statements and the errors of some blocks together.
struct Pooled {
    integrals: Vec<f64>,
    /// Mean ê² at each target.
    squared: Vec<f64>,
    tally: Tally,
}

impl Pooled {
    /// Without block `out`, if any.
    fn of(said: &[Said], tallies: &[Tally], out: Option<usize>) -> Self {
        let mut pooled = Self {
            integrals: Vec::new(),
            squared: Vec::new(),
            tally: Tally::default(),
        };
        for (block, (said, tally)) in said.iter().zip(tallies).enumerate() {
            if Some(block) == out {
                continue;
            }
            pooled.integrals.extend(&said.integrals);
            pooled.squared.resize(said.squared.len(), 0.0);
            for (sum, value) in pooled.squared.iter_mut().zip(&said.squared) {
                *sum += value;
            }
            pooled.tally.merge(tally);
        }
        let n = pooled.integrals.len().max(1) as f64;
        pooled.squared.iter_mut().for_each(|value| *value /= n);
        pooled
    }

    /// The true mean squared error at each target, from the replicates.
    fn errors(&self) -> Vec<f64> {
        let n = self.tally.count() as f64;
        let deviation = self.tally.deviation().unwrap_or_default();
        let moments = self.tally.mean().iter().zip(deviation);
        moments
            .map(|(mean, s)| mean * mean + s * s * (n - 1.0) / n)
            .collect()
    }

    /// `exact` are ∫var and MISE by theory, where it knows them.
    fn quantity(&self, quantity: Quantity, exact: Option<(f64, f64)>, cell: f64) -> Option<f64> {
        let n = self.integrals.len() as f64;
        let mean = self.integrals.iter().sum::<f64>() / n;
        match quantity {
            Quantity::Ratio => {
                let variance = match exact {
                    Some((variance, _)) => variance,
                    None => self.tally.decompose(cell)?.variance,
                };
                Some(mean / variance)
            }
            Quantity::Spread => {
                let squares = self.integrals.iter().map(|i| (i - mean).powi(2));
                Some((squares.sum::<f64>() / (n - 1.0)).sqrt() / mean)
            }
            Quantity::Unseen => {
                let error = match exact {
                    Some((_, error)) => error,
                    None => self.errors().iter().sum::<f64>() * cell,
                };
                Some(error / mean)
            }
            Quantity::Rank => rank_correlation(&self.squared, &self.errors()),
            Quantity::Factor => {
                Calibration::of(&self.squared, &self.errors()).map(|found| found.factor)
            }
        }
    }
}

impl Outcome {
    /// A quantity of the estimate of the error number `at`, with an interval by leaving out a block of replicates at a time (jackknife; none for fewer than three blocks).
    pub fn uncertainty<const D: usize>(
        &self,
        at: usize,
        quantity: Quantity,
        confidence: f64,
        group: &Group<D>,
    ) -> Option<Interval> {
        use super::Measure::{ExactMise, ExactVariance};
        let said = self.said.get(at)?;
        let cell = group.grid.cell_measure();
        let exact = |measure| self.measures.get(&measure).map(|interval| interval.value);
        let exact = exact(ExactVariance).zip(exact(ExactMise));
        let of = |out| Pooled::of(said, &self.blocks, out).quantity(quantity, exact, cell);
        let whole = of(None).filter(|value| value.is_finite())?;
        let blocks = said.len();
        if blocks < 3 {
            return Some(Interval::exact(whole));
        }
        let left: Vec<f64> = (0..blocks)
            .map(|out| of(Some(out)))
            .collect::<Option<_>>()?;
        let g = blocks as f64;
        let mean = left.iter().sum::<f64>() / g;
        let squares = left.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        let error = ((g - 1.0) / g * squares).sqrt();
        Some(Interval::around(whole, error, g - 1.0, confidence))
    }

    /// Mean ê² of the estimate of the error number `at`, and the true mean squared error, at each target.
    pub fn squared_errors(&self, at: usize) -> Option<(Vec<f64>, Vec<f64>)> {
        let pooled = Pooled::of(self.said.get(at)?, &self.blocks, None);
        let errors = pooled.errors();
        Some((pooled.squared, errors))
    }
}
