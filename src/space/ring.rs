//! Rings of vertices: what polygons and their parts have in common.
//!
//! # References
//! Shewchuk 1997, Adaptive precision floating-point arithmetic and fast robust geometric predicates (orientation); Sutherland & Hodgman
//! 1974, Reentrant polygon clipping; Green's theorem for the moments.

use super::Point;

pub(super) fn ring_edges(ring: &[Point<2>]) -> impl Iterator<Item = [Point<2>; 2]> + '_ {
    (0..ring.len()).map(|k| [ring[k], ring[(k + 1) % ring.len()]])
}

/// The part of a ring of vertices to the left of the line from `a` to `b`. [Sutherland & Hodgman 1974]
///
/// Of a shape with bays the parts stay joined by edges along the line that are passed in both directions: [`moments`] of the ring are those
/// of the part, but the ring need not be simple. O(vertices).
pub fn clip(ring: &[Point<2>], a: Point<2>, b: Point<2>) -> Vec<Point<2>> {
    let height = |p: Point<2>| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let mut kept = Vec::with_capacity(ring.len() + 2);
    for [p, q] in ring_edges(ring) {
        let (from, to) = (height(p), height(q));
        if from >= 0.0 {
            kept.push(p);
        }
        if (from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0) {
            let t = from / (from - to);
            kept.push([t.mul_add(q[0] - p[0], p[0]), t.mul_add(q[1] - p[1], p[1])]);
        }
    }
    kept
}

/// The part of a ring of vertices in a convex polygon with these corners, counter-clockwise: see [`clip`]. Nothing where there are fewer than three.
pub fn within_convex(ring: &[Point<2>], corners: &[Point<2>]) -> Vec<Point<2>> {
    if corners.len() < 3 {
        return Vec::new();
    }
    ring_edges(corners).fold(ring.to_vec(), |ring, [a, b]| clip(&ring, a, b))
}

/// The same of the box from `low` to `high`.
pub fn clipped_to_box(ring: &[Point<2>], low: Point<2>, high: Point<2>) -> Vec<Point<2>> {
    within_convex(ring, &[low, [high[0], low[1]], high, [low[0], high[1]]])
}

/// ∫1, ∫x and ∫y over the inside of a ring, counter-clockwise positive. By Green's theorem about the first vertex, so that a polygon far from
/// zero loses no digits. Zeros for fewer than three vertices.
pub fn moments(ring: &[Point<2>]) -> [f64; 3] {
    let Some(&[x, y]) = ring.first() else {
        return [0.0; 3];
    };
    let (mut area, mut first) = (0.0, [0.0; 2]);
    for [a, b] in ring_edges(ring) {
        let (p, q) = ([a[0] - x, a[1] - y], [b[0] - x, b[1] - y]);
        let twice = p[0] * q[1] - p[1] * q[0];
        area += twice / 2.0;
        first[0] += twice * (p[0] + q[0]) / 6.0;
        first[1] += twice * (p[1] + q[1]) / 6.0;
    }
    [area, x.mul_add(area, first[0]), y.mul_add(area, first[1])]
}

/// The distance from `x` to the nearest place of the segment.
pub fn distance_to_segment(x: Point<2>, [a, b]: [Point<2>; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let from = [x[0] - a[0], x[1] - a[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let t = if square > 0.0 {
        ((from[0] * along[0] + from[1] * along[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (from[0] - t * along[0]).hypot(from[1] - t * along[1])
}

/// Whether the edges a-b and b-c run over each other.
pub(super) fn folded(a: Point<2>, b: Point<2>, c: Point<2>) -> bool {
    orientation(a, b, c) == 0 && (a[0] - b[0]) * (c[0] - b[0]) + (a[1] - b[1]) * (c[1] - b[1]) > 0.0
}

/// Whether the closed segments a-b and c-d have a point in common.
pub(super) fn meet(a: Point<2>, b: Point<2>, c: Point<2>, d: Point<2>) -> bool {
    let (c_side, d_side) = (orientation(a, b, c), orientation(a, b, d));
    let (a_side, b_side) = (orientation(c, d, a), orientation(c, d, b));
    if c_side * d_side < 0 && a_side * b_side < 0 {
        return true;
    }
    let on = |side: i32, p: Point<2>, q: Point<2>, r: Point<2>| {
        side == 0 && (0..2).all(|k| p[k].min(q[k]) <= r[k] && r[k] <= p[k].max(q[k]))
    };
    on(c_side, a, b, c) || on(d_side, a, b, d) || on(a_side, c, d, a) || on(b_side, c, d, b)
}

/// 1 if a, b, c turn left, -1 if they turn right, 0 if they lie on a line; exact. [Shewchuk 1997, section 4.2]
pub(super) fn orientation(a: Point<2>, b: Point<2>, c: Point<2>) -> i32 {
    let left = (a[0] - c[0]) * (b[1] - c[1]);
    let right = (a[1] - c[1]) * (b[0] - c[0]);
    let determinant = left - right;
    // (3 + 16ε)ε with Shewchuk's ε of half an ulp
    if determinant.abs() > 3.330_669_073_875_472e-16 * (left.abs() + right.abs()) {
        return if determinant > 0.0 { 1 } else { -1 };
    }
    let products = [
        (a[0], b[1]),
        (-a[0], c[1]),
        (-c[0], b[1]),
        (-a[1], b[0]),
        (a[1], c[0]),
        (c[1], b[0]),
    ];
    // an expansion: parts that do not overlap, so that its last part that is not zero has the sign of the sum
    let mut parts: Vec<f64> = Vec::with_capacity(12);
    for (x, y) in products {
        let high = x * y;
        for mut term in [x.mul_add(y, -high), high] {
            for part in &mut parts {
                let sum = term + *part;
                let added = sum - term;
                *part = (term - (sum - added)) + (*part - added);
                term = sum;
            }
            parts.push(term);
        }
    }
    parts
        .iter()
        .rev()
        .find(|part| **part != 0.0)
        .map_or(0, |part| if *part > 0.0 { 1 } else { -1 })
}
