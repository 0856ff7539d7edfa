//! A few flat pieces, all tried, by as many rays at once as a register has lanes.
//!
//! Rectangles are tried in [their own coordinates](super::rectangles); what is left, triangles and slanting parallelograms, by the plane and two dual edges as
//! in [`facets`](super::facets), whose rows are facets where those here are rays. A single ray is a register of one lane: every operation is the same and
//! correctly rounded, so that a ray meets the same thing at the same distance, to the last bit, alone or among others, on any machine.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::Found;
use super::beam::{Beam, Nearest};
use super::facets::REACH;
use super::rays::Rays;
use super::rectangles::Rectangles;
use crate::light::scene::Facet;
use crate::light::vector::{Ray, Vector};
use pulp::{Scalar, Simd};

/// A linear form n·p + c of a place p.
#[derive(Clone, Copy, Debug)]
struct Form([f64; 4]);

impl Form {
    fn new(slope: Vector, origin: Vector) -> Self {
        Self([slope.x, slope.y, slope.z, -slope.dot(&origin)])
    }

    #[inline(always)]
    fn along<S: Simd>(&self, simd: S, v: &[S::f64s; 3]) -> S::f64s {
        let x = simd.mul_f64s(simd.splat_f64s(self.0[0]), v[0]);
        let xy = simd.mul_add_f64s(simd.splat_f64s(self.0[1]), v[1], x);
        simd.mul_add_f64s(simd.splat_f64s(self.0[2]), v[2], xy)
    }

    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, p: &[S::f64s; 3]) -> S::f64s {
        let x = simd.mul_add_f64s(simd.splat_f64s(self.0[0]), p[0], simd.splat_f64s(self.0[3]));
        let xy = simd.mul_add_f64s(simd.splat_f64s(self.0[1]), p[1], x);
        simd.mul_add_f64s(simd.splat_f64s(self.0[2]), p[2], xy)
    }
}

/// A facet that is no rectangle.
#[derive(Clone, Copy, Debug)]
struct Oblique {
    above: Form,
    below: Form,
    first: Form,
    second: Form,
    /// 1 for a triangle, 0 for a parallelogram: s + k t ≤ 1 and t + k s ≤ 1.
    share: f64,
    number: f64,
}

impl Oblique {
    fn new(number: u32, facet: &Facet) -> Self {
        let normal = facet.first.cross(&facet.second);
        let square = normal.norm_squared();
        let form = |slope: Vector| Form::new(slope, facet.origin);
        Self {
            above: form(normal / square.sqrt()),
            below: form(-normal / square.sqrt()),
            first: form(facet.second.cross(&normal) / square),
            second: form(normal.cross(&facet.first) / square),
            share: f64::from(u8::from(facet.triangle)),
            number: f64::from(number),
        }
    }

    #[inline(always)]
    fn nearest<S: Simd>(&self, simd: S, beam: &Beam<S>, best: &mut Nearest<S>) {
        let low = simd.splat_f64s(-REACH);
        let high = simd.splat_f64s(1.0 + REACH);
        let below = self.below.at(simd, &beam.origin);
        // a minus would be a call
        let across = self.above.along(simd, &beam.direction);
        let distance = simd.div_f64s(below, across);
        let (o, d) = (&beam.origin, &beam.direction);
        let place = [
            simd.mul_add_f64s(distance, d[0], o[0]),
            simd.mul_add_f64s(distance, d[1], o[1]),
            simd.mul_add_f64s(distance, d[2], o[2]),
        ];
        let (s, t) = (self.first.at(simd, &place), self.second.at(simd, &place));
        let share = simd.splat_f64s(self.share);
        let least = simd.and_m64s(
            simd.greater_than_or_equal_f64s(s, low),
            simd.greater_than_or_equal_f64s(t, low),
        );
        let most = simd.and_m64s(
            simd.less_than_or_equal_f64s(simd.mul_add_f64s(share, t, s), high),
            simd.less_than_or_equal_f64s(simd.mul_add_f64s(share, s, t), high),
        );
        let met = simd.and_m64s(least, most);
        best.take::<true>(simd, met, distance, simd.splat_f64s(self.number), beam);
    }
}

/// All facets of a scene.
#[derive(Debug)]
pub(super) struct Few {
    rectangles: Vec<Rectangles>,
    oblique: Vec<Oblique>,
}

impl Few {
    pub(super) fn new(facets: &[Facet]) -> Self {
        let mut rectangles = Vec::new();
        let mut oblique = Vec::new();
        for (number, facet) in (0..).zip(facets) {
            if !Rectangles::add(&mut rectangles, number, facet) {
                oblique.push(Oblique::new(number, facet));
            }
        }
        Self {
            rectangles,
            oblique,
        }
    }

    #[inline(always)]
    fn of<S: Simd>(&self, simd: S, beam: &Beam<S>, limit: f64) -> Nearest<S> {
        let mut best = Nearest::before(simd, limit);
        // the first are in the order of their numbers, and mostly there are no others
        if let Some((first, others)) = self.rectangles.split_first() {
            first.nearest::<S, false>(simd, beam, &mut best);
            for rectangles in others {
                rectangles.nearest::<S, true>(simd, beam, &mut best);
            }
        }
        for oblique in &self.oblique {
            oblique.nearest(simd, beam, &mut best);
        }
        best
    }

    /// Of one ray.
    #[inline(always)]
    pub(super) fn nearest(&self, ray: &Ray, limit: f64) -> Option<Found> {
        self.of(Scalar, &Beam::one(ray), limit).found()
    }

    /// Of the first `count` of many.
    #[inline(always)]
    pub(super) fn nearest_of<S: Simd>(&self, simd: S, rays: &mut Rays, count: usize) {
        let rows = |row| S::as_simd_f64s(row).0;
        let [ox, oy, oz] = [
            rows(&rays.origin[0]),
            rows(&rays.origin[1]),
            rows(&rays.origin[2]),
        ];
        let [dx, dy, dz] = [
            rows(&rays.direction[0]),
            rows(&rays.direction[1]),
            rows(&rays.direction[2]),
        ];
        let leaving = rows(&rays.leaving);
        let distance = S::as_mut_simd_f64s(&mut rays.distance).0;
        let number = S::as_mut_simd_f64s(&mut rays.number).0;
        for at in 0..count.div_ceil(S::F64_LANES) {
            let beam = Beam {
                origin: [ox[at], oy[at], oz[at]],
                direction: [dx[at], dy[at], dz[at]],
                leaving: leaving[at],
            };
            let best = self.of(simd, &beam, f64::INFINITY);
            distance[at] = best.distance;
            number[at] = best.number;
        }
    }
}
