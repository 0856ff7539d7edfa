//! The definition: all distances.

use super::kept::Kept;
use super::{Metric, Neighbours, Scratch, check, select};
use crate::sample::Sample;
use crate::space::Point;

/// Looks at every point for every target: O(n) a query, and the judge of the others.
pub struct Brute<const D: usize> {
    kept: Kept<D>,
    metric: Metric<D>,
}

impl<const D: usize> Brute<D> {
    /// The finder for `sample`. O(n).
    pub fn new(sample: &Sample<D>) -> Self {
        Self {
            kept: Kept::new(sample),
            metric: Metric::new(sample.domain()),
        }
    }
}

impl<const D: usize> Neighbours<D> for Brute<D> {
    fn name(&self) -> &'static str {
        "brute"
    }

    fn count(&self) -> usize {
        self.kept.points().len()
    }

    fn metric(&self) -> &Metric<D> {
        &self.metric
    }

    fn distance(&self, target: Point<D>, k: usize, scratch: &mut Scratch) -> f64 {
        check(k, self.count());
        let home = self.metric.home(target);
        scratch.bits.clear();
        let all = self.kept.points().iter();
        scratch
            .bits
            .extend(all.map(|&x| self.metric.squared(home, x).to_bits()));
        select(&mut scratch.bits, k)
    }

    fn within(&self, target: Point<D>, squared: f64, show: &mut dyn FnMut(usize, f64)) {
        let home = self.metric.home(target);
        for (i, &x) in self.kept.points().iter().enumerate() {
            let d = self.metric.squared(home, x);
            if d <= squared {
                show(self.kept.number(i), d);
            }
        }
    }
}
