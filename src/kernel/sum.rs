//! The weighted sum of kernels: what every kernel estimate is.

use super::{Bandwidth, Kernel, Shape, Use};
use crate::numeric::Sum;
use crate::sample::Sample;
use crate::space::{Domain, Field, Point};

/// f̂(x) = Σᵢ wᵢ Πₐ K((xₐ - Xᵢₐ) / hₐ) / hₐ, the product kernel over the axes a.
///
/// This is the **definition**: its own slow, exact field, one compensated sum over all points per target. Engines compute the
/// same numbers for less and are judged by it.
#[derive(Clone, Debug)]
pub struct KernelSum<const D: usize> {
    sample: Sample<D>,
    shape: Shape,
    bandwidth: Bandwidth<D>,
}

/// Why a kernel sum cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WidthError {
    /// A width that is not positive and finite.
    #[error("a bandwidth must be positive and finite, not {0}")]
    Illegal(f64),
    /// Widths per point that are not one per point.
    #[error("{widths} bandwidths for {points} points")]
    Count {
        /// Widths given.
        widths: usize,
        /// Points in the sample.
        points: usize,
    },
}

impl<const D: usize> KernelSum<D> {
    /// The sum of `shape` over `sample` at `bandwidth`.
    ///
    /// # Errors
    /// If a width is not positive and finite (1/h must be finite too), or the widths per point are not one a point.
    pub fn new(
        sample: Sample<D>,
        shape: Shape,
        bandwidth: Bandwidth<D>,
    ) -> Result<Self, WidthError> {
        let legal = |h: &f64| *h > 0.0 && h.is_finite() && h.recip().is_finite();
        let illegal = match &bandwidth {
            Bandwidth::Fixed(h) => h.iter().copied().find(|h| !legal(h)),
            Bandwidth::PerPoint(h) if h.len() != sample.len() => {
                return Err(WidthError::Count {
                    widths: h.len(),
                    points: sample.len(),
                });
            }
            Bandwidth::PerPoint(h) => h.iter().copied().find(|h| !legal(h)),
            Bandwidth::PerTarget(_) => None,
        };
        match illegal {
            Some(h) => Err(WidthError::Illegal(h)),
            None => Ok(Self {
                sample,
                shape,
                bandwidth,
            }),
        }
    }

    /// The points and weights.
    pub fn sample(&self) -> &Sample<D> {
        &self.sample
    }

    /// The kernel.
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// The width.
    pub fn bandwidth(&self) -> &Bandwidth<D> {
        &self.bandwidth
    }
}

impl KernelSum<1> {
    /// The width if it is the same everywhere.
    pub fn fixed_bandwidth(&self) -> Option<f64> {
        match self.bandwidth {
            Bandwidth::Fixed([h]) => Some(h),
            _ => None,
        }
    }

    /// The largest value that the sum could have: mass × K(0) / h, all points at one place. `None` if the width varies.
    pub fn ceiling(&self) -> Option<f64> {
        self.fixed_bandwidth()
            .map(|h| self.sample.mass() * self.shape.peak() / h)
    }
}

struct At<'a, const D: usize> {
    sum: &'a KernelSum<D>,
    x: Point<D>,
}

impl<const D: usize> Use for At<'_, D> {
    type Output = f64;

    fn with<K: Kernel>(self, kernel: K) -> f64 {
        let Self { sum, x } = self;
        let mut total = Sum::default();
        for (i, point) in sum.sample.points().iter().enumerate() {
            let h = sum.bandwidth.between(i, x);
            let mut term = sum.sample.weight(i);
            for axis in 0..D {
                term *= kernel.value((x[axis] - point[axis]) / h[axis]) / h[axis];
            }
            if term != 0.0 {
                total.add(term);
            }
        }
        total.value()
    }
}

impl<const D: usize> Field<D> for KernelSum<D> {
    fn domain(&self) -> &Domain<D> {
        self.sample.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        self.shape.apply(At { sum: self, x })
    }
}
