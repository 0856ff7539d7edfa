//! Optima and rates that are known.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::density::{named, named_in_plane};
use crate::kernel::{Shape, Symmetry};

fn slope(least: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    (least(high) / least(low)).ln() / (high / low).ln()
}

/// Exact slopes of the least MISE in the plane, over sizes that one has and at one that nobody has; the limit is -2/3, approached from above.
#[test]
fn errors_in_the_plane_fall_as_theory_says() {
    let truth = named_in_plane("normal-2d").unwrap();
    let errors = PlaneKernelError::new(&*truth, Shape::Gaussian, Symmetry::Product).unwrap();
    let least = |n: f64| errors.optimum(n).error.mise();
    let usual = slope(least, 1e3, 1e5);
    assert!((usual + 0.647).abs() < 1e-3, "{usual}");
    let far = slope(least, 0.9e8, 1.1e8);
    assert!((far + 0.6658).abs() < 5e-4, "{far}");
    let farther = slope(least, 0.9e10, 1.1e10);
    assert!(-2.0 / 3.0 < farther && farther < far, "{farther}");
}

/// The variance falls like 1/(n h) on a line and 1/(n h²) in the plane, where the kernel is narrow. [Wand & Jones 1995, sections 2.5 and 4.3]
#[test]
fn variances_fall_with_the_bandwidth_as_theory_says() {
    let line = named("normal").unwrap();
    let plane = named_in_plane("normal-2d").unwrap();
    let on_line = |h: f64| kernel_moments(&*line, Shape::Biweight, h, 100.0, 0.4).variance;
    let in_plane = |h: f64| {
        let (shape, symmetry) = (Shape::Biweight, Symmetry::Radial);
        plane_kernel_moments(&*plane, shape, symmetry, [h, h], 100.0, [0.4, 0.2]).variance
    };
    assert!((slope(on_line, 1e-4, 2e-4) + 1.0).abs() < 1e-3);
    assert!((slope(in_plane, 1e-3, 2e-3) + 2.0).abs() < 1e-3);
    let bias = |h: f64| {
        let (shape, symmetry) = (Shape::Biweight, Symmetry::Radial);
        let place = [0.4, 0.2];
        let m = plane_kernel_moments(&*plane, shape, symmetry, [h, h], 100.0, place);
        (m.mean - plane.at(place)).abs()
    };
    let found = slope(bias, 0.02, 0.04);
    assert!((found - 2.0).abs() < 0.01, "{found}");
}

/// The best bandwidth at a place nears its leading terms, and at a point of inflection there is none.
#[test]
fn the_best_bandwidth_at_a_place_is_that_of_its_curvature() {
    let normal = named("normal").unwrap();
    let at = |n: f64, x: f64| {
        Family::Kernel(Shape::Gaussian)
            .best_at::<1>(&*normal, n, [x])
            .unwrap()
    };
    let n = 1e9;
    let local = at(n, 0.0);
    // f R(K)/(n f''²) with f'' = -f at 0
    let known = (0.5 / std::f64::consts::PI.sqrt() / n / normal.at([0.0])).powf(0.2);
    assert!((local.asymptotic / known - 1.0).abs() < 1e-12);
    assert!((local.at / known - 1.0).abs() < 0.01, "{local:?} {known}");
    // half the bias² is a fifth of the error: the balance of h⁴ and 1/h
    let ratio = local.bias.powi(2) / local.variance;
    assert!((ratio - 0.25).abs() < 0.01, "{ratio}");
    let inflected = at(n, 1.0);
    assert!(inflected.asymptotic.is_infinite() && inflected.at > 2.0 * local.at);
    let plane = named_in_plane("normal-2d").unwrap();
    let family = Family::RadialKernel(Shape::Epanechnikov);
    let local = family.best_at::<2>(&*plane, 1e8, [0.0, 0.0]).unwrap();
    assert!(
        (local.at / local.asymptotic - 1.0).abs() < 0.02,
        "{local:?}"
    );
}

/// k⁵ = 144 n⁴ f⁶/f''² and k³ = 32π² n² f⁴/(Δf)² are what the exact error chooses for large samples. [Mack & Rosenblatt 1979]
#[test]
fn the_best_number_of_neighbours_is_that_of_the_curvature() {
    let normal = named("normal").unwrap();
    let family = Family::Neighbour(Convention::Unbiased);
    let local = family.best_at::<1>(&*normal, 1e6, [0.0]).unwrap();
    assert!(
        (local.at / local.asymptotic - 1.0).abs() < 0.05,
        "{local:?}"
    );
    let plane = named_in_plane("normal-2d").unwrap();
    let local = family.best_at::<2>(&*plane, 1e5, [0.0, 0.0]).unwrap();
    assert!((local.at / local.asymptotic - 1.0).abs() < 0.1, "{local:?}");
}

