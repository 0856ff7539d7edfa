//! Surfaces that shine.

use super::spectrum::Spectrum;
use std::f64::consts::PI;

/// Diffuse emission: the same radiance in all directions on the front of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    /// Power per area and solid angle; over wavelengths also per nm.
    pub radiance: Spectrum,
}

impl Emission {
    /// Power per area of each of red, green and blue: π × radiance.
    pub fn exitance(&self) -> [f64; 3] {
        self.radiance.rgb().map(|radiance| PI * radiance)
    }
}
