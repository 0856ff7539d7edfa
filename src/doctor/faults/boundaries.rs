//! Walls treated wrongly.

use super::Fault;
use crate::boundary::{
    Boundary, BoundaryError, Bump, Compute, Equivalent, Ignore, NormaliseTargets, Promises,
};
use crate::estimator::{Estimate, Estimator, FitError, Laws};
use crate::kernel::KernelSum;
use crate::sample::Sample;
use crate::space::{Domain, Field, Point};
use std::sync::Arc;

/// A half put back without a word.
pub const HALF_LOST: Fault = Fault {
    name: "half-lost",
    summary: "the estimate without treatment does not lose its half at the wall",
    caught_by: "wall-factors",
    plant: |subjects| subjects.ignore = Arc::new(NormaliseTargets),
};

/// A half not put back.
pub const MIRROR_LOST: Fault = Fault {
    name: "mirror-lost",
    summary: "reflection adds no mirrored points",
    caught_by: "wall-mirror",
    plant: |subjects| subjects.reflect = Arc::new(Ignore),
};

/// Mirrors in each wall but not in two at once.
struct OneWallAtATime;

/// A sum seen from the mirror images of a place in each of four walls, one at a time: the same as mirroring points.
struct SeenInMirrors(Domain<2>, Box<dyn Field<2>>);

impl Field<2> for SeenInMirrors {
    fn domain(&self) -> &Domain<2> {
        &self.0
    }

    fn at(&self, x: Point<2>) -> f64 {
        let mut total = self.1.at(x);
        for axis in 0..2 {
            for wall in [self.0.low()[axis], self.0.high()[axis]] {
                let mut image = x;
                image[axis] = 2.0 * wall - x[axis];
                total += self.1.at(image);
            }
        }
        total
    }
}

impl Boundary<2> for OneWallAtATime {
    fn name(&self) -> &'static str {
        "reflect"
    }

    fn promises(&self) -> Promises {
        Boundary::<2>::promises(&crate::boundary::Reflect)
    }

    fn correct(
        &self,
        sum: KernelSum<2>,
        compute: Compute<'_, 2>,
    ) -> Result<Box<dyn Field<2>>, BoundaryError> {
        let domain = sum.domain().clone();
        Ok(Box::new(SeenInMirrors(domain, compute(sum))))
    }

    fn equivalent<'a>(
        &self,
        _bump: &'a Bump<2>,
        _domain: &'a Domain<2>,
        _x: Point<2>,
    ) -> Option<Equivalent<'a, 2>> {
        None
    }
}

/// The doubly mirrored copy.
pub const CORNER_COPY_LOST: Fault = Fault {
    name: "corner-copy-lost",
    summary: "reflection in a corner lacks the copy that is mirrored twice",
    caught_by: "corner-mirror",
    plant: |subjects| subjects.corner = Arc::new(OneWallAtATime),
};

/// The line of local linear.
pub const SLOPE_LOST: Fault = Fault {
    name: "slope-lost",
    summary: "local linear correction restores the mass but not the mean",
    caught_by: "wall-slope",
    plant: |subjects| subjects.linear = Arc::new(NormaliseTargets),
};

/// Takes a ring for a line.
struct Unrolled(Arc<dyn Estimator<1>>);

impl Estimator<1> for Unrolled {
    fn laws(&self) -> Laws {
        self.0.laws()
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let points = sample.points().to_vec();
        let open = Sample::new(points, sample.weights().clone(), Domain::whole());
        self.0.fit(&open.expect("the same finite points"))
    }
}

/// What comes in at the other side.
pub const WRAP_LOST: Fault = Fault {
    name: "wrap-lost",
    summary: "on a ring, what a kernel lays beyond the seam is lost",
    caught_by: "ring",
    plant: |subjects| subjects.kde = Arc::new(Unrolled(subjects.kde.clone())),
};
