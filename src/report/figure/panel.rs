//! A framed panel on a sheet: data coordinates, curves cut at the frame, axes with their labels.

use super::Axis;
use super::backend::UNITS;
use super::canvas::{Area, Canvas, Hang, INFALLIBLE, MARGIN, Type, shape, units};
use super::path::{Place, clip_line, clip_polygon, thin};
use super::scale::{Scale, Ticks};
use super::style::{self, Stroke};
use crate::report::text::{fit, fixed, power, width};
use plotters::coord::cartesian::Cartesian2d;
use plotters::element::{PathElement, Polygon};
use plotters::style::RGBColor;
use std::fmt::Write as _;

impl Canvas {
    /// A frame for data with its left upper corner at `corner`.
    pub fn panel(&self, corner: Place, size: (f64, f64), x: Scale, y: Scale) -> Panel<'_> {
        let pixels_x = units(corner.0)..units(corner.0 + size.0);
        // Downwards on the sheet is up in the data.
        let pixels_y = units(corner.1 + size.1)..units(corner.1);
        let area = self
            .sheet
            .apply_coord_spec(Cartesian2d::new(x, y, (pixels_x, pixels_y)));
        Panel {
            canvas: self,
            area,
            frame: Frame {
                left: corner.0,
                top: corner.1,
                width: size.0,
                height: size.1,
                x,
                y,
            },
        }
    }
}

/// Where a panel lies on its figure and what its axes span: enough to draw more into it later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Left side in pixels of the figure.
    pub left: f64,
    /// Upper side in pixels of the figure.
    pub top: f64,
    /// Width in pixels.
    pub width: f64,
    /// Height in pixels.
    pub height: f64,
    /// The horizontal axis.
    pub x: Scale,
    /// The vertical axis.
    pub y: Scale,
}

impl Frame {
    /// Horizontal place of a value on the figure.
    pub fn across(&self, x: f64) -> f64 {
        self.left + self.x.place(x) * self.width
    }

    /// Vertical place of a value on the figure.
    pub fn down(&self, y: f64) -> f64 {
        self.top + (1.0 - self.y.place(y)) * self.height
    }

    /// Right side.
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Lower side.
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Whether a value is on the horizontal axis.
    pub fn spans(&self, x: f64) -> bool {
        (-1e-9..=1.0 + 1e-9).contains(&self.x.place(x))
    }

    fn places(&self, points: impl IntoIterator<Item = Place>) -> impl Iterator<Item = Place> {
        let (x, y) = (self.x, self.y);
        points
            .into_iter()
            .map(move |(a, b)| (x.place(a), y.place(b)))
    }

    fn values(&self, places: &[Place]) -> Vec<Place> {
        places
            .iter()
            .map(|&(a, b)| (self.x.value(a), self.y.value(b)))
            .collect()
    }
}

/// The pieces of a curve between its gaps as SVG path data in pixels of the figure.
pub(super) fn path_data(frame: &Frame, x: &[f64], y: &[f64]) -> String {
    let places: Vec<Place> = frame
        .places(x.iter().copied().zip(y.iter().copied()))
        .collect();
    let mut data = String::new();
    for run in places.split(|place| !(place.0.is_finite() && place.1.is_finite())) {
        for (index, place) in thin(run, (frame.width, frame.height), 1.0 / UNITS)
            .into_iter()
            .enumerate()
        {
            // A curve far beyond the frame is as good as one at twenty times its height.
            let (across, up) = (place.0.clamp(-20.0, 20.0), place.1.clamp(-20.0, 20.0));
            let at = (
                frame.left + across * frame.width,
                frame.bottom() - up * frame.height,
            );
            let _ = write!(
                data,
                "{}{:.2} {:.2}",
                if index == 0 { 'M' } else { 'L' },
                at.0,
                at.1
            );
        }
    }
    data
}

