//! Densities over one axis: the truth, estimates, step functions, bands, and the data beneath.

use super::canvas::{Canvas, Hang, MARGIN, Type};
use super::legend::{End, Entry, FILL, Legend, Markers, Swatch, label_ends};
use super::multiples::{Multiples, Small};
use super::panel::{Frame, Panel, overhang, room_left};
use super::path::Place;
use super::scale::Scale;
use super::style::{self, Stroke};
use super::{Axis, Marker, Role, Series, Svg};
use crate::report::text::width;

/// Curves over a common pair of axes.
#[derive(Clone, Debug, Default)]
pub struct Curves {
    /// Printed at the top; may be empty.
    pub title: String,
    /// What the figure shows, for those who do not see it.
    pub description: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis; without a range it starts at zero if it is linear.
    pub y: Axis,
    /// The curves, drawn in this order over the truth.
    pub series: Vec<Series>,
    /// The data, ticked beneath the axis; beyond 2000 of them as a strip of their density.
    pub rug: Vec<f64>,
    /// Vertical lines.
    pub markers: Vec<Marker>,
    /// Places on the curves worth a dot, such as modes: (number of the series, x).
    pub dots: Vec<(usize, f64)>,
}

/// Width of every figure.
pub(super) const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 290.0;
/// Height of the strip that shows the data.
pub(super) const RUG: f64 = 9.0;

impl Curves {
    /// The figure.
    pub fn draw(&self) -> Svg {
        self.draw_in_frame().0
    }

    /// The figure and where its frame lies.
    pub fn draw_in_frame(&self) -> (Svg, Frame) {
        self.compose(true)
    }

    /// The same for curves that are put in later: without a remark that there are none.
    pub(in crate::report) fn draw_stage(&self) -> (Svg, Frame) {
        self.compose(false)
    }

    fn compose(&self, remark: bool) -> (Svg, Frame) {
        let (x, y) = self.scales();
        let ends = self.ends(x, y);
        let entries = legend(&self.series, !self.rug.is_empty());
        let entries = if ends.is_some() { Vec::new() } else { entries };
        let legend = Legend::new(entries, WIDTH - 2.0 * MARGIN);
        let gap = if self.rug.is_empty() { 0.0 } else { RUG + 3.0 };
        let left = room_left(y, HEIGHT, true);
        let mut frame = Frame {
            left,
            top: 0.0,
            width: WIDTH - left - 16.0_f64.max(overhang(x, WIDTH - left).1 + 4.0),
            height: HEIGHT,
            x,
            y,
        };
        let labels = ends
            .iter()
            .flatten()
            .map(|end| width(&end.name, style::LABEL) + 26.0)
            .fold(0.0, f64::max);
        frame.width -= labels
            .max(Markers::overhang(&self.markers, frame))
            .min(170.0);
        let markers = Markers::new(&self.markers, frame, WIDTH - 4.0);

        // The title decides where everything else begins, so it is drawn on a sheet of the right height in a second pass.
        let heading = Canvas::new(WIDTH, 1.0).title(&self.title, WIDTH - 2.0 * MARGIN);
        frame.top = heading + legend.height() + markers.height() + 6.0;
        let canvas = Canvas::new(WIDTH, frame.bottom() + gap + 42.0);
        canvas.title(&self.title, WIDTH - 2.0 * MARGIN);
        legend.draw(&canvas, (MARGIN, heading));
        let panel = canvas.panel((frame.left, frame.top), (frame.width, frame.height), x, y);
        panel.axes(&self.x, &self.y, gap);
        rug(&canvas, &panel.frame, &self.rug);
        series(&panel, &self.series, 1.0);
        markers.draw(&canvas, panel.frame);
        for &(index, at) in &self.dots {
            if let Some(series) = self.series.get(index) {
                let colour = stroke(series).colour;
                panel.mark((at, height(series, at)), |canvas, place| {
                    canvas.dot(place, 2.6, colour, true);
                });
            }
        }
        if let Some(ends) = ends {
            label_ends(&panel, &canvas, &ends, labels);
        }
        if remark
            && !self
                .series
                .iter()
                .any(|series| series.y.iter().any(|value| value.is_finite()))
        {
            nothing(&canvas, &panel.frame);
        }
        let frame = panel.frame;
        (canvas.finish(&self.title, &self.description), frame)
    }

    /// The same as one small panel per series, with the truth in each, over shared axes.
    pub fn panels(&self, columns: usize) -> Multiples {
        let (truths, others): (Vec<_>, Vec<_>) = self
            .series
            .iter()
            .cloned()
            .partition(|series| series.role == Role::Truth);
        let panels = others
            .into_iter()
            .map(|series| Small {
                title: series.name.clone(),
                series: truths.iter().cloned().chain([series]).collect(),
            })
            .collect();
        Multiples {
            title: self.title.clone(),
            description: self.description.clone(),
            x: self.x.clone(),
            y: self.y.clone(),
            columns,
            shared: true,
            panels,
        }
    }

