//! Estimators that are nearly right.

use super::Fault;
use crate::density::Density;
use crate::doctor::subjects::{H, WIDTH, built};
use crate::estimator::{Estimate, Estimator, FitError, Laws, Moments};
use crate::parameter::Value;
use crate::sample::{Sample, Weights};
use crate::space::{Domain, Field, Point};
use std::sync::Arc;

/// An estimator that is given another sample, whose estimate is asked at another place and multiplied.
struct Spoilt<const D: usize> {
    good: Arc<dyn Estimator<D>>,
    sample: fn(&Sample<D>) -> Sample<D>,
    place: fn(Point<D>) -> Point<D>,
    times: fn(usize) -> f64,
}

struct SpoiltField<const D: usize> {
    good: Estimate<D>,
    place: fn(Point<D>) -> Point<D>,
    times: f64,
}

impl<const D: usize> Field<D> for SpoiltField<D> {
    fn domain(&self) -> &Domain<D> {
        self.good.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        self.times * self.good.at((self.place)(x))
    }
}

impl<const D: usize> Estimator<D> for Spoilt<D> {
    fn laws(&self) -> Laws {
        self.good.laws()
    }

    fn fit(&self, sample: &Sample<D>) -> Result<Estimate<D>, FitError> {
        Ok(Estimate::new(Arc::new(SpoiltField {
            good: self.good.fit(&(self.sample)(sample))?,
            place: self.place,
            times: (self.times)(sample.len()),
        })))
    }

    fn expectation(
        &self,
        truth: &dyn Density<D>,
        draws: usize,
        places: &[Point<D>],
    ) -> Option<Vec<Moments>> {
        // the theory is right, the estimate is not
        self.good.expectation(truth, draws, places)
    }
}

impl<const D: usize> Spoilt<D> {
    fn of(good: &Arc<dyn Estimator<D>>) -> Self {
        Self {
            good: good.clone(),
            sample: Sample::clone,
            place: |x| x,
            times: |_| 1.0,
        }
    }
}

/// One percent.
pub const ONE_PERCENT: Fault = Fault {
    name: "one-percent",
    summary: "a kernel estimate is 1 % too high",
    caught_by: "estimate-mean",
    plant: |subjects| {
        subjects.kde = Arc::new(Spoilt {
            times: |_| 1.01,
            ..Spoilt::of(&subjects.kde)
        });
    },
};

/// Three percent in the plane.
pub const PLANE_TWO_PERCENT: Fault = Fault {
    name: "plane-three-percent",
    summary: "a kernel estimate in the plane is 3 % too high",
    caught_by: "plane-estimate-mean",
    plant: |subjects| {
        subjects.plane_kde = Arc::new(Spoilt {
            times: |_| 1.03,
            ..Spoilt::of(&subjects.plane_kde)
        });
    },
};

/// The theory of another bandwidth.
struct Wide {
    wide: Arc<dyn Estimator<1>>,
    right: Arc<dyn Estimator<1>>,
}

impl Estimator<1> for Wide {
    fn laws(&self) -> Laws {
        self.wide.laws()
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        self.wide.fit(sample)
    }

    fn expectation(
        &self,
        truth: &dyn Density<1>,
        draws: usize,
        places: &[Point<1>],
    ) -> Option<Vec<Moments>> {
        self.right.expectation(truth, draws, places)
    }
}

/// A bandwidth rounded.
pub const BANDWIDTH_OFF: Fault = Fault {
    name: "bandwidth-off",
    summary: "the bandwidth used is 5 % wider than the one asked for",
    caught_by: "estimate-mean",
    plant: |subjects| {
        subjects.kde = Arc::new(Wide {
            wide: built("kernel", &[("bandwidth", Value::Number(1.05 * H))]),
            right: subjects.kde.clone(),
        });
    },
};

/// Right on average, and twice as noisy.
pub const EVERY_OTHER_POINT: Fault = Fault {
    name: "every-other-point",
    summary: "only every other point is used: right on average, twice the variance",
    caught_by: "estimate-variance",
    plant: |subjects| {
        subjects.kde = Arc::new(Spoilt {
            sample: |sample| {
                let part = sample.part(|i| i % 2 == 0, 1.0);
                part.and_then(|part| part.part(|_| true, sample.mass() / part.mass()))
                    .unwrap_or_else(|| sample.clone())
            },
            ..Spoilt::of(&subjects.kde)
        });
    },
};

/// The bare points.
pub const WEIGHTS_IGNORED: Fault = Fault {
    name: "weights-ignored",
    summary: "all points count the same",
    caught_by: "weights",
    plant: |subjects| {
        subjects.kde = Arc::new(Spoilt {
            sample: |sample| {
                let each = sample.mass() / sample.len() as f64;
                let points = sample.points().to_vec();
                Sample::new(points, Weights::Equal(each), sample.domain().clone())
                    .expect("the same points")
            },
            ..Spoilt::of(&subjects.kde)
        });
    },
};

/// N is the number of paths, not of hits.
pub const HITS_FOR_PATHS: Fault = Fault {
    name: "hits-for-paths",
    summary: "flux is divided by the number of hits, not of emitted paths",
    caught_by: "flux",
    plant: |subjects| {
        subjects.kde = Arc::new(Spoilt {
            sample: |sample| {
                let points = sample.points().to_vec();
                Sample::equal(points, sample.domain().clone()).expect("the same points")
            },
            ..Spoilt::of(&subjects.kde)
        });
    },
};

/// Rounding where flooring is meant.
pub const BIN_EDGE_OFF: Fault = Fault {
    name: "bin-edge-off",
    summary: "bins are centred on multiples of the width instead of beginning there",
    caught_by: "histogram-counts",
    plant: |subjects| {
        subjects.histogram = Arc::new(Spoilt {
            place: |[x]| [x + 0.5 * WIDTH],
            ..Spoilt::of(&subjects.histogram)
        });
    },
};

/// A correction that is for variances.
pub const POINTS_LESS_ONE: Fault = Fault {
    name: "points-less-one",
    summary: "counts are divided by n - 1",
    caught_by: "histogram-counts",
    plant: |subjects| {
        subjects.histogram = Arc::new(Spoilt {
            times: |n| n as f64 / (n as f64 - 1.0),
            ..Spoilt::of(&subjects.histogram)
        });
    },
};
