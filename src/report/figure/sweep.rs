//! Error against bandwidth: exact curves, Monte Carlo intervals around them, and the bandwidths that have a name.

use super::canvas::{Canvas, MARGIN};
use super::curves::{WIDTH, nothing};
use super::legend::{End, Entry, Legend, Markers, Swatch, label_ends};
use super::panel::{Frame, overhang, room_left};
use super::scale::Scale;
use super::style::{self, Stroke};
use super::{Axis, Marker, Svg};
use crate::report::text::{fit_with, width};
use plotters::style::RGBColor;

/// Which part of the error a trace is; picks its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// MISE: the whole.
    Total,
    /// Integrated squared bias.
    Bias,
    /// Integrated variance.
    Variance,
    /// Something else, with the colour of this estimate.
    Other(usize),
}

/// A measured value with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Bandwidth.
    pub at: f64,
    /// Mean over the replicates.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// One part of the error over the swept bandwidths.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// What stands at its end.
    pub name: String,
    /// Which part it is.
    pub part: Part,
    /// Exact values as (bandwidth, value), if they are known.
    pub exact: Vec<(f64, f64)>,
    /// Monte Carlo values, if there were replicates.
    pub measured: Vec<Measured>,
}

/// The figure's data.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// Printed at the top; may be empty.
    pub title: String,
    /// What the figure shows, for those who do not see it.
    pub description: String,
    /// The bandwidth.
    pub x: Axis,
    /// The error.
    pub y: Axis,
    /// The parts of the error.
    pub traces: Vec<Trace>,
    /// What the intervals are, such as "95 % interval of 400 replicates".
    pub interval: String,
    /// Bandwidths with a name.
    pub markers: Vec<Marker>,
    /// Minima of the exact total, the global one first.
    pub minima: Vec<(f64, f64)>,
}

const HEIGHT: f64 = 320.0;
/// What the names beside the ends of curves may take of the width, and what of that leads to a name.
const LABELS: f64 = 220.0;
const LEADER: f64 = 26.0;

/// How many times lower than its upper end an interval is cut that reaches zero.
const CUT: f64 = 30.0;

fn stroke(part: Part) -> Stroke {
    let colour: RGBColor = match part {
        Part::Total => style::INK,
        Part::Bias => style::colour(0),
        Part::Variance => style::colour(1),
        Part::Other(index) => return style::series(index),
    };
    Stroke::new(
        colour,
        if part == Part::Total {
            2.0
        } else {
            style::LINE
        },
    )
}

/// Whether an interval reaches zero, which a logarithmic axis does not.
fn reaches_zero(measured: &Measured, y: Scale) -> bool {
    measured.low <= 0.0 && y.is_logarithmic()
}

/// Where an interval is drawn to end below: one that reaches zero on a logarithmic axis is cut, lest it fill the figure.
fn foot(measured: &Measured, y: Scale) -> f64 {
    if reaches_zero(measured, y) {
        (measured.high / CUT).max(y.ends().0)
    } else {
        measured.low
    }
}

/// Where a trace can be seen to end.
fn end(trace: &Trace, y: Scale) -> Option<End> {
    let visible = |end: &(f64, f64)| y.place(end.1).is_finite();
    let measured: Vec<(f64, f64)> = trace.measured.iter().map(|m| (m.at, m.value)).collect();
    let at = *trace
        .exact
        .iter()
        .rfind(|end| visible(end))
        .or_else(|| measured.iter().rfind(|end| visible(end)))?;
    Some(End {
        at,
        name: trace.name.clone(),
        stroke: stroke(trace.part),
    })
}

impl Sweep {
    /// The figure.
    pub fn draw(&self) -> Svg {
        self.draw_in_frame().0
    }

    /// The name of a trace with a value that stays readable where the name is too long.
    pub fn name_with(name: &str, value: &str) -> String {
        let room = LABELS - LEADER;
        fit_with(name, &format!(", {value}"), style::LABEL, room)
    }

