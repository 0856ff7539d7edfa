//! What the map of radii and the three estimates must do.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::estimator::built;
use crate::parameter::Value;
use crate::random::{open_unit, stream};
use crate::sample::Weights;

fn points(n: usize, spot: f64) -> Vec<Point<2>> {
    let mut random = stream(43, "texture", n as u64);
    (0..n)
        .map(|i| {
            let [u, v] = [(); 2].map(|()| open_unit(&mut random));
            if (i as f64) < spot * n as f64 {
                let radius = 0.04 * (-2.0 * u.ln()).sqrt();
                let (sine, cosine) = (std::f64::consts::TAU * v).sin_cos();
                [0.5 + radius * cosine, 0.5 + radius * sine].map(|x| x.clamp(0.0, 1.0))
            } else {
                [u, v]
            }
        })
        .collect()
}

fn kernel(set: &[(&'static str, Value)]) -> VariableKernel {
    built(set)
}

fn word(word: &str) -> Value {
    Value::Word(word.to_owned())
}

/// Step 6: each kernel holds exactly its weight on the texture, at walls and corners too, in every channel.
#[test]
fn energy_is_kept_to_the_last_digits() {
    let points = points(6000, 0.4);
    let n = points.len();
    let red: Vec<f64> = (0..n).map(|i| 0.1 + (i % 7) as f64).collect();
    let blue: Vec<f64> = (0..n).map(|i| (i % 3) as f64).collect();
    let sample =
        Sample::with_channels(points, vec![red.clone(), blue.clone()], Domain::unit()).unwrap();
    let estimate = kernel(&[("cells", Value::Count(48))]).fit(&sample).unwrap();
    let grid = Grid::new([0.0; 2], [1.0; 2], [48; 2]).unwrap();
    let total = |field: &dyn Field<2>| field.on(&grid).integral();
    let (sum_red, sum_blue): (f64, f64) = (red.iter().sum(), blue.iter().sum());
    assert!((total(estimate.channel(0).unwrap()) / sum_red - 1.0).abs() < 1e-10);
    assert!((total(estimate.channel(1).unwrap()) / sum_blue - 1.0).abs() < 1e-10);
    assert!((total(&estimate) / (sum_red + sum_blue) - 1.0).abs() < 1e-10);
}

/// The trap: of all sizes the largest window, which holds the whole spot wherever it is shifted to, looks best at the spot; searching upward finds a small one.
#[test]
fn the_least_error_of_all_sizes_is_a_trap() {
    let sample = Sample::equal(points(20_000, 0.8), Domain::unit()).unwrap();
    let settings = |search: &str| {
        kernel(&[
            ("search", word(search)),
            ("half-width", Value::Count(40)),
            ("sizes", Value::Count(16)),
            ("median", Value::Count(1)),
        ])
    };
    let radius = |search: &str| {
        let estimate = settings(search).fit(&sample).unwrap();
        estimate
            .evaluate(Targets::Points(&[[0.5, 0.5]]))
            .sizes
            .unwrap()[0]
    };
    let (upward, least) = (radius("upward"), radius("least"));
    assert!(upward < 0.05 && least > 4.0 * upward, "{upward} {least}");
}

#[test]
fn radii_are_small_at_the_spot_and_large_in_the_flat() {
    let sample = Sample::equal(points(60_000, 0.4), Domain::unit()).unwrap();
    for estimate in Output::NAMES {
        let fitted = kernel(&[("estimate", word(estimate))])
            .fit(&sample)
            .unwrap();
        let evaluation = fitted.evaluate(Targets::Points(&[[0.5, 0.5], [0.12, 0.85]]));
        let sizes = evaluation.sizes.unwrap();
        assert!(sizes[1] > 2.0 * sizes[0], "{estimate}: {sizes:?}");
        // 0.4 / (2π 0.04²) + 0.6 at the peak
        let [peak, flat] = evaluation.values[..] else {
            panic!()
        };
        assert!(
            (peak / 40.4 - 1.0).abs() < 0.25 && (flat / 0.6 - 1.0).abs() < 0.25,
            "{estimate}: {peak} {flat}"
        );
    }
}

#[test]
fn a_point_of_double_weight_is_two_points() {
    let mut twice = points(500, 0.5);
    let n = twice.len();
    let weights: Vec<f64> = (0..n).map(|i| if i < 100 { 2.0 } else { 1.0 }).collect();
    let heavy = Sample::new(twice.clone(), Weights::Each(weights.into()), Domain::unit()).unwrap();
    twice.extend_from_within(..100);
    let repeated = Sample::new(twice, Weights::Equal(1.0), Domain::unit()).unwrap();
    let rule = kernel(&[("cells", Value::Count(32))]);
    let (heavy, repeated) = (rule.fit(&heavy).unwrap(), rule.fit(&repeated).unwrap());
    for i in 0..50 {
        let x = [f64::from(i % 7) / 7.0, f64::from(i) / 50.0];
        assert!((heavy.at(x) - repeated.at(x)).abs() < 1e-9, "{x:?}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let sample = Sample::equal(points(70_000, 0.4), Domain::unit()).unwrap();
    let grid = Grid::new([0.0; 2], [1.0; 2], [40; 2]).unwrap();
    let bits = |threads: usize| -> Vec<u64> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let estimate = kernel(&[("cells", Value::Count(40))]).fit(&sample).unwrap();
            estimate
                .on(&grid)
                .values()
                .iter()
                .map(|v| v.to_bits())
                .collect()
        })
    };
    let one = bits(1);
    assert!(one == bits(2) && one == bits(7));
}

#[test]
fn one_point_and_points_in_a_row_have_estimates_or_a_reason() {
    let one = Sample::equal(vec![[0.3, 0.3]], Domain::unit()).unwrap();
    for estimate in Output::NAMES {
        let fitted = kernel(&[("estimate", word(estimate)), ("cells", Value::Count(8))])
            .fit(&one)
            .unwrap();
        assert!(fitted.at([0.3, 0.3]) > 0.0, "{estimate}");
    }
    // no extent on one axis, and no walls to say how far it goes
    let row = Sample::equal(vec![[0.0, 1.0], [1.0, 1.0]], Domain::whole()).unwrap();
    assert!(matches!(
        kernel(&[]).fit(&row).map(|_| ()),
        Err(FitError::Degenerate(_))
    ));
}

/// Where there are no walls the estimate ends without a jump, and holds all mass.
#[test]
fn without_walls_it_fades_and_keeps_its_mass() {
    let moved = |x: &Point<2>| x.map(|x| x + 1e6);
    let points: Vec<Point<2>> = points(300, 0.3).iter().map(moved).collect();
    let sample = Sample::equal(points, Domain::whole()).unwrap();
    let estimate = kernel(&[("cells", Value::Count(10))]).fit(&sample).unwrap();
    // linear on each quarter of a cell of the texture, whose cells are about a tenth wide
    let grid = Grid::new([1e6 - 0.2; 2], [1e6 + 1.2; 2], [700; 2]).unwrap();
    assert!((estimate.on(&grid).integral() - 1.0).abs() < 1e-3);
    let values: Vec<f64> = (0..70_000)
        .map(|i| estimate.at([1e6 - 0.2 + f64::from(i) * 2e-5, 1e6 + 0.5]))
        .collect();
    let jump = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let peak = values.iter().copied().fold(0.0, f64::max);
    assert!(jump.fold(0.0, f64::max) < 1e-3 * peak && values[0] == 0.0);
}

#[test]
fn filters_without_a_middle_are_refused() {
    let mut values = Values::defaults(VariableKernel::PARAMETERS);
    values.set("median", Value::Count(4));
    let context = Context {
        truth: None,
        draws: 1,
    };
    assert!(VariableKernel::build(&values, &context).is_err_and(|e| e.parameter == "median"));
}

/// What would not fit is refused before anything is held, and the reason says what to change.
#[test]
fn a_texture_that_does_not_fit_is_refused() {
    let large = kernel(&[("cells", Value::Count(4096))]);
    // 10⁷ points in three channels: not a texture for each 65 536 of them
    assert!(large.bytes(10_000_000, 4) < 7 << 30);
    if crate::memory::available() == u64::MAX {
        return;
    }
    let channels = vec![vec![1.0; 2]; 4096];
    let points = vec![[0.2, 0.2], [0.7, 0.4]];
    let sample = Sample::with_channels(points, channels, Domain::unit()).unwrap();
    let Err(FitError::TooLarge(reason)) = large.fit(&sample).map(|_| ()) else {
        panic!("4096 channels of 4096² cells, twice, are a tebibyte")
    };
    for part in ["4096 × 4096 cells", "4096 channels", "fewer `cells`"] {
        assert!(reason.contains(part), "{reason}");
    }
}

/// Windows and kernels know rectangles; along the other edges of a polygon half of each would lie outside.
#[test]
fn polygons_are_refused_where_mass_would_be_lost() {
    let triangle = Domain::polygon(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).unwrap();
    let inside = points(4000, 0.0).into_iter().filter(|x| x[0] + x[1] < 1.0);
    let sample = Sample::equal(inside.collect(), triangle).unwrap();
    let fit = |estimate: &str| {
        let kernel = kernel(&[("estimate", word(estimate)), ("cells", Value::Count(32))]);
        kernel.fit(&sample)
    };
    for estimate in ["splat", "window"] {
        let refused = fit(estimate).map(|_| ());
        assert!(
            matches!(&refused, Err(FitError::Degenerate(reason)) if reason.contains("polygon")),
            "{estimate}: {refused:?}"
        );
    }
    // even light of density 2, away from the edges
    let value = fit("nearest-neighbours").unwrap().at([0.3, 0.3]);
    assert!((value / 2.0 - 1.0).abs() < 0.35, "{value}");
}