/// The best member is the best: its neighbours have larger errors, and the error is what is integrated from place to place.
#[test]
fn families_know_their_best_member() {
    let bimodal = named("bimodal").unwrap();
    let draws = 300.0;
    let ([low], [high]) = bimodal.bulk(1e-9);
    let series = |system| Family::Series {
        system,
        place: [Some(-4.0), Some(4.0)],
        taper: Taper::None,
    };
    for (family, step) in [
        (Family::Kernel(Shape::Biweight), 0.0),
        (Family::Neighbour(Convention::Unbiased), 1.0),
        (series(System::Cosine), 1.0),
        (series(System::Legendre), 1.0),
    ] {
        let errors = family.errors(&*bimodal).unwrap();
        let best = errors.optimum(draws);
        assert!(
            (errors.at(best.at, draws).unwrap().mise() / best.error.mise() - 1.0).abs() < 1e-12
        );
        for side in [-1.0, 1.0] {
            let other = if step == 0.0 {
                best.at * (1.0 + 0.02 * side)
            } else {
                best.at + step * side
            };
            let worse = errors.at(other, draws).unwrap().mise();
            assert!(worse >= best.error.mise(), "{family:?} {side}");
        }
    }
    // of neighbours, from place to place: the tails beyond have a little more
    let errors = Family::Neighbour(Convention::Raw)
        .errors(&*bimodal)
        .unwrap();
    let whole = errors.at(40.0, draws).unwrap();
    let moments =
        |x: f64| neighbour_moments::<1>(&*bimodal, 40, Convention::Raw, 300, &[[x]]).unwrap()[0];
    let over = |from: f64, to: f64| {
        let cuts = (0..60).map(|i| from + (to - from) * f64::from(i) / 60.0);
        integrate_over(&*bimodal, [from, to], cuts, moments).absolute
    };
    let inner = over(low, high);
    assert!(
        (inner.variance / whole.variance - 1.0).abs() < 0.03,
        "{inner:?} {whole:?}"
    );
    let wide = over(-40.0, 40.0);
    let share = 40.0_f64 / 300.0;
    let rest = 0.5 * share * share / 40.0;
    let total = wide.squared_bias + rest;
    assert!(
        (total / whole.squared_bias - 1.0).abs() < 0.01,
        "{total} {whole:?}"
    );
}

/// Square bins in the plane: the asymptotic width h⁴ = 12/(n ∫|∇f|²), near the exact best for large samples. [Scott 1992, section 3.4]
#[test]
fn bins_of_the_plane_have_a_best_width() {
    let plane = named_in_plane("normal-2d").unwrap();
    let family = Family::SquareHistogram {
        origin: [0.0; 2],
        degrees: 0.0,
    };
    let n = 1e6;
    let best = family.errors_in_plane(&*plane).unwrap().optimum(n);
    let leading = family.asymptotic_in_plane(&*plane, n).unwrap();
    // ∫|∇f|² = 1/(4π) for N(0, I)
    let known = (12.0 * 4.0 * std::f64::consts::PI / n).powf(0.25);
    assert!((leading.best() / known - 1.0).abs() < 1e-10);
    assert!((best.at / known - 1.0).abs() < 0.03, "{best:?} {known}");
    assert!(
        (best.error.mise() / leading.at(known).mise() - 1.0).abs() < 0.05,
        "{best:?}"
    );
}

/// Whether a family has errors is known without making them.
#[test]
fn families_have_errors_where_they_say_so() {
    let series = |system, place| Family::Series {
        system,
        place,
        taper: Taper::None,
    };
    let law = WidthLaw {
        exponent: 0.5,
        clip: 0.1,
    };
    let adaptive = |law| Family::Adaptive {
        shape: Shape::Gaussian,
        symmetry: Symmetry::Product,
        law,
        pilot: FixedPilot::Truth,
    };
    let families = [
        Family::Kernel(Shape::Gaussian),
        Family::Kernel(Shape::Epanechnikov),
        Family::RadialKernel(Shape::Biweight),
        Family::ShiftedHistogram {
            shifts: 3,
            origin: 0.1,
        },
        Family::SquareHistogram {
            origin: [0.1; 2],
            degrees: 20.0,
        },
        Family::FrequencyPolygon { origin: 0.1 },
        Family::Neighbour(Convention::MeanRadius),
        adaptive(law),
        adaptive(WidthLaw { clip: 0.0, ..law }),
        series(System::Cosine, [None; 2]),
        series(System::Cosine, [Some(0.0), Some(1.0)]),
        series(System::Fourier, [Some(0.0), None]),
        series(System::Hermite, [None; 2]),
    ];
    let mut seen = [0; 2];
    for family in families {
        for name in ["normal", "uniform", "exponential", "claw"] {
            let truth = named(name).unwrap();
            let has = family.has_errors::<1>(&*truth);
            assert_eq!(has, family.errors(&*truth).is_some(), "{family:?} {name}");
            seen[usize::from(has)] += 1;
        }
        for name in ["normal-2d", "uniform-2d", "triangle", "mix"] {
            let truth = named_in_plane(name).unwrap();
            let has = family.has_errors::<2>(&*truth);
            let made = family.errors_in_plane(&*truth).is_some();
            assert_eq!(has, made, "{family:?} {name}");
            seen[usize::from(has)] += 1;
        }
    }
    assert!(seen[0] > 20 && seen[1] > 20, "{seen:?}");
}
