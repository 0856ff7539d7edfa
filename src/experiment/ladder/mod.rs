//! The best that can be had, rung by rung: what every error is compared with.

mod kernel;
mod lattice;
mod moments;
mod search;

use super::EstimatorSpec;
use super::catalogue::{Builds, Entry};
use super::run::Bench;
use crate::density::Density;
use crate::estimator::Estimator;
use crate::space::Grid;
use crate::theory::{Family, System};
use kernel::KernelRungs;
use moments::KernelMoments;
use search::{Likes, Places};
use std::sync::Arc;

/// Least errors that theory knows; `None` where it does not.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ladder {
    /// The MISE over the whole line or plane (where the grid covers the density) of the best of all estimators that differ in their bandwidth, width, k or number of terms alone; over the grid where
    /// only moments at places are known, as of kernels that know walls.
    pub best: Option<f64>,
    /// The MISE over the grid of the best estimate with one bandwidth and a Gaussian kernel, reflected at walls, or cut and normalised in a polygon: one rung for all estimators.
    pub kernel: Option<f64>,
    /// ∫ over the grid of the least mean squared error at each place of estimates with this kernel and any bandwidth, up to the extent of the density: the next rung for all.
    pub local: Option<f64>,
}

/// The ladder of each estimator for one source, by sample size.
pub(super) fn climb<const D: usize>(bench: &Bench<D>, source: usize) -> Vec<Vec<Ladder>>
where
    Entry: Builds<D>,
{
    let Some(truth) = bench.independent(source) else {
        let none = vec![Ladder::default(); bench.experiment().estimators.len()];
        return vec![none; bench.settings(source).len()];
    };
    let settings = bench.settings(source);
    let most = settings.iter().map(|setting| setting.draws).max();
    let ground = Ground {
        bench,
        source,
        truth,
        // grids are those of the source
        rungs: (settings.first().zip(most).filter(|_| has_kernel(truth))).and_then(
            |(setting, most)| {
                KernelRungs::new(&**truth, &setting.grid, setting.truth()?, most as f64)
            },
        ),
    };
    (0..settings.len())
        .map(|size| ground.ladders(size))
        .collect()
}

/// Whether theory has the best estimator like this one for a source of independent points, over a grid (by default one that covers the density). What has a best may still have none
/// for its sample size: where the wider is the better, or one that lays mass beyond a wall is best narrower than places are apart.
pub(super) fn has_best<const D: usize>(
    truth: &Arc<dyn Density<D>>,
    grid: Option<&Grid<D>>,
    estimator: &dyn Estimator<D>,
    spec: &EstimatorSpec,
) -> bool
where
    Entry: Builds<D>,
{
    Kind::of(truth, grid, estimator, spec).is_some()
}

/// Whether there are rungs of the best kernels: not for a level density, for which the wider is the better, nor where there are no moments.
pub(super) fn has_kernel<const D: usize>(truth: &Arc<dyn Density<D>>) -> bool {
    truth.level().is_none() && KernelMoments::are_of(&**truth)
}

/// Whether a density ends anywhere.
fn walled<const D: usize>(truth: &Arc<dyn Density<D>>) -> bool {
    let (low, high) = (truth.domain().low(), truth.domain().high());
    low.iter().chain(&high).any(|end| end.is_finite())
}

/// Whether errors over a grid are all but those over everything.
fn covers<const D: usize>(grid: &Grid<D>, truth: &Arc<dyn Density<D>>) -> bool {
    let (low, high) = truth.bulk(2e-3);
    (0..D).all(|k| grid.low()[k] <= low[k] && high[k] <= grid.high()[k])
}

/// How the best of an estimator's kind is found.
enum Kind {
    /// Among the members of a family, by integrated errors.
    Family(Family),
    /// By moments at places.
    Search(Likes),
}

