//! Tests of chance: p-values, and what to make of many of them.

pub use density_lab::accuracy::chance::{equally_likely, holm, kolmogorov_smirnov, two_sided};
