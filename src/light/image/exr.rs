//! Pictures for other programs: linear values, nothing lost.

use super::{Image, ImageError};
use exr::prelude::{SpecificChannels, WritableImage};
use std::io::Cursor;

/// The image as the bytes of an OpenEXR file: R, G, B in 32-bit floats, scan lines, without loss.
///
/// # Errors
/// If the writer refuses it.
pub fn exr(image: &Image) -> Result<Vec<u8>, ImageError> {
    let width = image.width();
    let channels = SpecificChannels::rgb(|at: exr::prelude::Vec2<usize>| {
        let [r, g, b] = image.pixels()[at.y() * width + at.x()];
        (r, g, b)
    });
    let mut file = Cursor::new(Vec::new());
    exr::prelude::Image::from_channels((width, image.height()), channels)
        .write()
        .non_parallel()
        .to_buffered(&mut file)?;
    Ok(file.into_inner())
}
