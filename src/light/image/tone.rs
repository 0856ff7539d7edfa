//! From linear light to what a screen shows.
//!
//! # References
//! Reinhard, Stark, Shirley & Ferwerda 2002, eqs. 1-4, with the log-average over pixels that are not black; sRGB transfer of IEC 61966-2-1.

use super::{Image, luminance};

/// A tone curve. The same one for all pictures of a comparison, else differences of brightness would be tuned away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    /// What luminances are multiplied by.
    exposure: f32,
    /// The least exposed luminance that is shown as white.
    white: f32,
}

/// The share of the screen's range at which the average of a picture is shown: a grey card.
const KEY: f32 = 0.18;
/// Brightest luminance over average that is still shown without clipping: lamps in view may burn out.
const RANGE: f32 = 20.0;

impl Tone {
    /// The curve that shows the geometric mean of the luminances of `image` as middle grey. A black image stays black.
    pub fn of(image: &Image) -> Self {
        let lit = image
            .pixels()
            .iter()
            .map(|&p| luminance(p))
            .filter(|&l| l > 0.0);
        let (sum, count) = lit.fold((0.0f64, 0u32), |(sum, count), l| {
            (sum + f64::from(l).ln(), count + 1)
        });
        let average = (sum / f64::from(count.max(1))).exp() as f32;
        Self {
            exposure: KEY / average,
            white: KEY * RANGE,
        }
    }

    /// The three bytes of a pixel: luminance L of the exposed value becomes L(1 + L/w²)/(1 + L), colours keep their ratios until they clip.
    pub fn display(&self, pixel: [f32; 3]) -> [u8; 3] {
        let exposed = pixel.map(|value| value * self.exposure);
        let l = luminance(exposed);
        let scale = (1.0 + l / (self.white * self.white)) / (1.0 + l);
        exposed.map(|value| {
            let shown = (value * scale).clamp(0.0, 1.0);
            let encoded = if shown <= 0.003_130_8 {
                12.92 * shown
            } else {
                1.055f32.mul_add(shown.powf(1.0 / 2.4), -0.055)
            };
            (255.0 * encoded).round() as u8
        })
    }
}
