//! Walls: what to do about the mass that kernels lay beyond the end of a domain.
//!
//! | name | the estimate near a wall | mass | sign | bias at the wall | file |
//! |---|---|---|---|---|---|
//! | ignore | the sum as it is | lost | ≥ 0 | half of f | `ignore.rs` |
//! | virtual-margin | and the bumps of what was registered beyond the wall | O(h²) | ≥ 0 | O(h²) where the density goes on smoothly; half of f where nothing is beyond | `virtual_margin.rs` |
//! | reflect | and the sum over mirrored points | kept | ≥ 0 | O(h), none for a uniform density | `reflect.rs` |
//! | normalise | over the share of the kernel inside, target by target | not kept | ≥ 0 | O(h), none for a uniform density | `normalise.rs` |
//! | normalise-points | each bump over its own share inside | kept | ≥ 0 | O(1) on the wall itself, even for a uniform density | `normalise.rs` |
//! | local-linear | the kernel times the line that restores mass and mean | not kept | any | O(h²), none for a linear density | `local_linear.rs` |
//! | jones-foster | positive mixture of the last and normalise | not kept | ≥ 0 | O(h²) | `local_linear.rs` |
//!
//! Every linear one is defined by its **equivalent kernel** κ: f̂(x) = Σ wᵢ κ(x, Xᵢ) for x in the domain, and zero outside (but for ignore). What
//! [`Boundary::correct`] computes is judged by that, and exact expectations follow from it.
//!
//! # References
//! Silverman 1986, section 2.10 (reflection); Gasser & Müller 1979 (cut and normalise); Lejeune & Sarda 1992; Jones 1993, Simple boundary correction for
//! kernel density estimation (local linear); Jones & Foster 1996 (positive); Walter, Hubbard, Shirley & Greenberg 1997 (local linear on polygons).

mod bump;
mod expectation;
mod ignore;
mod local_linear;
mod moments;
mod nearby;
mod normalise;
mod reflect;
mod virtual_margin;
mod within;
mod wrap;

pub use bump::Bump;
pub use expectation::{corrected_moments, corrected_moments_in_plane};
pub use ignore::Ignore;
pub use local_linear::LocalLinear;
pub use moments::DomainMoments;
pub use normalise::{NormalisePoints, NormaliseTargets};
pub use reflect::Reflect;
pub use virtual_margin::VirtualMargin;
pub use wrap::apply;

use crate::kernel::KernelSum;
use crate::space::{Domain, Field, Point};

/// Computes a kernel sum, by whatever engine.
pub type Compute<'a, const D: usize> = &'a dyn Fn(KernelSum<D>) -> Box<dyn Field<D>>;

/// κ(x, ·) of one target.
pub type Equivalent<'a, const D: usize> = Box<dyn Fn(Point<D>) -> f64 + 'a>;

/// Why a treatment cannot be applied.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct BoundaryError(pub String);

/// What holds on a domain with walls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "a list of independent promises"
)]
pub struct Promises {
    /// The estimate integrates over the domain to the mass of the sample (on boxes; the file says what holds on other polygons).
    pub mass_conserving: bool,
    /// Never below zero.
    pub non_negative: bool,
    /// Linear in the weights.
    pub linear: bool,
    /// Even data give an even estimate; for a linear treatment that is E f̂ = f for a uniform density.
    pub reproduces_constants: bool,
    /// Data on a slope give that slope; for a linear treatment that is E f̂ = f for every linear density.
    pub reproduces_lines: bool,
}

/// A treatment of the walls of a sample's domain.
///
/// A boundary rewrites one kernel sum in terms of others (mirrored points, divided by a mass, a moment-corrected kernel) and has them computed
/// by whoever computes kernel sums, so that engines know nothing of walls and boundaries nothing of engines.
pub trait Boundary<const D: usize>: Send + Sync {
    /// The name in files and tables.
    fn name(&self) -> &'static str;

    /// What holds of every estimate that it corrects.
    fn promises(&self) -> Promises;

    /// The corrected field for `sum`, whose kernel sums are computed by `compute`. On a domain without walls that is the sum itself.
    ///
    /// # Errors
    /// If the bandwidth varies in a way for which the treatment is not defined, or is so wide that the corrected sum would not fit in memory.
    fn correct(
        &self,
        sum: KernelSum<D>,
        compute: Compute<'_, D>,
    ) -> Result<Box<dyn Field<D>>, BoundaryError>;

    /// κ(x, ·) for a target `x` in `domain` and the kernel `bump`; `None` for a treatment that is not linear.
    fn equivalent<'a>(
        &self,
        bump: &'a Bump<D>,
        domain: &'a Domain<D>,
        x: Point<D>,
    ) -> Option<Equivalent<'a, D>>;

    /// Whether points beyond the domain ([`Sample::margin`](crate::sample::Sample::margin)) count with the same κ.
    fn sees_beyond(&self) -> bool {
        false
    }

    /// How many reaches of its kernel away from a target the points may lie that it feels.
    fn reaches(&self, _domain: &Domain<D>) -> f64 {
        1.0
    }
}

/// Every treatment, in the order of the table above; to add one, add a line.
pub fn all<const D: usize>() -> [Box<dyn Boundary<D>>; 7] {
    [
        Box::new(Ignore),
        Box::new(VirtualMargin),
        Box::new(Reflect),
        Box::new(NormaliseTargets),
        Box::new(NormalisePoints),
        Box::new(LocalLinear { positive: false }),
        Box::new(LocalLinear { positive: true }),
    ]
}

/// The names in the order of [`all`].
pub const NAMES: [&str; 7] = [
    "ignore",
    "virtual-margin",
    "reflect",
    "normalise",
    "normalise-points",
    "local-linear",
    "jones-foster",
];

/// What each does, in the order of [`NAMES`].
pub const SUMMARIES: [&str; 7] = [
    "kernels reach through the walls; the estimate at a wall is half of what it should be",
    "points registered beyond the wall reach in: no trace of an edge beyond which the density goes on; nothing else",
    "points are mirrored at the walls: keeps the mass, bias of order h where there is a slope at the wall",
    "the estimate over the share of the kernel inside, target by target: right for a flat density",
    "each bump over its own share inside: keeps the mass, wrong on the wall itself even for a flat density",
    "the kernel times the line that restores mass and mean: right for a linear density, may be negative",
    "the positive mixture of local-linear and normalise: bias of order h squared",
];

/// The treatment of that name.
pub fn named<const D: usize>(name: &str) -> Option<Box<dyn Boundary<D>>> {
    all().into_iter().find(|boundary| boundary.name() == name)
}

/// The one width of `sum`, which a treatment that looks at the walls from the target needs.
fn one_width<const D: usize>(sum: &KernelSum<D>, name: &str) -> Result<Bump<D>, BoundaryError> {
    match sum.fixed() {
        Some(_) => Ok(Bump::of(sum, 0, [0.0; D])),
        None => Err(BoundaryError(format!(
            "the boundary \"{name}\" corrects each target and so needs one bandwidth for all; with bandwidths that vary use reflect or normalise-points"
        ))),
    }
}

#[cfg(test)]
mod tests;
