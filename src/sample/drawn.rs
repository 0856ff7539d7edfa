//! Points drawn independently from a known density.

use super::{Sample, SampleError, Source, Weights};
use crate::density::Density;
use crate::random::Stream;
use std::sync::Arc;

/// Draws from a density, 1/n a point. Where the density is what a window shows of another that goes on beyond it ([`Density::beyond`]), that one is drawn from until n points have fallen into the window, and those
/// that fell beside it are the margin of the sample, of the same weight.
#[derive(Clone)]
pub struct Drawn<const D: usize>(pub Arc<dyn Density<D>>);

impl<const D: usize> Source<D> for Drawn<D> {
    fn truth(&self) -> Option<&dyn Density<D>> {
        Some(&*self.0)
    }

    fn sample(&self, draws: usize, random: &mut Stream) -> Result<Sample<D>, SampleError> {
        let domain = self.0.domain().clone();
        let Some((whole, _)) = self.0.beyond() else {
            return Sample::equal(self.0.draws(draws, random), domain);
        };
        let (mut points, mut margin) = (Vec::with_capacity(draws), Vec::new());
        while points.len() < draws {
            let x = whole.draw(random);
            if domain.contains(x) {
                points.push(x);
            } else {
                margin.push(x);
            }
        }
        let each = Weights::Equal(1.0 / draws as f64);
        Sample::equal(points, domain)?.with_margin(margin, each, Vec::new())
    }
}
