//! What one sample says of the error of its own estimate, without the truth.
//!
//! | estimate of the squared error | what it is an estimate of | needs | file |
//! |---|---|---|---|
//! | halves, batches | the variance; blind to bias | an estimator that is linear in the data | `halves.rs` |
//! | local differences | M⁻¹ × (variance + squared first differences) | a grid in the plane, one width | `differences.rs` |
//!
//! Each is a trait object that can be held against the exact variance and the true error over many samples, which is what the experiments `halves` and `local-error` do.

mod differences;
mod halves;

pub use differences::Differences;
pub use halves::{Halves, Split};

use crate::estimator::{Estimator, FitError};
use crate::sample::Sample;
use crate::space::Targets;

/// Why there is no estimate of the error.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UncertaintyError {
    /// The estimator does not have a property that this way of estimating its error rests on.
    #[error("{0}")]
    Unsuitable(String),
    /// Fitting part of the sample failed.
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// An estimate of the squared error of an estimate, place by place, from the one sample that the estimate itself is from.
pub trait ErrorEstimate<const D: usize>: Send + Sync {
    /// ê²(x) at each of `targets` for the estimate that `estimator` makes of `sample`, in squared units of the estimate.
    ///
    /// # Errors
    /// If the estimator does not allow it, or a part of the sample cannot be fitted.
    fn squared(
        &self,
        estimator: &dyn Estimator<D>,
        sample: &Sample<D>,
        targets: Targets<'_, D>,
    ) -> Result<Vec<f64>, UncertaintyError>;
}
