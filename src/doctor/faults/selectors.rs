//! Selectors that count wrongly.

use super::Fault;
use crate::kernel::{Bandwidth, Shape};
use crate::numeric::special::normal_density;
use crate::sample::Sample;
use crate::selector::{Criterion, SelectError, Selection, Selector};
use std::sync::Arc;

/// n for (Σw)²/Σw².
struct BareCount(Arc<dyn Selector<1>>);

impl Selector<1> for BareCount {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        let mut selection = self.0.select(sample, shape)?;
        let ratio = (sample.effective_size() / sample.len() as f64).powf(0.2);
        if let Bandwidth::Fixed([h]) = &mut selection.bandwidth {
            *h *= ratio;
        }
        Ok(selection)
    }
}

/// The number of points, whatever they weigh.
pub const BARE_COUNT: Fault = Fault {
    name: "bare-count",
    summary: "a rule for the bandwidth takes the number of points for their effective size",
    caught_by: "reference-rule",
    plant: |subjects| subjects.reference = Arc::new(BareCount(subjects.reference.clone())),
};

/// f̂(Xᵢ) for f̂₋ᵢ(Xᵢ).
struct OwnPointKept(Arc<dyn Selector<1>>);

impl Selector<1> for OwnPointKept {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        self.0.select(sample, shape)
    }

    fn criterion(
        &self,
        sample: &Sample<1>,
        shape: Shape,
    ) -> Result<Option<Criterion>, SelectError> {
        let n = sample.effective_size();
        let right = self.0.criterion(sample, shape)?;
        Ok(right.map(|at| -> Criterion {
            Box::new(move |h| at(h) - 2.0 * normal_density(0.0) / (n * h))
        }))
    }
}

/// What cross-validation is about.
pub const OWN_POINT_KEPT: Fault = Fault {
    name: "own-point-kept",
    summary: "cross-validation does not leave the point out at which it looks",
    caught_by: "cross-validation",
    plant: |subjects| {
        subjects.cross_validation = Arc::new(OwnPointKept(subjects.cross_validation.clone()));
    },
};
