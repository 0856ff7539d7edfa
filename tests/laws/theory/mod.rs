//! The exact error theory: against published numbers, against itself by other routes, and against chance.

mod binned;
mod limits;
mod optimum;
mod pointwise;
mod walled;

use density_lab::density::{self, Univariate};
use density_lab::kernel::Shape;
use density_lab::parameter::{Value, Values};
use density_lab::theory::KernelError;
use std::sync::Arc;

fn named(name: &str) -> Arc<dyn Univariate> {
    density::named(name).unwrap()
}

fn beta(a: f64, b: f64) -> Arc<dyn Univariate> {
    let mut values = Values::default();
    values.set("a", Value::Number(a));
    values.set("b", Value::Number(b));
    density::entry("beta")
        .unwrap()
        .build(&values)
        .unwrap()
        .line()
        .unwrap()
}

fn gaussian(name: &str) -> KernelError {
    KernelError::new(&*named(name), Shape::Gaussian)
}

fn near(got: f64, expected: f64, relative: f64) -> bool {
    (got / expected - 1.0).abs() < relative
}

/// Agreement to as many significant digits as are given.
fn digits(got: f64, expected: f64, significant: i32) -> bool {
    let unit = 10f64.powi(expected.abs().log10().floor() as i32 + 1 - significant);
    (got - expected).abs() <= 0.5001 * unit
}
