//! The nearest points of a sample: how far away the k-th is, and which they are.
//!
//! A density needs the distance to the k-th neighbour, not a sorted list of k of them, and that is much cheaper. All finders agree on it to the
//! last bit; they differ in cost.
//!
//! | finder | dimension | building | a query | file |
//! |---|---|---|---|---|
//! | brute | any | n | n | `brute.rs` |
//! | sorted | 1 | n log n | log n | `sorted.rs` |
//! | cells | 2, points not too unevenly spread | n | √k + the points near the circle | `cells/` |
//! | tree | 2, any spread | n log n | log n + k | `tree.rs` |
//!
//! **Which points count.** Those of positive weight, each once, whatever its weight: k counts points, not mass. Points at one place are as many
//! neighbours as they are points. A point at the target is its neighbour at distance zero.
//!
//! **Where.** On periodic axes the shorter way round counts. Walls do not: the ball about a place near a wall is a whole ball.

mod brute;
mod cells;
mod counter;
mod kept;
mod metric;
mod nearest;
mod sorted;
mod tree;

pub use brute::Brute;
pub use cells::Cells;
pub use counter::{Counter, Work};
pub use metric::Metric;
pub use nearest::{Found, Nearest};
pub use sorted::Sorted;
pub use tree::Tree;

use crate::sample::Sample;
use crate::space::Point;
use rayon::prelude::*;
use std::sync::Arc;

/// Memory that a finder uses again from query to query, with what it remembers of the last one. Never changes an answer.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Squared distances as bits, whose order is that of the numbers.
    bits: Vec<u64>,
    /// What the tree remembers.
    memory: tree::Memory,
}

/// Finds the neighbours of places among the points of positive weight of one sample.
pub trait Neighbours<const D: usize>: Send + Sync {
    /// The name in tables.
    fn name(&self) -> &'static str;

    /// How many points there are; each is a neighbour.
    fn count(&self) -> usize;

    /// What near means.
    fn metric(&self) -> &Metric<D>;

    /// The **squared** distance from `target` to the `k`-th nearest point, 1 ≤ k ≤ `count`; infinite if it overflows.
    ///
    /// # Panics
    /// For any other k.
    fn distance(&self, target: Point<D>, k: usize, scratch: &mut Scratch) -> f64;

    /// Shows each point whose **squared** distance from `target` is at most `squared`: its number in the sample and its squared distance, in
    /// an order that depends on nothing but the sample and the target.
    fn within(&self, target: Point<D>, squared: f64, show: &mut dyn FnMut(usize, f64));

    /// Adds to `found` all points within some distance of `target` that holds at least `k` of them, 1 ≤ k ≤ `count`. Which points and in which order
    /// depends on nothing but the sample, the target and k.
    ///
    /// # Panics
    /// For any other k.
    fn gather(&self, target: Point<D>, k: usize, scratch: &mut Scratch, found: &mut Vec<Found>) {
        let squared = self.distance(target, k, scratch);
        self.within(target, squared, &mut |i, d| found.push((d, i as u32)));
    }
}

/// A sample whose dimension has finders.
pub trait Searchable<const D: usize> {
    /// The finder expected to be fastest.
    fn neighbours(&self) -> Arc<dyn Neighbours<D>>;
}

impl Searchable<1> for Sample<1> {
    fn neighbours(&self) -> Arc<dyn Neighbours<1>> {
        Arc::new(Sorted::new(self))
    }
}

/// Fewer points than this are not worth a structure: scanning them all takes less than a microsecond.
const FEW: usize = 64;

impl Searchable<2> for Sample<2> {
    fn neighbours(&self) -> Arc<dyn Neighbours<2>> {
        if self.len() <= FEW || !squares(self.points()) {
            return Arc::new(Brute::new(self));
        }
        match Cells::new(self) {
            Some(cells) => Arc::new(cells),
            None => Arc::new(Tree::new(self)),
        }
    }
}

/// Whether squares of distances between these points neither overflow nor lose digits.
fn squares(points: &[Point<2>]) -> bool {
    let [x, y] = points[0];
    let extent = points
        .iter()
        .map(|p| (p[0] - x).abs().max((p[1] - y).abs()))
        .fold(0.0, f64::max);
    (1e-130..1e150).contains(&extent) && x.abs().max(y.abs()) < 1e150
}

/// What `look` finds at each of `targets`, in their order, in parallel. Each answer depends on its target alone, so the bits depend neither
/// on the number of threads nor on the order in which the targets are taken, which is one that keeps neighbours together.
pub fn at_each<const D: usize, T: Send + Sync + Copy + Default>(
    targets: &[Point<D>],
    look: impl Fn(Point<D>, &mut Scratch) -> T + Sync,
) -> Vec<T> {
    /// Long enough that memory of the last query is worth having, short enough to share the work evenly.
    const BLOCK: usize = 256;
    let Some(order) = order(targets) else {
        let blocks: Vec<Vec<T>> = targets
            .par_chunks(BLOCK)
            .map_init(Scratch::default, |scratch, block| {
                block.iter().map(|&x| look(x, scratch)).collect()
            })
            .collect();
        return blocks.concat();
    };
    let found: Vec<Vec<T>> = order
        .par_chunks(BLOCK)
        .map_init(Scratch::default, |scratch, block| {
            let at = |&i: &u32| look(targets[i as usize], scratch);
            block.iter().map(at).collect()
        })
        .collect();
    let mut values = vec![T::default(); targets.len()];
    for (&i, value) in order.iter().zip(found.into_iter().flatten()) {
        values[i as usize] = value;
    }
    values
}

/// An order that goes through many targets tile by tile, or `None` where they are few or near each other in their own order, as on a grid: then memory is read
/// from here and there no more than it must.
fn order<const D: usize>(targets: &[Point<D>]) -> Option<Vec<u32>> {
    const MANY: usize = 1024;
    const TILES: f64 = 128.0;
    if targets.len() < MANY || u32::try_from(targets.len()).is_err() {
        return None;
    }
    let (mut low, mut high) = (targets[0], targets[0]);
    for x in targets {
        for axis in 0..D {
            low[axis] = low[axis].min(x[axis]);
            high[axis] = high[axis].max(x[axis]);
        }
    }
    let tile = |x: &Point<D>| {
        let mut number = 0u32;
        for axis in 0..D {
            let share = (x[axis] - low[axis]) / (high[axis] - low[axis]);
            // casts take care of what is no number
            number = number * TILES as u32 + (share * TILES) as u32;
        }
        number
    };
    let mut keys: Vec<(u32, u32)> = targets.iter().zip(0..).map(|(x, i)| (tile(x), i)).collect();
    let jumps = keys
        .windows(2)
        .filter(|pair| pair[0].0.abs_diff(pair[1].0) > 2)
        .count();
    if jumps < targets.len() / 8 {
        return None;
    }
    keys.sort_unstable();
    Some(keys.into_iter().map(|(_, i)| i).collect())
}

/// The `k`-th smallest of some squared distances given as bits, k from 1.
fn select(bits: &mut [u64], k: usize) -> f64 {
    f64::from_bits(*bits.select_nth_unstable(k - 1).1)
}

fn check(k: usize, count: usize) {
    assert!(
        (1..=count).contains(&k),
        "neighbour {k} of {count} points was asked for"
    );
}

#[cfg(test)]
mod tests;
