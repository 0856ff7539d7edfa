//! The naive estimator: the share of the data within a window around each place.

use super::{
    Build, BuildError, Context, Described, Estimate, Estimator, Family, FitError, Kde, Laws,
    Moments,
};
use crate::density::Density;
use crate::kernel::Shape;
use crate::parameter::{Parameter, Values};
use crate::sample::Sample;
use crate::space::Point;

/// f̂(x) = (mass within h of x) / 2h: a histogram whose bin is centred on each x. [Silverman 1986, eq. 2.1]
///
/// It *is* the kernel estimator with the uniform kernel, and is computed by it. Its window is 2h wide: the histogram that smooths as much
/// has the width 2h.
///
/// In the plane the window is a square (or rectangle) of half width h, or a disc (ellipse) of radius h.
pub struct Naive<const D: usize = 1>(Kde<D>);

impl Estimator<1> for Naive {
    fn laws(&self) -> Laws {
        self.0.laws()
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        self.0.fit(sample)
    }

    fn expectation(
        &self,
        truth: &dyn Density<1>,
        draws: usize,
        places: &[Point<1>],
    ) -> Option<Vec<Moments>> {
        self.0.expectation(truth, draws, places)
    }

    fn family(&self) -> Option<Family> {
        self.0.family()
    }
}

impl Estimator<2> for Naive<2> {
    fn laws(&self) -> Laws {
        self.0.laws()
    }

    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        self.0.fit(sample)
    }

    fn expectation(
        &self,
        truth: &dyn Density<2>,
        draws: usize,
        places: &[Point<2>],
    ) -> Option<Vec<Moments>> {
        self.0.expectation(truth, draws, places)
    }

    fn family(&self) -> Option<Family> {
        self.0.family()
    }
}

impl<const D: usize> Described for Naive<D>
where
    Self: Estimator<D>,
{
    const NAME: &'static str = "naive";
    const SUMMARY: &'static str = "the share of the data within h of each place";
    const COST: &'static str = Kde::<1>::COST;
    const REFERENCE: &'static str = "Rosenblatt 1956; Silverman 1986, eq. 2.1";
    const SMOOTHING: Option<&'static str> = Some("bandwidth");
    const PARAMETERS: &'static [Parameter] = &[
        Parameter {
            help: "h, half the width of the window, in the unit of the data",
            ..super::kde::BANDWIDTH
        },
        super::kde::BANDWIDTH_Y,
        Parameter {
            help: "the window in the plane: a rectangle (product, if not given) or an ellipse (radial)",
            ..super::kde::SYMMETRY
        },
    ];
}

impl Build<1> for Naive {
    fn build(values: &Values, context: &Context<1>) -> Result<Self, BuildError> {
        Ok(Self(Kde::<1>::new(Shape::Uniform, values, context)?))
    }
}

impl Build<2> for Naive<2> {
    fn build(values: &Values, _context: &Context<2>) -> Result<Self, BuildError> {
        Ok(Self(Kde::<2>::new(Shape::Uniform, values)?))
    }
}
