//! What comes out: figures and the page that shows them.
//!
//! Nothing here computes a statistic. Figures and pages take plain numbers and names, so they can be drawn from a table alone.

pub mod compared;
pub mod figure;
pub mod page;
pub mod paper;
pub mod text;
