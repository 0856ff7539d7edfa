//! Likelihood cross-validation: the bandwidth under which the data surprise each other least.

use super::functionals::{canonical, fall_back};
use super::search::search;
use super::spread::Spread;
use super::{Criterion, Described, SelectError, Selection, Selector};
use crate::engine::{EXACT, LINE, Planned};
use crate::kernel::{Bandwidth, Kernel, KernelSum, Shape};
use crate::random;
use crate::sample::{Sample, Weights};
use crate::space::{Domain, Field, Point, Targets, Warning};
use rand::seq::SliceRandom;
use std::cell::Cell;

/// The h of the largest Σᵢ wᵢ log f̂₋ᵢ(Xᵢ), each point judged by the estimate from all others, for the kernel itself. [Habbema, Hermans & van den Broek 1974; Duin 1976;
/// Silverman 1986, section 3.4.4]
///
/// By definition one far point would dictate h, since log 0 is -∞ (Schuster & Gregory 1981). So f̂₋ᵢ counts as at least 1/(n² range), a density that
/// even a single point spread evenly over n times the range of the data exceeds: points so isolated neither forbid nor demand anything, and are counted in a warning. O(n) a bandwidth for the
/// Gaussian, O(n log n) for compact kernels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Likelihood;

/// The same with ten folds: each tenth of the data (drawn from their ranks by a fixed stream, so that the order of the data does not matter) is judged by the estimate from the other nine.
#[derive(Clone, Copy, Debug, Default)]
pub struct FoldedLikelihood;

/// Folds of [`FoldedLikelihood`].
const FOLDS: usize = 10;

/// What is below this share of the peak is summed point by point: an engine's error is 1e-12 of the peak.
const DEEP: f64 = 1e-8;

/// Points with the same estimate: those left out of it, and those it is made of.
struct Fold {
    /// Positions in the sorted sample of the points to judge.
    judged: Vec<Point<1>>,
    weights: Vec<f64>,
    rest: Sample<1>,
}

/// The criterion of one sample and kernel.
struct Surprise {
    shape: Shape,
    /// Sorted, mass 1.
    points: Vec<f64>,
    weights: Vec<f64>,
    sample: Sample<1>,
    /// Empty for leave-one-out.
    folds: Vec<Fold>,
    floor: f64,
    deviation: f64,
}

impl Surprise {
    fn new(sample: &Sample<1>, shape: Shape, folds: usize) -> Result<Self, SelectError> {
        let spread = Spread::of(sample)?;
        let mut pairs: Vec<(f64, f64)> = sample
            .coordinates()
            .iter()
            .enumerate()
            .map(|(i, &x)| (x, sample.weight(i) / sample.mass()))
            .filter(|&(_, w)| w > 0.0)
            .collect();
        pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let sorted = |pairs: &[(f64, f64)]| {
            let points = pairs.iter().map(|&(x, _)| [x]).collect();
            let weights = match sample.weights() {
                Weights::Equal(_) => Weights::Equal(1.0 / pairs.len() as f64),
                Weights::Each(_) => {
                    let mass: f64 = pairs.iter().map(|&(_, w)| w).sum();
                    Weights::Each(pairs.iter().map(|&(_, w)| w / mass).collect())
                }
            };
            Sample::new(points, weights, Domain::whole()).ok()
        };
        // by chance: folds that interleave in order resemble each other more than samples do, and ask for too small an h
        let mut place: Vec<usize> = (0..pairs.len()).collect();
        place.shuffle(&mut random::stream(0, "folds", pairs.len() as u64));
        let parts = (0..folds)
            .filter_map(|fold| {
                let (judged, rest): (Vec<_>, Vec<_>) = pairs
                    .iter()
                    .enumerate()
                    .partition(|(i, _)| place[*i] % folds == fold);
                let rest: Vec<(f64, f64)> = rest.into_iter().map(|(_, &pair)| pair).collect();
                Some(Fold {
                    judged: judged.iter().map(|(_, pair)| [pair.0]).collect(),
                    weights: judged.iter().map(|(_, pair)| pair.1).collect(),
                    rest: sorted(&rest)?,
                })
            })
            .collect();
        let n = sample.effective_size();
        Ok(Self {
            shape,
            sample: sorted(&pairs).unwrap_or_else(|| sample.clone()),
            points: pairs.iter().map(|&(x, _)| x).collect(),
            weights: pairs.iter().map(|&(_, w)| w).collect(),
            folds: parts,
            floor: 1.0 / (n * n * (spread.most - spread.least)),
            deviation: spread.deviation,
        })
    }

    /// Minus the mean log density, and the mass of the points that count with the floor.
    fn at(&self, h: f64) -> (f64, f64) {
        let (mut surprise, mut isolated) = (0.0, 0.0);
        let mut count = |weight: f64, density: f64| {
            if density > self.floor {
                surprise -= weight * density.ln();
            } else {
                surprise -= weight * self.floor.ln();
                isolated += weight;
            }
        };
        if self.folds.is_empty() {
            for (weight, density) in self.weights.iter().zip(self.without_itself(h)) {
                count(*weight, density);
            }
        } else {
            for fold in &self.folds {
                let densities = evaluate(&fold.rest, self.shape, h, &fold.judged);
                for (weight, density) in fold.weights.iter().zip(densities) {
                    count(*weight, density);
                }
            }
        }
        (surprise, isolated)
    }

