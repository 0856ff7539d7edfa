//! One kernel of one width: what a wall cuts.

use crate::kernel::{Kernel, KernelSum, Shape, Symmetry};
use crate::space::Point;

/// K((x - y)/h) / Πh as a function of two places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bump<const D: usize> {
    /// The kernel.
    pub shape: Shape,
    /// A product over the axes, or a function of the distance.
    pub symmetry: Symmetry,
    /// h on each axis.
    pub width: [f64; D],
}

impl<const D: usize> Bump<D> {
    /// The bump that `sum` puts on point `i`, as a target at `x` sees it.
    pub fn of(sum: &KernelSum<D>, i: usize, x: Point<D>) -> Self {
        Self {
            shape: sum.shape(),
            symmetry: sum.symmetry(),
            width: sum.bandwidth().between(i, x),
        }
    }

    /// The kernel between `x` and `y`, computed as the definition of the kernel sum does.
    #[inline]
    pub fn value(&self, x: Point<D>, y: Point<D>) -> f64 {
        let radial = D > 1 && self.symmetry == Symmetry::Radial;
        let (mut value, mut square) = (1.0, 0.0);
        for axis in 0..D {
            let u = (x[axis] - y[axis]) / self.width[axis];
            if radial {
                square += u * u;
                value /= self.width[axis];
            } else {
                value *= self.shape.value(u) / self.width[axis];
            }
        }
        if radial {
            value *= self.shape.of_square(square) * self.symmetry.factor::<D>(self.shape);
        }
        value
    }

    /// How far on each axis the kernel is felt: its support, or where the Gaussian has lost its last digit.
    pub fn reach(&self) -> [f64; D] {
        let reach = self.shape.reach().min(super::moments::GAUSSIAN_REACH);
        self.width.map(|h| h * reach)
    }
}
