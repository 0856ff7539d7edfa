//! Gaussian kernels between walls of the plane: moments by cosines against those by quadrature.

use super::near;
use density_lab::density::{self, Bivariate, Density, Product, Window};
use density_lab::estimator::{Context, Estimator};
use density_lab::experiment::read::estimator_in;
use density_lab::parameter::{Value, Values};
use density_lab::space::Point;
use density_lab::theory::{Moments, WalledKernel};
use std::f64::consts::TAU;
use std::sync::Arc;

fn built(name: &str, told: &[(&'static str, Value)]) -> Arc<dyn Bivariate> {
    let entry = density::entry(name).unwrap();
    let mut values = Values::defaults(entry.parameters);
    for (key, value) in told {
        values.set(key, value.clone());
    }
    entry.build(&values).unwrap().plane().unwrap()
}

fn word(word: &str) -> Value {
    Value::Word(word.to_owned())
}

/// Of an estimate of one point by the estimator of the catalogue.
fn direct(truth: &dyn Bivariate, h: f64, boundary: &str, place: Point<2>) -> Moments {
    let told = format!("kernel = {{ bandwidth = {h}, boundary = \"{boundary}\" }}");
    let context = Context {
        truth: None,
        draws: 1,
    };
    let (_, kernel): (_, Box<dyn Estimator<2>>) =
        estimator_in(&told, "the test", &context).unwrap();
    let truth: &dyn Density<2> = truth;
    kernel.expectation(truth, 1, &[place]).unwrap()[0]
}

/// Compares at some places, in units of the larger of the moments and those of a level density.
fn agree(truth: &dyn Bivariate, boundary: &str, (first, second): (&[f64], &[f64]), within: f64) {
    let walled = WalledKernel::new(truth).unwrap();
    let [low, high] = walled.range();
    let area = truth.domain().measure();
    for h in [low, 2.0 * low, 0.4 * high, high] {
        let found = walled.moments(h, first, second);
        let places = first
            .iter()
            .flat_map(|&x| second.iter().map(move |&y| [x, y]));
        for (got, place) in found.iter().zip(places) {
            if !truth.domain().contains(place) {
                assert!(got.mean == 0.0 && got.variance == 0.0, "{place:?}");
                continue;
            }
            let expected = direct(truth, h, boundary, place);
            // waves that the narrowest of kernels would leave are not among those there are
            let within = if h > low { within } else { within.max(2e-3) };
            let mean = expected.mean.max(1.0 / area);
            assert!(
                (got.mean - expected.mean).abs() < within * mean,
                "{boundary} {h} {place:?}: {got:?} {expected:?}"
            );
            // of a kernel that is all but level the variance is a small difference
            let square = |m: &Moments| m.mean.mul_add(m.mean, m.variance);
            assert!(
                near(square(got), square(&expected), 2.0 * within),
                "{boundary} {h} {place:?}: {got:?} {expected:?}"
            );
        }
    }
}

const EVERYWHERE: ([f64; 4], [f64; 3]) = ([0.001, 0.07, 0.42, 0.995], [0.02, 0.55, 0.9]);

fn everywhere() -> (&'static [f64], &'static [f64]) {
    (&EVERYWHERE.0, &EVERYWHERE.1)
}

/// On squares, of densities with slopes at the walls and with spots.
#[test]
fn reflected_kernels_are_waves_that_fade() {
    agree(&*built("ramp-2d", &[]), "reflect", everywhere(), 1e-4);
    agree(&*built("smooth", &[]), "reflect", everywhere(), 1e-4);
    agree(
        &*built(
            "product",
            &[
                ("x", word("truncated-exponential")),
                ("y", word("ramp-down")),
            ],
        ),
        "reflect",
        everywhere(),
        1e-4,
    );
}

/// A disc with a sharp edge falls between cells: against sums over rings of it, in which no edge is between places.
#[test]
fn jumps_fall_between_cells() {
    const RADIUS: f64 = 0.12;
    const SHARE: f64 = 0.4;
    let disc = built("disc", &[]);
    let walled = WalledKernel::new(&*disc).unwrap();
    let reflected = |h: f64, x: f64, y: f64| -> f64 {
        let bump = |d: f64| (-0.5 * (d / h).powi(2)).exp() / (h * TAU.sqrt());
        let images = (-3..=3).map(|m| 2.0 * f64::from(m));
        images.map(|m| bump(x - y - m) + bump(x + y - m)).sum()
    };
    let (rings, turns, cells) = (200, 800, 8000);
    let rows: [f64; 3] = [0.001, 0.42, 0.62];
    let columns: [f64; 2] = [0.5, 0.93];
    let [low, high] = walled.range();
    for h in [low, 2.0 * low, 0.4 * high] {
        let found = walled.moments(h, &rows, &columns);
        let even = |x: f64| -> f64 {
            let all = (0..cells).map(|i| (f64::from(i) + 0.5) / f64::from(cells));
            all.map(|y| reflected(h, x, y).powi(2)).sum::<f64>() / f64::from(cells)
        };
        for (i, got) in found.iter().enumerate() {
            let (x, y) = (rows[i / 2], columns[i % 2]);
            let (mut mean, mut square, mut mass) = (0.0, 0.0, 0.0);
            for ring in 0..rings {
                let r = (f64::from(ring) + 0.5) / f64::from(rings) * RADIUS;
                for turn in 0..turns {
                    let (sine, cosine) = (TAU * f64::from(turn) / f64::from(turns)).sin_cos();
                    let at = [r.mul_add(cosine, 0.5), r.mul_add(sine, 0.5)];
                    let kernel = reflected(h, x, at[0]) * reflected(h, y, at[1]);
                    mean += r * kernel;
                    square += r * kernel * kernel;
                    mass += r;
                }
            }
            let mean = SHARE * mean / mass + 1.0 - SHARE;
            let square = SHARE * square / mass + (1.0 - SHARE) * even(x) * even(y);
            let within = if h > low { 1e-3 } else { 8e-3 };
            assert!(near(got.mean, mean, within), "{h} {x} {y}: {got:?} {mean}");
            let found = got.mean.mul_add(got.mean, got.variance);
            assert!(near(found, square, within), "{h} {x} {y}: {got:?} {square}");
        }
    }
}

/// In rooms, beside their slanted edges and inward corners, too.
#[test]
fn kernels_are_cut_and_normalised_in_polygons() {
    let slopes = [
        ("slope-x", Value::Number(1.2)),
        ("slope-y", Value::Number(-0.6)),
    ];
    agree(&*built("l-shape", &slopes), "normalise", everywhere(), 3e-3);
    agree(
        &*built("triangle", &slopes),
        "normalise",
        everywhere(),
        3e-3,
    );
}

/// Sides are told apart: on rectangles that are no squares.
#[test]
fn sides_may_differ() {
    let row = |x: f64, y: f64| {
        let mut row = Values::default();
        row.set("x", Value::Number(x));
        row.set("y", Value::Number(y));
        row
    };
    let vertices = vec![row(0.0, 0.0), row(2.0, 0.0), row(2.0, 0.5), row(0.0, 0.5)];
    let told = [
        ("vertices", Value::Rows(vertices)),
        ("slope-x", Value::Number(0.7)),
        ("slope-y", Value::Number(-0.5)),
    ];
    let places: (&[f64], &[f64]) = (&[0.01, 0.8, 1.9], &[0.04, 0.3]);
    agree(&*built("polygon", &told), "normalise", places, 3e-3);
    // a long one, whose cells are longer than wide
    let vertices = vec![row(0.0, 0.0), row(5.0, 0.0), row(5.0, 0.3), row(0.0, 0.3)];
    let told = [
        ("vertices", Value::Rows(vertices)),
        ("slope-x", Value::Number(0.2)),
    ];
    let within: (&[f64], &[f64]) = (&[0.02, 2.0, 4.97], &[0.015, 0.2]);
    agree(&*built("polygon", &told), "normalise", within, 3e-3);
    // too long for all cells there are
    let vertices = vec![row(0.0, 0.0), row(1.0, 0.0), row(1.0, 1e-3), row(0.0, 1e-3)];
    let told = [("vertices", Value::Rows(vertices))];
    assert!(WalledKernel::new(&*built("polygon", &told)).is_none());
    let view = Window::new(density::named("normal").unwrap(), 0.0, 2.0).unwrap();
    let product = Product::new([Arc::new(view), density::named("ramp-down").unwrap()]);
    agree(&product, "reflect", places, 1e-4);
}
