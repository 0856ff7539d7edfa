//! Maps of values over the plane: colours, level lines, walls; several side by side on one scale of colours.

use super::canvas::{Canvas, Hang, MARGIN, Type};
use super::colour::Colours;
use super::curves::{WIDTH, nothing};
use super::panel::{Panel, overhang, room_left, title, widest};
use super::path::Place;
use super::pieces::{Piece, outlined};
use super::pixels::encoded;
use super::scale::{Scale, Ticks};
use super::style::{self, Stroke};
use super::{Axis, Svg};
use crate::report::text::{BOLDER, fit, fit_with};
use plotters::style::RGBColor;

/// One map.
#[derive(Clone, Debug, Default)]
pub struct Map {
    /// What it shows.
    pub title: String,
    /// A number that stands behind the title and stays whole where that is shortened; may be empty.
    pub value: String,
    /// A value for each cell, the second axis fastest; what is not a number is left white.
    pub values: Vec<f64>,
}

/// Maps over the same cells with the same colours.
#[derive(Clone, Debug, Default)]
pub struct HeatMaps {
    /// Printed at the top; may be empty.
    pub title: String,
    /// What the figure shows, for those who do not see it.
    pub description: String,
    /// The first axis, from left to right.
    pub x: Axis,
    /// The second axis, upwards.
    pub y: Axis,
    /// The lower corner of the cells.
    pub low: [f64; 2],
    /// The upper corner.
    pub high: [f64; 2],
    /// How many cells each axis has.
    pub cells: [usize; 2],
    /// What the colours mean.
    pub label: String,
    /// How values become colours.
    pub colours: Colours,
    /// Level lines at round values, labelled.
    pub levels: bool,
    /// The corners of the polygon that bounds the domain; empty where there is none.
    pub outline: Vec<[f64; 2]>,
    /// Pieces that the maps are put together of, outlined and named; axes and their numbers mean nothing then and are left out.
    pub pieces: Vec<Piece>,
    /// A line drawn across each map, such as that of a cross-section; empty where there is none.
    pub across: Vec<[f64; 2]>,
    /// Maps in a row.
    pub columns: usize,
    /// The maps, row by row.
    pub maps: Vec<Map>,
}

/// The most pixels of a map on each axis; finer values are averaged.
const PIXELS: usize = 1024;
/// The most height of one map.
const TALLEST: f64 = 420.0;
/// Width of the colour bar.
const BAR: f64 = 13.0;

/// Where the maps lie.
struct Layout {
    columns: usize,
    x: Scale,
    y: Scale,
    left: f64,
    top: f64,
    size: (f64, f64),
    gap: f64,
    pitch: f64,
}

impl Layout {
    fn ticks(&self) -> (Ticks, Ticks) {
        (
            self.x.ticks(self.size.0, true),
            self.y.ticks(self.size.1, false),
        )
    }

    fn corner(&self, index: usize) -> Place {
        let (row, column) = (index / self.columns, index % self.columns);
        (
            self.left + column as f64 * (self.size.0 + self.gap),
            self.top + row as f64 * self.pitch,
        )
    }

    fn rows(&self, maps: usize) -> usize {
        maps.div_ceil(self.columns).max(1)
    }
}

impl HeatMaps {
    /// The figure.
    pub fn draw(&self) -> Svg {
        let scale = self.scale();
        let bar_ticks = scale.ticks(200.0, false);
        let bar_room = if self.colours == Colours::Ink {
            0.0
        } else {
            BAR + 12.0 + widest(&bar_ticks) + 32.0
        };
        let mut layout = self.layout(bar_room);
        let heading = Canvas::new(WIDTH, 1.0).title(&self.title, WIDTH - 2.0 * MARGIN);
        let titled = self.maps.iter().any(|map| !map.title.is_empty());
        layout.top = heading + if titled { 22.0 } else { 8.0 };
        let rows = layout.rows(self.maps.len());
        let bottom = layout.top + layout.pitch * (rows - 1) as f64 + layout.size.1;
        let below = if self.pieces.is_empty() { 44.0 } else { 12.0 };
        let canvas = Canvas::new(WIDTH, bottom + below);
        canvas.title(&self.title, WIDTH - 2.0 * MARGIN);
        for index in 0..self.maps.len() {
            self.map(&canvas, &layout, index, scale);
        }
        if self.maps.is_empty() {
            let panel = canvas.panel((layout.left, layout.top), layout.size, layout.x, layout.y);
            nothing(&canvas, &panel.frame);
        }
        self.titles(&canvas, &layout, bottom);
        let shown = self.maps.len().clamp(1, layout.columns);
        let right = layout.corner(shown - 1).0 + layout.size.0;
        let height = (bottom - layout.top).min(TALLEST);
        let at = (
            right + 14.0,
            layout.top + 0.5 * (bottom - layout.top - height),
        );
        if self.colours != Colours::Ink {
            self.bar(&canvas, at, height, scale);
        }
        canvas.finish(&self.title, &self.description)
    }

