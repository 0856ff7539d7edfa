//! The laws of the engines of the plane: every one is judged by the definition, over all kernels, product and radial, and the cases that break sums; to add an
//! engine is to add a line to the catalogue.

use density_lab::engine::{Direct, EXACT, Engine, PLANE};
use density_lab::kernel::{Bandwidth, KernelSum, Shape, Symmetry};
use density_lab::random::stream;
use density_lab::sample::{Sample, Weights};
use density_lab::space::{Domain, Field, Grid, Point, Targets};
use proptest::prelude::*;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use std::collections::BTreeMap;
use std::sync::Arc;

/// All engines but the judge.
fn judged() -> impl Iterator<Item = &'static dyn Engine<2>> {
    PLANE
        .iter()
        .copied()
        .filter(|engine| engine.name() != "direct")
}

#[derive(Clone)]
struct Case {
    name: &'static str,
    points: Vec<Point<2>>,
    weights: Option<Vec<f64>>,
    h: [f64; 2],
    grid: Grid<2>,
    scattered: Vec<Point<2>>,
}

fn normal(n: usize, number: u64) -> Vec<Point<2>> {
    let mut random = stream(1, "plane laws", number);
    (0..n)
        .map(|_| [0; 2].map(|_| StandardNormal.sample(&mut random)))
        .collect()
}

fn moved(points: &[Point<2>], scale: [f64; 2], by: [f64; 2]) -> Vec<Point<2>> {
    points
        .iter()
        .map(|x| [0, 1].map(|axis| x[axis] * scale[axis] + by[axis]))
        .collect()
}

