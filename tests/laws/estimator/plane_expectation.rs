//! Monte Carlo against `expectation()` in the plane: kernels of both symmetries with walls and without, neighbours, series.

use crate::chance::{holm, two_sided};
use density_lab::density::{Bivariate, named_in_plane};
use density_lab::estimator::{Context, Estimator, Moments};
use density_lab::experiment::catalogue::{self, Builds};
use density_lab::experiment::read;
use density_lab::random::stream;
use density_lab::sample::Sample;
use density_lab::space::{Field, Point};
use rayon::prelude::*;

/// The chance that anything true is rejected.
const LEVEL: f64 = 1e-3;

const POINTS: usize = 60;

/// Where the walls of a square or a room are felt, and where not.
const INSIDE: [Point<2>; 4] = [[0.04, 0.5], [0.12, 0.09], [0.45, 0.41], [0.46, 0.93]];

const OPEN: [Point<2>; 4] = [[0.0, 0.0], [0.9, -0.3], [-1.4, 1.1], [2.3, 0.4]];

/// Density, estimator, places.
const SUBJECTS: [(&str, &str, [Point<2>; 4]); 17] = [
    (
        "normal-2d",
        "kernel = { shape = \"epanechnikov\", bandwidth = 0.8 }",
        OPEN,
    ),
    (
        "normal-2d",
        "kernel = { shape = \"biweight\", symmetry = \"radial\", bandwidth = 0.9, bandwidth-y = 1.3 }",
        OPEN,
    ),
    (
        "normal-2d",
        "kernel = { shape = \"uniform\", symmetry = \"radial\", bandwidth = 0.7 }",
        OPEN,
    ),
    ("normal-2d", "nearest-neighbour = { k = 12 }", OPEN),
    (
        "ramp-2d",
        "nearest-neighbour = { k = 9, convention = \"raw\" }",
        INSIDE,
    ),
    (
        "ramp-2d",
        "kernel = { shape = \"epanechnikov\", symmetry = \"radial\", bandwidth = 0.3 }",
        INSIDE,
    ),
    (
        "ramp-2d",
        "kernel = { shape = \"epanechnikov\", symmetry = \"radial\", bandwidth = 0.3, boundary = \"reflect\" }",
        INSIDE,
    ),
    (
        "smooth",
        "kernel = { shape = \"biweight\", bandwidth = 0.35, boundary = \"local-linear\" }",
        INSIDE,
    ),
    (
        "smooth",
        "kernel = { bandwidth = 0.1, boundary = \"normalise\" }",
        INSIDE,
    ),
    (
        "ramp-2d",
        "kernel = { shape = \"triangular\", bandwidth = 0.3, boundary = \"normalise-points\" }",
        INSIDE,
    ),
    (
        "l-shape",
        "kernel = { shape = \"epanechnikov\", symmetry = \"radial\", bandwidth = 0.3, boundary = \"local-linear\" }",
        INSIDE,
    ),
    (
        "l-shape",
        "kernel = { shape = \"epanechnikov\", symmetry = \"radial\", bandwidth = 0.3, boundary = \"normalise\" }",
        INSIDE,
    ),
    ("smooth", "cosine-series = { terms = 4 }", INSIDE),
    (
        "ramp-2d",
        "legendre-series = { terms = 3, taper = \"fejer\" }",
        INSIDE,
    ),
    (
        "normal-2d",
        "histogram = { width = 1.3, width-y = 0.8, angle = 30, origin = 0.2 }",
        OPEN,
    ),
    ("l-shape", "histogram = { width = 0.3, angle = 20 }", INSIDE),
    ("disc", "histogram = { width = 0.31, angle = -65 }", INSIDE),
];

fn built(text: &str, draws: usize) -> Box<dyn Estimator<2>> {
    let spec = read::estimator(text, "test").unwrap();
    let context = Context::<2> { truth: None, draws };
    catalogue::estimator(&spec.kind)
        .unwrap()
        .build(&spec.values, &context)
        .unwrap()
}

