//! The checks, by what they look at.

mod drawing;
mod estimates;
mod kernels;
mod neighbours;
mod selectors;
mod streams;
mod uncertain;
mod walls;

use super::{Check, Evidence, Finding, Subjects};
use crate::sample::Sample;
use crate::space::{Domain, Point, Side};

/// Every check; to add one, add a line.
pub const CHECKS: &[Check] = &[
    streams::UNRELATED,
    streams::REPLICATES,
    drawing::DISTRIBUTION,
    drawing::QUANTILES,
    drawing::MASS,
    drawing::ROUGHNESS,
    kernels::CONSTANTS,
    kernels::SUM,
    kernels::PLANE_SUM,
    estimates::MEAN,
    estimates::PLANE_MEAN,
    estimates::VARIANCE,
    estimates::MISE,
    estimates::WEIGHTS,
    estimates::FLUX,
    estimates::BINS,
    estimates::BINS_MISE,
    walls::UNTREATED,
    walls::MIRROR,
    walls::CORNER,
    walls::SLOPE,
    walls::RING,
    neighbours::MOMENTS,
    neighbours::TORUS,
    neighbours::FOUND,
    selectors::REFERENCE,
    selectors::CROSS_VALIDATION,
    uncertain::BATCHED,
    uncertain::PATHS,
    uncertain::COVERAGE,
];

/// Points of the unit interval or square, uniform, from the stream of a check.
fn uniform<const D: usize>(
    subjects: &Subjects,
    seed: u64,
    purpose: &str,
    number: usize,
    draws: usize,
) -> Vec<Point<D>> {
    use rand::RngExt;
    let mut random = subjects.stream(seed, purpose, number);
    (0..draws)
        .map(|_| std::array::from_fn(|_| random.random()))
        .collect()
}

/// The unit interval or square that wraps round.
fn round<const D: usize>() -> Domain<D> {
    Domain::new([0.0; D], [1.0; D], [[Side::Periodic; 2]; D]).expect("a legal domain")
}

/// A sample of equal weights.
fn sample<const D: usize>(points: Vec<Point<D>>, domain: Domain<D>) -> Sample<D> {
    Sample::equal(points, domain).expect("points of the domain")
}
