//! The balance of light in a room of diffuse flat surfaces, and the irradiance that follows from it at any place.
//!
//! Light between patches is balanced once ([`FormFactors::solve`](super::FormFactors::solve)); the irradiance at a place is then gathered from all patches with the
//! closed form of each, so that only the radiosity of the patches is cut into steps, not the irradiance. Two levels, one with patches of half the size,
//! tell how far off that leaves it, and are extrapolated. \[Richardson 1911\]
//!
//! # References
//! Goral et al. 1984; Lischinski, Tampieri & Greenberg 1993 (a global pass and a local one that gathers from it).

use super::cover::{Cover, cover};
use super::patch::{Patch, patches};
use super::system::Unbalanced;
use super::transfer::form_factors;
use crate::light::cie;
use crate::light::emission::bands;
use crate::light::scene::{Scene, Shape, Surface};
use crate::light::spectrum::Colour;
use crate::light::vector::Vector;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

/// Why a scene has no radiosity solution.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RadiosityError {
    /// A surface that is not flat.
    #[error("radiosity needs flat surfaces, and \"{0}\" is not")]
    Curved(String),
    /// A surface that is not diffuse.
    #[error("radiosity needs diffuse surfaces, and \"{0}\" is not")]
    Glossy(String),
    /// Too many patches.
    #[error("{0} patches are too many: their form factors would not fit into memory")]
    Many(usize),
    /// No balance.
    #[error(transparent)]
    Unbalanced(#[from] Unbalanced),
}

/// The most patches: the form factors take 800 MB.
const MOST: usize = 10_000;

/// One level: patches and their radiosity.
struct Level {
    patches: Vec<Patch>,
    /// What leaves each patch in each channel, emission included.
    radiosity: Vec<[f64; 3]>,
    /// Whether each patch emits.
    shines: Vec<bool>,
}

/// A solved room.
pub struct Radiosity {
    scene: Arc<Scene>,
    coarse: Level,
    fine: Level,
}

/// Irradiance in three channels (X, Y and Z where colour is known by wavelength), and how far the two levels are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gathered {
    /// Extrapolated from both levels: fine + (fine - coarse)/3.
    pub irradiance: [f64; 3],
    /// |fine - coarse|/3: what the extrapolation changed.
    pub change: [f64; 3],
}

impl Radiosity {
    /// The solution with about `patches` patches on the fine level, a quarter of it on the other. O(patches²) rays and closed forms: for 2000
    /// patches of the Cornell box 8·10⁶ rays.
    ///
    /// # Errors
    /// If the scene is not one of flat, diffuse surfaces, or its light has no balance.
    pub fn solve(scene: &Arc<Scene>, patches: usize) -> Result<Self, RadiosityError> {
        Self::can(scene)?;
        let area: f64 = scene.surfaces().iter().map(Surface::area).sum();
        let size = (area / patches.max(1) as f64).sqrt();
        Ok(Self {
            scene: scene.clone(),
            coarse: Level::solve(scene, 2.0 * size)?,
            fine: Level::solve(scene, size)?,
        })
    }

    /// Whether the scene is one that radiosity is for.
    ///
    /// # Errors
    /// With the reason, if not.
    pub fn can(scene: &Scene) -> Result<(), RadiosityError> {
        for surface in scene.surfaces() {
            let name = || surface.name.clone();
            if matches!(surface.shape, Shape::Sphere(_)) {
                return Err(RadiosityError::Curved(name()));
            }
            if !surface.material.is_diffuse() {
                return Err(RadiosityError::Glossy(name()));
            }
        }
        Ok(())
    }

    /// How many patches the fine level has.
    pub fn patches(&self) -> usize {
        self.fine.patches.len()
    }

    /// The irradiance on the front of a small surface. O(patches) closed forms and rays.
    pub fn irradiance(&self, place: Vector, normal: Vector) -> Gathered {
        let fine = self.fine.gather(&self.scene, place, normal);
        let coarse = self.coarse.gather(&self.scene, place, normal);
        Gathered {
            irradiance: [0, 1, 2].map(|c: usize| (fine[c] + (fine[c] - coarse[c]) / 3.0).max(0.0)),
            change: [0, 1, 2].map(|c: usize| (fine[c] - coarse[c]).abs() / 3.0),
        }
    }
}

