//! Random streams: each uniform, any two unrelated.

use super::{Check, Evidence, Finding, Subjects};
use crate::accuracy::chance::kolmogorov_smirnov;
use rand::RngExt;

/// Streams of different names have nothing to do with each other.
pub const UNRELATED: Check = Check {
    name: "streams",
    states: "numbers are uniform, and streams of another purpose, number or seed unrelated",
    run: unrelated,
};

/// The correlation of pairs (uᵢ, vᵢ) of uniform numbers: z = 12 Σ (u - ½)(v - ½) / √n.
fn related(evidence: &mut Evidence, of: &str, pairs: impl Iterator<Item = (f64, f64)>) {
    let products: Vec<f64> = pairs.map(|(u, v)| 12.0 * (u - 0.5) * (v - 0.5)).collect();
    let n = products.len() as f64;
    // the variance of 12(u - ½)(v - ½) is 1 for unrelated numbers
    evidence.value(of, products.iter().sum::<f64>() / n, n.sqrt().recip(), 0.0);
}

fn unrelated(subjects: &Subjects, seed: u64) -> Finding {
    const STREAMS: usize = 4000;
    let first = |seed: u64, purpose: &str| -> Vec<f64> {
        (0..STREAMS)
            .map(|number| subjects.stream(seed, purpose, number).random())
            .collect()
    };
    let here = first(seed, "doctor/streams");
    let elsewhere = first(seed, "doctor/streams, another purpose");
    let later = first(seed ^ 1, "doctor/streams");
    let mut evidence = Evidence::default();
    let with = |other: &[f64]| -> Vec<(f64, f64)> {
        here.iter().copied().zip(other.iter().copied()).collect()
    };
    related(
        &mut evidence,
        "another purpose",
        with(&elsewhere).into_iter(),
    );
    related(&mut evidence, "another seed", with(&later).into_iter());
    related(
        &mut evidence,
        "the next number",
        with(&here[1..]).into_iter(),
    );
    let sharp = 0.5 / (STREAMS as f64).sqrt();
    evidence.test("uniform", kolmogorov_smirnov(here), sharp);
    evidence.finding()
}

/// So do the samples drawn from them.
pub const REPLICATES: Check = Check {
    name: "replicates",
    states: "samples of different replicates are unrelated, and their means vary as theory says",
    run: replicates,
};

fn replicates(subjects: &Subjects, seed: u64) -> Finding {
    const SAMPLES: usize = 4000;
    const DRAWS: usize = 8;
    let (mean, deviation) = subjects.density.mean_and_deviation();
    let means: Vec<f64> = (0..SAMPLES)
        .map(|number| {
            let sample = subjects.sample(seed, "doctor/replicates", number, DRAWS);
            sample.coordinates().iter().sum::<f64>() / DRAWS as f64
        })
        .collect();
    let variance = deviation * deviation / DRAWS as f64;
    let mut evidence = Evidence::default();
    evidence.mean("mean", &means, mean);
    evidence.variance("variance of the mean", &means, variance);
    let products: Vec<f64> = means
        .windows(2)
        .map(|pair| (pair[0] - mean) * (pair[1] - mean) / variance)
        .collect();
    let n = products.len() as f64;
    let correlation = products.iter().sum::<f64>() / n;
    evidence.value(
        "correlation with the next",
        correlation,
        n.sqrt().recip(),
        0.0,
    );
    evidence.finding()
}
