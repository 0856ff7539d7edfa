//! The random error from parts of the sample that are independent of each other.

use super::{ErrorEstimate, UncertaintyError};
use crate::estimator::Estimator;
use crate::sample::{Paths, Sample};
use crate::space::{Field, Targets};

/// Two halves A and B of a sample: f̂ = (f̂A + f̂B)/2 and ê = (f̂A - f̂B)/2, so that E ê² = ¼ (var f̂A + var f̂B) = var f̂; and the same for more than two batches.
///
/// With B batches of sizes n_b and estimates f̂_b from each alone, ê² = Σ n_b (f̂_b - f̂)² / ((B - 1) n), which is unbiased for var f̂ whatever the sizes. The size of a batch is the number
/// of paths in it where the sample says which path each point comes from; else its effective size (Σw)²/Σw², each batch scaled to unit mass, since the mass is then known and not random.
///
/// **The factor.** ¼, not ½: var f̂A is twice var f̂. **What it cannot see.** A and B have the same bias, which cancels; so this is the variance, not the mean squared error: at four times the best
/// bandwidth the error is a hundred times what the halves say. **How to split.** By path. Hits of one path are near each other, and a split by the number of the hit puts half of them
/// in A and half in B, which then agree for that reason alone.
///
/// Spread of the integral over one sample: the relative deviation is c √(2/(B - 1)) with c² = ∫∫cov(f̂(x), f̂(y))² / (∫var f̂)², one over the number of places that vary independently: about a
/// half with two batches, a sixth with ten. At a single place (c = 1) two halves have one degree of freedom: a relative deviation of 141 %.
///
/// Cost: about one more fit and evaluation for all batches together, and B evaluations of the targets.
///
/// # References
/// The halves are folklore; batch means: Fishman 1978, Principles of Discrete Event Simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Halves {
    /// B, at least 2.
    pub batches: usize,
    /// What goes into one batch together.
    pub split: Split,
}

/// What goes into one batch together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Split {
    /// All points of a path; path number p goes into batch p mod B.
    #[default]
    Path,
    /// Nothing: point number i goes into batch i mod B, whatever path it comes from. Wrong where paths leave several points; kept to be shown to be.
    Point,
}

impl Split {
    /// The names in files.
    pub const NAMES: [&'static str; 2] = ["path", "point"];

    /// The split of that name.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "path" => Some(Self::Path),
            "point" => Some(Self::Point),
            _ => None,
        }
    }
}

impl Halves {
    /// The batches of `sample` as samples of their own, each of the mass that the whole has in expectation, with their sizes; a batch without points is `None`.
    fn parts<const D: usize>(&self, sample: &Sample<D>) -> Vec<(f64, Option<Sample<D>>)> {
        let of = |i: usize| match (self.split, sample.paths()) {
            (Split::Path, Some(paths)) => paths.of()[i] as usize % self.batches,
            _ => i % self.batches,
        };
        (0..self.batches)
            .map(|b| {
                let Some(paths) = sample.paths() else {
                    let Some(part) = sample.part(|i| of(i) == b, 1.0) else {
                        return (0.0, None);
                    };
                    let scale = sample.mass() / part.mass();
                    return (part.effective_size(), part.part(|_| true, scale));
                };
                let all = match self.split {
                    Split::Path => paths.count(),
                    Split::Point => sample.len(),
                };
                let size = (all + self.batches - 1 - b) / self.batches;
                if size == 0 {
                    return (0.0, None);
                }
                let scale = all as f64 / size as f64;
                (size as f64, sample.part(|i| of(i) == b, scale))
            })
            .collect()
    }
}

impl<const D: usize> ErrorEstimate<D> for Halves {
    fn squared(
        &self,
        estimator: &dyn Estimator<D>,
        sample: &Sample<D>,
        targets: Targets<'_, D>,
    ) -> Result<Vec<f64>, UncertaintyError> {
        if !estimator.laws().linear {
            return Err(UncertaintyError::Unsuitable(
                "halves need an estimator that is linear in the data: an estimate from half of the points must be one of the same kind, so give the width as a number".to_owned(),
            ));
        }
        let events = sample.paths().map_or(sample.len(), Paths::count);
        if self.batches < 2 || events < self.batches {
            return Err(UncertaintyError::Unsuitable(format!(
                "{} batches cannot be made of {events} independent events; at least 2 batches, and no more than events",
                self.batches
            )));
        }
        let parts = self.parts(sample);
        let total: f64 = parts.iter().map(|(size, _)| size).sum();
        let mut estimates = Vec::with_capacity(parts.len());
        let mut mean = vec![0.0; targets.len()];
        for (size, part) in parts {
            let values = match part {
                Some(part) => estimator.fit(&part)?.evaluate(targets).values,
                None => vec![0.0; targets.len()],
            };
            for (mean, value) in mean.iter_mut().zip(&values) {
                *mean += size / total * value;
            }
            estimates.push((size, values));
        }
        let mut squared = vec![0.0; targets.len()];
        let scale = total * (self.batches as f64 - 1.0);
        for (size, values) in &estimates {
            for ((squared, value), mean) in squared.iter_mut().zip(values).zip(&mean) {
                *squared += size / scale * (value - mean).powi(2);
            }
        }
        Ok(squared)
    }
}
