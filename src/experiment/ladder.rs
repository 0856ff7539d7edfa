//! The best that can be had, rung by rung: what every error is compared with.

use super::run::Bench;
use crate::numeric::Sum;
use crate::space::Point;
use crate::theory::{Family, Local};
use rayon::prelude::*;

/// Least errors that theory knows; `None` where it does not.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ladder {
    /// The MISE over the whole line or plane of the best of all estimators that differ in their bandwidth, width, k or number of terms alone.
    pub best: Option<f64>,
    /// ∫ of the least mean squared error at each place over the grid, for kernel estimates.
    pub local: Option<f64>,
}

/// At most so many places, spread over the grid, tell what the best bandwidth at each place gives.
const PLACES: usize = 160;

/// The ladder of each estimator for one source and size. What estimators share is computed once.
pub(super) fn climb<const D: usize>(bench: &Bench<D>, source: usize, size: usize) -> Vec<Ladder> {
    let mut known: Vec<(Family, Ladder)> = Vec::new();
    let estimators = &bench.setting(source, size).estimators;
    estimators
        .iter()
        .map(|estimator| {
            let known_theory = |family: &Family| family.is_of_estimates();
            let Some(family) = estimator.family().filter(known_theory) else {
                return Ladder::default();
            };
            if let Some((_, ladder)) = known.iter().find(|(other, _)| *other == family) {
                return *ladder;
            }
            let ladder = rungs(bench, source, size, family);
            known.push((family, ladder));
            ladder
        })
        .collect()
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
    let step = setting.grid.len().div_ceil(PLACES).max(1);
    let places: Vec<Point<D>> = setting
        .grid
        .centres()
        .skip(step / 2)
        .step_by(step)
        .collect();
    // in the plane only where moments are closed forms
    let cheap =
        D == 1 || (matches!(family, Family::Kernel(crate::kernel::Shape::Gaussian)) && mixture);
    let kernel = matches!(family, Family::Kernel(_) | Family::RadialKernel(_));
    let local: Option<Vec<f64>> = (kernel && cheap)
        .then(|| {
            (places.par_iter())
                .map(|x| family.best_at(&**truth, draws, *x).map(Local::error))
                .collect()
        })
        .flatten();
    let cell = setting.grid.cell_measure() * setting.grid.len() as f64 / places.len() as f64;
    let held = |error: f64| (error > 0.0 && error.is_finite()).then_some(error);
    Ladder {
        best: best.and_then(|best| held(best.error.mise())),
        local: local.and_then(|errors| held(errors.into_iter().collect::<Sum>().value() * cell)),
    }
}