/// A frame with data coordinates.
pub(super) struct Panel<'a> {
    canvas: &'a Canvas,
    area: Area<Cartesian2d<Scale, Scale>>,
    pub frame: Frame,
}

impl Panel<'_> {
    /// A polyline of data points, cut at the frame; non-finite points leave gaps.
    pub fn line(&self, points: impl IntoIterator<Item = Place>, stroke: Stroke) {
        self.canvas.dash(stroke.dash);
        for piece in clip_line(self.frame.places(points)) {
            let thinned = thin(&piece, (self.frame.width, self.frame.height), 1.0 / UNITS);
            let style = shape(stroke.colour, 1.0, false, stroke.width);
            self.area
                .draw(&PathElement::new(self.frame.values(&thinned), style))
                .expect(INFALLIBLE);
        }
        self.canvas.dash(None);
    }

    /// The area between two curves over the same abscissae, filled.
    pub fn band(&self, x: &[f64], low: &[f64], high: &[f64], colour: RGBColor, alpha: f64) {
        let rows: Vec<(f64, f64, f64)> = (0..x.len().min(low.len()).min(high.len()))
            .map(|i| {
                (
                    self.frame.x.place(x[i]),
                    self.edge(low[i]),
                    self.frame.y.place(high[i]),
                )
            })
            .collect();
        for run in rows.split(|row| !(row.0.is_finite() && row.1.is_finite() && row.2.is_finite()))
        {
            let upper: Vec<Place> = run.iter().map(|row| (row.0, row.2)).collect();
            let lower: Vec<Place> = run.iter().rev().map(|row| (row.0, row.1)).collect();
            let size = (self.frame.width, self.frame.height);
            let mut corners = thin(&upper, size, 1.0 / UNITS);
            corners.extend(thin(&lower, size, 1.0 / UNITS));
            let cut = clip_polygon(corners);
            if cut.len() > 2 {
                self.area
                    .draw(&Polygon::new(
                        self.frame.values(&cut),
                        shape(colour, alpha, true, 0.0),
                    ))
                    .expect(INFALLIBLE);
            }
        }
    }

    /// The place of a band's lower edge: at or below zero of a logarithmic axis it lies far below the frame.
    fn edge(&self, low: f64) -> f64 {
        if low <= 0.0 && self.frame.y.is_logarithmic() {
            -10.0
        } else {
            self.frame.y.place(low)
        }
    }

    /// A mark of fixed size at a data point, if it is inside the frame.
    pub fn mark(&self, (x, y): Place, draw: impl FnOnce(&Canvas, Place)) {
        let place = (self.frame.x.place(x), self.frame.y.place(y));
        if [place.0, place.1]
            .iter()
            .all(|p| (-1e-9..=1.0 + 1e-9).contains(p))
        {
            draw(self.canvas, (self.frame.across(x), self.frame.down(y)));
        }
    }

    /// Grid and tick labels, and axis titles where they are not empty; draw it before the data. `gap` is room between the frame and
    /// the labels below it.
    pub fn axes(&self, x: &Axis, y: &Axis, gap: f64) {
        let ticks = (
            self.frame.x.ticks(self.frame.width, true),
            self.frame.y.ticks(self.frame.height, false),
        );
        self.grid(&ticks.0, &ticks.1, gap);
        self.labels_below(&ticks.0, gap);
        let widest = self.labels_left(&ticks.1);
        let Frame {
            left,
            top,
            width: across,
            height,
            ..
        } = self.frame;
        let kind = Type::new(style::LABEL, style::INK, Hang::Middle);
        let text = fit(&title(x, &ticks.0), style::LABEL, across + left - MARGIN);
        self.canvas.text(
            (left + 0.5 * across, top + height + gap + 30.0),
            &text,
            kind,
        );
        let text = fit(&title(y, &ticks.1), style::LABEL, height + 40.0);
        self.canvas.text(
            (left - widest - 18.0, top + 0.5 * height),
            &text,
            kind.upwards(),
        );
    }

    /// Light lines at the ticks, the base line in ink.
    pub fn grid(&self, across: &Ticks, down: &Ticks, gap: f64) {
        let frame = &self.frame;
        let thin = Stroke::new(style::GRID, 0.75);
        for &(value, _) in &across.major {
            let x = frame.across(value);
            self.canvas
                .line(&[(x, frame.top), (x, frame.bottom() + gap)], thin);
        }
        for &(value, _) in &down.major {
            let y = frame.down(value);
            self.canvas
                .line(&[(frame.left, y), (frame.right(), y)], thin);
        }
        let fine = Stroke::new(style::MUTED, 0.6);
        for &value in &across.minor {
            let x = frame.across(value);
            self.canvas
                .line(&[(x, frame.bottom()), (x, frame.bottom() - 3.0)], fine);
        }
        for &value in &down.minor {
            let y = frame.down(value);
            self.canvas
                .line(&[(frame.left, y), (frame.left + 3.0, y)], fine);
        }
        let base = if frame.y.is_logarithmic() || !(0.0..=1.0).contains(&frame.y.place(0.0)) {
            frame.bottom()
        } else {
            frame.down(0.0)
        };
        self.canvas.line(
            &[(frame.left, base), (frame.right(), base)],
            Stroke::new(style::INK, 0.9),
        );
    }

    pub fn labels_below(&self, ticks: &Ticks, gap: f64) {
        let kind = Type::new(style::TICK, style::MUTED, Hang::Middle);
        for (value, label) in &ticks.major {
            self.canvas.text(
                (self.frame.across(*value), self.frame.bottom() + gap + 11.0),
                label,
                kind,
            );
        }
    }

    /// Tick labels at the left; returns the width of the widest.
    pub fn labels_left(&self, ticks: &Ticks) -> f64 {
        let kind = Type::new(style::TICK, style::MUTED, Hang::Right);
        for (value, label) in &ticks.major {
            self.canvas.text(
                (self.frame.left - 6.0, self.frame.down(*value)),
                label,
                kind,
            );
        }
        widest(ticks)
    }
}

