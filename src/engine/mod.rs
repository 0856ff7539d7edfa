//! Computing a kernel sum. An engine changes what a result costs, never what it means.
//!
//! The [`KernelSum`] itself is the definition; [`Direct`] evaluates it as written and judges the others, each of which states its error
//! bound before it starts. [`plan()`] asks all for a quote and takes the cheapest within the tolerance.
//!
//! | engine | sums | targets | error (relative to the ceiling) | cost | file |
//! |---|---|---|---|---|---|
//! | direct | any | any | rounding | n·m | `direct.rs` |
//! | interval | compact kernels, fixed width, a line | a grid | rounding | n + m | `interval/` |
//! | sorted | compact kernels, fixed width, a line | any | rounding | n log n + m | `sorted.rs` |
//! | binned | Gaussian, fixed width, a line | a grid | as asked, to about 1e-8 of the peak | n + nodes | `binned/` |
//! | relay | Gaussian, fixed width, a line | a grid | 1e-12 of the peak or as asked | n + m | `relay/` |
//! | scatter | any kernel, widths that do not depend on the target, a line | any | rounding | n log m + m, or n · targets in a window | `scatter.rs` |
//! | gather, splat, mesh, hermite, binned | the plane, see [`plane`] | | | | `plane/` |
//! | hermite | Gaussian, fixed width, a line | any | 1e-12 of the peak or as asked | n + m | `hermite/` |
//!
//! Double sums over all pairs of data, which criteria for bandwidths are made of, are in `pairs/`.

mod basis;
mod binned;
mod bound;
mod direct;
mod hermite;
mod interval;
mod ladder;
mod pairs;
mod pieces;
mod plan;
pub mod plane;
mod recent;
mod relay;
mod scatter;
mod sorted;

pub use binned::Binned;
pub use direct::Direct;
pub use hermite::Hermite;
pub use interval::Interval;
pub use pairs::{CompactPairs, GaussianPairs};
pub use plan::{LINE, Plan, PlanError, Planned, Verdict, plan};
pub use plane::{BinnedGrid, Gather, HermiteGrid, Mesh, PLANE, PlanePairs, Splat};
pub use relay::Relay;
pub use scatter::Scatter;
pub use sorted::Sorted;

use crate::kernel::{KernelSum, Shape};
use crate::space::{Field, Targets};

/// "Exact": as far as an engine may be from the definition and still count as computing the same number, relative to the ceiling of
/// the sum, mass × K(0) / h.
pub const EXACT: f64 = 1e-12;

/// What an engine promises for a sum on given targets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quote {
    /// Bound on the error of each value, relative to the ceiling mass × K(0) / h.
    pub error: f64,
    /// Expected time in nanoseconds on one thread, from per-item constants measured once; only good for choosing.
    pub nanoseconds: f64,
}

/// An engine's "not I", with the reason.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unsupported(pub String);

/// The one width of a Gaussian sum, for an engine that knows no other sums.
fn gaussian_width<const D: usize>(
    sum: &KernelSum<D>,
    engine: &str,
) -> Result<[f64; D], Unsupported> {
    if sum.shape() != Shape::Gaussian {
        return Err(Unsupported(format!(
            "{engine} is for the Gaussian kernel, not the {} one",
            sum.shape()
        )));
    }
    sum.fixed().ok_or_else(|| {
        Unsupported(format!(
            "{engine} needs one bandwidth for all points and targets"
        ))
    })
}

/// One way to compute a kernel sum.
pub trait Engine<const D: usize>: Send + Sync {
    /// The name in files and tables.
    fn name(&self) -> &'static str;

    /// What it would cost and how exact it would be, without doing any work on the data beyond what the sample knows already. On a line, with one width and a grid, that is
    /// how many points there are and whether they have weights: such plans are kept and used for other data.
    /// `tolerance` is the error that the caller allows; an engine with a choice takes the cheapest setting within it, or its best.
    ///
    /// # Errors
    /// If it cannot compute this sum on these targets at all.
    fn quote(
        &self,
        sum: &KernelSum<D>,
        targets: Targets<'_, D>,
        tolerance: f64,
    ) -> Result<Quote, Unsupported>;

    /// Does the work that is shared by all targets (sorting, binning) and gives the field that serves them, whose answers carry
    /// the error bound and warnings.
    ///
    /// # Errors
    /// If it cannot compute this sum.
    fn prepare(&self, sum: KernelSum<D>, tolerance: f64) -> Result<Box<dyn Field<D>>, Unsupported>;
}
