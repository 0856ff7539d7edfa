//! Moments at a place: against chance, on paper, and against the integrals.

use super::{beta, named, near};
use crate::chance::{holm, two_sided};
use density_lab::density::{self, Density, Univariate};
use density_lab::kernel::{Kernel, Shape};
use density_lab::random::stream;
use density_lab::theory::{
    HistogramError, Integrated, KernelError, Moments, histogram_moments, integrate_over,
    kernel_cuts, kernel_moments, polygon_moments, shifted_histogram_moments,
};
use rayon::prelude::*;
use std::sync::Arc;

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
