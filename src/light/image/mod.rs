//! Pictures: linear light on pixels, and the files they go to.
//!
//! An [`Image`] holds radiometric values and is what metrics compare; a [`Tone`] turns it into something for a screen, for figures only.

mod exr;
mod png;
mod tone;

pub use exr::exr;
pub use png::png;
pub use tone::Tone;

/// Linear light in three channels on pixels, rows from the top, each from the left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

/// Why an image could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The PNG encoder refused.
    #[error("the picture cannot be written as PNG: {0}")]
    Png(#[from] ::png::EncodingError),
    /// The EXR writer refused.
    #[error("the picture cannot be written as OpenEXR: {0}")]
    Exr(#[from] ::exr::error::Error),
}

impl Image {
    /// An image from its pixels.
    ///
    /// # Panics
    /// If there is no pixel, or not as many as width × height.
    pub fn new(width: usize, height: usize, pixels: Vec<[f32; 3]>) -> Self {
        assert!(width > 0 && height > 0, "an image has pixels");
        assert_eq!(pixels.len(), width * height, "one value for each pixel");
        Self {
            width,
            height,
            pixels,
        }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// The root of the mean squared difference over all pixels and channels, over the root of the mean square of `truth`: 0 where they are equal, 1 for
    /// black. Pixels with a value above `ceiling` in `truth` (lamps seen directly) are left out, since every method shows them alike.
    pub fn relative_error(&self, truth: &Self, ceiling: f32) -> f64 {
        let (mut off, mut all) = (0.0, 0.0);
        for (a, b) in self.pixels.iter().zip(&truth.pixels) {
            if b.iter().all(|&value| value <= ceiling) {
                for (a, b) in a.iter().zip(b) {
                    off += f64::from(a - b).powi(2);
                    all += f64::from(*b).powi(2);
                }
            }
        }
        if all > 0.0 { (off / all).sqrt() } else { 0.0 }
    }
}

/// What an eye makes of linear RGB with the primaries of ITU-R BT.709.
pub fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.2126f32.mul_add(r, 0.7152f32.mul_add(g, 0.0722 * b))
}

#[cfg(test)]
mod tests {
    use super::{Image, Tone, exr, png};
    use ::exr::prelude::traits::*;

    fn ramp() -> Image {
        Image::new(
            4,
            2,
            (0..8).map(|i| [i as f32, 0.25 * i as f32, 100.0]).collect(),
        )
    }

    #[test]
    fn a_png_reads_back_as_the_tones_it_was_given() {
        let (image, tone) = (ramp(), Tone::of(&ramp()));
        let file = png(&image, &tone).expect("written");
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(file))
            .read_info()
            .expect("a PNG");
        let mut bytes = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut bytes).expect("whole");
        let expected: Vec<u8> = image
            .pixels()
            .iter()
            .flat_map(|&p| tone.display(p))
            .collect();
        assert_eq!(bytes, expected);
        assert!(bytes.iter().step_by(3).is_sorted(), "more light is lighter");
    }

    #[test]
    fn an_exr_keeps_every_bit() {
        let file = exr(&ramp()).expect("written");
        let read = ::exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .rgb_channels(
                |size, _| (size.width(), vec![[0.0f32; 3]; size.area()]),
                |(width, pixels), at, (r, g, b): (f32, f32, f32)| {
                    pixels[at.y() * *width + at.x()] = [r, g, b];
                },
            )
            .first_valid_layer()
            .all_attributes()
            .from_buffered(std::io::Cursor::new(file))
            .expect("an EXR");
        assert_eq!(read.layer_data.channel_data.pixels.1, ramp().pixels());
    }

    #[test]
    fn errors_are_relative_and_lamps_do_not_count() {
        let truth = ramp();
        let dim = Image::new(
            4,
            2,
            truth.pixels().iter().map(|p| p.map(|v| 0.9 * v)).collect(),
        );
        assert!((dim.relative_error(&truth, f32::INFINITY) - 0.1).abs() < 1e-6);
        assert!(
            dim.relative_error(&truth, 1.0) < f64::MIN_POSITIVE,
            "all pixels have a lamp in blue"
        );
    }
}
