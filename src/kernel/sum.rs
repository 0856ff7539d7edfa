//! The weighted sum of kernels: what every kernel estimate is.

use super::{Bandwidth, Kernel, Shape, Symmetry, Use};
use crate::numeric::Sum;
use crate::sample::Sample;
use crate::space::{Domain, Field, Point};

/// f̂(x) = Σᵢ wᵢ Πₐ K((xₐ - Xᵢₐ) / hₐ) / hₐ, the product kernel over the axes a; or, where the kernel is radial,
/// f̂(x) = Σᵢ wᵢ c K(√Σₐ ((xₐ - Xᵢₐ) / hₐ)²) / Πₐ hₐ with c from [`Symmetry::factor`].
///
/// This is the **definition**: its own slow, exact field, one compensated sum over all points per target. Engines compute the
/// same numbers for less and are judged by it.
#[derive(Clone, Debug)]
pub struct KernelSum<const D: usize> {
    sample: Sample<D>,
    shape: Shape,
    bandwidth: Bandwidth<D>,
    symmetry: Symmetry,
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
    /// Widths whose product is so small that the largest density is no finite number.
    #[error(
        "bandwidths of {0:?} give densities beyond the largest number; change the unit of the data"
    )]
    Thin(Vec<f64>),
}

impl<const D: usize> KernelSum<D> {
    /// The sum of `shape` over `sample` at `bandwidth`, the product kernel; see [`KernelSum::radial`].
    ///
    /// # Errors
    /// If a width is not positive and finite (1/h, and their product over the axes, must be finite too), or the widths per point are not one a point.
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
        if let Some(h) = illegal {
            return Err(WidthError::Illegal(h));
        }
        // no kernel is higher than 1 or wider than 1/4 on any axis in the plane, so a finite 1/Πh is a finite peak
        let density = |h: [f64; D]| h.iter().fold(sample.mass(), |density, h| density / h);
        let thin = match &bandwidth {
            Bandwidth::Fixed(h) => Some(*h).filter(|h| !density(*h).is_finite()),
            Bandwidth::PerPoint(h) => {
                let least = h.iter().copied().fold(f64::INFINITY, f64::min);
                Some([least; D]).filter(|h| !density(*h).is_finite())
            }
            Bandwidth::PerTarget(_) => None,
        };
        match thin {
            Some(h) => Err(WidthError::Thin(h.to_vec())),
            None => Ok(Self {
                sample,
                shape,
                bandwidth,
                symmetry: Symmetry::Product,
            }),
        }
    }

    /// The same with the kernel a function of the distance.
    #[must_use]
    pub fn radial(self) -> Self {
        self.with_symmetry(Symmetry::Radial)
    }

    /// The same with the kernel a product or a function of the distance.
    #[must_use]
    pub fn with_symmetry(self, symmetry: Symmetry) -> Self {
        Self { symmetry, ..self }
    }

    /// Whether the kernel is a product over the axes or a function of the distance.
    pub fn symmetry(&self) -> Symmetry {
        self.symmetry
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

    /// The width on each axis if it is the same everywhere.
    pub fn fixed(&self) -> Option<[f64; D]> {
        match self.bandwidth {
            Bandwidth::Fixed(h) => Some(h),
            _ => None,
        }
    }

    /// The largest value that the sum could have: mass × K(0) / Πh, all points at one place. `None` if the width varies.
    pub fn ceiling(&self) -> Option<f64> {
        let peak = self.sample.mass() * self.symmetry.peak::<D>(self.shape);
        self.fixed()
            .map(|h| h.iter().fold(peak, |value, h| value / h))
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
        let radial = D > 1 && sum.symmetry == Symmetry::Radial;
        let factor = sum.symmetry.factor::<D>(sum.shape);
        for (i, point) in sum.sample.points().iter().enumerate() {
            let h = sum.bandwidth.between(i, x);
            let mut term = sum.sample.weight(i);
            let mut square = 0.0;
            for axis in 0..D {
                let u = (x[axis] - point[axis]) / h[axis];
                if radial {
                    square += u * u;
                    term /= h[axis];
                } else {
                    term *= kernel.value(u) / h[axis];
                }
            }
            if radial {
                term *= kernel.of_square(square) * factor;
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::space::{Grid, Raster};

    fn one_point(shape: Shape, symmetry: Symmetry) -> KernelSum<2> {
        let sample = Sample::equal(vec![[0.5, -0.25]], Domain::whole()).unwrap();
        KernelSum::new(sample, shape, Bandwidth::Fixed([0.5, 0.25]))
            .unwrap()
            .with_symmetry(symmetry)
    }

    /// Each kernel at two places, written out by hand for h = (1/2, 1/4).
    #[test]
    fn the_plane_is_as_written() {
        use std::f64::consts::PI;
        let u = (1.3 - 1.0) / 1.0;
        let place = [0.5 + 0.5 * u, -0.25 + 0.25 * 0.4];
        let r = (u * u + 0.16_f64).sqrt();
        for (shape, symmetry, expected) in [
            (
                Shape::Epanechnikov,
                Symmetry::Product,
                9.0 / 16.0 * (1.0 - u * u) * (1.0 - 0.16),
            ),
            (
                Shape::Epanechnikov,
                Symmetry::Radial,
                2.0 / PI * (1.0 - r * r),
            ),
            (Shape::Triangular, Symmetry::Radial, 3.0 / PI * (1.0 - r)),
            (Shape::Uniform, Symmetry::Product, 0.25),
            (Shape::Uniform, Symmetry::Radial, 1.0 / PI),
            (
                Shape::Gaussian,
                Symmetry::Radial,
                (-0.5 * r * r).exp() / (2.0 * PI),
            ),
            (
                Shape::Gaussian,
                Symmetry::Product,
                (-0.5 * r * r).exp() / (2.0 * PI),
            ),
        ] {
            let got = one_point(shape, symmetry).at(place);
            assert!(
                (got - 8.0 * expected).abs() < 1e-14,
                "{symmetry} {shape}: {got} {}",
                8.0 * expected
            );
        }
    }

    #[test]
    fn the_support_is_closed_and_its_shape_is_the_symmetry() {
        let [box_, disc] = Symmetry::ALL.map(|symmetry| one_point(Shape::Uniform, symmetry));
        for (place, in_box, in_disc) in [
            ([1.0, -0.25], true, true),
            ([0.5, 0.0], true, true),
            ([1.0, 0.0], true, false),
            ([0.75, -0.125], true, true),
            ([1.0 + 1e-15, -0.25], false, false),
        ] {
            assert_eq!(box_.at(place) > 0.0, in_box, "{place:?}");
            assert_eq!(disc.at(place) > 0.0, in_disc, "{place:?}");
        }
    }

    #[test]
    fn every_bump_has_the_mass_of_its_point_and_the_height_of_the_ceiling() {
        let grid = Grid::new([-4.5, -2.75], [5.5, 2.25], [500, 500]).unwrap();
        for shape in Shape::ALL {
            for symmetry in Symmetry::ALL {
                let sum = one_point(shape, symmetry);
                let mass =
                    Raster::new(grid, grid.centres().map(|x| sum.at(x)).collect()).integral();
                // the midpoint rule on 50 cells a unit; edges are the worst
                assert!((mass - 1.0).abs() < 1e-2, "{symmetry} {shape}: {mass}");
                let top = sum.at([0.5, -0.25]);
                assert!((top / sum.ceiling().unwrap() - 1.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn widths_too_thin_for_a_number_are_refused() {
        let sample = Sample::equal(vec![[0.0, 0.0]; 3], Domain::whole()).unwrap();
        let with = |bandwidth| KernelSum::new(sample.clone(), Shape::Gaussian, bandwidth).err();
        assert!(matches!(
            with(Bandwidth::Fixed([1e-200, 1e-200])),
            Some(WidthError::Thin(_))
        ));
        assert!(matches!(
            with(Bandwidth::PerPoint(vec![1.0, 1e-200, 1.0].into())),
            Some(WidthError::Thin(_))
        ));
        assert!(matches!(
            with(Bandwidth::Fixed([1.0, -1.0])),
            Some(WidthError::Illegal(_))
        ));
        assert_eq!(with(Bandwidth::Fixed([1e-200, 1.0])), None);
    }
}
