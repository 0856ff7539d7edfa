//! Flat pieces, all tried at once.
//!
//! For a facet o + s·a + t·b with unit normal m, the ray p + λ d meets the plane at λ = −m·(p − o) / m·d. With the dual edges
//! A = (b × n)/|n|², B = (n × a)/|n|², n = a × b (A·a = B·b = 1, A·b = B·a = 0) the coordinates there are s = A·(p − o) + λ A·d and t likewise.
//! Everything is compared after multiplication with |m·d|, so that a whole scene costs one division a lane. The numbers of eight facets stand in
//! rows, and a row is a register or a few of them.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::Found;
use crate::light::scene::Facet;
use crate::light::vector::{Ray, Vector};
use pulp::Simd;

/// Facets in a group.
pub(super) const LANES: usize = 8;

/// Facets reach this much, as a share of their edges, beyond them: no ray slips through between two that share an edge.
pub(super) const REACH: f64 = 1e-12;

/// A linear form n·p + c of a place p, for each facet of a group.
#[derive(Clone, Copy, Debug, Default)]
struct Form {
    slope: [[f64; LANES]; 3],
    offset: [f64; LANES],
}

impl Form {
    fn set(&mut self, lane: usize, slope: Vector, origin: Vector) {
        for axis in 0..3 {
            self.slope[axis][lane] = slope[axis];
        }
        self.offset[lane] = -slope.dot(&origin);
    }
}

/// A register of a row. Closures and iterators would not be compiled for wide registers, so these are functions.
#[inline(always)]
fn row<S: Simd>(numbers: &[f64; LANES], at: usize) -> S::f64s {
    S::as_simd_f64s(numbers).0[at]
}

impl Form {
    /// n·v for a direction.
    #[inline(always)]
    fn along<S: Simd>(&self, simd: S, v: &[S::f64s; 3], at: usize) -> S::f64s {
        let x = simd.mul_f64s(row::<S>(&self.slope[0], at), v[0]);
        let xy = simd.mul_add_f64s(row::<S>(&self.slope[1], at), v[1], x);
        simd.mul_add_f64s(row::<S>(&self.slope[2], at), v[2], xy)
    }

    /// n·p + c for a place.
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, p: &[S::f64s; 3], at: usize) -> S::f64s {
        let offset = row::<S>(&self.offset, at);
        let x = simd.mul_add_f64s(row::<S>(&self.slope[0], at), p[0], offset);
        let xy = simd.mul_add_f64s(row::<S>(&self.slope[1], at), p[1], x);
        simd.mul_add_f64s(row::<S>(&self.slope[2], at), p[2], xy)
    }

    /// The form where the ray meets the plane, times `across`.
    #[inline(always)]
    fn met<S: Simd>(
        &self,
        simd: S,
        beam: &Spread<S>,
        ahead: S::f64s,
        across: S::f64s,
        at: usize,
    ) -> S::f64s {
        let start = simd.mul_f64s(self.at(simd, &beam.origin, at), across);
        simd.mul_add_f64s(ahead, self.along(simd, &beam.direction, at), start)
    }
}

/// Up to eight facets; places not taken hold forms that are 0 and are met by no ray.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Group {
    /// The signed distance from the plane.
    above: Form,
    first: Form,
    second: Form,
    /// 1 for a triangle, 0 for a parallelogram: s + k t ≤ 1 and t + k s ≤ 1.
    share: [f64; LANES],
    /// The number of the facet; exact, as there are fewer than 2⁵³.
    number: [f64; LANES],
}

impl Group {
    pub(super) fn new(facets: &[Facet], numbers: &[u32]) -> Self {
        let mut group = Self {
            number: [-1.0; LANES],
            ..Self::default()
        };
        for (lane, &number) in numbers.iter().enumerate() {
            let facet = &facets[number as usize];
            let normal = facet.first.cross(&facet.second);
            let square = normal.norm_squared();
            let dual = [
                facet.second.cross(&normal) / square,
                normal.cross(&facet.first) / square,
            ];
            group.above.set(lane, normal / square.sqrt(), facet.origin);
            group.first.set(lane, dual[0], facet.origin);
            group.second.set(lane, dual[1], facet.origin);
            group.share[lane] = f64::from(u8::from(facet.triangle));
            group.number[lane] = f64::from(number);
        }
        group
    }
}

/// One ray in registers, each number in all lanes.
pub(super) struct Spread<S: Simd> {
    origin: [S::f64s; 3],
    direction: [S::f64s; 3],
    leaving: S::f64s,
}

impl<S: Simd> Spread<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, ray: &Ray) -> Self {
        let (o, d) = (ray.origin, ray.direction);
        Self {
            origin: [
                simd.splat_f64s(o.x),
                simd.splat_f64s(o.y),
                simd.splat_f64s(o.z),
            ],
            direction: [
                simd.splat_f64s(d.x),
                simd.splat_f64s(d.y),
                simd.splat_f64s(d.z),
            ],
            // padding has number −1, so nothing is left out twice
            leaving: simd.splat_f64s(match ray.leaving {
                Some(number) => f64::from(number),
                None => -1.0,
            }),
        }
    }
}