    /// Amounts start at zero unless all are far from it; errors reach as far down as up.
    fn scale(&self) -> Scale {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in self.maps.iter().flat_map(|map| &map.values) {
            if value.is_finite() {
                (low, high) = (low.min(*value), high.max(*value));
            }
        }
        match self.colours {
            Colours::Ink => Scale::linear(0.0, 1.0),
            Colours::Signed => {
                let most = low.abs().max(high.abs());
                let most = if most > 0.0 && most.is_finite() {
                    most
                } else {
                    1.0
                };
                Scale::linear(-most, most)
            }
            Colours::Amount if low > high => Scale::linear(0.0, 1.0),
            Colours::Amount if low >= 0.0 && low < 0.5 * high => Scale::linear(0.0, high),
            // one value everywhere has the colour of its height above zero
            Colours::Amount if high - low <= 1e-12 * high.abs() => {
                Scale::linear(high.min(0.0), if high > 0.0 { 1.25 * high } else { 1.0 })
            }
            Colours::Amount => Scale::linear(low, high),
        }
    }

    fn layout(&self, bar_room: f64) -> Layout {
        let columns = self.columns.clamp(1, 4).min(self.maps.len().max(1));
        let (x, y) = (
            Scale::linear(self.low[0], self.high[0]),
            Scale::linear(self.low[1], self.high[1]),
        );
        let extent = |scale: Scale| {
            let (low, high) = scale.ends();
            high - low
        };
        // one unit is as long upwards as across, unless that would make a thread of the map
        let shape = (extent(y) / extent(x)).clamp(0.2, 3.0);
        let (left, gap, below) = if self.pieces.is_empty() {
            let gap = 14.0 + overhang(x, 200.0).1 + overhang(x, 200.0).0;
            (room_left(y, 200.0, true) + 6.0, gap, 44.0)
        } else {
            (MARGIN, 14.0, 30.0)
        };
        let room = WIDTH - left - bar_room - MARGIN - gap * (columns - 1) as f64;
        let tallest = if columns == 1 { TALLEST } else { 0.8 * TALLEST };
        let across = (room / columns as f64).min(tallest / shape).max(40.0);
        let size = (across, across * shape);
        Layout {
            columns,
            x,
            y,
            left,
            top: 0.0,
            size,
            gap,
            pitch: size.1 + below,
        }
    }

    fn map(&self, canvas: &Canvas, layout: &Layout, index: usize, scale: Scale) {
        let map = &self.maps[index];
        let corner = layout.corner(index);
        let panel = canvas.panel(corner, layout.size, layout.x, layout.y);
        let frame = panel.frame;
        if let Some(png) = self.picture(&map.values, scale) {
            canvas.image(corner, layout.size, &png);
            if self.levels {
                self.level_lines(canvas, &panel, &map.values, scale);
            }
        } else {
            nothing(canvas, &frame);
        }
        if !self.outline.is_empty() {
            let closed = self.outline.iter().chain(self.outline.first());
            panel.line(closed.map(|p| (p[0], p[1])), Stroke::new(style::INK, 1.3));
        }
        if !self.across.is_empty() {
            let line = || self.across.iter().map(|p| (p[0], p[1]));
            panel.line(line(), Stroke::new(RGBColor(255, 255, 255), 2.2));
            panel.line(line(), Stroke::new(style::INK, 1.1).dashed("4 3"));
        }
        if self.pieces.is_empty() {
            self.frame(canvas, &panel, layout, index);
        } else {
            outlined(&self.pieces, canvas, &panel);
        }
        let size = BOLDER * style::LABEL;
        let room = layout.size.0 + layout.gap - 8.0;
        let name = if map.value.is_empty() {
            fit(&map.title, size, room)
        } else {
            fit_with(&map.title, &format!(": {}", map.value), size, room)
        };
        canvas.text(
            (corner.0, corner.1 - 9.0),
            &name,
            Type::new(style::LABEL, style::INK, Hang::Left).bold(),
        );
    }

