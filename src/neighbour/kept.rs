//! The points that count as neighbours.

use crate::sample::{Sample, Weights};
use crate::space::Point;

/// The points of positive weight with their numbers in the sample. Nothing is copied if that is all of them.
pub(super) struct Kept<const D: usize> {
    sample: Sample<D>,
    some: Option<(Vec<Point<D>>, Vec<u32>)>,
}

impl<const D: usize> Kept<D> {
    /// # Panics
    /// For 2³² points or more, which no memory here holds with what a finder needs beside them.
    pub fn new(sample: &Sample<D>) -> Self {
        assert!(u32::try_from(sample.len()).is_ok(), "too many points");
        let every = match sample.weights() {
            Weights::Equal(_) => true,
            Weights::Each(weights) => weights.iter().all(|&w| w > 0.0),
        };
        let some = (!every).then(|| {
            (0..sample.len() as u32)
                .filter(|&i| sample.weight(i as usize) > 0.0)
                .map(|i| (sample.points()[i as usize], i))
                .unzip()
        });
        Self {
            sample: sample.clone(),
            some,
        }
    }

    /// The points.
    pub fn points(&self) -> &[Point<D>] {
        self.some
            .as_ref()
            .map_or_else(|| self.sample.points(), |(points, _)| points)
    }

    /// The number in the sample of the `i`-th point that is kept.
    pub fn number(&self, i: usize) -> usize {
        self.some
            .as_ref()
            .map_or(i, |(_, numbers)| numbers[i] as usize)
    }
}
