//! No treatment: kernels reach through the walls, and the estimate there is short by what they lay outside.

use super::{Boundary, BoundaryError, Bump, Compute, Equivalent, Promises};
use crate::kernel::KernelSum;
use crate::space::{Domain, Field, Point};

/// Leaves the sum as it is. E f̂ is half of f at a wall, a quarter in a right corner. [Silverman 1986, section 2.10]
#[derive(Clone, Copy, Debug, Default)]
pub struct Ignore;

impl<const D: usize> Boundary<D> for Ignore {
    fn name(&self) -> &'static str {
        "ignore"
    }

    fn promises(&self) -> Promises {
        Promises {
            mass_conserving: false,
            non_negative: true,
            linear: true,
            reproduces_constants: false,
            reproduces_lines: false,
        }
    }

    fn correct(
        &self,
        sum: KernelSum<D>,
        compute: Compute<'_, D>,
    ) -> Result<Box<dyn Field<D>>, BoundaryError> {
        Ok(compute(sum))
    }

    fn equivalent<'a>(
        &self,
        bump: &'a Bump<D>,
        _domain: &'a Domain<D>,
        x: Point<D>,
    ) -> Option<Equivalent<'a, D>> {
        Some(Box::new(move |y| bump.value(x, y)))
    }
}