    /// The rim of a map, with ticks, and numbers where no other map is between it and the edge.
    fn frame(&self, canvas: &Canvas, panel: &Panel<'_>, layout: &Layout, index: usize) {
        let frame = panel.frame;
        let rim = [
            (frame.left, frame.top),
            (frame.right(), frame.top),
            (frame.right(), frame.bottom()),
            (frame.left, frame.bottom()),
            (frame.left, frame.top),
        ];
        canvas.line(&rim, Stroke::new(style::MUTED, 0.7));
        let (across, down) = layout.ticks();
        for &(value, _) in &across.major {
            let x = frame.across(value);
            canvas.line(
                &[(x, frame.bottom()), (x, frame.bottom() + 3.5)],
                Stroke::new(style::MUTED, 0.7),
            );
        }
        for &(value, _) in &down.major {
            let y = frame.down(value);
            canvas.line(
                &[(frame.left - 3.5, y), (frame.left, y)],
                Stroke::new(style::MUTED, 0.7),
            );
        }
        if index + layout.columns >= self.maps.len() {
            panel.labels_below(&across, 2.0);
        }
        if index.is_multiple_of(layout.columns) {
            panel.labels_left(&down);
        }
    }

    fn titles(&self, canvas: &Canvas, layout: &Layout, bottom: f64) {
        if !self.pieces.is_empty() {
            return;
        }
        let (across, down) = layout.ticks();
        let kind = Type::new(style::LABEL, style::INK, Hang::Middle);
        let shown = self.maps.len().clamp(1, layout.columns) as f64;
        let whole = shown * layout.size.0 + (shown - 1.0) * layout.gap;
        canvas.text(
            (layout.left + 0.5 * whole, bottom + 32.0),
            &fit(&title(&self.x, &across), style::LABEL, whole + layout.left),
            kind,
        );
        let height = bottom - layout.top;
        canvas.text(
            (
                layout.left - widest(&down) - 20.0,
                layout.top + 0.5 * height,
            ),
            &fit(&title(&self.y, &down), style::LABEL, height + 40.0),
            kind.upwards(),
        );
    }

    /// The colours with their values.
    fn bar(&self, canvas: &Canvas, corner: Place, height: f64, scale: Scale) {
        const STEPS: usize = 256;
        let colours = (0..STEPS)
            .rev()
            .flat_map(|step| {
                let RGBColor(red, green, blue) =
                    self.colours.at((step as f64 + 0.5) / STEPS as f64);
                [red, green, blue, 255]
            })
            .collect::<Vec<u8>>();
        let unit = Scale::linear(0.0, 1.0);
        let panel = canvas.panel(corner, (BAR, height), unit, scale);
        canvas.image(corner, (BAR, height), &encoded(1, STEPS, &colours));
        let frame = panel.frame;
        let ticks = scale.ticks(height, false);
        let kind = Type::new(style::TICK, style::MUTED, Hang::Left);
        for (value, label) in &ticks.major {
            let y = frame.down(*value);
            canvas.line(
                &[(frame.right(), y), (frame.right() + 3.5, y)],
                Stroke::new(style::MUTED, 0.7),
            );
            canvas.text((frame.right() + 6.0, y), label, kind);
        }
        let label = title(&Axis::new(self.label.clone(), ""), &ticks);
        canvas.text(
            (
                frame.right() + widest(&ticks) + 18.0,
                frame.top + 0.5 * height,
            ),
            &fit(&label, style::LABEL, height + 20.0),
            Type::new(style::LABEL, style::INK, Hang::Middle).upwards(),
        );
    }

