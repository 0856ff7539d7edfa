//! Probabilities, derivatives, roughnesses.

use super::all;
use density_lab::density::Bivariate;
use density_lab::numeric::{GaussLegendre, Sum, panels};
use density_lab::random::{Stream, open_unit, stream};
use density_lab::space::{Lattice, Point};
use rayon::prelude::*;

const WHOLE: [Point<2>; 2] = [[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]];

/// A place in the bulk.
fn somewhere(truth: &dyn Bivariate, tail: f64, random: &mut Stream) -> Point<2> {
    let (low, high) = truth.bulk(tail);
    [0, 1].map(|k: usize| open_unit(random).mul_add(high[k] - low[k], low[k]))
}

/// The least deviation, which sets the scale for what is small.
fn deviation(truth: &dyn Bivariate) -> f64 {
    let (_, covariance) = truth.mean_and_covariance();
    covariance[0][0].min(covariance[1][1]).sqrt()
}

/// Probabilities add up over parts and are, of a small box, its area times the density: so they are the integral of the density.
#[test]
fn probabilities_are_the_integral_of_the_density() {
    all().par_iter().for_each(|(name, truth)| {
        let mut random = stream(7, "boxes", 0);
        let total = truth.probability(WHOLE[0], WHOLE[1]);
        assert!((total - 1.0).abs() < 1e-12, "{name}: {total}");
        for _ in 0..50 {
            let cut = somewhere(&**truth, 1e-3, &mut random);
            let sum: Sum = (0..4)
                .map(|quarter| {
                    let (mut low, mut high) = (WHOLE[0], WHOLE[1]);
                    for k in 0..2 {
                        if quarter >> k & 1 == 0 {
                            high[k] = cut[k];
                        } else {
                            low[k] = cut[k];
                        }
                    }
                    let part = truth.probability(low, high);
                    assert!((-1e-15..=1.0 + 1e-12).contains(&part), "{name}: {part}");
                    part
                })
                .collect();
            assert!((sum.value() - 1.0).abs() < 1e-12, "{name}: cut at {cut:?}");
        }
        let finest = truth.finest_scale(0).min(truth.finest_scale(1));
        let side = 1e-3 * finest.min(deviation(&**truth));
        let peak = (0..2000)
            .map(|_| truth.at(somewhere(&**truth, 1e-3, &mut random)))
            .fold(0.0, f64::max);
        let (mut tested, mut skipped) = (0, 0);
        while tested < 500 {
            let x = somewhere(&**truth, 1e-3, &mut random);
            let corner = |a: f64, b: f64| truth.at([x[0] + a * side, x[1] + b * side]);
            let around = [
                corner(0.5, 0.5),
                corner(-0.5, 0.5),
                corner(0.5, -0.5),
                corner(-0.5, -0.5),
            ];
            let f = truth.at(x);
            // a jump runs through the box
            if around
                .iter()
                .any(|v| (v - f).abs() > 0.01 * f + 1e-5 * peak)
            {
                skipped += 1;
                assert!(skipped < 200, "{name}: jumps everywhere");
                continue;
            }
            tested += 1;
            let (low, high) = (x.map(|x| x - side / 2.0), x.map(|x| x + side / 2.0));
            let mean = truth.probability(low, high) / ((high[0] - low[0]) * (high[1] - low[1]));
            assert!(
                (mean - f).abs() < 2e-6 * (f + peak),
                "{name} at {x:?}: {mean} {f}"
            );
        }
    });
}

