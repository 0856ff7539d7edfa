//! The nearest points of one place, put in order only as far as anyone asks.

use super::{Neighbours, Scratch};
use crate::space::Point;

/// A datum that was found: its squared distance and its number in the sample.
pub type Found = (f64, u32);

/// All points within some distance of one place, in buckets of squared distance.
///
/// Where the density is even, squared distances in the plane are spread evenly, so equal buckets hold about as many points each. A rank is found by looking
/// up its bucket and sorting that alone: rules that ask for a dozen ranks among thousands never sort the thousands. Gathering k points costs
/// O(k) beside what the finder takes, a rank O(log k) on average, all ranks together O(k log k) at worst.
///
/// Memory is used again from place to place.
#[derive(Debug, Default)]
pub struct Nearest {
    /// As the finder gave them.
    found: Vec<Found>,
    /// The last that fell into each bucket, by its place in `found`.
    heads: Vec<u32>,
    /// For each that was found the one that fell into its bucket before.
    earlier: Vec<u32>,
    /// Bucket i is `placed[starts[i]..starts[i + 1]]` once someone has asked for it.
    starts: Vec<u32>,
    asked: Vec<bool>,
    /// By bucket; beyond as many as were found lies what an earlier place left.
    placed: Vec<Found>,
    scratch: Scratch,
}

/// The end of a chain.
const NONE: u32 = u32::MAX;

/// Points a bucket, where they are spread evenly.
const OCCUPANCY: usize = 8;

/// Added to a number below 2³² it leaves the nearest whole number in the lowest bits of the sum.
const WHOLE: f64 = 4_503_599_627_370_496.0; // 2⁵²

impl Nearest {
    /// Gathers at least the `k` nearest points of `target`, 1 ≤ k ≤ the finder's count.
    pub fn gather<const D: usize>(
        &mut self,
        finder: &dyn Neighbours<D>,
        target: Point<D>,
        k: usize,
    ) {
        self.found.clear();
        finder.gather(target, k, &mut self.scratch, &mut self.found);
        self.distribute();
    }

    fn distribute(&mut self) {
        let many = self.found.len();
        let last = (many / OCCUPANCY).max(1);
        let scale = last as f64 / largest(&self.found);
        self.heads.clear();
        self.heads.resize(last + 1, NONE);
        self.starts.clear();
        self.starts.resize(last + 2, 0);
        self.earlier.clear();
        // beyond all numbers, and where all are at the place, everything is in the first bucket
        let spread = scale.is_finite() && scale > 0.0;
        let (heads, starts) = (&mut self.heads[..], &mut self.starts[1..]);
        let chain = |(at, found): (usize, &Found)| {
            let bucket = if spread {
                (found.0 * scale + WHOLE).to_bits() as u32 as usize
            } else {
                0
            };
            starts[bucket] += 1;
            std::mem::replace(&mut heads[bucket], at as u32)
        };
        self.earlier
            .extend(self.found.iter().enumerate().map(chain));
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.asked.clear();
        self.asked.resize(last + 1, false);
        if self.placed.len() < many {
            self.placed.resize(many, (0.0, 0));
        }
    }

    /// How many points were gathered.
    pub fn len(&self) -> usize {
        self.found.len()
    }

    /// Whether none was.
    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// How many buckets there are.
    pub(crate) fn buckets(&self) -> usize {
        self.asked.len()
    }

    /// What is in a bucket, in order; points equally far in the order of their numbers.
    pub(crate) fn bucket(&mut self, bucket: usize) -> &[Found] {
        let range = self.starts[bucket] as usize..self.starts[bucket + 1] as usize;
        let inside = &mut self.placed[range];
        if !self.asked[bucket] {
            self.asked[bucket] = true;
            let mut at = self.heads[bucket];
            for place in &mut *inside {
                *place = self.found[at as usize];
                at = self.earlier[at as usize];
            }
            inside.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        }
        inside
    }

    /// The bucket of the `k`-th nearest point and how many points are in buckets before.
    pub(crate) fn place(&self, k: usize) -> (usize, usize) {
        let bucket = self.starts.partition_point(|&start| (start as usize) < k) - 1;
        (bucket, self.starts[bucket] as usize)
    }

    /// The squared distance of the `k`-th nearest point, k from 1.
    ///
    /// # Panics
    /// For a k that was not gathered.
    pub fn squared(&mut self, k: usize) -> f64 {
        let (bucket, before) = self.place(k);
        self.bucket(bucket)[k - 1 - before].0
    }

