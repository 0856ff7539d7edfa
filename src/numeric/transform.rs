//! Plans for the transforms of real numbers, made once for each length.
//!
//! A plan holds the roots of unity of its length, which cost more than a transform. Plans are kept for good: lengths are few, since all who transform choose smooth
//! ones, and a plan is about as large as what it transforms.

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

static PLANNER: LazyLock<Mutex<RealFftPlanner<f64>>> =
    LazyLock::new(|| Mutex::new(RealFftPlanner::new()));

/// From `length` real numbers to their spectrum, unscaled.
pub fn forward_transform(length: usize) -> Arc<dyn RealToComplex<f64>> {
    let mut planner = PLANNER.lock().unwrap_or_else(PoisonError::into_inner);
    planner.plan_fft_forward(length)
}

/// From a spectrum to `length` real numbers, unscaled.
pub fn inverse_transform(length: usize) -> Arc<dyn ComplexToReal<f64>> {
    let mut planner = PLANNER.lock().unwrap_or_else(PoisonError::into_inner);
    planner.plan_fft_inverse(length)
}