    /// The figure and where its frame lies.
    pub fn draw_in_frame(&self) -> (Svg, Frame) {
        let (x, y) = self.scales();
        let left = room_left(y, HEIGHT, true);
        let mut frame = Frame {
            left,
            top: 0.0,
            width: WIDTH - left - 16.0_f64.max(overhang(x, WIDTH - left).1 + 4.0),
            height: HEIGHT,
            x,
            y,
        };
        let labels = self
            .traces
            .iter()
            .map(|trace| width(&trace.name, style::LABEL) + LEADER)
            .fold(0.0, f64::max)
            .min(LABELS);
        frame.width -= labels
            .max(Markers::overhang(&self.markers, frame))
            .min(LABELS);
        let markers = Markers::new(&self.markers, frame, WIDTH - 4.0);
        let legend = Legend::new(self.key(), WIDTH - 2.0 * MARGIN);
        let heading = Canvas::new(WIDTH, 1.0).title(&self.title, WIDTH - 2.0 * MARGIN);
        frame.top = heading + legend.height() + markers.height() + 6.0;

        let canvas = Canvas::new(WIDTH, frame.bottom() + 42.0);
        canvas.title(&self.title, WIDTH - 2.0 * MARGIN);
        legend.draw(&canvas, (MARGIN, heading));
        let panel = canvas.panel((frame.left, frame.top), (frame.width, frame.height), x, y);
        panel.axes(&self.x, &self.y, 0.0);
        markers.draw(&canvas, panel.frame);
        for trace in &self.traces {
            let column =
                |of: fn(&Measured) -> f64| -> Vec<f64> { trace.measured.iter().map(of).collect() };
            let low: Vec<f64> = trace.measured.iter().map(|m| foot(m, y)).collect();
            panel.band(
                &column(|m| m.at),
                &low,
                &column(|m| m.high),
                stroke(trace.part).colour,
                style::BAND,
            );
        }
        for trace in &self.traces {
            let line = stroke(trace.part);
            panel.line(trace.exact.iter().copied(), line);
            if trace.exact.is_empty() {
                panel.line(
                    trace.measured.iter().map(|m| (m.at, m.value)),
                    Stroke { width: 1.0, ..line },
                );
            }
            for measured in &trace.measured {
                let low = foot(measured, y);
                panel.line(
                    [(measured.at, low), (measured.at, measured.high)],
                    Stroke::new(line.colour, 1.1),
                );
                panel.mark((measured.at, measured.value), |canvas, place| {
                    canvas.dot(place, 2.2, line.colour, false);
                });
            }
        }
        for (index, &minimum) in self.minima.iter().enumerate() {
            panel.mark(minimum, |canvas, place| {
                canvas.dot(place, 4.0, style::INK, index > 0);
            });
        }
        let ends: Vec<End> = self
            .traces
            .iter()
            .filter_map(|trace| end(trace, y))
            .collect();
        label_ends(&panel, &canvas, &ends, labels);
        if ends.is_empty() {
            nothing(&canvas, &panel.frame);
        }
        let frame = panel.frame;
        (canvas.finish(&self.title, &self.description), frame)
    }

    /// The axes: they hold the curves, and markers that are not far off.
    fn scales(&self) -> (Scale, Scale) {
        let abscissae = || {
            self.traces.iter().flat_map(|t| {
                t.exact
                    .iter()
                    .map(|p| p.0)
                    .chain(t.measured.iter().map(|m| m.at))
            })
        };
        let x = self.x.scale(abscissae(), 0.0);
        let x = if self.x.range.is_some() {
            x
        } else {
            let near = self
                .markers
                .iter()
                .map(|marker| marker.at)
                .filter(|&at| (-0.12..=1.12).contains(&x.place(at)));
            self.x.scale(abscissae().chain(near), 0.02)
        };
        // Values only: an interval that reaches down to zero would stretch a logarithmic axis without end.
        let values = self.traces.iter().flat_map(|t| {
            t.exact
                .iter()
                .map(|p| p.1)
                .chain(t.measured.iter().flat_map(|m| [m.value, m.high]))
        });
        (x, self.y.scale(values, 0.04))
    }

    fn key(&self) -> Vec<Entry> {
        let mut key = Vec::new();
        if self.traces.iter().any(|trace| !trace.exact.is_empty()) {
            key.push(Entry {
                swatch: Swatch::Line(Stroke::new(style::INK, 2.0)),
                name: "exact".into(),
            });
        }
        if self.traces.iter().any(|trace| !trace.measured.is_empty()) {
            let name = if self.interval.is_empty() {
                "Monte Carlo mean".into()
            } else {
                let y = self.scales().1;
                let cut = self
                    .traces
                    .iter()
                    .any(|trace| trace.measured.iter().any(|m| reaches_zero(m, y)));
                let note = if cut { ", cut where it reaches 0" } else { "" };
                format!("Monte Carlo mean, {}{note}", self.interval)
            };
            key.push(Entry {
                swatch: Swatch::Interval(style::INK),
                name,
            });
        }
        if !self.minima.is_empty() {
            key.push(Entry {
                swatch: Swatch::Disc,
                name: "least error".into(),
            });
        }
        if self.minima.len() > 1 {
            key.push(Entry {
                swatch: Swatch::Ring,
                name: "other local minimum".into(),
            });
        }
        key
    }
}
