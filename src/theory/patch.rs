//! Quadrature over what a wall leaves of the support of a kernel in the plane.

use crate::numeric::{GaussLegendre, panels};
use crate::space::{Domain, Point};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(12));

/// The support of a kernel about a place.
#[derive(Clone, Copy, Debug)]
pub struct Support {
    /// Its centre.
    pub centre: Point<2>,
    /// How far it reaches on each axis.
    pub reach: [f64; 2],
    /// An ellipse, or the rectangle around it.
    pub round: bool,
}

impl Support {
    /// Places and weights: Σ w g(y) is the integral of g over the part of the support that lies in `domain`, for a g that changes over no less than
    /// `longest` and is smooth but for lines through the centre along the axes.
    ///
    /// Polar about the centre, in units of the reach: each ray is cut where it meets the outline. Sectors end at corners, where edges leave an ellipse,
    /// and at a ladder of angles that closes in on edges near the centre. Good to some 1e-9 of the largest g; some hundred to thousand places.
    pub fn nodes(&self, domain: &Domain<2>, longest: f64) -> Vec<(Point<2>, f64)> {
        let area = self.reach[0] * self.reach[1];
        let inner = longest / self.reach[0].max(self.reach[1]);
        let mut nodes = Vec::new();
        for ray in self.rays(domain, longest) {
            for [from, to] in &ray.pieces {
                for piece in panels(*from, *to, [], inner).windows(2) {
                    for (r, along) in RULE.on(piece[0], piece[1]) {
                        nodes.push((self.place(&ray, r), area * r * ray.weight * along));
                    }
                }
            }
        }
        nodes
    }

    /// The rays of [`Support::nodes`], in the order of their angles: Σ over them of weight × ∫ g r dr over their pieces, times the area of the square of the reach, is the integral of g.
    pub(super) fn rays(&self, domain: &Domain<2>, longest: f64) -> Vec<Ray> {
        let ring = self.ring(domain);
        let longest = longest / self.reach[0].max(self.reach[1]);
        let mut rays = Vec::new();
        for sector in sectors(&ring, self.round, longest).windows(2) {
            for (angle, weight) in RULE.on(sector[0], sector[1]) {
                let (sine, cosine) = angle.sin_cos();
                let direction = [cosine, sine];
                rays.push(Ray {
                    direction,
                    weight,
                    pieces: inside(&ring, direction, self.round),
                });
            }
        }
        rays
    }

    /// The place at the distance `r` on a ray.
    pub(super) fn place(&self, ray: &Ray, r: f64) -> Point<2> {
        [0, 1].map(|k: usize| (r * ray.direction[k]).mul_add(self.reach[k], self.centre[k]))
    }

    /// The rectangle cut to the domain, in units of the reach from the centre; empty where nothing is left.
    fn ring(&self, domain: &Domain<2>) -> Vec<[f64; 2]> {
        let ends = |sign: f64| [0, 1].map(|k: usize| self.centre[k] + sign * self.reach[k]);
        let (low, high) = (ends(-1.0), ends(1.0));
        let unit = |y: Point<2>| [0, 1].map(|k: usize| (y[k] - self.centre[k]) / self.reach[k]);
        if let Some(outline) = domain.outline() {
            return outline.within(low, high).into_iter().map(unit).collect();
        }
        let low = unit([0, 1].map(|k: usize| low[k].max(domain.low()[k])));
        let high = unit([0, 1].map(|k: usize| high[k].min(domain.high()[k])));
        if low[0] >= high[0] || low[1] >= high[1] {
            return Vec::new();
        }
        vec![low, [high[0], low[1]], high, [low[0], high[1]]]
    }
}

/// A direction from the centre of a support, lengths in units of its reach.
pub(super) struct Ray {
    /// Cosine and sine of its angle.
    direction: [f64; 2],
    /// The weight of the rule over the angles.
    pub weight: f64,
    /// From where to where it runs inside.
    pub pieces: Vec<[f64; 2]>,
}

fn edges(ring: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
    (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]])
}

