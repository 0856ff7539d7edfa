//! The laws of the engines of the plane: every one is judged by the definition, over all kernels, product and radial, and the cases that break sums; to add an
//! engine is to add a line to the catalogue.

mod cases;

use cases::{Case, cases, normal};
use density_lab::engine::{Direct, EXACT, Engine, PLANE};
use density_lab::kernel::{Bandwidth, KernelSum, Shape, Symmetry};
use density_lab::sample::{Sample, Weights};
use density_lab::space::{Domain, Field, Grid, Point, Targets};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// All engines but the judge.
fn judged() -> impl Iterator<Item = &'static dyn Engine<2>> {
    PLANE
        .iter()
        .copied()
        .filter(|engine| engine.name() != "direct")
}

fn sample_of(case: &Case) -> Sample<2> {
    match &case.weights {
        None => Sample::equal(case.points.clone(), Domain::whole()),
        Some(w) => Sample::new(
            case.points.clone(),
            Weights::Each(w.clone().into()),
            Domain::whole(),
        ),
    }
    .unwrap()
}

fn sum_of(case: &Case, shape: Shape, symmetry: Symmetry) -> KernelSum<2> {
    KernelSum::new(sample_of(case), shape, Bandwidth::Fixed(case.h))
        .unwrap()
        .with_symmetry(symmetry)
}

/// The largest error relative to `ceiling`, and the bound, if the engine takes the case.
fn measure(
    engine: &dyn Engine<2>,
    sum: &KernelSum<2>,
    targets: Targets<'_, 2>,
    truth: &[f64],
    tolerance: f64,
    ceiling: f64,
) -> Option<(f64, f64)> {
    let quote = engine.quote(sum, targets, tolerance).ok()?;
    let field = engine.prepare(sum.clone(), tolerance).unwrap();
    let answer = field.evaluate(targets);
    assert_eq!(answer.values.len(), targets.len());
    assert!(
        quote.nanoseconds.is_finite() && quote.error.is_finite(),
        "{quote:?}"
    );
    assert!(
        answer.values.iter().all(|v| *v >= 0.0),
        "{}: a density below zero or none",
        engine.name()
    );
    let worst = answer
        .values
        .iter()
        .zip(truth)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    Some((worst / ceiling, quote.error.max(answer.error)))
}

fn by_definition(sum: &KernelSum<2>, targets: Targets<'_, 2>) -> Vec<f64> {
    let field = Direct.prepare(sum.clone(), 0.0).unwrap();
    field.evaluate(targets).values
}

#[test]
fn every_engine_computes_the_definition_within_its_bound() {
    let mut taken = BTreeMap::new();
    for case in cases() {
        for shape in Shape::ALL {
            for symmetry in Symmetry::ALL {
                let sum = sum_of(&case, shape, symmetry);
                let ceiling = sum.ceiling().unwrap();
                for (kind, targets) in [
                    ("grid", Targets::Grid(&case.grid)),
                    ("points", Targets::Points(&case.scattered)),
                ] {
                    let truth = by_definition(&sum, targets);
                    for engine in judged() {
                        for tolerance in [EXACT, 1e-4] {
                            let Some((error, bound)) =
                                measure(engine, &sum, targets, &truth, tolerance, ceiling)
                            else {
                                continue;
                            };
                            let entry = taken
                                .entry((engine.name(), kind, symmetry.name(), shape.name()))
                                .or_insert((0, 0.0_f64, 0.0_f64));
                            if tolerance <= EXACT {
                                *entry = (entry.0 + 1, entry.1.max(error), entry.2.max(bound));
                            }
                            assert!(
                                error <= bound,
                                "{} with {symmetry} {shape} on {kind}, {}{}, tolerance {tolerance:e}: error {error:e} beyond its bound {bound:e}",
                                engine.name(),
                                case.name,
                                if case.weights.is_some() {
                                    ", weighted"
                                } else {
                                    ""
                                },
                            );
                        }
                    }
                }
            }
        }
    }
    for (key, (count, worst, bound)) in taken {
        println!("{key:?}: {count} cases, worst {worst:.1e}, loosest bound {bound:.1e}");
    }
}

/// A width that grows away from the middle.
struct Growing(Domain<2>);

impl Field<2> for Growing {
    fn domain(&self) -> &Domain<2> {
        &self.0
    }
    fn at(&self, [x, y]: Point<2>) -> f64 {
        0.1 + 0.2 * x.abs() + 0.05 * y * y
    }
}