/// Convex polygons: boxes are boxes, turned rectangles that cover all hold all, and of a small one the probability is its area times the density.
#[test]
fn polygons_have_the_probability_of_what_they_cover() {
    all().par_iter().for_each(|(name, truth)| {
        let mut random = stream(17, "polygons", 0);
        for _ in 0..40 {
            let (a, b) = (
                somewhere(&**truth, 1e-3, &mut random),
                somewhere(&**truth, 1e-3, &mut random),
            );
            let (low, high) = (
                [a[0].min(b[0]), a[1].min(b[1])],
                [a[0].max(b[0]), a[1].max(b[1])],
            );
            let within =
                truth.probability_within(&[low, [high[0], low[1]], high, [low[0], high[1]]]);
            let known = truth.probability(low, high);
            assert!((within - known).abs() < 1e-12, "{name}: {within} {known}");
        }
        let (low, high) = truth.bulk(1e-18);
        let middle = [0, 1].map(|k: usize| 0.5 * (low[k] + high[k]));
        let finest = truth.finest_scale(0).min(truth.finest_scale(1));
        for degrees in [31.0, 90.0, 107.0, -45.0] {
            let widths = [0, 1].map(|k: usize| (high[k] - low[k]) / 5.3);
            let lattice = Lattice::new(widths, middle, degrees);
            let [first, last] = lattice.numbers(low, high);
            let mut sum = Sum::default();
            for i in 0..=(last[0] - first[0]) as usize {
                for j in 0..=(last[1] - first[1]) as usize {
                    let number = [first[0] + i as f64, first[1] + j as f64];
                    let part = truth.probability_within(&lattice.within(number, low, high));
                    assert!((0.0..=1.0 + 1e-12).contains(&part), "{name}: {part}");
                    sum.add(part);
                }
            }
            assert!(
                (sum.value() - 1.0).abs() < 1e-11,
                "{name}: {degrees} {}",
                sum.value()
            );
        }
        let side = 1e-3 * finest.min(deviation(&**truth));
        let peak = (0..2000)
            .map(|_| truth.at(somewhere(&**truth, 1e-3, &mut random)))
            .fold(0.0, f64::max);
        let (mut tested, mut skipped) = (0, 0);
        while tested < 200 {
            let x = somewhere(&**truth, 1e-3, &mut random);
            let (sine, cosine) = (7.0 * open_unit(&mut random)).sin_cos();
            let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[u, v]| {
                let (u, v) = (u * side, v * side);
                [
                    cosine.mul_add(u, x[0] - sine * v),
                    sine.mul_add(u, x[1] + cosine * v),
                ]
            });
            let f = truth.at(x);
            // a jump runs through the square
            if (corners.iter()).any(|c| (truth.at(*c) - f).abs() > 0.01 * f + 1e-5 * peak) {
                skipped += 1;
                assert!(skipped < 200, "{name}: jumps everywhere");
                continue;
            }
            tested += 1;
            let mean = truth.probability_within(&corners) / (side * side);
            assert!(
                (mean - f).abs() < 2e-6 * (f + peak),
                "{name} at {x:?}: {mean} {f}"
            );
        }
        assert!(
            truth.probability_within(&[]) == 0.0 && truth.probability_within(&[middle; 2]) == 0.0
        );
    });
}

#[test]
fn derivatives_are_differences() {
    all().par_iter().for_each(|(name, truth)| {
        let mut random = stream(8, "differences", 0);
        let finest = truth.finest_scale(0).min(truth.finest_scale(1));
        let step = 3e-3 * finest;
        let mut scale = [0.0_f64; 2];
        let mut found = Vec::new();
        for _ in 0..400 {
            let x = somewhere(&**truth, 1e-2, &mut random);
            let f = |a: f64, b: f64| truth.at([a.mul_add(step, x[0]), b.mul_add(step, x[1])]);
            let gradient = truth.gradient(x);
            let laplacian = truth.laplacian(x);
            scale[0] = scale[0]
                .max(gradient[0].hypot(gradient[1]))
                .max(truth.at(x) * 1e-3 / finest);
            scale[1] = scale[1]
                .max(laplacian.abs())
                .max(truth.at(x) * 1e-3 / (finest * finest));
            // fourth-order differences
            let first = |a: f64, b: f64| {
                (8.0 * (f(a, b) - f(-a, -b)) - (f(2.0 * a, 2.0 * b) - f(-2.0 * a, -2.0 * b)))
                    / (12.0 * step)
            };
            let second = |a: f64, b: f64| {
                (16.0 * (f(a, b) + f(-a, -b))
                    - (f(2.0 * a, 2.0 * b) + f(-2.0 * a, -2.0 * b))
                    - 30.0 * f(0.0, 0.0))
                    / (12.0 * step * step)
            };
            found.push((
                x,
                (first(1.0, 0.0) - gradient[0]).hypot(first(0.0, 1.0) - gradient[1]),
                (second(1.0, 0.0) + second(0.0, 1.0) - laplacian).abs(),
            ));
        }
        let wrong = found
            .iter()
            .filter(|(_, first, second)| *first > 1e-6 * scale[0] || *second > 1e-5 * scale[1])
            .count();
        // differences across an edge are not derivatives; few places are so near one
        assert!(
            wrong <= 24,
            "{name}: {wrong} of 400 wrong, for instance {:?}",
            found
                .iter()
                .find(|(_, a, b)| *a > 1e-6 * scale[0] || *b > 1e-5 * scale[1])
        );
    });
}

