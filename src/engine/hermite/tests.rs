//! The definition judges: compensated direct sums written out here, differences relative to the peak.

use super::*;
use crate::kernel::{Bandwidth, Shape};
use crate::numeric::Sum;
use crate::sample::Sample;
use crate::space::Grid;
use proptest::prelude::*;
use std::f64::consts::PI;

fn direct(points: &[f64], weights: Option<&[f64]>, h: f64, x: f64) -> f64 {
    let total: Sum = points
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let u = (x - p) / h;
            weights.map_or(1.0 / points.len() as f64, |w| w[i]) * (-0.5 * u * u).exp()
        })
        .collect();
    total.value() / (2.0 * PI).sqrt() / h
}

fn prepared(points: &[f64], weights: Option<&[f64]>, h: f64, tolerance: f64) -> Box<dyn Field<1>> {
    let points: Vec<[f64; 1]> = points.iter().map(|&x| [x]).collect();
    let domain = Domain::whole();
    let sample = match weights {
        None => Sample::equal(points, domain),
        Some(w) => Sample::new(points, Weights::Each(w.to_vec().into()), domain),
    };
    let sum = KernelSum::new(
        sample.expect("legal"),
        Shape::Gaussian,
        Bandwidth::Fixed([h]),
    )
    .expect("legal");
    Hermite.prepare(sum, tolerance).expect("Gaussian")
}

/// Compares with the definition for each tolerance; the peak is sought on the targets and at some data.
fn compare(
    points: &[f64],
    weights: Option<&[f64]>,
    h: f64,
    targets: Targets<'_, 1>,
    tolerances: &[f64],
) -> Result<(), String> {
    let exact: Vec<f64> = targets
        .places()
        .map(|[x]| direct(points, weights, h, x))
        .collect();
    let some = points
        .iter()
        .step_by(points.len().div_ceil(200))
        .map(|&x| direct(points, weights, h, x));
    let peak = exact.iter().copied().chain(some).fold(0.0, f64::max);
    for &tolerance in tolerances {
        let got = prepared(points, weights, h, tolerance).evaluate(targets);
        let worst = got
            .values
            .iter()
            .zip(&exact)
            .map(|(a, b)| (a - b).abs() / peak)
            .fold(0.0, f64::max);
        if got.error > tolerance || worst > got.error {
            let bound = got.error;
            return Err(format!(
                "h {h}, asked {tolerance:e}: bound {bound:e}, error {worst:e}"
            ));
        }
    }
    Ok(())
}

fn check(points: &[f64], weights: Option<&[f64]>, h: f64, targets: Targets<'_, 1>) {
    let all = [1e-4, 1e-6, 1e-10, 1e-12];
    compare(points, weights, h, targets, &all).unwrap_or_else(|what| panic!("{what}"));
}

fn golden(n: usize) -> Vec<f64> {
    (0..n)
        .map(|i| (i as f64 * 0.618_033_988_749_895).fract())
        .collect()
}

fn grid(low: f64, high: f64, cells: usize) -> Grid<1> {
    Grid::new([low], [high], [cells]).expect("legal")
}

#[test]
fn grids_of_all_sizes_against_widths_of_all_sizes() {
    let points: Vec<f64> = golden(3000)
        .iter()
        .map(|u| (u - 0.5) * 6.0 + (9.0 * u).sin())
        .collect();
    let weights: Vec<f64> = golden(3000).iter().map(|u| 1e3 * u * u).collect();
    for h in [1e-5, 1e-3, 0.03, 0.5, 4.0, 1e4] {
        for cells in [1, 7, 400] {
            let grid = grid(-4.0, 5.0, cells);
            check(&points, None, h, Targets::Grid(&grid));
            check(&points, Some(&weights), h, Targets::Grid(&grid));
        }
    }
}

#[test]
fn data_far_from_zero_cost_no_digits() {
    let points: Vec<f64> = golden(2000).iter().map(|u| 1e9 + 5.0 * u).collect();
    let grid = grid(1e9 - 1.0, 1e9 + 6.0, 300);
    for h in [0.01, 0.3] {
        check(&points, None, h, Targets::Grid(&grid));
    }
}

#[test]
fn ties_and_single_points() {
    let grid = grid(-1.0, 1.0, 101);
    check(&[0.1], None, 0.2, Targets::Grid(&grid));
    check(&[0.1], None, 1e-4, Targets::Grid(&grid));
    check(&[0.1; 1500], None, 0.05, Targets::Grid(&grid));
    check(&[0.1; 1500], Some(&[0.1; 1500]), 0.05, Targets::Grid(&grid));
    let n = 1_000_000;
    let (ties, weights) = (vec![0.3; n], vec![0.1; n]);
    let got = prepared(&ties, Some(&weights), 0.05, 1e-12).at([0.33]);
    let exact = 1e5 * direct(&[0.3], Some(&[1.0]), 0.05, 0.33);
    assert!((got / exact - 1.0).abs() < 1e-12, "{got} {exact}");
}