    /// f̂₋ᵢ(Xᵢ) for the sorted points.
    fn without_itself(&self, h: f64) -> Vec<f64> {
        let all = evaluate(&self.sample, self.shape, h, self.sample.points());
        let peak = all.iter().copied().fold(0.0, f64::max);
        let own = self.shape.peak() / h;
        all.iter()
            .zip(&self.weights)
            .enumerate()
            .map(|(i, (&density, &weight))| {
                let others = density - weight * own;
                let others = if others < DEEP * peak {
                    self.one_by_one(i, h)
                } else {
                    others
                };
                others / (1.0 - weight)
            })
            .collect()
    }

    /// The sum over all points but the i-th, from the nearest outwards. Only for isolated points, which have few near ones.
    fn one_by_one(&self, i: usize, h: f64) -> f64 {
        const MOST: usize = 4096;
        let reach = self.shape.reach().min(12.0);
        let term = |j: usize| {
            let u = (self.points[i] - self.points[j]) / h;
            (u.abs() <= reach).then(|| self.weights[j] * self.shape.value(u))
        };
        let left: f64 = (0..i).rev().take(MOST).map_while(term).sum();
        let right: f64 = (i + 1..self.points.len()).take(MOST).map_while(term).sum();
        (left + right) / h
    }
}

/// The estimate from `sample` at `places`, by whatever engine is fastest.
fn evaluate(sample: &Sample<1>, shape: Shape, h: f64, places: &[Point<1>]) -> Vec<f64> {
    KernelSum::new(sample.clone(), shape, Bandwidth::Fixed([h]))
        .ok()
        .and_then(|sum| Planned::new(LINE, sum, EXACT, None).ok())
        .map_or_else(
            || vec![0.0; places.len()],
            |field| field.evaluate(Targets::Points(places)).values,
        )
}

fn select(
    sample: &Sample<1>,
    shape: Shape,
    folds: usize,
    what: &str,
) -> Result<Selection<1>, SelectError> {
    let surprise = Surprise::new(sample, shape, folds)?;
    let n = sample.effective_size();
    let widest = 3.0 * 1.144 * n.powf(-0.2) * surprise.deviation * canonical(shape);
    let isolated = Cell::new(0.0);
    let at = |h: f64| {
        let (value, mass) = surprise.at(h);
        isolated.set(mass);
        value
    };
    let found = search(at, at, 1e-4 * widest, widest);
    let Some((h, mut warnings)) = found.choose(what) else {
        return fall_back(
            sample,
            shape,
            &format!("{what} has no minimum but towards bandwidth 0 or infinity"),
        );
    };
    at(h);
    if isolated.get() > 0.0 {
        warnings.push(Warning {
            what: format!(
                "a share of {:.2e} of the data is so far from all others that it cannot be foreseen from them; {what} leaves it out of account",
                isolated.get()
            ),
            hint: "look at these points: are they errors?".to_owned(),
        });
    }
    Ok(Selection::new(h, warnings))
}

fn criterion(
    sample: &Sample<1>,
    shape: Shape,
    folds: usize,
) -> Result<Option<Criterion>, SelectError> {
    let surprise = Surprise::new(sample, shape, folds)?;
    Ok(Some(Box::new(move |h| surprise.at(h).0)))
}

impl Selector<1> for Likelihood {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        select(sample, shape, 0, "likelihood cross-validation")
    }

    fn criterion(
        &self,
        sample: &Sample<1>,
        shape: Shape,
    ) -> Result<Option<Criterion>, SelectError> {
        criterion(sample, shape, 0)
    }
}

impl Selector<1> for FoldedLikelihood {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        select(sample, shape, FOLDS, "ten-fold likelihood cross-validation")
    }

    fn criterion(
        &self,
        sample: &Sample<1>,
        shape: Shape,
    ) -> Result<Option<Criterion>, SelectError> {
        criterion(sample, shape, FOLDS)
    }
}

impl Described for Likelihood {
    const NAME: &'static str = "likelihood-cross-validation";
    const SUMMARY: &'static str = "the largest likelihood of each point given all others, with the kernel itself; far points have no say";
    const COST: &'static str = "O(n) a bandwidth, O(n log n) for compact kernels";
    const REFERENCE: &'static str =
        "Habbema, Hermans & van den Broek 1974; Duin 1976; Silverman 1986, section 3.4.4";
}

impl Described for FoldedLikelihood {
    const NAME: &'static str = "k-fold-likelihood";
    const SUMMARY: &'static str = "the same, each tenth of the data judged by the other nine";
    const COST: &'static str = "ten estimates of 0.9 n points a bandwidth";
    const REFERENCE: &'static str =
        "Habbema, Hermans & van den Broek 1974; van der Laan, Dudoit & Keles 2004";
}
