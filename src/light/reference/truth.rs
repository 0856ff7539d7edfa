//! The true irradiance over a surface as a field.

use super::direct::Lamps;
use super::path::{Measured, PathTracer};
use super::radiosity::Radiosity;
use crate::light::scene::Scene;
use crate::light::vector::Vector;
use crate::random;
use crate::space::{Domain, Evaluation, Field, Grid, Point, Targets};
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// Where the truth about a scene comes from.
///
/// Rooms of flat diffuse surfaces are solved (see [`Radiosity`]); for all others paths are traced from each place, `PATHS` of
/// them with a stream of random numbers that the place decides, so that a place always has the same value.
pub struct Reference {
    scene: Arc<Scene>,
    /// Solved when it is first needed.
    solved: OnceLock<Option<Radiosity>>,
}

/// Patches of the fine level: the mean irradiance of each wall of the Cornell box with blocks is then right to 0.5 % (against traced paths; the
/// faces of the blocks that see little but shadows: 2 %), see `benches/evidence/light/`.
const PATCHES: usize = 2400;
/// Paths for the irradiance at one place: 2 % in a room lit by a small lamp.
pub const PATHS: usize = 4096;

impl Reference {
    /// For `scene`; nothing is computed yet.
    pub fn new(scene: Arc<Scene>) -> Self {
        Self {
            scene,
            solved: OnceLock::new(),
        }
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The balance of light, where the scene has one. A few seconds at the first call.
    pub fn solved(&self) -> Option<&Radiosity> {
        let solve = || Radiosity::solve(&self.scene, PATCHES).ok();
        self.solved.get_or_init(solve).as_ref()
    }

    /// The irradiance in each channel at (u, v) of a surface: NaN where it is not known, which is only in scenes that know colour by wavelength.
    pub fn irradiance(&self, surface: usize, [u, v]: Point<2>) -> [f64; 3] {
        let shape = &self.scene.surfaces()[surface].shape;
        let place = shape.place(0, u, v);
        let normal = shape.normal(0, place);
        let primitive = self.scene.primitive(surface, 0);
        self.irradiance_in_space((place, normal), primitive, (surface, [u, v]))
    }

    /// The same at a place in space with the direction in which the surface looks there, on a primitive; coordinates on the surface, which need not tell
    /// the facets of a mesh apart, only choose the random numbers.
    pub fn irradiance_in_space(
        &self,
        (place, normal): (Vector, Vector),
        primitive: Option<u32>,
        (surface, [u, v]): (usize, Point<2>),
    ) -> [f64; 3] {
        if let Some(solved) = self.solved() {
            return solved.irradiance(place, normal).irradiance;
        }
        let Some(tracer) = PathTracer::new(&self.scene) else {
            return [f64::NAN; 3];
        };
        let mut random = random::stream(
            u.to_bits() ^ v.to_bits().rotate_left(32),
            "truth",
            surface as u64,
        );
        Measured::of(PATHS, || {
            tracer.irradiance(place, normal, primitive, &mut random)
        })
        .mean
    }

    /// The mean irradiance over each cell of `grid` that lies on a surface, from `across`² places of each. In parallel.
    pub fn cell_means(&self, surface: usize, grid: &Grid<2>, across: usize) -> Vec<[f64; 3]> {
        let domain = self.scene.surfaces()[surface].domain();
        let across = across.max(1);
        let step = [0, 1].map(|axis: usize| grid.width(axis) / across as f64);
        (0..grid.len())
            .into_par_iter()
            .map(|cell| {
                let centre = grid.centre(cell);
                let (mut sum, mut count) = ([0.0; 3], 0.0);
                for i in 0..across * across {
                    let at = [i / across, i % across];
                    let place = [0, 1].map(|axis: usize| {
                        let off = at[axis] as f64 - 0.5 * (across - 1) as f64;
                        off.mul_add(step[axis], centre[axis])
                    });
                    if domain.is_none_or(|domain| domain.contains(place)) {
                        count += 1.0;
                        for (sum, e) in sum.iter_mut().zip(self.irradiance(surface, place)) {
                            *sum += e;
                        }
                    }
                }
                sum.map(|sum| if count > 0.0 { sum / count } else { 0.0 })
            })
            .collect()
    }
}

/// Which light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Light {
    /// All of it.
    All,
    /// Straight from flat lamps.
    Direct,
    /// All the rest.
    Indirect,
}

/// The true irradiance over one surface, all channels together: what a sample of hits there estimates.
pub struct SurfaceTruth {
    reference: Arc<Reference>,
    surface: usize,
    light: Light,
    lamps: Lamps,
    domain: Domain<2>,
}

impl SurfaceTruth {
    /// Over a surface of the scene; `None` for one without (u, v).
    pub fn new(reference: Arc<Reference>, surface: usize, light: Light) -> Option<Self> {
        let domain = reference.scene.surfaces()[surface].domain()?.clone();
        Some(Self {
            lamps: Lamps::of(&reference.scene),
            light,
            reference,
            surface,
            domain,
        })
    }
}

impl Field<2> for SurfaceTruth {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        if !self.domain.contains(x) {
            return 0.0;
        }
        let all = || {
            self.reference
                .irradiance(self.surface, x)
                .iter()
                .sum::<f64>()
        };
        let direct = || {
            let shape = &self.reference.scene.surfaces()[self.surface].shape;
            let place = shape.place(0, x[0], x[1]);
            let normal = shape.normal(0, place);
            let direct = self.lamps.irradiance(&self.reference.scene, place, normal);
            direct.iter().sum::<f64>()
        };
        match self.light {
            Light::All => all(),
            Light::Direct => direct(),
            Light::Indirect => all() - direct(),
        }
    }

    fn evaluate(&self, targets: Targets<'_, 2>) -> Evaluation {
        if self.light != Light::Direct {
            // once, before all threads want it
            self.reference.solved();
        }
        let places: Vec<Point<2>> = targets.places().collect();
        Evaluation {
            values: places.par_iter().map(|&x| self.at(x)).collect(),
            ..Evaluation::default()
        }
    }
}
