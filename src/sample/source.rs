//! Everything that yields weighted points: a known density, a data file, a photon walk.

use super::{Sample, SampleError};
use crate::density::Density;
use crate::random::Stream;

/// Yields samples. The light half of the laboratory meets the statistics half here and in `Field`, and nowhere else.
pub trait Source<const D: usize>: Send + Sync {
    /// The density that the samples follow; absent for measured data.
    fn truth(&self) -> Option<&dyn Density<D>>;

    /// A sample of `draws` points. A fixed data set has its own size and ignores both arguments.
    ///
    /// # Errors
    /// If what was drawn is not a sample.
    fn sample(&self, draws: usize, random: &mut Stream) -> Result<Sample<D>, SampleError>;
}

/// A fixed data set is a source that always yields itself.
impl<const D: usize> Source<D> for Sample<D> {
    fn truth(&self) -> Option<&dyn Density<D>> {
        None
    }

    fn sample(&self, _draws: usize, _random: &mut Stream) -> Result<Sample<D>, SampleError> {
        Ok(self.clone())
    }
}
