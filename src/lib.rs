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
//! A module uses only modules above it in this list; `tests/architecture.rs` reads the sources and enforces it.
//!
//! | module | what it is |
//! |---|---|
//! | [`numeric`] | one-variable mathematics without data |
//! | [`memory`] | how much of it there is |
//! | [`random`] | named, splittable random streams |
//! | [`storage`] | files that appear whole or not at all |
//! | [`parameter`] | what things chosen by name may be told |
//! | [`document`] | TOML text with every problem located |
//! | [`space`] | points, domains, grids, fields |
//! | [`density`] | known truths |
//! | [`sample`] | weighted points on a domain, and where they come from |
//! | [`accuracy`] | how wrong: distances between fields, and what can be said of them without the truth |
//! | [`neighbour`] | the nearest points of a sample |
//! | [`kernel`] | the bump, its width, and the sum of bumps |
//! | [`theory`] | exact expectations, errors and optima without simulation |
//! | [`engine`] | computing that sum |
//! | [`selector`] | sample → bandwidth |
//! | [`boundary`] | walls |
//! | [`estimator`] | sample → estimate |
//! | [`light`] | photons in rooms, and the hits that they leave |
//! | [`uncertainty`] | what one sample says of its own error |
//! | [`experiment`] | question → table |
//! | [`doctor`] | is the laboratory itself well? |
//! | [`report`] | table → figures and page |
//! | [`cli`] | one file per command |
pub mod accuracy;
pub mod boundary;
pub mod cli;
pub mod density;
pub mod doctor;
pub mod document;
pub mod engine;
pub mod estimator;
pub mod experiment;
pub mod kernel;
pub mod light;
pub mod memory;
pub mod neighbour;
pub mod numeric;
pub mod parameter;
pub mod random;
pub mod report;
pub mod sample;
pub mod selector;
pub mod space;
pub mod storage;
pub mod theory;
pub mod uncertainty;
