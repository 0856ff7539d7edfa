//! Light that comes straight from the lamps, in closed form where nothing stands between.

use super::patch::{Patch, patches};
use super::radiosity::seen_between;
use crate::light::scene::Scene;
use crate::light::vector::Vector;

/// The flat lamps of a scene.
pub struct Lamps {
    parts: Vec<(Patch, [f64; 3])>,
}

/// How often a lamp is quartered where it is seen in part: 4⁶ pieces, a shadow's edge to a thousandth of the light.
const DEPTH: u32 = 6;

impl Lamps {
    /// The lamps among the flat surfaces of `scene`.
    pub fn of(scene: &Scene) -> Self {
        let parts = patches(scene, f64::INFINITY)
            .into_iter()
            .filter_map(|patch| {
                let emission = scene.surfaces()[patch.surface].emission.as_ref()?;
                Some((patch, emission.exitance()))
            });
        Self {
            parts: parts.collect(),
        }
    }

    /// The irradiance on the front of a small surface from the lamps alone. [Lambert 1760]
    pub fn irradiance(&self, scene: &Scene, place: Vector, normal: Vector) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (lamp, exitance) in &self.parts {
            let seen = seen_between(scene, lamp, place, normal, DEPTH);
            for (sum, m) in sum.iter_mut().zip(exitance) {
                *sum += seen * m;
            }
        }
        sum
    }
}
