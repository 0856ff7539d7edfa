//! Rectangles whose edges run along the same three directions, such as the walls of a room or the sides of a box.
//!
//! In coordinates along these directions such a rectangle is a part of the plane x_k = level. A ray is turned into the coordinates once, costs one division
//! for each k, and then meets each rectangle at λ = (level − o_k)/d_k, where two numbers o_i + λ d_i are compared with the rectangle's middle and half edges.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::beam::{Beam, Nearest};
use super::facets::REACH;
use crate::light::scene::Facet;
use crate::light::vector::Vector;
use pulp::Simd;

/// Directions of length 1 that differ by no more are the same: less than what [`REACH`] bridges.
const SAME: f64 = 1e-14;

/// A part of a plane x_k = level.
#[derive(Clone, Copy, Debug)]
struct Rectangle {
    level: f64,
    /// Along the next two directions.
    middle: [f64; 2],
    /// The squares of half the edges.
    square: [f64; 2],
    number: f64,
}

/// Rectangles along three perpendicular directions.
#[derive(Clone, Debug)]
pub(super) struct Rectangles {
    axes: [Vector; 3],
    /// By the direction k to which they are perpendicular.
    across: [Vec<Rectangle>; 3],
}

impl Rectangles {
    /// Adds the facet to those of its directions; `false` if it is no rectangle.
    pub(super) fn add(all: &mut Vec<Self>, number: u32, facet: &Facet) -> bool {
        let (first, second) = (facet.first.normalize(), facet.second.normalize());
        if facet.triangle || first.dot(&second).abs() > SAME {
            return false;
        }
        let wanted = [first, second, first.cross(&second)];
        let places = |axes: &[Vector; 3]| {
            let along = |a: &Vector| {
                (0..3).find(|&k| (a - axes[k]).norm() <= SAME || (a + axes[k]).norm() <= SAME)
            };
            Some([along(&wanted[0])?, along(&wanted[1])?, along(&wanted[2])?])
        };
        let known = all.iter().position(|one| places(&one.axes).is_some());
        let at = known.unwrap_or_else(|| {
            all.push(Self {
                axes: wanted,
                across: [const { Vec::new() }; 3],
            });
            all.len() - 1
        });
        let one = &mut all[at];
        let k = places(&one.axes).map_or(2, |places| places[2]);
        let middle = facet.origin + 0.5 * (facet.first + facet.second);
        let next = [one.axes[(k + 1) % 3], one.axes[(k + 2) % 3]];
        one.across[k].push(Rectangle {
            level: one.axes[k].dot(&middle),
            middle: next.map(|axis| axis.dot(&middle)),
            square: next.map(|axis| {
                let edges = axis.dot(&facet.first).abs() + axis.dot(&facet.second).abs();
                (0.5 * edges * (1.0 + 2.0 * REACH)).powi(2)
            }),
            number: f64::from(number),
        });
        true
    }

    /// Tries all of them.
    #[inline(always)]
    pub(super) fn nearest<S: Simd, const TIES: bool>(
        &self,
        simd: S,
        beam: &Beam<S>,
        best: &mut Nearest<S>,
    ) {
        let turned = Beam {
            origin: self.turned(simd, &beam.origin),
            direction: self.turned(simd, &beam.direction),
            leaving: beam.leaving,
        };
        across::<S, 0, TIES>(simd, &self.across[0], &turned, best);
        across::<S, 1, TIES>(simd, &self.across[1], &turned, best);
        across::<S, 2, TIES>(simd, &self.across[2], &turned, best);
    }

    #[inline(always)]
    fn turned<S: Simd>(&self, simd: S, v: &[S::f64s; 3]) -> [S::f64s; 3] {
        let mut turned = [v[0]; 3];
        let mut k = 0;
        while k < 3 {
            let axis = &self.axes[k];
            let x = simd.mul_f64s(simd.splat_f64s(axis.x), v[0]);
            let xy = simd.mul_add_f64s(simd.splat_f64s(axis.y), v[1], x);
            turned[k] = simd.mul_add_f64s(simd.splat_f64s(axis.z), v[2], xy);
            k += 1;
        }
        turned
    }
}

/// Those across direction K. Along a plane λ is infinite or no number, and nothing is met.
#[inline(always)]
fn across<S: Simd, const K: usize, const TIES: bool>(
    simd: S,
    rectangles: &[Rectangle],
    beam: &Beam<S>,
    best: &mut Nearest<S>,
) {
    if rectangles.is_empty() {
        return;
    }
    let (i, j) = ((K + 1) % 3, (K + 2) % 3);
    let (o, d) = (&beam.origin, &beam.direction);
    let reciprocal = simd.div_f64s(simd.splat_f64s(1.0), d[K]);
    for rectangle in rectangles {
        let level = simd.splat_f64s(rectangle.level);
        let distance = simd.mul_f64s(simd.sub_f64s(level, o[K]), reciprocal);
        let [u, v] = [
            simd.splat_f64s(rectangle.middle[0]),
            simd.splat_f64s(rectangle.middle[1]),
        ];
        let u = simd.mul_add_f64s(distance, d[i], simd.sub_f64s(o[i], u));
        let v = simd.mul_add_f64s(distance, d[j], simd.sub_f64s(o[j], v));
        // squares, as absolute values would be calls
        let (width, height) = (
            simd.splat_f64s(rectangle.square[0]),
            simd.splat_f64s(rectangle.square[1]),
        );
        let met = simd.and_m64s(
            simd.less_than_or_equal_f64s(simd.mul_f64s(u, u), width),
            simd.less_than_or_equal_f64s(simd.mul_f64s(v, v), height),
        );
        best.take::<TIES>(simd, met, distance, simd.splat_f64s(rectangle.number), beam);
    }
}
