//! Probabilities of convex polygons, slice by slice.

use crate::numeric::special::{normal_density, normal_probability};
use crate::numeric::{GaussLegendre, Sum, panels};
use crate::space::{Point, clipped_to_box};
use std::sync::LazyLock;

/// For slices that are long against what changes, and for those of small polygons in smooth light.
static LONG: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(16));
static SHORT: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(7));

/// Where a density of the plane and its derivatives jump, and over which lengths it changes, along each axis.
pub(super) struct Change {
    pub breaks: [Vec<f64>; 2],
    pub scales: [f64; 2],
}

/// ∫ slice(x, bottom(x), top(x)) dx over a convex polygon, where `slice` is the integral over a vertical segment: by panels cut at corners, at breaks and where an edge passes a break of the other axis,
/// none of which spans more than one scale along either axis. To some 1e-14 of the largest slice where the density is smooth between its breaks.
pub(super) fn sliced(
    ring: &[Point<2>],
    change: &Change,
    slice: impl Fn(f64, f64, f64) -> f64,
) -> f64 {
    let mut corners: Vec<f64> = ring.iter().map(|x| x[0]).collect();
    corners.sort_by(f64::total_cmp);
    let mut total = Sum::default();
    for pair in corners.windows(2) {
        let (left, right) = (pair[0], pair[1]);
        if left >= right {
            continue;
        }
        let Some([bottom, top]) = sides(ring, 0.5 * (left + right)) else {
            continue;
        };
        let reach = right - left;
        let rise = bottom.slope.abs().max(top.slope.abs()) * reach;
        let span = (reach / change.scales[0]).max(rise / change.scales[1]);
        let crossings = change.breaks[1]
            .iter()
            .flat_map(|y| [bottom, top].map(|side| side.from[0] + (y - side.from[1]) / side.slope));
        let cuts = change.breaks[0].iter().copied().chain(crossings);
        let pieces = panels(
            left,
            right,
            cuts.filter(|cut| cut.is_finite()),
            reach / span,
        );
        // where the density has breaks it may be a broken power of the distance from one
        let smooth = change.breaks.iter().all(Vec::is_empty) && span < 0.35;
        let rule = if smooth { &*SHORT } else { &*LONG };
        for piece in pieces.windows(2) {
            for (x, weight) in rule.on(piece[0], piece[1]) {
                total.add(weight * slice(x, bottom.at(x), top.at(x)));
            }
        }
    }
    total.value().max(0.0)
}

/// An edge as a function of the first coordinate.
#[derive(Clone, Copy)]
struct Side {
    from: Point<2>,
    slope: f64,
}

impl Side {
    fn at(&self, x: f64) -> f64 {
        (x - self.from[0]).mul_add(self.slope, self.from[1])
    }
}

/// The edges below and above `x`.
fn sides(ring: &[Point<2>], x: f64) -> Option<[Side; 2]> {
    let mut found: Option<[(f64, Side); 2]> = None;
    for (i, &a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        if (a[0] < x) == (b[0] < x) {
            continue;
        }
        // from the end that is nearer, so that steep edges lose no digits
        let from = if (x - a[0]).abs() < (x - b[0]).abs() {
            a
        } else {
            b
        };
        let side = Side {
            from,
            slope: (b[1] - a[1]) / (b[0] - a[0]),
        };
        let one = (side.at(x), side);
        found = Some(match found {
            None => [one, one],
            Some([low, high]) => [
                if one.0 < low.0 { one } else { low },
                if one.0 > high.0 { one } else { high },
            ],
        });
    }
    found.map(|pair| pair.map(|(_, side)| side))
}

/// The probability of a convex polygon under N(0, I).
pub(super) fn standard_normal(ring: &[Point<2>]) -> f64 {
    // beyond 9 deviations lies less than 1e-18
    let ring = clipped_to_box(ring, [-9.0; 2], [9.0; 2]);
    let change = Change {
        breaks: [Vec::new(), Vec::new()],
        scales: [1.0; 2],
    };
    sliced(&ring, &change, |u, low, high| {
        normal_density(u) * normal_probability(low, high)
    })
}

/// The area that a polygon, counter-clockwise, has in common with the disc of this radius about 0: of each edge the triangle with 0 where it runs inside, and sectors where it does not.
pub(super) fn area_in_disc(ring: &[Point<2>], radius: f64) -> f64 {
    let cross = |p: Point<2>, q: Point<2>| p[0] * q[1] - p[1] * q[0];
    let dot = |p: Point<2>, q: Point<2>| p[0] * q[0] + p[1] * q[1];
    let sector = |p, q| radius * radius * cross(p, q).atan2(dot(p, q));
    let twice: Sum = (0..ring.len())
        .map(|i| {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            let d = [b[0] - a[0], b[1] - a[1]];
            let square = dot(d, d);
            if square == 0.0 {
                return 0.0;
            }
            let foot = -dot(a, d) / square;
            let away = cross(a, d).powi(2) / square;
            let half = ((radius * radius - away).max(0.0) / square).sqrt();
            let (enter, leave) = ((foot - half).max(0.0), (foot + half).min(1.0));
            if enter >= leave {
                return sector(a, b);
            }
            let place = |t: f64| [t.mul_add(d[0], a[0]), t.mul_add(d[1], a[1])];
            let (p, q) = (place(enter), place(leave));
            let before = if enter > 0.0 { sector(a, p) } else { 0.0 };
            let after = if leave < 1.0 { sector(q, b) } else { 0.0 };
            before + cross(p, q) + after
        })
        .collect();
    (0.5 * twice.value()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_1_SQRT_2, PI};

    #[test]
    fn discs_are_cut_as_in_geometry() {
        let square = |x: f64, y: f64, half: f64| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[u, v]| [half.mul_add(u, x), half.mul_add(v, y)])
        };
        let segment = |d: f64| d.acos() - d * (1.0 - d * d).sqrt();
        for (ring, expected) in [
            (square(0.0, 0.0, 5.0), PI),
            (square(0.0, 0.0, FRAC_1_SQRT_2), 2.0),
            (square(0.1, -0.2, 0.01), 4e-4),
            (square(5.0, 0.3, 4.5), segment(0.5)),
            (square(10.0, 10.0, 10.0), PI / 4.0),
            (square(3.0, 3.0, 1.0), 0.0),
            (square(0.0, 0.0, 0.8), PI - 4.0 * segment(0.8)),
        ] {
            let found = area_in_disc(&ring, 1.0);
            assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        }
    }

    /// Half planes through places at known distances, whatever their direction.
    #[test]
    fn half_planes_of_the_normal_have_its_distribution() {
        for k in 0..40 {
            let (sine, cosine) = (0.3 + 0.157 * f64::from(k)).sin_cos();
            for distance in [-2.5, 0.0, 0.4, 3.0, 6.0] {
                let ring = [
                    [distance, -30.0],
                    [30.0, -30.0],
                    [30.0, 30.0],
                    [distance, 30.0],
                ]
                .map(|[u, v]| [cosine * u - sine * v, sine * u + cosine * v]);
                let found = standard_normal(&ring);
                let known = normal_probability(distance, f64::INFINITY);
                assert!(
                    (found - known).abs() < 1e-14,
                    "{k} {distance}: {found} {known}"
                );
                assert!(
                    (found / known - 1.0).abs() < 1e-8,
                    "{k} {distance}: {found} {known}"
                );
            }
        }
    }
}
