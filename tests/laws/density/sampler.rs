//! Points that are drawn.

use super::all;
use crate::chance::{equally_likely, holm, kolmogorov_smirnov, two_sided};
use density_lab::density::Univariate;
use density_lab::random::{Stream, stream};
use rayon::prelude::*;

const DRAWS: usize = 400_000;

/// Four p-values for points that should follow `truth`: Kolmogorov and Smirnov's, Pearson's over 64 equally likely cells, mean, variance.
fn suspicions(truth: &dyn Univariate, points: &[f64]) -> [f64; 4] {
    let n = points.len() as f64;
    let probabilities: Vec<f64> = points.iter().map(|&x| truth.distribution(x)).collect();
    let mut counts = [0; 64];
    for p in &probabilities {
        counts[((p * 64.0) as usize).min(63)] += 1;
    }
    let (mean, deviation) = truth.mean_and_deviation();
    let power = |k: i32| {
        points
            .iter()
            .map(|x| ((x - mean) / deviation).powi(k))
            .sum::<f64>()
            / n
    };
    let (second, fourth) = (power(2), power(4));
    [
        kolmogorov_smirnov(probabilities),
        equally_likely(&counts),
        two_sided(power(1) * n.sqrt()),
        two_sided((second - 1.0) * n.sqrt() / (fourth - second * second).sqrt()),
    ]
}

/// The indices of the densities that any of the four tests rejects, at most one true sampler in a thousand runs of all.
fn accused(suspicions: &[[f64; 4]]) -> Vec<usize> {
    let rejected = holm(suspicions.as_flattened(), 1e-3);
    (0..suspicions.len())
        .filter(|i| rejected[4 * i..4 * i + 4].contains(&true))
        .collect()
}

#[test]
fn samplers_follow_their_distribution_and_one_percent_of_fault_is_seen() {
    let all = all();
    let tested: Vec<[[f64; 4]; 3]> = all
        .par_iter()
        .enumerate()
        .map(|(number, (_, truth))| {
            let mut random = stream(1986, "law of samplers", number as u64);
            let points: Vec<f64> = (0..DRAWS).map(|_| truth.draw(&mut random)[0]).collect();
            let (mean, deviation) = truth.mean_and_deviation();
            let moved: Vec<f64> = points
                .iter()
                .map(|x| 0.01f64.mul_add(deviation, *x))
                .collect();
            let wider: Vec<f64> = points
                .iter()
                .map(|x| 1.01f64.mul_add(x - mean, mean))
                .collect();
            [&points, &moved, &wider].map(|points| suspicions(&**truth, points))
        })
        .collect();
    let [fair, shifted, stretched] =
        [0, 1, 2].map(|kind| tested.iter().map(|of| of[kind]).collect::<Vec<_>>());
    let names = |faults: Vec<usize>| {
        faults
            .iter()
            .map(|&i| all[i].0.as_str())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(accused(&fair)), [""; 0], "{fair:?}");
    assert_eq!(
        accused(&shifted).len(),
        all.len(),
        "shifts unseen: {:?}",
        names(accused(&shifted))
    );
    assert_eq!(
        accused(&stretched).len(),
        all.len(),
        "stretches unseen: {:?}",
        names(accused(&stretched))
    );
}

/// Documented numbers of random words, so that a stream can be split by counting.
#[test]
fn draws_take_the_words_that_are_documented() {
    let words = |truth: &dyn Univariate, random: &mut Stream| {
        let before = random.get_word_pos();
        truth.draw(random);
        (random.get_word_pos() - before) / 2
    };
    for (name, truth) in all() {
        let mut random = stream(3, "words", 0);
        let taken: Vec<u128> = (0..1000).map(|_| words(&*truth, &mut random)).collect();
        if truth.normal_components().is_some() {
            assert!(taken.iter().all(|&words| words == 2), "{name}");
        } else if name.starts_with("beta") {
            let mean = taken.iter().sum::<u128>() as f64 / 1000.0;
            assert!(
                taken.iter().all(|&words| words >= 2) && mean < 4.0,
                "{name}: {mean}"
            );
        } else {
            assert!(taken.iter().all(|&words| words == 1), "{name}");
        }
    }
}
