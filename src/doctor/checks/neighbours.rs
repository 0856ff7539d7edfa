//! Nearest neighbours: how far they are, and what estimates make of it.

use super::{Check, Evidence, Finding, Subjects, round, sample, uniform};
use crate::doctor::subjects::K;
use crate::neighbour::Scratch;
use crate::space::Field;

/// The estimate on a line, and the ball that it is made from.
pub const MOMENTS: Check = Check {
    name: "neighbour-moments",
    states: "the mean of (k - 1)/(n V) is the one by theory, and the probability of the ball has the Beta distribution's mean and variance",
    run: moments,
};

fn moments(subjects: &Subjects, seed: u64) -> Finding {
    const DRAWS: usize = 150;
    const PLACE: [f64; 1] = [0.4];
    let values: Vec<f64> = (0..3000)
        .map(|number| {
            let sample = subjects.sample(seed, "doctor/neighbour-moments", number, DRAWS);
            let estimate = subjects.nearest.fit(&sample);
            estimate.map_or(f64::NAN, |estimate| estimate.at(PLACE))
        })
        .collect();
    let theory = subjects
        .nearest
        .expectation(&*subjects.density, DRAWS, &[PLACE])
        .unwrap_or_default();
    // whatever the density, Beta(k, n - k + 1). The estimate has heavy tails, so that its variance would not keep the level; the probability of the ball has none
    let (n, k) = (DRAWS as f64, K as f64);
    let probabilities: Vec<f64> = values
        .iter()
        .map(|f| 0.5 * (k - 1.0) / (n * f))
        .map(|radius| {
            let density = &subjects.density;
            density.probability([PLACE[0] - radius], [PLACE[0] + radius])
        })
        .collect();
    let mean = k / (n + 1.0);
    let mut evidence = Evidence::default();
    for theory in theory {
        evidence.mean("mean", &values, theory.mean);
    }
    evidence.mean("probability of the ball", &probabilities, mean);
    let variance = mean * (1.0 - mean) / (n + 2.0);
    evidence.variance("its variance", &probabilities, variance);
    evidence.finding()
}

/// On a torus, where the density is flat and the estimate exactly unbiased.
pub const TORUS: Check = Check {
    name: "neighbour-torus",
    states: "on a flat torus the estimate is unbiased with the coefficient of variation that k gives",
    run: torus,
};

fn torus(subjects: &Subjects, seed: u64) -> Finding {
    const DRAWS: usize = 150;
    let values: Vec<f64> = (0..2000)
        .map(|number| {
            let points = uniform::<2>(subjects, seed, "doctor/neighbour-torus", number, DRAWS);
            let estimate = subjects.plane_nearest.fit(&sample(points, round()));
            // near the seam, where wrapping matters
            estimate.map_or(f64::NAN, |estimate| estimate.at([0.02, 0.97]))
        })
        .collect();
    // (k - 1)/(n V) with V of Beta(k, n - k + 1). The estimate has heavy tails, which its reciprocal, the volume of the ball, has not
    let (n, k) = (DRAWS as f64, K as f64);
    let volumes: Vec<f64> = values.iter().map(|f| (k - 1.0) / (n * f)).collect();
    let variance = k * (n - k + 1.0) / ((n + 1.0).powi(2) * (n + 2.0));
    let mut evidence = Evidence::default();
    evidence.mean("mean", &values, 1.0);
    evidence.variance("variance of the volume of the ball", &volumes, variance);
    evidence.finding()
}

/// Distances against looking at every point.
pub const FOUND: Check = Check {
    name: "neighbours-found",
    states: "the k-th neighbour is as far away as the k-th of all distances, round the torus too",
    run: found,
};

fn found(subjects: &Subjects, seed: u64) -> Finding {
    let points = uniform::<2>(subjects, seed, "doctor/neighbours-found", 0, 400);
    let targets = uniform::<2>(subjects, seed, "doctor/neighbours-found", 1, 40);
    let finder = (subjects.neighbours)(&sample(points.clone(), round()));
    let mut scratch = Scratch::default();
    let mut evidence = Evidence::default();
    let pairs: Vec<(f64, f64)> = targets
        .iter()
        .flat_map(|target| {
            let mut squares: Vec<f64> = points
                .iter()
                .map(|point| {
                    let along = |axis: usize| {
                        let d = (target[axis] - point[axis]).abs();
                        d.min(1.0 - d)
                    };
                    along(0).powi(2) + along(1).powi(2)
                })
                .collect();
            squares.sort_by(f64::total_cmp);
            [1, 7, 50].map(|k| (finder.distance(*target, k, &mut scratch), squares[k - 1]))
        })
        .collect();
    evidence.exact("squared distance", pairs, 0.01, 1e-12);
    evidence.finding()
}
