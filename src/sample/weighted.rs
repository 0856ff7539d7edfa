//! The sample itself.

use super::Paths;
use super::margin::Margin;
use crate::numeric::Sum;
use crate::space::{Domain, Point};
use pulp::{Arch, Simd, WithSimd};
use std::sync::Arc;

/// Why points and weights are not a sample.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SampleError {
    /// No points.
    #[error("a sample needs at least one point")]
    Empty,
    /// A coordinate that is NaN or infinite.
    #[error(
        "point {index} (counted from 0) has the coordinate {value}, which is not a finite number"
    )]
    NotFinite {
        /// Which point.
        index: usize,
        /// The coordinate.
        value: f64,
    },
    /// A point outside the domain.
    #[error("point {index} (counted from 0) at {value} lies outside the domain on axis {axis}")]
    Outside {
        /// Which point.
        index: usize,
        /// On which axis.
        axis: usize,
        /// The coordinate there.
        value: f64,
    },
    /// A point in the box around the domain's polygon but not in the polygon.
    #[error("point {index} (counted from 0) at ({x}, {y}) lies outside the polygon")]
    OutsidePolygon {
        /// Which point.
        index: usize,
        /// Its first coordinate.
        x: f64,
        /// Its second coordinate.
        y: f64,
    },
    /// A point of the margin that lies in the domain.
    #[error("point {index} (counted from 0) of the margin lies inside the domain")]
    Inside {
        /// Which point.
        index: usize,
    },
    /// Not one weight a point.
    #[error("{weights} weights for {points} points")]
    Count {
        /// Weights given.
        weights: usize,
        /// Points given.
        points: usize,
    },
    /// A weight that is negative, NaN or infinite.
    #[error(
        "point {index} (counted from 0) has the weight {value}; weights are finite and not negative"
    )]
    Weight {
        /// Which point.
        index: usize,
        /// Its weight.
        value: f64,
    },
    /// Not one path a point.
    #[error("{paths} paths for {points} points")]
    Paths {
        /// Paths given.
        paths: usize,
        /// Points given.
        points: usize,
    },
    /// A path that is not one of those there are.
    #[error(
        "point {index} (counted from 0) comes from path {path}, but the {count} paths are numbered from 0"
    )]
    Path {
        /// Which point.
        index: usize,
        /// Its path.
        path: u32,
        /// How many paths there are.
        count: usize,
    },
    /// Weights whose sum is zero or overflows.
    #[error("the weights sum to {0}; the sum must be positive and finite")]
    Mass(f64),
    /// Nothing could be drawn.
    #[error("{0}")]
    Source(String),
}

/// One number for all points, or one each.
#[derive(Clone, Debug, PartialEq)]
pub enum Weights {
    /// Each point has this weight.
    Equal(f64),
    /// One weight a point, in their order.
    Each(Arc<[f64]>),
}

/// Weighted points on a domain. Cloning is cheap: the data are shared.
///
/// Always true, so that nobody downstream checks again: at least one point, all coordinates finite and inside the domain, weights finite and
/// ≥ 0 with a positive finite sum, and the same for each channel except that a channel's sum may be zero.
#[derive(Clone, Debug)]
pub struct Sample<const D: usize> {
    points: Arc<Vec<Point<D>>>,
    weights: Weights,
    channels: Arc<[Arc<[f64]>]>,
    domain: Domain<D>,
    mass: f64,
    effective_size: f64,
    pub(super) paths: Option<Paths>,
    pub(super) margin: Option<Arc<Margin<D>>>,
}

impl<const D: usize> Sample<D> {
    /// Points of weight 1/n each: an ordinary statistical sample.
    ///
    /// # Errors
    /// If there is no point, or one is not finite or outside the domain.
    pub fn equal(points: Vec<Point<D>>, domain: Domain<D>) -> Result<Self, SampleError> {
        let each = 1.0 / points.len() as f64;
        Self::new(points, Weights::Equal(each), domain)
    }

    /// Points with weights proportional to `weights`, scaled to the mass 1.
    ///
    /// # Errors
    /// As [`Sample::new`].
    pub fn normalised(
        points: Vec<Point<D>>,
        mut weights: Vec<f64>,
        domain: Domain<D>,
    ) -> Result<Self, SampleError> {
        let mass = weights.iter().copied().collect::<Sum>().value();
        // an illegal mass is left to `new`, which says what is wrong and where
        if mass > 0.0 && mass.is_finite() {
            for weight in &mut weights {
                *weight /= mass;
            }
        }
        Self::new(points, Weights::Each(weights.into()), domain)
    }

    /// Points with the weights as they are.
    ///
    /// # Errors
    /// If there is no point, a point or weight is not legal, or the sum of weights is not positive and finite.
    pub fn new(
        points: Vec<Point<D>>,
        weights: Weights,
        domain: Domain<D>,
    ) -> Result<Self, SampleError> {
        if points.is_empty() {
            return Err(SampleError::Empty);
        }
        let legal = |point: &Point<D>| {
            let mut finite = true;
            for x in point {
                finite &= x.is_finite();
            }
            finite && domain.contains(*point)
        };
        if !(domain.outline().is_none() && in_box(&points, &domain))
            && let Some(index) = points.iter().position(|point| !legal(point))
        {
            return Err(Self::misplaced(index, points[index], &domain));
        }
        let (mass, effective_size) = Self::measure(&points, &weights)?;
        Ok(Self {
            points: Arc::new(points),
            weights,
            channels: Arc::new([]),
            domain,
            mass,
            effective_size,
            paths: None,
            margin: None,
        })
    }

