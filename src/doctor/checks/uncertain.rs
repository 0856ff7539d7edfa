//! Statements of uncertainty: halves and intervals.

use super::{Check, Evidence, Finding, Subjects};
use crate::accuracy::compare;
use crate::doctor::subjects::H;
use crate::numeric::special::normal_density;
use crate::sample::Sample;
use crate::space::{Domain, Field, Point, Targets};
use rand_distr::{Distribution, StandardNormal};

const PLACES: [Point<1>; 5] = [[-1.5], [-0.7], [0.0], [0.9], [1.8]];

/// Batches of independent points give the variance.
pub const BATCHED: Check = Check {
    name: "halves",
    states: "the random error from batches is the exact variance on average",
    run: batched,
};

fn batched(subjects: &Subjects, seed: u64) -> Finding {
    const DRAWS: usize = 100;
    let sums: Vec<f64> = (0..2000)
        .map(|number| {
            let sample = subjects.sample(seed, "doctor/halves", number, DRAWS);
            let targets = Targets::Points(&PLACES);
            let squared = subjects.halves.squared(&*subjects.kde, &sample, targets);
            squared.map_or(f64::NAN, |squared| squared.iter().sum())
        })
        .collect();
    let theory = subjects.kde.expectation(&*subjects.density, DRAWS, &PLACES);
    let expected = theory.unwrap_or_default().iter().map(|m| m.variance).sum();
    let mut evidence = Evidence::default();
    evidence.mean("Σ ê²", &sums, expected);
    evidence.finding()
}

/// Batches of paths give it too where a path leaves several hits.
pub const PATHS: Check = Check {
    name: "halves-by-path",
    states: "the same where paths leave four hits each, near each other",
    run: paths,
};

fn paths(subjects: &Subjects, seed: u64) -> Finding {
    const PATHS: usize = 100;
    const HITS: usize = 4;
    const SPREAD: f64 = 0.1;
    // hits are normal with variance 1 + spread², their estimate is smoothed by h
    let deviation = (1.0 + SPREAD * SPREAD + H * H).sqrt();
    let expected = PLACES.map(|[x]| normal_density(x / deviation) / deviation);
    let (mut said, mut was) = (Vec::new(), Vec::new());
    for number in 0..500 {
        let mut random = subjects.stream(seed, "doctor/halves-by-path", number);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let mut points = Vec::with_capacity(PATHS * HITS);
        for _ in 0..PATHS {
            let centre = normal();
            points.extend((0..HITS).map(|_| [centre + SPREAD * normal()]));
        }
        let of = (0..PATHS * HITS).map(|i| (i / HITS) as u32).collect();
        let sample = Sample::equal(points, Domain::whole())
            .and_then(|sample| sample.with_paths(of, PATHS))
            .expect("finite points of known paths");
        let targets = Targets::Points(&PLACES);
        let squared = subjects.halves.squared(&*subjects.kde, &sample, targets);
        said.push(squared.map_or(f64::NAN, |squared| squared.iter().sum()));
        let estimate = subjects.kde.fit(&sample);
        let values = estimate.map(|estimate| estimate.evaluate(targets).values);
        let values = values.unwrap_or_default();
        was.push(
            values
                .iter()
                .zip(expected)
                .map(|(v, e)| (v - e).powi(2))
                .sum(),
        );
    }
    let ratio = compare(&said, &was, 0.95);
    let mut evidence = Evidence::default();
    let error = ratio.ratio_error.unwrap_or(f64::NAN);
    evidence.value("∫ê²/∫var", ratio.ratio, error, 1.0);
    evidence.finding()
}

/// Intervals cover what they say.
pub const COVERAGE: Check = Check {
    name: "interval-coverage",
    states: "the 95 % interval of a mean of five normal values covers it in 95 % of samples",
    run: coverage,
};

fn coverage(subjects: &Subjects, seed: u64) -> Finding {
    const SAMPLES: usize = 10_000;
    let mut random = subjects.stream(seed, "doctor/interval-coverage", 0);
    let covered = (0..SAMPLES)
        .filter(|_| {
            let values: [f64; 5] = std::array::from_fn(|_| StandardNormal.sample(&mut random));
            let interval = (subjects.interval)(&values, 0.95);
            interval.low <= 0.0 && 0.0 <= interval.high
        })
        .count();
    let n = SAMPLES as f64;
    let mut evidence = Evidence::default();
    let error = (0.95 * 0.05 / n).sqrt();
    evidence.value("coverage", covered as f64 / n, error, 0.95);
    evidence.finding()
}
