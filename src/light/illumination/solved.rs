//! Irradiance from the reference.

use super::{Returned, Spot};
use crate::light::reference::Reference;
use rayon::prelude::*;

impl Returned for Reference {
    fn at(&self, spots: &[Spot]) -> Vec<[f64; 3]> {
        // solved once before all threads want it
        self.solved();
        spots
            .par_iter()
            .map(|spot| spot.returned(self.irradiance(spot.surface, spot.chart)))
            .collect()
    }
}
