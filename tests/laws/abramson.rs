//! Abramson's estimator: the order of its bias, by quadrature with the true pilot, and its claims against chance.

use density_lab::density::{self, Univariate};
use density_lab::estimator::{Abramson, Build, Context, Described, Estimator};
use density_lab::kernel::Shape;
use density_lab::numeric::{GaussLegendre, special::normal_density};
use density_lab::parameter::{Value, Values};
use density_lab::random::stream;
use density_lab::sample::Sample;
use density_lab::space::{Domain, Field, Grid};
use density_lab::theory::{adaptive_moments, geometric_mean, kernel_moments};
use rayon::prelude::*;
use std::sync::Arc;

fn normal() -> Arc<dyn Univariate> {
    density::named("normal").unwrap()
}

/// E f̂(x) - f(x) with the biweight and h(y) = h max(f(y)/g, clip)^(-1/2).
fn bias(h: f64, clip: f64, x: f64) -> f64 {
    let truth = normal();
    let g = geometric_mean(&*truth);
    let width = |y: f64| h * (normal_density(y) / g).max(clip).powf(-0.5);
    // where φ = clip · g
    let bend = (-2.0 * (clip * g * (2.0 * std::f64::consts::PI).sqrt()).ln()).sqrt();
    let moments = adaptive_moments(&*truth, Shape::Biweight, width, &[-bend, bend], 1.0, x);
    moments.mean - normal_density(x)
}

/// The least-squares slope of log |b| against log h at eight geometric steps.
fn slope(bias: impl Fn(f64) -> f64, [low, high]: [f64; 2]) -> f64 {
    let points: Vec<(f64, f64)> = (0..8)
        .map(|i| {
            let h: f64 = low * (high / low).powf(f64::from(i) / 7.0);
            (h.ln(), bias(h).abs().ln())
        })
        .collect();
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / 8.0;
    let (a, b) = (mean(&|p| p.0), mean(&|p| p.1));
    mean(&|p| (p.0 - a) * (p.1 - b)) / mean(&|p| (p.0 - a).powi(2))
}

/// exp(∫ φ log φ) = (2πe)^(-1/2).
#[test]
fn the_geometric_mean_of_a_normal_is_the_one_on_paper() {
    let exact = (2.0 * std::f64::consts::PI * std::f64::consts::E).powf(-0.5);
    assert!((geometric_mean(&*normal()) - exact).abs() < 1e-13);
    let uniform = density::named("uniform").unwrap();
    assert!((geometric_mean(&*uniform) - 1.0).abs() < 1e-13);
}

#[test]
fn the_bias_is_of_fourth_order_where_that_of_a_fixed_width_is_of_second() {
    let truth = normal();
    for x in [0.0, 0.5_f64] {
        let fourth = slope(|h| bias(h, 0.1, x), [0.05, 0.2]);
        assert!((3.9..=4.1).contains(&fourth), "at {x}: {fourth}");
        let fixed =
            |h: f64| kernel_moments(&*truth, Shape::Biweight, h, 1.0, x).mean - normal_density(x);
        let second = slope(fixed, [0.05, 0.2]);
        assert!((second - 2.0).abs() < 0.02, "at {x}: {second}");
    }
}

/// h⁴ (k₄/24) (1/f)'''' g², where (1/f)'''' = √2π (3 + 6x² + x⁴) exp(x²/2) and k₄ = 1/21 for the biweight.
#[test]
fn the_bias_is_its_leading_term_for_a_small_bandwidth() {
    let rule = GaussLegendre::new(16);
    let k4 = rule.integrate(
        |u| u.powi(4) * 15.0 / 16.0 * (1.0 - u * u).powi(2),
        -1.0,
        1.0,
    );
    assert!((k4 - 1.0 / 21.0).abs() < 1e-14);
    let g = geometric_mean(&*normal());
    for x in [0.0, 0.5_f64] {
        let h = 0.05_f64;
        let fourth = (3.0 + 6.0 * x * x + x.powi(4)) / normal_density(x);
        let leading = h.powi(4) * k4 / 24.0 * fourth * g * g;
        let ratio = bias(h, 0.1, x) / leading;
        assert!((ratio - 1.0).abs() < 0.02, "at {x}: {ratio}");
    }
}

/// Without the clip, bumps from far out reach everywhere and the order is lost. [Terrell & Scott 1992; Hall, Hu & Marron 1995]
#[test]
fn without_a_clip_distant_bumps_destroy_the_order() {
    let unclipped = slope(|h| bias(h, 1e-12, 0.0), [0.05, 0.2]);
    assert!(unclipped < 3.0, "{unclipped}");
}

fn estimator(pilot: Value, clip: f64) -> Abramson {
    let mut values = Values::defaults(<Abramson>::PARAMETERS);
    values.set("bandwidth", Value::Number(0.4));
    values.set("shape", Value::Word("biweight".to_owned()));
    values.set("pilot", pilot);
    values.set("clip", Value::Number(clip));
    let context = Context {
        truth: Some(normal() as Arc<dyn density::Density<1>>),
        draws: 50,
    };
    <Abramson>::build(&values, &context).unwrap()
}

