//! One question, all finders, growing n: what do the k-th distances from 256² places to n points of the plane cost?
//!
//! Building is timed apart from asking. One thread, except where the name says two. The yardstick is the k-d tree crate's own list of the k
//! nearest, in the same run. Spreads: even, and half of the points in a spot of a hundredth of the width.
//!
//! `cargo bench --bench neighbour -- 'k = 500'` runs one group, `-- cells` one finder.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use density_lab::neighbour::{Cells, Neighbours, Tree, at_each};
use density_lab::sample::Sample;
use density_lab::space::{Domain, Grid, Point};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rayon::ThreadPoolBuilder;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::Duration;

/// A shape of data.
type Spread = fn(usize) -> Vec<Point<2>>;

fn even(n: usize) -> Vec<Point<2>> {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(1986);
    (0..n).map(|_| [random.random(), random.random()]).collect()
}

fn spot(n: usize) -> Vec<Point<2>> {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(1986);
    (0..n)
        .map(|i| {
            if i % 2 == 0 {
                [random.random(), random.random()]
            } else {
                [(); 2].map(|()| {
                    let z: f64 = StandardNormal.sample(&mut random);
                    (0.01 * z + 0.5).clamp(0.0, 1.0)
                })
            }
        })
        .collect()
}

const SPREADS: [(&str, Spread); 2] = [("even", even), ("spot", spot)];

fn sample(points: &[Point<2>]) -> Sample<2> {
    Sample::equal(points.to_vec(), Domain::whole()).expect("finite")
}

fn targets() -> Vec<Point<2>> {
    let grid = Grid::new([0.0; 2], [1.0; 2], [256; 2]).expect("legal");
    grid.centres().collect()
}

fn distances(finder: &dyn Neighbours<2>, targets: &[Point<2>], k: usize) -> Vec<f64> {
    at_each(targets, |x, scratch| finder.distance(x, k, scratch))
}

fn building(bench: &mut Criterion) {
    let mut group = bench.benchmark_group("building");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1));
    for n in [10_000, 100_000, 1_000_000] {
        group.throughput(Throughput::Elements(n as u64));
        let points = even(n);
        let sample = sample(&points);
        group.bench_function(BenchmarkId::new("cells", n), |b| {
            b.iter(|| Cells::new(black_box(&sample)));
        });
        group.bench_function(BenchmarkId::new("tree", n), |b| {
            b.iter(|| Tree::new(black_box(&sample)));
        });
        group.bench_function(BenchmarkId::new("kiddo", n), |b| {
            b.iter(|| ImmutableKdTree::<f64, 2>::new_from_slice(black_box(&points)));
        });
    }
    group.finish();
}

fn asking(bench: &mut Criterion) {
    let targets = targets();
    let [one, two] = [1, 2].map(|threads| {
        ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads")
    });
    for (name, spread) in SPREADS {
        for k in [50, 500] {
            let mut group = bench.benchmark_group(format!("{name}, k = {k}"));
            group
                .sample_size(10)
                .warm_up_time(Duration::from_millis(200))
                .measurement_time(Duration::from_secs(1));
            group.throughput(Throughput::Elements(targets.len() as u64));
            for n in [10_000, 100_000, 1_000_000] {
                let points = spread(n);
                let sample = sample(&points);
                let tree = Tree::new(&sample);
                if let Some(cells) = Cells::new(&sample) {
                    group.bench_function(BenchmarkId::new("cells", n), |b| {
                        b.iter(|| one.install(|| distances(&cells, black_box(&targets), k)));
                    });
                    group.bench_function(BenchmarkId::new("cells, two threads", n), |b| {
                        b.iter(|| two.install(|| distances(&cells, black_box(&targets), k)));
                    });
                }
                group.bench_function(BenchmarkId::new("tree", n), |b| {
                    b.iter(|| one.install(|| distances(&tree, black_box(&targets), k)));
                });
                let kiddo = ImmutableKdTree::<f64, 2>::new_from_slice(&points).expect("finite");
                let many = NonZeroUsize::new(k).expect("positive");
                group.bench_function(BenchmarkId::new("kiddo nearest_n", n), |b| {
                    b.iter(|| {
                        let last = |x: &Point<2>| -> f64 {
                            let list = kiddo.query(x).nearest_n::<SquaredEuclidean<f64>>(many);
                            list.execute().last().map_or(0.0, |hit| hit.distance)
                        };
                        black_box(&targets).iter().map(last).collect::<Vec<f64>>()
                    });
                });
            }
            group.finish();
        }
    }
}

criterion_group!(benches, building, asking);
criterion_main!(benches);