    /// One pixel a cell, upwards on the second axis; blocks of cells are averaged where there are more than the eye can see.
    fn picture(&self, values: &[f64], scale: Scale) -> Option<Vec<u8>> {
        let [across, up] = self.cells;
        if across == 0 || up == 0 || values.len() != across * up {
            return None;
        }
        let block = [across, up].map(|cells| cells.div_ceil(PIXELS));
        let size = [across.div_ceil(block[0]), up.div_ceil(block[1])];
        let mut pixels = Vec::with_capacity(4 * size[0] * size[1]);
        for row in (0..size[1]).rev() {
            for column in 0..size[0] {
                let (mut sum, mut count) = (0.0, 0.0);
                for i in column * block[0]..((column + 1) * block[0]).min(across) {
                    for j in row * block[1]..((row + 1) * block[1]).min(up) {
                        let value = values[i * up + j];
                        if value.is_finite() {
                            sum += value;
                            count += 1.0;
                        }
                    }
                }
                if count > 0.0 {
                    let RGBColor(red, green, blue) = self.colours.at(scale.place(sum / count));
                    pixels.extend([red, green, blue, 255]);
                } else {
                    pixels.extend([0; 4]);
                }
            }
        }
        Some(encoded(size[0], size[1], &pixels))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn maps(values: Vec<f64>, cells: [usize; 2], colours: Colours) -> HeatMaps {
        HeatMaps {
            title: "A <map>".to_owned(),
            x: Axis::new("x", ""),
            y: Axis::new("y", ""),
            low: [0.0; 2],
            high: [1.0; 2],
            cells,
            label: "density".to_owned(),
            colours,
            levels: true,
            columns: 2,
            maps: vec![
                Map {
                    title: "one".to_owned(),
                    value: String::new(),
                    values,
                },
                Map::default(),
            ],
            ..HeatMaps::default()
        }
    }

    #[test]
    fn whatever_the_values_are_a_picture_comes_out() {
        for colours in [Colours::Amount, Colours::Signed] {
            for values in [
                vec![1.0; 6],
                vec![0.0; 6],
                vec![f64::NAN; 6],
                vec![-1.0, 0.0, 1e300, f64::INFINITY, f64::NAN, 2.0],
                vec![1e-300, 2e-300, 0.0, 0.0, 1e-310, 0.0],
                Vec::new(),
            ] {
                let svg = maps(values, [2, 3], colours).draw();
                assert!(svg.as_str().contains("A &lt;map&gt;") && !svg.as_str().contains("NaN"));
            }
        }
    }

    #[test]
    fn the_first_axis_runs_right_and_the_second_up() {
        let figure = maps(vec![0.0, 0.0, 0.0, 0.0, 0.0, 1.0], [2, 3], Colours::Amount);
        let png = figure
            .picture(&figure.maps[0].values, Scale::linear(0.0, 1.0))
            .expect("a value a cell");
        let mut reader = png::Decoder::new(std::io::Cursor::new(png))
            .read_info()
            .expect("a PNG file");
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut pixels).expect("pixels");
        // 2 across, 3 up: the last cell is the right upper corner, the second pixel
        assert_eq!(pixels.len(), 24);
        assert_eq!(pixels[4..8], [0xfd, 0xe7, 0x25, 255]);
        assert_eq!(pixels[0..4], [0x44, 0x01, 0x54, 255]);
    }

    #[test]
    fn signed_colours_are_symmetric() {
        let figure = maps(
            vec![-0.5, 0.25, 0.0, 0.1, 0.0, 0.0],
            [2, 3],
            Colours::Signed,
        );
        assert_eq!(figure.scale().ends(), (-0.5, 0.5));
        let amounts = maps(vec![0.1, 0.25, 1.0, 0.1, 0.2, 0.3], [2, 3], Colours::Amount);
        assert_eq!(amounts.scale().ends(), (0.0, 1.0));
    }
}