/// Angles from -π to π between which the ends of rays move smoothly.
fn sectors(ring: &[[f64; 2]], round: bool, longest: f64) -> Vec<f64> {
    /// Steps of the ladder towards an edge.
    const LADDER: i32 = 8;
    let mut cuts = vec![-FRAC_PI_2, 0.0, FRAC_PI_2];
    for [a, b] in edges(ring) {
        cuts.push(a[1].atan2(a[0]));
        let d = [b[0] - a[0], b[1] - a[1]];
        let square = d[0] * d[0] + d[1] * d[1];
        if square == 0.0 {
            continue;
        }
        let along = -(a[0] * d[0] + a[1] * d[1]) / square;
        let foot = [along.mul_add(d[0], a[0]), along.mul_add(d[1], a[1])];
        let distance = foot[0].hypot(foot[1]);
        if round && distance < 1.0 {
            // where the edge enters and leaves the unit disc
            let half = ((1.0 - distance * distance) / square).sqrt();
            for t in [along - half, along + half] {
                let place = [t.mul_add(d[0], a[0]), t.mul_add(d[1], a[1])];
                cuts.push(place[1].atan2(place[0]));
            }
        }
        if 0.0 < distance && distance < 0.7 {
            let middle = foot[1].atan2(foot[0]);
            let steps = (0..LADDER).map(|k| 3.0f64.powi(k - 1).atan());
            let away = steps.take_while(|tilt| tilt.cos() > 0.5 * distance);
            cuts.extend(away.flat_map(|tilt| [middle - tilt, middle + tilt]));
        }
    }
    let turn = |angle: &mut f64| {
        if *angle > PI {
            *angle -= 2.0 * PI;
        } else if *angle < -PI {
            *angle += 2.0 * PI;
        }
    };
    cuts.iter_mut().for_each(turn);
    let mut all = panels(-PI, PI, cuts, longest.max(0.05));
    // slivers between cuts that are one but for rounding
    all.dedup_by(|next, last| *next - *last < 1e-12);
    all
}

/// The pieces of the ray from the centre in a direction that lie in the ring, and in the unit disc where the support is one.
fn inside(ring: &[[f64; 2]], [x, y]: [f64; 2], round: bool) -> Vec<[f64; 2]> {
    let mut crossings: Vec<f64> = edges(ring)
        .filter_map(|[a, b]| {
            // left and right of the ray
            let (s, t) = (x * a[1] - y * a[0], x * b[1] - y * b[0]);
            if (s > 0.0) == (t > 0.0) {
                return None;
            }
            let share = s / (s - t);
            let place = [
                share.mul_add(b[0] - a[0], a[0]),
                share.mul_add(b[1] - a[1], a[1]),
            ];
            let r = place[0] * x + place[1] * y;
            (r > 0.0).then_some(r)
        })
        .collect();
    crossings.sort_by(f64::total_cmp);
    // far away is outside, so an odd number of crossings is seen from inside
    if crossings.len() % 2 == 1 {
        crossings.insert(0, 0.0);
    }
    let most = if round { 1.0 } else { f64::INFINITY };
    crossings
        .chunks_exact(2)
        .map(|pair| [pair[0], pair[1].min(most)])
        .filter(|pair| pair[0] < pair[1])
        .collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn area(domain: &Domain<2>, centre: Point<2>, reach: f64, round: bool) -> f64 {
        let support = Support {
            centre,
            reach: [reach; 2],
            round,
        };
        support.nodes(domain, 10.0).iter().map(|(_, w)| w).sum()
    }

    #[test]
    fn areas_are_known() {
        let square = Domain::<2>::unit();
        // whole, cut by one edge at distance d, a quarter in a corner
        let segment = |d: f64| (d.acos() - d * (1.0 - d * d).sqrt()) * 0.04;
        for (centre, expected) in [
            ([0.5, 0.5], PI * 0.04),
            ([0.1, 0.5], PI * 0.04 - segment(0.5)),
            ([0.002, 0.5], PI * 0.04 - segment(0.01)),
            ([0.0, 0.5], PI * 0.02),
            ([0.0, 1.0], PI * 0.01),
            ([-0.1, 0.5], segment(0.5)),
        ] {
            let found = area(&square, centre, 0.2, true);
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "{centre:?} {found} {expected}"
            );
        }
        assert!((area(&square, [0.3, 0.9], 0.2, false) - 0.4 * 0.3).abs() < 1e-12);
        assert!(area(&square, [2.0, 2.0], 0.2, true).abs() < 1e-300);
        let whole = Domain::<2>::whole();
        assert!((area(&whole, [3.0, -2.0], 2.0, true) / (4.0 * PI) - 1.0).abs() < 1e-12);
    }

    /// Rays that leave a room and come into it again.
    #[test]
    fn a_room_with_a_corner_inside_is_covered_once() {
        let ell = [
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [0.0, 2.0],
        ];
        let room = Domain::polygon(ell.to_vec()).unwrap();
        for centre in [[0.5, 1.8], [1.9, 0.2], [1.0, 1.0], [0.0, 0.0], [0.9, 1.2]] {
            let found = area(&room, centre, 4.0, false);
            assert!((found - 3.0).abs() < 1e-8, "{centre:?}: {found}");
        }
        // three quarters of a disc about the inner corner
        let found = area(&room, [1.0, 1.0], 0.5, true);
        assert!((found / (0.75 * PI * 0.25) - 1.0).abs() < 1e-9, "{found}");
    }
}
