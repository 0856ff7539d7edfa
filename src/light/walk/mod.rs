//! Photons: from the lamps, by the surfaces, until they are absorbed.
//!
//! The expected density of arrivals, weighted with their flux, solves the rendering equation for irradiance. [Dutré, Bekaert, Bala 2003,
//! "Advanced Global Illumination", ch. 4]
//!
//! A photon starts at a lamp that is chosen by power, at a place uniform by area, in a direction whose cosine to the normal is its density; over
//! wavelengths also with a wavelength chosen by the lamp's spectrum. Its power is Φ/N, N paths sharing the power Φ of all lamps.
//!
//! What happens at a surface is the [`Power`] scheme. A photon carries one power per channel, w. Surviving with the *mean* albedo of a
//! surface while keeping the colour would favour the channels that the surface absorbs; so here the share that survives is that of the power which this
//! photon would keep, q = Σ w ρ / Σ w, and what survives carries w ρ / q: each channel is right on the average, and the total power of a photon
//! never changes.
//!
//! Paths come in blocks, each with a random stream of its own: results are the same for any number of threads.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

mod carried;
mod lamps;
#[cfg(test)]
mod tests;

use super::hits::{Hits, Record};
use super::ledger::{Ledger, LedgerError};
use super::material::Material;
use super::scene::Scene;
use super::spectrum::Colour;
use super::vector::Ray;
use crate::memory::{self, TooLarge};
use crate::random::{Stream, stream};
use carried::{Carried, Channels, Wave};
use lamps::{Given, Lamps, Start};
use pulp::{Arch, Simd, WithSimd};
use rand::RngExt;
use rayon::prelude::*;

/// Paths in a block.
pub const BLOCK: u64 = 4096;
/// The most paths of a walk.
pub const PATHS: u64 = 4_000_000_000;
/// Blocks traced before their hits are sorted to surfaces.
const BATCH: u64 = 64;

/// What happens to the power of a photon at a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Power {
    /// Always the same: the photon survives with the share of its power that is reflected.
    #[default]
    Same,
    /// Attenuated: the photon goes on with what is reflected. Once that is below `threshold` of its first power it is killed with
    /// probability `kill`, or goes on with its power divided by 1 − `kill` (Russian roulette).
    Attenuated {
        /// As a share of the first power.
        threshold: f64,
        /// From 0 to below 1.
        kill: f64,
    },
}

/// Why there are no hits.
#[derive(Debug, thiserror::Error)]
pub enum WalkError {
    /// No paths, or too many.
    #[error("{0} photons: allowed are 1 to {PATHS}")]
    Paths(u64),
    /// Settings of the roulette that do not let paths end, or bring them to an end at once.
    #[error(
        "roulette with threshold {threshold} and probability {kill}: the threshold must be from 0 (excluded) to 1, the probability between 0 and 1"
    )]
    Roulette {
        /// As given.
        threshold: f64,
        /// As given.
        kill: f64,
    },
    /// The light does not add up.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
    /// The hits do not fit into memory.
    #[error("the hits of {paths} photons: {source}")]
    Memory {
        /// How many photons.
        paths: u64,
        /// What is missing.
        source: TooLarge,
    },
}

/// A walk that can be done block by block.
#[derive(Debug)]
pub struct Walk<'s> {
    scene: &'s Scene,
    lamps: Lamps,
    power: Power,
    paths: u64,
    seed: u64,
    returned: bool,
    arch: Arch,
}

/// What a block of paths left.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// The hits in the order of paths.
    pub records: Vec<Record>,
    /// Paths that ended on no front: they left the scene, or met a back.
    pub astray: Vec<u32>,
    /// Where the light went.
    pub ledger: Ledger,
}

impl<'s> Walk<'s> {
    /// A walk of `paths` photons.
    ///
    /// # Errors
    /// If their number or the settings of the roulette are not legal.
    pub fn new(scene: &'s Scene, power: Power, paths: u64, seed: u64) -> Result<Self, WalkError> {
        if paths == 0 || paths > PATHS {
            return Err(WalkError::Paths(paths));
        }
        if let Power::Attenuated { threshold, kill } = power
            && !(threshold > 0.0 && threshold <= 1.0 && kill > 0.0 && kill < 1.0)
        {
            return Err(WalkError::Roulette { threshold, kill });
        }
        Ok(Self {
            lamps: Lamps::new(scene),
            scene,
            power,
            paths,
            seed,
            returned: false,
            arch: Arch::new(),
        })
    }

    /// The same walk, but hits hold what their surface returns of the flux that arrives: their density is the reflected radiosity. In three channels that is
    /// irradiance times reflectance; over wavelengths it cannot be had from the tristimulus values of what arrives.
    pub fn returned(self) -> Self {
        Self {
            returned: true,
            ..self
        }
    }

    /// How many blocks there are.
    pub fn blocks(&self) -> u64 {
        self.paths.div_ceil(BLOCK)
    }

    /// Traces one block.
    pub fn trace(&self, block: u64) -> Trace {
        match self.scene.colour {
            Colour::Rgb => self.arch.dispatch(Task::<Channels>::new(self, block)),
            Colour::Spectral => self.arch.dispatch(Task::<Wave>::new(self, block)),
        }
    }

