//! The line and the circle: sorted points, binary search.

use super::kept::Kept;
use super::{Counter, Metric, Neighbours, Scratch, check, select};
use crate::sample::Sample;
use crate::space::Point;
use rayon::prelude::*;

/// Keeps the points in order. The k nearest are k consecutive ones, so the k-th distance takes two binary searches: O(log n) for any k.
///
/// Building is O(n log n).
pub struct Sorted {
    points: Vec<f64>,
    numbers: Vec<u32>,
    metric: Metric<1>,
    /// What rounding may do to a coordinate that went once round.
    slack: f64,
}

impl Sorted {
    /// The finder for `sample`.
    pub fn new(sample: &Sample<1>) -> Self {
        let kept = Kept::new(sample);
        let coordinates = kept.points().as_flattened();
        let mut order: Vec<u32> = (0..coordinates.len() as u32).collect();
        // ties in the order of the sample: a total order, so the bits do not depend on threads
        order.par_sort_unstable_by(|&i, &j| {
            let (a, b) = (coordinates[i as usize], coordinates[j as usize]);
            a.total_cmp(&b).then(i.cmp(&j))
        });
        let metric = Metric::new(sample.domain());
        let period = metric.period(0);
        let largest = sample.domain().low()[0]
            .abs()
            .max(sample.domain().high()[0].abs());
        Self {
            points: order.iter().map(|&i| coordinates[i as usize]).collect(),
            numbers: order
                .iter()
                .map(|&i| kept.number(i as usize) as u32)
                .collect(),
            metric,
            slack: if period.is_finite() {
                8.0 * f64::EPSILON * (largest + period)
            } else {
                0.0
            },
        }
    }

    fn wraps(&self) -> bool {
        self.metric.wraps()
    }

    /// The `i`-th point counted on round and round: `i` may be one turn below 0 or above n.
    fn turned(&self, i: isize) -> f64 {
        let n = self.points.len() as isize;
        if (0..n).contains(&i) {
            return self.points[i as usize];
        }
        self.points[i.rem_euclid(n) as usize] + i.div_euclid(n) as f64 * self.metric.period(0)
    }

    /// Where the k nearest to `t` begin, as a number for [`Sorted::turned`].
    fn window<C: Counter>(&self, t: f64, k: usize, counter: &mut C) -> isize {
        let (n, k) = (self.points.len() as isize, k as isize);
        let before = |&x: &f64| {
            counter.nodes(1);
            x < t
        };
        let right = self.points.partition_point(before) as isize;
        let (mut low, mut high) = (right - k, right);
        if !self.wraps() {
            (low, high) = (low.max(0), high.min(n - k));
        }
        while low < high {
            counter.nodes(1);
            let middle = low + (high - low) / 2;
            if t - self.turned(middle) > self.turned(middle + k) - t {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }

    /// The same as [`Neighbours::distance`], telling `counter` what it takes.
    ///
    /// # Panics
    /// As that.
    pub fn distance_counted<C: Counter>(
        &self,
        target: Point<1>,
        k: usize,
        scratch: &mut Scratch,
        counter: &mut C,
    ) -> f64 {
        check(k, self.count());
        let [t] = self.metric.home(target);
        let first = self.window(t, k, counter);
        let last = self.turned(first + k as isize - 1);
        let radius = (t - self.turned(first)).abs().max((last - t).abs());
        counter.distances(2);
        if self.wraps() {
            self.settle(t, radius, k, scratch)
        } else {
            radius * radius
        }
    }

    /// The points from `from` on, in steps of 1 upwards, that `inside` holds for, which must hold for a beginning of them; at most n.
    fn run(&self, from: isize, step: isize, inside: impl Fn(f64) -> bool) -> isize {
        let (mut low, mut high) = (0, self.points.len() as isize);
        while low < high {
            let middle = low + (high - low) / 2;
            if inside(self.turned(from + step * middle)) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }

    /// On the circle, where the formula of the distance rounds otherwise than a turned coordinate: what is surely nearer than `radius` is counted,
    /// what is about there is measured.
    fn settle(&self, t: f64, radius: f64, k: usize, scratch: &mut Scratch) -> f64 {
        let n = self.points.len() as isize;
        let right = self.points.partition_point(|&x| x < t) as isize;
        let (sure, possible) = (radius - self.slack, radius + self.slack);
        let up = |reach: f64| self.run(right, 1, |x| x - t <= reach);
        let down = |reach: f64| self.run(right - 1, -1, |x| t - x <= reach);
        // nothing within `sure` is met from both sides; what else is counts once
        let (up_sure, down_sure) = (up(sure), down(sure));
        let down_possible = down(possible).min(n - up_sure);
        let up_possible = up(possible).min(n - down_possible);
        scratch.bits.clear();
        let about = (right - down_possible..right - down_sure)
            .chain(right + up_sure..right + up_possible.max(up_sure));
        scratch.bits.extend(about.map(|i| {
            let x = self.points[i.rem_euclid(n) as usize];
            self.metric.squared([t], [x]).to_bits()
        }));
        select(&mut scratch.bits, k - (up_sure + down_sure) as usize)
    }
}

impl Neighbours<1> for Sorted {
    fn name(&self) -> &'static str {
        "sorted"
    }

    fn count(&self) -> usize {
        self.points.len()
    }

    fn metric(&self) -> &Metric<1> {
        &self.metric
    }

    fn distance(&self, target: Point<1>, k: usize, scratch: &mut Scratch) -> f64 {
        self.distance_counted(target, k, scratch, &mut ())
    }

    fn within(&self, target: Point<1>, squared: f64, show: &mut dyn FnMut(usize, f64)) {
        let n = self.points.len() as isize;
        let [t] = self.metric.home(target);
        // squares below the least normal number have lost digits
        let reach = (squared.sqrt() * (1.0 + 4.0 * f64::EPSILON)).max(1e-153) + self.slack;
        let right = self.points.partition_point(|&x| x < t) as isize;
        let (up, down) = if self.wraps() {
            let down = self.run(right - 1, -1, |x| t - x <= reach);
            (self.run(right, 1, |x| x - t <= reach).min(n - down), down)
        } else {
            let first = self.points.partition_point(|&x| t - x > reach) as isize;
            let end = self.points.partition_point(|&x| x - t <= reach) as isize;
            (end - right, right - first)
        };
        for i in right - down..right + up {
            let i = i.rem_euclid(n) as usize;
            let d = self.metric.squared([t], [self.points[i]]);
            if d <= squared {
                show(self.numbers[i] as usize, d);
            }
        }
    }
}
