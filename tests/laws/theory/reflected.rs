//! Kernels that are reflected at four walls: integrated errors by cosines against moments on both axes.

use super::{named, near};
use density_lab::density::{self, Density, Univariate};
use density_lab::estimator::{Context, Estimator};
use density_lab::experiment::read::estimator_in;
use density_lab::parameter::{Value, Values};
use density_lab::theory::ReflectedError;

/// ∫m², ∫m f, ∫f² and ∫s over [0, 1], where m is the mean of a reflected kernel at a place and s that of its square: from the mean and the variance of an estimate.
fn integrals(truth: &dyn Univariate, h: f64) -> [f64; 4] {
    const CELLS: usize = 4000;
    const DRAWS: usize = 100;
    let told = format!("kernel = {{ bandwidth = {h}, boundary = \"reflect\" }}");
    let context = Context {
        truth: None,
        draws: DRAWS,
    };
    let (_, kernel): (_, Box<dyn Estimator<1>>) =
        estimator_in(&told, "the test", &context).unwrap();
    let middle = |i: usize| [(i as f64 + 0.5) / CELLS as f64];
    let places: Vec<_> = (0..CELLS).map(middle).collect();
    let truth: &dyn Density<1> = truth;
    let moments = kernel.expectation(truth, DRAWS, &places).unwrap();
    let mut sums = [0.0; 4];
    for (m, &x) in moments.iter().zip(&places) {
        let f = truth.at(x);
        let square = m.variance.mul_add(DRAWS as f64, m.mean * m.mean);
        for (sum, term) in sums
            .iter_mut()
            .zip([m.mean * m.mean, m.mean * f, f * f, square])
        {
            *sum += term / CELLS as f64;
        }
    }
    sums
}

/// Of a product of a decay, which has all frequencies, and a ramp: in the plane means and squares are products of those on the axes.
#[test]
fn sums_over_cosines_are_products_of_integrals() {
    let names = ["truncated-exponential", "ramp-down"];
    let mut values = Values::default();
    for (axis, name) in ["x", "y"].into_iter().zip(names) {
        values.set(axis, Value::Word(name.to_owned()));
    }
    let built = density::entry("product").unwrap().build(&values);
    let truth = built.unwrap().plane().unwrap();
    let errors = ReflectedError::new(&*truth).unwrap();
    let draws = 400.0;
    for h in [0.03, 0.1, 0.2] {
        let [first, second] = names.map(|name| integrals(&*named(name), h));
        let [m, both, f, square] = [0, 1, 2, 3].map(|i: usize| first[i] * second[i]);
        let found = errors.at(h, draws);
        let (bias, variance) = (m - 2.0 * both + f, (square - m) / draws);
        assert!(
            near(found.variance, variance, 1e-4),
            "{h}: {found:?} {variance}"
        );
        assert!(
            near(found.squared_bias, bias, 1e-3),
            "{h}: {found:?} {bias}"
        );
    }
}
