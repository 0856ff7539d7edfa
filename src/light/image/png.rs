//! Pictures for screens.

use super::{Image, ImageError, Tone};

/// The image as the bytes of a PNG file, eight bits a channel in sRGB.
///
/// # Errors
/// If it is too large for the format.
pub fn png(image: &Image, tone: &Tone) -> Result<Vec<u8>, ImageError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, image.width() as u32, image.height() as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    let bytes: Vec<u8> = image
        .pixels()
        .iter()
        .flat_map(|&pixel| tone.display(pixel))
        .collect();
    writer.write_image_data(&bytes)?;
    writer.finish()?;
    Ok(file)
}
