//! Sums over all pairs of data: what every criterion for a bandwidth is made of.
//!
//! | sum | definition | cost at one bandwidth | file |
//! |---|---|---|---|
//! | [`GaussianPairs`] | Σᵢⱼ wᵢwⱼ φ⁽ʳ⁾((Xᵢ - Xⱼ)/g), any even r | O(g / step), whatever n | `gaussian.rs`, `lattice.rs` |
//! | [`CompactPairs`] | Σᵢⱼ wᵢwⱼ (K∗K)((Xᵢ - Xⱼ)/h) and the same with K | O(n), data sorted once | `compact.rs`, `convolution.rs` |
//!
//! Weights sum to 1 and i = j is included: with equal weights these are V-statistics, in which a point of weight k/n counts as k points do.

mod compact;
pub(super) mod convolution;
mod gaussian;
mod lattice;

pub use compact::CompactPairs;
pub use gaussian::GaussianPairs;
