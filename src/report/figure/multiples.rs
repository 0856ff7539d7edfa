//! Small multiples: many small frames over the same axes, to be compared at a glance.

use super::canvas::{Canvas, Hang, MARGIN, Type};
use super::curves::{WIDTH, abscissae, legend, nothing, ordinate_scale, series};
use super::legend::{Entry, Legend, Swatch};
use super::panel::{overhang, room_left, title};
use super::path::Place;
use super::scale::{Scale, Ticks};
use super::style::{self, Stroke};
use super::{Axis, Role, Series, Svg};
use crate::report::text::{BOLDER, fit, width};

/// One small panel.
#[derive(Clone, Debug, Default)]
pub struct Small {
    /// What it shows.
    pub title: String,
    /// Its curves; series at the same position share a legend entry across panels.
    pub series: Vec<Series>,
}

/// Panels in rows and columns.
#[derive(Clone, Debug, Default)]
pub struct Multiples {
    /// Printed at the top; may be empty.
    pub title: String,
    /// What the figure shows, for those who do not see it.
    pub description: String,
    /// The horizontal axis of every panel; without a range each panel has its own when `shared` is false.
    pub x: Axis,
    /// The vertical axis of every panel.
    pub y: Axis,
    /// Panels in a row.
    pub columns: usize,
    /// One range for all panels, or each its own.
    pub shared: bool,
    /// The panels, row by row.
    pub panels: Vec<Small>,
}

/// Where the panels lie.
struct Layout {
    columns: usize,
    /// Axes of each panel, and of all together.
    scales: Vec<(Scale, Scale)>,
    common: (Scale, Scale),
    /// Horizontal axes are alike, so that labels beneath the last row serve all.
    same_x: bool,
    left: f64,
    top: f64,
    across: f64,
    height: f64,
    between: f64,
}

impl Layout {
    fn new(figure: &Multiples) -> Self {
        let columns = figure.columns.clamp(1, 6).min(figure.panels.len().max(1));
        let height = if columns <= 2 {
            150.0
        } else {
            420.0 / columns as f64 + 8.0
        };
        let all: Vec<Series> = figure
            .panels
            .iter()
            .flat_map(|panel| panel.series.iter().cloned())
            .collect();
        let fitted = |series: &[Series]| {
            (
                figure.x.scale(abscissae(series), 0.0),
                ordinate_scale(&figure.y, series),
            )
        };
        let common = fitted(&all);
        let own = |panel: &Small| {
            if figure.shared {
                common
            } else {
                fitted(&panel.series)
            }
        };
        let scales: Vec<(Scale, Scale)> = figure.panels.iter().map(own).collect();
        // Labels of the vertical axis stand at the first column, or at each panel when each has its own.
        let left = scales
            .iter()
            .map(|(_, y)| room_left(*y, height, false))
            .fold(0.0, f64::max)
            + 16.0;
        let right = 16.0_f64.max(overhang(common.0, (WIDTH - left) / columns as f64).1 + 4.0);
        let split = |between: f64| {
            (WIDTH - left - right - between * (columns as f64 - 1.0)) / columns as f64
        };
        let narrow = if figure.shared { 14.0 } else { left - 14.0 };
        // Tick labels at the ends of neighbouring panels need room side by side.
        let overhang = scales
            .iter()
            .map(|(x, _)| overhang(*x, split(narrow)))
            .fold((0.0, 0.0), |a: (f64, f64), b| (a.0.max(b.0), a.1.max(b.1)));
        let between = narrow.max(overhang.0 + overhang.1 + 6.0);
        let across = split(between).max(30.0);
        Self {
            columns,
            scales,
            common,
            same_x: figure.shared || figure.x.range.is_some(),
            left,
            top: 0.0,
            across,
            height,
            between,
        }
    }

    fn pitch(&self) -> f64 {
        self.height + if self.same_x { 30.0 } else { 42.0 }
    }

    fn bottom(&self) -> f64 {
        self.top + self.pitch() * self.scales.len().div_ceil(self.columns).max(1) as f64
    }

    fn corner(&self, index: usize) -> Place {
        let (row, column) = (index / self.columns, index % self.columns);
        (
            self.left + column as f64 * (self.across + self.between),
            self.top + row as f64 * self.pitch(),
        )
    }
}

