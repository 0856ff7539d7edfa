//! The best of estimators that differ in their bandwidth alone, found where theory gives moments at places only.

use super::held;
use crate::density::Density;
use crate::estimator::Context;
use crate::experiment::EstimatorSpec;
use crate::experiment::catalogue::{self, Builds, Entry};
use crate::experiment::run::Setting;
use crate::numeric::{Sum, minimise};
use crate::parameter::{Kind, Value, Values};
use crate::space::Point;
use rayon::prelude::*;
use std::sync::Arc;

/// All estimators that are told the same but for one number.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Likes {
    kind: String,
    /// What decides how smooth they are, and whether it is a count.
    smoothing: &'static str,
    counts: bool,
    /// The rest.
    values: Values,
}

impl Likes {
    /// The estimators like one; `None` if no number decides how smooth it is.
    pub fn of(spec: &EstimatorSpec) -> Option<Self> {
        Self::new(&spec.kind, &spec.values)
    }

    fn new(kind: &str, values: &Values) -> Option<Self> {
        let entry = catalogue::estimator(kind)?;
        let smoothing = entry.smoothing?;
        let parameter = entry.parameters.iter().find(|p| p.name == smoothing)?;
        let counts = match parameter.kind.numeric() {
            Kind::Positive => false,
            Kind::Count { .. } => true,
            _ => return None,
        };
        let mut likes = Self {
            kind: kind.to_owned(),
            smoothing,
            counts,
            values: values.clone(),
        };
        // the same for all of them
        likes.values = likes.member(1.0);
        Some(likes)
    }

    /// Gaussian kernels that are reflected at walls.
    pub fn reflected() -> Option<Self> {
        let entry = catalogue::estimator("kernel")?;
        let mut values = Values::defaults(entry.parameters);
        values.set("boundary", Value::Word("reflect".to_owned()));
        Self::new("kernel", &values)
    }

    /// Whether they are kernel estimates, whatever they do at walls.
    pub fn is_kernel(&self) -> bool {
        self.kind == "kernel"
    }

    /// Whether theory gives moments of all of them.
    pub fn have_moments<const D: usize>(&self, truth: &Arc<dyn Density<D>>) -> bool
    where
        Entry: Builds<D>,
    {
        let (low, high) = truth.bulk(1e-4);
        let context = Context {
            truth: Some(truth.clone()),
            draws: 10,
        };
        let some = if self.counts {
            5.0
        } else {
            0.1 * (high[0] - low[0])
        };
        let entry = catalogue::estimator(&self.kind);
        let built = entry.and_then(|entry| entry.build(&self.member(some), &context).ok());
        built.is_some_and(|built| built.expectation(&**truth, context.draws, &[]).is_some())
    }

    /// What the one of this bandwidth, width or number is told.
    pub fn member(&self, smoothing: f64) -> Values {
        let mut values = self.values.clone();
        let value = if self.counts {
            Value::Count(smoothing as u64)
        } else {
            Value::Number(smoothing)
        };
        values.set(self.smoothing, value);
        values
    }
}

/// Places over which errors are integrated.
pub(super) struct Places<'t, const D: usize> {
    truth: &'t Arc<dyn Density<D>>,
    draws: usize,
    /// All of them, the truth there, and the measure of the part of the grid that each stands for.
    all: Vec<Point<D>>,
    values: Vec<f64>,
    cell: f64,
    /// From the narrowest bandwidth that is tried to the widest.
    range: [f64; 2],
}

/// At most so many places are looked at while the best is searched, so many while it is refined (a wall is felt by few of them), and so many for its error.
const FEW: usize = 128;
const SOME: usize = 512;
const MANY: usize = 4096;
/// The ratio of bandwidths that are tried before the best of them is refined.
const RATIO: f64 = 4.0 / 3.0;
/// Places whose moments are computed together.
const CHUNK: usize = 64;

