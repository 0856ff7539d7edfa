//! The two ramps on the unit interval: one end a jump of height 2, the other a kink at height 0.

use super::{Builder, Density, Entry, Univariate};
use crate::random::{Stream, open_unit};
use crate::space::{Domain, Field, Point};
use std::sync::Arc;

/// Which way a ramp leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// f = 2x.
    Up,
    /// f = 2(1 - x).
    Down,
}

/// f = 2x or 2(1 - x) on \[0, 1\].
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    direction: Direction,
    domain: Domain<1>,
}

impl Ramp {
    /// The ramp that leads that way.
    pub fn new(direction: Direction) -> Self {
        Self {
            direction,
            domain: Domain::unit(),
        }
    }
}

impl Field<1> for Ramp {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        match self.direction {
            _ if !self.domain.contains([x]) => 0.0,
            Direction::Up => 2.0 * x,
            Direction::Down => 2.0 * (1.0 - x),
        }
    }
}

impl Density<1> for Ramp {
    /// One random word a draw.
    fn draw(&self, random: &mut Stream) -> Point<1> {
        [self.quantile(open_unit(random))]
    }

    fn probability(&self, [low]: Point<1>, [high]: Point<1>) -> f64 {
        let (a, b) = (low.clamp(0.0, 1.0), high.clamp(0.0, 1.0));
        let sum = match self.direction {
            Direction::Up => a + b,
            Direction::Down => (1.0 - a) + (1.0 - b),
        };
        (b - a) * sum
    }

    fn breaks(&self, _axis: usize) -> Vec<f64> {
        vec![0.0, 1.0]
    }

    fn finest_scale(&self, _axis: usize) -> f64 {
        1.0
    }

    fn bulk(&self, _tail: f64) -> (Point<1>, Point<1>) {
        ([0.0], [1.0])
    }

    fn univariate(&self) -> Option<&dyn Univariate> {
        Some(self)
    }
}

impl Univariate for Ramp {
    fn distribution(&self, x: f64) -> f64 {
        let t = x.clamp(0.0, 1.0);
        match self.direction {
            Direction::Up => t * t,
            Direction::Down => t * (2.0 - t),
        }
    }

    fn quantile(&self, p: f64) -> f64 {
        match self.direction {
            _ if !(0.0..=1.0).contains(&p) => f64::NAN,
            Direction::Up => p.sqrt(),
            // 1 - √(1 - p) without its cancellation
            Direction::Down => p / (1.0 + (1.0 - p).sqrt()),
        }
    }

    fn derivative(&self, order: u32, x: f64) -> f64 {
        match self.direction {
            _ if order != 1 || !self.domain.contains([x]) => 0.0,
            Direction::Up => 2.0,
            Direction::Down => -2.0,
        }
    }

    fn roughness(&self, order: u32) -> f64 {
        if order == 0 { 4.0 / 3.0 } else { f64::INFINITY }
    }

    fn mean_and_deviation(&self) -> (f64, f64) {
        let mean = match self.direction {
            Direction::Up => 2.0 / 3.0,
            Direction::Down => 1.0 / 3.0,
        };
        (mean, (1.0 / 18.0_f64).sqrt())
    }
}

pub(super) const ENTRIES: &[Entry] = &[
    Entry {
        names: &["ramp-up"],
        summary: "2x on the unit interval: rises to a wall",
        reference: "Jones 1993, Simple boundary correction, Statistics and Computing 3",
        parameters: &[],
        build: Builder::Line(|_| Ok(Arc::new(Ramp::new(Direction::Up)))),
    },
    Entry {
        names: &["ramp-down"],
        summary: "2(1 - x) on the unit interval: falls from a wall",
        reference: "Jones 1993, Simple boundary correction, Statistics and Computing 3",
        parameters: &[],
        build: Builder::Line(|_| Ok(Arc::new(Ramp::new(Direction::Down)))),
    },
];
