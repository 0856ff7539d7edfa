//! What was registered beyond the domain of a sample.

use super::{Sample, SampleError, Weights};
use crate::space::Point;
use std::sync::Arc;

/// Points beyond, with their weights in total and in each channel.
#[derive(Clone, Debug)]
pub(super) struct Margin<const D: usize> {
    points: Arc<Vec<Point<D>>>,
    weights: Weights,
    channels: Vec<Weights>,
}

impl<const D: usize> Margin<D> {
    /// The same with the weights of one channel.
    pub fn channel(&self, channel: usize) -> Self {
        Self {
            points: self.points.clone(),
            weights: self.channels[channel].clone(),
            channels: Vec::new(),
        }
    }
}

impl<const D: usize> Sample<D> {
    /// The same with points that were registered **beyond** the domain. They are no part of the sample: they have no part in its mass, its size, or in what is chosen from it, and most estimators never
    /// look at them; the boundary `virtual-margin` lets their kernels reach into the domain. Their weights are on the scale of those of the sample (1/n where those are 1/n), one list for each channel if
    /// the sample has channels, and then their totals over the channels in `weights`.
    ///
    /// # Errors
    /// If a point is not finite or lies in the domain, a weight is not legal, or the numbers of weights or channels do not match.
    pub fn with_margin(
        mut self,
        points: Vec<Point<D>>,
        weights: Weights,
        channels: Vec<Weights>,
    ) -> Result<Self, SampleError> {
        for (index, point) in points.iter().enumerate() {
            if let Some(axis) = point.iter().position(|x| !x.is_finite()) {
                let value = point[axis];
                return Err(SampleError::NotFinite { index, value });
            }
            if self.domain().contains(*point) {
                return Err(SampleError::Inside { index });
            }
        }
        if channels.len() != self.channels() {
            return Err(SampleError::Count {
                weights: channels.len(),
                points: self.channels(),
            });
        }
        if points.is_empty() {
            return Ok(self);
        }
        for weights in channels.iter().chain([&weights]) {
            match Self::measure(&points, weights) {
                Ok(_) => {}
                // nothing in one channel
                Err(SampleError::Mass(mass)) if mass.abs() <= 0.0 => {}
                Err(error) => return Err(error),
            }
        }
        self.margin = Some(Arc::new(Margin {
            points: Arc::new(points),
            weights,
            channels,
        }));
        Ok(self)
    }

    /// The points registered beyond the domain, with their weights.
    pub fn margin(&self) -> impl Iterator<Item = (Point<D>, f64)> + '_ {
        let margin = self.margin.iter();
        margin.flat_map(|margin| {
            let weight = |i: usize| match &margin.weights {
                Weights::Equal(weight) => *weight,
                Weights::Each(weights) => weights[i],
            };
            let numbered = margin.points.iter().enumerate();
            numbered.map(move |(i, x)| (*x, weight(i)))
        })
    }
}
