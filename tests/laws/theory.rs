//! The exact error theory: against published numbers, against itself by other routes, and against chance.

use crate::chance::{holm, two_sided};
use density_lab::density::{self, Density, Univariate};
use density_lab::kernel::{Kernel, Shape};
use density_lab::parameter::{Value, Values};
use density_lab::random::stream;
use density_lab::theory::{
    HistogramError, Integrated, KernelError, Moments, NoAsymptotics, histogram_moments,
    integrate_over, kernel_cuts, kernel_moments, polygon_moments, shifted_histogram_moments,
};
use rayon::prelude::*;
use std::sync::Arc;

fn named(name: &str) -> Arc<dyn Univariate> {
    density::named(name).unwrap()
}

fn beta(a: f64, b: f64) -> Arc<dyn Univariate> {
    let mut values = Values::default();
    values.set("a", Value::Number(a));
    values.set("b", Value::Number(b));
    density::entry("beta")
        .unwrap()
        .build(&values)
        .unwrap()
        .line()
        .unwrap()
}

fn gaussian(name: &str) -> KernelError {
    KernelError::new(&*named(name), Shape::Gaussian)
}

fn near(got: f64, expected: f64, relative: f64) -> bool {
    (got / expected - 1.0).abs() < relative
}

/// Agreement to as many significant digits as are given.
fn digits(got: f64, expected: f64, significant: i32) -> bool {
    let unit = 10f64.powi(expected.abs().log10().floor() as i32 + 1 - significant);
    (got - expected).abs() <= 0.5001 * unit
}

/// Bandwidth and MISE at the optimum, to the digits that were published or computed independently of this program.
#[test]
fn optima_agree_with_known_values_to_four_digits() {
    for (name, draws, h, mise) in [
        ("normal", 1e2, 0.4455, 5.410e-3),
        ("normal", 1e3, 0.2723, 1.030e-3),
        ("normal", 1e4, 0.1695, 1.808e-4),
        ("normal", 1e5, 0.1063, 3.039e-5),
        ("bimodal", 2e2, 0.3217, 4.570e-3),
        ("bimodal", 1e3, 0.2208, 1.397e-3),
        ("bimodal", 1e4, 0.1349, 2.399e-4),
        ("claw", 1e3, 0.0516, 6.668e-3),
    ] {
        let best = gaussian(name).optimum(draws);
        assert!(
            (best.at - h).abs() < 1.0e-4,
            "{name} {draws}: h = {}",
            best.at
        );
        assert!(
            digits(best.error.mise(), mise, 4),
            "{name} {draws}: {:?}",
            best.error
        );
        assert!(best.others.is_empty(), "{name} {draws}: {:?}", best.others);
    }
}

#[test]
fn the_bimodal_density_is_under_well_and_over_smoothed() {
    let errors = gaussian("bimodal");
    let least = errors.optimum(200.0).error.mise();
    for (h, ratio, squared_bias, variance) in [
        (0.1, 2.84, 2e-5, 0.0129),
        (0.3, 1.01, 0.00102, 0.00359),
        (0.6, 1.94, 0.00754, 0.00134),
    ] {
        let error = errors.at(h, 200.0);
        assert!(
            digits(error.mise() / least, ratio, 3),
            "h = {h}: {}",
            error.mise() / least
        );
        assert!(digits(error.variance, variance, 3), "h = {h}: {error:?}");
        assert!(
            digits(
                error.squared_bias,
                squared_bias,
                if h < 0.2 { 1 } else { 3 }
            ),
            "h = {h}: {error:?}"
        );
    }
    // what a variance estimate alone would not see
    let best = errors.optimum(1000.0).at;
    for (times, ratio) in [(1.0, 1.33), (2.0, 9.1), (4.0, 117.0)] {
        let error = errors.at(times * best, 1000.0);
        assert!(
            near(error.mise() / error.variance, ratio, 0.006),
            "{times}: {}",
            error.mise() / error.variance
        );
    }
}

