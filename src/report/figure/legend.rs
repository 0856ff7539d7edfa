//! Keys and labels that keep out of each other's way: a legend in rows, labels at line ends, names over vertical markers.

use super::Marker;
use super::canvas::{Canvas, Hang, Type};
use super::panel::{Frame, Panel};
use super::path::Place;
use super::style::{self, Stroke};
use crate::report::text::{fit, significant, width};
use plotters::style::RGBColor;

/// The sample of a legend entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Swatch {
    /// A curve.
    Line(Stroke),
    /// A curve filled lightly down to the base line.
    Filled(Stroke),
    /// A curve in the middle of a band.
    Band(Stroke),
    /// A dot with an interval.
    Interval(RGBColor),
    /// A bar with an interval.
    Bar(RGBColor),
    /// A diamond.
    Diamond,
    /// A disc.
    Disc,
    /// A ring.
    Ring,
    /// Upright ticks: data.
    Rug,
}

/// One entry of a legend.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub swatch: Swatch,
    pub name: String,
}

const SWATCH: f64 = 22.0;
const GAP: f64 = 18.0;
const ROW: f64 = 16.0;

/// A legend set in rows of a given width.
pub(super) struct Legend {
    rows: Vec<Vec<(Entry, f64)>>,
}

impl Legend {
    /// Sets the entries one after the other, a new row where one does not fit.
    pub fn new(entries: Vec<Entry>, room: f64) -> Self {
        let mut rows: Vec<Vec<(Entry, f64)>> = Vec::new();
        let mut x = 0.0;
        for mut entry in entries {
            entry.name = fit(&entry.name, style::LABEL, (room - SWATCH - 6.0).min(320.0));
            let needed = SWATCH + 6.0 + width(&entry.name, style::LABEL);
            if rows.is_empty() || x + needed > room {
                rows.push(Vec::new());
                x = 0.0;
            }
            if let Some(row) = rows.last_mut() {
                row.push((entry, x));
            }
            x += needed + GAP;
        }
        Self { rows }
    }

    /// Its height, 0 without entries.
    pub fn height(&self) -> f64 {
        if self.rows.is_empty() {
            0.0
        } else {
            ROW * self.rows.len() as f64 + 6.0
        }
    }

    /// Draws it with its left upper corner at `corner`.
    pub fn draw(&self, canvas: &Canvas, corner: Place) {
        for (row, entries) in self.rows.iter().enumerate() {
            let y = corner.1 + ROW * (row as f64 + 0.5);
            for (entry, x) in entries {
                let left = corner.0 + x;
                swatch(canvas, entry.swatch, (left, y));
                canvas.text(
                    (left + SWATCH + 6.0, y),
                    &entry.name,
                    Type::new(style::LABEL, style::INK, Hang::Left),
                );
            }
        }
    }
}

fn swatch(canvas: &Canvas, swatch: Swatch, (left, y): Place) {
    let (right, middle) = (left + SWATCH, left + 0.5 * SWATCH);
    match swatch {
        Swatch::Line(stroke) => canvas.line(&[(left, y), (right, y)], stroke),
        Swatch::Filled(stroke) => {
            canvas.rectangle((left, y - 2.0), (right, y + 5.0), stroke.colour, FILL);
            canvas.line(&[(left, y - 2.0), (right, y - 2.0)], stroke);
        }
        Swatch::Band(stroke) => {
            canvas.rectangle(
                (left, y - 5.0),
                (right, y + 5.0),
                stroke.colour,
                style::BAND,
            );
            canvas.line(&[(left, y), (right, y)], stroke);
        }
        Swatch::Interval(colour) => {
            canvas.line(
                &[(middle, y - 6.0), (middle, y + 6.0)],
                Stroke::new(colour, 1.1),
            );
            canvas.dot((middle, y), 2.2, colour, false);
        }
        Swatch::Bar(colour) => {
            canvas.rectangle((left, y - 4.0), (middle + 3.0, y + 4.0), colour, 0.45);
            canvas.line(
                &[(middle - 3.0, y), (right - 2.0, y)],
                Stroke::new(style::INK, 1.1),
            );
        }
        Swatch::Diamond => canvas.diamond((middle, y), 4.0, style::INK),
        Swatch::Disc => canvas.dot((middle, y), 4.0, style::INK, false),
        Swatch::Ring => canvas.dot((middle, y), 4.0, style::INK, true),
        Swatch::Rug => {
            for x in [2.0, 5.0, 9.0, 11.0, 16.0, 20.0] {
                canvas.line(
                    &[(left + x, y - 3.5), (left + x, y + 3.5)],
                    Stroke::new(style::INK, 0.6),
                );
            }
        }
    }
}

