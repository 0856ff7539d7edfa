//! What comes out: figures and the page that shows them.
//!
//! Figures and pages compute no statistic: they take plain numbers and names, so they can be drawn from a table alone. What is wrong in pictures is
//! found in [`compared`], and estimates that are shown are made again in [`paper`].

pub mod compared;
pub mod figure;
pub mod page;
pub mod paper;
pub mod text;