#[test]
fn the_claw_with_fifty_points_has_two_minima() {
    let best = gaussian("claw").optimum(50.0);
    assert!(
        (best.at - 0.403).abs() < 0.001 && best.others.len() == 1,
        "{best:?}"
    );
    assert!((best.others[0].at - 0.131).abs() < 0.001, "{best:?}");
    assert!(best.others[0].value > best.error.mise());
    // a little later the fingers win
    let later = gaussian("claw").optimum(100.0);
    assert!(later.at < 0.15, "{later:?}");
}

/// All fifteen and a mixture of very different scales, seven decades of bandwidth.
#[test]
fn quadrature_is_the_closed_form() {
    let mut worst = (0.0, 0.0);
    for number in 1..=15 {
        let truth = density::marron_wand(number).unwrap();
        let closed = KernelError::new(&truth, Shape::Gaussian);
        let quadrature = KernelError::by_quadrature(&truth, Shape::Gaussian);
        for i in -16..=8 {
            let h = 10f64.powf(f64::from(i) / 4.0);
            let (a, b) = (closed.at(h, 1e3), quadrature.at(h, 1e3));
            let bias = (a.squared_bias / b.squared_bias - 1.0).abs();
            let variance = (a.variance - b.variance).abs() / a.mise();
            let mise = (a.mise() / b.mise() - 1.0).abs();
            assert!(
                mise < 1e-10 && variance < 1e-10,
                "mw-{number} h = {h}: {a:?} {b:?}"
            );
            assert!(bias < 1e-7, "mw-{number} h = {h}: {a:?} {b:?}");
            worst = (f64::max(worst.0, mise), f64::max(worst.1, bias));
        }
    }
    println!(
        "worst relative difference: MISE {:.1e}, bias² {:.1e}",
        worst.0, worst.1
    );
}

/// The same integrals by another route: pointwise moments, integrated over all places that the estimate reaches.
#[test]
fn integrals_of_pointwise_moments_are_the_integrated_errors() {
    let truths: Vec<(String, Arc<dyn Univariate>)> = density::entries()
        .filter(|entry| entry.dimensions() == 1 && entry.stands_alone())
        .map(|entry| (entry.names[0].to_owned(), named(entry.names[0])))
        .chain([
            ("beta 1.5 2.75".to_owned(), beta(1.5, 2.75)),
            ("beta 1 3".to_owned(), beta(1.0, 3.0)),
        ])
        .collect();
    truths
        .par_iter()
        .enumerate()
        .for_each(|(number, (name, truth))| {
            for (i, shape) in Shape::ALL.into_iter().enumerate() {
                let smooth = truth.normal_components().is_some();
                // for mixtures three of the kernels in turn; the other densities have all
                if smooth && (i + number) % 7 > 2 {
                    continue;
                }
                let errors = KernelError::new(&**truth, shape);
                for share in [0.05, 0.9] {
                    let h = share * truth.mean_and_deviation().1;
                    let ([low], [high]) = truth.bulk(1e-18);
                    let reach = shape.reach().min(9.0) * h;
                    let cuts = kernel_cuts(&**truth, shape, h);
                    let over = integrate_over(&**truth, [low - reach, high + reach], cuts, |x| {
                        kernel_moments(&**truth, shape, h, 200.0, x)
                    });
                    let whole = errors.at(h, 200.0);
                    let slack = 1e-9;
                    assert!(
                        near(over.absolute.mise(), whole.mise(), slack),
                        "{name} {shape} h = {h}: {over:?} {whole:?}"
                    );
                    assert!(
                        near(over.absolute.squared_bias, whole.squared_bias, 1e-6),
                        "{name} {shape} h = {h}: {over:?} {whole:?}"
                    );
                }
            }
        });
}

/// What one point at `place` contributes to an estimate at `x`: every linear estimator is the mean of this over its sample, and written here as in
/// its definition, with no code of the theory.
type Weight = Box<dyn Fn(f64, f64) -> f64 + Sync>;

/// The moments that theory gives an estimate at a place.
type Theory = Box<dyn Fn(&dyn Density<1>, f64) -> Moments + Sync>;

struct Case {
    truth: Arc<dyn Univariate>,
    places: [f64; 3],
    weight: Weight,
    theory: Theory,
}

const REPLICATES: usize = 400_000;
const DRAWS: usize = 5;

