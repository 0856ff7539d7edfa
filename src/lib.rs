//! `lab`: a laboratory for density estimators.
//!
//! **A sample is a measure; an estimator turns a measure into a density; an error is a distance between two fields.**
//!
//! ```text
//! density (known truth) ─┐
//! data file ─────────────┴─> Source ─> Sample ─> Estimator ─> Field ──> accuracy (against the truth) ─> tables, figures, report
//!                                                   ^
//!                                   selector, kernel, boundary, engine
//! ```
//!
//! # Order of the modules
//! A module uses only modules above it in this list; a test reads the sources and enforces it.
//!
//! | module | what it is |
//! |---|---|
//! | [`numeric`] | one-variable mathematics without data |
//! | [`space`] | points, domains, grids, fields |
pub mod numeric;
pub mod space;
