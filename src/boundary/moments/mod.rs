//! The kernel as a wall leaves it: its mass and moments over the part of its support that lies in the domain.
//!
//! | domain | product kernel | radial kernel | file |
//! |---|---|---|---|
//! | interval, box | partial moments of each axis | as a polygon | `mod.rs` |
//! | polygon | ∮ around the outline, by Green's formula | ∮ around the outline, by the divergence theorem | `outline.rs` |
//!
//! All are exact to rounding (some 1e-14): polynomial kernels by rules of sufficient degree, the others by panels that follow their
//! curvature.

mod outline;

pub(super) use outline::GAUSSIAN_REACH;

use super::Bump;
use crate::kernel::{Kernel, Symmetry};
use crate::space::{Domain, Point};

/// ∫ tᵖ K(t) dt over the domain as seen from x, t = (y - x) / h, for |p| ≤ 2. Far from all walls 1, 0 and k₂ times the unit matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DomainMoments<const D: usize> {
    /// ∫ K: the share of the kernel that lies in the domain.
    pub mass: f64,
    /// ∫ t K.
    pub first: [f64; D],
    /// ∫ t tᵀ K.
    pub second: [[f64; D]; D],
}

impl<const D: usize> Bump<D> {
    /// Mass and moments of the kernel around `x` over `domain`. Periodic sides count as open. O(1) on a box with a product kernel, otherwise O(edges).
    pub fn moments(&self, domain: &Domain<D>, x: Point<D>) -> DomainMoments<D> {
        if let Some(outline) = domain.outline() {
            self.over(outline.vertices(), x)
        } else if D == 2 && self.symmetry == Symmetry::Radial {
            self.over(&self.box_around(domain, x), x)
        } else {
            self.over_box(domain, x)
        }
    }

    /// Whether all of the kernel around `x` lies in `domain`, so that there is nothing to correct.
    pub fn is_clear(&self, domain: &Domain<D>, x: Point<D>) -> bool {
        let reach = self.reach();
        if let (Some(outline), &[x, y]) = (domain.outline(), &x[..]) {
            let farthest = reach.iter().copied().fold(0.0, f64::max);
            return outline.contains([x, y]) && outline.distance([x, y]) >= farthest;
        }
        (0..D).all(|axis| {
            let [lower, upper] = walls(domain, axis);
            lower <= x[axis] - reach[axis] && x[axis] + reach[axis] <= upper
        })
    }

    fn over_box(&self, domain: &Domain<D>, x: Point<D>) -> DomainMoments<D> {
        let mut axes = [[0.0; 3]; D];
        for axis in 0..D {
            let [low, high] = walls(domain, axis).map(|wall| (wall - x[axis]) / self.width[axis]);
            for (order, moment) in axes[axis].iter_mut().enumerate() {
                // a wall at infinity is one beyond reach
                let below = |t: f64| {
                    self.shape
                        .partial_moment(order as u32, t.clamp(-40.0, 40.0))
                };
                *moment = below(high) - below(low);
            }
        }
        // Π over the axes of the moment of the order that `orders` gives for each
        let product = |orders: &dyn Fn(usize) -> usize| -> f64 {
            (0..D).map(|axis| axes[axis][orders(axis)]).product()
        };
        let mut moments = DomainMoments {
            mass: product(&|_| 0),
            first: [0.0; D],
            second: [[0.0; D]; D],
        };
        for i in 0..D {
            moments.first[i] = product(&|axis| usize::from(axis == i));
            for j in 0..D {
                moments.second[i][j] =
                    product(&|axis| usize::from(axis == i) + usize::from(axis == j));
            }
        }
        moments
    }

    /// The corners of the part of a box that the kernel around `x` can reach, counter-clockwise.
    fn box_around(&self, domain: &Domain<D>, x: Point<D>) -> [Point<2>; 4] {
        let reach = self.reach();
        let [[left, right], [bottom, top]] = [0, 1].map(|axis| {
            let [lower, upper] = walls(domain, axis);
            let beyond = 1.25 * reach[axis];
            [lower.max(x[axis] - beyond), upper.min(x[axis] + beyond)]
        });
        [[left, bottom], [right, bottom], [right, top], [left, top]]
    }

    fn over(&self, ring: &[Point<2>], x: Point<D>) -> DomainMoments<D> {
        let ring: Vec<Point<2>> = ring
            .iter()
            .map(|vertex| [0, 1].map(|axis| (vertex[axis] - x[axis]) / self.width[axis]))
            .collect();
        let [mass, x, y, xx, xy, yy] = match self.symmetry {
            Symmetry::Radial => outline::radial(self.shape, &ring),
            Symmetry::Product => outline::product(self.shape, &ring),
        };
        let (first, second) = ([x, y], [[xx, xy], [xy, yy]]);
        DomainMoments {
            mass,
            first: std::array::from_fn(|i| first[i]),
            second: std::array::from_fn(|i| std::array::from_fn(|j| second[i][j])),
        }
    }
}