#[test]
fn roughnesses_are_integrals_or_infinite_at_walls() {
    let (mut finite, mut infinite) = (0, 0);
    for (name, truth) in all() {
        let claimed = [truth.gradient_roughness(), truth.laplacian_roughness()];
        for (kind, claimed) in claimed.into_iter().enumerate() {
            if claimed.is_infinite() {
                assert!(truth.domain().has_walls(), "{name}: why infinite?");
                infinite += 1;
                continue;
            }
            let (low, high) = truth.bulk(1e-14);
            let cuts = |axis: usize| {
                panels(
                    low[axis],
                    high[axis],
                    truth.breaks(axis),
                    1.5 * truth.finest_scale(axis),
                )
            };
            let (rule, x_cuts, y_cuts) = (GaussLegendre::new(12), cuts(0), cuts(1));
            let square = |x: Point<2>| match kind {
                0 => truth.gradient(x).iter().map(|g| g * g).sum(),
                _ => truth.laplacian(x).powi(2),
            };
            let got = rule.integrate_panels(
                |x| rule.integrate_panels(|y| square([x, y]), &y_cuts),
                &x_cuts,
            );
            assert!(
                (got / claimed - 1.0).abs() < 1e-8,
                "{name}: {claimed} {got}"
            );
            finite += 1;
        }
    }
    assert!(finite >= 7 && infinite >= 10, "{finite} {infinite}");
}

#[test]
fn nothing_lies_outside_the_support_and_nothing_is_undefined() {
    for (name, truth) in all() {
        let domain = truth.domain().clone();
        let mut random = stream(11, "support", 0);
        for _ in 0..20_000 {
            let x = truth.draw(&mut random);
            assert!(domain.contains(x) && truth.at(x) > 0.0, "{name} at {x:?}");
        }
        let odd = [
            f64::NEG_INFINITY,
            -1e200,
            -1.0,
            -0.0,
            0.3,
            1.0 + 1e-9,
            1e200,
            f64::INFINITY,
        ];
        for x in odd {
            for y in odd {
                let f = truth.at([x, y]);
                assert!(f >= 0.0 && f.is_finite(), "{name} at {x}, {y}: {f}");
                let [a, b] = truth.gradient([x, y]);
                assert!(
                    a.is_finite() && b.is_finite() && truth.laplacian([x, y]).is_finite(),
                    "{name} at {x}, {y}"
                );
                assert!(f == 0.0 || domain.contains([x, y]), "{name}");
            }
        }
        for tail in [0.2, 1e-3, 1e-12, 0.0] {
            let (low, high) = truth.bulk(tail);
            for k in 0..2 {
                assert!(
                    low[k].is_finite() && high[k].is_finite() && low[k] < high[k],
                    "{name}"
                );
                let (mut below, mut above) = (WHOLE, WHOLE);
                below[1][k] = low[k];
                above[0][k] = high[k];
                for side in [below, above] {
                    let beyond = truth.probability(side[0], side[1]);
                    assert!(
                        beyond <= tail * (1.0 + 1e-9) + 1e-12,
                        "{name} tail {tail}: {beyond}"
                    );
                }
            }
        }
        assert!(truth.bivariate().is_some() && truth.univariate().is_none());
        assert!(truth.breaks(0).is_sorted() && truth.breaks(1).is_sorted());
    }
}