    fn scales(&self) -> (Scale, Scale) {
        let rug = self.rug.iter().copied();
        let x = self.x.scale(abscissae(&self.series).chain(rug), 0.0);
        (x, ordinate_scale(&self.y, &self.series))
    }

    /// The right ends of the curves, if they are far enough apart there to be named in place.
    fn ends(&self, x: Scale, y: Scale) -> Option<Vec<End>> {
        let mut ends = Vec::new();
        for series in &self.series {
            let (&last_x, &last_y) = series.x.last().zip(series.y.last())?;
            if matches!(series.role, Role::Steps(_))
                || x.place(last_x) < 0.97
                || !(0.0..=1.0).contains(&y.place(last_y))
            {
                return None;
            }
            ends.push(End {
                at: (last_x, last_y),
                name: series.name.clone(),
                stroke: stroke(series),
            });
        }
        let mut places: Vec<f64> = ends.iter().map(|end| y.place(end.at.1)).collect();
        places.sort_by(f64::total_cmp);
        let apart = places
            .windows(2)
            .all(|pair| (pair[1] - pair[0]) * HEIGHT > 6.0);
        (!ends.is_empty() && apart && self.rug.is_empty()).then_some(ends)
    }
}

/// Says that there is nothing to show, where the curves would be.
pub(super) fn nothing(canvas: &Canvas, frame: &Frame) {
    let middle = (
        frame.left + 0.5 * frame.width,
        frame.top + 0.4 * frame.height,
    );
    canvas.text(
        middle,
        "no values to show",
        Type::new(style::LABEL, style::MUTED, Hang::Middle),
    );
}

