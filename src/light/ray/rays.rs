//! Many rays, and what they meet, in rows of numbers.

use super::Found;
use crate::light::vector::{Ray, Vector};

/// The most rays that go together: as many as stay in a cache near by, and more than enough to fill every register.
pub const TOGETHER: usize = 512;

/// A number of each ray; a row is a whole number of the widest registers.
pub type Row = [f64; TOGETHER];

/// Rays that go together.
#[derive(Clone, Debug)]
pub struct Rays {
    /// Where they start.
    pub origin: [Row; 3],
    /// Where they go: of length 1.
    pub direction: [Row; 3],
    /// The number of the primitive on which the origin lies, as in [`Ray::leaving`]; −1: none.
    pub leaving: Row,
    /// The number of the primitive that they meet, once that was asked; −1: none.
    pub number: Row,
    /// How far along the ray that is.
    pub distance: Row,
}

impl Default for Rays {
    fn default() -> Self {
        const NONE: Row = [0.0; TOGETHER];
        Self {
            origin: [NONE; 3],
            direction: [NONE; 3],
            leaving: [-1.0; TOGETHER],
            number: [-1.0; TOGETHER],
            distance: NONE,
        }
    }
}

impl Rays {
    /// One of them.
    #[inline]
    pub fn ray(&self, at: usize) -> Ray {
        let leaving = self.leaving[at];
        Ray {
            origin: Vector::new(self.origin[0][at], self.origin[1][at], self.origin[2][at]),
            direction: Vector::new(
                self.direction[0][at],
                self.direction[1][at],
                self.direction[2][at],
            ),
            leaving: (leaving >= 0.0).then_some(leaving as u32),
        }
    }

    /// Puts one in its place.
    #[inline]
    pub fn set(&mut self, at: usize, ray: &Ray) {
        for axis in 0..3 {
            self.origin[axis][at] = ray.origin[axis];
            self.direction[axis][at] = ray.direction[axis];
        }
        self.leaving[at] = ray.leaving.map_or(-1.0, f64::from);
    }

    /// What one of them meets.
    #[inline]
    pub fn found(&self, at: usize) -> Option<Found> {
        let number = self.number[at];
        (number >= 0.0).then_some(Found {
            primitive: number as u32,
            distance: self.distance[at],
        })
    }

    /// Notes what one of them meets.
    #[inline]
    pub fn meet(&mut self, at: usize, found: Option<Found>) {
        self.number[at] = found.map_or(-1.0, |found| f64::from(found.primitive));
        self.distance[at] = found.map_or(f64::INFINITY, |found| found.distance);
    }
}
