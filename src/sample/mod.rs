//! Weighted points on a domain: the measure Σ wᵢ δ(xᵢ) that every estimator starts from.
//!
//! For statistics wᵢ = 1/n and the mass is 1; for light wᵢ is flux per *emitted* path and the mass is watts. Estimators do not know the
//! difference. Several channels (colours) share points; the smoothing geometry is always chosen from the total.

mod clustered;
mod drawn;
pub mod file;
mod margin;
mod paths;
mod source;
mod summary;
mod weighted;

pub use clustered::Clustered;
pub use drawn::Drawn;
pub use paths::Paths;
pub use source::{Exposed, Source};
pub use summary::Summary;
pub use weighted::{Sample, SampleError, Weights};
