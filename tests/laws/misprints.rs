//! Misprints and loose claims of the lecture: the printed version fails, the corrected one holds, each with its number. `experiments/misprints/README.md` lists all of them.

use density_lab::accuracy::{Errors, Tally};
use density_lab::density::named;
use density_lab::estimator::Context;
use density_lab::experiment::catalogue::{Builds, estimator};
use density_lab::kernel::Shape;
use density_lab::parameter::{Value, Values};
use density_lab::random::stream;
use density_lab::sample::{Drawn, Source};
use density_lab::space::Targets;
use density_lab::theory::{Convention, KernelError, kernel_moments, neighbour_moments};
use density_lab::uncertainty::{ErrorEstimate, Halves, Split};

/// S01: the error is estimate less truth, and bias has that sign everywhere.
#[test]
fn s01_the_error_is_estimate_less_truth() {
    let mut tally = Tally::default();
    tally.add(&[1.5], &[1.0]);
    let printed = 1.0 - 1.5;
    assert_eq!(tally.mean()[0], 0.5);
    assert_ne!(tally.mean()[0], printed);
    // squares do not tell
    let squared = |e: f64, f: f64| Errors::between(&[e], &[f], 1.0).ise;
    assert_eq!(squared(1.5, 1.0), squared(1.0, 1.5));
    // a mode is smoothed away: the bias there is negative
    let normal = named("normal").unwrap();
    let bias = kernel_moments(&*normal, Shape::Gaussian, 0.3, 1.0, 0.0).mean - normal.at([0.0]);
    assert!(bias < 0.0);
}

/// S02: E f̂ is the smoothed density; the bias is its difference to the density and integrates to nothing.
#[test]
fn s02_the_bias_is_no_smoothed_density() {
    let normal = named("normal").unwrap();
    let (mut mean, mut bias) = (0.0, 0.0);
    let step = 0.01;
    for i in -1000..1000 {
        let x = (f64::from(i) + 0.5) * step;
        let m = kernel_moments(&*normal, Shape::Gaussian, 0.5, 1.0, x).mean;
        mean += m * step;
        bias += (m - normal.at([x])) * step;
    }
    assert!((mean - 1.0).abs() < 1e-9, "{mean}");
    assert!(bias.abs() < 1e-9, "{bias}");
}

/// S03: more points do not help at a fixed bandwidth; with the best one for each n they do.
#[test]
fn s03_bias_goes_with_the_bandwidth() {
    let bimodal = named("bimodal").unwrap();
    let errors = KernelError::new(&*bimodal, Shape::Gaussian);
    let fixed = |n: f64| errors.at(0.3, n).mise();
    // a billion points at h = 0.3: the squared bias stays
    assert!(fixed(1e9) > 0.99 * errors.at(0.3, 1e3).squared_bias);
    let best = |n: f64| errors.optimum(n);
    assert!(best(1e9).error.mise() < 1e-6 && fixed(1e9) > 7e-4);
    assert!(best(1e9).error.squared_bias < 1e-3 * errors.at(0.3, 1e9).squared_bias);
}

/// S08 and S09: the factor is ¼, and what it gives is the variance, not the mean squared error.
#[test]
fn s08_s09_a_quarter_and_only_the_variance() {
    const DRAWS: usize = 200;
    const H: f64 = 0.6;
    let bimodal = named("bimodal").unwrap();
    let entry = estimator("kernel").unwrap();
    let mut values = Values::defaults(entry.parameters);
    values.set("bandwidth", Value::Number(H));
    let context = Context {
        truth: None,
        draws: DRAWS,
    };
    let kernel = Builds::<1>::build(entry, &values, &context).unwrap();
    let places = [[-1.0], [0.0], [1.0]];
    let moments = kernel.expectation(&*bimodal, DRAWS, &places).unwrap();
    let variance: f64 = moments.iter().map(|m| m.variance).sum();
    let error: f64 = moments
        .iter()
        .zip(places)
        .map(|(m, x)| m.variance + (m.mean - bimodal.at(x)).powi(2))
        .sum();
    let halves = Halves {
        batches: 2,
        split: Split::Path,
    };
    let samples = 600;
    let said: f64 = (0..samples)
        .map(|number| {
            let mut random = stream(8, "misprints", number);
            let sample = Drawn(bimodal.clone()).sample(DRAWS, &mut random).unwrap();
            let squared = halves.squared(&*kernel, &sample, Targets::Points(&places));
            squared.unwrap().iter().sum::<f64>() / samples as f64
        })
        .sum();
    // the relative spread of one is about one: 4 % of the mean of 600
    assert!((said / variance - 1.0).abs() < 0.16, "{}", said / variance);
    // the printed ½ gives twice that
    assert!((2.0 * said / variance - 1.0).abs() > 0.5);
    // the printed MISE is more than six times what halves see here
    assert!(error / variance > 6.0, "{}", error / variance);
    assert!((said / error - 1.0).abs() > 0.5);
}

/// S10: k/(n V) has the mean f k/(k - 1); infinite for k = 1.
#[test]
fn s10_the_nearest_neighbour_estimate_is_too_high_by_a_factor() {
    let uniform = named("uniform").unwrap();
    // in the middle of a flat density nothing but the convention biases
    let mean = |convention| {
        let moments = neighbour_moments(&*uniform, 10, convention, 1000, &[[0.5]]);
        moments.unwrap()[0].mean
    };
    let (printed, corrected) = (mean(Convention::Raw), mean(Convention::Unbiased));
    assert!((printed - 10.0 / 9.0).abs() < 1e-6, "{printed}");
    assert!((corrected - 1.0).abs() < 1e-6, "{corrected}");
}

/// S15: a window that shrinks so that it always holds the same number of points loses its bias and keeps its noise.
#[test]
fn s15_a_fixed_count_does_not_converge() {
    let normal = named("normal").unwrap();
    let relative = |n: f64, h: f64| {
        let moments = kernel_moments(&*normal, Shape::Epanechnikov, h, n, 0.0);
        let f = normal.at([0.0]);
        ((moments.mean - f).abs() / f, moments.variance.sqrt() / f)
    };
    // 20 points in the window on average
    let fixed = |n: f64| relative(n, 20.0 / (2.0 * n * normal.at([0.0])));
    let (few, many) = (fixed(1e4), fixed(1e8));
    assert!(
        many.0 < 1e-7 * few.0.max(1e-3),
        "the bias goes: {} {}",
        few.0,
        many.0
    );
    assert!(
        (many.1 / few.1 - 1.0).abs() < 0.01,
        "the noise stays: {} {}",
        few.1,
        many.1
    );
    // √(2 R / 20) = √(1.2/20)
    assert!((many.1 - 0.06_f64.sqrt()).abs() < 1e-3, "{}", many.1);
    // h ∝ n^(-1/5) loses both
    let falling = |n: f64| relative(n, 2.0 * n.powf(-0.2));
    assert!(falling(1e8).1 < 0.05 * falling(1e4).1 * 1.0001 + 0.02 * falling(1e4).1);
}
