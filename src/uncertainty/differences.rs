//! The local error estimate for any estimate of one width.

use super::{ErrorEstimate, UncertaintyError};
use crate::accuracy::LocalError;
use crate::estimator::Estimator;
use crate::kernel::Bandwidth;
use crate::sample::Sample;
use crate::space::{Field, Targets};

/// [`LocalError`] with shifts of half the width of the estimate.
///
/// Needs a grid of square cells in the plane and an estimate of one width: a bandwidth (half a window) or the width of a bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Differences(pub LocalError);

impl ErrorEstimate<2> for Differences {
    fn squared(
        &self,
        estimator: &dyn Estimator<2>,
        sample: &Sample<2>,
        targets: Targets<'_, 2>,
    ) -> Result<Vec<f64>, UncertaintyError> {
        let unsuitable = |what: &str| Err(UncertaintyError::Unsuitable(what.to_owned()));
        let Targets::Grid(grid) = targets else {
            return unsuitable("local differences are taken on a grid");
        };
        let estimate = estimator.fit(sample)?;
        let half = match &estimate.bandwidth {
            Some(Bandwidth::Fixed([h, _])) => *h,
            Some(_) => return unsuitable("local differences compare windows of one size"),
            None => match estimate.smoothing {
                Some(width) => 0.5 * width,
                None => return unsuitable("local differences need the width of the estimate"),
            },
        };
        let shift = (0.5 * half / grid.width(0)).round().max(1.0) as usize;
        let squared = self.0.squared(&estimate.on(grid), shift);
        Ok(squared.into_values())
    }
}

/// On the line there are no windows to shift in several directions; kept to the plane, where the estimate was made for.
impl ErrorEstimate<1> for Differences {
    fn squared(
        &self,
        _estimator: &dyn Estimator<1>,
        _sample: &Sample<1>,
        _targets: Targets<'_, 1>,
    ) -> Result<Vec<f64>, UncertaintyError> {
        Err(UncertaintyError::Unsuitable(
            "local differences are taken in the plane".to_owned(),
        ))
    }
}
