//! Bandwidth selectors against what they estimate.

use super::{Check, Evidence, Finding, Subjects};
use crate::doctor::subjects::H;
use crate::kernel::{Bandwidth, Shape};
use crate::sample::Sample;
use crate::space::Domain;
use crate::theory::KernelError;

/// The normal reference rule, with weights.
pub const REFERENCE: Check = Check {
    name: "reference-rule",
    states: "E h² = (1.06 σ)² n^(-2/5) with the effective size of a weighted sample",
    run: reference,
};

fn reference(subjects: &Subjects, seed: u64) -> Finding {
    const DRAWS: usize = 300;
    let (_, deviation) = subjects.density.mean_and_deviation();
    // weights 1 and 9 in turn: 300 points count as much as 183
    let weights: Vec<f64> = (0..DRAWS).map(|i| [1.0, 9.0][i % 2]).collect();
    let size = weights.iter().sum::<f64>().powi(2) / weights.iter().map(|w| w * w).sum::<f64>();
    let squares: Vec<f64> = (0..400)
        .map(|number| {
            let drawn = subjects.sample(seed, "doctor/reference-rule", number, DRAWS);
            let points = drawn.points().to_vec();
            let sample = Sample::normalised(points, weights.clone(), Domain::whole());
            let selected = sample
                .ok()
                .and_then(|sample| subjects.reference.select(&sample, Shape::Gaussian).ok());
            match selected.map(|selection| selection.bandwidth) {
                Some(Bandwidth::Fixed([h])) => h * h,
                _ => f64::NAN,
            }
        })
        .collect();
    let expected = (1.06 * deviation).powi(2) * size.powf(-0.4);
    let mut evidence = Evidence::default();
    evidence.mean("E h²", &squares, expected);
    evidence.finding()
}

/// Cross-validation estimates MISE - R(f) without bias.
pub const CROSS_VALIDATION: Check = Check {
    name: "cross-validation",
    states: "the criterion of least-squares cross-validation has the mean MISE - R(f)",
    run: cross_validation,
};

fn cross_validation(subjects: &Subjects, seed: u64) -> Finding {
    const DRAWS: usize = 60;
    let values: Vec<f64> = (0..1500)
        .map(|number| {
            let sample = subjects.sample(seed, "doctor/cross-validation", number, DRAWS);
            let criterion = subjects
                .cross_validation
                .criterion(&sample, Shape::Gaussian);
            criterion.ok().flatten().map_or(f64::NAN, |at| at(H))
        })
        .collect();
    let exact = KernelError::new(&*subjects.density, Shape::Gaussian).at(H, DRAWS as f64);
    let mut evidence = Evidence::default();
    evidence.mean(
        "criterion",
        &values,
        exact.mise() - subjects.density.roughness(0),
    );
    evidence.finding()
}
