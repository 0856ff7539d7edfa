//! How wrong: distances between an estimate and the truth, over one sample and over many.
//!
//! | measure | definition | file |
//! |---|---|---|
//! | ISE | ∫(f̂ - f)² | `errors.rs` |
//! | IAE | ∫\|f̂ - f\| | `errors.rs` |
//! | IRE | ∫((f̂ - f)/f)² where f ≥ 1 % of its peak | `errors.rs` |
//! | energy | ∫f̂ / ∫f | `errors.rs` |
//! | MISE, MIAE, MIRE | their means over samples, with standard errors | `interval.rs` |
//! | medians and shares | of the replicates, with intervals | `interval.rs` |
//! | coverage | how often an interval about an estimate holds its mean, and the truth | `coverage.rs` |
//! | ∫bias², ∫variance | from the pointwise moments of f̂ - f over samples | `tally.rs` |
//! | ê² | an estimate of the squared error at each place from one sample, without the truth | `local.rs` |
//! | M, rank correlation | how well ê² follows e² | `calibration.rs` |
//!
//! All integrals are midpoint sums over the cells of one grid, for simulated and exact values alike, so that the two are
//! expectation and average of the same number.

mod calibration;
pub mod chance;
mod coverage;
mod errors;
mod interval;
mod local;
mod paired;
mod tally;

pub use calibration::{Calibration, rank_correlation};
pub use coverage::{Coverage, coverage_with_bias, reach};
pub use errors::{Errors, RELATIVE_FLOOR, Yardstick};
pub use interval::{
    Interval, fewest_for_median, mean_interval, median_interval, share_interval, sidak,
};
pub use local::{Directions, LocalError};
pub use paired::{Paired, compare, lower_bound};
pub use tally::{Decomposition, Tally};