    /// The squared distances of the `k` nearest points, ascending.
    ///
    /// # Panics
    /// For a k that was not gathered.
    pub fn first(&mut self, k: usize) -> impl Iterator<Item = Found> + '_ {
        if k > 0 {
            let (last, _) = self.place(k);
            for bucket in 0..=last {
                self.bucket(bucket);
            }
        }
        self.placed[..k].iter().copied()
    }
}

/// The largest squared distance: four chains, so that one does not wait for the other.
fn largest(found: &[Found]) -> f64 {
    let mut four = [0.0f64; 4];
    let parts = found.chunks_exact(4);
    let rest = parts.remainder();
    for part in parts {
        for (largest, found) in four.iter_mut().zip(part) {
            *largest = if found.0 > *largest {
                found.0
            } else {
                *largest
            };
        }
    }
    let rest = rest.iter().map(|found| found.0);
    four.into_iter().chain(rest).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::neighbour::{Brute, Cells, Sorted, Tree};
    use crate::random::{open_unit, stream};
    use crate::sample::Sample;
    use crate::space::Domain;

    /// A sorted list of all squared distances.
    fn all<const D: usize>(finder: &dyn Neighbours<D>, target: Point<D>) -> Vec<Found> {
        let mut all = Vec::new();
        finder.within(target, f64::INFINITY, &mut |i, d| all.push((d, i as u32)));
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all
    }

    fn check<const D: usize>(finder: &dyn Neighbours<D>, targets: &[Point<D>]) {
        let mut nearest = Nearest::default();
        let n = finder.count();
        for (i, &target) in targets.iter().enumerate() {
            let right = all(finder, target);
            for k in [1, 2, 7, n / 3 + 1, n] {
                nearest.gather(finder, target, k.min(n));
                assert!(nearest.len() >= k.min(n));
                // in any order of asking
                for rank in [k.min(n), 1, (k / 2).max(1), nearest.len()] {
                    let squared = nearest.squared(rank);
                    assert_eq!(
                        squared.to_bits(),
                        right[rank - 1].0.to_bits(),
                        "{} {i} {k}",
                        finder.name()
                    );
                }
                let some = nearest.len() / 2;
                assert!(nearest.first(some).eq(right[..some].iter().copied()));
            }
        }
    }

    fn points(n: usize, lattice: bool) -> Vec<Point<2>> {
        let mut random = stream(5, "nearest", u64::from(lattice));
        (0..n)
            .map(|_| {
                [(); 2].map(|()| {
                    let u = open_unit(&mut random);
                    if lattice {
                        (u * 12.0).floor() / 12.0
                    } else {
                        u * u
                    }
                })
            })
            .collect()
    }

    #[test]
    fn ranks_are_those_of_a_sorted_list() {
        let targets = [[0.3, 0.2], [0.0, 0.0], [0.9, 0.95], [0.5, 0.5], [-3.0, 9.0]];
        for lattice in [false, true] {
            let points = points(700, lattice);
            let sample = Sample::equal(points.clone(), Domain::whole()).expect("legal");
            check(&Brute::new(&sample), &targets);
            check(&Tree::new(&sample), &targets);
            check(&Cells::new(&sample).expect("even enough"), &targets);
            let line: Vec<Point<1>> = points.iter().map(|x| [x[0]]).collect();
            let sample = Sample::equal(line, Domain::whole()).expect("legal");
            check(&Sorted::new(&sample), &targets.map(|x| [x[0]]));
        }
    }

    /// What a finder remembers of earlier questions changes neither which points are gathered nor their order.
    #[test]
    fn memory_of_the_last_place_changes_nothing() {
        let sample = Sample::equal(points(3000, false), Domain::whole()).expect("legal");
        let tree = Tree::new(&sample);
        let cells = Cells::new(&sample).expect("even enough");
        let finders: [&dyn Neighbours<2>; 2] = [&tree, &cells];
        for finder in finders {
            let mut used = Nearest::default();
            for i in 0..60 {
                let target = [f64::from(i * 7 % 60) / 60.0, f64::from(i * 13 % 60) / 60.0];
                used.gather(finder, target, 200);
                let mut fresh = Nearest::default();
                fresh.gather(finder, target, 200);
                let many = used.len();
                assert_eq!(many, fresh.len());
                assert!(used.first(many).eq(fresh.first(many)), "{}", finder.name());
            }
        }
    }
}
