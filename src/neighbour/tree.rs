//! Any spread in the plane: the k-d tree of the kiddo crate.

use super::kept::Kept;
use super::{Metric, Neighbours, Scratch, check};
use crate::sample::Sample;
use crate::space::Point;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;
use std::num::NonZeroUsize;

/// A k-d tree over the distinct places of the points.
///
/// Points at one place are stored once, with how many they are: the tree keeps them in one leaf, which would be scanned as a whole. The tree finds
/// all within a radius fast and the nearest in order slowly, so the radius comes from the last query where that is near, by the triangle inequality: it holds
/// k points for sure. Where such a radius turns out to hold far too many (a dense cluster at a distance), the next queries go the slow way, which is
/// never worse than k log k, until the loss is made good.
///
/// On periodic axes the images of the target are asked for.
///
/// Building is O(n log n), a query O(log n + k).
pub struct Tree {
    tree: ImmutableKdTree<f64, 2>,
    places: Vec<Point<2>>,
    /// The points at place i are `numbers[starts[i]..starts[i + 1]]`, numbers in the sample.
    starts: Vec<u32>,
    numbers: Vec<u32>,
    metric: Metric<2>,
}

/// What is remembered of the last query.
#[derive(Debug, Default)]
pub struct Memory<const D: usize> {
    last: Option<(Point<D>, usize, f64)>,
    /// Points that were looked at in vain and not yet made good.
    debt: usize,
    /// Squared distances with how many points are there.
    found: Vec<(f64, u32)>,
    /// Places found, where images can meet.
    seen: Vec<u32>,
}

/// A radius that is enlarged by this factor holds all that is within the radius, whatever the rounding in the tree.
const SAFE: f64 = 1.0 + 1e-9;

impl Tree {
    /// The finder for `sample`.
    pub fn new(sample: &Sample<2>) -> Self {
        let kept = Kept::new(sample);
        let place = |i: u32| kept.points[i as usize].map(|x| x + 0.0); // one zero
        let mut order: Vec<u32> = (0..kept.points.len() as u32).collect();
        order.par_sort_unstable_by(|&i, &j| {
            let ([a, b], [c, d]) = (place(i), place(j));
            a.total_cmp(&c).then(b.total_cmp(&d)).then(i.cmp(&j))
        });
        let mut places: Vec<Point<2>> = Vec::new();
        let mut starts = Vec::new();
        for (at, &i) in order.iter().enumerate() {
            let here = place(i);
            if places.last() != Some(&here) {
                places.push(here);
                starts.push(at as u32);
            }
        }
        starts.push(order.len() as u32);
        Self {
            tree: ImmutableKdTree::new_from_slice(&places)
                .expect("places are finite and fewer than 2³²"),
            places,
            starts,
            numbers: order
                .iter()
                .map(|&i| kept.number(i as usize) as u32)
                .collect(),
            metric: Metric::new(sample.domain()),
        }
    }

    fn multiplicity(&self, place: usize) -> u32 {
        self.starts[place + 1] - self.starts[place]
    }

    /// The target and, where axes wrap round, those of its images from which a ball of `radius` reaches the domain.
    fn images(&self, home: Point<2>, radius: f64) -> Vec<Point<2>> {
        let mut images = vec![home];
        for axis in 0..2 {
            let period = self.metric.period(axis);
            if period.is_infinite() {
                continue;
            }
            let low = self.metric.low()[axis];
            for i in 0..images.len() {
                let mut image = images[i];
                image[axis] = home[axis] - period;
                if image[axis] + radius >= low {
                    images.push(image);
                }
                image[axis] = home[axis] + period;
                if image[axis] - radius <= low + period {
                    images.push(image);
                }
            }
        }
        images
    }