#[allow(clippy::too_many_lines)] // a table
fn cases() -> Vec<Case> {
    let case =
        |name, points: Vec<Point<2>>, h, (low, high, cells): ([f64; 2], [f64; 2], [usize; 2])| {
            Case {
                name,
                points,
                weights: None,
                h,
                grid: Grid::new(low, high, cells).unwrap(),
                scattered: Vec::new(),
            }
        };
    let usual = ([-4.0, -4.0], [4.0, 4.0], [32, 27]);
    let n = 800;
    let far = 1e9;
    let lattice = |step: f64| -> Vec<Point<2>> {
        (0..1600)
            .map(|i| [f64::from(i % 40), f64::from(i / 40)].map(|k| k * step))
            .collect()
    };
    let mut all = vec![
        case("normal", normal(n, 0), [0.5, 0.5], usual),
        case("stretched", normal(n, 1), [0.9, 0.3], usual),
        case(
            "cells that are not square",
            normal(n, 2),
            [0.4, 0.4],
            ([-4.0, -1.0], [4.0, 2.0], [9, 70]),
        ),
        case("narrower than a cell", normal(n, 3), [0.02, 0.03], usual),
        case("about a cell", normal(n, 4), [0.2, 0.25], usual),
        case(
            "wider than the grid",
            normal(n, 5),
            [30.0, 20.0],
            ([-1.0, -1.0], [1.5, 1.0], [21, 20]),
        ),
        case(
            "half the grid",
            normal(n, 6),
            [1.25, 1.0],
            ([-1.0, -1.0], [1.5, 1.0], [21, 20]),
        ),
        case(
            "one cell",
            normal(n, 7),
            [0.5, 0.5],
            ([0.0, 0.0], [1.0, 1.0], [1, 1]),
        ),
        case(
            "one row",
            normal(n, 8),
            [0.5, 0.2],
            ([-3.0, -0.1], [3.0, 0.1], [1, 60]),
        ),
        case(
            "one column",
            normal(n, 9),
            [0.5, 0.2],
            ([-3.0, -0.1], [3.0, 0.1], [60, 1]),
        ),
        case(
            "one point",
            vec![[0.3, -0.1]],
            [0.4, 0.7],
            ([-1.0, -1.0], [1.0, 1.0], [23, 19]),
        ),
        case(
            "identical",
            vec![[0.123_456_789, -0.3]; 9000],
            [0.4, 0.5],
            ([-1.0, -1.0], [1.0, 1.0], [23, 19]),
        ),
        case(
            "on a line",
            moved(&normal(n, 10), [1.0, 0.0], [0.0, 0.5]),
            [0.3, 0.3],
            usual,
        ),
        case(
            "identical, far",
            vec![[far + 0.1, -far]; 9000],
            [0.4, 0.5],
            ([far - 1.0, -far - 1.0], [far + 1.0, -far + 1.0], [23, 19]),
        ),
        case(
            "far from zero",
            moved(&normal(n, 11), [1.0; 2], [far, -far]),
            [0.5, 0.4],
            ([far - 4.0, -far - 4.0], [far + 4.0, -far + 4.0], [40, 33]),
        ),
        case(
            "far from zero, coarse numbers",
            moved(&normal(n, 12), [1.0; 2], [1e14, 0.0]),
            [0.9, 0.9],
            ([1e14 - 4.0, -4.0], [1e14 + 4.0, 4.0], [17, 23]),
        ),
        case(
            "all beyond the grid",
            normal(n, 13),
            [0.5, 0.5],
            ([50.0, 50.0], [60.0, 60.0], [20, 20]),
        ),
        case(
            "mostly beyond the grid",
            normal(n, 14),
            [0.5, 0.5],
            ([2.0, 0.0], [60.0, 1.0], [50, 20]),
        ),
        case(
            "wild outliers",
            {
                let mut points = normal(n, 15);
                points.extend([[1e12, 0.0], [0.0, -1e15], [1e300, -1e300], [-1e300, 1e300]]);
                points
            },
            [0.5, 0.5],
            usual,
        ),
        // h, cells and data in steps of 1/64: every third datum sits exactly on an edge
        case(
            "ties on edges",
            moved(&lattice(0.0625), [1.0; 2], [-1.0, -1.0]),
            [0.25, 0.125],
            ([-1.03125, -1.03125], [1.46875, 1.46875], [40, 40]),
        ),
        // the same in decimals, where rounding decides
        case(
            "decimal ties on edges",
            lattice(0.1),
            [0.3, 0.5],
            ([-0.05, -0.05], [3.95, 3.95], [40, 40]),
        ),
        // with h = 5 units the circle passes through the lattice points (3, 4), (5, 0) ...
        case(
            "decimal ties on circles",
            lattice(0.1),
            [0.5, 0.5],
            ([-0.05, -0.05], [3.95, 3.95], [40, 40]),
        ),
        case(
            "tiny scale",
            moved(&normal(n, 16), [1e-120; 2], [0.0; 2]),
            [0.5e-120, 0.4e-120],
            ([-4e-120, -4e-120], [4e-120, 4e-120], [30, 20]),
        ),
        case(
            "huge scale",
            moved(&normal(n, 17), [1e120; 2], [0.0; 2]),
            [0.5e120, 0.4e120],
            ([-4e120, -4e120], [4e120, 4e120], [30, 20]),
        ),
        case(
            "axes of different units",
            moved(&normal(n, 18), [1e-9, 1e9], [0.0; 2]),
            [0.5e-9, 0.4e9],
            ([-4e-9, -4e9], [4e-9, 4e9], [30, 20]),
        ),
        case(
            "heavy tails",
            normal(n, 19)
                .iter()
                .map(|x| x.map(|x| x / (1e-9 + x.sin().powi(2))))
                .collect(),
            [0.3, 0.3],
            usual,
        ),
    ];
    let weighted: Vec<Case> = all
        .iter()
        .enumerate()
        .map(|(number, case)| {
            let mut random = stream(2, "plane laws", number as u64);
            let weight = |_: &Point<2>| {
                if random.random_bool(0.1) {
                    0.0
                } else {
                    random.random::<f64>().powi(4) + 1e-6
                }
            };
            Case {
                weights: Some(case.points.iter().map(weight).collect()),
                ..case.clone()
            }
        })
        .collect();
    all.extend(weighted);
    for (number, case) in all.iter_mut().enumerate() {
        let mut random = stream(3, "plane laws", number as u64);
        let (low, high) = (case.grid.low(), case.grid.high());
        let mut targets: Vec<Point<2>> = (0..60)
            .map(|_| [0, 1].map(|a| low[a] + (high[a] - low[a]) * random.random::<f64>()))
            .collect();
        // at data, and at the very ends of their bumps
        let [h0, h1] = case.h;
        for &[x, y] in case.points.iter().take(20) {
            targets.extend([
                [x, y],
                [x - h0, y],
                [x + h0, y],
                [x, y + h1],
                [x + h0, y - h1],
            ]);
            targets.push([x + 0.6 * h0, y + 0.8 * h1]);
        }
        targets.extend([
            [low[0] - 1e3 * h0, low[1]],
            [f64::MAX, 0.0],
            [f64::MIN, f64::MAX],
        ]);
        case.scattered = targets;
    }
    all
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
