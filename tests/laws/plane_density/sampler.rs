//! Points that are drawn.

use super::all;
use crate::chance::{holm, two_sided};
use density_lab::density::Bivariate;
use density_lab::random::stream;
use density_lab::space::Point;
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};

const DRAWS: usize = 400_000;

/// Cells on each axis; the outer ones go on to infinity.
const CELLS: usize = 12;

/// P-values for points that should follow `truth`: Pearson's over cells, and of two means, two variances and the covariance.
fn suspicions(truth: &dyn Bivariate, cells: &[f64], points: &[Point<2>]) -> [f64; 6] {
    let n = points.len() as f64;
    let (low, high) = truth.bulk(2e-2);
    let mut counts = vec![0.0; CELLS * CELLS];
    for x in points {
        let [i, j] = [0, 1].map(|k: usize| {
            let t = (x[k] - low[k]) / (high[k] - low[k]) * CELLS as f64;
            (t.max(0.0) as usize).min(CELLS - 1)
        });
        counts[i * CELLS + j] += 1.0;
    }
    let (mut statistic, mut freedom) = (0.0, -1.0);
    let mut rest = (0.0, 0.0);
    for (count, probability) in counts.iter().zip(cells) {
        let expected = n * probability;
        if expected < 20.0 {
            rest = (rest.0 + count, rest.1 + expected);
            continue;
        }
        statistic += (count - expected).powi(2) / expected;
        freedom += 1.0;
    }
    if rest.1 > 5.0 {
        statistic += (rest.0 - rest.1).powi(2) / rest.1;
        freedom += 1.0;
    } else if rest.0 > rest.1 + 30.0 {
        statistic = f64::INFINITY;
    }
    let (mean, covariance) = truth.mean_and_covariance();
    let test = |value: &dyn Fn(f64, f64) -> f64, expected: f64| {
        let values = points
            .iter()
            .map(|x| value(x[0] - mean[0], x[1] - mean[1]) - expected);
        let (sum, squares) = values.fold((0.0, 0.0), |(s, q), v| (s + v, q + v * v));
        two_sided(sum / squares.sqrt())
    };
    [
        ChiSquared::new(freedom).unwrap().sf(statistic),
        test(&|x, _| x, 0.0),
        test(&|_, y| y, 0.0),
        test(&|x, _| x * x, covariance[0][0]),
        test(&|_, y| y * y, covariance[1][1]),
        test(&|x, y| x * y, covariance[0][1]),
    ]
}

fn cell_probabilities(truth: &dyn Bivariate) -> Vec<f64> {
    let (low, high) = truth.bulk(2e-2);
    let edge = |k: usize, i: usize| match i {
        0 => f64::NEG_INFINITY,
        CELLS => f64::INFINITY,
        _ => (high[k] - low[k]).mul_add(i as f64 / CELLS as f64, low[k]),
    };
    (0..CELLS * CELLS)
        .map(|cell| {
            let (i, j) = (cell / CELLS, cell % CELLS);
            truth.probability([edge(0, i), edge(1, j)], [edge(0, i + 1), edge(1, j + 1)])
        })
        .collect()
}

/// The indices of the densities that any of the tests rejects, at most one true sampler in a thousand runs of all.
fn accused(suspicions: &[[f64; 6]]) -> Vec<usize> {
    let rejected = holm(suspicions.as_flattened(), 1e-3);
    (0..suspicions.len())
        .filter(|i| rejected[6 * i..6 * i + 6].contains(&true))
        .collect()
}

#[test]
fn samplers_follow_their_density_and_one_percent_of_fault_is_seen() {
    let all = all();
    let tested: Vec<[[f64; 6]; 4]> = all
        .par_iter()
        .enumerate()
        .map(|(number, (_, truth))| {
            let mut random = stream(1986, "law of samplers in the plane", number as u64);
            let points: Vec<Point<2>> = (0..DRAWS).map(|_| truth.draw(&mut random)).collect();
            let (mean, covariance) = truth.mean_and_covariance();
            let [s, t] = [covariance[0][0].sqrt(), covariance[1][1].sqrt()];
            let changed = |change: &dyn Fn(Point<2>) -> Point<2>| -> Vec<Point<2>> {
                points.iter().map(|&x| change(x)).collect()
            };
            let cells = cell_probabilities(&**truth);
            let check = |points: &[Point<2>]| suspicions(&**truth, &cells, points);
            [
                check(&points),
                check(&changed(&|x| [0.01f64.mul_add(s, x[0]), x[1]])),
                check(&changed(&|x| {
                    [x[0], 1.01f64.mul_add(x[1] - mean[1], mean[1])]
                })),
                // a wrong correlation
                check(&changed(&|x| {
                    [x[0], (0.015 * t / s).mul_add(x[0] - mean[0], x[1])]
                })),
            ]
        })
        .collect();
    let [fair, shifted, stretched, sheared] =
        [0, 1, 2, 3].map(|kind| tested.iter().map(|of| of[kind]).collect::<Vec<_>>());
    let names =
        |faults: Vec<usize>| -> Vec<&str> { faults.iter().map(|&i| all[i].0.as_str()).collect() };
    assert_eq!(names(accused(&fair)), [""; 0], "{fair:?}");
    for (fault, seen) in [
        ("shift", shifted),
        ("stretch", stretched),
        ("shear", sheared),
    ] {
        assert_eq!(
            accused(&seen).len(),
            all.len(),
            "{fault} seen only in {:?}",
            names(accused(&seen))
        );
    }
}

#[test]
fn draws_take_the_words_that_are_documented() {
    for (name, truth) in all() {
        let mut random = stream(3, "words", 0);
        let taken: Vec<u128> = (0..500)
            .map(|_| {
                let before = random.get_word_pos();
                truth.draw(&mut random);
                (random.get_word_pos() - before) / 2
            })
            .collect();
        assert!(
            taken
                .iter()
                .all(|words| *words == taken[0] && (2..=4).contains(words)),
            "{name}: {taken:?}"
        );
    }
}
