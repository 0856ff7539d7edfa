//! Nearest-neighbour estimates against their exact distribution, and what they answer where the data leave them no choice.
//!
//! Chance is tested with chance: fixed seeds, a level of 4 standard errors an item, and faults planted on purpose that must be caught.
#![allow(clippy::unwrap_used)]

use density_lab::density::named;
use density_lab::estimator::{
    Build, Context, Estimator, FitError, GeneralisedNearestNeighbour, NearestNeighbour,
};
use density_lab::parameter::{Value, Values};
use density_lab::random::stream;
use density_lab::sample::{Sample, Weights};
use density_lab::space::{Domain, Field, Point, Side, Targets};
use density_lab::theory::{Convention, neighbour_moments};
use rand::RngExt;
use rayon::prelude::*;

/// Standard errors that a true statement is off by once in 16 000 times.
const LEVEL: f64 = 4.0;

fn torus<const D: usize>() -> Domain<D> {
    Domain::new([0.0; D], [1.0; D], [[Side::Periodic; 2]; D]).unwrap()
}

fn values(k: u64, words: &[(&'static str, &str)]) -> Values {
    let mut values = Values::default();
    values.set("k", Value::Count(k));
    for (name, word) in words {
        values.set(name, Value::Word((*word).to_owned()));
    }
    values
}

fn context<const D: usize>() -> Context<D> {
    Context {
        truth: None,
        draws: 0,
    }
}

fn generalised<const D: usize>(k: u64, shape: &str) -> Box<dyn Estimator<D>>
where
    GeneralisedNearestNeighbour: Build<D>,
{
    let values = values(k, &[("shape", shape)]);
    Box::new(<GeneralisedNearestNeighbour as Build<D>>::build(&values, &context()).unwrap())
}

/// Mean, standard deviation, and the standard errors of both, of the estimate on the even torus: `samples` samples of `n` points, each looked at in a few
/// places far apart, so that balls of k points do not meet and values are as good as independent.
fn on_the_torus<const D: usize>(
    estimator: &dyn Estimator<D>,
    n: usize,
    samples: u64,
    places: &[Point<D>],
) -> [f64; 4] {
    let all: Vec<f64> = (0..samples)
        .into_par_iter()
        .map(|number| {
            let mut random = stream(1986, "torus", number);
            let points = (0..n)
                .map(|_| [(); D].map(|()| random.random::<f64>()))
                .collect();
            let sample = Sample::equal(points, torus()).unwrap();
            let estimate = estimator.fit(&sample).unwrap();
            estimate.evaluate(Targets::Points(places)).values
        })
        .flatten()
        .collect();
    let count = all.len() as f64;
    let mean = all.iter().sum::<f64>() / count;
    let moment = |power| all.iter().map(|v| (v - mean).powi(power)).sum::<f64>() / count;
    let (variance, fourth) = (moment(2), moment(4));
    let deviation = variance.sqrt();
    let error_of_deviation = ((fourth - variance * variance) / count).sqrt() / (2.0 * deviation);
    [
        mean,
        deviation,
        (variance / count).sqrt(),
        error_of_deviation,
    ]
}

/// A lattice of places in the unit square.
fn lattice(side: usize) -> Vec<Point<2>> {
    let at = |i: usize| (i as f64 + 0.37) / side as f64;
    (0..side * side)
        .map(|i| [at(i / side), at(i % side)])
        .collect()
}

/// n, samples and places for each k, so that the standard error is small enough to tell a fault of one percent.
const PLAN: [(usize, usize, u64, usize); 3] = [
    (10, 2000, 1500, 8),
    (50, 4000, 600, 5),
    (500, 20_000, 250, 4),
];

#[test]
fn mean_and_spread_on_the_torus_are_those_of_the_beta_distribution() {
    for (k, n, samples, side) in PLAN {
        let places = lattice(side);
        for (convention, factor) in [
            (Convention::Unbiased, 1.0),
            (Convention::Raw, k as f64 / (k as f64 - 1.0)),
        ] {
            let estimator = NearestNeighbour::new(k, convention);
            let [mean, deviation, error, error_of_deviation] =
                on_the_torus::<2>(&estimator, n, samples, &places);
            // var/mean² = (k-1)(n-1)/((k-2) n) - 1, for large n 1/(k-2)
            let (kf, nf) = (k as f64, n as f64);
            let relative = ((kf - 1.0) * (nf - 1.0) / ((kf - 2.0) * nf) - 1.0).sqrt();
            eprintln!(
                "k = {k}, {convention:?}: mean {mean:.5} (exact {factor:.5}, {:+.1} standard errors), cv {:.5} (exact {relative:.5}, 1/sqrt(k-2) {:.5})",
                (mean - factor) / error,
                deviation / mean,
                1.0 / (kf - 2.0).sqrt()
            );
            assert!(
                (mean - factor).abs() < LEVEL * error,
                "{k} {convention:?}: {mean}"
            );
            assert!(
                (deviation - factor * relative).abs() < LEVEL * error_of_deviation,
                "{k} {convention:?}: {deviation} {}",
                factor * relative
            );
            assert!((deviation / mean * (kf - 2.0).sqrt() - 1.0).abs() < 0.02 + 1.0 / nf.sqrt());
        }
        // planted: the raw convention is not the unbiased one
        if k < 500 {
            let [mean, _, error, _] = on_the_torus::<2>(
                &NearestNeighbour::new(k, Convention::Raw),
                n,
                samples,
                &places,
            );
            assert!(
                (mean - 1.0).abs() > LEVEL * error,
                "not noticed at k = {k}: {mean}"
            );
        }
    }
}

#[test]
fn the_mean_radius_has_about_half_of_the_excess() {
    for (k, n, samples, side, known) in [(10, 2000, 1500, 8, 1.051), (50, 4000, 600, 5, 1.0102)] {
        let estimator = NearestNeighbour::new(k, Convention::MeanRadius);
        let [mean, _, error, _] = on_the_torus::<2>(&estimator, n, samples, &lattice(side));
        eprintln!("k = {k}: mean radius {mean:.4} ± {error:.4}, known {known}");
        assert!((mean - known).abs() < LEVEL * error + 5e-4);
        assert!(
            (mean - 1.0).abs() > LEVEL * error,
            "not told from the unbiased one"
        );
    }
}

#[test]
fn kernels_without_the_kth_point_are_unbiased_and_with_it_are_not() {
    let (k, n, samples, side) = PLAN[0];
    let places = lattice(side);
    for shape in [
        "epanechnikov",
        "cosine",
        "biweight",
        "triweight",
        "triangular",
        "uniform",
        "jensen-cone",
        "jensen-gaussian-corrected",
    ] {
        let estimator = generalised::<2>(k as u64, shape);
        let [mean, _, error, _] = on_the_torus(&*estimator, n, samples, &places);
        eprintln!("{shape}: {mean:.4} ± {error:.4}");
        assert!(
            (mean - 1.0).abs() < LEVEL * error,
            "{shape}: {mean} ± {error}"
        );
    }
    // planted: the uniform kernel with the k-th point kept is the raw convention
    let kept = NearestNeighbour::new(k, Convention::Raw);
    let [mean, _, error, _] = on_the_torus::<2>(&kept, n, samples, &places);
    assert!((mean - 1.0).abs() > LEVEL * error);
    // the Gaussian reaches nine times as far, so the ball must be small on the torus
    let gaussian = generalised::<2>(10, "gaussian");
    let [mean, _, error, _] = on_the_torus(&*gaussian, 20_000, 100, &lattice(6));
    assert!(
        (mean - 1.0).abs() < LEVEL * error,
        "gaussian: {mean} ± {error}"
    );
    // and on the line
    for shape in [
        "epanechnikov",
        "gaussian",
        "jensen-cone",
        "jensen-gaussian-corrected",
    ] {
        let estimator = generalised::<1>(k as u64, shape);
        let line: Vec<Point<1>> = (0..10).map(|i| [0.1 * f64::from(i) + 0.03]).collect();
        let [mean, _, error, _] = on_the_torus(&*estimator, 10_000, 400, &line);
        assert!(
            (mean - 1.0).abs() < LEVEL * error,
            "{shape} on the line: {mean} ± {error}"
        );
    }
}

#[test]
fn the_gaussian_filter_of_photon_maps_sees_0_5312_of_the_light() {
    let estimator = generalised::<2>(500, "jensen-gaussian");
    let [mean, deviation, error, _] = on_the_torus(&*estimator, 40_000, 2000, &lattice(5));
    eprintln!("mean {mean:.5} ± {error:.5}, deviation {deviation:.4}");
    assert!(error < 2.5e-4, "too noisy to tell: {error}");
    assert!((mean - 0.5312).abs() < 0.001, "{mean}");
}

/// Between L₁ and L₂ on both sides of the data the raw estimate holds (k/n) ln(L₂/L₁), twice that in the plane; so its integral diverges.
#[test]
fn the_tails_hold_mass_that_grows_like_a_logarithm() {
    let (n, k) = (500, 20);
    let share = k as f64 / f64::from(n as u32);
    let normal = named("normal").unwrap();
    let mut random = stream(7, "tails", 0);
    let points: Vec<[f64; 1]> = (0..n).map(|_| normal.draw(&mut random)).collect();
    let sample = Sample::equal(points.clone(), Domain::whole()).unwrap();
    let tail = |convention| {
        let estimate = NearestNeighbour::new(k, convention).fit(&sample).unwrap();
        // ∫ f̂ dx = ∫ f̂ |x| d ln|x|
        let steps = 4000;
        let (l1, l2) = (1e3f64, 1e6f64);
        let step = (l2 / l1).ln() / f64::from(steps);
        let sum: f64 = (0..steps)
            .map(|i| l1 * ((f64::from(i) + 0.5) * step).exp())
            .map(|x| x * (estimate.at([x]) + estimate.at([-x])))
            .sum();
        sum * step / (l2 / l1).ln()
    };
    let slope = tail(Convention::Raw);
    eprintln!("slope {slope:.5} on the line, (k/n) = {share}");
    assert!((slope / share - 1.0).abs() < 0.01, "{slope}");
    // planted: the other convention is off by 5 %
    assert!((tail(Convention::Unbiased) / share - 1.0).abs() > 0.01);

    let plane: Vec<Point<2>> = (0..n)
        .map(|_| [normal.draw(&mut random)[0], normal.draw(&mut random)[0]])
        .collect();
    let sample = Sample::equal(plane, Domain::whole()).unwrap();
    let estimate = NearestNeighbour::new(k, Convention::Raw)
        .fit(&sample)
        .unwrap();
    let (l1, l2, steps, turns) = (1e3f64, 1e6f64, 500, 16);
    let step = (l2 / l1).ln() / f64::from(steps);
    let mut sum = 0.0;
    for i in 0..steps {
        let r = l1 * ((f64::from(i) + 0.5) * step).exp();
        for turn in 0..turns {
            let angle = std::f64::consts::TAU * (f64::from(turn) + 0.3) / f64::from(turns);
            sum += estimate.at([r * angle.cos(), r * angle.sin()]) * r * r * std::f64::consts::TAU
                / f64::from(turns);
        }
    }
    let slope = sum * step / (l2 / l1).ln();
    eprintln!("slope {slope:.5} in the plane, (2k/n) = {}", 2.0 * share);
    assert!((slope / (2.0 * share) - 1.0).abs() < 0.01, "{slope}");
}

/// Simulation against the exact moments on a curved density, in the middle, flank and tail.
#[test]
fn what_the_theory_expects_is_what_happens() {
    let truth = named("bimodal").unwrap();
    let places = [[-2.5], [-1.0], [0.0], [0.4], [3.0]];
    let (n, k, samples) = (60, 9, 40_000u64);
    for convention in Convention::ALL {
        let estimator = NearestNeighbour::new(k, convention);
        let claimed = Estimator::<1>::expectation(&estimator, &*truth, n, &places).unwrap();
        let sums = simulate(&estimator, &*truth, n, samples, &places);
        let judge = |claimed: &[density_lab::estimator::Moments]| -> Vec<f64> {
            claimed
                .iter()
                .zip(&sums)
                .flat_map(|(claim, values)| {
                    let count = values.len() as f64;
                    let mean = values.iter().sum::<f64>() / count;
                    let about = |power| {
                        values
                            .iter()
                            .map(|v| (v - claim.mean).powi(power))
                            .sum::<f64>()
                            / count
                    };
                    let (square, fourth) = (about(2), about(4));
                    [
                        (mean - claim.mean) / (square / count).sqrt(),
                        (square - claim.variance) / ((fourth - square * square) / count).sqrt(),
                    ]
                })
                .collect()
        };
        let z = judge(&claimed);
        eprintln!("{convention:?}: {z:.1?}");
        assert!(z.iter().all(|z| z.abs() < LEVEL), "{convention:?}: {z:?}");
        // planted: a mean 1 % too high; one neighbour too many
        let mut high = claimed.clone();
        for claim in &mut high {
            claim.mean *= 1.01;
        }
        assert!(judge(&high).iter().any(|z| z.abs() > LEVEL));
        let other = neighbour_moments(&*truth, k + 1, convention, n, &places).unwrap();
        assert!(judge(&other).iter().any(|z| z.abs() > LEVEL));
    }
}

fn simulate(
    estimator: &NearestNeighbour,
    truth: &dyn density_lab::density::Univariate,
    n: usize,
    samples: u64,
    places: &[Point<1>],
) -> Vec<Vec<f64>> {
    let all: Vec<Vec<f64>> = (0..samples)
        .into_par_iter()
        .map(|number| {
            let mut random = stream(3, "moments", number);
            let points = (0..n).map(|_| truth.draw(&mut random)).collect();
            let sample = Sample::equal(points, Domain::whole()).unwrap();
            let estimate = estimator.fit(&sample).unwrap();
            places.iter().map(|x| estimate.at(*x)).collect()
        })
        .collect();
    (0..places.len())
        .map(|i| all.iter().map(|values| values[i]).collect())
        .collect()
}

#[test]
fn hard_data_get_documented_answers() {
    let unbiased = |k| NearestNeighbour::new(k, Convention::Unbiased);
    let plane = |points: Vec<Point<2>>| Sample::equal(points, Domain::unit()).unwrap();
    // more neighbours than points
    let three = plane(vec![[0.1, 0.1], [0.5, 0.5], [1.0, 1.0]]);
    let Err(FitError::Degenerate(what)) = unbiased(4).fit(&three) else {
        panic!("k = 4 of 3 points");
    };
    assert!(what.contains("k may be from 2 to 3"), "{what}");
    let Err(FitError::Degenerate(what)) =
        NearestNeighbour::new(3, Convention::MeanRadius).fit(&three)
    else {
        panic!("k + 1 = 4 of 3 points");
    };
    assert!(what.contains("from 2 to 2"), "{what}");
    // the same with points that weigh nothing
    let ghosts = Sample::new(
        vec![[0.0], [1.0], [2.0], [3.0]],
        Weights::Each(vec![1.0, 0.0, 1.0, 0.0].into()),
        Domain::whole(),
    )
    .unwrap();
    assert!(unbiased(3).fit(&ghosts).is_err());
    assert!((unbiased(2).fit(&ghosts).unwrap().at([0.0]) - 0.5 * 2.0 / 4.0).abs() < 1e-15);
    // points on the wall: a whole ball, half of it empty
    let corner = unbiased(2).fit(&three).unwrap().at([1.0, 1.0]);
    assert!((corner - 1.0 / (3.0 * std::f64::consts::PI * 0.5)).abs() < 1e-15);
    // all at one place
    let one = plane(vec![[0.3, 0.3]; 1000]);
    assert!(matches!(
        unbiased(5).fit(&one),
        Err(FitError::Degenerate(_))
    ));
    // five of seven at one place, k = 3: there the sixth is taken
    let mut points = vec![[0.3, 0.3]; 5];
    points.extend([[0.3, 0.5], [0.9, 0.9]]);
    let estimate = unbiased(3).fit(&plane(points)).unwrap();
    let evaluation = estimate.evaluate(Targets::Points(&[[0.3, 0.3], [0.3, 0.6]]));
    let expected = 5.0 / (7.0 * std::f64::consts::PI * 0.04);
    assert!(
        (evaluation.values[0] / expected - 1.0).abs() < 1e-12,
        "{evaluation:?}"
    );
    assert!(evaluation.values[1].is_finite());
    assert_eq!(evaluation.warnings.len(), 1, "{evaluation:?}");
    assert!(
        evaluation.warnings[0]
            .what
            .starts_with("at 1 of 2 places at least k = 3 points")
    );
    // offsets
    let far = Sample::equal(
        (0..50).map(|i| [1e9 + f64::from(i)]).collect(),
        Domain::whole(),
    )
    .unwrap();
    let near = Sample::equal((0..50).map(|i| [f64::from(i)]).collect(), Domain::whole()).unwrap();
    for k in [2, 7, 50] {
        let there = unbiased(k).fit(&far).unwrap().at([1e9 + 20.25]);
        let here = unbiased(k).fit(&near).unwrap().at([20.25]);
        assert_eq!(there.to_bits(), here.to_bits());
    }
}

/// Half of a million points in a spot, points far apart, all on a line, all alike but one: none may take long.
#[test]
fn clusters_are_no_cliff() {
    let mut random = stream(11, "clusters", 0);
    let mut unit = || random.random::<f64>();
    let n = 100_000;
    let spot: Vec<Point<2>> = (0..n)
        .map(|i| {
            if i % 2 == 0 {
                [unit(), unit()]
            } else {
                [0.5 + 1e-6 * unit(), 0.5 + 1e-6 * unit()]
            }
        })
        .collect();
    let apart: Vec<Point<2>> = (0..n)
        .map(|i| [unit() + 1e6 * f64::from(u8::from(i % 2 == 0)), unit()])
        .collect();
    let diagonal: Vec<Point<2>> = (0..n)
        .map(|_| {
            let t = unit();
            [t, t]
        })
        .collect();
    let mut alike = vec![[0.25, 0.75]; n];
    alike[0] = [0.0, 0.0];
    let lattice: Vec<Point<2>> = (0..n)
        .map(|i| [f64::from((i % 10) as u8), f64::from((i / 10 % 10) as u8)])
        .collect();
    let targets: Vec<Point<2>> = (0..4096)
        .map(|i| [f64::from(i / 64) / 64.0, f64::from(i % 64) / 64.0])
        .collect();
    for (name, points) in [
        ("spot", spot),
        ("apart", apart),
        ("diagonal", diagonal),
        ("alike", alike),
        ("lattice", lattice),
    ] {
        let sample = Sample::equal(points.clone(), Domain::whole()).unwrap();
        let start = std::time::Instant::now();
        let estimate = NearestNeighbour::new(100, Convention::Unbiased)
            .fit(&sample)
            .unwrap();
        let fitted = start.elapsed();
        let mut places = targets.clone();
        places.extend(&points[..4096]);
        let evaluation = estimate.evaluate(Targets::Points(&places));
        eprintln!(
            "{name}: fit {fitted:?}, all {:?} with {:?}",
            start.elapsed(),
            evaluation.engine
        );
        assert!(
            evaluation.values.iter().all(|v| v.is_finite() && *v >= 0.0),
            "{name}"
        );
        // a direct search takes 8192 × 100 000 × 1 ns = 0.8 s and more
        assert!(
            start.elapsed().as_secs_f64() < 20.0,
            "{name}: {:?}",
            start.elapsed()
        );
    }
}