    /// Traces all blocks on all threads and sorts their hits by surface.
    ///
    /// # Errors
    /// If the light does not add up or leaks, or the hits would not fit into memory.
    pub fn run(&self) -> Result<(Hits, Ledger), WalkError> {
        let mut hits = Hits::new(self.scene.surfaces().len(), self.paths);
        let mut ledger = Ledger::default();
        let blocks = self.blocks();
        let mut done = 0;
        while done < blocks {
            let next = (done + BATCH).min(blocks);
            let traces: Vec<Trace> = (done..next)
                .into_par_iter()
                .map(|block| self.trace(block))
                .collect();
            for trace in &traces {
                hits.extend(&trace.records);
                hits.lose(&trace.astray);
                ledger.add(&trace.ledger);
            }
            if done == 0 && next < blocks {
                // the first batch tells how many there will be
                let factor = (blocks as f64 / next as f64 - 1.0) * 1.02;
                let bytes = hits.len() as f64 * factor * size_of::<Record>() as f64;
                memory::check(bytes as u64).map_err(|source| WalkError::Memory {
                    paths: self.paths,
                    source,
                })?;
                hits.reserve(factor);
            }
            done = next;
        }
        ledger.check(self.scene.open)?;
        Ok((hits, ledger))
    }
}

/// One block for one kind of light.
struct Task<'w, L> {
    walk: &'w Walk<'w>,
    block: u64,
    light: std::marker::PhantomData<L>,
}

impl<'w, L> Task<'w, L> {
    fn new(walk: &'w Walk<'w>, block: u64) -> Self {
        Self {
            walk,
            block,
            light: std::marker::PhantomData,
        }
    }
}

impl<L: Given> WithSimd for Task<'_, L> {
    type Output = Trace;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Trace {
        let walk = self.walk;
        let mut random = stream(walk.seed, "photon", self.block);
        let first = self.block * BLOCK;
        let last = (first + BLOCK).min(walk.paths);
        let mut trace = Trace {
            records: Vec::with_capacity(4 * BLOCK as usize),
            astray: Vec::new(),
            ledger: Ledger::default(),
        };
        for path in first..last {
            let start = walk.lamps.start::<L>(walk.scene, walk.paths, &mut random);
            follow(simd, walk, start, path as u32, &mut random, &mut trace);
        }
        trace.ledger.paths = last - first;
        trace.ledger.hits = trace.records.len() as u64;
        trace
    }
}

/// Follows one photon to its end.
#[inline(always)]
fn follow<S: Simd, L: Carried>(
    simd: S,
    walk: &Walk<'_>,
    start: Start<L>,
    path: u32,
    random: &mut Stream,
    trace: &mut Trace,
) {
    let Trace {
        records,
        astray,
        ledger,
    } = trace;
    let scene = walk.scene;
    let Start { mut ray, mut light } = start;
    let first_power = light.power();
    ledger.emitted += first_power;
    let mut bounce: u16 = 0;
    loop {
        ledger.segments += 1;
        let Some(found) = scene.caster().nearest_in(simd, &ray, f64::INFINITY) else {
            ledger.escaped += light.power();
            ledger.left += 1;
            astray.push(path);
            return;
        };
        let (surface, part) = scene.part(found.primitive);
        let about = &scene.surfaces()[surface];
        let place = ray.at(found.distance);
        let normal = about.shape.normal(part, place);
        let front = ray.direction.dot(&normal) < 0.0;
        let material = &*about.material;
        if !(front || material.is_clear()) {
            ledger.behind += light.power();
            astray.push(path);
            break;
        }
        if bounce == u16::MAX {
            ledger.endless += light.power();
            break;
        }
        bounce += 1;
        if front {
            records.push(Record::new(
                about.shape.raw_coordinates(part, place),
                if walk.returned {
                    light.reflected(material.reflectance(), 1.0).flux()
                } else {
                    light.flux()
                },
                (path, bounce),
                (surface, part),
                ray.direction,
            ));
        }
        let direction = if let Material::Lambertian(diffuse) = material {
            // the direction is drawn only for those that go on
            let Some(kept) = decide(
                walk.power,
                light,
                light.reflected(&diffuse.reflectance, 1.0),
                first_power,
                random,
                ledger,
            ) else {
                break;
            };
            light = kept;
            material
                .scatter(ray.direction, normal, front, random)
                .direction
        } else {
            let scattered = material.scatter(ray.direction, normal, front, random);
            let reflected = light.reflected(material.reflectance(), scattered.factor);
            let Some(kept) = decide(walk.power, light, reflected, first_power, random, ledger)
            else {
                break;
            };
            light = kept;
            scattered.direction
        };
        ray = Ray {
            origin: place,
            direction,
            leaving: Some(found.primitive),
        };
    }
    ledger.ended += 1;
}

/// Whether a photon goes on, and with what, where `reflected` is what is left of `light`. The ledger is told.
#[inline(always)]
fn decide<L: Carried>(
    scheme: Power,
    light: L,
    reflected: L,
    first_power: f64,
    random: &mut Stream,
    ledger: &mut Ledger,
) -> Option<L> {
    let (before, after) = (light.power(), reflected.power());
    match scheme {
        Power::Same => {
            let share = after / before;
            if share >= 1.0 {
                return Some(reflected);
            }
            if random.random::<f64>() < share {
                let kept = reflected.scaled(share.recip());
                // rounding is booked as it happens
                ledger.absorbed += before - kept.power();
                Some(kept)
            } else {
                ledger.absorbed += before;
                None
            }
        }
        Power::Attenuated { threshold, kill } => {
            ledger.absorbed += before - after;
            if after <= 0.0 {
                return None;
            }
            if after >= threshold * first_power {
                return Some(reflected);
            }
            if random.random::<f64>() < kill {
                ledger.roulette += after;
                None
            } else {
                let kept = reflected.scaled((1.0 - kill).recip());
                ledger.roulette += after - kept.power();
                Some(kept)
            }
        }
    }
}
