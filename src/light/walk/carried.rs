//! What a photon carries.

use crate::light::cie;
use crate::light::spectrum::Spectrum;

/// What a photon carries: power in one or more channels.
pub(super) trait Carried: Copy {
    /// The power over all channels.
    fn power(&self) -> f64;

    /// What a surface of this reflectance returns of it, times `factor`.
    fn reflected(self, reflectance: &Spectrum, factor: f64) -> Self;

    /// The same in every channel, times `factor`.
    fn scaled(self, factor: f64) -> Self;

    /// What is recorded of it.
    fn flux(&self) -> [f32; 3];
}

/// Red, green and blue.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channels(pub(super) [f64; 3]);

impl Carried for Channels {
    #[inline(always)]
    fn power(&self) -> f64 {
        self.0[0] + self.0[1] + self.0[2]
    }

    #[inline(always)]
    fn reflected(self, reflectance: &Spectrum, factor: f64) -> Self {
        let albedo = reflectance.rgb();
        Self([
            self.0[0] * (albedo[0] * factor),
            self.0[1] * (albedo[1] * factor),
            self.0[2] * (albedo[2] * factor),
        ])
    }

    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        Self([self.0[0] * factor, self.0[1] * factor, self.0[2] * factor])
    }

    #[inline(always)]
    fn flux(&self) -> [f32; 3] {
        [self.0[0] as f32, self.0[1] as f32, self.0[2] as f32]
    }
}

/// One wavelength.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wave {
    power: f64,
    wavelength: f64,
    /// X, Y and Z of one watt.
    tristimulus: [f64; 3],
}

impl Wave {
    pub(super) fn new(power: f64, wavelength: f64) -> Self {
        Self {
            power,
            wavelength,
            tristimulus: cie::tristimulus(wavelength),
        }
    }
}

impl Carried for Wave {
    #[inline(always)]
    fn power(&self) -> f64 {
        self.power
    }

    #[inline(always)]
    fn reflected(self, reflectance: &Spectrum, factor: f64) -> Self {
        self.scaled(reflectance.at(self.wavelength) * factor)
    }

    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        Self {
            power: self.power * factor,
            ..self
        }
    }

    #[inline(always)]
    fn flux(&self) -> [f32; 3] {
        self.tristimulus.map(|value| (value * self.power) as f32)
    }
}
