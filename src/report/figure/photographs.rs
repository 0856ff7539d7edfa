//! Pictures as a screen shows them, side by side.

use super::Svg;
use super::canvas::{Canvas, Hang, MARGIN, Type};
use super::curves::WIDTH;
use super::pixels::encoded;
use super::style;
use crate::report::text::{BOLDER, fit};

/// One picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Photograph {
    /// What it shows, printed above it.
    pub title: String,
    /// Red, green and blue of each pixel, rows from the top, each from the left; as many as all others have.
    pub pixels: Vec<[u8; 3]>,
}

/// Pictures of one size.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Photographs {
    /// What the figure shows, for those who do not see it.
    pub description: String,
    /// Pixels in a row, and rows.
    pub size: [usize; 2],
    /// Pictures in a row.
    pub columns: usize,
    /// The pictures, row by row.
    pub pictures: Vec<Photograph>,
}

/// Room for a title.
const TITLE: f64 = 22.0;
/// Between pictures.
const GAP: f64 = 14.0;

impl Photographs {
    /// The figure.
    pub fn draw(&self) -> Svg {
        let columns = self.columns.clamp(1, 4);
        let [width, height] = self.size.map(|pixels| pixels.max(1));
        let room = WIDTH - 2.0 * MARGIN - GAP * (columns - 1) as f64;
        let across = room / columns as f64;
        let down = across * height as f64 / width as f64;
        let rows = self.pictures.len().div_ceil(columns).max(1);
        let pitch = TITLE + down + 8.0;
        let canvas = Canvas::new(WIDTH, pitch * rows as f64 + MARGIN);
        for (index, picture) in self.pictures.iter().enumerate() {
            let (row, column) = (index / columns, index % columns);
            let left = MARGIN + column as f64 * (across + GAP);
            let top = row as f64 * pitch + TITLE;
            let pixels: Vec<u8> = picture
                .pixels
                .iter()
                .flat_map(|&[red, green, blue]| [red, green, blue, 255])
                .collect();
            if pixels.len() == 4 * width * height {
                canvas.image(
                    (left, top),
                    (across, down),
                    &encoded(width, height, &pixels),
                );
            }
            canvas.text(
                (left, top - 9.0),
                &fit(&picture.title, BOLDER * style::LABEL, across),
                Type::new(style::LABEL, style::INK, Hang::Left).bold(),
            );
        }
        canvas.finish("", &self.description)
    }
}
