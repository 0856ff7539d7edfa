//! One question, all engines, growing n: what does the kernel estimate of n standard normal points cost?
//!
//! Data are made and samples checked outside the timed loop; what is timed is `prepare` and `evaluate` together, that is all work that depends
//! on the data. Throughput is in points of a second of processor time (`processor_time.rs`), so that a flat line is O(n). The histogram of the same data is the yardstick.
//!
//! `cargo bench --bench engine -- 'gaussian on a grid'` runs one group, `-- hermite` one engine.

mod processor_time;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use density_lab::engine::{Binned, Direct, Engine, Hermite, Interval, Sorted};
use density_lab::kernel::{Bandwidth, KernelSum, Shape};
use density_lab::sample::Sample;
use density_lab::space::{Domain, Grid, Point, Targets, binning};
use processor_time::ProcessorTime;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::hint::black_box;
use std::time::Duration;

/// Cells of the output grid.
const CELLS: usize = 1024;

/// One line of the plot.
struct Contestant {
    name: &'static str,
    engine: Box<dyn Engine<1>>,
    shape: Shape,
    tolerance: f64,
    /// Larger n are left out: the definition would take minutes.
    most: usize,
}

fn contestant(
    name: &'static str,
    engine: impl Engine<1> + 'static,
    shape: Shape,
    tolerance: f64,
    most: usize,
) -> Contestant {
    Contestant {
        name,
        engine: Box::new(engine),
        shape,
        tolerance,
        most,
    }
}

/// Add an engine here.
fn on_a_grid() -> Vec<Contestant> {
    let gaussian = Shape::Gaussian;
    vec![
        contestant("direct", Direct, gaussian, 1e-15, 10_000),
        contestant("hermite 1e-12", Hermite, gaussian, 1e-12, usize::MAX),
        contestant("hermite 1e-10", Hermite, gaussian, 1e-10, usize::MAX),
        contestant("hermite 1e-6", Hermite, gaussian, 1e-6, usize::MAX),
        contestant("binned 1e-6", Binned::default(), gaussian, 1e-6, usize::MAX),
        contestant("binned 1e-4", Binned::default(), gaussian, 1e-4, usize::MAX),
    ]
}

/// Engines of compact kernels on the same grid. Add an engine here.
fn compact_on_a_grid() -> Vec<Contestant> {
    let best = Shape::Epanechnikov;
    vec![
        contestant("direct", Direct, best, 1e-12, 10_000),
        contestant("interval", Interval, best, 1e-12, usize::MAX),
        contestant(
            "interval, triweight",
            Interval,
            Shape::Triweight,
            1e-12,
            usize::MAX,
        ),
        contestant("sorted", Sorted, best, 1e-12, usize::MAX),
    ]
}

/// The same at the data.
fn compact_at_the_data() -> Vec<Contestant> {
    let best = Shape::Epanechnikov;
    vec![
        contestant("direct", Direct, best, 1e-12, 1000),
        contestant("sorted", Sorted, best, 1e-12, 1_000_000),
    ]
}

/// Engines for targets at the data themselves, as in cross-validation.
fn at_the_data() -> Vec<Contestant> {
    vec![
        contestant("direct", Direct, Shape::Gaussian, 1e-15, 1000),
        contestant("hermite 1e-12", Hermite, Shape::Gaussian, 1e-12, 1_000_000),
        contestant("hermite 1e-6", Hermite, Shape::Gaussian, 1e-6, 1_000_000),
    ]
}

fn points(n: usize) -> Vec<Point<1>> {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(1986);
    (0..n)
        .map(|_| [StandardNormal.sample(&mut random)])
        .collect()
}

/// Silverman's h for a standard normal sample, in the scale of each kernel.
fn sum(points: &[Point<1>], shape: Shape) -> KernelSum<1> {
    use density_lab::kernel::Kernel;
    let scale = shape.canonical_scale() / Shape::Gaussian.canonical_scale();
    let h = 0.9 * (points.len() as f64).powf(-0.2) * scale;
    let sample = Sample::equal(points.to_vec(), Domain::whole()).expect("finite");
    KernelSum::new(sample, shape, Bandwidth::Fixed([h])).expect("positive")
}

fn sizes() -> impl Iterator<Item = usize> {
    (3..=7).map(|exponent| 10usize.pow(exponent))
}

fn grid(bench: &mut Criterion<ProcessorTime>) {
    over_a_grid(bench, "gaussian on a grid", &on_a_grid());
    over_a_grid(bench, "compact on a grid", &compact_on_a_grid());
}

fn scattered(bench: &mut Criterion<ProcessorTime>) {
    over_the_data(bench, "gaussian at the data", &at_the_data());
    over_the_data(bench, "compact at the data", &compact_at_the_data());
}

fn over_a_grid(bench: &mut Criterion<ProcessorTime>, name: &str, contestants: &[Contestant]) {
    let grid = Grid::new([-5.5], [5.5], [CELLS]).expect("legal");
    let mesh = binning::Mesh {
        origin: -5.5,
        width: grid.width(0),
        first: 0.0,
        count: CELLS,
    };
    let mut group = bench.benchmark_group(name);
    for n in sizes() {
        let points = points(n);
        group.throughput(Throughput::Elements(n as u64));
        group.bench_function(BenchmarkId::new("histogram", n), |b| {
            b.iter(|| binning::count(black_box(points.as_flattened()), mesh));
        });
        for c in contestants.iter().filter(|c| n <= c.most) {
            let sum = sum(&points, c.shape);
            group.bench_function(BenchmarkId::new(c.name, n), |b| {
                b.iter(|| {
                    let field = c
                        .engine
                        .prepare(black_box(sum.clone()), c.tolerance)
                        .expect("supported");
                    field.evaluate(Targets::Grid(&grid)).values
                });
            });
        }
    }
    group.finish();
}

fn over_the_data(bench: &mut Criterion<ProcessorTime>, name: &str, contestants: &[Contestant]) {
    let mut group = bench.benchmark_group(name);
    for n in sizes() {
        let points = points(n);
        group.throughput(Throughput::Elements(n as u64));
        for c in contestants.iter().filter(|c| n <= c.most) {
            let sum = sum(&points, c.shape);
            group.bench_function(BenchmarkId::new(c.name, n), |b| {
                b.iter(|| {
                    let field = c
                        .engine
                        .prepare(black_box(sum.clone()), c.tolerance)
                        .expect("supported");
                    field.evaluate(Targets::Points(&points)).values
                });
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    // not in the groups, which would not listen to --warm-up-time and --measurement-time
    config = ProcessorTime::criterion()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = grid, scattered
}
criterion_main!(benches);
