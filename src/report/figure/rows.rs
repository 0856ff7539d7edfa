//! What figures with one named row per estimator share: a key, names at the left, a value axis below, numbers at the right.

use super::Axis;
use super::canvas::{Canvas, Hang, MARGIN, Type};
use super::curves::{WIDTH, nothing};
use super::legend::{Entry, Legend};
use super::panel::{Frame, overhang, title};
use super::scale::Scale;
use super::style::{self, Stroke};
use crate::report::text::{fit, width};

const ROW: f64 = 26.0;

/// A sheet with the rows set out and nothing in them yet.
pub(super) struct Rows {
    pub canvas: Canvas,
    pub frame: Frame,
}

impl Rows {
    /// Rows called `names`, leaving `right` free for numbers.
    pub fn new(
        heading: &str,
        key: Vec<Entry>,
        axis: &Axis,
        scale: Scale,
        names: &[&str],
        right: f64,
    ) -> Self {
        let longest = names
            .iter()
            .map(|name| width(name, style::LABEL))
            .fold(0.0, f64::max);
        let longest = longest.min(200.0);
        let legend = Legend::new(key, WIDTH - 2.0 * MARGIN);
        let below_title = Canvas::new(WIDTH, 1.0).title(heading, WIDTH - 2.0 * MARGIN);
        let left = MARGIN + longest + 12.0;
        // Labels at the ends of the axis reach beyond it.
        let beyond = overhang(scale, 400.0);
        let left = left.max(beyond.0 + 4.0);
        let right = right.max(beyond.1 - 4.0);
        let top = below_title + legend.height() + 18.0;
        let across = (WIDTH - left - MARGIN - right).max(160.0);
        let height = ROW * names.len().max(1) as f64 + 4.0;
        let canvas = Canvas::new(WIDTH, top + height + 42.0);
        canvas.title(heading, WIDTH - 2.0 * MARGIN);
        legend.draw(&canvas, (MARGIN, below_title));

        let panel = canvas.panel(
            (left, top),
            (across, height),
            scale,
            Scale::linear(0.0, 1.0),
        );
        let frame = panel.frame;
        let ticks = scale.ticks(across, true);
        for &(value, _) in &ticks.major {
            let x = frame.across(value);
            canvas.line(
                &[(x, top), (x, top + height)],
                Stroke::new(style::GRID, 0.75),
            );
        }
        panel.labels_below(&ticks, 0.0);
        let text = fit(&title(axis, &ticks), style::LABEL, across + 40.0);
        let below = (left + 0.5 * across, top + height + 30.0);
        canvas.text(
            below,
            &text,
            Type::new(style::LABEL, style::INK, Hang::Middle),
        );
        if names.is_empty() {
            nothing(&canvas, &frame);
        }
        let rows = Self { canvas, frame };
        for (index, name) in names.iter().enumerate() {
            let name = fit(name, style::LABEL, longest);
            let kind = Type::new(style::LABEL, style::INK, Hang::Right);
            rows.canvas
                .text((left - 10.0, rows.middle(index)), &name, kind);
        }
        rows
    }

    /// Height of the middle of a row.
    pub fn middle(&self, index: usize) -> f64 {
        self.frame.top + 2.0 + ROW * (index as f64 + 0.5)
    }

    /// Horizontal place of a value, moved to the edge of the frame where it lies outside.
    pub fn place(&self, value: f64) -> f64 {
        self.frame.left + self.frame.x.place(value).clamp(0.0, 1.0) * self.frame.width
    }

    /// A heading over numbers that end at `right`.
    pub fn heading(&self, right: f64, text: &str) {
        let kind = Type::new(style::TICK, style::MUTED, Hang::Right);
        self.canvas.text((right, self.frame.top - 9.0), text, kind);
    }

    /// A number, or other text, of row `index` that ends at `right`.
    pub fn cell(&self, index: usize, right: f64, text: &str) {
        let kind = Type::new(style::LABEL, style::INK, Hang::Right);
        self.canvas.text((right, self.middle(index)), text, kind);
    }
}
