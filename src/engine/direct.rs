//! The definition, evaluated as written.

use super::{Engine, Quote, Unsupported};
use crate::kernel::{Kernel, KernelSum};
use crate::space::{Domain, Evaluation, Field, Point, Targets};
use rayon::prelude::*;

/// One compensated sum over all points for each target, targets in parallel. O(n m) time, O(m) memory, any kernel, any width rule.
#[derive(Clone, Copy, Debug, Default)]
pub struct Direct;

struct Prepared<const D: usize>(KernelSum<D>);

impl<const D: usize> Engine<D> for Direct {
    fn name(&self) -> &'static str {
        "direct"
    }

    fn quote(
        &self,
        sum: &KernelSum<D>,
        targets: Targets<'_, D>,
        _tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        // measured: 3 ns a pair for polynomials, 8 ns with an exponential or cosine
        let pair = match sum.shape().form() {
            crate::kernel::Form::Polynomial(_) => 3.0,
            _ => 8.0,
        };
        Ok(Quote {
            error: 4.0 * f64::EPSILON,
            nanoseconds: pair * sum.sample().len() as f64 * targets.len() as f64,
        })
    }

    fn prepare(
        &self,
        sum: KernelSum<D>,
        _tolerance: f64,
    ) -> Result<Box<dyn Field<D>>, Unsupported> {
        Ok(Box::new(Prepared(sum)))
    }
}

impl<const D: usize> Field<D> for Prepared<D> {
    fn domain(&self) -> &Domain<D> {
        self.0.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        self.0.at(x)
    }

    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        by_definition(&self.0, targets, "direct")
    }
}

/// The definition, in the name of the engine that was asked: what a quote refuses is still answered, slowly.
pub(super) fn by_definition<const D: usize>(
    sum: &KernelSum<D>,
    targets: Targets<'_, D>,
    name: &'static str,
) -> Evaluation {
    // each value is one sum in a fixed order, so the bits do not depend on the number of threads
    let places: Vec<Point<D>> = targets.places().collect();
    Evaluation {
        values: places.into_par_iter().map(|x| sum.at(x)).collect(),
        error: 4.0 * f64::EPSILON,
        engine: Some(name),
        ..Evaluation::default()
    }
}
