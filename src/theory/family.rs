//! Families of estimates that differ in how much they smooth, and the member that is best.

use super::{Asymptotic, HistogramError, KernelError, NoAsymptotics, Optimum, kernel_oracle};
use crate::density::{Density, Univariate};
use crate::kernel::{Kernel, Shape};

/// All that an estimator is but for its bandwidth or width, where the exact error of each member is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Family {
    /// Kernel estimates, by bandwidth.
    Kernel(Shape),
    /// Means of so many histograms (of one, the histogram), by the width of a bin.
    ShiftedHistogram {
        /// How many.
        shifts: u32,
        /// An edge of a bin of the first.
        origin: f64,
    },
    /// Straight lines between the middles of a histogram's bars, by the width of a bin.
    FrequencyPolygon {
        /// An edge of a bin.
        origin: f64,
    },
}

impl Family {
    /// The member of least MISE over the whole line for samples of `draws` points from `truth`, and all other local minima. Cost: some hundred evaluations of
    /// the error, which are microseconds to milliseconds each.
    pub fn optimum(self, truth: &dyn Univariate, draws: f64) -> Optimum {
        match self {
            Self::Kernel(shape) => KernelError::new(truth, shape).optimum(draws),
            Self::ShiftedHistogram { shifts, origin } => {
                HistogramError::shifted(truth, origin, shifts).optimum(draws)
            }
            Self::FrequencyPolygon { origin } => {
                HistogramError::polygon(truth, origin).optimum(draws)
            }
        }
    }

    /// The same for a density on a line or in the plane; `None` where the exact error is not known.
    pub fn optimum_of<const D: usize>(self, truth: &dyn Density<D>, draws: f64) -> Option<Optimum> {
        if let Some(line) = truth.univariate() {
            return Some(self.optimum(line, draws));
        }
        match self {
            Self::Kernel(shape) => kernel_oracle(truth, shape, draws).map(|oracle| oracle.optimum),
            _ => None,
        }
    }

    /// The leading terms for large samples.
    ///
    /// # Errors
    /// If the density is not smooth enough to have them.
    pub fn asymptotic(
        self,
        truth: &dyn Univariate,
        draws: f64,
    ) -> Result<Asymptotic, NoAsymptotics> {
        match self {
            Self::Kernel(shape) => Asymptotic::of_kernel(
                shape.variance(),
                shape.roughness(),
                truth.roughness(2),
                draws,
            ),
            Self::ShiftedHistogram { shifts, origin } => {
                HistogramError::shifted(truth, origin, shifts).asymptotic(draws)
            }
            Self::FrequencyPolygon { origin } => {
                HistogramError::polygon(truth, origin).asymptotic(draws)
            }
        }
    }
}
