//! Adaptive kernel estimates: wide bumps where the data are thin, narrow ones where they are dense.
//!
//! A width can belong to the datum or to the target, and the two are different estimators, not options of one.
//!
//! - **Sample point** ([`Abramson`]): f̂(x) = Σ wᵢ K((x - Xᵢ)/hᵢ)/hᵢ. Each bump keeps the mass of its datum, the sum is a density, and with hᵢ ∝ f(Xᵢ)^(-1/2) the bias
//!   is of order h⁴ instead of h².
//! - **Balloon**: f̂(x) = Σ wᵢ K((x - Xᵢ)/h(x))/h(x). At each place it is a fixed-width estimate, with the bias of one; over all places the mass is not kept, and the tails
//!   can be so heavy that it is infinite. The nearest-neighbour estimators are of this kind.
//!
//! # References
//! Abramson 1982, Annals of Statistics 10; Terrell & Scott 1992, Annals of Statistics 20; Silverman 1986, section 5.3.

mod abramson;
mod plane;

pub use abramson::Abramson;