    /// The same points seen in several channels: `channels[c][i]` is the weight of point i in channel c, and the total of a
    /// point over the channels becomes its weight.
    ///
    /// # Errors
    /// As [`Sample::new`], for each channel; a channel whose weights are all zero is allowed.
    pub fn with_channels(
        points: Vec<Point<D>>,
        channels: Vec<Vec<f64>>,
        domain: Domain<D>,
    ) -> Result<Self, SampleError> {
        for channel in &channels {
            if channel.len() != points.len() {
                return Err(SampleError::Count {
                    weights: channel.len(),
                    points: points.len(),
                });
            }
            if let Some(index) = channel.iter().position(|&w| !(w >= 0.0 && w.is_finite())) {
                return Err(SampleError::Weight {
                    index,
                    value: channel[index],
                });
            }
        }
        let total: Vec<f64> = (0..points.len())
            .map(|i| channels.iter().map(|c| c[i]).sum())
            .collect();
        let mut sample = Self::new(points, Weights::Each(total.into()), domain)?;
        sample.channels = channels.into_iter().map(Into::into).collect();
        Ok(sample)
    }

    fn misplaced(index: usize, point: Point<D>, domain: &Domain<D>) -> SampleError {
        for axis in 0..D {
            let value = point[axis];
            if !value.is_finite() {
                return SampleError::NotFinite { index, value };
            }
            if value < domain.low()[axis] || value > domain.high()[axis] {
                return SampleError::Outside { index, axis, value };
            }
        }
        // inside the box, so the domain has an outline, which only a plane has
        SampleError::OutsidePolygon {
            index,
            x: point[0],
            y: point[D - 1],
        }
    }

    pub(super) fn measure(
        points: &[Point<D>],
        weights: &Weights,
    ) -> Result<(f64, f64), SampleError> {
        let n = points.len() as f64;
        let (mass, squares) = match weights {
            Weights::Equal(w) => (w * n, w * w * n),
            Weights::Each(each) => {
                if each.len() != points.len() {
                    return Err(SampleError::Count {
                        weights: each.len(),
                        points: points.len(),
                    });
                }
                if let Some(index) = each.iter().position(|&w| !(w >= 0.0 && w.is_finite())) {
                    return Err(SampleError::Weight {
                        index,
                        value: each[index],
                    });
                }
                let largest = each
                    .iter()
                    .copied()
                    .fold(0.0, f64::max)
                    .max(f64::MIN_POSITIVE);
                // scaled by the largest weight so that neither sum over- or underflows
                let sum = each.iter().map(|w| w / largest).collect::<Sum>().value();
                let squares = each
                    .iter()
                    .map(|w| (w / largest).powi(2))
                    .collect::<Sum>()
                    .value();
                return Self::legal_mass(sum * largest, sum * sum / squares);
            }
        };
        Self::legal_mass(mass, mass * mass / squares)
    }

    fn legal_mass(mass: f64, effective_size: f64) -> Result<(f64, f64), SampleError> {
        if mass > 0.0 && mass.is_finite() {
            Ok((mass, effective_size))
        } else {
            Err(SampleError::Mass(mass))
        }
    }

    /// How many points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Never: a sample has at least one point.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The points.
    pub fn points(&self) -> &[Point<D>] {
        &self.points
    }

    /// The weights.
    pub fn weights(&self) -> &Weights {
        &self.weights
    }

    /// The weight of point `i`.
    #[inline]
    pub fn weight(&self, i: usize) -> f64 {
        match &self.weights {
            Weights::Equal(weight) => *weight,
            Weights::Each(weights) => weights[i],
        }
    }

    /// Where the points may lie.
    pub fn domain(&self) -> &Domain<D> {
        &self.domain
    }

    /// Σ wᵢ.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// n_eff = (Σ w)² / Σ w², the number of equally weighted points that would carry as much information. What rules for
    /// bandwidths and intervals use, never the bare count.
    pub fn effective_size(&self) -> f64 {
        self.effective_size
    }

    /// How many channels; 0 when the weights are all there is.
    pub fn channels(&self) -> usize {
        self.channels.len()
    }

    /// The same points with the weights of one channel.
    ///
    /// # Panics
    /// If there is no such channel.
    pub fn channel(&self, channel: usize) -> Self {
        let weights = Weights::Each(self.channels[channel].clone());
        let (mass, effective_size) = Self::measure(&self.points, &weights).unwrap_or((0.0, 0.0));
        Self {
            points: self.points.clone(),
            weights,
            channels: Arc::new([]),
            domain: self.domain.clone(),
            mass,
            effective_size,
            paths: self.paths.clone(),
            margin: self
                .margin
                .as_ref()
                .map(|margin| Arc::new(margin.channel(channel))),
        }
    }
}

/// Whether all points are finite and in the box of `domain`: one question about some together, without a branch for each.
fn in_box<const D: usize>(points: &[Point<D>], domain: &Domain<D>) -> bool {
    Arch::new().dispatch(InBox {
        points,
        low: domain.low(),
        high: domain.high(),
    })
}

struct InBox<'a, const D: usize> {
    points: &'a [Point<D>],
    low: Point<D>,
    high: Point<D>,
}

impl<const D: usize> WithSimd for InBox<'_, D> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        for points in self.points.chunks(256) {
            let mut wrong = 0u64;
            for point in points {
                for axis in 0..D {
                    let x = point[axis];
                    let right = u64::from(self.low[axis] <= x) & u64::from(x <= self.high[axis]);
                    wrong |= 1 - (right & u64::from(x.abs() < f64::INFINITY));
                }
            }
            if wrong != 0 {
                return false;
            }
        }
        true
    }
}

impl Sample<1> {
    /// The points as plain numbers.
    pub fn coordinates(&self) -> &[f64] {
        self.points.as_flattened()
    }
}
