//! The nested estimates at one place.

use crate::neighbour::{Metric, Nearest, Neighbours};
use crate::sample::{Sample, Weights};
use crate::space::Point;
use crate::theory::Convention;

/// The estimates from the k nearest points of one place, for every k in a range, computed when they are asked for.
///
/// Points are gathered as far as a rule said that it would look at first; where it looks further, all that it may ask for are. Values do not depend on that.
///
/// Always true: `least` ≤ `most`, and every rung from `least` to `most` has a ball of positive size; rungs below may not.
pub struct Ladder<'a, const D: usize> {
    nearest: &'a mut Nearest,
    finder: &'a dyn Neighbours<D>,
    target: Point<D>,
    metric: &'a Metric<D>,
    channels: &'a [Sample<D>],
    /// For each channel, the mass in all buckets before each; empty for equal weights.
    before: Vec<Vec<f64>>,
    convention: Convention,
    least: usize,
    most: usize,
}

impl<'a, const D: usize> Ladder<'a, D> {
    /// The ladder about `target` over what was gathered there already, with the rungs from `min` to `max` as far as they exist. `here` points are at the place itself, not all that there are.
    pub(super) fn new(
        nearest: &'a mut Nearest,
        (finder, target): (&'a dyn Neighbours<D>, Point<D>),
        channels: &'a [Sample<D>],
        convention: Convention,
        (min, max): (usize, usize),
        here: usize,
    ) -> Self {
        // the last point has no next for the mean radius; rungs end before it in every convention, so that conventions compare
        let end = (finder.count() - 1).max(here + 1);
        let most = max.max(here + 1).min(end);
        let least = min.max(here + 1).min(most);
        let mut ladder = Self {
            nearest,
            finder,
            target,
            metric: finder.metric(),
            channels,
            before: Vec::new(),
            convention,
            least,
            most,
        };
        ladder.reach(least);
        ladder.sum();
        ladder
    }

    /// Sees to it that the `k`-th point and the next are known.
    fn reach(&mut self, k: usize) {
        let all = self.finder.count();
        if self.nearest.len() < (k + 1).min(all) {
            let most = (self.most.max(k) + 1).min(all);
            self.nearest.gather(self.finder, self.target, most);
            self.sum();
        }
    }

    fn sum(&mut self) {
        let channels = self.channels.iter();
        self.before = channels
            .map(|channel| prefixes(self.nearest, channel))
            .collect();
    }

    /// The fewest neighbours that may be taken.
    pub fn least(&self) -> usize {
        self.least
    }

    /// The most.
    pub fn most(&self) -> usize {
        self.most
    }

    /// How many values a rung has.
    pub fn channels(&self) -> usize {
        self.channels.len()
    }

    /// Whether the place is so far from the data that distances overflow.
    pub(super) fn is_endless(&mut self) -> bool {
        !self.squared(self.least).is_finite()
    }

    /// The size of the ball out to the `k`-th neighbour.
    pub fn volume(&mut self, k: usize) -> f64 {
        self.metric.ball(self.squared(k).sqrt())
    }

    /// The squared distance of the `k`-th point.
    fn squared(&mut self, k: usize) -> f64 {
        self.reach(k);
        self.nearest.squared(k)
    }

    /// The estimate in one channel from the `k` nearest points, 1 ≤ k ≤ `most`; infinite where their ball has no size.
    pub fn estimate(&mut self, channel: usize, k: usize) -> f64 {
        let radius = self.radius(k);
        let mass = mass(
            self.nearest,
            &self.channels[channel],
            &self.before[channel],
            k,
        );
        share(self.convention, k) * mass / self.metric.ball(radius)
    }

    /// The estimates in one channel from the 1, 2, ..., `k` nearest points, at `put`. O(k).
    pub fn each_up_to(&mut self, channel: usize, k: usize, mut put: impl FnMut(usize, f64)) {
        if let Weights::Equal(each) = *self.channels[channel].weights() {
            self.reach(k);
            let known = self.nearest.len();
            let (convention, metric) = (self.convention, self.metric);
            let mut radii = self
                .nearest
                .first((k + 1).min(known))
                .map(|(squared, _)| squared.sqrt());
            let mut radius = radii.next().unwrap_or(0.0);
            for j in 1..=k {
                let next = radii.next().unwrap_or(radius);
                let used = used(convention, radius, next);
                let mass = j as f64 * each;
                put(j, share(convention, j) * mass / metric.ball(used));
                radius = next;
            }
            return;
        }
        for j in 1..=k {
            put(j, self.estimate(channel, j));
        }
    }

    /// The number of equally heavy points that would tell as much as the `k` nearest do, over all channels: (Σw)²/Σw².
    pub fn effective(&mut self, k: usize) -> f64 {
        if let [one] = self.channels
            && let Weights::Equal(_) = one.weights()
        {
            return k as f64;
        }
        self.reach(k);
        let channels = self.channels;
        let (mut sum, mut squares) = (0.0, 0.0);
        for (_, number) in self.nearest.first(k) {
            let weight: f64 = channels.iter().map(|c| c.weight(number as usize)).sum();
            sum += weight;
            squares += weight * weight;
        }
        if squares > 0.0 {
            sum * sum / squares
        } else {
            k as f64
        }
    }

    /// The estimate of something else with the same points, from the `k` nearest of them, and the radius of the ball.
    pub(super) fn show(&mut self, shown: &Sample<D>, k: usize) -> (f64, f64) {
        let radius = self.radius(k);
        let before = prefixes(self.nearest, shown);
        let mass = mass(self.nearest, shown, &before, k);
        (
            share(self.convention, k) * mass / self.metric.ball(radius),
            radius,
        )
    }

    /// The radius of the ball that is divided by.
    fn radius(&mut self, k: usize) -> f64 {
        let radius = self.squared(k).sqrt();
        let next = self.next(k, radius);
        used(self.convention, radius, next)
    }

    fn next(&mut self, k: usize, radius: f64) -> f64 {
        if k < self.finder.count() {
            self.nearest.squared(k + 1).sqrt()
        } else {
            radius
        }
    }
}

/// The share of the mass that counts.
fn share(convention: Convention, k: usize) -> f64 {
    match convention {
        Convention::Unbiased => (k as f64 - 1.0) / k as f64,
        Convention::Raw | Convention::MeanRadius => 1.0,
    }
}

/// The radius that is divided by, of those of a neighbour and of the next.
fn used(convention: Convention, radius: f64, next: f64) -> f64 {
    match convention {
        Convention::MeanRadius => 0.5 * (radius + next),
        Convention::Raw | Convention::Unbiased => radius,
    }
}

/// The mass in all buckets before each. Points are added bucket by bucket in order of distance, so the bits do not depend on how they were found.
fn prefixes<const D: usize>(nearest: &mut Nearest, sample: &Sample<D>) -> Vec<f64> {
    if let Weights::Equal(_) = sample.weights() {
        return Vec::new();
    }
    let mut sum = 0.0;
    (0..nearest.buckets())
        .map(|bucket| {
            let before = sum;
            for &(_, number) in nearest.bucket(bucket) {
                sum += sample.weight(number as usize);
            }
            before
        })
        .collect()
}

/// The mass of the `k` nearest points. Of those that are equally far it is not said which is which, so each gives the same share.
fn mass<const D: usize>(
    nearest: &mut Nearest,
    sample: &Sample<D>,
    before: &[f64],
    k: usize,
) -> f64 {
    if let Weights::Equal(each) = sample.weights() {
        return k as f64 * each;
    }
    let (bucket, earlier) = nearest.place(k);
    let inside = nearest.bucket(bucket);
    let edge = inside[k - 1 - earlier].0;
    let (mut sum, mut tied, mut tied_mass, mut nearer) = (before[bucket], 0usize, 0.0, earlier);
    for &(squared, number) in inside {
        let weight = sample.weight(number as usize);
        if squared < edge {
            nearer += 1;
            sum += weight;
        } else if squared > edge {
            break;
        } else {
            tied += 1;
            tied_mass += weight;
        }
    }
    ((k - nearer) as f64 / tied as f64).mul_add(tied_mass, sum)
}
