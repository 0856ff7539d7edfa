//! Reflected light from the hits of photons by an estimator of densities; the hits of a walk that records what is
//! [returned](crate::light::walk::Walk::returned).

use super::{Returned, Spot};
use crate::estimator::{Estimate, Estimator, FitError};
use crate::sample::Sample;
use crate::space::{Field, Point, Targets, Warning};

/// An estimate of the density of power on each surface.
pub struct Estimated {
    surfaces: Vec<Option<Estimate<2>>>,
}

impl Estimated {
    /// Fits `estimator` to the hits of each surface, one surface after another; one without hits is dark.
    ///
    /// # Errors
    /// If it cannot be fitted somewhere.
    pub fn fit(
        estimator: &dyn Estimator<2>,
        surfaces: usize,
        hits: impl Fn(usize) -> Option<Sample<2>>,
    ) -> Result<Self, FitError> {
        let fit = |surface| hits(surface).map(|hits| estimator.fit(&hits)).transpose();
        Ok(Self {
            surfaces: (0..surfaces).map(fit).collect::<Result<_, _>>()?,
        })
    }

    /// What the reader should know, each once.
    pub fn warnings(&self) -> Vec<Warning> {
        let all = self.surfaces.iter().flatten();
        let mut all: Vec<Warning> = all.flat_map(|e| e.warnings.iter().cloned()).collect();
        all.sort();
        all.dedup();
        all
    }
}

/// The channels of an estimate at `targets`; one channel for all where the sample had none.
pub fn channels(estimate: &Estimate<2>, targets: Targets<'_, 2>) -> Vec<[f64; 3]> {
    let all = [0, 1, 2].map(|c: usize| match estimate.channel(c) {
        Some(field) => field.evaluate(targets).values,
        None => estimate.evaluate(targets).values,
    });
    (0..targets.len())
        .map(|i| [all[0][i], all[1][i], all[2][i]])
        .collect()
}

impl Returned for Estimated {
    fn at(&self, spots: &[Spot]) -> Vec<[f64; 3]> {
        let mut found = vec![[0.0; 3]; spots.len()];
        for (surface, estimate) in self.surfaces.iter().enumerate() {
            let Some(estimate) = estimate else { continue };
            let here = (0..spots.len()).filter(|&i| spots[i].surface == surface);
            let here: Vec<usize> = here.collect();
            if here.is_empty() {
                continue;
            }
            let places: Vec<Point<2>> = here.iter().map(|&i| spots[i].chart).collect();
            let values = channels(estimate, Targets::Points(&places));
            for (&i, value) in here.iter().zip(values) {
                found[i] = value;
            }
        }
        found
    }
}
