//! Irradiance by tracing paths from each place.

use super::{Returned, Spot};
use crate::light::reference::{Measured, PathTracer};
use crate::random;
use rayon::prelude::*;

/// So many paths from each place, each place with a stream of its own.
pub struct Traced<'s> {
    /// Traces them.
    pub tracer: PathTracer<'s>,
    /// How many.
    pub paths: usize,
    /// The seed of the streams.
    pub seed: u64,
}

impl Returned for Traced<'_> {
    fn at(&self, spots: &[Spot]) -> Vec<[f64; 3]> {
        spots
            .par_iter()
            .enumerate()
            .map(|(number, spot)| {
                let mut random = random::stream(self.seed, "path", number as u64);
                let draw = || {
                    let (place, normal) = (spot.place, spot.normal);
                    self.tracer
                        .irradiance(place, normal, Some(spot.primitive), &mut random)
                };
                spot.returned(Measured::of(self.paths, draw).mean)
            })
            .collect()
    }
}
