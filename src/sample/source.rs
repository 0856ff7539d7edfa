//! Everything that yields weighted points: a known density, a data file, a photon walk.

use super::{Sample, SampleError};
use crate::density::Density;
use crate::random::Stream;
use crate::space::{Domain, Field};

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

/// A source whose truth has any mass and is a density to nobody: hits on a surface, say.
pub trait Exposed<const D: usize>: Source<D> {
    /// Where points may lie: finite.
    fn domain(&self) -> &Domain<D>;

    /// What estimates should be: the expectation of the measure per length, area, ...
    fn field(&self) -> &dyn Field<D>;

    /// The cells of each axis beyond which the truth costs more than it tells.
    fn resolution(&self) -> usize;

    /// Where the points lie in space, if they do: the place of the origin of their coordinates and the directions of both axes, of length 1.
    fn frame(&self) -> Option<[[f64; 3]; 3]>;
}