#[test]
fn outliers_cost_neither_memory_nor_digits() {
    let mut points = golden(2000);
    points.extend([1e12, -1e15, 1e300]);
    let grid = grid(-0.5, 1.5, 200);
    check(&points, None, 0.02, Targets::Grid(&grid));
    // targets at the data themselves, outliers included where a cell can still be told from its neighbour
    points.truncate(2001);
    let targets: Vec<[f64; 1]> = points.iter().map(|&x| [x]).collect();
    check(&points, None, 0.02, Targets::Points(&targets));
    let field = prepared(&points, None, 0.02, 1e-12);
    let peak = direct(&points, None, 0.02, 0.5);
    for x in [-10.0, -0.12, 0.0, 0.5, 1.15, 77.0, 1e12, -1e300] {
        assert!(
            (field.at([x]) - direct(&points, None, 0.02, x)).abs() <= 1e-12 * peak,
            "{x}"
        );
    }
}

#[test]
fn many_targets_use_local_expansions_and_agree() {
    let points: Vec<f64> = golden(2500).iter().map(|u| (6.0 * u).sin() + u).collect();
    let targets: Vec<[f64; 1]> = points.iter().map(|&x| [1.1 * x]).collect();
    for h in [0.05, 0.4, 3.0] {
        check(&points, None, h, Targets::Points(&targets));
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let points: Vec<f64> = golden(400_000)
        .iter()
        .map(|u| (6.0 * u).sin() + u)
        .collect();
    let weights: Vec<f64> = points.iter().map(|x| x * x).collect();
    let grid = grid(-2.0, 3.0, 777);
    let scattered: Vec<[f64; 1]> = points[..10_000].iter().map(|&x| [x]).collect();
    let run = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads")
            .install(|| {
                let mut all = Vec::new();
                for weights in [None, Some(&weights[..])] {
                    for h in [1e-5, 0.03] {
                        let field = prepared(&points, weights, h, 1e-12);
                        all.extend(field.evaluate(Targets::Grid(&grid)).values);
                        all.extend(field.evaluate(Targets::Points(&scattered)).values);
                    }
                }
                all.into_iter().map(f64::to_bits).collect::<Vec<_>>()
            })
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(7));
}

#[test]
fn what_it_cannot_do_it_refuses_with_a_reason() {
    let sample = Sample::equal(vec![[1e20], [1.0]], Domain::whole()).expect("legal");
    let sum =
        |shape, h| KernelSum::new(sample.clone(), shape, Bandwidth::Fixed([h])).expect("legal");
    let refusal = Hermite
        .prepare(sum(Shape::Biweight, 1.0), 1e-12)
        .err()
        .expect("refused");
    assert!(refusal.0.contains("biweight"), "{refusal}");
    assert!(
        Hermite
            .prepare(sum(Shape::Gaussian, 1e-300), 1e-12)
            .is_err()
    );
    let far = [[1e20]];
    assert!(
        Hermite
            .quote(&sum(Shape::Gaussian, 1.0), Targets::Points(&far), 1e-12)
            .is_err()
    );
    // asked all the same, it falls back to the definition rather than be wrong
    let values = Hermite
        .prepare(sum(Shape::Gaussian, 1.0), 1e-12)
        .expect("Gaussian")
        .evaluate(Targets::Points(&far))
        .values;
    assert!((values[0] - 0.5 / (2.0 * PI).sqrt()).abs() < 1e-15);
}

proptest! {
    #[test]
    fn random_samples_scales_offsets_and_weights(
        raw in prop::collection::vec((-1.0..1.0_f64, 0.0..1.0_f64), 1..150),
        scale in -6..6_i32, offset in prop::sample::select(vec![0.0, 1.0, -3e4, 1e7]), h in -4.0..2.0_f64,
        weighted in any::<bool>(), cells in 1usize..60, tolerance in -12..-3_i32,
    ) {
        let scale = 10f64.powi(scale);
        let points: Vec<f64> = raw.iter().map(|(x, _)| (x * x * x + offset) * scale).collect();
        let mut weights: Vec<f64> = raw.iter().map(|(_, w)| w.powi(6) * scale).collect();
        weights[0] += 1e-9 * scale;
        let h = scale * 10f64.powf(h);
        let grid = grid((offset - 1.2) * scale, (offset + 1.1) * scale, cells);
        let weights = weighted.then_some(&weights[..]);
        let outcome = compare(&points, weights, h, Targets::Grid(&grid), &[10f64.powi(tolerance)]);
        prop_assert!(outcome.is_ok(), "{:?}", outcome);
    }
}
