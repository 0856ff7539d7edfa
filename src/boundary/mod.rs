//! Walls: what to do about the mass that kernels lay beyond the end of a domain.

mod ignore;

pub use ignore::Ignore;

use crate::kernel::KernelSum;
use crate::space::Field;

/// A treatment of the walls of a sample's domain.
///
/// A boundary rewrites one kernel sum in terms of others (mirrored points, divided by a mass, a moment-corrected kernel) and has them computed
/// by whoever computes kernel sums, so that engines know nothing of walls and boundaries nothing of engines.
pub trait Boundary<const D: usize>: Send + Sync {
    /// The name in files and tables.
    fn name(&self) -> &'static str;

    /// The corrected field for `sum`, whose kernel sums are computed by `compute`.
    fn correct(
        &self,
        sum: KernelSum<D>,
        compute: &dyn Fn(KernelSum<D>) -> Box<dyn Field<D>>,
    ) -> Box<dyn Field<D>>;
}