/// Opacity of the area under the truth.
pub(super) const FILL: f64 = 0.06;

/// Heights for labels that want to stand at `wanted`, at least `gap` apart and within `low..=high`, moved as little as that allows.
pub(super) fn spread(wanted: &[f64], gap: f64, low: f64, high: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    // Labels in contact form groups that stand centred on what their members want: least squares under order constraints, by
    // merging neighbours that overlap [the pool-adjacent-violators algorithm].
    let mut groups: Vec<(f64, usize)> = Vec::new();
    for (rank, &index) in order.iter().enumerate() {
        let mut group = (wanted[index].clamp(low, high) - gap * rank as f64, 1);
        while let Some(&(mean, count)) = groups.last() {
            if mean <= group.0 {
                break;
            }
            groups.pop();
            group = (
                (mean * count as f64 + group.0 * group.1 as f64) / (count + group.1) as f64,
                count + group.1,
            );
        }
        groups.push(group);
    }
    let last = gap * wanted.len().saturating_sub(1) as f64;
    let starts = groups
        .iter()
        .flat_map(|&(mean, count)| std::iter::repeat_n(mean.min(high - last).max(low), count));
    let mut placed = vec![0.0; wanted.len()];
    for (rank, (start, &index)) in starts.zip(&order).enumerate() {
        placed[index] = start + gap * rank as f64;
    }
    placed
}

/// The right end of a curve.
#[derive(Clone, Debug)]
pub(super) struct End {
    /// Abscissa and value.
    pub at: Place,
    pub name: String,
    pub stroke: Stroke,
}

/// Names of curves beside their right ends, no wider than `room`.
pub(super) fn label_ends(panel: &Panel, canvas: &Canvas, ends: &[End], room: f64) {
    let frame = &panel.frame;
    let height = |end: &End| frame.down(end.at.1).clamp(frame.top, frame.bottom());
    let wanted: Vec<f64> = ends.iter().map(height).collect();
    let placed = spread(&wanted, 14.0, frame.top + 4.0, frame.bottom() - 4.0);
    let x = ends
        .iter()
        .map(|end| frame.across(end.at.0))
        .fold(frame.left, f64::max)
        .min(frame.right());
    for (end, y) in ends.iter().zip(placed) {
        let leader = [
            (frame.across(end.at.0).min(x) + 3.0, height(end)),
            (x + 13.0, y),
        ];
        canvas.line(&leader, Stroke::new(end.stroke.colour, 0.8));
        let text = fit(&end.name, style::LABEL, room - 18.0);
        canvas.text(
            (x + 16.0, y),
            &text,
            Type::new(style::LABEL, style::INK, Hang::Left),
        );
    }
}

/// Names over vertical lines. Each name is a flag to the right of its line; a line further right that would cut the flag belongs to a
/// lower tier, so no name touches another name or a line, however close the lines are.
pub(super) struct Markers<'a> {
    placed: Vec<Flag<'a>>,
}

struct Flag<'a> {
    marker: &'a Marker,
    /// Place of the line and left end of the name.
    x: f64,
    tier: usize,
    name: String,
}

const TIER: f64 = 13.0;

impl<'a> Markers<'a> {
    /// Finds the tiers for the markers over `frame`; names may run to `limit`. A marker off the axis is named, with its value, at the
    /// side where it would be.
    pub fn new(markers: &'a [Marker], frame: Frame, limit: f64) -> Self {
        let mut order: Vec<&Marker> = markers
            .iter()
            .filter(|marker| frame.x.place(marker.at).is_finite())
            .collect();
        order.sort_by(|a, b| b.at.total_cmp(&a.at));
        let mut placed: Vec<Flag> = Vec::new();
        for marker in order {
            let x = frame.across(marker.at).clamp(frame.left, frame.right());
            let name = match (frame.spans(marker.at), x > frame.left) {
                (true, _) => marker.name.clone(),
                (false, true) => format!("→ {} {}", marker.name, significant(marker.at, 3)),
                (false, false) => format!("← {} {}", marker.name, significant(marker.at, 3)),
            };
            let name = fit(&name, style::TICK, limit - x - 4.0);
            let end = x + width(&name, style::TICK) + 8.0;
            let tier = placed
                .iter()
                .filter(|flag| flag.x <= end)
                .map(|flag| flag.tier + 1)
                .max()
                .unwrap_or(0);
            placed.push(Flag {
                marker,
                x,
                tier,
                name,
            });
        }
        Self { placed }
    }

