//! The best that can be had, rung by rung: what every error is compared with.

mod search;

use super::EstimatorSpec;
use super::catalogue::{Builds, Entry};
use super::run::Bench;
use crate::density::Density;
use crate::estimator::Estimator;
use crate::kernel::Shape;
use crate::numeric::Sum;
use crate::space::Point;
use crate::theory::{Family, Local, ReflectedError, System};
use rayon::prelude::*;
use search::{Likes, Places};
use std::sync::Arc;

/// Least errors that theory knows; `None` where it does not.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ladder {
    /// The MISE over the whole line or plane of the best of all estimators that differ in their bandwidth, width, k or number of terms alone; over the grid where
    /// only moments at places are known, as of kernels that know walls.
    pub best: Option<f64>,
    /// The MISE of the best kernel estimate with one bandwidth and a Gaussian kernel, reflected at walls: one rung for all estimators.
    pub kernel: Option<f64>,
    /// ∫ of the least mean squared error at each place over the grid, for kernel estimates.
    pub local: Option<f64>,
}

/// At most so many places, spread over the grid, tell what the best bandwidth at each place gives.
const PLACES: usize = 160;

/// The ladder of each estimator for one source, by sample size.
pub(super) fn climb<const D: usize>(bench: &Bench<D>, source: usize) -> Vec<Vec<Ladder>>
where
    Entry: Builds<D>,
{
    let Some(truth) = bench.independent(source) else {
        let none = vec![Ladder::default(); bench.experiment().estimators.len()];
        return vec![none; bench.settings(source).len()];
    };
    let plane = truth.bivariate();
    let (low, high) = (truth.domain().low(), truth.domain().high());
    let walls = low.iter().chain(&high).any(|end| end.is_finite());
    let ground = Ground {
        bench,
        source,
        truth,
        walls,
        mixture: plane.is_some_and(|plane| plane.normal_components().is_some()),
        reflected: plane.filter(|_| walls).and_then(ReflectedError::new),
    };
    let sizes = 0..bench.settings(source).len();
    sizes.map(|size| ground.ladders(size)).collect()
}

/// What the ladders of all sizes of a source stand on.
struct Ground<'b, const D: usize> {
    bench: &'b Bench<D>,
    source: usize,
    truth: &'b Arc<dyn Density<D>>,
    /// Whether its domain has any.
    walls: bool,
    /// Whether it is one of normal densities in the plane.
    mixture: bool,
    /// The errors of reflected kernels in the plane.
    reflected: Option<ReflectedError>,
}

impl<const D: usize> Ground<'_, D>
where
    Entry: Builds<D>,
{
    /// Each estimator's; what they share is computed once.
    fn ladders(&self, size: usize) -> Vec<Ladder> {
        let setting = self.bench.setting(self.source, size);
        // in the plane moments between walls are dear: minutes for a kernel
        let places = (D == 1).then(|| Places::new(self.truth, setting)).flatten();
        let kernel = self.kernel(size, places.as_ref());
        let (mut known, mut searched) = (Vec::new(), Vec::new());
        let specs = &self.bench.experiment().estimators;
        let mut ladder = |estimator: &dyn Estimator<D>, spec: &EstimatorSpec| {
            let family = estimator.family();
            let own = family.filter(|family| family.is_of_estimates() && !self.beyond(*family));
            if let Some(family) = own {
                return once(&mut known, family, || self.of_family(size, family));
            }
            let likes = Likes::of(spec).filter(|likes| is_searched(family, likes));
            let Some((likes, places)) = likes.zip(places.as_ref()) else {
                return Ladder::default();
            };
            once(&mut searched, likes.clone(), || Ladder {
                best: places.least(&likes),
                kernel: None,
                local: family.and_then(|family| self.local(size, family)),
            })
        };
        let all = setting.estimators.iter().zip(specs);
        all.map(|(estimator, spec)| ladder(estimator.as_ref(), spec))
            .map(|ladder| Ladder { kernel, ..ladder })
            .collect()
    }

    /// The rung of all estimators: between walls of a line from moments over the grid, between four walls by cosines, elsewhere in closed form or by integrals
    /// over everything; in the plane only where that is quick.
    fn kernel(&self, size: usize, places: Option<&Places<'_, D>>) -> Option<f64> {
        let draws = self.bench.setting(self.source, size).draws as f64;
        if D == 1 && self.walls {
            return places?.least(&Likes::reflected()?);
        }
        if self.walls {
            return held(self.reflected.as_ref()?.optimum(draws)?.error.mise());
        }
        if D > 1 && !self.mixture {
            return None;
        }
        let best = Family::Kernel(Shape::Gaussian).optimum_of(&**self.truth, draws)?;
        held(best.error.mise())
    }

    /// Whether members lay mass beyond walls: no part of an experiment's errors, but of those over the whole line or plane. Series on an interval between them do not.
    fn beyond(&self, family: Family) -> bool {
        let domain = self.truth.domain();
        let inside = match family {
            Family::Series { system, place, .. } if D == 1 && system != System::Hermite => {
                place[0].is_none_or(|end| end >= domain.low()[0])
                    && place[1].is_none_or(|end| end <= domain.high()[0])
            }
            _ => false,
        };
        self.walls && !inside
    }

    /// The ladder of a family whose integrated errors theory knows.
    fn of_family(&self, size: usize, family: Family) -> Ladder {
        // tables of all discs of the plane would take longer than most experiments, and so would bumps of all widths between walls
        let dear = D > 1
            && match family {
                Family::Neighbour(_) => true,
                Family::Adaptive { .. } => !self.mixture,
                _ => false,
            };
        let draws = self.bench.setting(self.source, size).draws as f64;
        let best = (!dear)
            .then(|| family.optimum_of(&**self.truth, draws))
            .flatten();
        Ladder {
            best: best.and_then(|best| held(best.error.mise())),
            kernel: None,
            local: self.local(size, family),
        }
    }

    /// What kernel estimates could reach with the best bandwidth at each place; in the plane only where moments are closed forms.
    fn local(&self, size: usize, family: Family) -> Option<f64> {
        let closed = self.mixture && matches!(family, Family::Kernel(Shape::Gaussian));
        let kernel = matches!(family, Family::Kernel(_) | Family::RadialKernel(_));
        if !kernel || !(D == 1 || closed) {
            return None;
        }
        let setting = self.bench.setting(self.source, size);
        let step = setting.grid.len().div_ceil(PLACES).max(1);
        let places: Vec<Point<D>> = setting
            .grid
            .centres()
            .skip(step / 2)
            .step_by(step)
            .collect();
        let draws = setting.draws as f64;
        let errors: Vec<f64> = (places.par_iter())
            .map(|x| family.best_at(&**self.truth, draws, *x).map(Local::error))
            .collect::<Option<_>>()?;
        let cell = setting.grid.cell_measure() * setting.grid.len() as f64 / places.len() as f64;
        held(errors.into_iter().collect::<Sum>().value() * cell)
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
    known: &mut Vec<(K, Ladder)>,
    key: K,
    make: impl FnOnce() -> Ladder,
) -> Ladder {
    if let Some((_, ladder)) = known.iter().find(|(other, _)| *other == key) {
        return *ladder;
    }
    let ladder = make();
    known.push((key, ladder));
    ladder
}

fn held(error: f64) -> Option<f64> {
    (error > 0.0 && error.is_finite()).then_some(error)
}