impl<'t, const D: usize> Places<'t, D>
where
    Entry: Builds<D>,
{
    /// Those of a grid; `None` where the truth is not known there.
    pub fn new(truth: &'t Arc<dyn Density<D>>, setting: &Setting<D>) -> Option<Self> {
        let step = setting.grid.len().div_ceil(MANY).max(1);
        let spread = |from: usize| from % step == step / 2;
        let all: Vec<Point<D>> = (setting.grid.centres().enumerate())
            .filter(|(i, _)| spread(*i))
            .map(|(_, x)| x)
            .collect();
        let known = setting.truth()?.iter().enumerate();
        let values = known.filter(|(i, _)| spread(*i)).map(|(_, f)| *f).collect();
        let whole = setting.grid.cell_measure() * setting.grid.len() as f64;
        let (low, high) = truth.bulk(1e-4);
        let extent = (0..D).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let finest = (0..D).map(|k| truth.finest_scale(k));
        let finest = finest.fold(f64::INFINITY, f64::min);
        Some(Self {
            truth,
            draws: setting.draws,
            cell: whole / all.len() as f64,
            all,
            values,
            // what lays mass beyond a wall is best as narrow as that
            range: [
                (0.1 * finest / (setting.draws as f64).sqrt()).min(1e-3 * extent),
                extent,
            ],
        })
    }

    /// The least MISE over the places of all that are like each other; `None` where there are no moments, none is better than the narrowest and the widest, or the best is narrower than places are apart.
    pub fn least(&self, likes: &Likes) -> Option<f64> {
        let step = |most: usize| self.all.len().div_ceil(most).max(1);
        let (few, some) = (step(FEW), step(SOME));
        let error = |smoothing: f64, step| {
            let mise = self.mise(likes, smoothing, step);
            mise.unwrap_or(f64::INFINITY)
        };
        let [low, high] = if likes.counts {
            [2.0, 0.5 * self.draws as f64]
        } else {
            self.range
        };
        let steps = ((high / low).ln() / RATIO.ln()).ceil().max(4.0) as usize;
        let ratio = (high / low).ln() / steps as f64;
        let mut tried: Vec<f64> = (0..=steps)
            .map(|i| low * (ratio * i as f64).exp())
            .collect();
        if likes.counts {
            tried = tried.into_iter().map(f64::round).collect();
            tried.dedup();
        }
        // one that has no moments has none at any bandwidth
        self.mise(likes, tried[tried.len() / 2], few)?;
        let errors: Vec<f64> = tried.iter().map(|&h| error(h, few)).collect();
        let best = (0..tried.len()).min_by(|&i, &j| errors[i].total_cmp(&errors[j]))?;
        if best == 0 || best + 1 == tried.len() {
            return None;
        }
        let (below, above) = (tried[best - 1], tried[best + 1]);
        let at = if likes.counts {
            least_whole(|k| error(k, some), below, above)
        } else {
            minimise(|h| error(h, some), below, above, 1e-3).at
        };
        // a layer along a wall that is thinner than places are apart is not seen
        let apart = self.cell * some as f64;
        if !likes.counts && at < apart {
            return None;
        }
        held(self.mise(likes, at, 1)?)
    }

    /// The exact MISE over every `step`-th place.
    fn mise(&self, likes: &Likes, smoothing: f64, step: usize) -> Option<f64> {
        let entry = catalogue::estimator(&likes.kind)?;
        let context = Context {
            truth: Some(self.truth.clone()),
            draws: self.draws,
        };
        let estimator = entry.build(&likes.member(smoothing), &context).ok()?;
        let every = (step / 2..self.all.len()).step_by(step);
        let (places, truths): (Vec<Point<D>>, Vec<f64>) =
            every.map(|i| (self.all[i], self.values[i])).unzip();
        let moments: Vec<_> = places
            .par_chunks(CHUNK)
            .map(|places| estimator.expectation(&**self.truth, self.draws, places))
            .collect::<Option<_>>()?;
        let squares = moments.iter().flatten().zip(&truths);
        let sum: Sum = squares
            .map(|(m, f)| (m.mean - f).powi(2) + m.variance)
            .collect();
        let cell = self.cell * self.all.len() as f64 / places.len() as f64;
        Some(sum.value() * cell)
    }
}

/// The whole number between two others where `f` is least, if it has one minimum there: by thirds.
fn least_whole(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    while high - low > 2.0 {
        let third = ((high - low) / 3.0).floor().max(1.0);
        let (a, b) = (low + third, high - third);
        if a >= b {
            break;
        }
        if f(a) <= f(b) {
            high = b;
        } else {
            low = a;
        }
    }
    let all = (0..=(high - low) as usize).map(|i| low + i as f64);
    all.map(|k| (k, f(k)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(low, |(k, _)| k)
}

#[cfg(test)]
mod tests {
    use super::least_whole;

    #[test]
    fn whole_numbers_are_searched_by_thirds() {
        for best in 3..60 {
            let f = |k: f64| (k - f64::from(best) - 0.2).abs();
            let found = least_whole(f, 2.0, 61.0);
            assert!((found - f64::from(best)).abs() < 1e-9, "{best}: {found}");
        }
    }
}
