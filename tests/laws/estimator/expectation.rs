//! Monte Carlo against `expectation()`: the mean and the variance that an estimator claims for itself, over many samples.

use super::subject::{Subject, catalogue, fixed};
use crate::chance::{holm, two_sided};
use density_lab::density::named;
use density_lab::estimator::{Estimator, Moments};
use density_lab::random::stream;
use density_lab::sample::{Sample, Weights};
use density_lab::space::{Domain, Field};
use rayon::prelude::*;

/// The chance that anything true is rejected.
const LEVEL: f64 = 1e-3;

/// Places to look at, in the density's middle, flanks and tail.
const PLACES: [[f64; 1]; 6] = [[-2.1], [-1.013], [-0.31], [0.07], [0.83], [1.9]];

/// Samples of one kind: their weights, and how many equally weighted points carry as much information.
struct Kind {
    weights: Weights,
    points: usize,
    effective: usize,
}

fn kinds() -> [Kind; 2] {
    // (3 + 1 + 1 + 1)² / (9 + 1 + 1 + 1) = 3 in each group of four
    let weights: Vec<f64> = (0..32)
        .map(|i| if i % 4 == 0 { 3.0 } else { 1.0 } / 48.0)
        .collect();
    [
        Kind {
            weights: Weights::Equal(1.0 / 24.0),
            points: 24,
            effective: 24,
        },
        Kind {
            weights: Weights::Each(weights.into()),
            points: 32,
            effective: 24,
        },
    ]
}

/// The p-values of claimed mean and variance at each place over `replicates` samples.
fn p_values(
    estimator: &dyn Estimator<1>,
    claimed: &[Moments],
    kind: &Kind,
    replicates: u64,
) -> Vec<f64> {
    const BLOCK: u64 = 1000;
    let truth = named("bimodal").unwrap();
    // Σ e, Σ e², Σ e⁴ at each place, e the deviation from the claimed mean
    let blocks: Vec<Vec<[f64; 3]>> = (0..replicates / BLOCK)
        .into_par_iter()
        .map(|block| {
            let mut random = stream(1986, "expectation", block);
            let mut sums = vec![[0.0; 3]; PLACES.len()];
            for _ in 0..BLOCK {
                let points = (0..kind.points).map(|_| truth.draw(&mut random)).collect();
                let sample = Sample::new(points, kind.weights.clone(), Domain::whole()).unwrap();
                let estimate = estimator.fit(&sample).unwrap();
                for ((place, claim), sums) in PLACES.iter().zip(claimed).zip(&mut sums) {
                    let square = (estimate.at(*place) - claim.mean).powi(2);
                    sums[0] += estimate.at(*place) - claim.mean;
                    sums[1] += square;
                    sums[2] += square * square;
                }
            }
            sums
        })
        .collect();
    let n = replicates as f64;
    (0..PLACES.len())
        .flat_map(|i| {
            let [first, second, fourth] =
                [0, 1, 2].map(|power| blocks.iter().map(|sums| sums[i][power]).sum::<f64>() / n);
            let mean = first / (second / n).sqrt();
            let variance = (second - claimed[i].variance) / ((fourth - second * second) / n).sqrt();
            [two_sided(mean), two_sided(variance)]
        })
        .collect()
}

fn claimed(estimator: &dyn Estimator<1>, draws: usize) -> Option<Vec<Moments>> {
    estimator.expectation(&*named("bimodal").unwrap(), draws, &PLACES)
}

#[test]
fn what_estimators_claim_to_expect_is_what_happens() {
    let kinds = kinds();
    // other engines expect the same
    let owed = |subject: &Subject<1>| fixed(subject) && !subject.computed_otherwise;
    let subjects: Vec<Subject<1>> = catalogue::<1>().into_iter().filter(owed).collect();
    let mut tested = Vec::new();
    let mut p = Vec::new();
    for subject in &subjects {
        let estimator = subject.plain();
        for kind in &kinds {
            let claims = claimed(&*estimator, kind.effective)
                .unwrap_or_else(|| panic!("{} knows no expectation", subject.name));
            let found = p_values(&*estimator, &claims, kind, 12_000);
            tested.extend(found.iter().map(|_| &subject.name));
            p.extend(found);
        }
    }
    let rejected: Vec<_> = holm(&p, LEVEL)
        .iter()
        .zip(&tested)
        .zip(&p)
        .filter(|((rejected, _), _)| **rejected)
        .map(|((_, name), p)| format!("{name}: p = {p}"))
        .collect();
    eprintln!(
        "{} settings, {} comparisons, least p {:.2e}",
        subjects.len(),
        p.len(),
        p.iter().copied().fold(1.0, f64::min)
    );
    assert!(subjects.len() >= 30, "{}", subjects.len());
    assert!(rejected.is_empty(), "\n{}", rejected.join("\n"));
}

#[test]
fn data_driven_widths_claim_nothing() {
    let claims: Vec<String> = catalogue::<1>()
        .iter()
        .filter(|subject| {
            !subject.plain().laws().linear
                // whose width is data-driven by definition, and whose distribution is known: judged in tests/nearest_neighbour.rs
                && !subject.name.starts_with("nearest-neighbour {")
                // linear where there are no walls, as here
                && !subject.name.contains("jones-foster")
                && claimed(&*subject.plain(), 24).is_some()
        })
        .map(|subject| subject.name.clone())
        .collect();
    assert!(claims.is_empty(), "{claims:?}");
}

/// Each fault of one or two percent alone is rejected at the level of the test above.
#[test]
fn planted_faults_are_noticed() {
    let kinds = kinds();
    let all: Vec<Subject<1>> = catalogue::<1>().into_iter().filter(fixed).collect();
    for start in [
        "histogram",
        "shifted-histogram",
        "frequency-polygon",
        "naive",
        "kernel",
    ] {
        let subject = all
            .iter()
            .find(|subject| subject.name.starts_with(&format!("{start} {{")))
            .unwrap();
        let estimator = subject.plain();
        let right = claimed(&*estimator, 24).unwrap();
        let caught = |estimator: &dyn Estimator<1>, claims: &[Moments], kind: &Kind| {
            let replicates = if start == "kernel" { 200_000 } else { 60_000 };
            let p = p_values(estimator, claims, kind, replicates);
            // as strict as among a thousand comparisons
            p.iter().any(|p| *p <= LEVEL / 1000.0)
        };
        let with = |mean: f64, variance: f64| -> Vec<Moments> {
            right
                .iter()
                .map(|claim| Moments {
                    mean: mean * claim.mean,
                    variance: variance * claim.variance,
                })
                .collect()
        };
        assert!(!caught(&*estimator, &right, &kinds[0]), "{start}");
        assert!(
            caught(&*estimator, &with(1.01, 1.0), &kinds[0]),
            "{start}: a mean 1 % too high"
        );
        if start == "kernel" {
            assert!(
                caught(&*estimator, &with(1.0, 0.98), &kinds[0]),
                "a variance 2 % too low"
            );
            assert!(
                caught(&*estimator, &with(1.0, 1.02), &kinds[0]),
                "a variance 2 % too high"
            );
        }
        // the bare count of weighted points instead of their effective size
        let counted = claimed(&*estimator, 32).unwrap();
        assert!(
            caught(&*estimator, &counted, &kinds[1]),
            "{start}: the count for the effective size"
        );
    }
}
