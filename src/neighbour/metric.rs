//! How far apart two places are, and how large a ball is, where axes may wrap round.

use crate::space::{Domain, Point, Side};
use std::f64::consts::PI;

/// Distance on a domain: Euclidean, where a periodic axis is a circle.
///
/// All ways of finding neighbours use the one formula of [`Metric::squared`], so that they agree to the last bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric<const D: usize> {
    low: Point<D>,
    /// The length of each axis that wraps round; infinite for one that does not.
    periods: [f64; D],
}

impl<const D: usize> Metric<D> {
    /// The distance that belongs to `domain`.
    pub fn new(domain: &Domain<D>) -> Self {
        let mut periods = [f64::INFINITY; D];
        for axis in 0..D {
            if domain.sides()[axis][0] == Side::Periodic {
                periods[axis] = domain.high()[axis] - domain.low()[axis];
            }
        }
        Self {
            low: domain.low(),
            periods,
        }
    }

    /// The lower corner of the domain.
    pub(super) fn low(&self) -> Point<D> {
        self.low
    }

    /// The length of `axis` if it wraps round, infinity if not.
    pub fn period(&self, axis: usize) -> f64 {
        self.periods[axis]
    }

    /// Whether any axis wraps round.
    pub fn wraps(&self) -> bool {
        self.periods.iter().any(|period| period.is_finite())
    }

    /// Whether every axis wraps round.
    pub fn round(&self) -> bool {
        self.periods.iter().all(|period| period.is_finite())
    }

    /// The longest way across the domain where every axis wraps round, without taking the shorter way.
    pub fn diagonal(&self) -> f64 {
        self.periods
            .iter()
            .map(|period| period * period)
            .sum::<f64>()
            .sqrt()
    }

    /// The place in the domain that `x` is on an axis that wraps round; `x` itself on the others.
    pub fn home(&self, mut x: Point<D>) -> Point<D> {
        for axis in 0..D {
            let (low, period) = (self.low[axis], self.periods[axis]);
            if period.is_finite() && !(low..=low + period).contains(&x[axis]) {
                x[axis] = low + (x[axis] - low).rem_euclid(period);
            }
        }
        x
    }

    /// The squared distance between two places of the domain. Zero also where it is below 1e-162, infinite where it is beyond 1e154.
    #[inline]
    pub fn squared(&self, a: Point<D>, b: Point<D>) -> f64 {
        let mut sum = 0.0;
        for axis in 0..D {
            let d = (a[axis] - b[axis]).abs();
            // an infinite period leaves d as it is: `min` ignores the NaN of ∞ - ∞
            let d = d.min(self.periods[axis] - d);
            sum += d * d;
        }
        sum
    }

    /// The length or area of all places no farther than `radius` from one of them. On an axis that wraps round the ball meets itself
    /// when the radius is above half the period, and each place counts once.
    ///
    /// On the line and in the plane; in more dimensions it does not compile.
    pub fn ball(&self, radius: f64) -> f64 {
        const { assert!(D == 1 || D == 2, "balls on the line and in the plane") };
        if D == 1 {
            (2.0 * radius).min(self.periods[0])
        } else {
            disc_in_box(radius, 0.5 * self.periods[0], 0.5 * self.periods[D - 1])
        }
    }
}

/// The area of the part of a disc about the centre of a box with half sides `a` and `b` that lies in the box.
fn disc_in_box(r: f64, a: f64, b: f64) -> f64 {
    if r <= a.min(b) {
        return PI * r * r;
    }
    if r.hypot(0.0) >= a.hypot(b) {
        return 4.0 * a * b;
    }
    // a quarter: ∫ min(b, √(r² - x²)) dx from 0 to min(a, r)
    let flat = if r > b { (r * r - b * b).sqrt() } else { 0.0 };
    let end = a.min(r);
    let segment = |x: f64| 0.5 * (x * (r * r - x * x).max(0.0).sqrt() + r * r * (x / r).asin());
    let under_the_lid = if flat > 0.0 { b * flat } else { 0.0 };
    4.0 * (under_the_lid + segment(end) - segment(flat))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn torus(low: [f64; 2], high: [f64; 2]) -> Metric<2> {
        Metric::new(&Domain::new(low, high, [[Side::Periodic; 2]; 2]).expect("legal"))
    }

    #[test]
    fn the_way_round_counts() {
        let metric = torus([0.0, 10.0], [1.0, 14.0]);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-15;
        assert!(close(metric.squared([0.1, 10.5], [0.9, 13.5]), 0.04 + 1.0));
        assert!(close(metric.squared([0.0, 10.0], [1.0, 14.0]), 0.0));
        assert_eq!(
            metric.home([-0.25, 19.0]).map(f64::to_bits),
            [0.75, 11.0].map(f64::to_bits)
        );
        let line = Metric::new(&Domain::<1>::whole());
        assert!(close(line.squared([-1.0], [2.0]), 9.0));
        assert!(line.squared([f64::MAX], [f64::MIN]).is_infinite());
    }

    /// Against counting cells of a fine grid.
    #[test]
    fn a_ball_that_meets_itself_counts_each_place_once() {
        let metric = torus([0.0; 2], [1.0, 0.5]);
        let cells = 1000;
        for radius in [0.1, 0.25, 0.3, 0.5, 0.52, 0.559, 0.6, 3.0] {
            let inside = (0..cells * cells)
                .filter(|i| {
                    let x = (f64::from(i / cells) + 0.5) / f64::from(cells);
                    let y = 0.5 * (f64::from(i % cells) + 0.5) / f64::from(cells);
                    metric.squared([0.3, 0.1], [x, y]) <= radius * radius
                })
                .count();
            let counted = 0.5 * inside as f64 / f64::from(cells * cells);
            let area = metric.ball(radius);
            assert!((area - counted).abs() < 1e-4, "{radius}: {area} {counted}");
        }
        let tube = Metric::new(
            &Domain::new(
                [0.0, f64::NEG_INFINITY],
                [1.0, f64::INFINITY],
                [[Side::Periodic; 2], [Side::Open; 2]],
            )
            .expect("legal"),
        );
        // far beyond the circumference the ball is two lengths of tube
        assert!((tube.ball(50.0) / 100.0 - 1.0).abs() < 1e-4);
        assert!((tube.ball(0.4) - PI * 0.16).abs() < 1e-15);
    }
}