impl Kind {
    fn of<const D: usize>(
        truth: &Arc<dyn Density<D>>,
        grid: Option<&Grid<D>>,
        estimator: &dyn Estimator<D>,
        spec: &EstimatorSpec,
    ) -> Option<Self>
    where
        Entry: Builds<D>,
    {
        let family = estimator.family();
        let covered = grid.is_none_or(|grid| covers(grid, truth));
        let own =
            family.filter(|family| covered && family.is_of_estimates() && !beyond(truth, *family));
        if let Some(family) = own {
            // tables of all discs of the plane would take longer than most experiments, and so would bumps of all widths on products
            let mixture = truth.bivariate();
            let mixture = mixture.is_some_and(|plane| plane.normal_components().is_some());
            let dear = D > 1
                && match family {
                    Family::Neighbour(_) => true,
                    Family::Adaptive { .. } => !mixture,
                    _ => false,
                };
            let known = !dear && family.has_errors(&**truth);
            return known.then_some(Self::Family(family));
        }
        // in the plane moments between walls are dear: minutes for a kernel
        let likes = Likes::of(spec).filter(|likes| D == 1 && is_searched(family, likes));
        likes
            .filter(|likes| likes.have_moments(truth))
            .map(Self::Search)
    }
}

/// Whether members of a family lay mass beyond walls: no part of an experiment's errors, but of those over the whole line or plane. Series on an interval between them do not.
fn beyond<const D: usize>(truth: &Arc<dyn Density<D>>, family: Family) -> bool {
    let domain = truth.domain();
    let inside = match family {
        Family::Series { system, place, .. } if D == 1 && system != System::Hermite => {
            place[0].is_none_or(|end| end >= domain.low()[0])
                && place[1].is_none_or(|end| end <= domain.high()[0])
        }
        _ => false,
    };
    walled(truth) && !inside
}

/// What the ladders of all sizes of a source stand on.
struct Ground<'b, const D: usize> {
    bench: &'b Bench<D>,
    source: usize,
    truth: &'b Arc<dyn Density<D>>,
    /// Those of all estimators.
    rungs: Option<KernelRungs>,
}

impl<const D: usize> Ground<'_, D>
where
    Entry: Builds<D>,
{
    /// Each estimator's; what they share is computed once.
    fn ladders(&self, size: usize) -> Vec<Ladder> {
        let setting = self.bench.setting(self.source, size);
        let places = (D == 1).then(|| Places::new(self.truth, setting)).flatten();
        let draws = setting.draws as f64;
        let rungs = self.rungs.as_ref();
        let kernel = rungs.and_then(|rungs| rungs.best(draws));
        // without a best bandwidth for all there is none at most places
        let local = kernel.and_then(|_| rungs?.local(draws));
        let (mut known, mut searched) = (Vec::new(), Vec::new());
        let mut best = |estimator: &dyn Estimator<D>, spec: &EstimatorSpec| match Kind::of(
            self.truth,
            Some(&setting.grid),
            estimator,
            spec,
        )? {
            Kind::Family(family) => once(&mut known, family, || {
                let best = family.optimum_of(&**self.truth, draws)?;
                held(best.error.mise())
            }),
            Kind::Search(likes) => once(&mut searched, likes.clone(), || {
                places.as_ref()?.least(&likes)
            }),
        };
        let specs = &self.bench.experiment().estimators;
        let all = setting.estimators.iter().zip(specs);
        all.map(|(estimator, spec)| Ladder {
            best: best(estimator.as_ref(), spec),
            kernel,
            local,
        })
        .collect()
    }
}

/// Whether the best is searched by moments at places. A pilot that is smoothed without noise has moments, but not those of estimates; those of the mean radius of two
/// neighbours cost a second for each k; and the errors of bins have a low wherever an edge meets a wall, between which no search may stop.
fn is_searched(family: Option<Family>, likes: &Likes) -> bool {
    match family {
        Some(Family::Kernel(_) | Family::RadialKernel(_) | Family::Neighbour(_)) => true,
        Some(family @ Family::Adaptive { .. }) => family.is_of_estimates(),
        Some(_) => false,
        None => likes.is_kernel(),
    }
}

/// What was made of `key` before, or else what is made now.
fn once<K: PartialEq>(
    known: &mut Vec<(K, Option<f64>)>,
    key: K,
    make: impl FnOnce() -> Option<f64>,
) -> Option<f64> {
    if let Some((_, error)) = known.iter().find(|(other, _)| *other == key) {
        return *error;
    }
    let error = make();
    known.push((key, error));
    error
}

fn held(error: f64) -> Option<f64> {
    (error > 0.0 && error.is_finite()).then_some(error)
}
