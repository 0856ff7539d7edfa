//! What does choosing a bandwidth cost, beside the estimate itself?
//!
//! Samples of a bimodal density with growing n; throughput in points of a second of processor time, so that a flat line is O(n). The yardstick is one binned estimate of the same data at a tolerance of
//! 1e-6 on 1024 cells, as `lab estimate` would make it.
//!
//! `RAYON_NUM_THREADS=1 cargo bench --bench selector -- sheather-jones` runs one selector on one thread.

mod processor_time;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use density_lab::engine::{Binned, Engine};
use density_lab::kernel::{Bandwidth, KernelSum, Shape};
use density_lab::sample::Sample;
use density_lab::selector::{CATALOGUE, named};
use density_lab::space::{Domain, Grid, Targets};
use processor_time::ProcessorTime;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use std::hint::black_box;
use std::time::Duration;

fn sample(n: usize) -> Sample<1> {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(1986);
    let points = (0..n)
        .map(|_| {
            let z: f64 = StandardNormal.sample(&mut random);
            [0.5 * z + if random.random::<bool>() { 1.0 } else { -1.0 }]
        })
        .collect();
    Sample::equal(points, Domain::whole()).expect("finite")
}

/// Those that cost many estimates stop earlier.
fn most(name: &str) -> usize {
    match name {
        "likelihood-cross-validation" => 100_000,
        "k-fold-likelihood" => 10_000,
        _ => 1_000_000,
    }
}

fn selectors(bench: &mut Criterion<ProcessorTime>) {
    let mut group = bench.benchmark_group("gaussian");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1));
    let grid = Grid::new([-4.0], [4.0], [1024]).expect("legal");
    for n in [1_000, 10_000, 100_000, 1_000_000] {
        let sample = sample(n);
        group.throughput(Throughput::Elements(n as u64));
        let h = 0.5 * (n as f64).powf(-0.2);
        let sum = KernelSum::new(sample.clone(), Shape::Gaussian, Bandwidth::Fixed([h]))
            .expect("positive");
        group.bench_function(BenchmarkId::new("one binned estimate", n), |b| {
            b.iter(|| {
                let field = Binned::AUTOMATIC
                    .prepare(black_box(sum.clone()), 1e-6)
                    .expect("Gaussian");
                field.evaluate(Targets::Grid(&grid)).values
            });
        });
        for entry in CATALOGUE.iter().filter(|entry| n <= most(entry.name)) {
            let selector = (entry.build)();
            group.bench_function(BenchmarkId::new(entry.name, n), |b| {
                b.iter(|| selector.select(black_box(&sample), Shape::Gaussian));
            });
        }
    }
    group.finish();
}

/// The criterion of least-squares cross-validation with a compact kernel at one bandwidth, the data sorted: O(n).
fn compact(bench: &mut Criterion<ProcessorTime>) {
    let mut group = bench.benchmark_group("compact, one bandwidth");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1));
    for n in [1_000, 10_000, 100_000, 1_000_000] {
        let sample = sample(n);
        let h = (n as f64).powf(-0.2);
        group.throughput(Throughput::Elements(n as u64));
        for shape in [Shape::Uniform, Shape::Epanechnikov, Shape::Biweight] {
            let criterion = named("lscv")
                .expect("known")
                .criterion(&sample, shape)
                .expect("a spread")
                .expect("has one");
            group.bench_function(BenchmarkId::new(shape.name(), n), |b| {
                b.iter(|| criterion(black_box(h)));
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = ProcessorTime::criterion();
    targets = selectors, compact
}
criterion_main!(benches);
