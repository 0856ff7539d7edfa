//! A sheet to draw on in pixels, over plotters' drawing areas.

use super::Svg;
use super::backend::{Backend, UNITS};
use super::path::Place;
use super::style::{self, Stroke};
use crate::report::text::{BOLDER, fit, width};
use plotters::drawing::DrawingArea;
use plotters::element::{Circle, PathElement, Polygon, Rectangle};
use plotters::prelude::Text;
use plotters::style::{
    Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle,
};
use plotters_backend::text_anchor::{HPos, Pos, VPos};
use std::cell::RefCell;
use std::rc::Rc;

pub(super) type Area<C> = DrawingArea<Backend, C>;
pub(super) type Sheet = Area<plotters::coord::Shift>;

pub(super) const INFALLIBLE: &str = "drawing into memory cannot fail";

/// Where text hangs on its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Hang {
    /// The place is the text's left end.
    Left,
    /// The place is its middle.
    Middle,
    /// The place is its right end.
    Right,
}

/// How a text looks; its place is the middle of its height.
#[derive(Clone, Copy)]
pub(super) struct Type {
    pub size: f64,
    pub colour: RGBColor,
    pub bold: bool,
    pub upwards: bool,
    pub hang: Hang,
}

impl Type {
    pub const fn new(size: f64, colour: RGBColor, hang: Hang) -> Self {
        Self {
            size,
            colour,
            bold: false,
            upwards: false,
            hang,
        }
    }

    pub const fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    pub const fn upwards(self) -> Self {
        Self {
            upwards: true,
            ..self
        }
    }
}

/// The whole figure.
pub(super) struct Canvas {
    backend: Rc<RefCell<Backend>>,
    pub(super) sheet: Sheet,
}

pub(super) fn units(pixels: f64) -> i32 {
    (pixels * UNITS).round() as i32
}

pub(super) fn shape(colour: RGBColor, alpha: f64, filled: bool, stroke: f64) -> ShapeStyle {
    ShapeStyle {
        color: colour.mix(alpha),
        filled,
        stroke_width: units(stroke) as u32,
    }
}

impl Canvas {
    pub fn new(width: f64, height: f64) -> Self {
        let backend = Rc::new(RefCell::new(Backend::new(width, height)));
        let sheet = DrawingArea::from(&backend);
        Self { backend, sheet }
    }

    pub fn finish(self, title: &str, description: &str) -> Svg {
        self.backend.borrow().document(title, description)
    }

    pub(super) fn dash(&self, dash: Option<&'static str>) {
        self.backend.borrow_mut().dash = dash;
    }

    pub fn line(&self, points: &[Place], stroke: Stroke) {
        self.dash(stroke.dash);
        let points: Vec<(i32, i32)> = points.iter().map(|&(x, y)| (units(x), units(y))).collect();
        self.sheet
            .draw(&PathElement::new(
                points,
                shape(stroke.colour, 1.0, false, stroke.width),
            ))
            .expect(INFALLIBLE);
        self.dash(None);
    }

    pub fn polygon(&self, points: &[Place], colour: RGBColor, alpha: f64) {
        let points: Vec<(i32, i32)> = points.iter().map(|&(x, y)| (units(x), units(y))).collect();
        self.sheet
            .draw(&Polygon::new(points, shape(colour, alpha, true, 0.0)))
            .expect(INFALLIBLE);
    }

    pub fn rectangle(&self, from: Place, to: Place, colour: RGBColor, alpha: f64) {
        let corners = [(units(from.0), units(from.1)), (units(to.0), units(to.1))];
        self.sheet
            .draw(&Rectangle::new(corners, shape(colour, alpha, true, 0.0)))
            .expect(INFALLIBLE);
    }

    /// A PNG file in base 64, stretched over a rectangle.
    pub(super) fn picture(&self, corner: (i32, i32), size: (i32, i32), data: &str) {
        self.backend.borrow_mut().image(corner, size, data);
    }

    /// A disc of `colour`, or a ring with a white middle.
    pub fn dot(&self, at: Place, radius: f64, colour: RGBColor, ring: bool) {
        let centre = (units(at.0), units(at.1));
        let fill = if ring {
            RGBColor(255, 255, 255)
        } else {
            colour
        };
        self.sheet
            .draw(&Circle::new(
                centre,
                units(radius),
                shape(fill, 1.0, true, 0.0),
            ))
            .expect(INFALLIBLE);
        if ring {
            self.sheet
                .draw(&Circle::new(
                    centre,
                    units(radius),
                    shape(colour, 1.0, false, 1.4),
                ))
                .expect(INFALLIBLE);
        }
    }

    /// A diamond of `colour` with a white rim, so that it shows on a bar.
    pub fn diamond(&self, (x, y): Place, radius: f64, colour: RGBColor) {
        for (radius, colour) in [(radius + 1.4, RGBColor(255, 255, 255)), (radius, colour)] {
            self.polygon(
                &[
                    (x - radius, y),
                    (x, y - radius),
                    (x + radius, y),
                    (x, y + radius),
                ],
                colour,
                1.0,
            );
        }
    }

    pub fn text(&self, at: Place, text: &str, kind: Type) {
        if text.is_empty() {
            return;
        }
        let weight = if kind.bold {
            FontStyle::Bold
        } else {
            FontStyle::Normal
        };
        let turn = if kind.upwards {
            FontTransform::Rotate270
        } else {
            FontTransform::None
        };
        let hang = match kind.hang {
            Hang::Left => HPos::Left,
            Hang::Middle => HPos::Center,
            Hang::Right => HPos::Right,
        };
        let font = FontDesc::new(FontFamily::SansSerif, kind.size * UNITS, weight).transform(turn);
        let style = font.color(&kind.colour).pos(Pos::new(hang, VPos::Center));
        self.sheet
            .draw(&Text::new(
                text.to_owned(),
                (units(at.0), units(at.1)),
                style,
            ))
            .expect(INFALLIBLE);
    }

    /// The figure's title at the top left, over at most two lines; returns the height it took.
    pub fn title(&self, title: &str, room: f64) -> f64 {
        let kind = Type::new(style::TITLE, style::INK, Hang::Left).bold();
        let size = BOLDER * style::TITLE;
        let mut lines: Vec<String> = Vec::new();
        for word in title.split_whitespace() {
            match lines.last_mut() {
                Some(line) if lines_left(line, word, size, room) => {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(word.to_owned()),
            }
        }
        if lines.len() > 2 {
            let rest = lines.split_off(1).join(" ");
            lines.push(rest);
        }
        for (index, line) in lines.iter().enumerate() {
            self.text(
                (MARGIN, MARGIN + 8.0 + 18.0 * index as f64),
                &fit(line, size, room),
                kind,
            );
        }
        if lines.is_empty() {
            MARGIN - 4.0
        } else {
            MARGIN + 2.0 + 18.0 * lines.len() as f64
        }
    }
}

fn lines_left(line: &str, word: &str, size: f64, room: f64) -> bool {
    width(line, size) + width(" ", size) + width(word, size) <= room
}

/// Free space around a figure.
pub(super) const MARGIN: f64 = 8.0;
