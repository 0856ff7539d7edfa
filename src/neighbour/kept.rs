//! The points that count as neighbours.

use crate::sample::{Sample, Weights};
use crate::space::Point;

/// The points of positive weight with their numbers in the sample.
pub(super) struct Kept<const D: usize> {
    pub points: Vec<Point<D>>,
    /// Absent if all are kept.
    numbers: Option<Vec<u32>>,
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
        if every {
            return Self {
                points: sample.points().to_vec(),
                numbers: None,
            };
        }
        let numbers: Vec<u32> = (0..sample.len() as u32)
            .filter(|&i| sample.weight(i as usize) > 0.0)
            .collect();
        Self {
            points: numbers
                .iter()
                .map(|&i| sample.points()[i as usize])
                .collect(),
            numbers: Some(numbers),
        }
    }

    /// The number in the sample of the `i`-th point that is kept.
    pub fn number(&self, i: usize) -> usize {
        self.numbers
            .as_ref()
            .map_or(i, |numbers| numbers[i] as usize)
    }
}
