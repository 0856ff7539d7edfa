//! Any spread in the plane: the k-d tree of the kiddo crate.

use super::kept::Kept;
use super::{Found, Metric, Neighbours, Scratch, check};
use crate::sample::Sample;
use crate::space::Point;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;
use std::num::NonZeroUsize;

/// A k-d tree over the distinct places of the points.
///
/// Points at one place are stored once, with how many they are: the tree keeps them in one leaf, which would be scanned as a whole. The tree finds
/// all within a radius fast and the nearest in order slowly, so the radius is guessed from the last query and enlarged where it holds too few. Where
/// it holds far too many (a dense cluster at a distance), the next queries go the slow way, which is never worse than k log k, until the loss
/// is made good. The answer does not depend on the guess.
///
/// On periodic axes the images of the target are asked for.
///
/// Building is O(n log n), a query O(log n + k).
pub struct Tree {
    index: ImmutableKdTree<f64, 2>,
    places: Vec<Point<2>>,
    /// The points at place i are `numbers[starts[i]..starts[i + 1]]`, numbers in the sample.
    starts: Vec<u32>,
    numbers: Vec<u32>,
    metric: Metric<2>,
}

/// What is remembered of the last query.
#[derive(Debug, Default)]
pub struct Memory {
    /// k and the squared distance.
    last: Option<(usize, f64)>,
    /// Points that were looked at in vain and not yet made good.
    debt: usize,
    /// Squared distances with a place or how many points are there.
    found: Vec<(f64, u32)>,
    /// Places found, where images can meet.
    seen: Vec<u32>,
}

/// A radius that is enlarged by this factor holds all that is within the radius, whatever the rounding in the tree.
const SAFE: f64 = 1.0 + 1e-9;

