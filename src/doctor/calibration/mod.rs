//! Reliability: how often what is stated with a probability is true, against that probability.
//!
//! A [`Promise`] is anything in the laboratory that states a probability: intervals of means, medians and shares, bounds from the bootstrap, the random error from batches, and the
//! p-values of tests (a test at level 1 - c states, with confidence c, that what is true will not be rejected). Each is put to the test with fresh random numbers under many seeds, at
//! each of [`LEVELS`], and all go into one diagram.

mod promises;

pub use promises::PROMISES;

use super::Subjects;
use crate::accuracy::chance::{detectable, two_sided};
use rayon::prelude::*;

/// The nominal probabilities at which promises are graded.
pub const LEVELS: [f64; 8] = [0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.98, 0.99];

/// The chance that any of all calibrated promises is called broken.
const FAMILY: f64 = 1e-3;

/// How a promise is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// True as often as stated.
    AsStated,
    /// True at least as often as stated: conservative.
    AtLeast,
    /// Not made by the laboratory: shown because it is easily misunderstood.
    NotClaimed,
}

/// Something that states a probability.
pub struct Promise {
    /// What is stated.
    pub name: &'static str,
    /// How it is meant.
    pub meaning: Meaning,
    /// Whether it came true at each of [`LEVELS`], under a seed.
    pub kept: fn(&Subjects, u64) -> [bool; LEVELS.len()],
}

/// How often a promise came true.
#[derive(Clone, Debug)]
pub struct Grade {
    /// What was stated.
    pub name: &'static str,
    /// How it was meant.
    pub meaning: Meaning,
    /// How often it came true at each of [`LEVELS`], a share of the seeds.
    pub actual: [f64; LEVELS.len()],
    /// The p-value of the worst level, over all levels (Bonferroni), of being as stated (or at least).
    pub p_value: f64,
}

impl Grade {
    /// Whether it was kept, as far as the seeds can tell; always for what is not claimed.
    pub fn is_kept(&self) -> bool {
        self.meaning == Meaning::NotClaimed || self.p_value > FAMILY / PROMISES.len() as f64
    }
}

/// Grades every promise over `seeds` seeds from `first`.
pub fn calibrate(first: u64, seeds: usize) -> Vec<Grade> {
    let subjects = Subjects::healthy();
    PROMISES
        .iter()
        .map(|promise| {
            let kept: Vec<[bool; LEVELS.len()]> = (0..seeds as u64)
                .into_par_iter()
                .map(|i| (promise.kept)(&subjects, first.wrapping_add(i)))
                .collect();
            let actual: [f64; LEVELS.len()] = std::array::from_fn(|level| {
                kept.iter().filter(|kept| kept[level]).count() as f64 / seeds as f64
            });
            let worst = LEVELS
                .iter()
                .zip(actual)
                .map(|(level, actual)| {
                    let z = (actual - level) / (level * (1.0 - level) / seeds as f64).sqrt();
                    match promise.meaning {
                        Meaning::AtLeast if z > 0.0 => 1.0,
                        _ => two_sided(z),
                    }
                })
                .fold(1.0, f64::min);
            Grade {
                name: promise.name,
                meaning: promise.meaning,
                actual,
                p_value: (worst * LEVELS.len() as f64).min(1.0),
            }
        })
        .collect()
}

/// Half the width of the band about a level within which a promise that is kept stays, at all levels and for all promises at once.
pub fn band(level: f64, seeds: usize) -> f64 {
    let comparisons = (PROMISES.len() * LEVELS.len()) as f64;
    detectable(FAMILY / comparisons, 0.5) * (level * (1.0 - level) / seeds as f64).sqrt()
}
