//! What holds of every known truth in the plane. A density added to the catalogue is tested here without another line.

mod calculus;
mod sampler;

use density_lab::density::{self, Bivariate};
use density_lab::parameter::{Value, Values};
use std::sync::Arc;

type Truth = Arc<dyn Bivariate>;

fn built(name: &str, settings: &[(&'static str, Value)]) -> Truth {
    let entry = density::entry(name).unwrap();
    let mut values = Values::defaults(entry.parameters);
    for (parameter, value) in settings {
        values.set(parameter, value.clone());
    }
    entry.build(&values).unwrap().plane().unwrap()
}

fn rows(names: &[&'static str], rows: &[&[f64]]) -> Value {
    let row = |numbers: &&[f64]| {
        let mut values = Values::default();
        for (name, number) in names.iter().zip(*numbers) {
            values.set(name, Value::Number(*number));
        }
        values
    };
    Value::Rows(rows.iter().map(row).collect())
}

/// Every density of the plane in the catalogue, those with parameters at several settings.
fn all() -> Vec<(String, Truth)> {
    let mut all: Vec<(String, Truth)> = density::entries()
        .filter(|entry| entry.dimensions() == 2 && entry.stands_alone())
        .map(|entry| {
            let name = entry.names[0];
            (name.to_owned(), density::named_in_plane(name).unwrap())
        })
        .collect();
    let normals = [
        "weight",
        "mean-x",
        "mean-y",
        "deviation-x",
        "deviation-y",
        "correlation",
    ];
    let number = Value::Number;
    let word = |word: &str| Value::Word(word.to_owned());
    let corners: [&[f64]; 5] = [
        &[10.0, 10.0],
        &[10.0, 11.0],
        &[11.5, 12.0],
        &[11.0, 11.0],
        &[12.0, 9.5],
    ];
    let more: [(&str, Vec<(&'static str, Value)>); 10] = [
        (
            "normal-mixture-2d",
            vec![(
                "components",
                rows(
                    &normals,
                    &[
                        &[0.5, -1.0, 0.0, 2.0 / 3.0, 1.0, 0.7],
                        &[0.3, 1.0, 1.0, 0.5, 0.4, -0.3],
                        &[0.2, 0.0, -2.0, 0.3, 0.3, 0.0],
                    ],
                ),
            )],
        ),
        (
            "normal-mixture-2d",
            vec![(
                "components",
                rows(&normals, &[&[1.0, 1e3, -1e3, 2.0, 0.5, 0.95]]),
            )],
        ),
        (
            "product",
            vec![("x", word("bimodal")), ("y", word("normal"))],
        ),
        (
            "product",
            vec![("x", word("ramp-up")), ("y", word("exponential"))],
        ),
        (
            "product",
            vec![("x", word("claw")), ("y", word("half-normal"))],
        ),
        (
            "highlight",
            vec![("share", number(0.7)), ("deviation", number(0.5))],
        ),
        ("smooth", vec![("amplitude", number(-0.95))]),
        (
            "l-shape",
            vec![("slope-x", number(0.5)), ("slope-y", number(-0.7))],
        ),
        (
            "polygon",
            vec![
                ("vertices", rows(&["x", "y"], &corners)),
                ("slope-x", number(-0.6)),
                ("slope-y", number(0.2)),
            ],
        ),
        (
            "product",
            vec![
                ("x", word("truncated-exponential")),
                ("y", word("ramp-down")),
            ],
        ),
    ];
    for (number, (name, settings)) in more.iter().enumerate() {
        all.push((format!("{name} #{number}"), built(name, settings)));
    }
    all
}

#[test]
fn what_is_no_density_is_refused_with_the_parameter_at_fault() {
    let number = Value::Number;
    let word = |word: &str| Value::Word(word.to_owned());
    let bow: [&[f64]; 4] = [&[0.0, 0.0], &[1.0, 1.0], &[1.0, 0.0], &[0.0, 1.0]];
    let normals = ["weight", "mean-x", "mean-y", "deviation-x", "correlation"];
    for (name, settings, parameter) in [
        (
            "product",
            vec![("x", word("bimodl")), ("y", word("normal"))],
            "x",
        ),
        (
            "product",
            vec![("x", word("normal")), ("y", word("highlight"))],
            "y",
        ),
        (
            "polygon",
            vec![("vertices", rows(&["x", "y"], &bow))],
            "vertices",
        ),
        ("triangle", vec![("slope-x", number(9.0))], "slope-x"),
        ("highlight", vec![("deviation", number(1e-9))], "deviation"),
        (
            "normal-mixture-2d",
            vec![("components", rows(&normals, &[&[0.5, 0.0, 0.0, 1.0, 0.0]]))],
            "components",
        ),
        (
            "normal-mixture-2d",
            vec![(
                "components",
                rows(&normals, &[&[1.0, 0.0, 0.0, 1.0, 0.9999]]),
            )],
            "components",
        ),
    ] {
        let entry = density::entry(name).unwrap();
        let mut values = Values::defaults(entry.parameters);
        for (parameter, value) in settings {
            values.set(parameter, value);
        }
        let error = entry.build(&values).err().unwrap();
        assert_eq!(error.parameter, parameter, "{name}: {}", error.what);
        assert!(!error.what.is_empty());
    }
}