impl Tree {
    /// The finder for `sample`.
    ///
    /// # Panics
    /// For 2³² points or more.
    pub fn new(sample: &Sample<2>) -> Self {
        let kept = Kept::new(sample);
        let place = |i: u32| kept.points()[i as usize].map(|x| x + 0.0); // one zero
        let mut order: Vec<u32> = (0..kept.points().len() as u32).collect();
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
            index: ImmutableKdTree::new_from_slice(&places)
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
            self.index
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
            self.index
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

    /// The squared distances of the `k` nearest places, images apart, in the tree's own rounding, as long as nothing overflows.
    fn nearest(&self, home: Point<2>, k: usize) -> Option<Vec<(f64, u32)>> {
        let some = NonZeroUsize::new(k.min(self.places.len())).expect("k is at least 1");
        home.iter().all(|x| x.abs() < 1e150).then(|| {
            self.index
                .query(&home)
                .nearest_n::<SquaredEuclidean<f64>>(some)
                .execute()
                .iter()
                .map(|hit| (hit.distance, hit.item))
                .collect()
        })
    }

    /// A squared radius that holds at least `k` points, found the slow way.
    fn enough(&self, home: Point<2>, k: usize) -> f64 {
        // on the way round the bound is perhaps larger than it need be
        self.nearest(home, k).map_or(f64::INFINITY, |list| {
            list.iter()
                .map(|&(_, i)| self.metric.squared(home, self.places[i as usize]))
                .fold(0.0, f64::max)
        })
    }

    /// The k-th squared distance where images or ties make it necessary to look at each place.
    fn carefully(&self, home: Point<2>, k: usize, memory: &mut Memory) -> f64 {
        let radius = self.enough(home, k);
        let Memory { found, seen, .. } = memory;
        found.clear();
        self.places_within(home, radius, seen, |i, d| {
            found.push((d, self.multiplicity(i)));
        });
        select(found, k)
    }

    /// The same where there is one point at each place and no axis wraps round: from a radius that should hold k points, or in order.
    fn quickly(&self, home: Point<2>, k: usize, memory: &mut Memory) -> f64 {
        let guess = memory
            .last
            .filter(|(many, squared)| *many == k && memory.debt == 0 && *squared > 0.0);
        if let Some((_, last)) = guess {
            let mut squared = last * (1.0 + 2.0 / (k as f64).sqrt());
            for _ in 0..3 {
                let found = &mut memory.found;
                found.clear();
                if squared.is_finite() && home.iter().all(|x| x.abs() < 1e150) {
                    self.index
                        .query(&home)
                        .within::<SquaredEuclidean<f64>>(squared)
                        .unsorted()
                        .visit(|hit| found.push((hit.distance, hit.item)));
                }
                memory.debt += found.len().saturating_sub(4 * k);
                if found.len() >= k {
                    let at = found.select_nth_unstable_by(k - 1, |a, b| a.0.total_cmp(&b.0));
                    let (distance, item) = *at.1;
                    if self.agrees(home, distance, item) {
                        return distance;
                    }
                    break;
                }
                squared *= (1.5 * k as f64 / found.len().max(1) as f64).clamp(1.5, 8.0);
            }
        }
        memory.debt = memory.debt.saturating_sub(8 * k + 64);
        let last = self.nearest(home, k).and_then(|list| list.last().copied());
        match last {
            Some((distance, item)) if self.agrees(home, distance, item) => distance,
            _ => self.carefully(home, k, memory),
        }
    }

    /// All points within the distance of the `k`-th where there is one at each place and no axis wraps round, from the radius of the last query; `None`, with
    /// nothing found, where that was of no use.
    fn collect(
        &self,
        home: Point<2>,
        k: usize,
        memory: &mut Memory,
        found: &mut Vec<Found>,
    ) -> Option<f64> {
        let (_, last) = memory
            .last
            .filter(|(many, squared)| *many == k && memory.debt == 0 && *squared > 0.0)?;
        let before = found.len();
        let mut squared = last * (1.0 + 2.0 / (k as f64).sqrt());
        for _ in 0..3 {
            self.places_within(home, squared, &mut memory.seen, |i, d| {
                found.push((d, self.numbers[i]));
            });
            let many = found.len() - before;
            memory.debt += many.saturating_sub(4 * k);
            if many >= k {
                let copy = &mut memory.found;
                copy.clear();
                copy.extend_from_slice(&found[before..]);
                let at = copy.select_nth_unstable_by(k - 1, |a, b| a.0.total_cmp(&b.0));
                let distance = at.1.0;
                // what lies beyond depends on the last query
                let mut end = before;
                for i in before..found.len() {
                    let one = found[i];
                    found[end] = one;
                    end += usize::from(one.0 <= distance);
                }
                found.truncate(end);
                return Some(distance);
            }
            found.truncate(before);
            squared *= (1.5 * k as f64 / many.max(1) as f64).clamp(1.5, 8.0);
        }
        None
    }

    /// Whether the tree rounds as the metric does.
    fn agrees(&self, home: Point<2>, distance: f64, item: u32) -> bool {
        let metric = self.metric.squared(home, self.places[item as usize]);
        metric.to_bits() == distance.to_bits()
    }
}

/// The distance to the `k`-th of points of which `u32` are at each distance.
fn select(found: &mut [(f64, u32)], k: usize) -> f64 {
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

    fn distance(&self, target: Point<2>, k: usize, scratch: &mut Scratch) -> f64 {
        check(k, self.count());
        let home = self.metric.home(target);
        let memory = &mut scratch.memory;
        let single = self.places.len() == self.numbers.len();
        let distance = if single && !self.metric.wraps() {
            self.quickly(home, k, memory)
        } else {
            self.carefully(home, k, memory)
        };
        memory.last = Some((k, distance));
        distance
    }

    fn gather(&self, target: Point<2>, k: usize, scratch: &mut Scratch, found: &mut Vec<Found>) {
        check(k, self.count());
        let memory = &mut scratch.memory;
        if self.places.len() == self.numbers.len() && !self.metric.wraps() {
            let home = self.metric.home(target);
            if let Some(distance) = self.collect(home, k, memory, found) {
                memory.last = Some((k, distance));
                return;
            }
        }
        let squared = self.distance(target, k, scratch);
        self.within(target, squared, &mut |i, d| found.push((d, i as u32)));
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
