//! Maps that are put together of pieces, such as the walls of a room.

use super::canvas::{Canvas, Hang, Type};
use super::panel::Panel;
use super::style::{self, Stroke};
use crate::report::text::width;
use plotters::style::RGBColor;

/// A part of a map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Piece {
    /// Its name; may be empty.
    pub name: String,
    /// Its corners in order.
    pub corners: Vec<[f64; 2]>,
}

/// Outlines and, where there is room, names.
pub(super) fn outlined(pieces: &[Piece], canvas: &Canvas, panel: &Panel<'_>) {
    let frame = panel.frame;
    for Piece { name, corners } in pieces {
        let closed = corners.iter().chain(corners.first());
        panel.line(closed.map(|p| (p[0], p[1])), Stroke::new(style::MUTED, 0.7));
        let across = corners.iter().map(|p| frame.across(p[0]));
        let (left, right) = across.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        let bottom = corners.iter().map(|p| frame.down(p[1]));
        let bottom = bottom.fold(f64::NEG_INFINITY, f64::max);
        let room = width(name, 0.85 * style::TICK) + 6.0;
        if name.is_empty() || room > right - left {
            continue;
        }
        let middle = 0.5 * (left + right);
        canvas.rectangle(
            (middle - 0.5 * room, bottom - 15.0),
            (middle + 0.5 * room, bottom - 3.0),
            RGBColor(255, 255, 255),
            0.8,
        );
        canvas.text(
            (middle, bottom - 9.0),
            name,
            Type::new(0.85 * style::TICK, style::INK, Hang::Middle),
        );
    }
}
