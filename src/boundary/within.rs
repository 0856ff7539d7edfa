//! A field that ends at the walls.

use crate::space::{Domain, Evaluation, Field, Point, Targets};

/// Zero outside `domain`, `field` in it.
pub(super) struct Within<const D: usize> {
    pub(super) domain: Domain<D>,
    pub(super) field: Box<dyn Field<D>>,
}

impl<const D: usize> Field<D> for Within<D> {
    fn domain(&self) -> &Domain<D> {
        &self.domain
    }

    fn at(&self, x: Point<D>) -> f64 {
        if self.domain.contains(x) {
            self.field.at(x)
        } else {
            0.0
        }
    }

    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        let mut evaluation = self.field.evaluate(targets);
        for (value, x) in evaluation.values.iter_mut().zip(targets.places()) {
            if !self.domain.contains(x) {
                *value = 0.0;
            }
        }
        evaluation
    }
}
