#![allow(clippy::unwrap_used, clippy::float_cmp)]

use super::*;
use crate::density::Univariate;
use crate::kernel::{Bandwidth, Shape, Symmetry};
use crate::numeric::GaussLegendre;
use crate::sample::{Sample, Weights};
use crate::space::{Grid, Targets};

/// Points that avoid no wall, no corner and no tie.
fn points<const D: usize>(domain: &Domain<D>, n: usize) -> Vec<Point<D>> {
    let mut points = Vec::new();
    let mut k = 0_u32;
    while points.len() < n {
        k += 1;
        let ratio = [0.618_033_988, 0.754_877_666];
        let x: Point<D> = std::array::from_fn(|axis| {
            let u = (f64::from(k) * ratio[axis]).fract();
            let (low, high) = (
                domain.low()[axis],
                domain.high()[axis].min(domain.low()[axis] + 3.0),
            );
            // some land exactly on a wall
            low + (high - low) * if k.is_multiple_of(17) { u.round() } else { u }
        });
        if domain.contains(x) {
            points.push(x);
        }
    }
    points
}

fn sum<const D: usize>(
    domain: &Domain<D>,
    shape: Shape,
    symmetry: Symmetry,
    h: f64,
) -> KernelSum<D> {
    let points = points(domain, 60);
    let weights: Vec<f64> = (1..=60).map(|i| f64::from(i % 7)).collect();
    let sample = Sample::new(points, Weights::Each(weights.into()), domain.clone()).unwrap();
    KernelSum::new(sample, shape, Bandwidth::Fixed([h; D]))
        .unwrap()
        .with_symmetry(symmetry)
}

fn plain<const D: usize>(sum: KernelSum<D>) -> Box<dyn Field<D>> {
    Box::new(sum)
}

fn l_shape() -> Domain<2> {
    Domain::polygon(vec![
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ])
    .unwrap()
}

fn triangle() -> Domain<2> {
    Domain::polygon(vec![[0.0, 0.0], [2.0, 0.2], [0.5, 1.5]]).unwrap()
}