impl Level {
    fn solve(scene: &Scene, size: f64) -> Result<Self, RadiosityError> {
        let patches = patches(scene, size);
        if patches.len() > MOST {
            return Err(RadiosityError::Many(patches.len()));
        }
        let mut factors = form_factors(scene, &patches);
        let covers: Vec<Cover> = patches
            .par_iter()
            .map(|patch| cover(scene, patch))
            .collect();
        factors.uncover(&covers);
        let surface = |patch: &Patch| &scene.surfaces()[patch.surface];
        let mut radiosity = vec![[0.0; 3]; patches.len()];
        for channel in channels(scene) {
            let reflectance: Vec<f64> = patches
                .iter()
                .map(|patch| channel.reflectance(surface(patch)))
                .collect();
            let exitance: Vec<f64> = patches
                .iter()
                .map(|patch| channel.exitance(surface(patch)))
                .collect();
            let solved = factors.solve(&reflectance, &exitance)?;
            for (patch, value) in radiosity.iter_mut().zip(solved) {
                for (sum, share) in patch.iter_mut().zip(channel.shares) {
                    *sum += share * value;
                }
            }
        }
        let shines = patches
            .iter()
            .map(|patch| surface(patch).emission.is_some())
            .collect();
        Ok(Self {
            patches,
            radiosity,
            shines,
        })
    }

    fn gather(&self, scene: &Scene, place: Vector, normal: Vector) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for ((patch, radiosity), &shines) in
            self.patches.iter().zip(&self.radiosity).zip(&self.shines)
        {
            let depth = if shines { LAMP } else { WALL };
            let seen = seen_between(scene, patch, place, normal, depth);
            for (sum, b) in sum.iter_mut().zip(radiosity) {
                *sum += seen * b;
            }
        }
        sum
    }
}

/// A transport of its own: one of three channels, or a band of wavelengths.
struct Channel {
    /// Which of red, green and blue; otherwise a wavelength.
    which: Result<usize, f64>,
    /// What its light counts for in what is recorded.
    shares: [f64; 3],
}

impl Channel {
    fn reflectance(&self, surface: &Surface) -> f64 {
        let spectrum = surface.material.reflectance();
        match self.which {
            Ok(channel) => spectrum.rgb()[channel],
            Err(wavelength) => spectrum.at(wavelength),
        }
    }

    fn exitance(&self, surface: &Surface) -> f64 {
        let Some(emission) = &surface.emission else {
            return 0.0;
        };
        match self.which {
            Ok(channel) => emission.exitance()[channel],
            Err(wavelength) => {
                let table = emission.table();
                let rows = table.rows();
                if (rows[0][0]..=rows[rows.len() - 1][0]).contains(&wavelength) {
                    PI * table.at(wavelength)
                } else {
                    0.0
                }
            }
        }
    }
}

/// The transports of a scene: one for each channel, or for each band in which a lamp shines, recorded as X, Y and Z.
fn channels(scene: &Scene) -> Vec<Channel> {
    if scene.colour == Colour::Rgb {
        return (0..3)
            .map(|channel| Channel {
                which: Ok(channel),
                shares: [0, 1, 2].map(|c: usize| f64::from(u8::from(c == channel))),
            })
            .collect();
    }
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for emission in scene.surfaces().iter().filter_map(|s| s.emission.as_ref()) {
        let ends = emission.table().ends();
        low = low.min(ends[0]);
        high = high.max(ends[1]);
    }
    bands([low, high])
        .map(|(wavelength, width)| Channel {
            which: Err(wavelength),
            shares: cie::tristimulus(wavelength).map(|value| value * width),
        })
        .collect()
}

/// How often a patch that emits is quartered where it is seen in part.
const LAMP: u32 = 4;
/// And one that only reflects.
const WALL: u32 = 1;

/// What is seen of a patch with everything that stands between: where the middles of its quarters are not all seen or all hidden, of the quarters.
pub(super) fn seen_between(
    scene: &Scene,
    patch: &Patch,
    place: Vector,
    normal: Vector,
    depth: u32,
) -> f64 {
    let whole = patch.seen_from(place, normal);
    if whole <= 0.0 {
        return 0.0;
    }
    if depth == 0 {
        return if scene.visible(place, patch.centre()) {
            whole
        } else {
            0.0
        };
    }
    let quarters = patch.quarters();
    let free = quarters
        .iter()
        .filter(|part| scene.visible(place, part.centre()))
        .count();
    match free {
        0 => 0.0,
        4 => whole,
        _ => quarters
            .iter()
            .map(|part| seen_between(scene, part, place, normal, depth - 1))
            .sum(),
    }
}
