//! The laws of engines: an engine changes what a result costs, never what it means. Every engine of the line is judged by the definition, over
//! every kernel and the cases that break sums; to add an engine is to add a line to the catalogue.

use density_lab::engine::{Direct, EXACT, Engine, LINE};
use density_lab::kernel::{Bandwidth, KernelSum, Shape};
use density_lab::random::stream;
use density_lab::sample::{Sample, Weights};
use density_lab::space::{Domain, Grid, Point, Targets};
use proptest::prelude::*;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

/// All engines but the judge.
fn judged() -> impl Iterator<Item = &'static dyn Engine<1>> {
    LINE.iter()
        .copied()
        .filter(|engine| engine.name() != "direct")
}

struct Case {
    name: &'static str,
    points: Vec<f64>,
    weights: Option<Vec<f64>>,
    h: f64,
    grid: (f64, f64, usize),
    scattered: Vec<f64>,
}

fn normal(n: usize, number: u64) -> Vec<f64> {
    let mut random = stream(1, "engine laws", number);
    (0..n).map(|_| StandardNormal.sample(&mut random)).collect()
}

#[allow(clippy::too_many_lines)] // a table
fn cases() -> Vec<Case> {
    let case = |name, points, h, grid| Case {
        name,
        points,
        weights: None,
        h,
        grid,
        scattered: Vec::new(),
    };
    let lattice = |n: usize, step: f64| {
        (0..n)
            .map(|i| (i % 200) as f64 * step - 3.0)
            .collect::<Vec<_>>()
    };
    let mut all = vec![
        case("normal", normal(6_000, 0), 0.3, (-5.0, 5.0, 256)),
        case(
            "narrower than a cell",
            normal(6_000, 1),
            0.01,
            (-4.0, 4.0, 100),
        ),
        case("about a cell", normal(5_000, 2), 0.081, (-4.0, 4.0, 100)),
        case(
            "wider than the grid",
            normal(5_000, 3),
            30.0,
            (-1.0, 1.5, 64),
        ),
        case("half the grid", normal(5_000, 4), 1.25, (-1.0, 1.5, 64)),
        case("one cell", normal(5_000, 5), 0.5, (0.0, 1.0, 1)),
        case("one cell, narrow", normal(5_000, 6), 0.05, (-2.0, 4.0, 1)),
        case("one point", vec![0.3], 0.4, (-1.0, 1.0, 77)),
        case(
            "identical",
            vec![0.123_456_789; 30_000],
            0.2,
            (-1.0, 1.0, 128),
        ),
        case(
            "identical, far",
            vec![1e9 + 0.1; 30_000],
            0.2,
            (1e9 - 1.0, 1e9 + 1.0, 128),
        ),
        case(
            "far from zero",
            normal(6_000, 7).iter().map(|x| x + 1e9).collect(),
            0.3,
            (1e9 - 5.0, 1e9 + 5.0, 200),
        ),
        case(
            "far from zero, coarse numbers",
            normal(5_000, 8).iter().map(|x| x + 1e14).collect(),
            0.9,
            (1e14 - 5.0, 1e14 + 5.0, 37),
        ),
        case(
            "all beyond the grid",
            normal(5_000, 9),
            0.5,
            (50.0, 60.0, 100),
        ),
        case(
            "mostly beyond the grid",
            normal(5_000, 10),
            0.5,
            (2.0, 60.0, 100),
        ),
        case(
            "wild outliers",
            normal(2_000, 11)
                .into_iter()
                .chain([1e12, -1e15, 1e300, -1e300])
                .collect(),
            0.3,
            (-5.0, 5.0, 256),
        ),
        // h, cells and data in steps of 1/64: every third datum sits exactly on a breakpoint
        case(
            "ties on breakpoints",
            lattice(10_000, 0.015_625),
            0.25,
            (-3.031_25, 0.968_75, 128),
        ),
        // the same in decimals, where rounding decides
        case(
            "decimal ties on breakpoints",
            (0..10_000).map(|i| f64::from(i % 300) / 100.0).collect(),
            0.25,
            (-0.005, 2.995, 300),
        ),
        case(
            "decimal ties, windows wider than the grid",
            (0..10_000).map(|i| f64::from(i % 300) / 100.0).collect(),
            0.65,
            (0.995, 1.595, 60),
        ),
        case(
            "decimal ties, midpoints",
            (0..10_000).map(|i| f64::from(i % 30) / 10.0).collect(),
            0.35,
            (0.0, 3.0, 60),
        ),
        case(
            "tiny scale",
            normal(5_000, 12).iter().map(|x| x * 1e-200).collect(),
            0.3e-200,
            (-5e-200, 5e-200, 90),
        ),
        case(
            "huge scale",
            normal(5_000, 13).iter().map(|x| x * 1e200).collect(),
            0.3e200,
            (-5e200, 5e200, 90),
        ),
        case(
            "in order",
            {
                let mut x = normal(6_000, 14);
                x.sort_by(f64::total_cmp);
                x
            },
            0.3,
            (-5.0, 5.0, 256),
        ),
        case(
            "heavy tails",
            normal(6_000, 15)
                .iter()
                .map(|x| x / (1e-9 + x.sin().powi(2)))
                .collect(),
            0.1,
            (-5.0, 5.0, 256),
        ),
    ];
    let weighted: Vec<Case> = all
        .iter()
        .enumerate()
        .map(|(number, case)| {
            let mut random = stream(2, "engine laws", number as u64);
            Case {
                name: case.name,
                points: case.points.clone(),
                weights: Some(
                    case.points
                        .iter()
                        .map(|_| {
                            if random.random_bool(0.1) {
                                0.0
                            } else {
                                random.random::<f64>().powi(4)
                            }
                        })
                        .collect(),
                ),
                h: case.h,
                grid: case.grid,
                scattered: Vec::new(),
            }
        })
        .collect();
    all.extend(weighted);
    for (number, case) in all.iter_mut().enumerate() {
        let mut random = stream(3, "engine laws", number as u64);
        let (low, high, _) = case.grid;
        let mut targets: Vec<f64> = (0..60)
            .map(|_| low + (high - low) * random.random::<f64>())
            .collect();
        // at data, and at the very ends of their bumps
        for &x in case.points.iter().take(40) {
            targets.extend([x, x - case.h, x + case.h]);
        }
        targets.extend([low - 1e3 * case.h, high + 1e3 * case.h, f64::MAX, f64::MIN]);
        case.scattered = targets;
    }
    all
}

