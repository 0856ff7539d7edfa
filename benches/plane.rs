//! The kernel estimate of n standard normal points of the plane on a grid of 256 × 256 cells: what does each engine cost?
//!
//! Data are made and samples checked outside the timed loop; what is timed is `prepare` and `evaluate` together, in processor time (`processor_time.rs`), on one thread unless RAYON_NUM_THREADS says otherwise.
//!
//! `cargo bench --bench plane -- 'product'` runs one group, `-- splat` one engine.

mod processor_time;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use density_lab::engine::{Direct, Engine, Gather, HermiteGrid, Mesh, Splat};
use density_lab::kernel::{Bandwidth, KernelSum, Shape, Symmetry};
use density_lab::sample::Sample;
use density_lab::space::{Domain, Grid, Point, Targets};
use processor_time::ProcessorTime;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::hint::black_box;
use std::time::Duration;

/// Cells of the output grid on each axis, between -4 and 4.
const CELLS: usize = 256;

/// One line of the plot.
struct Contestant {
    name: &'static str,
    engine: &'static dyn Engine<2>,
    shape: Shape,
    symmetry: Symmetry,
    /// Of the bandwidth for normal data.
    wide: f64,
    tolerance: f64,
    /// Larger n are left out: they would take minutes.
    most: usize,
}

/// Compact kernels.
fn compact(symmetry: Symmetry) -> Vec<Contestant> {
    let line = |name, engine, shape, wide, most| Contestant {
        name,
        engine,
        shape,
        symmetry,
        wide,
        tolerance: 1e-12,
        most,
    };
    let best = Shape::Epanechnikov;
    let mut all = vec![
        line("direct", &Direct as &dyn Engine<2>, best, 1.0, 1000),
        line("gather", &Gather, best, 1.0, 100_000),
        line("splat", &Splat, best, 1.0, usize::MAX),
        line("splat, narrow", &Splat, best, 0.4, usize::MAX),
        line("splat, biweight", &Splat, Shape::Biweight, 1.0, usize::MAX),
        line("splat, wide", &Splat, best, 4.0, 100_000),
    ];
    if symmetry == Symmetry::Product {
        all.push(line("mesh", &Mesh, best, 1.0, usize::MAX));
        all.push(line(
            "mesh, biweight",
            &Mesh,
            Shape::Biweight,
            1.0,
            usize::MAX,
        ));
        all.push(line("mesh, wide", &Mesh, best, 4.0, usize::MAX));
    }
    all
}

/// The Gaussian.
fn gaussian() -> Vec<Contestant> {
    let line = |name, engine, tolerance, most| Contestant {
        name,
        engine,
        shape: Shape::Gaussian,
        symmetry: Symmetry::Product,
        wide: 1.0,
        tolerance,
        most,
    };
    vec![
        line("direct", &Direct as &dyn Engine<2>, 1e-15, 1000),
        line("splat 1e-12", &Splat, 1e-12, usize::MAX),
        line("splat 1e-3", &Splat, 1e-3, usize::MAX),
        line("hermite 1e-12", &HermiteGrid, 1e-12, usize::MAX),
        line("hermite 1e-6", &HermiteGrid, 1e-6, usize::MAX),
        line("hermite 1e-3", &HermiteGrid, 1e-3, usize::MAX),
    ]
}

fn points(n: usize) -> Vec<Point<2>> {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(1986);
    (0..n)
        .map(|_| [0; 2].map(|_| StandardNormal.sample(&mut random)))
        .collect()
}

/// h = n^(-1/6) for a standard normal sample, in the scale of each kernel.
fn sum(points: &[Point<2>], line: &Contestant) -> KernelSum<2> {
    let scale = line.symmetry.canonical_scale::<2>(line.shape)
        / Symmetry::Product.canonical_scale::<2>(Shape::Gaussian);
    let h = line.wide * scale * (points.len() as f64).powf(-1.0 / 6.0);
    let sample = Sample::equal(points.to_vec(), Domain::whole()).expect("finite");
    KernelSum::new(sample, line.shape, Bandwidth::Fixed([h; 2]))
        .expect("positive")
        .with_symmetry(line.symmetry)
}

fn over_a_grid(bench: &mut Criterion<ProcessorTime>, name: &str, contestants: &[Contestant]) {
    let grid = Grid::new([-4.0; 2], [4.0; 2], [CELLS; 2]).expect("legal");
    let mut group = bench.benchmark_group(name);
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    for n in (3..=6).map(|exponent| 10usize.pow(exponent)) {
        let points = points(n);
        group.throughput(Throughput::Elements(n as u64));
        for line in contestants.iter().filter(|line| n <= line.most) {
            let sum = sum(&points, line);
            group.bench_function(BenchmarkId::new(line.name, n), |b| {
                b.iter(|| {
                    let field = line
                        .engine
                        .prepare(black_box(sum.clone()), line.tolerance)
                        .expect("supported");
                    field.evaluate(Targets::Grid(&grid)).values
                });
            });
        }
    }
    group.finish();
}

fn all(bench: &mut Criterion<ProcessorTime>) {
    if std::env::var_os("RAYON_NUM_THREADS").is_none() {
        rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build_global()
            .expect("built once");
    }
    over_a_grid(bench, "plane, product", &compact(Symmetry::Product));
    over_a_grid(bench, "plane, radial", &compact(Symmetry::Radial));
    over_a_grid(bench, "plane, gaussian", &gaussian());
}

criterion_group! {
    name = benches;
    config = ProcessorTime::criterion();
    targets = all
}
criterion_main!(benches);