/// A width of its own for each datum or each target.
#[test]
fn widths_that_vary_are_the_definition_too() {
    let mut taken = BTreeMap::new();
    let points = normal(1200, 40);
    let weights: Vec<f64> = points.iter().map(|[x, _]| x.sin().powi(2)).collect();
    let grid = Grid::new([-3.0, -4.0], [3.5, 4.0], [31, 44]).unwrap();
    let scattered: Vec<Point<2>> = points.iter().take(150).copied().collect();
    // over five powers of two, some of them far below a cell
    let own: Vec<f64> = points
        .iter()
        .map(|[x, y]| 0.05 * (1.2 * x.abs() + y.abs()).exp2())
        .collect();
    for weights in [None, Some(weights)] {
        let sample = match &weights {
            None => Sample::equal(points.clone(), Domain::whole()),
            Some(w) => Sample::new(
                points.clone(),
                Weights::Each(w.clone().into()),
                Domain::whole(),
            ),
        }
        .unwrap();
        for bandwidth in [
            Bandwidth::PerPoint(own.clone().into()),
            Bandwidth::PerTarget(Arc::new(Growing(Domain::whole()))),
        ] {
            for shape in Shape::ALL {
                for symmetry in Symmetry::ALL {
                    let sum = KernelSum::new(sample.clone(), shape, bandwidth.clone())
                        .unwrap()
                        .with_symmetry(symmetry);
                    for targets in [Targets::Grid(&grid), Targets::Points(&scattered)] {
                        let truth = by_definition(&sum, targets);
                        // no value of a sum of bumps of different heights comes near a ceiling: relative to the largest there is
                        let scale =
                            sum.sample().mass() * symmetry.peak::<2>(shape) / 0.05_f64.powi(2);
                        for engine in judged() {
                            if let Some((error, bound)) =
                                measure(engine, &sum, targets, &truth, EXACT, scale)
                            {
                                *taken.entry(engine.name()).or_insert(0) += 1;
                                assert!(
                                    error <= bound,
                                    "{} with {symmetry} {shape}, {bandwidth:?}: error {error:e} beyond its bound {bound:e}",
                                    engine.name()
                                );
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(taken["gather"] >= 100 && taken["splat"] >= 25, "{taken:?}");
}

/// More data than are put in order at one go, and footprints of a few cells as well as wide ones; judged at some of the cells.
#[test]
fn large_samples_are_summed_as_defined() {
    let points = normal(300_000, 60);
    let weights: Vec<f64> = points.iter().map(|[x, _]| x.sin().powi(2)).collect();
    let grid = Grid::new([-4.0, -4.0], [4.0, 4.0], [96, 80]).unwrap();
    // rows so long that no band of them fits the cache
    let long = Grid::new([-4.0, -4.0], [4.0, 4.0], [160, 1500]).unwrap();
    let mut taken = BTreeMap::new();
    for (weights, grid, h, shape, symmetry) in [
        (
            None,
            grid,
            [0.2, 0.3],
            Shape::Epanechnikov,
            Symmetry::Product,
        ),
        (None, grid, [0.3, 0.2], Shape::Uniform, Symmetry::Radial),
        (
            Some(&weights),
            grid,
            [0.2, 0.3],
            Shape::Biweight,
            Symmetry::Radial,
        ),
        (
            Some(&weights),
            grid,
            [0.9, 0.5],
            Shape::Triangular,
            Symmetry::Product,
        ),
        (None, grid, [0.15, 0.2], Shape::Gaussian, Symmetry::Product),
        (
            Some(&weights),
            long,
            [0.14, 0.02],
            Shape::Biweight,
            Symmetry::Product,
        ),
    ] {
        let case = Case {
            name: "large",
            points: points.clone(),
            weights: weights.cloned(),
            h,
            grid,
            scattered: Vec::new(),
        };
        let sum = sum_of(&case, shape, symmetry);
        let ceiling = sum.ceiling().unwrap();
        let chosen: Vec<usize> = (0..grid.len()).step_by(grid.len() / 16).collect();
        let centres: Vec<Point<2>> = grid.centres().collect();
        let places: Vec<Point<2>> = chosen.iter().map(|&cell| centres[cell]).collect();
        let truth = by_definition(&sum, Targets::Points(&places));
        for engine in judged() {
            if engine.quote(&sum, Targets::Grid(&grid), EXACT).is_err() {
                continue;
            }
            let field = engine.prepare(sum.clone(), EXACT).unwrap();
            let answer = field.evaluate(Targets::Grid(&grid));
            *taken.entry(engine.name()).or_insert(0) += 1;
            for (&cell, truth) in chosen.iter().zip(&truth) {
                let error = (answer.values[cell] - truth).abs() / ceiling;
                assert!(
                    error <= answer.error,
                    "{} with {symmetry} {shape}: error {error:e} beyond its bound {:e}",
                    engine.name(),
                    answer.error
                );
            }
        }
    }
    assert!(taken["splat"] == 6 && taken["mesh"] == 3, "{taken:?}");
}

fn on_threads(threads: usize, work: impl Fn() -> Vec<f64> + Send + Sync) -> Vec<u64> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
        .install(|| work().into_iter().map(f64::to_bits).collect())
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    let points = normal(150_000, 20);
    let weights: Vec<f64> = points.iter().map(|[x, _]| x.sin().powi(2)).collect();
    let grid = Grid::new([-4.0, -4.0], [4.0, 4.0], [120, 90]).unwrap();
    let scattered: Vec<Point<2>> = points.iter().take(300).copied().collect();
    for weights in [None, Some(weights)] {
        let case = Case {
            name: "",
            points: points.clone(),
            weights,
            h: [0.11, 0.2],
            grid,
            scattered: Vec::new(),
        };
        for (shape, symmetry) in [
            (Shape::Epanechnikov, Symmetry::Radial),
            (Shape::Epanechnikov, Symmetry::Product),
            (Shape::Uniform, Symmetry::Product),
            (Shape::Cosine, Symmetry::Product),
            (Shape::Gaussian, Symmetry::Product),
        ] {
            let sum = sum_of(&case, shape, symmetry);
            for engine in judged() {
                for targets in [Targets::Grid(&grid), Targets::Points(&scattered)] {
                    // what would take minutes is left out: a gather of the whole Gaussian
                    match engine.quote(&sum, targets, EXACT) {
                        Ok(quote) if quote.nanoseconds < 3e9 => {}
                        _ => continue,
                    }
                    let work = || {
                        let field = engine.prepare(sum.clone(), EXACT).unwrap();
                        field.evaluate(targets).values
                    };
                    let one = on_threads(1, work);
                    assert_eq!(one, on_threads(2, work), "{} {shape}", engine.name());
                    assert_eq!(one, on_threads(7, work), "{} {shape}", engine.name());
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]
    #[test]
    fn random_sums_stay_within_the_bounds(
        raw in prop::collection::vec([-10.0..10.0_f64, -10.0..10.0_f64], 1..300),
        decimals in 0..4_i32,
        h_exponents in [-2.5..1.5_f64, -2.5..1.5_f64],
        offset in prop::sample::select(vec![0.0, 1e3, -1e6, 1e9]),
        scale in prop::sample::select(vec![1.0, 1e-9, 1e9]),
        low in [-12.0..12.0_f64, -12.0..12.0_f64],
        length in [0.1..30.0_f64, 0.1..30.0_f64],
        cells in [1..40_usize, 1..40_usize],
        shape in prop::sample::select(Shape::ALL.to_vec()),
        symmetry in prop::sample::select(Symmetry::ALL.to_vec()),
        weighted in any::<bool>(),
    ) {
        // rounded to few decimals so that ties, and data at the ends of bumps, are common
        let step = 10.0_f64.powi(-decimals);
        let place = |x: f64| (if decimals < 3 { (x / step).round() * step } else { x } + offset) * scale;
        let width = |e: f64| scale * if decimals < 2 { step * 10.0_f64.powf(e).ceil() } else { 10.0_f64.powf(e) };
        let Ok(grid) = Grid::new(low.map(place), [0, 1].map(|a| place(low[a] + length[a].ceil())), cells) else {
            return Ok(());
        };
        let case = Case {
            name: "random",
            weights: weighted.then(|| raw.iter().map(|[x, _]| x.fract().abs() + 1e-3).collect()),
            points: raw.iter().map(|x| x.map(place)).collect(),
            h: h_exponents.map(width),
            grid,
            scattered: Vec::new(),
        };
        let sum = sum_of(&case, shape, symmetry);
        let [h0, h1] = case.h;
        let scattered: Vec<Point<2>> = case.points.iter().take(40).flat_map(|&[x, y]| [[x, y], [x + h0, y], [x - h0, y + h1]]).collect();
        for targets in [Targets::Grid(&grid), Targets::Points(&scattered)] {
            let truth = by_definition(&sum, targets);
            for engine in judged() {
                if let Some((error, bound)) = measure(engine, &sum, targets, &truth, EXACT, sum.ceiling().unwrap()) {
                    prop_assert!(error <= bound, "{} with {symmetry} {shape}: {error:e} beyond {bound:e}", engine.name());
                }
            }
        }
    }
}
