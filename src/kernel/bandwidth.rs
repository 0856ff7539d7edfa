//! How far a kernel is stretched, and by what rule it varies.

use crate::space::{Field, Point};
use std::sync::Arc;

/// The h of f̂(x) = Σ wᵢ K((x - Xᵢ)/h) / hᵈ.
///
/// The three kinds are different estimators, not options of one: a width that belongs to the data point keeps mass
/// (each bump integrates to its weight), a width that belongs to the target does not.
#[derive(Clone)]
pub enum Bandwidth<const D: usize> {
    /// The same for all, one number an axis.
    Fixed([f64; D]),
    /// One for each data point, in their order (sample-point estimators).
    PerPoint(Arc<[f64]>),
    /// One for each target (balloon estimators).
    PerTarget(Arc<dyn Field<D>>),
}

impl<const D: usize> Bandwidth<D> {
    /// The widths that data point `i` and target `x` see.
    pub fn between(&self, i: usize, x: Point<D>) -> [f64; D] {
        match self {
            Self::Fixed(h) => *h,
            Self::PerPoint(h) => [h[i]; D],
            Self::PerTarget(h) => [h.at(x); D],
        }
    }
}

impl<const D: usize> std::fmt::Debug for Bandwidth<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Fixed(h) => f.debug_tuple("Fixed").field(h).finish(),
            Self::PerPoint(h) => f.debug_tuple("PerPoint").field(&h.len()).finish(),
            Self::PerTarget(_) => f.write_str("PerTarget(..)"),
        }
    }
}