fn cases() -> Vec<Case> {
    let bin = |origin: f64, width: f64, x: f64| ((x - origin) / width).floor();
    let histogram = move |origin: f64, width: f64, x: f64, place: f64| {
        if bin(origin, width, x) == bin(origin, width, place) {
            1.0 / width
        } else {
            0.0
        }
    };
    let truths = [
        "skewed-bimodal",
        "uniform",
        "exponential",
        "truncated-exponential",
        "half-normal",
        "beta",
        "ramp-down",
    ];
    let kernels = Shape::ALL.into_iter().zip(truths).map(|(shape, name)| {
        let h = 0.4;
        Case {
            truth: named(name),
            places: [0.0, 0.3, 1.1],
            weight: Box::new(move |x, place| shape.value((x - place) / h) / h),
            theory: Box::new(move |truth, x| kernel_moments(truth, shape, h, DRAWS as f64, x)),
        }
    });
    let (width, origin) = (0.5, 0.1);
    let binned = [
        Case {
            truth: named("bimodal"),
            places: [-0.9, 0.3, 1.6],
            weight: Box::new(move |x, place| histogram(origin, width, x, place)),
            theory: Box::new(move |truth, x| {
                histogram_moments(truth, width, origin, DRAWS as f64, x)
            }),
        },
        Case {
            truth: named("exponential"),
            places: [0.05, 0.3, 1.6],
            weight: Box::new(move |x, place| {
                (0..4)
                    .map(|j| histogram(origin + width * f64::from(j) / 4.0, width, x, place))
                    .sum::<f64>()
                    / 4.0
            }),
            theory: Box::new(move |truth, x| {
                shifted_histogram_moments(truth, width, 4, origin, DRAWS as f64, x)
            }),
        },
        Case {
            truth: named("skewed-bimodal"),
            places: [-0.9, 0.34, 1.6],
            weight: Box::new(move |x, place| {
                let left = bin(origin + 0.5 * width, width, x);
                let part = (x - origin - 0.5 * width) / width - left;
                let centre = |k: f64| origin + (k + 0.5) * width;
                (1.0 - part) * histogram(origin, width, centre(left), place)
                    + part * histogram(origin, width, centre(left + 1.0), place)
            }),
            theory: Box::new(move |truth, x| {
                polygon_moments(truth, width, origin, DRAWS as f64, x)
            }),
        },
    ];
    kernels.chain(binned).collect()
}

/// The z of the mean and of the variance at each place of a case; and what they would be if theory were off by 2 %.
fn scores(number: usize, case: &Case) -> [[f64; 4]; 3] {
    let mut random = stream(1986, "theory against simulation", number as u64);
    let samples: Vec<[f64; DRAWS]> = (0..REPLICATES)
        .map(|_| std::array::from_fn(|_| case.truth.draw(&mut random)[0]))
        .collect();
    case.places.map(|x| {
        let estimate = |sample: &[f64; DRAWS]| {
            sample
                .iter()
                .map(|&place| (case.weight)(x, place))
                .sum::<f64>()
                / DRAWS as f64
        };
        let values: Vec<f64> = samples.iter().map(estimate).collect();
        let n = REPLICATES as f64;
        let mean = values.iter().sum::<f64>() / n;
        let central = |k: i32| values.iter().map(|v| (v - mean).powi(k)).sum::<f64>() / n;
        let (second, fourth) = (central(2), central(4));
        let spreads = ((second / n).sqrt(), ((fourth - second * second) / n).sqrt());
        let expected = (case.theory)(&*case.truth, x);
        [
            (mean - expected.mean) / spreads.0,
            (second - expected.variance) / spreads.1,
            (mean - 1.02 * expected.mean) / spreads.0,
            (second - 1.02 * expected.variance) / spreads.1,
        ]
    })
}

#[test]
fn moments_agree_with_simulation_and_two_percent_of_fault_is_seen() {
    let scores: Vec<[f64; 4]> = cases()
        .par_iter()
        .enumerate()
        .flat_map_iter(|(number, case)| scores(number, case))
        .collect();
    let pick = |which: [usize; 2]| -> Vec<f64> {
        scores
            .iter()
            .flat_map(|z| which.map(|i| two_sided(z[i])))
            .collect()
    };
    assert!(!holm(&pick([0, 1]), 1e-3).contains(&true), "{scores:?}");
    let caught = holm(&pick([2, 3]), 1e-3);
    let unseen = caught.iter().filter(|&&caught| !caught).count();
    assert!(
        unseen <= 2,
        "{unseen} of {} faults unseen: {scores:?}",
        caught.len()
    );
}

