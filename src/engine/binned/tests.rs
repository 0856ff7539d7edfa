//! The definition judges; each answer must keep the bound that it was quoted with.

use super::*;
use crate::kernel::{Bandwidth, Shape};
use crate::sample::Sample;
use proptest::prelude::*;

fn sum(points: &[f64], weights: Option<&[f64]>, h: f64) -> KernelSum<1> {
    let points: Vec<[f64; 1]> = points.iter().map(|&x| [x]).collect();
    let sample = match weights {
        None => Sample::equal(points, Domain::whole()),
        Some(w) => Sample::new(points, Weights::Each(w.to_vec().into()), Domain::whole()),
    };
    KernelSum::new(
        sample.expect("legal"),
        Shape::Gaussian,
        Bandwidth::Fixed([h]),
    )
    .expect("legal")
}

fn grid(low: f64, high: f64, cells: usize) -> Grid<1> {
    Grid::new([low], [high], [cells]).expect("legal")
}

fn golden(n: usize) -> Vec<f64> {
    (0..n)
        .map(|i| (i as f64 * 0.618_033_988_749_895).fract())
        .collect()
}

/// Error relative to the peak (sought on the grid and at some data), and the bound. `None` where the engine refuses.
fn error(
    engine: Binned,
    sum: &KernelSum<1>,
    grid: &Grid<1>,
    tolerance: f64,
) -> Option<(f64, f64, Evaluation)> {
    let quote = engine.quote(sum, Targets::Grid(grid), tolerance).ok()?;
    let got = engine
        .prepare(sum.clone(), tolerance)
        .expect("Gaussian")
        .evaluate(Targets::Grid(grid));
    assert_eq!(
        quote.error.to_bits(),
        got.error.to_bits(),
        "the bound is known beforehand"
    );
    let exact: Vec<f64> = grid.centres().map(|x| sum.at(x)).collect();
    let data = sum.sample().points();
    let some = data
        .iter()
        .step_by(data.len().div_ceil(200))
        .map(|&x| sum.at(x));
    let peak = exact.iter().copied().chain(some).fold(0.0, f64::max);
    let worst = got
        .values
        .iter()
        .zip(&exact)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    Some((worst / peak, got.error, got))
}

#[test]
fn tolerances_are_kept_on_ordinary_grids() {
    let points: Vec<f64> = golden(3000)
        .iter()
        .map(|u| (u - 0.5) * 6.0 + (9.0 * u).sin())
        .collect();
    let weights: Vec<f64> = points.iter().map(|x| x * x).collect();
    for h in [0.02, 0.4, 5.0] {
        for cells in [1, 50, 512, 4000] {
            for tolerance in [1e-2, 1e-4, 1e-6] {
                let grid = grid(-4.0, 5.0, cells);
                for weights in [None, Some(&weights[..])] {
                    let (worst, bound, got) = error(
                        Binned::default(),
                        &sum(&points, weights, h),
                        &grid,
                        tolerance,
                    )
                    .expect("fits");
                    assert!(
                        worst <= bound && bound <= tolerance,
                        "{h} {cells} {tolerance:e}: {worst:e} {bound:e}"
                    );
                    assert!(got.warnings.is_empty());
                }
            }
        }
    }
}

#[test]
fn the_worst_single_points_come_near_the_bound() {
    // on a node and half way between two the interpolant is off by the whole of ±δ²K″/16
    let grid = grid(-1.0, 1.0, 201);
    for place in [0.0, 0.005] {
        let (worst, bound, _) = error(
            Binned::with_refinement(NonZeroUsize::MIN),
            &sum(&[place], None, 1.0),
            &grid,
            1e-8,
        )
        .expect("fits");
        assert!(worst <= bound && worst > 0.4 * bound, "{worst:e} {bound:e}");
    }
}

#[test]
fn a_forced_coarse_grid_states_its_bound_and_warns() {
    let grid = grid(-1.0, 1.0, 64);
    let points: Vec<f64> = golden(500).iter().map(|u| 1.8 * u - 0.9).collect();
    let forced = Binned::with_refinement(NonZeroUsize::MIN);
    for h in [0.5, 0.1, 0.03, 0.001] {
        let (worst, bound, got) = error(forced, &sum(&points, None, h), &grid, 1e-6).expect("fits");
        assert!(worst <= bound || bound >= 1.0, "{h}: {worst:e} {bound:e}");
        assert_eq!(got.warnings.len(), 1, "{h}");
        assert!(got.warnings[0].what.contains("too coarse"));
    }
}

