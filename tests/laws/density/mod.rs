//! What holds of every known truth. A density added to the catalogue is tested here without another line.

mod calculus;
mod catalogue;
mod sampler;

use density_lab::density::{self, Univariate};
use density_lab::parameter::{Value, Values};
use density_lab::random::stream;
use std::fmt::Write;
use std::sync::Arc;

fn built(name: &str, settings: &[(&'static str, f64)]) -> Arc<dyn Univariate> {
    let entry = density::entry(name).unwrap();
    let mut values = Values::defaults(entry.parameters);
    for &(parameter, value) in settings {
        values.set(parameter, Value::Number(value));
    }
    entry.build(&values).unwrap().line().unwrap()
}

/// (weight, mean, deviation or variance) of each component.
type Parts = Vec<(f64, f64, f64)>;

fn mixture(parts: &[(f64, f64, f64)]) -> Values {
    let row = |&(weight, mean, deviation): &(f64, f64, f64)| {
        let mut row = Values::default();
        row.set("weight", Value::Number(weight));
        row.set("mean", Value::Number(mean));
        row.set("deviation", Value::Number(deviation));
        row
    };
    let mut values = Values::default();
    values.set("components", Value::Rows(parts.iter().map(row).collect()));
    values
}

/// Every density of the catalogue, those with parameters at several settings.
fn all() -> Vec<(String, Arc<dyn Univariate>)> {
    let mut all: Vec<(String, Arc<dyn Univariate>)> = density::entries()
        .filter(|entry| entry.dimensions() == 1 && entry.stands_alone())
        .map(|entry| {
            let name = entry.names[0];
            (name.to_owned(), density::named(name).unwrap())
        })
        .collect();
    let settings: &[(&str, &[(&'static str, f64)])] = &[
        ("uniform", &[("low", -3.0), ("high", 5.0)]),
        ("exponential", &[("rate", 40.0)]),
        ("truncated-exponential", &[("rate", 0.01)]),
        ("truncated-exponential", &[("rate", 25.0)]),
        ("half-normal", &[("scale", 0.2)]),
        ("beta", &[("a", 1.0), ("b", 3.0)]),
        ("beta", &[("a", 1.0), ("b", 1.0)]),
        ("beta", &[("a", 1.5), ("b", 2.75)]),
        ("beta", &[("a", 5.0), ("b", 3.0)]),
        ("beta", &[("a", 40.5), ("b", 60.0)]),
    ];
    for (name, values) in settings {
        all.push((format!("{name} {values:?}"), built(name, values)));
    }
    let entry = density::entry("normal-mixture").unwrap();
    let far = mixture(&[(0.25, 1000.0, 2.0), (0.75, 1010.0, 0.03)]);
    all.push((
        "mixture far from 0".to_owned(),
        entry.build(&far).unwrap().line().unwrap(),
    ));
    all
}

/// Many draws are those of one at a time, to the bit, and leave the stream where those do.
#[test]
fn many_draws_are_those_of_one_at_a_time() {
    for (name, truth) in all() {
        for many in [0, 1, 255, 256, 600, 1024, 2500] {
            let (mut one, mut together) = (stream(7, "sample", 1), stream(7, "sample", 1));
            for x in truth.draws(many, &mut together) {
                let [alone] = truth.draw(&mut one);
                assert_eq!(x[0].to_bits(), alone.to_bits(), "{name}");
            }
            assert_eq!(truth.draw(&mut together), truth.draw(&mut one), "{name}");
        }
    }
}

#[test]
fn first_draws_are_frozen() {
    let mut table = String::new();
    for (name, truth) in all() {
        let mut random = stream(1986, "sample", 0);
        let drawn: Vec<String> = (0..3)
            .map(|_| format!("{:.11e}", truth.draw(&mut random)[0]))
            .collect();
        writeln!(table, "{name}: {}", drawn.join(" ")).unwrap();
    }
    insta::assert_snapshot!(table);
}