    /// Height of all tiers.
    pub fn height(&self) -> f64 {
        self.placed
            .iter()
            .map(|flag| TIER * (flag.tier as f64 + 1.0) + 2.0)
            .fold(0.0, f64::max)
    }

    /// Room to the right of `frame` that the names would like.
    pub fn overhang(markers: &[Marker], frame: Frame) -> f64 {
        let placed = Markers::new(markers, frame, f64::INFINITY).placed;
        placed
            .iter()
            .map(|flag| flag.x + width(&flag.name, style::TICK) + 6.0 - frame.right())
            .fold(0.0, f64::max)
    }

    /// Draws lines and names; the names stand directly over the frame.
    pub fn draw(&self, canvas: &Canvas, frame: Frame) {
        for flag in &self.placed {
            let y = frame.top - 8.0 - TIER * flag.tier as f64;
            if frame.spans(flag.marker.at) {
                canvas.line(
                    &[(flag.x, frame.bottom()), (flag.x, y - 4.0)],
                    Stroke::new(style::MUTED, 0.9).dashed("3 3"),
                );
            }
            canvas.text(
                (flag.x + 4.0, y),
                &flag.name,
                Type::new(style::TICK, style::INK, Hang::Left),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figure::scale::Scale;

    #[test]
    fn labels_spread_by_the_least_movement() {
        assert_eq!(spread(&[10.0, 50.0], 14.0, 0.0, 100.0), [10.0, 50.0]);
        assert_eq!(
            spread(&[50.0, 50.0, 50.0], 10.0, 0.0, 100.0),
            [40.0, 50.0, 60.0]
        );
        assert_eq!(spread(&[98.0, 99.0], 10.0, 0.0, 100.0), [90.0, 100.0]);
        assert_eq!(spread(&[-5.0, 3.0], 10.0, 0.0, 100.0), [0.0, 10.0]);
        let crowded = spread(&[20.0, 22.0, 24.0, 80.0, 81.0], 12.0, 0.0, 100.0);
        let mut sorted = crowded.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(
            sorted.windows(2).all(|pair| pair[1] - pair[0] > 11.999),
            "{crowded:?}"
        );
    }

    #[test]
    fn marker_names_never_touch_each_other_or_a_line() {
        let frame = Frame {
            left: 50.0,
            top: 60.0,
            width: 300.0,
            height: 100.0,
            x: Scale::logarithmic(0.1, 1.0),
            y: Scale::linear(0.0, 1.0),
        };
        let at = [
            0.30,
            0.31,
            0.32,
            0.33,
            0.34,
            0.9,
            0.95,
            0.101,
            7.0,
            0.001,
            f64::NAN,
        ];
        let markers: Vec<Marker> = at
            .iter()
            .enumerate()
            .map(|(i, &at)| Marker {
                name: format!("marker number {i}"),
                at,
            })
            .collect();
        let placed = Markers::new(&markers, frame, 480.0).placed;
        assert_eq!(placed.len(), 10);
        let end = |flag: &Flag| flag.x + 4.0 + width(&flag.name, style::TICK);
        for (index, flag) in placed.iter().enumerate() {
            assert!(end(flag) <= 480.0 && flag.x >= frame.left, "{}", flag.name);
            for other in placed
                .iter()
                .take(index)
                .chain(placed.iter().skip(index + 1))
            {
                let apart = end(flag) < other.x || end(other) < flag.x;
                assert!(
                    flag.tier != other.tier || apart,
                    "{} over {}",
                    flag.name,
                    other.name
                );
                let cut = other.tier > flag.tier && flag.x + 4.0 <= other.x && other.x <= end(flag);
                assert!(
                    !cut || !frame.spans(other.marker.at),
                    "the line of {} cuts {}",
                    other.name,
                    flag.name
                );
            }
        }
    }
}