/// On a flat density every kernel has exactly the mean 1 away from the walls, half of it on them, and a variance known on paper.
#[test]
fn a_flat_density_has_errors_known_on_paper() {
    let flat = named("uniform");
    for shape in Shape::ALL {
        let h = if shape == Shape::Gaussian { 0.02 } else { 0.1 };
        let inside = integrate_over(&*flat, [0.3, 0.7], [], |x| {
            kernel_moments(&*flat, shape, h, 50.0, x)
        });
        let variance = 0.4 * (shape.roughness() / h - 1.0) / 50.0;
        assert!(near(inside.absolute.variance, variance, 1e-12), "{shape}");
        assert!(inside.absolute.squared_bias < 1e-24, "{shape}");
        // f = 1: absolute and relative errors are the same
        assert!(near(inside.relative.mise(), variance, 1e-12), "{shape}");
        assert!(
            (kernel_moments(&*flat, shape, h, 50.0, 0.0).mean - 0.5).abs() < 1e-12,
            "{shape}"
        );
    }
    // naive estimator: the bias is ∓(1 - u)/2 within h of a wall, inside and outside: ∫ = 4 h/12
    let naive = KernelError::new(&*flat, Shape::Uniform).at(0.1, 1e6);
    assert!(near(naive.squared_bias, 0.1 / 3.0, 1e-12), "{naive:?}");
    let exact = HistogramError::new(&*flat, 0.0).at(0.25, 100.0);
    assert!(exact.squared_bias < 1e-15 && near(exact.variance, 0.75 / 25.0, 1e-13));
}

#[test]
fn kernels_differ_by_their_efficiency() {
    let truth = named("normal");
    let least = |shape| KernelError::new(&*truth, shape).optimum(1e5).error.mise();
    let best = least(Shape::Epanechnikov);
    for shape in Shape::ALL {
        let expected = shape.efficiency().powf(-0.8);
        assert!(
            near(least(shape) / best, expected, 0.01),
            "{shape}: {} {expected}",
            least(shape) / best
        );
    }
}

#[test]
fn asymptotics_overstate_the_error_of_small_samples() {
    let errors = gaussian("normal");
    for (draws, over) in [(1e3, 1.29), (1e4, 1.16)] {
        let best = errors.optimum(draws);
        let leading = errors.asymptotic(draws).unwrap().at(best.at).mise();
        assert!(
            (leading / best.error.mise() - over).abs() < 0.006,
            "{}",
            leading / best.error.mise()
        );
    }
    // 1.25 C(K) (R(f'')/n⁴)^(1/5), and (4/3)^(1/5) σ n^(-1/5) for the normal
    for shape in Shape::ALL {
        let truth = named("mw-8");
        let leading = KernelError::new(&*truth, shape).asymptotic(1e4).unwrap();
        let expected = 1.25 * shape.constant() * (truth.roughness(2) / 1e16).powf(0.2);
        assert!(
            near(leading.at(leading.best()).mise(), expected, 1e-12),
            "{shape}"
        );
    }
    let silverman = errors.asymptotic(1e3).unwrap().best();
    assert!(near(
        silverman,
        (4.0f64 / 3.0).powf(0.2) * 1e3f64.powf(-0.2),
        1e-12
    ));
    // in the limit they are right
    let many = errors.optimum(1e12);
    assert!(near(
        errors.asymptotic(1e12).unwrap().at(many.at).mise(),
        many.error.mise(),
        5e-3
    ));
}

