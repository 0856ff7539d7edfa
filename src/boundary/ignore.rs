//! No treatment: kernels reach through the walls, and the estimate there is short by what they lay outside.

use super::Boundary;
use crate::kernel::KernelSum;
use crate::space::Field;

/// Leaves the sum as it is. E f̂ is half of f at a wall. [Silverman 1986, section 2.10]
#[derive(Clone, Copy, Debug, Default)]
pub struct Ignore;

impl<const D: usize> Boundary<D> for Ignore {
    fn name(&self) -> &'static str {
        "ignore"
    }

    fn correct(
        &self,
        sum: KernelSum<D>,
        compute: &dyn Fn(KernelSum<D>) -> Box<dyn Field<D>>,
    ) -> Box<dyn Field<D>> {
        compute(sum)
    }
}
