//! One measure for several estimators: value, interval and, beside it, what it should be exactly.

use super::legend::{Entry, Swatch};
use super::rows::Rows;
use super::scale::Scale;
use super::style::{self, Stroke};
use super::{Axis, Svg};
use crate::report::text::{Column, width};

/// One estimator.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// Picks its colour.
    pub colour: usize,
    /// The measured value.
    pub value: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end of its interval.
    pub high: f64,
    /// The exact value, if it is known.
    pub exact: Option<f64>,
}

/// Horizontal bars with intervals. Bars start at zero; where the values differ by more than a factor of 30 the axis is
/// logarithmic, on which a bar has no meaning, so that dots take their place.
#[derive(Clone, Debug, Default)]
pub struct Comparison {
    /// Printed at the top; may be empty.
    pub title: String,
    /// What the figure shows, for those who do not see it.
    pub description: String,
    /// The measure.
    pub axis: Axis,
    /// What the intervals are, such as "95 % interval".
    pub interval: String,
    /// The estimators, top down.
    pub rows: Vec<Row>,
}

impl Comparison {
    /// The figure.
    pub fn draw(&self) -> Svg {
        let exact = self.rows.iter().any(|row| row.exact.is_some());
        let scale = self.scale();
        let columns = Columns::new(&self.rows, exact);
        let names: Vec<&str> = self.rows.iter().map(|row| row.name.as_str()).collect();
        let rows = Rows::new(
            &self.title,
            self.key(!scale.is_logarithmic(), exact),
            &self.axis,
            scale,
            &names,
            columns.width(),
        );
        columns.headings(&rows);
        for (index, row) in self.rows.iter().enumerate() {
            bar(&rows, index, row);
            columns.cells(&rows, index, row);
        }
        if !scale.is_logarithmic() && !self.rows.is_empty() {
            let zero = rows.place(0.0);
            rows.canvas.line(
                &[(zero, rows.frame.top), (zero, rows.frame.bottom())],
                Stroke::new(style::INK, 0.9),
            );
        }
        rows.canvas.finish(&self.title, &self.description)
    }

    fn key(&self, bars: bool, exact: bool) -> Vec<Entry> {
        let swatch = if bars {
            Swatch::Bar(style::MUTED)
        } else {
            Swatch::Interval(style::MUTED)
        };
        let name = if self.interval.is_empty() {
            "measured".into()
        } else {
            format!("measured, {}", self.interval)
        };
        let mut key = vec![Entry { swatch, name }];
        if exact {
            key.push(Entry {
                swatch: Swatch::Diamond,
                name: "exact".into(),
            });
        }
        key
    }

    fn scale(&self) -> Scale {
        let values = || {
            let exact = self.rows.iter().filter_map(|row| row.exact);
            self.rows
                .iter()
                .map(|row| row.value)
                .chain(exact)
                .filter(|value| value.is_finite())
        };
        let (least, most) = values().fold((f64::INFINITY, 0.0_f64), |(least, most), value| {
            (least.min(value), most.max(value))
        });
        let wide = least > 0.0 && most > 30.0 * least;
        if let Some((low, high)) = self.axis.range {
            return if self.axis.logarithmic {
                Scale::logarithmic(low, high)
            } else {
                Scale::linear(low, high)
            };
        }
        let ends = self
            .rows
            .iter()
            .flat_map(|row| [row.low, row.high])
            .filter(|end| end.is_finite());
        if wide || self.axis.logarithmic {
            // An interval that reaches down to zero is cut at half the least value.
            return Scale::holding(
                values().chain(ends.map(|end| end.max(0.5 * least))),
                true,
                0.05,
            );
        }
        let (low, high) = Scale::holding(values().chain(ends).chain([0.0]), false, 0.0).ends();
        Scale::linear(if low < 0.0 { low * 1.04 } else { 0.0 }, high * 1.04)
    }
}

/// One row: a bar (a dot on a logarithmic axis), its interval, and the exact value beneath, so that neither hides the other.
fn bar(rows: &Rows, index: usize, row: &Row) {
    let (canvas, scale) = (&rows.canvas, rows.frame.x);
    let bars = !scale.is_logarithmic();
    let y = rows.middle(index);
    let colour = style::colour(row.colour);
    let drawn = |value: f64| value.is_finite() && (value > 0.0 || bars);
    if bars && drawn(row.value) {
        canvas.rectangle(
            (rows.place(0.0), y - 7.0),
            (rows.place(row.value), y + 7.0),
            colour,
            0.45,
        );
    }
    if drawn(row.value) && row.high.is_finite() && !row.low.is_nan() {
        let ends = [row.low.max(scale.ends().0), row.high].map(|end| rows.place(end));
        let whisker = Stroke::new(if bars { style::INK } else { colour }, 1.3);
        canvas.line(&[(ends[0], y), (ends[1], y)], whisker);
        for x in ends {
            canvas.line(&[(x, y - 3.0), (x, y + 3.0)], whisker);
        }
    }
    if !bars && drawn(row.value) {
        canvas.dot((rows.place(row.value), y), 3.2, colour, false);
    }
    if let Some(exact) = row.exact.filter(|&exact| drawn(exact)) {
        canvas.diamond((rows.place(exact), y + 8.0), 3.6, style::INK);
    }
}

/// The numbers at the right of the bars.
struct Columns {
    format: Column,
    /// Widths of the two columns; the second may be absent.
    measured: f64,
    exact: Option<f64>,
}

impl Columns {
    fn new(rows: &[Row], exact: bool) -> Self {
        let numbers = rows
            .iter()
            .flat_map(|row| [Some(row.value), row.exact])
            .flatten();
        let format = Column::of(numbers.map(|value| (value, None)), 3);
        let room = |of: fn(&Row) -> f64| {
            let widths = rows
                .iter()
                .map(|row| width(&format.print(of(row)), style::LABEL));
            widths.fold(
                width(&format!("measured{}", format.scale()), style::TICK),
                f64::max,
            ) + 16.0
        };
        let exact = exact.then(|| room(|row| row.exact.unwrap_or(0.0)));
        Self {
            format,
            measured: room(|row| row.value),
            exact,
        }
    }

    fn width(&self) -> f64 {
        self.measured + self.exact.unwrap_or(0.0)
    }

    fn headings(&self, rows: &Rows) {
        let scale = self.format.scale();
        let right = rows.frame.right();
        rows.heading(right + self.measured, &format!("measured{scale}"));
        if self.exact.is_some() {
            rows.heading(right + self.width(), &format!("exact{scale}"));
        }
    }

    fn cells(&self, rows: &Rows, index: usize, row: &Row) {
        let right = rows.frame.right();
        rows.cell(index, right + self.measured, &self.format.print(row.value));
        if let Some(value) = row.exact {
            rows.cell(index, right + self.width(), &self.format.print(value));
        }
    }
}
