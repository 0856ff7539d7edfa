//! Pictures made of pixels, inside drawings made of lines.

use super::canvas::{Canvas, units};
use super::path::Place;
use base64::Engine as _;

/// Four bytes a pixel as a PNG file.
pub(super) fn encoded(width: usize, height: usize, pixels: &[u8]) -> Vec<u8> {
    const WRITTEN: &str = "writing a picture of the right size into memory cannot fail";
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().expect(WRITTEN);
    writer.write_image_data(pixels).expect(WRITTEN);
    writer.finish().expect(WRITTEN);
    file
}

impl Canvas {
    /// A PNG picture stretched over a rectangle, its pixels kept sharp.
    pub(super) fn image(&self, corner: Place, size: (f64, f64), png: &[u8]) {
        let data = base64::engine::general_purpose::STANDARD.encode(png);
        self.picture(
            (units(corner.0), units(corner.1)),
            (units(size.0), units(size.1)),
            &data,
        );
    }
}
