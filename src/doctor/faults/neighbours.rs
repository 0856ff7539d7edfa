//! Neighbours miscounted.

use super::Fault;
use crate::density::Density;
use crate::doctor::subjects::{K, built};
use crate::estimator::{Estimate, Estimator, FitError, Laws, Moments};
use crate::neighbour::{Metric, Neighbours, Scratch, Searchable};
use crate::parameter::Value;
use crate::sample::Sample;
use crate::space::{Domain, Field, Point};
use std::f64::consts::FRAC_PI_4;
use std::sync::Arc;

/// Another estimator under the name and theory of the right one, times a number.
struct Impostor<const D: usize> {
    right: Arc<dyn Estimator<D>>,
    wrong: Arc<dyn Estimator<D>>,
    times: f64,
}

struct Times<const D: usize>(f64, Estimate<D>);

impl<const D: usize> Field<D> for Times<D> {
    fn domain(&self) -> &Domain<D> {
        self.1.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        self.0 * self.1.at(x)
    }
}

impl<const D: usize> Estimator<D> for Impostor<D> {
    fn laws(&self) -> Laws {
        self.right.laws()
    }

    fn fit(&self, sample: &Sample<D>) -> Result<Estimate<D>, FitError> {
        let field = Times(self.times, self.wrong.fit(sample)?);
        Ok(Estimate::new(Arc::new(field)))
    }

    fn expectation(
        &self,
        truth: &dyn Density<D>,
        draws: usize,
        places: &[Point<D>],
    ) -> Option<Vec<Moments>> {
        self.right.expectation(truth, draws, places)
    }
}

/// The slide's k.
pub const K_FOR_K_LESS_ONE: Fault = Fault {
    name: "k-for-k-less-one",
    summary: "k/(n V) instead of (k - 1)/(n V)",
    caught_by: "neighbour-moments",
    plant: |subjects| {
        subjects.nearest = Arc::new(Impostor {
            right: subjects.nearest.clone(),
            wrong: subjects.nearest.clone(),
            times: K as f64 / (K as f64 - 1.0),
        });
    },
};

/// The ball of the next neighbour.
pub const SHELL_OFF: Fault = Fault {
    name: "shell-off",
    summary: "the ball reaches to neighbour k + 1",
    caught_by: "neighbour-moments",
    plant: |subjects| {
        subjects.nearest = Arc::new(Impostor {
            right: subjects.nearest.clone(),
            wrong: built("nearest-neighbour", &[("k", Value::Count(K as u64 + 1))]),
            times: (K as f64 - 1.0) / K as f64,
        });
    },
};

/// 4 r² for π r².
pub const SQUARE_FOR_DISC: Fault = Fault {
    name: "square-for-disc",
    summary: "in the plane the area is that of the square about the disc",
    caught_by: "neighbour-torus",
    plant: |subjects| {
        subjects.plane_nearest = Arc::new(Impostor {
            right: subjects.plane_nearest.clone(),
            wrong: subjects.plane_nearest.clone(),
            times: FRAC_PI_4,
        });
    },
};

/// Distances the long way round.
pub const WRAP_LOST: Fault = Fault {
    name: "neighbour-wrap-lost",
    summary: "distances do not go round the torus",
    caught_by: "neighbours-found",
    plant: |subjects| {
        subjects.neighbours = Arc::new(|sample| {
            let open = Sample::equal(sample.points().to_vec(), Domain::whole());
            open.expect("the same finite points").neighbours()
        });
    },
};

/// Counts from zero.
struct Next(Arc<dyn Neighbours<2>>);

impl Neighbours<2> for Next {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn count(&self) -> usize {
        self.0.count()
    }

    fn metric(&self) -> &Metric<2> {
        self.0.metric()
    }

    fn distance(&self, target: Point<2>, k: usize, scratch: &mut Scratch) -> f64 {
        self.0.distance(target, (k + 1).min(self.count()), scratch)
    }

    fn within(&self, target: Point<2>, squared: f64, show: &mut dyn FnMut(usize, f64)) {
        self.0.within(target, squared, show);
    }
}

/// An index from zero taken for one from one.
pub const NEXT_NEIGHBOUR: Fault = Fault {
    name: "next-neighbour",
    summary: "neighbours are counted from zero",
    caught_by: "neighbours-found",
    plant: |subjects| {
        let right = subjects.neighbours.clone();
        subjects.neighbours = Arc::new(move |sample| Arc::new(Next(right(sample))));
    },
};
