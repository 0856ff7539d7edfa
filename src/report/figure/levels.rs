//! Level lines on maps.

use super::HeatMaps;
use super::canvas::{Canvas, Hang, Type};
use super::contour::contours;
use super::panel::Panel;
use super::path::Place;
use super::scale::Scale;
use super::style::{self, Stroke};
use crate::report::text::width;
use plotters::style::RGBColor;

impl HeatMaps {
    /// Lines at the ticks of the colour bar, each with its value where it runs most level.
    pub(super) fn level_lines(
        &self,
        canvas: &Canvas,
        panel: &Panel<'_>,
        values: &[f64],
        scale: Scale,
    ) {
        let frame = panel.frame;
        let ticks = scale.ticks(200.0, false);
        let mut taken: Vec<Place> = Vec::new();
        for (level, label) in &ticks.major {
            let place = scale.place(*level);
            if !(0.01..=0.99).contains(&place) {
                continue;
            }
            let light = self.colours.is_light(place);
            let ink = if light {
                style::INK
            } else {
                RGBColor(255, 255, 255)
            };
            let lines = contours(values, self.cells, *level);
            let spot = |axis: usize, t: f64| {
                let width = (self.high[axis] - self.low[axis]) / self.cells[axis] as f64;
                (t + 0.5).mul_add(width, self.low[axis])
            };
            let on_sheet = |p: Place| (frame.across(spot(0, p.0)), frame.down(spot(1, p.1)));
            for line in &lines {
                panel.line(
                    line.iter().map(|p| (spot(0, p.0), spot(1, p.1))),
                    Stroke::new(ink, 0.7),
                );
            }
            let room = width(label, 0.85 * style::TICK) + 5.0;
            let longest = lines.iter().max_by_key(|line| line.len());
            let Some(line) = longest.filter(|line| line.len() > 8) else {
                continue;
            };
            let reach = (line.len() / 24).max(2);
            let free = |at: &Place| {
                (frame.left + room..=frame.right() - room).contains(&at.0)
                    && (frame.top + 7.0..=frame.bottom() - 7.0).contains(&at.1)
                    && taken
                        .iter()
                        .all(|t| (t.0 - at.0).abs() > 1.2 * room || (t.1 - at.1).abs() > 11.0)
            };
            let steepness = |k: usize| {
                let (a, b) = (on_sheet(line[k - reach]), on_sheet(line[k + reach]));
                (b.1 - a.1).abs() / (b.0 - a.0).hypot(b.1 - a.1).max(1e-9)
            };
            let best = (reach..line.len() - reach)
                .filter(|&k| free(&on_sheet(line[k])))
                .min_by(|&a, &b| steepness(a).total_cmp(&steepness(b)));
            let Some(at) = best.map(|k| on_sheet(line[k])) else {
                continue;
            };
            taken.push(at);
            let (half, up) = (0.5 * room - 1.0, 5.0);
            canvas.rectangle(
                (at.0 - half, at.1 - up),
                (at.0 + half, at.1 + up),
                self.colours.at(place),
                1.0,
            );
            canvas.text(at, label, Type::new(0.85 * style::TICK, ink, Hang::Middle));
        }
    }
}