/// The p-values of claimed mean and variance at each place.
fn p_values(
    truth: &dyn Bivariate,
    estimator: &dyn Estimator<2>,
    (draws, replicates): (usize, u64),
    places: &[Point<2>],
    claimed: &[Moments],
) -> Vec<f64> {
    const BLOCK: u64 = 250;
    let blocks: Vec<Vec<[f64; 3]>> = (0..replicates / BLOCK)
        .into_par_iter()
        .map(|block| {
            let mut random = stream(2024, "plane expectation", block);
            let mut sums = vec![[0.0; 3]; places.len()];
            for _ in 0..BLOCK {
                let points = (0..draws).map(|_| truth.draw(&mut random)).collect();
                let sample = Sample::equal(points, truth.domain().clone()).unwrap();
                let estimate = estimator.fit(&sample).unwrap();
                for ((place, claim), sums) in places.iter().zip(claimed).zip(&mut sums) {
                    let apart = estimate.at(*place) - claim.mean;
                    for (power, sum) in [1, 2, 4].into_iter().zip(sums) {
                        *sum += apart.powi(power);
                    }
                }
            }
            sums
        })
        .collect();
    let n = replicates as f64;
    (0..places.len())
        .flat_map(|i| {
            let [first, second, fourth] =
                [0, 1, 2].map(|power| blocks.iter().map(|sums| sums[i][power]).sum::<f64>() / n);
            let mean = first / (second / n).sqrt();
            let variance = (second - claimed[i].variance) / ((fourth - second * second) / n).sqrt();
            [two_sided(mean), two_sided(variance)]
        })
        .collect()
}

#[test]
fn what_estimators_of_the_plane_claim_to_expect_is_what_happens() {
    let (mut p, mut tested) = (Vec::new(), Vec::new());
    for (density, text, places) in SUBJECTS {
        let truth = named_in_plane(density).unwrap();
        let estimator = built(text, POINTS);
        let claimed = estimator
            .expectation(&*truth, POINTS, &places)
            .unwrap_or_else(|| panic!("{text} knows no expectation"));
        // that places are inside is part of the test
        assert!(places.iter().all(|x| truth.at(*x) > 0.0), "{density}");
        let found = p_values(&*truth, &*estimator, (POINTS, 5000), &places, &claimed);
        tested.extend(found.iter().map(|_| format!("{density}, {text}")));
        p.extend(found);
    }
    let rejected: Vec<_> = (holm(&p, LEVEL).iter().zip(&tested).zip(&p))
        .filter(|((rejected, _), _)| **rejected)
        .map(|((_, name), p)| format!("{name}: p = {p}"))
        .collect();
    assert!(rejected.is_empty(), "\n{}", rejected.join("\n"));
}

/// A mean that is 1 % too high is rejected at the level of the test above.
#[test]
fn a_planted_fault_of_one_percent_is_noticed() {
    noticed(
        "ramp-2d",
        "kernel = { shape = \"epanechnikov\", symmetry = \"radial\", bandwidth = 0.4, boundary = \"reflect\" }",
    );
    noticed("disc", "histogram = { width = 0.4, angle = 35 }");
}

fn noticed(density: &str, text: &str) {
    let truth = named_in_plane(density).unwrap();
    let (draws, replicates) = (200, 20_000);
    let estimator = built(text, draws);
    let right = estimator.expectation(&*truth, draws, &INSIDE).unwrap();
    let caught = |claims: &[Moments]| {
        let p = p_values(&*truth, &*estimator, (draws, replicates), &INSIDE, claims);
        p.iter().any(|p| *p <= LEVEL / 100.0)
    };
    assert!(!caught(&right));
    let wrong: Vec<Moments> = right
        .iter()
        .map(|claim| Moments {
            mean: 1.01 * claim.mean,
            ..*claim
        })
        .collect();
    assert!(caught(&wrong));
}