/// With the truth as pilot the estimator claims its mean and variance; forty thousand samples agree within four standard errors, with and without a clip
/// that bends the widths.
#[test]
fn what_is_claimed_with_the_true_pilot_is_what_happens() {
    const REPLICATES: u64 = 40_000;
    let truth = normal();
    let places = [[-2.2], [-1.0], [0.0], [0.7], [1.6]];
    for clip in [0.1, 0.9] {
        let estimator = estimator(Value::Word("truth".to_owned()), clip);
        assert!(estimator.laws().linear);
        let claims = estimator.expectation(&*truth, 50, &places).unwrap();
        let mut sums = [[0.0; 3]; 5];
        for replicate in 0..REPLICATES {
            let mut random = stream(5, "abramson", replicate);
            let points = (0..50).map(|_| truth.draw(&mut random)).collect();
            let sample = Sample::equal(points, Domain::whole()).unwrap();
            let estimate = estimator.fit(&sample).unwrap();
            for ((place, claim), sums) in places.iter().zip(&claims).zip(&mut sums) {
                let e = estimate.at(*place) - claim.mean;
                sums[0] += e;
                sums[1] += e * e;
                sums[2] += e.powi(4);
            }
        }
        let n = REPLICATES as f64;
        for (sums, claim) in sums.iter().zip(&claims) {
            let [first, second, fourth] = sums.map(|sum| sum / n);
            let mean = first / (second / n).sqrt();
            let variance = (second - claim.variance) / ((fourth - second * second) / n).sqrt();
            assert!(
                mean.abs() < 4.0 && variance.abs() < 4.0,
                "{mean} {variance}"
            );
        }
    }
}

/// Sample point, not balloon: wide bumps in the tails keep their mass.
#[test]
fn the_widths_are_those_of_the_data_and_keep_the_mass() {
    let points: Vec<[f64; 1]> = (0..60)
        .map(|i| [(f64::from(i) * 0.618).fract().powi(4) * 9.0])
        .collect();
    let sample = Sample::equal(points, Domain::whole()).unwrap();
    let estimate = estimator(Value::Number(0.5), 0.0).fit(&sample).unwrap();
    let Some(density_lab::kernel::Bandwidth::PerPoint(widths)) = &estimate.bandwidth else {
        panic!("a width a point")
    };
    let (least, most) = widths
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(a, b), &h| (a.min(h), b.max(h)));
    assert!(most > 2.0 * least, "{least} {most}");
    // Σ log hᵢ = n log h, as g is the geometric mean
    let mean = widths.iter().map(|h| h.ln()).sum::<f64>() / 60.0;
    assert!((mean.exp() / 0.4 - 1.0).abs() < 1e-12);
    let rule = GaussLegendre::new(8);
    let cuts: Vec<f64> = (0..=6000).map(|i| f64::from(i) * 0.003 - 5.0).collect();
    let mass = rule.integrate_panels(|x| estimate.at([x]), &cuts);
    assert!((mass - 1.0).abs() < 1e-6, "{mass}");
}

/// The mean of ∫(f̂ - f)² over `many` samples of `draws` points less `claimed`, in standard errors.
fn apart<const D: usize>(
    truth: &dyn density_lab::density::Density<D>,
    estimator: &dyn Estimator<D>,
    (draws, many): (usize, u64),
    grid: &Grid<D>,
    claimed: f64,
) -> f64 {
    let values: Vec<f64> = grid.centres().map(|x| truth.at(x)).collect();
    let cell = grid.cell_measure();
    let errors: Vec<f64> = (0..many)
        .into_par_iter()
        .map(|replicate| {
            let mut random = stream(2027, "adaptive error", replicate);
            let points = truth.draws(draws, &mut random);
            let sample = Sample::equal(points, truth.domain().clone()).unwrap();
            let estimate = estimator.fit(&sample).unwrap().on(grid);
            let squares = estimate.values().iter().zip(&values);
            squares.map(|(a, b)| (a - b).powi(2)).sum::<f64>() * cell
        })
        .collect();
    let n = many as f64;
    let mean = errors.iter().sum::<f64>() / n;
    let variance = errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean - claimed) / (variance / n).sqrt()
}

/// Exact integrated errors against chance, on a line and in the plane, and a claim that is 5 % too low, which is caught.
#[test]
fn integrated_errors_are_those_of_estimates() {
    let numbers = |h: f64| {
        let mut values = Values::defaults(Abramson::<1>::PARAMETERS);
        values.set("bandwidth", Value::Number(h));
        values.set("pilot", Value::Word("truth".to_owned()));
        values
    };
    let (draws, h) = (60, 0.4);
    let line = density::named("bimodal").unwrap();
    let context = Context::<1> {
        truth: Some(line.clone()),
        draws,
    };
    let estimator = Abramson::<1>::build(&numbers(h), &context).unwrap();
    let errors = estimator.family().unwrap().errors(&*line).unwrap();
    let mise = errors.at(h, draws as f64).unwrap().mise();
    let grid = Grid::new([-5.0], [5.0], [250]).unwrap();
    let found = |claimed| apart(&*line, &estimator, (draws, 6000), &grid, claimed);
    assert!(found(mise).abs() < 4.0, "{}", found(mise));
    assert!(found(0.95 * mise) > 4.0);

    let (draws, h) = (50, 0.6);
    let plane = density::named_in_plane("normal-2d").unwrap();
    let context = Context::<2> {
        truth: Some(plane.clone()),
        draws,
    };
    let estimator = Abramson::<2>::build(&numbers(h), &context).unwrap();
    let errors = estimator.family().unwrap().errors_in_plane(&*plane);
    let mise = errors.unwrap().at(h, draws as f64).unwrap().mise();
    let grid = Grid::new([-5.0; 2], [5.0; 2], [32, 32]).unwrap();
    let found = |claimed| apart(&*plane, &estimator, (draws, 3000), &grid, claimed);
    assert!(found(mise).abs() < 4.0, "{}", found(mise));
    assert!(found(0.95 * mise) > 4.0);
}
