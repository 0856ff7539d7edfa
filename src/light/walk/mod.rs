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
//! Paths come in blocks, each with a random stream of its own: results are the same for any number of threads. Within a block they go in groups,
//! all photons of a group step by step; what a photon does is the same to the last bit whatever the registers of the machine.
//!
//! | file | what |
//! |---|---|
//! | `lamps` | where photons come from |
//! | `carried` | what they carry |
//! | `group` | their steps |
//! | `power` | what a surface leaves of their power |
//! | `words` | random words by the thousand |
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

mod carried;
mod group;
mod lamps;
#[cfg(test)]
mod plain;
mod power;
#[cfg(test)]
mod tests;
mod words;

pub use power::Power;

use super::hits::{Hits, Record};
use super::ledger::{Ledger, LedgerError};
use super::ray::TOGETHER;
use super::scene::Scene;
use super::spectrum::Colour;
use crate::memory::{self, TooLarge};
use crate::random::stream;
use carried::{Channels, Wave};
use group::{Face, Group};
use lamps::{Given, Lamps};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use words::Words;

/// Paths in a block.
pub const BLOCK: u64 = 4096;
/// The most paths of a walk.
pub const PATHS: u64 = 4_000_000_000;
/// Blocks traced before their hits are sorted to surfaces.
const BATCH: u64 = 64;

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
    faces: Vec<Face<'s>>,
    lamps: Lamps,
    /// The power with which photons leave their lamps.
    first: f64,
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
        let lamps = Lamps::new(scene);
        Ok(Self {
            first: lamps.total() / paths as f64,
            lamps,
            faces: Face::all(scene),
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
        let trace = |from: u64| -> Vec<Trace> {
            let to = (from + BATCH).min(blocks);
            let traces = (from..to).into_par_iter().map(|block| self.trace(block));
            traces.collect()
        };
        let mut sort = |hits: &mut Hits, traces: &[Trace]| {
            for trace in traces {
                hits.extend(&trace.records);
                hits.lose(&trace.astray);
                ledger.add(&trace.ledger);
            }
        };
        sort(&mut hits, &trace(0));
        if BATCH < blocks {
            // the first batch tells how many there will be
            let factor = (blocks as f64 / BATCH as f64 - 1.0) * 1.02;
            // and two batches are alive besides: one that is sorted, one that is traced
            let bytes = hits.len() as f64 * (factor + 2.0) * size_of::<Record>() as f64;
            memory::check(bytes as u64).map_err(|source| WalkError::Memory {
                paths: self.paths,
                source,
            })?;
            hits.reserve(factor);
            // one thread sorts, which only one can, while the others trace on
            let mut traces = trace(BATCH);
            for next in (2 * BATCH..blocks).step_by(BATCH as usize) {
                let sorting = || sort(&mut hits, &traces);
                ((), traces) = rayon::join(sorting, || trace(next));
            }
            sort(&mut hits, &traces);
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
        let mut words = Words::of(stream(walk.seed, "photon", self.block));
        let first = self.block * BLOCK;
        let last = (first + BLOCK).min(walk.paths);
        let mut trace = Trace {
            records: Vec::with_capacity(4 * BLOCK as usize),
            astray: Vec::new(),
            ledger: Ledger::default(),
        };
        let mut group = Group::<L>::new();
        let mut next = first;
        while next < last {
            let end = (next + TOGETHER as u64).min(last);
            group.follow(simd, walk, next..end, &mut words, &mut trace);
            next = end;
        }
        trace.astray.sort_unstable();
        trace.ledger.paths = last - first;
        trace.ledger.hits = trace.records.len() as u64;
        trace
    }
}
