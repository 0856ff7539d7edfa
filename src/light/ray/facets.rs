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
const REACH: f64 = 1e-12;

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

/// A ray in registers, each number in all lanes.
pub(super) struct Beam<S: Simd> {
    origin: [S::f64s; 3],
    direction: [S::f64s; 3],
    leaving: S::f64s,
}

impl<S: Simd> Beam<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, ray: &Ray) -> Self {
        let three = |v: Vector| [v.x, v.y, v.z].map(|x| simd.splat_f64s(x));
        Self {
            origin: three(ray.origin),
            direction: three(ray.direction),
            // padding has number −1, so nothing is left out twice
            leaving: simd.splat_f64s(ray.leaving.map_or(-1.0, f64::from)),
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
    pub(super) fn try_group(&mut self, simd: S, beam: &Beam<S>, group: &Group) {
        let row = |numbers: &[f64; LANES], at: usize| S::as_simd_f64s(numbers).0[at];
        let along = |form: &Form, v: &[S::f64s; 3], at: usize| {
            let x = simd.mul_f64s(row(&form.slope[0], at), v[0]);
            let xy = simd.mul_add_e_f64s(row(&form.slope[1], at), v[1], x);
            simd.mul_add_e_f64s(row(&form.slope[2], at), v[2], xy)
        };
        let place = |form: &Form, at: usize| {
            let o = &beam.origin;
            let x = simd.mul_add_e_f64s(row(&form.slope[0], at), o[0], row(&form.offset, at));
            let xy = simd.mul_add_e_f64s(row(&form.slope[1], at), o[1], x);
            simd.mul_add_e_f64s(row(&form.slope[2], at), o[2], xy)
        };
        let zero = simd.splat_f64s(0.0);
        let low = simd.splat_f64s(-REACH);
        let high = simd.splat_f64s(1.0 + REACH);
        for at in 0..LANES / S::F64_LANES {
            let across = along(&group.above, &beam.direction, at);
            // −above · sign(across): positive where the plane lies ahead
            let sign = simd.greater_than_f64s(across, zero);
            let above = place(&group.above, at);
            let ahead = simd.select_f64s(sign, simd.neg_f64s(above), above);
            let across = simd.abs_f64s(across);
            let coordinate = |form: &Form| {
                simd.mul_add_e_f64s(
                    ahead,
                    along(form, &beam.direction, at),
                    simd.mul_f64s(place(form, at), across),
                )
            };
            let (s, t) = (coordinate(&group.first), coordinate(&group.second));
            let share = row(&group.share, at);
            let (least, most) = (simd.mul_f64s(low, across), simd.mul_f64s(high, across));
            let number = row(&group.number, at);
            let inside = [
                simd.greater_than_f64s(ahead, zero),
                simd.greater_than_or_equal_f64s(s, least),
                simd.greater_than_or_equal_f64s(t, least),
                simd.less_than_or_equal_f64s(simd.mul_add_e_f64s(share, t, s), most),
                simd.less_than_or_equal_f64s(simd.mul_add_e_f64s(share, s, t), most),
                simd.less_than_f64s(
                    simd.mul_f64s(ahead, self.across),
                    simd.mul_f64s(self.above, across),
                ),
                simd.not_m64s(simd.equal_f64s(number, beam.leaving)),
            ];
            let nearer = inside
                .into_iter()
                .reduce(|a, b| simd.and_m64s(a, b))
                .expect("seven conditions");
            self.above = simd.select_f64s(nearer, ahead, self.above);
            self.across = simd.select_f64s(nearer, across, self.across);
            self.number = simd.select_f64s(nearer, number, self.number);
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
            let nearer = spread[1][lane] >= 0.0 && spread[0][lane] < distance;
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
        let beam = Beam::new(simd, ray);
        let mut best = Best::new(simd, limit);
        for group in &self.groups {
            best.try_group(simd, &beam, group);
        }
        best.found(simd)
    }
}
