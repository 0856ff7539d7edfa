//! Cross-validation in the plane.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::density;
use crate::kernel::KernelSum;
use crate::parameter::Values;
use crate::random;
use crate::space::{Domain, Field, Grid, Point};

/// Two round humps side by side, the second axis in a unit three times smaller.
fn drawn(n: usize) -> Vec<Point<2>> {
    let mut stream = random::stream(3, "lscv in the plane", 0);
    let normal = density::entry("normal-2d")
        .unwrap()
        .build(&Values::default())
        .unwrap();
    let normal = normal.plane().unwrap();
    (0..n)
        .map(|i| {
            let [x, y] = normal.draw(&mut stream);
            [x + if i % 2 == 0 { 2.0 } else { -2.0 }, 3.0 * y]
        })
        .collect()
}

fn sample(points: Vec<Point<2>>) -> Sample<2> {
    Sample::equal(points, Domain::whole()).unwrap()
}

fn select(selector: PlaneLeastSquares, sample: &Sample<2>, shape: Shape) -> ([f64; 2], usize) {
    let selection = selector.select(sample, shape).unwrap();
    match selection.bandwidth {
        Bandwidth::Fixed(h) => (h, selection.warnings.len()),
        _ => unreachable!("numbers"),
    }
}

/// ∫f̂² on a grid, and each datum left out in turn.
#[test]
fn the_criterion_is_as_written() {
    let points = drawn(24);
    let all = sample(points.clone());
    let grid = Grid::new([-12.0, -22.0], [12.0, 22.0], [480, 480]).unwrap();
    let h = [0.9, 2.2];
    for (shape, symmetry) in [
        (Shape::Gaussian, Symmetry::Product),
        (Shape::Biweight, Symmetry::Product),
        (Shape::Biweight, Symmetry::Radial),
        (Shape::Triangular, Symmetry::Radial),
    ] {
        let sum = |sample: &Sample<2>| {
            KernelSum::new(sample.clone(), shape, Bandwidth::Fixed(h))
                .unwrap()
                .with_symmetry(symmetry)
        };
        let estimate = sum(&all);
        let square: f64 = grid.centres().map(|x| estimate.at(x).powi(2)).sum();
        let left_out = |i: usize| {
            let mut others = points.clone();
            let x = others.remove(i);
            sum(&sample(others)).at(x)
        };
        let n = points.len();
        let mean: f64 = (0..n).map(left_out).sum::<f64>() / n as f64;
        let expected = square * grid.cell_measure() - 2.0 * mean;
        let got = Risk::new(&all, shape, symmetry, [1.0; 2]).exact(h);
        assert!(
            (got / expected - 1.0).abs() < 2e-4,
            "{symmetry} {shape}: {got} {expected}"
        );
    }
}

#[test]
fn the_lattice_agrees_with_the_pairs() {
    let all = sample(drawn(700));
    for (shape, symmetry, close) in [
        (Shape::Gaussian, Symmetry::Product, 1e-5),
        (Shape::Epanechnikov, Symmetry::Product, 2e-3),
        (Shape::Epanechnikov, Symmetry::Radial, 2e-3),
        (Shape::Uniform, Symmetry::Radial, 3e-2),
    ] {
        let risk = Risk::new(&all, shape, symmetry, [1.0; 2]);
        for h in [[0.35, 0.9], [0.8, 2.0], [2.0, 5.0]] {
            let (exact, glance) = (risk.exact(h), risk.glance(h));
            assert!(
                (glance / exact - 1.0).abs() < close,
                "{symmetry} {shape} {h:?}: {glance} {exact}"
            );
        }
    }
}

#[test]
fn the_least_of_the_exact_criterion_is_found() {
    let all = sample(drawn(400));
    for (shape, symmetry) in [
        (Shape::Gaussian, Symmetry::Product),
        (Shape::Epanechnikov, Symmetry::Radial),
    ] {
        let risk = Risk::new(&all, shape, symmetry, [1.0; 2]);
        let (h, warnings) = select(PlaneLeastSquares::each_axis(symmetry), &all, shape);
        assert_eq!(warnings, 0);
        let least = risk.exact(h);
        for moved in [[1.03, 1.03], [0.97, 0.97], [1.04, 0.96], [0.96, 1.04]] {
            let there = risk.exact([h[0] * moved[0], h[1] * moved[1]]);
            assert!(
                there > least,
                "{symmetry} {shape} {moved:?}: {there} {least}"
            );
        }
        // two humps on the first axis ask for a narrower kernel there than its deviation says
        assert!(h[1] / h[0] > 2.0, "{h:?}");
    }
}

