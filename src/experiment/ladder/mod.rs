//! The best that can be had, rung by rung: what every error is compared with.

mod search;

use super::catalogue::{Builds, Entry};
use super::run::Bench;
use crate::kernel::Shape;
use crate::numeric::Sum;
use crate::space::Point;
use crate::theory::{Family, Local, ReflectedError, System};
use rayon::prelude::*;
use search::{Likes, Places};

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

/// The ladder of each estimator for one source and size. What estimators share is computed once.
pub(super) fn climb<const D: usize>(bench: &Bench<D>, source: usize, size: usize) -> Vec<Ladder>
where
    Entry: Builds<D>,
{
    let setting = bench.setting(source, size);
    let places = (bench.independent(source))
        // in the plane moments between walls are dear: minutes for a kernel
        .filter(|_| D == 1)
        .and_then(|truth| Places::new(truth, setting));
    let walls = bench.independent(source).is_some_and(|truth| {
        let (low, high) = (truth.domain().low(), truth.domain().high());
        low.iter().chain(&high).any(|end| end.is_finite())
    });
    let kernel = common(bench, source, size, (walls, places.as_ref()));
    let mut known: Vec<(Family, Ladder)> = Vec::new();
    let mut searched: Vec<(Likes, Ladder)> = Vec::new();
    let mut ladders = Vec::new();
    for (estimator, spec) in setting
        .estimators
        .iter()
        .zip(&bench.experiment().estimators)
    {
        // what is laid beyond walls is no part of an experiment's errors, but of those over the whole line or plane
        let beyond = |family: &Family| walls && !(D == 1 && within(family, places.as_ref()));
        let family = estimator.family();
        let known_theory = |family: &Family| family.is_of_estimates() && !beyond(family);
        if let Some(family) = family.filter(known_theory) {
            let found = known.iter().find(|(other, _)| *other == family);
            let ladder =
                found.map_or_else(|| rungs(bench, source, size, family), |(_, ladder)| *ladder);
            known.push((family, ladder));
            ladders.push(Ladder { kernel, ..ladder });
            continue;
        }
        // A pilot that is smoothed without noise has moments, but not those of estimates. Those of the mean radius of two neighbours cost a second for each
        // k, and the errors of bins have a low wherever an edge meets a wall, between which no search may stop.
        let likes = Likes::of(spec).filter(|likes| match family {
            Some(Family::Kernel(_) | Family::RadialKernel(_) | Family::Neighbour(_)) => true,
            Some(family @ Family::Adaptive { .. }) => family.is_of_estimates(),
            Some(_) => false,
            None => likes.is_kernel(),
        });
        let Some((likes, places)) = likes.zip(places.as_ref()) else {
            ladders.push(Ladder {
                kernel,
                ..Ladder::default()
            });
            continue;
        };
        let found = searched.iter().find(|(other, _)| *other == likes);
        let ladder = found.map_or_else(
            || Ladder {
                best: places.least(&likes),
                kernel,
                local: family.and_then(|family| local(bench, (source, size), family)),
            },
            |(_, ladder)| *ladder,
        );
        searched.push((likes, ladder));
        ladders.push(ladder);
    }
    ladders
}

/// Whether a family lays nothing beyond the walls of a line: series on an interval between them.
fn within<const D: usize>(family: &Family, places: Option<&Places<'_, D>>) -> bool
where
    Entry: Builds<D>,
{
    let Family::Series { system, place, .. } = family else {
        return false;
    };
    let Some([low, high]) = places.map(Places::walls) else {
        return false;
    };
    *system != System::Hermite
        && place[0].is_none_or(|end| end >= low)
        && place[1].is_none_or(|end| end <= high)
}

fn held(error: f64) -> Option<f64> {
    (error > 0.0 && error.is_finite()).then_some(error)
}

/// The rung of all estimators: between walls of a line from moments over the grid, elsewhere in closed form or by integrals over everything. In the plane
/// only where that is quick: for mixtures of normals.
fn common<const D: usize>(
    bench: &Bench<D>,
    source: usize,
    size: usize,
    (walls, places): (bool, Option<&Places<'_, D>>),
) -> Option<f64>
where
    Entry: Builds<D>,
{
    let truth = bench.independent(source)?;
    let draws = bench.setting(source, size).draws as f64;
    if walls && D > 1 {
        let plane = truth.bivariate()?;
        let (_, errors) = ReflectedError::new(plane)?.optimum(draws)?;
        return held(errors.mise());
    }
    if walls {
        return places?.least(&Likes::reflected()?);
    }
    let mixture = truth
        .bivariate()
        .is_some_and(|plane| plane.normal_components().is_some());
    if D > 1 && !mixture {
        return None;
    }
    let best = Family::Kernel(Shape::Gaussian).optimum_of(&**truth, draws)?;
    held(best.error.mise())
}

fn rungs<const D: usize>(bench: &Bench<D>, source: usize, size: usize, family: Family) -> Ladder {
    let setting = bench.setting(source, size);
    let Some(truth) = bench.independent(source) else {
        return Ladder::default();
    };
    let draws = setting.draws as f64;
    let mixture = truth
        .bivariate()
        .is_some_and(|plane| plane.normal_components().is_some());
    // tables of all discs of the plane would take longer than most experiments, and so would bumps of all widths between walls
    let dear = D > 1
        && match family {
            Family::Neighbour(_) => true,
            Family::Adaptive { .. } => !mixture,
            _ => false,
        };
    let best = (!dear)
        .then(|| family.optimum_of(&**truth, draws))
        .flatten();
    Ladder {
        best: best.and_then(|best| held(best.error.mise())),
        kernel: None,
        local: local(bench, (source, size), family),
    }
}

/// What kernel estimates could reach with the best bandwidth at each place; in the plane only where moments are closed forms.
fn local<const D: usize>(
    bench: &Bench<D>,
    (source, size): (usize, usize),
    family: Family,
) -> Option<f64> {
    let setting = bench.setting(source, size);
    let truth = bench.independent(source)?;
    let draws = setting.draws as f64;
    let mixture = truth
        .bivariate()
        .is_some_and(|plane| plane.normal_components().is_some());
    let cheap = D == 1 || (matches!(family, Family::Kernel(Shape::Gaussian)) && mixture);
    if !cheap || !matches!(family, Family::Kernel(_) | Family::RadialKernel(_)) {
        return None;
    }
    let step = setting.grid.len().div_ceil(PLACES).max(1);
    let places: Vec<Point<D>> = setting
        .grid
        .centres()
        .skip(step / 2)
        .step_by(step)
        .collect();
    let errors: Vec<f64> = (places.par_iter())
        .map(|x| family.best_at(&**truth, draws, *x).map(Local::error))
        .collect::<Option<_>>()?;
    let cell = setting.grid.cell_measure() * setting.grid.len() as f64 / places.len() as f64;
    held(errors.into_iter().collect::<Sum>().value() * cell)
}
