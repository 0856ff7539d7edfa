//! Figures: plain numbers in, print-quality SVG out.
//!
//! One file per kind of figure, each a struct of plain data with a `draw` that cannot fail: whatever the numbers are, a
//! valid picture comes out, with gaps where there is nothing to show. Everything a user named is escaped.
//!
//! | figure | question it answers |
//! |---|---|
//! | [`Curves`] | what do the estimates look like over the truth? |
//! | [`Multiples`] | the same, one small panel per density or estimator |
//! | [`Comparison`] | how large is the error of each, how sure are we, and what is it exactly? |
//! | [`Sweep`] | how do bias² and variance trade against each other as the bandwidth grows? |
//! | [`Modes`] | how often does each estimator show how many modes? |
//! | [`HeatMaps`] | what does a density of the plane, or an error, look like? |
//! | [`Photographs`] | what does a scene look like in the light of each? |
//! | [`Dots`] | how do a few numbers near each other (efficiencies) compare? |
//!
//! Layers, bottom up: `backend` writes SVG for plotters, `canvas` draws on it in pixels and keeps data inside their frame
//! (`path`), `scale` maps values and finds ticks, `legend` keeps names apart, `style` holds colours and type.

mod backend;
mod canvas;
mod colour;
mod comparison;
mod contour;
mod curves;
mod dots;
mod heatmap;
mod legend;
mod levels;
mod modes;
mod multiples;
mod panel;
mod path;
mod photographs;
mod pieces;
mod pixels;
mod rows;
mod scale;
mod style;
mod sweep;

pub use colour::Colours;
pub use comparison::{Comparison, Row};
pub use curves::Curves;
pub use dots::{Dot, Dots};
pub use heatmap::{HeatMaps, Map};
pub use modes::{ModeCounts, Modes};
pub use multiples::{Multiples, Small};
pub use panel::Frame;
pub use photographs::{Photograph, Photographs};
pub use pieces::Piece;
pub use scale::Scale;
pub use sweep::{Measured, Part, Sweep, Trace};

use std::fmt;

#[cfg(test)]
mod tests;

/// A finished drawing. Only this module makes one, so what it holds is known to be well-formed and free of foreign markup.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Svg(String);

impl Svg {
    /// The document.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The same drawing with `markup` on top of it.
    pub(in crate::report) fn with_overlay(&self, markup: &str) -> Self {
        let end = self.0.rfind("</svg>").unwrap_or(self.0.len());
        Self(format!("{}{markup}{}", &self.0[..end], &self.0[end..]))
    }
}

impl fmt::Display for Svg {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

/// The curve through (x, y) as path data for a drawing with this frame, thinned by less than the eye can see. It is not cut at the
/// frame: whoever moves it in a page gives it a viewport that does.
pub(in crate::report) fn line_in_frame(frame: &Frame, x: &[f64], y: &[f64]) -> String {
    panel::path_data(frame, x, y)
}

/// Colour of estimate number `index` as `#rrggbb`.
pub(in crate::report) fn series_colour(index: usize) -> String {
    let plotters::style::RGBColor(red, green, blue) = style::colour(index);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// An axis: its name, its unit and, where the data should not decide, its range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Name of the quantity.
    pub label: String,
    /// Unit, or empty.
    pub unit: String,
    /// Equal steps are equal ratios.
    pub logarithmic: bool,
    /// Ends, if not those of the data.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis over the range of the data.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            logarithmic: false,
            range: None,
        }
    }

    /// The same with equal ratios.
    #[must_use]
    pub fn logarithmic(self) -> Self {
        Self {
            logarithmic: true,
            ..self
        }
    }

    /// The same from `low` to `high`.
    #[must_use]
    pub fn over(self, low: f64, high: f64) -> Self {
        Self {
            range: Some((low, high)),
            ..self
        }
    }

    fn scale(&self, values: impl IntoIterator<Item = f64>, margin: f64) -> Scale {
        match self.range {
            Some((low, high)) if self.logarithmic => Scale::logarithmic(low, high),
            Some((low, high)) => Scale::linear(low, high),
            None => Scale::holding(values, self.logarithmic, margin),
        }
    }
}

/// How a series is drawn. The number of an estimate picks its colour, so one estimator can look the same in every figure.
#[derive(Clone, Debug, PartialEq)]
pub enum Role {
    /// The true density: ink, thicker, lightly filled.
    Truth,
    /// A curve through (x, y).
    Estimate(usize),
    /// A step function: `x` holds the k + 1 edges of k cells, `y` the k heights.
    Steps(usize),
    /// A curve with a band around it: in small panels a mean with one standard deviation on each side.
    Band {
        /// Number of the estimate.
        colour: usize,
        /// Lower edge at each `x`.
        low: Vec<f64>,
        /// Upper edge at each `x`.
        high: Vec<f64>,
    },
}

/// A named curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What the legend calls it.
    pub name: String,
    /// Abscissae, ascending.
    pub x: Vec<f64>,
    /// Values; where one is not finite the curve has a gap.
    pub y: Vec<f64>,
    /// How it is drawn.
    pub role: Role,
}

/// A vertical line with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// What stands over it.
    pub name: String,
    /// Where it is.
    pub at: f64,
}
