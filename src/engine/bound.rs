//! How far a sum from moments can be from the definition.

use crate::kernel::{KernelSum, Shape};
use crate::sample::Weights;

/// How many roundings of the ceiling one rounding in each moment may cost, with data at |d| ≤ `half` from the centres.
///
/// The terms of the expansion of a kernel (1 - u²)ˢ exceed the kernel by at most (1 + 2d²)ˢ. Equal weights are counted without
/// error, which leaves only the terms that vanish with d.
pub(super) fn expansion_terms(sum: &KernelSum<1>, half: f64) -> f64 {
    let shape = sum.shape();
    let order = flatness(shape);
    match (shape, sum.sample().weights()) {
        (Shape::Uniform, Weights::Equal(_)) => 0.0,
        (Shape::Cosine, _) => 2.0_f64.sqrt(),
        (_, Weights::Equal(_)) => (2.0 + 3.0_f64.powi(order) * half) * half,
        (_, Weights::Each(_)) => (1.0 + 2.0 * half * half).powi(order) + (2.0 + half) * half,
    }
}

/// Bound on the error, relative to the ceiling, of Σ w K(y - d) from moments that are each a sum in at most `chain` roundings of data
/// at |d| ≤ `half`. About the centres of the cells of the [`Ladder`] the terms exceed the kernel by up to 3ˢ, for which some
/// forty roundings of shifts and values are allowed.
pub(super) fn expansion_error(sum: &KernelSum<1>, half: f64, chain: usize) -> f64 {
    let ladder = 40.0 * 3.0_f64.powi(flatness(sum.shape()));
    0.5 * f64::EPSILON * (expansion_terms(sum, half) * chain as f64 + ladder)
}

/// s, if the kernel vanishes at the ends of its support like (1 - |u|)ˢ.
pub(super) fn flatness(shape: Shape) -> i32 {
    match shape {
        Shape::Uniform => 0,
        Shape::Biweight => 2,
        Shape::Triweight => 3,
        _ => 1,
    }
}
