//! Where photons come from.

use super::carried::{Carried, Channels, Wave};
use crate::light::emission::{Emission, Wavelengths};
use crate::light::scene::Scene;
use crate::light::spectrum::Colour;
use crate::light::vector::Vector;
use rand::{Rng, RngExt};

/// A photon about to leave its lamp.
#[derive(Clone, Copy)]
pub(super) struct Start<L> {
    pub(super) origin: Vector,
    /// About which its direction has the cosine for its density.
    pub(super) normal: Vector,
    /// As in [`Ray::leaving`](crate::light::vector::Ray::leaving).
    pub(super) leaving: u32,
    pub(super) light: L,
}

/// The surfaces that shine.
#[derive(Debug)]
pub(super) struct Lamps {
    lamps: Vec<Lamp>,
    /// The power of the lamps up to each, itself included.
    cumulative: Vec<f64>,
}

#[derive(Debug)]
struct Lamp {
    surface: usize,
    /// The number of its first primitive; those of its other parts follow.
    primitive: u32,
    /// The share of its power in each channel.
    shares: [f64; 3],
    /// Only over wavelengths.
    wavelengths: Option<Wavelengths>,
}

/// Light that a lamp can give.
pub(super) trait Given: Carried {
    fn given(lamps: &Lamps, lamp: usize, power: f64, random: &mut impl Rng) -> Self;
}

impl Lamps {
    pub(super) fn new(scene: &Scene) -> Self {
        let mut lamps = Vec::new();
        let mut cumulative = Vec::new();
        let mut sum = 0.0;
        for (surface, about) in scene.surfaces().iter().enumerate() {
            let Some(emission) = &about.emission else {
                continue;
            };
            let (power, shares) = power(emission, scene.colour);
            if power <= 0.0 {
                continue;
            }
            sum += power * about.area();
            cumulative.push(sum);
            lamps.push(Lamp {
                surface,
                primitive: scene.primitive(surface, 0).unwrap_or(0),
                shares,
                wavelengths: (scene.colour == Colour::Spectral)
                    .then(|| Wavelengths::new(emission.table())),
            });
        }
        Self { lamps, cumulative }
    }

    /// The power of all lamps.
    pub(super) fn total(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }

    /// One of `paths` photons.
    #[inline(always)]
    pub(super) fn start<L: Given>(
        &self,
        scene: &Scene,
        paths: u64,
        random: &mut impl Rng,
    ) -> Start<L> {
        let chosen = if self.lamps.len() == 1 {
            0
        } else {
            let wanted = random.random::<f64>() * self.total();
            self.cumulative
                .partition_point(|&sum| sum <= wanted)
                .min(self.lamps.len() - 1)
        };
        let surface = self.lamps[chosen].surface;
        let shape = &scene.surfaces()[surface].shape;
        let light = L::given(self, chosen, self.total() / paths as f64, random);
        let (choice, s, t) = (random.random(), random.random(), random.random());
        let (part, origin) = shape.draw(choice, s, t);
        Start {
            origin,
            normal: shape.normal(part, origin),
            leaving: self.lamps[chosen].primitive + part as u32,
            light,
        }
    }
}

/// Power per area, and the share of each channel in it.
fn power(emission: &Emission, colour: Colour) -> (f64, [f64; 3]) {
    match colour {
        Colour::Rgb => {
            let exitance = emission.exitance();
            let total: f64 = exitance.iter().sum();
            (total, exitance.map(|channel| channel / total))
        }
        Colour::Spectral => (emission.spectral_exitance(), [0.0; 3]),
    }
}

impl Given for Channels {
    #[inline(always)]
    fn given(lamps: &Lamps, lamp: usize, power: f64, _random: &mut impl Rng) -> Self {
        Self(lamps.lamps[lamp].shares.map(|share| share * power))
    }
}

impl Given for Wave {
    #[inline(always)]
    fn given(lamps: &Lamps, lamp: usize, power: f64, random: &mut impl Rng) -> Self {
        let wavelengths = lamps.lamps[lamp].wavelengths.as_ref();
        let wavelength = wavelengths.map_or(0.0, |drawer| drawer.at(random.random()));
        Self::new(power, wavelength)
    }
}