/// A vertical scale for curves: from zero if it is linear and nothing is negative, with a little room above.
pub(super) fn ordinate_scale(axis: &Axis, series: &[Series]) -> Scale {
    let values = || {
        series.iter().flat_map(|series| {
            let edges: [&[f64]; 2] = match &series.role {
                Role::Band { low, high, .. } => [low, high],
                _ => [&[], &[]],
            };
            series.y.iter().chain(edges[0]).chain(edges[1]).copied()
        })
    };
    if axis.range.is_some() || axis.logarithmic {
        return axis.scale(values(), 0.05);
    }
    let (least, most) = values()
        .filter(|value| value.is_finite())
        .fold((0.0_f64, 0.0_f64), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if most - least <= 0.0 {
        return Scale::linear(0.0, 1.0);
    }
    let room = 0.05 * (most - least);
    Scale::linear(
        if least < 0.0 { least - room } else { 0.0 },
        if most > 0.0 { most + room } else { most },
    )
}

/// Every abscissa of some curves.
pub(super) fn abscissae(series: &[Series]) -> impl Iterator<Item = f64> {
    series.iter().flat_map(|series| series.x.iter().copied())
}

/// The line of a series.
pub(super) fn stroke(series: &Series) -> Stroke {
    match series.role {
        Role::Truth => Stroke::new(style::INK, style::TRUTH),
        Role::Estimate(index) | Role::Steps(index) | Role::Band { colour: index, .. } => {
            style::series(index)
        }
    }
}

/// The legend entries of some curves.
pub(super) fn legend(series: &[Series], rug: bool) -> Vec<Entry> {
    let mut entries: Vec<Entry> = series
        .iter()
        .map(|series| {
            let line = stroke(series);
            let swatch = match series.role {
                Role::Truth => Swatch::Filled(line),
                Role::Band { .. } => Swatch::Band(line),
                Role::Estimate(_) | Role::Steps(_) => Swatch::Line(line),
            };
            Entry {
                swatch,
                name: series.name.clone(),
            }
        })
        .collect();
    if rug {
        entries.push(Entry {
            swatch: Swatch::Rug,
            name: "data".into(),
        });
    }
    entries
}

/// The corners of a step function, from and to the base line.
fn steps(edges: &[f64], heights: &[f64]) -> Vec<Place> {
    let cells = heights.len().min(edges.len().saturating_sub(1));
    let mut corners = Vec::with_capacity(2 * cells + 2);
    for cell in 0..cells {
        if cell == 0 {
            corners.push((edges[0], 0.0));
        }
        corners.extend([
            (edges[cell], heights[cell]),
            (edges[cell + 1], heights[cell]),
        ]);
    }
    if cells > 0 {
        corners.push((edges[cells], 0.0));
    }
    corners
}

/// Value of a series at `at`, between its points.
fn height(series: &Series, at: f64) -> f64 {
    let above = series.x.partition_point(|&x| x < at);
    if let Role::Steps(_) = series.role {
        return above
            .checked_sub(1)
            .and_then(|cell| series.y.get(cell))
            .copied()
            .unwrap_or(0.0);
    }
    let point = |index: usize| {
        series
            .x
            .get(index)
            .copied()
            .zip(series.y.get(index).copied())
    };
    match (above.checked_sub(1).and_then(point), point(above)) {
        (Some((a, fa)), Some((b, fb))) => fa + (fb - fa) * (at - a) / (b - a),
        (None, Some((b, fb))) if b <= at => fb,
        _ => f64::NAN,
    }
}

/// Draws curves: the truth first, then bands, then lines in their order, all lines `weight` times as heavy as in a large figure.
pub(super) fn series(panel: &Panel, series: &[Series], weight: f64) {
    let stroke = |series: &Series| {
        let line = stroke(series);
        Stroke {
            width: weight * line.width,
            ..line
        }
    };
    let points = |series: &Series| -> Vec<Place> {
        match series.role {
            Role::Steps(_) => steps(&series.x, &series.y),
            _ => series
                .x
                .iter()
                .copied()
                .zip(series.y.iter().copied())
                .collect(),
        }
    };
    let truths = || series.iter().filter(|series| series.role == Role::Truth);
    for truth in truths() {
        let base = if panel.frame.y.is_logarithmic() {
            panel.frame.y.ends().0
        } else {
            0.0
        };
        panel.band(
            &truth.x,
            &vec![base; truth.x.len()],
            &truth.y,
            style::INK,
            FILL,
        );
    }
    for band in series {
        if let Role::Band { colour, low, high } = &band.role {
            panel.band(&band.x, low, high, style::colour(*colour), style::BAND);
        }
    }
    for truth in truths() {
        panel.line(points(truth), stroke(truth));
    }
    for estimate in series.iter().filter(|series| series.role != Role::Truth) {
        panel.line(points(estimate), stroke(estimate));
    }
}

/// The data beneath the frame: a tick each, or beyond 2000 a strip as dark as they are dense.
fn rug(canvas: &Canvas, frame: &Frame, data: &[f64]) {
    let top = frame.bottom() + 3.0;
    let inside = data.iter().copied().filter(|&x| frame.spans(x));
    if data.len() <= 2000 {
        let stroke = Stroke::new(style::INK, if data.len() <= 300 { 0.7 } else { 0.4 });
        for x in inside {
            let x = frame.across(x);
            canvas.line(&[(x, top), (x, top + RUG)], stroke);
        }
        return;
    }
    // Cells of two whole pixels, so that neighbours meet without a seam.
    let (first, cells) = (frame.left.ceil(), (frame.width / 2.0).floor());
    let mut counts = vec![0_u64; cells as usize];
    for x in inside {
        let cell = ((frame.across(x) - first) / 2.0).clamp(0.0, cells - 1.0) as usize;
        counts[cell] += 1;
    }
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    for (cell, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let x = first + 2.0 * cell as f64;
        // The square root keeps thin tails visible.
        canvas.rectangle(
            (x, top),
            (x + 2.0, top + RUG),
            style::INK,
            (count as f64 / most as f64).sqrt().max(0.04),
        );
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn steps_rise_from_the_base_line_and_return_to_it() {
        assert_eq!(
            steps(&[0.0, 1.0, 2.0], &[3.0, 4.0]),
            [
                (0.0, 0.0),
                (0.0, 3.0),
                (1.0, 3.0),
                (1.0, 4.0),
                (2.0, 4.0),
                (2.0, 0.0)
            ]
        );
        assert!(steps(&[1.0], &[2.0]).is_empty() && steps(&[], &[]).is_empty());
    }

    #[test]
    fn dots_sit_on_their_curves() {
        let line = Series {
            name: String::new(),
            x: vec![0.0, 2.0, 4.0],
            y: vec![0.0, 1.0, 0.0],
            role: Role::Estimate(0),
        };
        assert_eq!(
            (
                height(&line, 1.0),
                height(&line, 2.0),
                height(&line, 3.0),
                height(&line, 0.0)
            ),
            (0.5, 1.0, 0.5, 0.0)
        );
        assert!(height(&line, 5.0).is_nan());
        let steps = Series {
            x: vec![0.0, 1.0, 2.0],
            y: vec![3.0, 4.0],
            role: Role::Steps(0),
            ..line
        };
        assert_eq!(
            (
                height(&steps, 0.5),
                height(&steps, 1.5),
                height(&steps, 9.0)
            ),
            (3.0, 4.0, 0.0)
        );
    }
}
