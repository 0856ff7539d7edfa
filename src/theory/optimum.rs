//! The least of an error over the bandwidth, and every other low.

use super::{Asymptotic, Integrated, NoAsymptotics};
use crate::numeric::{Minimum, local_minima, minimise};

/// The best bandwidth or width.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// Where the MISE is least.
    pub at: f64,
    /// Its parts there.
    pub error: Integrated,
    /// All other local minima of the MISE that lie 8 % apart or more, the lowest first: a search that starts near one of them would end there.
    pub others: Vec<Minimum>,
}

/// All that theory has to say about one density, one estimator and one sample size, whatever the bandwidth.
#[derive(Clone, Debug, PartialEq)]
pub struct Oracle {
    /// The bandwidth or width of least MISE.
    pub optimum: Optimum,
    /// The leading terms for large samples, or why there are none.
    pub asymptotic: Result<Asymptotic, NoAsymptotics>,
}

/// Scans `error` on a ladder from `low` to `high` whose steps are 4 %, and refines each low.
pub(super) fn search(error: impl Fn(f64) -> Integrated, low: f64, high: f64) -> Optimum {
    search_by(error, low, high, 0.04)
}

/// The same with steps of 15 %, for errors that take long to compute: other minima that lie closer than 30 % may be missed.
pub(super) fn search_coarsely(error: impl Fn(f64) -> Integrated, low: f64, high: f64) -> Optimum {
    search_by(error, low, high, 0.15)
}

fn search_by(error: impl Fn(f64) -> Integrated, low: f64, high: f64, step: f64) -> Optimum {
    let mise = |h: f64| error(h).mise();
    let steps = ((high / low).ln() / step).ceil().clamp(8.0, 4000.0) as usize;
    let mut minima = local_minima(mise, low, high, steps);
    if minima.is_empty() {
        minima.push(minimise(mise, low, high, 1e-8));
    }
    let best = minima.remove(0);
    Optimum {
        at: best.at,
        error: error(best.at),
        others: minima,
    }
}

/// The minima of `error` beside those of a function that is almost the same.
pub(super) fn refine(near: &Optimum, error: impl Fn(f64) -> Integrated) -> Optimum {
    let mise = |h: f64| error(h).mise();
    let places = std::iter::once(near.at).chain(near.others.iter().map(|other| other.at));
    let mut minima: Vec<Minimum> = places
        .map(|at| minimise(mise, 0.98 * at, 1.02 * at, 1e-8))
        .collect();
    minima.sort_by(|a, b| a.value.total_cmp(&b.value));
    let best = minima.remove(0);
    Optimum {
        at: best.at,
        error: error(best.at),
        others: minima,
    }
}