#[test]
fn what_it_cannot_do_it_refuses_or_admits() {
    let narrow = sum(&golden(50), None, 1e-9);
    let grid = grid(0.0, 1.0, 100);
    let quote = Binned::default()
        .quote(&narrow, Targets::Grid(&grid), 1e-6)
        .expect("possible");
    assert!(
        quote.error > 1e-6,
        "h far below a cell cannot be binned: {quote:?}"
    );
    assert!(
        Binned::default()
            .quote(&narrow, Targets::Points(&[[0.5]]), 1e-6)
            .is_err()
    );
    let wide = sum(&golden(50), None, 1e6);
    assert!(
        Binned::default()
            .quote(&wide, Targets::Grid(&grid), 1e-6)
            .is_err()
    );
    // asked all the same, it answers by definition
    let got = Binned::default()
        .prepare(wide.clone(), 1e-6)
        .expect("Gaussian")
        .evaluate(Targets::Grid(&grid));
    assert!((got.values[7] - wide.at(grid.centre(7))).abs() <= 1e-15 * wide.at([0.0]));
}

#[test]
fn offsets_ties_and_outliers() {
    let far: Vec<f64> = golden(1000).iter().map(|u| 1e9 + 5.0 * u).collect();
    let cases = [
        (far, grid(1e9 - 1.0, 1e9 + 6.0, 300), 0.5, 1e-5),
        (vec![0.3; 2000], grid(0.0, 1.0, 100), 0.05, 1e-6),
        (vec![0.3], grid(0.0, 1.0, 100), 0.05, 1e-6),
        (
            vec![0.3, 0.4, 1e12, -1e300],
            grid(0.0, 1.0, 100),
            0.05,
            1e-6,
        ),
    ];
    for (points, grid, h, tolerance) in cases {
        let (worst, bound, _) =
            error(Binned::default(), &sum(&points, None, h), &grid, tolerance).expect("fits");
        assert!(worst <= bound && bound <= tolerance, "{worst:e} {bound:e}");
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let points: Vec<f64> = golden(600_000)
        .iter()
        .map(|u| (6.0 * u).sin() + u)
        .collect();
    let weights: Vec<f64> = points.iter().map(|x| x * x).collect();
    let run = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads")
            .install(|| {
                let mut all = Vec::new();
                for (weights, cells) in [(None, 100), (Some(&weights[..]), 100), (None, 100_000)] {
                    let field = Binned::default()
                        .prepare(sum(&points, weights, 0.02), 1e-6)
                        .expect("Gaussian");
                    all.extend(
                        field
                            .evaluate(Targets::Grid(&grid(-2.0, 3.0, cells)))
                            .values,
                    );
                }
                all.into_iter().map(f64::to_bits).collect::<Vec<_>>()
            })
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(7));
}

proptest! {
    #[test]
    fn the_bound_holds_for_random_samples(
        raw in prop::collection::vec((-1.0..1.0_f64, 0.0..1.0_f64), 1..100),
        offset in prop::sample::select(vec![0.0, 1.0, -3e4]), scale in -6..6_i32, h in -2.0..1.0_f64,
        weighted in any::<bool>(), cells in 1usize..80, tolerance in -6.0..-1.0_f64, forced in 0usize..4,
    ) {
        let scale = 10f64.powi(scale);
        let points: Vec<f64> = raw.iter().map(|(x, _)| (x * x * x + offset) * scale).collect();
        let mut weights: Vec<f64> = raw.iter().map(|(_, w)| w.powi(6)).collect();
        weights[0] += 1e-9;
        let sum = sum(&points, weighted.then_some(&weights[..]), scale * 10f64.powf(h));
        let grid = grid((offset - 1.2) * scale, (offset + 1.1) * scale, cells);
        let engine = Binned { refinement: NonZeroUsize::new(forced) };
        if let Some((worst, bound, _)) = error(engine, &sum, &grid, 10f64.powf(tolerance)) {
            prop_assert!(worst <= bound || bound >= 1.0, "{:e} {:e}", worst, bound);
        }
    }
}
