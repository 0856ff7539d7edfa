//! Which points come from one and the same random event.

use super::{Sample, SampleError, Weights};
use std::sync::Arc;

/// The random event behind each point: for hits of photons the path that left them, several hits a path. Events are independent of each other, points of one event are not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Paths {
    of: Arc<[u32]>,
    count: usize,
}

impl Paths {
    /// The number of the path of each point, from 0.
    pub fn of(&self) -> &[u32] {
        &self.of
    }

    /// How many paths there were, with those that left no point.
    pub fn count(&self) -> usize {
        self.count
    }
}

impl<const D: usize> Sample<D> {
    /// The same points with the path that each comes from, a number from 0 to before `count`, which counts paths without points too. The weights then are per path, and the mass
    /// of the sample is random as its points are. Without this, each point is an event of its own and the mass is known.
    ///
    /// # Errors
    /// If there is not one path a point, or a number is not below `count`.
    pub fn with_paths(mut self, paths: Vec<u32>, count: usize) -> Result<Self, SampleError> {
        if paths.len() != self.len() {
            return Err(SampleError::Paths {
                paths: paths.len(),
                points: self.len(),
            });
        }
        if let Some(index) = paths.iter().position(|&path| path as usize >= count) {
            return Err(SampleError::Path {
                index,
                path: paths[index],
                count,
            });
        }
        self.paths = Some(Paths {
            of: paths.into(),
            count,
        });
        Ok(self)
    }

    /// The path of each point, where a path may have left several.
    pub fn paths(&self) -> Option<&Paths> {
        self.paths.as_ref()
    }

    /// The points that `keep` keeps, with weights times `scale`; without channels and paths. `None` if no weight is left.
    pub fn part(&self, keep: impl Fn(usize) -> bool, scale: f64) -> Option<Self> {
        let kept: Vec<usize> = (0..self.len()).filter(|&i| keep(i)).collect();
        let points = kept.iter().map(|&i| self.points()[i]).collect();
        let weights = match self.weights() {
            Weights::Equal(weight) => Weights::Equal(weight * scale),
            Weights::Each(each) => Weights::Each(kept.iter().map(|&i| each[i] * scale).collect()),
        };
        Self::new(points, weights, self.domain().clone()).ok()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::space::Domain;

    fn three() -> Sample<1> {
        Sample::normalised(
            vec![[0.0], [1.0], [2.0]],
            vec![1.0, 2.0, 1.0],
            Domain::whole(),
        )
        .unwrap()
    }

    #[test]
    fn paths_are_one_a_point_and_below_their_number() {
        assert!(three().with_paths(vec![0, 0], 2).is_err());
        assert!(three().with_paths(vec![0, 0, 2], 2).is_err());
        let sample = three().with_paths(vec![0, 0, 2], 5).unwrap();
        assert_eq!(sample.paths().unwrap().count(), 5);
        assert_eq!(sample.paths().unwrap().of(), [0, 0, 2]);
    }

    #[test]
    fn a_part_has_its_points_and_their_weights() {
        let part = three().part(|i| i != 0, 2.0).unwrap();
        assert_eq!(part.coordinates(), [1.0, 2.0]);
        assert!((part.mass() - 1.5).abs() < 1e-15);
        assert!(three().part(|_| false, 1.0).is_none());
    }
}
