//! Rays in registers, a ray a lane.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::Found;
use crate::light::vector::Ray;
use pulp::{Scalar, Simd};

/// As many rays as a register has lanes.
pub(super) struct Beam<S: Simd> {
    pub(super) origin: [S::f64s; 3],
    pub(super) direction: [S::f64s; 3],
    /// The number of the primitive that they leave; −1: none.
    pub(super) leaving: S::f64s,
}

impl Beam<Scalar> {
    /// One.
    #[inline(always)]
    pub(super) fn one(ray: &Ray) -> Self {
        Self {
            origin: [ray.origin.x, ray.origin.y, ray.origin.z],
            direction: [ray.direction.x, ray.direction.y, ray.direction.z],
            leaving: ray.leaving.map_or(-1.0, f64::from),
        }
    }
}

/// The nearest things so far.
pub(super) struct Nearest<S: Simd> {
    pub(super) distance: S::f64s,
    /// −1: none.
    pub(super) number: S::f64s,
}

impl<S: Simd> Nearest<S> {
    #[inline(always)]
    pub(super) fn before(simd: S, limit: f64) -> Self {
        Self {
            distance: simd.splat_f64s(limit),
            number: simd.splat_f64s(-1.0),
        }
    }

    /// Takes what is `met` at a distance where that lies ahead, is nearer than what was found, and is not what the ray leaves. Of things in one place the first is taken: those that do not come
    /// in the order of their numbers must say so by `TIES`.
    #[inline(always)]
    pub(super) fn take<const TIES: bool>(
        &mut self,
        simd: S,
        met: S::m64s,
        distance: S::f64s,
        number: S::f64s,
        beam: &Beam<S>,
    ) {
        let ahead = simd.greater_than_f64s(distance, simd.splat_f64s(0.0));
        let mut nearer = simd.less_than_f64s(distance, self.distance);
        if TIES {
            let tie = simd.and_m64s(
                simd.equal_f64s(distance, self.distance),
                simd.less_than_f64s(number, self.number),
            );
            nearer = simd.or_m64s(nearer, tie);
        }
        // `not_m64s` would be a call
        let other = simd.or_m64s(
            simd.less_than_f64s(number, beam.leaving),
            simd.greater_than_f64s(number, beam.leaving),
        );
        let take = simd.and_m64s(simd.and_m64s(met, ahead), simd.and_m64s(nearer, other));
        self.distance = simd.select_f64s(take, distance, self.distance);
        self.number = simd.select_f64s(take, number, self.number);
    }
}

impl Nearest<Scalar> {
    #[inline(always)]
    pub(super) fn found(&self) -> Option<Found> {
        (self.number >= 0.0).then_some(Found {
            primitive: self.number as u32,
            distance: self.distance,
        })
    }
}