#[test]
fn rates_for_finite_samples_are_the_published_ones() {
    let slope = |low: f64, high: f64, least: &dyn Fn(f64) -> f64| {
        (least(high) / least(low)).ln() / (high / low).ln()
    };
    for (name, expected) in [("normal", -0.765), ("bimodal", -0.773), ("claw", -0.784)] {
        let errors = gaussian(name);
        let got = slope(1e3, 1e5, &|draws| errors.optimum(draws).error.mise());
        assert!((got - expected).abs() < 1e-3, "{name}: {got}");
    }
    let errors = gaussian("normal");
    let got = slope(0.9e6, 1.1e6, &|draws| errors.optimum(draws).error.mise());
    assert!((got + 0.788).abs() < 1e-3, "{got}");
    for (name, expected) in [("normal", -0.655), ("bimodal", -0.656)] {
        let truth = named(name);
        let errors = HistogramError::new(&*truth, 0.0);
        let got = slope(1e3, 1e5, &|draws| errors.optimum(draws).error.mise());
        assert!((got - expected).abs() < 5e-3, "histogram, {name}: {got}");
    }
}

#[test]
fn histograms_have_the_error_of_their_bins() {
    for name in [
        "normal",
        "claw",
        "smooth-comb",
        "exponential",
        "ramp-up",
        "beta",
    ] {
        let truth = named(name);
        let deviation = truth.mean_and_deviation().1;
        for (width, origin) in [(0.3 * deviation, 0.05), (1.7 * deviation, -0.4)] {
            let ([low], [high]) = truth.bulk(1e-18);
            let (first, last) = (
                ((low - origin) / width).floor(),
                ((high - origin) / width).ceil(),
            );
            let edges: Vec<f64> = (first as i64..=last as i64)
                .map(|k| (k as f64).mul_add(width, origin))
                .collect();
            let ends = [edges[0], edges[edges.len() - 1]];
            let over = integrate_over(&*truth, ends, edges.iter().copied(), |x| {
                histogram_moments(&*truth, width, origin, 70.0, x)
            });
            let exact = HistogramError::new(&*truth, origin).at(width, 70.0);
            assert!(
                near(exact.squared_bias, over.absolute.squared_bias, 1e-9),
                "{name}: {exact:?} {over:?}"
            );
            assert!(
                near(exact.variance, over.absolute.variance, 1e-11),
                "{name}: {exact:?} {over:?}"
            );
        }
    }
    // 0.8255 R(f')^(1/3) n^(-2/3) at (6/(n R(f')))^(1/3)
    let truth = named("bimodal");
    let leading = HistogramError::new(&*truth, 0.0).asymptotic(1e3).unwrap();
    assert!(near(
        leading.best(),
        (6.0 / (1e3 * truth.roughness(1))).cbrt(),
        1e-12
    ));
    assert!(near(
        leading.at(leading.best()).mise(),
        0.825_5 * truth.roughness(1).cbrt() * 0.01,
        1e-4
    ));
}

/// Shifted histograms and polygons: by the integrals of their moments, and by their asymptotics.
#[test]
fn relatives_of_the_histogram_have_the_error_of_their_bins() {
    for name in ["normal", "claw", "exponential", "beta", "uniform"] {
        let truth = named(name);
        let deviation = truth.mean_and_deviation().1;
        for (width, origin) in [(0.3 * deviation, 0.05), (1.7 * deviation, -0.4)] {
            let ([low], [high]) = truth.bulk(1e-18);
            let places = |step: f64, offset: f64| -> Vec<f64> {
                let (first, last) = ((low - origin) / step - 8.0, (high - origin) / step + 8.0);
                (first as i64..=last as i64)
                    .map(|k| (k as f64 + offset).mul_add(step, origin))
                    .collect()
            };
            for shifts in [2, 5] {
                let cuts = places(width / f64::from(shifts), 0.0);
                let ends = [cuts[0], cuts[cuts.len() - 1]];
                let over = integrate_over(&*truth, ends, cuts, |x| {
                    shifted_histogram_moments(&*truth, width, shifts, origin, 70.0, x)
                });
                let exact = HistogramError::shifted(&*truth, origin, shifts).at(width, 70.0);
                assert!(
                    near(exact.squared_bias, over.absolute.squared_bias, 1e-9),
                    "{name} {shifts}: {exact:?} {over:?}"
                );
                assert!(
                    near(exact.variance, over.absolute.variance, 1e-11),
                    "{name} {shifts}: {exact:?} {over:?}"
                );
            }
            let cuts = places(width, 0.5);
            let ends = [cuts[0], cuts[cuts.len() - 1]];
            let over = integrate_over(&*truth, ends, cuts, |x| {
                polygon_moments(&*truth, width, origin, 70.0, x)
            });
            let exact = HistogramError::polygon(&*truth, origin).at(width, 70.0);
            assert!(
                near(exact.squared_bias, over.absolute.squared_bias, 1e-9),
                "{name}: {exact:?} {over:?}"
            );
            assert!(
                near(exact.variance, over.absolute.variance, 1e-11),
                "{name}: {exact:?} {over:?}"
            );
        }
    }
    // for large samples the leading terms are all there is
    let truth = named("bimodal");
    for errors in [
        HistogramError::new(&*truth, 0.1),
        HistogramError::shifted(&*truth, 0.1, 2),
        HistogramError::shifted(&*truth, 0.1, 8),
        HistogramError::polygon(&*truth, 0.1),
    ] {
        let draws = 1e9;
        let (leading, best) = (errors.asymptotic(draws).unwrap(), errors.optimum(draws));
        assert!(
            near(leading.best(), best.at, 0.01),
            "{} {best:?}",
            leading.best()
        );
        assert!(
            near(leading.at(leading.best()).mise(), best.error.mise(), 0.01),
            "{leading:?} {best:?}"
        );
        // the least is a least
        for other in [0.99, 1.01] {
            assert!(leading.at(other * leading.best()).mise() > leading.at(leading.best()).mise());
        }
    }
}