impl Multiples {
    /// The figure.
    pub fn draw(&self) -> Svg {
        let mut layout = Layout::new(self);
        let legend = Legend::new(self.entries(), WIDTH - 2.0 * MARGIN);
        let heading = Canvas::new(WIDTH, 1.0).title(&self.title, WIDTH - 2.0 * MARGIN);
        layout.top = heading + legend.height() + 22.0;
        let bottom = layout.bottom();
        let canvas = Canvas::new(WIDTH, bottom + if layout.same_x { 20.0 } else { 8.0 });
        canvas.title(&self.title, WIDTH - 2.0 * MARGIN);
        legend.draw(&canvas, (MARGIN, heading));
        for index in 0..self.panels.len() {
            self.panel(&canvas, &layout, index);
        }
        let size = (layout.across, layout.height);
        if self.panels.is_empty() {
            nothing(
                &canvas,
                &canvas
                    .panel(
                        (layout.left, layout.top),
                        size,
                        layout.common.0,
                        layout.common.1,
                    )
                    .frame,
            );
        }
        // What labels leave out is said once when all share it, and in each panel otherwise.
        let ticks = |scale: Scale, length: f64, across: bool| {
            let ticks = scale.ticks(length, across);
            if self.shared {
                ticks
            } else {
                Ticks {
                    power: 0,
                    offset: 0.0,
                    ..ticks
                }
            }
        };
        let below = title(&self.x, &ticks(layout.common.0, size.0, true));
        let beside = title(&self.y, &ticks(layout.common.1, size.1, false));
        let kind = Type::new(style::LABEL, style::INK, Hang::Middle);
        let middle = (
            layout.left + 0.5 * (WIDTH - layout.left - MARGIN),
            0.5 * (layout.top + bottom) - 12.0,
        );
        canvas.text(
            (middle.0, bottom + if layout.same_x { 4.0 } else { -8.0 }),
            &below,
            kind,
        );
        canvas.text(
            (MARGIN + 6.0, middle.1),
            &fit(&beside, style::LABEL, bottom - layout.top),
            kind.upwards(),
        );
        canvas.finish(&self.title, &self.description)
    }

    fn panel(&self, canvas: &Canvas, layout: &Layout, index: usize) {
        let (small, (x, y)) = (&self.panels[index], layout.scales[index]);
        let corner = layout.corner(index);
        let panel = canvas.panel(corner, (layout.across, layout.height), x, y);
        let (across, down) = (x.ticks(layout.across, true), y.ticks(layout.height, false));
        panel.grid(&across, &down, 0.0);
        if !layout.same_x || index + layout.columns >= self.panels.len() {
            panel.labels_below(&across, 0.0);
        }
        if !self.shared || index.is_multiple_of(layout.columns) {
            panel.labels_left(&down);
        }
        let units: Vec<String> = [(&self.x, &across), (&self.y, &down)]
            .into_iter()
            .filter(|(_, ticks)| !self.shared && (ticks.power != 0 || ticks.offset != 0.0))
            .map(|(axis, ticks)| {
                title(
                    &Axis {
                        unit: String::new(),
                        ..axis.clone()
                    },
                    ticks,
                )
            })
            .collect();
        let note = units.join(", ");
        let right = (panel.frame.right(), corner.1 - 9.0);
        canvas.text(
            right,
            &note,
            Type::new(style::TICK, style::MUTED, Hang::Right),
        );
        let name = fit(
            &small.title,
            BOLDER * style::LABEL,
            layout.across - width(&note, style::TICK) - 6.0,
        );
        canvas.text(
            (corner.0, corner.1 - 9.0),
            &name,
            Type::new(style::LABEL, style::INK, Hang::Left).bold(),
        );
        series(
            &panel,
            &small.series,
            if layout.columns <= 2 { 0.9 } else { 0.75 },
        );
    }

    /// Legend entries: those of the fullest panel, without the series that the panels' titles name already; but what a band is no title says.
    fn entries(&self) -> Vec<Entry> {
        let fullest = self.panels.iter().max_by_key(|panel| panel.series.len());
        let series = fullest
            .map(|panel| panel.series.as_slice())
            .unwrap_or_default();
        let named = |position: usize| {
            self.panels.iter().all(|panel| {
                panel
                    .series
                    .get(position)
                    .is_none_or(|series| series.name == panel.title)
            })
        };
        let entries = legend(series, false).into_iter().enumerate();
        let mut entries: Vec<Entry> = entries
            .filter(|(position, _)| !named(*position))
            .map(|(_, entry)| entry)
            .collect();
        let mut all = series.iter().enumerate();
        if all.any(|(position, s)| named(position) && matches!(s.role, Role::Band { .. })) {
            entries.push(Entry {
                swatch: Swatch::Band(Stroke::new(style::MUTED, 1.6)),
                name: "mean ± one standard deviation".to_owned(),
            });
        }
        entries
    }
}