/// Width of the widest label.
pub(super) fn widest(ticks: &Ticks) -> f64 {
    ticks
        .major
        .iter()
        .map(|(_, label)| width(label, style::TICK))
        .fold(0.0, f64::max)
}

/// How far the tick labels of a horizontal axis reach beyond its two ends.
pub(super) fn overhang(x: Scale, across: f64) -> (f64, f64) {
    let ends = x
        .ticks(across, true)
        .major
        .into_iter()
        .map(|(value, label)| {
            let (middle, half) = (x.place(value) * across, 0.5 * width(&label, style::TICK));
            (half - middle, middle + half - across)
        });
    ends.fold((0.0, 0.0), |most, end| {
        (most.0.max(end.0), most.1.max(end.1))
    })
}

/// Room to the left of a frame for the labels of its vertical axis and its title.
pub(super) fn room_left(y: Scale, height: f64, titled: bool) -> f64 {
    MARGIN + widest(&y.ticks(height, false)) + if titled { 24.0 } else { 8.0 }
}

/// An axis title with its unit and with what the tick labels leave out.
pub(super) fn title(axis: &Axis, ticks: &Ticks) -> String {
    let mut title = axis.label.clone();
    if ticks.offset != 0.0 {
        let sign = if ticks.offset < 0.0 { '+' } else { '\u{2212}' };
        title = format!(
            "{title} {sign} {}",
            fixed(ticks.offset.abs(), ticks.offset_digits)
        );
    }
    let scale = if ticks.power == 0 {
        String::new()
    } else {
        power(ticks.power)
    };
    match (scale.is_empty(), axis.unit.is_empty()) {
        (true, true) => title,
        (true, false) => format!("{title} ({})", axis.unit),
        (false, true) => format!("{title} ({scale})"),
        (false, false) => format!("{title} ({scale}\u{202f}{})", axis.unit),
    }
}
