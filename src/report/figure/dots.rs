//! A dot plot with a few columns of text: numbers near each other, such as the efficiencies of kernels.

use super::legend::{Entry, Swatch};
use super::rows::Rows;
use super::style::{self, Stroke};
use super::{Axis, Svg};
use crate::report::text::{fit, width};

/// One row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dot {
    /// Its name.
    pub name: String,
    /// What theory says, drawn as a diamond.
    pub exact: Option<f64>,
    /// What was measured with its interval: (value, low, high), drawn as a dot.
    pub measured: Option<(f64, f64, f64)>,
    /// Text for the columns at the right, one per heading.
    pub cells: Vec<String>,
}

/// The figure's data. The axis need not start at zero: dots mark positions, not lengths.
#[derive(Clone, Debug, Default)]
pub struct Dots {
    /// Printed at the top; may be empty.
    pub title: String,
    /// What the figure shows, for those who do not see it.
    pub description: String,
    /// The quantity.
    pub axis: Axis,
    /// What the intervals are, such as "95 % interval".
    pub interval: String,
    /// Headings of the columns at the right.
    pub headings: Vec<String>,
    /// The rows, top down.
    pub rows: Vec<Dot>,
}

impl Dots {
    /// The figure.
    pub fn draw(&self) -> Svg {
        let intervals = self.rows.iter().filter_map(|row| row.measured);
        let measured = intervals.flat_map(|(value, low, high)| [value, low, high]);
        let exact = self.rows.iter().filter_map(|row| row.exact);
        let scale = self.axis.scale(exact.chain(measured), 0.06);
        let widths = self.widths();
        let names: Vec<&str> = self.rows.iter().map(|row| row.name.as_str()).collect();
        let rows = Rows::new(
            &self.title,
            self.key(),
            &self.axis,
            scale,
            &names,
            widths.iter().sum(),
        );
        let mut right = rows.frame.right();
        let ends: Vec<f64> = widths
            .iter()
            .map(|width| {
                right += width;
                right
            })
            .collect();
        for (heading, end) in self.headings.iter().zip(&ends) {
            rows.heading(*end, &fit(heading, style::TICK, COLUMN));
        }
        for (index, row) in self.rows.iter().enumerate() {
            dot(&rows, index, row);
            for (cell, end) in row.cells.iter().zip(&ends) {
                rows.cell(index, *end, &fit(cell, style::LABEL, COLUMN));
            }
        }
        rows.canvas.finish(&self.title, &self.description)
    }

    fn key(&self) -> Vec<Entry> {
        let mut key = Vec::new();
        if self.rows.iter().any(|row| row.measured.is_some()) {
            let name = if self.interval.is_empty() {
                "measured".into()
            } else {
                format!("measured, {}", self.interval)
            };
            key.push(Entry {
                swatch: Swatch::Interval(style::colour(0)),
                name,
            });
        }
        if self.rows.iter().any(|row| row.exact.is_some()) {
            key.push(Entry {
                swatch: Swatch::Diamond,
                name: "exact".into(),
            });
        }
        key
    }

    /// Widths of the columns of text.
    fn widths(&self) -> Vec<f64> {
        let column = |(index, heading): (usize, &String)| {
            let cells = self.rows.iter().filter_map(|row| row.cells.get(index));
            let widest = cells
                .map(|cell| width(cell, style::LABEL))
                .fold(width(heading, style::TICK), f64::max);
            widest.min(COLUMN) + 16.0
        };
        self.headings.iter().enumerate().map(column).collect()
    }
}

/// No column is wider.
const COLUMN: f64 = 110.0;

/// One row: theory above the line, measurement below it, so that agreement does not hide either.
fn dot(rows: &Rows, index: usize, row: &Dot) {
    let (canvas, y) = (&rows.canvas, rows.middle(index));
    canvas.line(
        &[(rows.frame.left, y), (rows.frame.right(), y)],
        Stroke::new(style::GRID, 0.75),
    );
    if let Some(exact) = row.exact.filter(|&exact| rows.frame.spans(exact)) {
        canvas.diamond((rows.place(exact), y - 4.5), 3.8, style::INK);
    }
    if let Some((value, low, high)) = row.measured.filter(|measured| rows.frame.spans(measured.0)) {
        let line = Stroke::new(style::colour(0), 1.3);
        if low.is_finite() && high.is_finite() {
            canvas.line(
                &[(rows.place(low), y + 4.5), (rows.place(high), y + 4.5)],
                line,
            );
        }
        canvas.dot((rows.place(value), y + 4.5), 2.8, line.colour, false);
    }
}
