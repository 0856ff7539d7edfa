//! Points drawn independently from a known density.

use super::{Sample, SampleError, Source};
use crate::density::Density;
use crate::random::Stream;
use std::sync::Arc;

/// Draws from a density, 1/n a point.
#[derive(Clone)]
pub struct Drawn<const D: usize>(pub Arc<dyn Density<D>>);

impl<const D: usize> Source<D> for Drawn<D> {
    fn truth(&self) -> Option<&dyn Density<D>> {
        Some(&*self.0)
    }

    fn sample(&self, draws: usize, random: &mut Stream) -> Result<Sample<D>, SampleError> {
        Sample::equal(
            (0..draws).map(|_| self.0.draw(random)).collect(),
            self.0.domain().clone(),
        )
    }
}
