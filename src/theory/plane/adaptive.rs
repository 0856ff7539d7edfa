//! Adaptive kernel estimates of the plane whose pilot is a known function: exact mean and variance.

use super::pointwise::{GAUSSIAN_REACH, of};
use crate::density::Density;
use crate::kernel::{Kernel, Shape, Symmetry};
use crate::numeric::{GaussLegendre, Sum, panels, sign_change};
use crate::space::Point;
use crate::theory::{Moments, Support};
use std::sync::LazyLock;

static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(12));

/// A bandwidth that is a fixed function of the place of a datum, one for both axes.
pub struct PlaneWidths<'a> {
    /// h(y), continuous and smooth but for bends.
    pub at: &'a (dyn Fn(Point<2>) -> f64 + Sync),
    /// What changes its sign (−, 0 or +) where h bends or jumps, as where a clip sets in; constant if it does not.
    pub bend: &'a (dyn Fn(Point<2>) -> f64 + Sync),
    /// The least and the greatest h.
    pub range: [f64; 2],
}

/// The moments at `x` of Σ wᵢ K((x - Xᵢ)/h(Xᵢ))/h(Xᵢ)² over `draws` points of `truth`: E f̂ = ∫ K((x - y)/h(y))/h(y)² f(y) dy, and the variance is that of the integrand's factor over n.
///
/// By quadrature along rays from `x`, cut at walls, where a kernel that ends reaches `x` no more, and where the width bends: to some 1e-6 of the peak for smooth densities and widths, 1e-4 where they
/// bend on a curve that rays touch. Some 10⁵ evaluations of the density a place. [Abramson 1982; Hall & Marron 1988]
pub fn plane_adaptive_moments(
    truth: &dyn Density<2>,
    shape: Shape,
    symmetry: Symmetry,
    widths: &PlaneWidths<'_>,
    draws: f64,
    x: Point<2>,
) -> Moments {
    let round = shape == Shape::Gaussian;
    let reach = if round { GAUSSIAN_REACH } else { 1.0 };
    let [least, most] = widths.range;
    let support = Support {
        centre: x,
        reach: [reach * most; 2],
        round: round || symmetry == Symmetry::Radial,
    };
    let factor = symmetry.factor::<2>(shape);
    let kernel = |y: Point<2>, h: f64| {
        let [u, v] = [0, 1].map(|k: usize| (x[k] - y[k]) / h);
        let value = match symmetry {
            Symmetry::Product => shape.value(u) * shape.value(v),
            Symmetry::Radial => shape.of_square(u * u + v * v),
        };
        factor * value / (h * h)
    };
    // how far y is inside the window that reaches x: negative beyond it
    let inside = |y: Point<2>| {
        let [dx, dy] = [0, 1].map(|k: usize| (x[k] - y[k]).abs());
        let away = if support.round {
            dx.hypot(dy)
        } else {
            dx.max(dy)
        };
        reach * (widths.at)(y) - away
    };
    let scale = truth.finest_scale(0).min(truth.finest_scale(1));
    let longest = scale.min(if round { 1.5 * least } else { most });
    let step = longest / support.reach[0];
    let (mut mean, mut square) = (Sum::default(), Sum::default());
    for ray in support.rays(truth.domain(), longest) {
        let at = |r: f64| support.place(&ray, r);
        for &[from, to] in &ray.pieces {
            // nothing that matters is smaller than half a step
            let coarse = panels(from, to, [], 0.5 * step);
            let crossings = |of: &dyn Fn(Point<2>) -> f64| -> Vec<f64> {
                let pieces = coarse.windows(2);
                pieces
                    .filter_map(|ends| sign_change(|r| of(at(r)), ends[0], ends[1]))
                    .collect()
            };
            let mut cuts = crossings(&inside);
            cuts.extend(crossings(widths.bend));
            for piece in panels(from, to, cuts, step).windows(2) {
                if inside(at(0.5 * (piece[0] + piece[1]))) <= 0.0 {
                    continue;
                }
                for (r, along) in RULE.on(piece[0], piece[1]) {
                    let y = at(r);
                    let value = kernel(y, (widths.at)(y));
                    let term = ray.weight * along * r * value * truth.at(y);
                    mean.add(term);
                    square.add(term * value);
                }
            }
        }
    }
    let area = support.reach[0] * support.reach[1];
    of(area * mean.value(), area * square.value(), draws)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::named_in_plane;
    use crate::random::Stream;
    use crate::space::{Domain, Field};
    use crate::theory::plane_kernel_moments;

    /// Flat on the unit square but for a hole in its middle, of which a pilot is exactly 0.
    struct Holed(Domain<2>);

    const HOLE: [f64; 2] = [0.3, 0.7];

    impl Field<2> for Holed {
        fn domain(&self) -> &Domain<2> {
            &self.0
        }

        fn at(&self, x: Point<2>) -> f64 {
            let hole = x.iter().all(|x| (HOLE[0]..HOLE[1]).contains(x));
            if hole || !self.0.contains(x) {
                0.0
            } else {
                1.0 / 0.84
            }
        }
    }

    impl Density<2> for Holed {
        fn draw(&self, _: &mut Stream) -> Point<2> {
            unreachable!("theory draws nothing")
        }

        fn probability(&self, _: Point<2>, _: Point<2>) -> f64 {
            unreachable!("nor does it ask for boxes here")
        }

        fn breaks(&self, _: usize) -> Vec<f64> {
            vec![0.0, HOLE[0], HOLE[1], 1.0]
        }

        fn finest_scale(&self, _: usize) -> f64 {
            0.5
        }

        fn bulk(&self, _: f64) -> (Point<2>, Point<2>) {
            ([0.0; 2], [1.0; 2])
        }
    }

    /// The pilot is 0 in the hole and nothing else beside it: rays must be cut at its edge all the same.
    #[test]
    fn the_edge_of_a_hole_is_found() {
        fn widths(bend: &(dyn Fn(Point<2>) -> f64 + Sync)) -> PlaneWidths<'_> {
            PlaneWidths {
                at: &|_| 0.25,
                bend,
                range: [0.25; 2],
            }
        }
        let truth = Holed(Domain::unit());
        let (shape, symmetry) = (Shape::Epanechnikov, Symmetry::Product);
        let (mut with, mut without): (f64, f64) = (0.0, 0.0);
        for x in [[0.2, 0.5], [0.25, 0.28], [0.45, 0.72], [0.5, 0.5]] {
            let along = |k: usize, [low, high]: [f64; 2]| {
                let below = |y: f64| shape.partial_moment(0, ((y - x[k]) / 0.25).clamp(-1.0, 1.0));
                below(high) - below(low)
            };
            let inside = |ends| along(0, ends) * along(1, ends);
            let known = (inside([0.0, 1.0]) - inside(HOLE)) / 0.84;
            let mean = |bend: &(dyn Fn(Point<2>) -> f64 + Sync)| {
                let widths = widths(bend);
                plane_adaptive_moments(&truth, shape, symmetry, &widths, 1.0, x).mean
            };
            with = with.max((mean(&|y| truth.at(y)) - known).abs());
            without = without.max((mean(&|_| 1.0) - known).abs());
        }
        assert!(with < 5e-4, "{with}");
        assert!(
            without > 3.0 * with,
            "it would not matter: {without} {with}"
        );
    }

    /// One width everywhere is no adaptive estimate.
    #[test]
    fn one_width_is_a_fixed_one() {
        for name in ["normal-2d", "uniform-2d"] {
            let Some(truth) = named_in_plane(name) else {
                panic!("{name}")
            };
            for symmetry in Symmetry::ALL {
                for shape in [Shape::Gaussian, Shape::Epanechnikov, Shape::Biweight] {
                    let widths = PlaneWidths {
                        at: &|_| 0.3,
                        bend: &|_| 1.0,
                        range: [0.3, 0.3],
                    };
                    for x in [[0.2, 0.1], [0.9, 0.95]] {
                        let got =
                            plane_adaptive_moments(&*truth, shape, symmetry, &widths, 100.0, x);
                        let known =
                            plane_kernel_moments(&*truth, shape, symmetry, [0.3; 2], 100.0, x);
                        assert!(
                            (got.mean - known.mean).abs() < 1e-7,
                            "{name} {got:?} {known:?}"
                        );
                        let off = (got.variance / known.variance - 1.0).abs();
                        assert!(off < 1e-6, "{name} {shape} {symmetry} {got:?} {known:?}");
                    }
                }
            }
        }
    }

    /// Widths that grow along one axis alone, h = a + b y₁ between bends, in the middle of a flat square: against a fine midpoint sum.
    #[test]
    fn widths_that_change_agree_with_a_fine_sum() {
        const STEPS: usize = 1200;
        let truth = named_in_plane("uniform-2d").expect("in the catalogue");
        let width = |y: Point<2>| (0.1 + 0.2 * y[0]).clamp(0.15, 0.25);
        let widths = PlaneWidths {
            at: &width,
            bend: &|y| (y[0] - 0.25) * (y[0] - 0.75),
            range: [0.15, 0.25],
        };
        let x = [0.45, 0.5];
        for symmetry in Symmetry::ALL {
            for shape in [Shape::Gaussian, Shape::Triweight] {
                let got = plane_adaptive_moments(&*truth, shape, symmetry, &widths, 1.0, x);
                let (mut mean, mut square) = (0.0, 0.0);
                for i in 0..STEPS * STEPS {
                    let y = [i / STEPS, i % STEPS].map(|k| (k as f64 + 0.5) / STEPS as f64);
                    let h = width(y);
                    let [u, v] = [0, 1].map(|k: usize| (x[k] - y[k]) / h);
                    let value = match symmetry {
                        Symmetry::Product => shape.value(u) * shape.value(v),
                        Symmetry::Radial => {
                            symmetry.factor::<2>(shape) * shape.of_square(u * u + v * v)
                        }
                    } / (h * h);
                    mean += value;
                    square += value * value;
                }
                let cell = 1.0 / (STEPS * STEPS) as f64;
                let expected = of(mean * cell, square * cell, 1.0);
                assert!(
                    (got.mean / expected.mean - 1.0).abs() < 1e-5,
                    "{got:?} {expected:?}"
                );
                let off = (got.variance / expected.variance - 1.0).abs();
                assert!(off < 1e-5, "{shape} {symmetry}: {got:?} {expected:?}");
            }
        }
    }
}