#[test]
fn many_shifts_tend_to_the_triangular_kernel_and_one_is_a_histogram() {
    let truth = named("skewed-bimodal");
    for x in [-1.0, 0.2, 1.5] {
        let kernel = kernel_moments(&*truth, Shape::Triangular, 0.6, 30.0, x);
        let shifted = |shifts| shifted_histogram_moments(&*truth, 0.6, shifts, 0.1, 30.0, x);
        let far = |m: Moments| {
            (m.mean - kernel.mean).abs() / kernel.mean
                + (m.variance - kernel.variance).abs() / kernel.variance
        };
        assert!(
            far(shifted(256)) < 0.02 && far(shifted(256)) < 0.05 * far(shifted(4)).max(1e-3) + 0.01,
            "{x}"
        );
        assert_eq!(shifted(1), histogram_moments(&*truth, 0.6, 0.1, 30.0, x));
    }
}

#[test]
fn without_curvature_there_are_no_asymptotics_and_the_reason_is_given() {
    for name in [
        "uniform",
        "ramp-up",
        "ramp-down",
        "exponential",
        "truncated-exponential",
        "half-normal",
        "beta",
    ] {
        let truth = named(name);
        let error = KernelError::new(&*truth, Shape::Biweight)
            .asymptotic(100.0)
            .unwrap_err();
        assert_eq!(error, NoAsymptotics::Curvature);
        assert!(error.to_string().contains("R(f'') is infinite"));
        assert!(
            HistogramError::polygon(&*truth, 0.0)
                .asymptotic(100.0)
                .is_err(),
            "{name}"
        );
        let slope = HistogramError::new(&*truth, 0.0).asymptotic(100.0).err();
        assert_eq!(
            slope,
            (name != "beta").then_some(NoAsymptotics::Slope),
            "{name}"
        );
        // the exact optimum exists all the same
        let best = KernelError::new(&*truth, Shape::Biweight).optimum(100.0);
        assert!(
            best.at > 0.0 && best.error.mise() < truth.roughness(0),
            "{name}"
        );
    }
    assert!(
        KernelError::new(&*beta(3.0, 3.5), Shape::Biweight)
            .asymptotic(100.0)
            .is_ok()
    );
}

/// At a jump the best bandwidth falls as n^(-1/2) and the error with it; the search must follow.
#[test]
fn optima_are_found_for_any_sample_size() {
    let flat = named("uniform");
    let errors = KernelError::new(&*flat, Shape::Uniform);
    // bias² = h/3, variance ≈ 1/(2 n h)
    let best = errors.optimum(1e12);
    assert!(near(best.at, 1.5f64.sqrt() * 1e-6, 1e-3), "{best:?}");
    let smooth = gaussian("normal").optimum(1e14);
    assert!(
        near(smooth.at, 1.0592 * 1e14f64.powf(-0.2), 0.01),
        "{smooth:?}"
    );
    for name in ["normal", "smooth-comb", "exponential"] {
        let one = KernelError::new(&*named(name), Shape::Epanechnikov).optimum(1.0);
        assert!(
            one.at.is_finite() && one.error.mise() < named(name).roughness(0),
            "{name}: {one:?}"
        );
    }
}