    /// Shows each place within `squared` of `home` once, with the exact squared distance.
    fn places_within(
        &self,
        home: Point<2>,
        squared: f64,
        seen: &mut Vec<u32>,
        mut show: impl FnMut(usize, f64),
    ) {
        let safe = (squared * SAFE).max(f64::MIN_POSITIVE);
        if !safe.is_finite() || !home.iter().all(|x| x.abs() < 1e150) {
            // beyond what squares can tell
            for (i, &place) in self.places.iter().enumerate() {
                let d = self.metric.squared(home, place);
                if d <= squared {
                    show(i, d);
                }
            }
            return;
        }
        if !self.metric.wraps() {
            self.tree
                .query(&home)
                .within::<SquaredEuclidean<f64>>(safe)
                .unsorted()
                .visit(|hit| {
                    let i = hit.item as usize;
                    let d = self.metric.squared(home, self.places[i]);
                    if d <= squared {
                        show(i, d);
                    }
                });
            return;
        }
        seen.clear();
        // turning rounds coordinates, by less than this
        let turned = (0..2)
            .filter(|&axis| self.metric.period(axis).is_finite())
            .map(|axis| 8.0 * f64::EPSILON * (home[axis].abs() + self.metric.period(axis)))
            .fold(0.0, f64::max);
        let reach = (safe.sqrt() + turned).powi(2);
        for image in self.images(home, reach.sqrt()) {
            self.tree
                .query(&image)
                .within::<SquaredEuclidean<f64>>(reach)
                .unsorted()
                .visit(|hit| seen.push(hit.item));
        }
        seen.sort_unstable();
        seen.dedup();
        for &item in seen.iter() {
            let i = item as usize;
            let d = self.metric.squared(home, self.places[i]);
            if d <= squared {
                show(i, d);
            }
        }
    }

    /// A squared radius that holds at least `k` points, found the slow way.
    fn enough(&self, home: Point<2>, k: usize) -> f64 {
        let some = NonZeroUsize::new(k.min(self.places.len())).expect("k is at least 1");
        if !home.iter().all(|x| x.abs() < 1e150) {
            return f64::INFINITY;
        }
        // the target's own image alone gives an upper bound on the way round
        self.tree
            .query(&home)
            .nearest_n::<SquaredEuclidean<f64>>(some)
            .execute()
            .iter()
            .map(|hit| self.metric.squared(home, self.places[hit.item as usize]))
            .fold(0.0, f64::max)
    }
}

/// The distance to the `k`-th of points of which `u32` are at each distance.
fn select(found: &mut [(f64, u32)], k: usize) -> f64 {
    let singles = found.iter().all(|(_, many)| *many == 1);
    if singles {
        return found
            .select_nth_unstable_by(k - 1, |a, b| a.0.total_cmp(&b.0))
            .1
            .0;
    }
    found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut points = 0;
    found
        .iter()
        .find(|(_, many)| {
            points += *many as usize;
            points >= k
        })
        .expect("the radius holds k points")
        .0
}

impl Neighbours<2> for Tree {
    fn name(&self) -> &'static str {
        "tree"
    }

    fn count(&self) -> usize {
        self.numbers.len()
    }

    fn metric(&self) -> &Metric<2> {
        &self.metric
    }

    fn distance(&self, target: Point<2>, k: usize, scratch: &mut Scratch<2>) -> f64 {
        check(k, self.count());
        let home = self.metric.home(target);
        let memory = &mut scratch.memory;
        let guess = memory
            .last
            .filter(|(_, many, _)| *many == k && memory.debt == 0)
            .map(|(place, _, radius)| {
                let radius = radius + self.metric.squared(place, home).sqrt();
                radius * radius * SAFE
            });
        let radius = match guess {
            Some(squared) if squared.is_finite() => squared,
            _ => {
                memory.debt = memory.debt.saturating_sub(8 * k + 64);
                self.enough(home, k)
            }
        };
        let (mut found, mut seen) = (
            std::mem::take(&mut memory.found),
            std::mem::take(&mut memory.seen),
        );
        found.clear();
        self.places_within(home, radius, &mut seen, |i, d| {
            found.push((d, self.multiplicity(i)));
        });
        let distance = select(&mut found, k);
        memory.debt += found.len().saturating_sub(4 * k + 64);
        memory.last = Some((home, k, distance.sqrt()));
        (memory.found, memory.seen) = (found, seen);
        distance
    }

    fn within(&self, target: Point<2>, squared: f64, show: &mut dyn FnMut(usize, f64)) {
        let home = self.metric.home(target);
        self.places_within(home, squared, &mut Vec::new(), |i, d| {
            for at in self.starts[i]..self.starts[i + 1] {
                show(self.numbers[at as usize] as usize, d);
            }
        });
    }
}