#[test]
fn units_order_and_points_without_weight_change_nothing() {
    let points = drawn(250);
    let (each, common) = (
        PlaneLeastSquares::each_axis(Symmetry::Product),
        PlaneLeastSquares::common(Symmetry::Radial),
    );
    let at = |selector, points: Vec<Point<2>>| select(selector, &sample(points), Shape::Biweight).0;
    let (h, one) = (at(each, points.clone()), at(common, points.clone()));
    assert!((one[0] - one[1]).abs() < 1e-15);
    let near = |a: [f64; 2], b: [f64; 2]| (0..2).all(|i| (a[i] / b[i] - 1.0).abs() < 1e-6);
    let scaled = points.iter().map(|x| [1e-30 * x[0], 1e40 * x[1]]).collect();
    assert!(near(at(each, scaled), [1e-30 * h[0], 1e40 * h[1]]));
    let turned = points
        .iter()
        .map(|x| [0.6 * x[0] - 0.8 * x[1] + 5.0, 0.8 * x[0] + 0.6 * x[1]]);
    // the lattice, on which the search begins, does not turn with the data
    let turned = at(common, turned.collect());
    assert!(
        (turned[0] / one[0] - 1.0).abs() < 1e-4,
        "{turned:?} {one:?}"
    );
    let backwards = points.iter().rev().copied().collect();
    assert!(near(at(each, backwards), h));
    let mut more = points.clone();
    more.push([7.0, 7.0]);
    let weights = (0..=250).map(|i| f64::from(u8::from(i < 250))).collect();
    let weighted = Sample::normalised(more, weights, Domain::whole()).unwrap();
    assert!(near(select(each, &weighted, Shape::Biweight).0, h));
}

#[test]
fn ties_and_too_few_points_are_told() {
    let each = PlaneLeastSquares::each_axis(Symmetry::Product);
    // every place four times: the criterion falls without bound
    let places = drawn(100);
    let tied: Vec<Point<2>> = places.iter().flat_map(|x| [*x; 4]).collect();
    let selection = each.select(&sample(tied), Shape::Gaussian).unwrap();
    assert!(!selection.warnings.is_empty());
    assert!(matches!(selection.bandwidth, Bandwidth::Fixed(h) if h[0] > 0.1));
    let flat = places.iter().map(|x| [x[0], 1.0]).collect();
    assert!(each.select(&sample(flat), Shape::Gaussian).is_err());
    assert!(
        each.select(&sample(vec![[1.0, 2.0]]), Shape::Gaussian)
            .is_err()
    );
    for few in [2, 3, 5] {
        let chosen = each
            .select(&sample(drawn(few)), Shape::Epanechnikov)
            .unwrap();
        assert!(matches!(chosen.bandwidth, Bandwidth::Fixed(h) if h[0] > 0.0 && h[0].is_finite()));
    }
}

/// Where only the lattice is used: normal data ask for the width that theory gives, (4/(d+2))^(1/6) n^(-1/6) σ = n^(-1/6) σ, within the noise of the criterion.
#[test]
fn many_points_are_served_by_the_lattice() {
    let points: Vec<Point<2>> = drawn(20_000)
        .into_iter()
        .enumerate()
        .map(|(i, x)| [x[0] - if i % 2 == 0 { 2.0 } else { -2.0 }, x[1]])
        .collect();
    let each = PlaneLeastSquares::each_axis(Symmetry::Product);
    let (h, warnings) = select(each, &sample(points), Shape::Gaussian);
    let expected = 20_000_f64.powf(-1.0 / 6.0);
    assert_eq!(warnings, 0);
    assert!((h[0] / expected - 1.0).abs() < 0.25, "{h:?} {expected}");
    assert!(
        (h[1] / expected / 3.0 - 1.0).abs() < 0.25,
        "{h:?} {expected}"
    );
}

/// Data on lines, a tenth of the deviation apart: the common width must not be that of the density along the lines, as it is for the eruptions of Old Faithful
/// in minutes with waiting times in whole minutes.
#[test]
fn one_rounded_axis_is_told() {
    let lines = drawn(272)
        .iter()
        .map(|x| [0.1 * x[0], (10.0 * x[1] / 3.0).round()])
        .collect();
    let all = sample(lines);
    for selector in [
        PlaneLeastSquares::common(Symmetry::Radial),
        PlaneLeastSquares::common(Symmetry::Product),
    ] {
        let selection = selector.select(&all, Shape::Gaussian).unwrap();
        assert!(
            selection
                .warnings
                .iter()
                .any(|w| w.what.contains("steps of 1.000e0")),
            "{:?}",
            selection.warnings
        );
        assert!(matches!(selection.bandwidth, Bandwidth::Fixed(h) if h[0] >= 0.5));
    }
}
