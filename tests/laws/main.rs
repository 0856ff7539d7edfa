//! Laws: one suite per trait, run over everything that implements it.
#![allow(clippy::unwrap_used, clippy::float_cmp, missing_docs)]

mod abramson;
mod chance;
mod density;
mod doctor;
mod engine;
mod estimator;
mod misprints;
mod parametric;
mod plane_density;
mod plane_engine;
mod series;
mod theory;
