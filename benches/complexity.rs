//! The lecture's table of costs, measured: every way of estimating a density in the plane on the same points, over growing n and over growing m.
//!
//! One estimate is fitting and evaluating on a grid of m places. The points are half even, half in a spot; kernels have one width, so that the number of points under each
//! grows with n for a gather (m n h²) and the number of cells under each does not for a splat (n m h²). One thread.
//!
//! `cargo bench --bench complexity -- 'over n'` runs one sweep, `-- 'nearest'` some estimators. Wall times on a shared machine are noisy; `tests/complexity.rs` asserts
//! the exponents on counters of operations instead.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use density_lab::estimator::{Context, Estimator};
use density_lab::experiment::read::estimator_in;
use density_lab::neighbour::{Scratch, Searchable};
use density_lab::sample::Sample;
use density_lab::space::{Domain, Field, Grid, Point};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rayon::ThreadPoolBuilder;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::Duration;

/// What is compared: a name, the estimator as a file would say it, and the largest n for which it is worth waiting.
const ESTIMATORS: &[(&str, &str, usize)] = &[
    ("histogram", "histogram = { width = 0.02 }", 1_000_000),
    ("naive", "naive = { bandwidth = 0.02 }", 1_000_000),
    (
        "kernel, splat",
        "kernel = { shape = \"epanechnikov\", symmetry = \"radial\", bandwidth = 0.05, engine = \"splat\" }",
        1_000_000,
    ),
    (
        "kernel, gather",
        "kernel = { shape = \"epanechnikov\", symmetry = \"radial\", bandwidth = 0.05, engine = \"gather\" }",
        1_000_000,
    ),
    (
        "kernel, direct sum",
        "kernel = { shape = \"epanechnikov\", symmetry = \"radial\", bandwidth = 0.05, engine = \"direct\" }",
        10_000,
    ),
    (
        "nearest neighbour",
        "nearest-neighbour = { k = 50 }",
        1_000_000,
    ),
    (
        "generalised nearest neighbour",
        "generalised-nearest-neighbour = { k = 50, shape = \"epanechnikov\" }",
        1_000_000,
    ),
    (
        "nearest neighbour, k = 500",
        "nearest-neighbour = { k = 500 }",
        1_000_000,
    ),
    (
        "bias compensated",
        "bias-compensated = { min = 50, max = 500 }",
        1_000_000,
    ),
    ("Lepski", "lepski = { min = 50, max = 500 }", 1_000_000),
    ("cosine series", "cosine-series = { terms = 8 }", 1_000_000),
];

fn points(n: usize) -> Vec<Point<2>> {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(1986);
    (0..n)
        .map(|i| {
            if i % 2 == 0 {
                [random.random(), random.random()]
            } else {
                [(); 2].map(|()| {
                    let z: f64 = StandardNormal.sample(&mut random);
                    (0.1 * z + 0.5).clamp(0.0, 1.0)
                })
            }
        })
        .collect()
}

fn built(text: &str, draws: usize) -> Box<dyn Estimator<2>> {
    let context = Context { truth: None, draws };
    match estimator_in(text, "the bench", &context) {
        Ok((_, estimator)) => estimator,
        Err(problems) => panic!("{text}: {problems}"),
    }
}

fn group(
    bench: &mut Criterion,
    sweep: &str,
    cases: &[(usize, usize)],
    by: fn(usize, usize) -> usize,
) {
    let one = ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("threads");
    let mut group = bench.benchmark_group(sweep);
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(700));
    for &(n, side) in cases {
        let sample = Sample::equal(points(n), Domain::unit()).expect("legal");
        let grid = Grid::new([0.0; 2], [1.0; 2], [side; 2]).expect("legal");
        group.throughput(Throughput::Elements(by(n, side * side) as u64));
        for &(name, text, most) in ESTIMATORS {
            if n > most {
                continue;
            }
            let estimator = built(text, n);
            group.bench_function(BenchmarkId::new(name, by(n, side * side)), |b| {
                b.iter(|| {
                    one.install(|| {
                        let estimate = estimator.fit(black_box(&sample)).expect("a fit");
                        estimate.on(&grid)
                    })
                });
            });
        }
    }
    group.finish();
}

fn over_points(bench: &mut Criterion) {
    let cases = [1_000, 10_000, 100_000, 1_000_000].map(|n| (n, 64));
    group(bench, "over n, m = 64²", &cases, |n, _| n);
}

fn over_places(bench: &mut Criterion) {
    let cases = [16, 32, 64, 128, 256].map(|side| (10_000, side));
    group(bench, "over m, n = 10⁴", &cases, |_, m| m);
}

/// What a rule for the number of neighbours costs beside one look for the most that it may ask for, a place: looks alone (the distance to the k-th; the k nearest, as a photon map
/// gathers them, with the k-th distance; a sorted list from the kiddo crate) and whole estimates, on an image of 256² cells from 10⁵ points.
fn a_pixel(bench: &mut Criterion) {
    const MOST: usize = 2000;
    let one = ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("threads");
    let n = 100_000;
    let sample = Sample::equal(points(n), Domain::unit()).expect("legal");
    let grid = Grid::new([0.0; 2], [1.0; 2], [256; 2]).expect("legal");
    let finder = sample.neighbours();
    let mut group = bench.benchmark_group("a pixel, k = 2000");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_secs(2))
        .throughput(Throughput::Elements(grid.len() as u64));
    group.bench_function("distance", |b| {
        let mut scratch = Scratch::default();
        b.iter(|| {
            grid.centres()
                .map(|x| finder.distance(x, MOST, &mut scratch))
                .sum::<f64>()
        });
    });
    group.bench_function("k nearest", |b| {
        let (mut scratch, mut found) = (Scratch::default(), Vec::new());
        b.iter(|| {
            grid.centres()
                .map(|x| {
                    found.clear();
                    finder.gather(x, MOST, &mut scratch, &mut found);
                    let by_distance = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0);
                    found.select_nth_unstable_by(MOST - 1, by_distance).1.0
                })
                .sum::<f64>()
        });
    });
    let tree: ImmutableKdTree<f64, 2> =
        ImmutableKdTree::new_from_slice(sample.points()).expect("finite");
    let most = NonZeroUsize::new(MOST).expect("positive");
    group.bench_function("kiddo nearest_n", |b| {
        b.iter(|| {
            grid.centres()
                .map(|x| {
                    let query = tree.query(&x);
                    let found = query.nearest_n::<SquaredEuclidean<f64>>(most).execute();
                    found.last().map_or(0.0, |hit| hit.distance)
                })
                .sum::<f64>()
        });
    });
    for (name, text) in [
        ("nearest neighbour", "nearest-neighbour = { k = 2000 }"),
        (
            "bias compensated",
            "bias-compensated = { min = 50, max = 2000 }",
        ),
        ("Lepski", "lepski = { min = 50, max = 2000 }"),
        ("nested test", "nested-test = { min = 50, max = 2000 }"),
    ] {
        let estimate = built(text, n).fit(&sample).expect("a fit");
        group.bench_function(name, |b| {
            b.iter(|| one.install(|| estimate.on(black_box(&grid))));
        });
    }
    group.finish();
}

criterion_group!(benches, over_points, over_places, a_pixel);
criterion_main!(benches);