fn agree<const D: usize>(domain: &Domain<D>, targets: &[Point<D>]) {
    for shape in [Shape::Epanechnikov, Shape::Gaussian, Shape::Uniform] {
        for symmetry in Symmetry::ALL {
            for h in [0.07, 0.4, 1.3] {
                let sum = sum(domain, shape, symmetry, h);
                let ceiling = sum.ceiling().unwrap();
                for boundary in all::<D>() {
                    let field = boundary.correct(sum.clone(), &plain).unwrap();
                    let many = field.evaluate(Targets::Points(targets)).values;
                    for (x, value) in targets.iter().zip(many) {
                        assert!((value - field.at(*x)).abs() <= 1e-13 * ceiling);
                        let bump = Bump::of(&sum, 0, *x);
                        let Some(kernel) = boundary.equivalent(&bump, domain, *x) else {
                            continue;
                        };
                        let expected: f64 = if domain.contains(*x) || boundary.name() == "ignore" {
                            let terms = sum.sample().points().iter().enumerate();
                            terms
                                .map(|(i, y)| sum.sample().weight(i) * kernel(*y))
                                .sum()
                        } else {
                            0.0
                        };
                        assert!(
                            (value - expected).abs() <= 1e-11 * ceiling,
                            "{} {shape} {symmetry} h = {h} at {x:?}: {value} is not {expected}",
                            boundary.name()
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn every_correction_computes_its_equivalent_kernel() {
    let line: Vec<Point<1>> = (-5..=40).map(|i| [f64::from(i) * 0.05]).collect();
    agree(&Domain::walled([0.0], [1.7]).unwrap(), &line);
    agree(&Domain::non_negative(), &line);
    let plane: Vec<Point<2>> = (-1..=11)
        .flat_map(|i| (-1..=11).map(move |j| [f64::from(i) * 0.2, f64::from(j) * 0.2]))
        .collect();
    agree(&Domain::walled([0.0, 0.0], [1.5, 2.0]).unwrap(), &plane);
    agree(&l_shape(), &plane);
    agree(&triangle(), &plane);
}

/// ∫ over a domain: a triangle from each edge to a centre, or strips.
fn over(domain: &Domain<2>, f: impl Fn(Point<2>) -> f64) -> f64 {
    let ring = domain.outline().map_or_else(
        || {
            let ([a, b], [c, d]) = (domain.low(), domain.high());
            vec![[a, b], [c, b], [c, d], [a, d]]
        },
        |outline| outline.vertices().to_vec(),
    );
    let rule = GaussLegendre::new(8);
    let mut total = 0.0;
    // signed triangles from the first vertex cover any polygon
    for i in 1..ring.len() - 1 {
        let [a, b, c] = [ring[0], ring[i], ring[i + 1]];
        let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        for p in 0..24 * 24 {
            let [low, left] = [p / 24, p % 24].map(|k| f64::from(k) / 24.0);
            for (u, wu) in rule.on(low, low + 1.0 / 24.0) {
                for (v, wv) in rule.on(left, left + 1.0 / 24.0) {
                    let y =
                        [0, 1].map(|k| a[k] + u * ((1.0 - v) * (b[k] - a[k]) + v * (c[k] - a[k])));
                    total += f(y) * twice * u * wu * wv;
                }
            }
        }
    }
    total
}

#[test]
fn promises_are_kept_and_what_is_not_promised_is_not_kept() {
    let line = |y: Point<2>| 0.7 + 0.3 * y[0] - 0.2 * y[1];
    for domain in [Domain::unit(), l_shape(), triangle()] {
        let is_box = domain.outline().is_none();
        let bump = Bump {
            shape: Shape::Triweight,
            symmetry: Symmetry::Radial,
            width: [0.35, 0.35],
        };
        for boundary in all::<2>() {
            let promises = boundary.promises();
            let (mut constants, mut lines) = (0.0_f64, 0.0_f64);
            for x in [[0.05, 0.04], [0.5, 0.3], [0.3, 0.9]] {
                let Some(kernel) = boundary.equivalent(&bump, &domain, x) else {
                    continue;
                };
                constants = constants.max((over(&domain, &kernel) - 1.0).abs());
                lines = lines.max((over(&domain, |y| kernel(y) * line(y)) - line(x)).abs());
            }
            let name = boundary.name();
            if name == "jones-foster" || (name == "reflect" && !is_box) {
                continue;
            }
            // quadrature over a kernel with an edge: some 1e-5
            assert_eq!(
                constants < 2e-5,
                promises.reproduces_constants,
                "{name}: {constants:e}"
            );
            assert_eq!(lines < 2e-5, promises.reproduces_lines, "{name}: {lines:e}");
        }
    }
}

/// What a kernel gives for a linear density, from an integral of which the quadrature is exact: on a triangle small beside h only polynomials are left.
#[test]
fn local_linear_reproduces_lines_to_rounding() {
    let small = Domain::polygon(vec![[0.0, 0.0], [0.1, 0.01], [0.02, 0.08]]).unwrap();
    let line = |y: Point<2>| 3.0 + 20.0 * y[0] - 15.0 * y[1];
    for domain in [Domain::walled([0.0, 0.0], [0.1, 0.07]).unwrap(), small] {
        for symmetry in Symmetry::ALL {
            for shape in [
                Shape::Epanechnikov,
                Shape::Biweight,
                Shape::Triweight,
                Shape::Gaussian,
            ] {
                let bump = Bump {
                    shape,
                    symmetry,
                    width: [0.25, 0.25],
                };
                for x in [[0.03, 0.02], [0.04, 0.03], [0.0, 0.0]] {
                    let kernel = LocalLinear::default()
                        .equivalent(&bump, &domain, x)
                        .unwrap();
                    let mean = over(&domain, |y| kernel(y) * line(y));
                    assert!(
                        (mean - line(x)).abs() < 1e-10,
                        "{symmetry} {shape} {x:?}: {mean} is not {}",
                        line(x)
                    );
                }
            }
        }
    }
}

#[test]
fn mass_is_kept_where_it_is_promised() {
    for domain in [Domain::unit(), Domain::walled([-1.0], [0.3]).unwrap()] {
        let rule = GaussLegendre::new(16);
        for shape in [Shape::Epanechnikov, Shape::Gaussian] {
            for h in [0.05, 0.4, 2.5] {
                let sum = sum(&domain, shape, Symmetry::Product, h);
                let mass = sum.sample().mass();
                for boundary in all::<1>() {
                    let field = boundary.correct(sum.clone(), &plain).unwrap();
                    let ([low], [high]) = (domain.low(), domain.high());
                    let panels: Vec<f64> = (0..=3000)
                        .map(|i| low + (high - low) * f64::from(i) / 3000.0)
                        .collect();
                    let total = rule.integrate_panels(|x| field.at([x]), &panels);
                    let kept = (total / mass - 1.0).abs() < 1e-6;
                    assert_eq!(
                        kept,
                        boundary.promises().mass_conserving,
                        "{} {shape} {h}: {total} {mass}",
                        boundary.name()
                    );
                }
            }
        }
    }
}

#[test]
fn the_textbook_biases_at_a_wall() {
    // E f̂ = f for f = 1 + s y near 0: what is left over s h is the coefficient of h f'
    let domain = Domain::<1>::non_negative();
    let bump = Bump {
        shape: Shape::Epanechnikov,
        symmetry: Symmetry::Product,
        width: [0.1],
    };
    let bias = |boundary: &dyn Boundary<1>, c: f64| {
        let kernel = boundary.equivalent(&bump, &domain, [c * 0.1]).unwrap();
        // the kernel has an edge at (1 ± c) h
        let rule = GaussLegendre::new(12);
        let cuts = [0.0, (1.0 - c).abs() * 0.1, c * 0.1, (1.0 + c) * 0.1];
        let mut cuts = cuts.to_vec();
        cuts.sort_by(f64::total_cmp);
        rule.integrate_panels(|y| kernel([y]) * (1.0 + 0.5 * y), &cuts) - (1.0 + 0.5 * c * 0.1)
    };
    for (c, reflected, cut) in [
        (0.0, 0.375, 0.375),
        (0.25, 0.1714, 0.2411),
        (0.5, 0.0547, 0.1250),
        (0.75, 0.0073, 0.0375),
        (1.0, 0.0, 0.0),
    ] {
        assert!((bias(&Reflect, c) / 0.05 - reflected).abs() < 1e-4, "{c}");
        assert!(
            (bias(&NormaliseTargets, c) / 0.05 - cut).abs() < 1e-4,
            "{c}"
        );
        assert!(bias(&LocalLinear::default(), c).abs() < 1e-14, "{c}");
    }
}

#[test]
fn without_walls_nothing_is_corrected() {
    let grid = Grid::new([-1.0], [4.0], [50]).unwrap();
    let sum = sum(
        &Domain::walled([0.0], [3.0]).unwrap(),
        Shape::Biweight,
        Symmetry::Product,
        0.5,
    );
    let open = Sample::new(
        sum.sample().points().to_vec(),
        sum.sample().weights().clone(),
        Domain::whole(),
    )
    .unwrap();
    let sum = KernelSum::new(open, sum.shape(), sum.bandwidth().clone()).unwrap();
    for boundary in all::<1>() {
        let field = boundary.correct(sum.clone(), &plain).unwrap();
        assert_eq!(
            field.on(&grid).values(),
            sum.on(&grid).values(),
            "{}",
            boundary.name()
        );
    }
}

#[test]
fn varying_widths_are_corrected_or_refused_by_name() {
    let domain = Domain::<1>::unit();
    let fixed = sum(&domain, Shape::Epanechnikov, Symmetry::Product, 0.1);
    let widths: Vec<f64> = (0..60).map(|i| 0.02 + 0.01 * f64::from(i % 9)).collect();
    let sum = KernelSum::new(
        fixed.sample().clone(),
        Shape::Epanechnikov,
        Bandwidth::PerPoint(widths.into()),
    )
    .unwrap();
    for boundary in all::<1>() {
        match boundary.correct(sum.clone(), &plain) {
            Ok(field) => assert!(field.at([0.01]) > 0.0),
            Err(error) => assert!(error.to_string().contains(boundary.name()), "{error}"),
        }
    }
    let wide = KernelSum::new(
        fixed.sample().clone(),
        Shape::Gaussian,
        Bandwidth::Fixed([1e6]),
    )
    .unwrap();
    assert!(
        Reflect
            .correct(wide, &plain)
            .err()
            .unwrap()
            .to_string()
            .contains("wider than the domain")
    );
}

/// At the wall, local linear has the smaller bias and 4.498 / 1.2 of the variance of reflection: it loses as long as (0.375 h f')² < 3.30 f / (n h).
#[test]
fn reflection_and_local_linear_cross_over_where_predicted() {
    let truth = crate::density::TruncatedExponential::new(2.0).unwrap();
    let draws = 2000;
    let error = |boundary: &dyn Boundary<1>, h: f64| {
        let bump = Bump {
            shape: Shape::Epanechnikov,
            symmetry: Symmetry::Product,
            width: [h],
        };
        let moments = corrected_moments(boundary, &bump, &truth, draws, 0.0).unwrap();
        (moments.mean - truth.at([0.0])).powi(2) + moments.variance
    };
    let (mut low, mut high) = (0.01, 0.5);
    assert!(error(&LocalLinear::default(), low) > error(&Reflect, low));
    assert!(error(&LocalLinear::default(), high) < error(&Reflect, high));
    for _ in 0..40 {
        let h = 0.5 * (low + high);
        if error(&LocalLinear::default(), h) > error(&Reflect, h) {
            low = h;
        } else {
            high = h;
        }
    }
    let (f, slope) = (truth.at([0.0]), truth.derivative(1, 0.0));
    let predicted = (3.30 * f / (f64::from(draws as u32) * (0.375 * slope).powi(2))).cbrt();
    assert!((low / predicted - 1.0).abs() < 0.15, "{low} {predicted}");
}

#[test]
fn expectations_of_corrected_estimates_are_those_of_many_samples() {
    use crate::density::Density;
    let truth = crate::density::TruncatedExponential::new(2.0).unwrap();
    let places = [[0.0], [0.03], [0.2], [0.97]];
    let bump = Bump {
        shape: Shape::Epanechnikov,
        symmetry: Symmetry::Product,
        width: [0.15],
    };
    let (draws, replicates) = (100, 4000);
    for boundary in all::<1>() {
        let exact: Option<Vec<_>> = places
            .iter()
            .map(|[x]| corrected_moments(&*boundary, &bump, &truth, draws, *x))
            .collect();
        let Some(exact) = exact else { continue };
        let mut sums = [[0.0; 2]; 4];
        for replicate in 0..replicates {
            let mut random = crate::random::stream(3, "boundary", replicate);
            let points = (0..draws).map(|_| truth.draw(&mut random)).collect();
            let sample = Sample::equal(points, truth.domain().clone()).unwrap();
            let sum = KernelSum::new(sample, bump.shape, Bandwidth::Fixed(bump.width)).unwrap();
            let field = boundary.correct(sum, &plain).unwrap();
            for (sum, x) in sums.iter_mut().zip(places) {
                let value = field.at(x);
                *sum = [sum[0] + value, sum[1] + value * value];
            }
        }
        let n = replicates as f64;
        for (moments, [sum, square]) in exact.iter().zip(sums) {
            let (mean, variance) = (sum / n, square / n - (sum / n).powi(2));
            let z = (mean - moments.mean) / (moments.variance / n).sqrt();
            // 4.1 standard errors: 20 comparisons at a joint level of 1e-3; a fault of 1 % in a value of 2 is 5 to 20 of them
            assert!(z.abs() < 4.1, "{}: z = {z}", boundary.name());
            assert!(
                (variance / moments.variance - 1.0).abs() < 0.12,
                "{}",
                boundary.name()
            );
        }
    }
}

/// Beside an inward corner mirror images of points beyond it are felt from farther than a kernel reaches; across the gap of a U, in the outward corners of the other arm, from farther still.
#[test]
fn mirrors_about_an_inward_corner_are_all_counted() {
    let l = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    let u = [
        [0.0, 0.0],
        [3.0, 0.0],
        [3.0, 2.0],
        [1.7, 2.0],
        [1.7, 0.6],
        [1.3, 0.6],
        [1.3, 2.0],
        [0.0, 2.0],
    ];
    let cases: [(&[Point<2>], f64, Point<2>); 4] = [
        (&l, 0.5, [0.96, 1.38]),
        (&l, 0.5, [1.24, 0.92]),
        (&l, 0.5, [0.9, 0.9]),
        (&u, 0.4, [2.22, 1.97]),
    ];
    for (corners, reach, x) in cases {
        let outline = crate::space::Polygon::new(corners.to_vec()).unwrap();
        let truth = crate::density::Room::new(outline, [0.1, 0.2]).unwrap();
        let truth: &dyn crate::density::Density<2> = &truth;
        let domain = truth.domain();
        let bump = Bump {
            shape: Shape::Epanechnikov,
            symmetry: Symmetry::Radial,
            width: [reach; 2],
        };
        let grid = Grid::new(domain.low(), domain.high(), [800, 800]).unwrap();
        let kernel = Reflect.equivalent(&bump, domain, x).unwrap();
        let felt = |farthest: f64| {
            let near = |y: &Point<2>| (y[0] - x[0]).hypot(y[1] - x[1]) < farthest;
            let terms = grid.centres().filter(near).map(|y| kernel(y) * truth.at(y));
            terms.sum::<f64>() * grid.cell_measure()
        };
        let expected = felt(f64::INFINITY);
        let bivariate = truth.bivariate().unwrap();
        let moments = corrected_moments_in_plane(&Reflect, &bump, bivariate, 10.0, x).unwrap();
        assert!(
            (moments.mean / expected - 1.0).abs() < 3e-3,
            "{x:?}: {} {expected}",
            moments.mean
        );
        if corners.len() == 8 {
            // the planted fault: three reaches are enough for edges, not for corners
            let fewer = felt(3.0 * reach);
            assert!(fewer < 0.99 * expected, "{fewer} {expected}");
        }
    }
}