/// The nearest facet so far in each lane, its distance as a fraction.
pub(super) struct Best<S: Simd> {
    above: S::f64s,
    across: S::f64s,
    number: S::f64s,
}

impl<S: Simd> Best<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, limit: f64) -> Self {
        Self {
            above: simd.splat_f64s(limit),
            across: simd.splat_f64s(1.0),
            number: simd.splat_f64s(-1.0),
        }
    }

    /// Tries the facets of a group.
    #[inline(always)]
    pub(super) fn try_group(&mut self, simd: S, beam: &Spread<S>, group: &Group) {
        let zero = simd.splat_f64s(0.0);
        let low = simd.splat_f64s(-REACH);
        let high = simd.splat_f64s(1.0 + REACH);
        let mut at = 0;
        while at < LANES / S::F64_LANES {
            let across = group.above.along(simd, &beam.direction, at);
            // −above · sign(across): positive where the plane lies ahead
            let sign = simd.greater_than_f64s(across, zero);
            let above = group.above.at(simd, &beam.origin, at);
            let ahead = simd.select_f64s(sign, simd.neg_f64s(above), above);
            let across = simd.abs_f64s(across);
            let s = group.first.met(simd, beam, ahead, across, at);
            let t = group.second.met(simd, beam, ahead, across, at);
            let share = row::<S>(&group.share, at);
            let (least, most) = (simd.mul_f64s(low, across), simd.mul_f64s(high, across));
            let number = row::<S>(&group.number, at);
            let mut nearer = simd.greater_than_f64s(ahead, zero);
            nearer = simd.and_m64s(nearer, simd.greater_than_or_equal_f64s(s, least));
            nearer = simd.and_m64s(nearer, simd.greater_than_or_equal_f64s(t, least));
            let sum = simd.mul_add_f64s(share, t, s);
            nearer = simd.and_m64s(nearer, simd.less_than_or_equal_f64s(sum, most));
            let sum = simd.mul_add_f64s(share, s, t);
            nearer = simd.and_m64s(nearer, simd.less_than_or_equal_f64s(sum, most));
            let (here, before) = (
                simd.mul_f64s(ahead, self.across),
                simd.mul_f64s(self.above, across),
            );
            nearer = simd.and_m64s(nearer, simd.less_than_f64s(here, before));
            // not the one it leaves; `not_m64s` would be a call
            let other = simd.or_m64s(
                simd.less_than_f64s(number, beam.leaving),
                simd.greater_than_f64s(number, beam.leaving),
            );
            nearer = simd.and_m64s(nearer, other);
            self.above = simd.select_f64s(nearer, ahead, self.above);
            self.across = simd.select_f64s(nearer, across, self.across);
            self.number = simd.select_f64s(nearer, number, self.number);
            at += 1;
        }
    }

    /// The nearest over the lanes.
    #[inline(always)]
    pub(super) fn found(&self, simd: S) -> Option<Found> {
        let distances = simd.div_f64s(self.above, self.across);
        let (mut distance, mut number) = (f64::INFINITY, -1.0);
        let mut spread = [[0.0; LANES]; 2];
        let lanes = S::F64_LANES;
        S::as_mut_simd_f64s(&mut spread[0]).0[0] = distances;
        S::as_mut_simd_f64s(&mut spread[1]).0[0] = self.number;
        for lane in 0..lanes {
            // of facets in one place the first; lanes are not in the order of numbers
            let tie = spread[0][lane] <= distance && spread[1][lane] < number;
            let nearer = spread[1][lane] >= 0.0 && (spread[0][lane] < distance || tie);
            distance = if nearer { spread[0][lane] } else { distance };
            number = if nearer { spread[1][lane] } else { number };
        }
        (number >= 0.0).then_some(Found {
            primitive: number as u32,
            distance,
        })
    }
}

/// All facets of a scene in groups.
#[derive(Debug)]
pub(super) struct Facets {
    groups: Vec<Group>,
}

impl Facets {
    pub(super) fn new(facets: &[Facet]) -> Self {
        let numbers: Vec<u32> = (0..facets.len() as u32).collect();
        Self {
            groups: numbers
                .chunks(LANES)
                .map(|numbers| Group::new(facets, numbers))
                .collect(),
        }
    }

    #[inline(always)]
    pub(super) fn nearest<S: Simd>(&self, simd: S, ray: &Ray, limit: f64) -> Option<Found> {
        let beam = Spread::new(simd, ray);
        let mut best = Best::new(simd, limit);
        for group in &self.groups {
            best.try_group(simd, &beam, group);
        }
        best.found(simd)
    }
}