fn sum_of(case: &Case, shape: Shape) -> KernelSum<1> {
    let points: Vec<Point<1>> = case.points.iter().map(|&x| [x]).collect();
    let sample = match &case.weights {
        None => Sample::equal(points, Domain::whole()),
        Some(w) => Sample::new(points, Weights::Each(w.clone().into()), Domain::whole()),
    };
    KernelSum::new(sample.unwrap(), shape, Bandwidth::Fixed([case.h])).unwrap()
}

/// The largest error relative to the ceiling, if the engine takes the case.
fn measure(
    engine: &dyn Engine<1>,
    sum: &KernelSum<1>,
    targets: Targets<'_, 1>,
    truth: &[f64],
    tolerance: f64,
) -> Option<(f64, f64)> {
    let quote = engine.quote(sum, targets, tolerance).ok()?;
    let answer = engine
        .prepare(sum.clone(), tolerance)
        .unwrap()
        .evaluate(targets);
    assert_eq!(answer.values.len(), targets.len());
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
    Some((
        worst / sum.ceiling().unwrap(),
        quote.error.max(answer.error),
    ))
}

#[test]
fn every_engine_computes_the_definition_within_its_bound() {
    let mut taken = std::collections::BTreeMap::new();
    for case in cases() {
        let (low, high, cells) = case.grid;
        let grid = Grid::new([low], [high], [cells]).unwrap();
        let scattered: Vec<Point<1>> = case.scattered.iter().map(|&x| [x]).collect();
        for shape in Shape::ALL {
            let sum = sum_of(&case, shape);
            for (kind, targets) in [
                ("grid", Targets::Grid(&grid)),
                ("points", Targets::Points(&scattered)),
            ] {
                let truth = Direct
                    .prepare(sum.clone(), 0.0)
                    .unwrap()
                    .evaluate(targets)
                    .values;
                for engine in judged() {
                    for tolerance in [EXACT, 1e-6] {
                        let Some((error, bound)) =
                            measure(engine, &sum, targets, &truth, tolerance)
                        else {
                            continue;
                        };
                        let entry = taken
                            .entry((engine.name(), shape.name(), kind))
                            .or_insert((0, 0.0_f64));
                        if tolerance <= EXACT {
                            *entry = (entry.0 + 1, entry.1.max(error));
                        }
                        assert!(
                            error <= bound,
                            "{} with {shape} on {kind}, {}{}: error {error:e} beyond its bound {bound:e}",
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
    for (key, (count, worst)) in taken {
        println!("{key:?}: {count} cases, worst {worst:.1e}");
    }
}

/// Samples that engines cut into lanes, which they do from some 65 000 data on, at few places.
#[test]
fn large_samples_are_summed_as_defined() {
    let points = normal(150_000, 30);
    let weights: Vec<f64> = points.iter().map(|x| x.cos().powi(2)).collect();
    let grid = Grid::new([-3.0], [3.0], [20]).unwrap();
    let scattered: Vec<Point<1>> = points.iter().step_by(5_000).map(|&x| [x]).collect();
    for (weights, shapes) in [
        (
            None,
            &[Shape::Epanechnikov, Shape::Uniform, Shape::Gaussian][..],
        ),
        (Some(weights), &[Shape::Triangular][..]),
    ] {
        let case = Case {
            name: "",
            points: points.clone(),
            weights,
            h: 0.1,
            grid: (0.0, 0.0, 0),
            scattered: Vec::new(),
        };
        for &shape in shapes {
            let sum = sum_of(&case, shape);
            for targets in [Targets::Grid(&grid), Targets::Points(&scattered)] {
                let judge = Direct.prepare(sum.clone(), 0.0).unwrap();
                let truth = judge.evaluate(targets).values;
                for engine in judged() {
                    if let Some((error, bound)) = measure(engine, &sum, targets, &truth, EXACT) {
                        assert!(
                            error <= bound,
                            "{} with {shape}: {error:e} beyond {bound:e}",
                            engine.name()
                        );
                    }
                }
            }
        }
    }
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
    let points = normal(700_000, 20);
    let weights: Vec<f64> = points.iter().map(|x| x.sin().powi(2)).collect();
    let grid = Grid::new([-4.0], [4.0], [300]).unwrap();
    let scattered: Vec<Point<1>> = points.iter().take(300).map(|&x| [x]).collect();
    for weights in [None, Some(weights)] {
        let case = Case {
            name: "",
            points: points.clone(),
            weights,
            h: 0.2,
            grid: (0.0, 0.0, 0),
            scattered: Vec::new(),
        };
        for shape in [
            Shape::Epanechnikov,
            Shape::Triangular,
            Shape::Cosine,
            Shape::Gaussian,
        ] {
            let sum = sum_of(&case, shape);
            for engine in judged() {
                for targets in [Targets::Grid(&grid), Targets::Points(&scattered)] {
                    if engine.quote(&sum, targets, EXACT).is_err() {
                        continue;
                    }
                    let work = || {
                        engine
                            .prepare(sum.clone(), EXACT)
                            .unwrap()
                            .evaluate(targets)
                            .values
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
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn random_sums_stay_within_the_bounds(
        points in prop::collection::vec(-10.0..10.0_f64, 1..600),
        decimals in 0..4_i32,
        h_exponent in -3.0..2.0_f64,
        offset in prop::sample::select(vec![0.0, 1e3, -1e6, 1e9]),
        scale in prop::sample::select(vec![1.0, 1e-9, 1e9]),
        (low, length, cells) in (-12.0..12.0_f64, 0.1..30.0_f64, 1..300_usize),
        shape in prop::sample::select(Shape::ALL.to_vec()),
        weighted in any::<bool>(),
    ) {
        // rounded to few decimals so that ties, and data at the ends of bumps, are common
        let step = 10.0_f64.powi(-decimals);
        let place = |x: f64| (if decimals < 3 { (x / step).round() * step } else { x } + offset) * scale;
        let case = Case {
            name: "random",
            weights: weighted.then(|| points.iter().map(|x| x.fract().abs() + 1e-3).collect()),
            points: points.iter().map(|&x| place(x)).collect(),
            h: scale * if decimals < 2 { step * (10.0_f64.powf(h_exponent)).ceil() } else { 10.0_f64.powf(h_exponent) },
            grid: (0.0, 0.0, 0),
            scattered: Vec::new(),
        };
        let Ok(grid) = Grid::new([place(low)], [place(low + length.ceil())], [cells]) else { return Ok(()) };
        let sum = sum_of(&case, shape);
        let scattered: Vec<Point<1>> = case.points.iter().take(50).flat_map(|&x| [[x], [x + case.h], [x - case.h]]).collect();
        for targets in [Targets::Grid(&grid), Targets::Points(&scattered)] {
            let truth = Direct.prepare(sum.clone(), 0.0).unwrap().evaluate(targets).values;
            for engine in judged() {
                if let Some((error, bound)) = measure(engine, &sum, targets, &truth, EXACT) {
                    prop_assert!(error <= bound, "{} with {shape}: {error:e} beyond {bound:e}", engine.name());
                }
            }
        }
    }
}