#[test]
fn errors_scale_with_the_density_and_with_the_sample() {
    let stretched = |by: f64| {
        let parts = density::marron_wand(8)
            .unwrap()
            .normal_components()
            .unwrap()
            .iter()
            .map(|part| density::NormalComponent {
                mean: part.mean * by + 3.0 * by,
                deviation: part.deviation * by,
                ..*part
            })
            .collect();
        density::NormalMixture::new(parts).unwrap()
    };
    for by in [1e-30, 1e-6, 1e6, 1e30] {
        for shape in [Shape::Gaussian, Shape::Triweight] {
            let (one, other) = (
                KernelError::new(&stretched(1.0), shape),
                KernelError::new(&stretched(by), shape),
            );
            assert!(
                near(
                    one.at(0.2, 90.0).mise(),
                    other.at(0.2 * by, 90.0).mise() * by,
                    1e-11
                ),
                "{shape} {by}"
            );
            assert!(
                near(one.optimum(90.0).at, other.optimum(90.0).at / by, 1e-6),
                "{shape} {by}"
            );
        }
    }
    // a weighted sample counts as its effective size
    let errors = gaussian("normal");
    let (few, many) = (errors.at(0.3, 12.5), errors.at(0.3, 125.0));
    assert!(near(few.variance, 10.0 * many.variance, 1e-14));
    assert_eq!(few.squared_bias, many.squared_bias);
    let at = |draws| kernel_moments(&*named("normal"), Shape::Biweight, 0.3, draws, 0.4);
    assert!(near(at(12.5).variance, 10.0 * at(125.0).variance, 1e-14));
}

#[test]
fn limits_of_the_bandwidth() {
    for name in ["discrete-comb", "smooth-comb", "half-normal"] {
        let truth = named(name);
        for shape in Shape::ALL {
            let errors = KernelError::new(&*truth, shape);
            let narrow = errors.at(1e-9, 100.0);
            assert!(
                near(narrow.variance, shape.roughness() / 1e-7, 1e-6),
                "{name} {shape}: {narrow:?}"
            );
            let wide = errors.at(1e9, 100.0);
            assert!(
                near(wide.squared_bias, truth.roughness(0), 1e-6),
                "{name} {shape}: {wide:?}"
            );
            assert!(wide.variance.abs() < 1e-9, "{name} {shape}: {wide:?}");
            let far = kernel_moments(&*truth, shape, 0.1, 100.0, 1e12);
            assert_eq!(
                far,
                Moments {
                    mean: 0.0,
                    variance: 0.0
                }
            );
        }
    }
}

/// Leading terms at a place: |bias| ~ h² k₂ f''/2, variance ~ f R(K)/(n h); at an inflection the bias is of fourth order.
#[test]
fn bias_and_variance_have_their_orders() {
    let truth = named("normal");
    let slope = |x: f64| {
        let bias = |h: f64| {
            (kernel_moments(&*truth, Shape::Gaussian, h, 100.0, x).mean - truth.at([x])).abs()
        };
        (bias(0.04) / bias(0.02)).log2()
    };
    assert!((slope(0.0) - 2.0).abs() < 0.01, "{}", slope(0.0));
    assert!((slope(1.0) - 4.0).abs() < 0.01, "{}", slope(1.0));
    for shape in Shape::ALL {
        let Moments { mean, variance } = kernel_moments(&*truth, shape, 1e-3, 100.0, 0.3);
        let bias = 0.5e-6 * shape.variance() * truth.derivative(2, 0.3);
        assert!(near(mean - truth.at([0.3]), bias, 1e-4), "{shape}");
        assert!(
            near(variance, truth.at([0.3]) * shape.roughness() / 0.1, 2e-3),
            "{shape}"
        );
    }
    let parts = Integrated {
        squared_bias: 1.0,
        variance: 2.0,
    };
    assert_eq!(parts.mise(), 3.0);
}