/// Where the density stops on `axis`, at infinity where it does not.
pub(super) fn walls<const D: usize>(domain: &Domain<D>, axis: usize) -> [f64; 2] {
    use crate::space::Side::Wall;
    let [lower, upper] = domain.sides()[axis];
    [
        if lower == Wall {
            domain.low()[axis]
        } else {
            f64::NEG_INFINITY
        },
        if upper == Wall {
            domain.high()[axis]
        } else {
            f64::INFINITY
        },
    ]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::kernel::Shape;
    use crate::numeric::GaussLegendre;
    use std::f64::consts::PI;

    fn bump(shape: Shape, symmetry: Symmetry, width: [f64; 2]) -> Bump<2> {
        Bump {
            shape,
            symmetry,
            width,
        }
    }

    fn square() -> Domain<2> {
        Domain::polygon(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]).unwrap()
    }

    /// All six by brute force: strips of the triangles between the origin and the edges, seen from the first vertex.
    fn brute(bump: &Bump<2>, ring: &[Point<2>], x: Point<2>) -> [f64; 6] {
        let rule = GaussLegendre::new(8);
        let mut sums = [0.0; 6];
        for i in 1..ring.len() - 1 {
            let [a, b, c] = [ring[0], ring[i], ring[i + 1]];
            let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            let pieces = 40;
            for p in 0..pieces * pieces {
                let [lu, lv] = [p / pieces, p % pieces].map(|k| f64::from(k) / f64::from(pieces));
                let step = 1.0 / f64::from(pieces);
                for (u, wu) in rule.on(lu, lu + step) {
                    for (v, wv) in rule.on(lv, lv + step) {
                        // the square onto the triangle
                        let y = [0, 1]
                            .map(|k| a[k] + u * ((1.0 - v) * (b[k] - a[k]) + v * (c[k] - a[k])));
                        let t = [0, 1].map(|k| (y[k] - x[k]) / bump.width[k]);
                        let f = bump.value(x, y) * twice * u * wu * wv;
                        for (sum, power) in sums.iter_mut().zip([
                            1.0,
                            t[0],
                            t[1],
                            t[0] * t[0],
                            t[0] * t[1],
                            t[1] * t[1],
                        ]) {
                            *sum += f * power;
                        }
                    }
                }
            }
        }
        sums
    }

    #[test]
    fn outlines_give_what_two_dimensional_quadrature_gives() {
        let ring = vec![[0.0, 0.0], [1.2, 0.1], [0.9, 0.8], [0.2, 1.1]];
        let domain = Domain::polygon(ring.clone()).unwrap();
        for symmetry in Symmetry::ALL {
            for (shape, tolerance) in [
                (Shape::Epanechnikov, 3e-5),
                (Shape::Triweight, 1e-7),
                (Shape::Gaussian, 1e-11),
                (Shape::Cosine, 3e-5),
                (Shape::Triangular, 3e-5),
            ] {
                for x in [[0.1, 0.2], [0.6, 0.5], [0.0, 0.0], [0.6, 0.05]] {
                    let bump = bump(shape, symmetry, [0.3, 0.4]);
                    let m = bump.moments(&domain, x);
                    let got = [
                        m.mass,
                        m.first[0],
                        m.first[1],
                        m.second[0][0],
                        m.second[0][1],
                        m.second[1][1],
                    ];
                    for (g, e) in got.iter().zip(brute(&bump, &ring, x)) {
                        assert!(
                            (g - e).abs() < tolerance,
                            "{symmetry} {shape} {x:?}: {got:?} {e}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_square_is_the_same_box_and_polygon() {
        for symmetry in Symmetry::ALL {
            for shape in Shape::ALL {
                for x in [
                    [0.5, 0.5],
                    [0.0, 0.3],
                    [0.01, 0.99],
                    [1.0, 1.0],
                    [0.7, 1e-7],
                ] {
                    let bump = bump(shape, symmetry, [0.2, 0.2]);
                    let (a, b) = (bump.moments(&Domain::unit(), x), bump.moments(&square(), x));
                    let close = |a: f64, b: f64| (a - b).abs() < 3e-14;
                    assert!(
                        close(a.mass, b.mass),
                        "{symmetry} {shape} {x:?} {a:?} {b:?}"
                    );
                    for i in 0..2 {
                        assert!(
                            close(a.first[i], b.first[i]),
                            "{symmetry} {shape} {x:?} {a:?} {b:?}"
                        );
                        for j in 0..2 {
                            assert!(
                                close(a.second[i][j], b.second[i][j]),
                                "{shape} {x:?} {a:?} {b:?}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn half_at_an_edge_a_quarter_in_a_corner_and_the_angle_at_a_vertex() {
        let angle = 1.1_f64;
        let triangle = Domain::polygon(vec![
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0 * angle.cos(), 2.0 * angle.sin()],
        ])
        .unwrap();
        for shape in Shape::ALL {
            let round = bump(shape, Symmetry::Radial, [0.05, 0.05]);
            for (domain, x, share) in [
                (square(), [0.5, 0.0], 0.5),
                (square(), [0.0, 0.0], 0.25),
                (triangle.clone(), [0.0, 0.0], angle / (2.0 * PI)),
                (Domain::unit(), [0.5, 0.5], 1.0),
            ] {
                let m = round.moments(&domain, x);
                assert!(
                    (m.mass - share).abs() < 1e-13,
                    "{shape} {x:?}: {} {share}",
                    m.mass
                );
            }
            let clear = round.moments(&square(), [0.5, 0.5]);
            assert!(clear.first.iter().all(|t| t.abs() < 1e-14));
            let variance = Symmetry::Radial.variance::<2>(shape);
            assert!(
                (clear.second[0][0] - variance).abs() < 1e-13,
                "{shape} {clear:?} {variance}"
            );
        }
    }

    #[test]
    fn the_line_has_the_textbook_numbers_of_the_epanechnikov_kernel() {
        let bump = Bump {
            shape: Shape::Epanechnikov,
            symmetry: Symmetry::Product,
            width: [0.5],
        };
        let domain = Domain::non_negative();
        for (c, mass) in [(0.0, 0.5), (0.25, 0.6836), (0.5, 0.8438), (1.0, 1.0)] {
            assert!((bump.moments(&domain, [c * 0.5]).mass - mass).abs() < 5e-5);
        }
        // ∫₀¹ t K = 3/16: the bias of cut and normalise is twice that
        assert!((bump.moments(&domain, [0.0]).first[0] - 0.1875).abs() < 1e-15);
    }
}
