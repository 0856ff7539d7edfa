//! Rays and photons per second: the empty box, the box with blocks, a mesh of 14 000 triangles; what a second thread gains; hits per second into estimates.
#![allow(missing_docs)]

#[path = "../tests/support/knobbly.rs"]
mod knobbly;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use density_lab::estimator::Context;
use density_lab::experiment::read::estimator_in;
use density_lab::light::material::cosine_direction;
use density_lab::light::scene::{Scene, Surface, read};
use density_lab::light::spectrum::Colour;
use density_lab::light::vector::Ray;
use density_lab::light::walk::{BLOCK, Power, Walk};
use density_lab::random::stream;
use density_lab::space::{Field, Grid};
use rand::RngExt;
use rayon::ThreadPoolBuilder;
use std::path::Path;
use std::time::Duration;

fn shipped(name: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes");
    read::scene(&folder.join(name)).expect("a shipped scene")
}

/// The box with a knobbly ball instead of blocks.
fn mesh() -> Scene {
    let empty = shipped("cornell-box-rgb-empty.toml");
    let mut surfaces = empty.surfaces().to_vec();
    surfaces.push(knobbly::ball());
    Scene::new(surfaces, Colour::Rgb, false).expect("a scene")
}

/// Rays as a walk has them: from surfaces, with the cosine.
fn rays(scene: &Scene, count: usize) -> Vec<Ray> {
    let mut random = stream(1, "rays", 0);
    let shapes: Vec<(usize, &Surface)> = scene.surfaces().iter().enumerate().collect();
    (0..count)
        .map(|k| {
            let (index, surface) = shapes[k % shapes.len()];
            let [choice, s, t, u, v] = std::array::from_fn(|_| random.random::<f64>());
            let (part, origin) = surface.shape.draw(choice, s, t);
            Ray {
                origin,
                direction: cosine_direction(surface.shape.normal(part, origin), u, v),
                leaving: scene.primitive(index, part),
            }
        })
        .collect()
}

fn photon(criterion: &mut Criterion) {
    let scenes = [
        ("box", shipped("cornell-box-rgb-empty.toml")),
        ("box with blocks", shipped("cornell-box-rgb.toml")),
        ("mesh", mesh()),
    ];
    let mut group = criterion.benchmark_group("rays");
    for (name, scene) in &scenes {
        let rays = rays(scene, 4096);
        group.throughput(Throughput::Elements(rays.len() as u64));
        group.bench_function(BenchmarkId::from_parameter(name), |bench| {
            bench.iter(|| {
                rays.iter()
                    .filter_map(|ray| scene.caster().nearest(ray, f64::INFINITY))
                    .map(|found| found.distance)
                    .sum::<f64>()
            });
        });
    }
    group.finish();
    for what in ["segments", "photons"] {
        let mut group = criterion.benchmark_group(what);
        for (name, scene) in &scenes {
            let walk = Walk::new(scene, Power::Same, 64 * BLOCK, 1).expect("a walk");
            let segments = walk.trace(0).ledger.segments;
            group.throughput(Throughput::Elements(if what == "photons" {
                BLOCK
            } else {
                segments
            }));
            group.bench_function(BenchmarkId::from_parameter(name), |bench| {
                bench.iter(|| walk.trace(0).records.len());
            });
        }
        group.finish();
    }
}

/// A whole walk, its hits sorted by surface, by one thread and by two: the least that another core must gain.
fn threads(criterion: &mut Criterion) {
    const PATHS: u64 = 512 * BLOCK;
    let scene = shipped("cornell-box-rgb.toml");
    let walk = Walk::new(&scene, Power::Same, PATHS, 1).expect("a walk");
    let mut group = criterion.benchmark_group("threads");
    group.throughput(Throughput::Elements(PATHS));
    group
        .sample_size(15)
        .measurement_time(Duration::from_secs(10));
    for count in [1, 2] {
        let threads = ThreadPoolBuilder::new().num_threads(count).build();
        let threads = threads.expect("threads");
        group.bench_function(BenchmarkId::from_parameter(count), |bench| {
            bench.iter(|| threads.install(|| walk.run().expect("hits").0.len()));
        });
    }
    group.finish();
}

/// The hits of a million photons on the floor into estimates on 256 × 256 places, by one thread.
fn hits(criterion: &mut Criterion) {
    let scene = shipped("cornell-box-rgb.toml");
    let walk = Walk::new(&scene, Power::Same, 1_000_000, 1).expect("a walk");
    let (hits, _) = walk.run().expect("hits");
    let (floor, _) = scene.surface("floor").expect("a floor");
    let sample = hits.sample(&scene, floor).expect("flat").expect("hits");
    let (low, high) = (sample.domain().low(), sample.domain().high());
    let grid = Grid::new(low, high, [256; 2]).expect("legal");
    let one = ThreadPoolBuilder::new().num_threads(1).build();
    let one = one.expect("threads");
    let context = Context {
        truth: None,
        draws: sample.len(),
    };
    let mut group = criterion.benchmark_group("hits");
    group.throughput(Throughput::Elements(sample.len() as u64));
    group.sample_size(10);
    for (name, text) in [
        ("histogram", "histogram = { width = 0.02 }"),
        (
            "splat",
            "kernel = { shape = \"epanechnikov\", symmetry = \"radial\", bandwidth = 0.02, engine = \"splat\" }",
        ),
        (
            "nearest neighbour, k = 50",
            "nearest-neighbour = { k = 50 }",
        ),
        (
            "nearest neighbour, k = 500",
            "nearest-neighbour = { k = 500 }",
        ),
    ] {
        let (_, estimator) = estimator_in(text, "the bench", &context).expect("an estimator");
        group.bench_function(name, |bench| {
            bench.iter(|| one.install(|| estimator.fit(&sample).expect("a fit").on(&grid)));
        });
    }
    group.finish();
}

criterion_group!(benches, photon, threads, hits);
criterion_main!(benches);
