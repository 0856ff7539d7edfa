//! Names, refusals and tabulated parameters.

use super::{Parts, mixture};
use density_lab::density::{self, Univariate};
use density_lab::parameter::{Value, Values};

#[test]
fn names_are_distinct_and_lead_to_their_density() {
    let names: Vec<&str> = density::names().collect();
    for (i, name) in names.iter().enumerate() {
        assert!(!names[i + 1..].contains(name), "{name} twice");
        assert!(density::entry(name).unwrap().names.contains(name));
    }
    for number in 1..=15 {
        let entry = density::entry(&format!("mw-{number}")).unwrap();
        assert!(entry.names.len() >= 2, "{:?}", entry.names);
    }
    assert_eq!(density::entry("bimodal").unwrap().names[0], "mw-6");
    assert_eq!(density::entry("normal").unwrap().names[0], "mw-1");
    assert!(density::named("normal-mixture").is_none() && density::named("no such").is_none());
}

#[test]
fn what_is_no_density_is_refused_with_the_parameter_at_fault() {
    let refused = |name: &str, values: Values| {
        let error = density::entry(name).unwrap().build(&values).err().unwrap();
        (error.parameter, error.what)
    };
    let with = |name: &'static str, value: f64| {
        let mut values = Values::default();
        values.set(name, Value::Number(value));
        values
    };
    for (name, values, parameter) in [
        ("uniform", with("low", 1.0), "high"),
        ("uniform", with("high", 1e-310), "high"),
        ("exponential", with("rate", 1e200), "rate"),
        ("truncated-exponential", with("rate", 701.0), "rate"),
        ("half-normal", with("scale", 1e-200), "scale"),
        ("beta", with("a", 0.5), "a"),
        ("beta", with("b", 1e4), "b"),
        ("normal-mixture", mixture(&[]), "components"),
        (
            "normal-mixture",
            mixture(&[(0.5, 0.0, 1.0), (0.4999, 1.0, 1.0)]),
            "components",
        ),
        (
            "normal-mixture",
            mixture(&[(0.5, 0.0, 1.0), (0.5, 1e9, 1.0)]),
            "components",
        ),
        (
            "normal-mixture",
            mixture(&[(1.0, f64::NAN, 1.0)]),
            "components",
        ),
    ] {
        let (at, what) = refused(name, values);
        assert_eq!(at, parameter, "{name}: {what}");
        assert!(!what.is_empty());
    }
    let nearly = mixture(&[(0.5, 0.0, 1.0), (0.5 + 1e-10, 1.0, 1.0)]);
    let entry = density::entry("normal-mixture").unwrap();
    let built = entry.build(&nearly).unwrap().line().unwrap();
    assert!((built.distribution(f64::INFINITY) - 1.0).abs() < 1e-15);
}

/// (weight, mean, variance) as tabulated by the R package HRW 1.0-5, `MarronWandParm`, written out in decimals.
#[test]
fn the_fifteen_agree_with_a_second_source() {
    let comb14 = [32.0, 16.0, 8.0, 4.0, 2.0, 1.0_f64].map(|k| k / 63.0);
    let table: [(usize, Parts); 6] = [
        (
            2,
            vec![
                (0.2, 0.0, 1.0),
                (0.2, 0.5, 4.0 / 9.0),
                (0.6, 13.0 / 12.0, 25.0 / 81.0),
            ],
        ),
        (8, vec![(0.75, 0.0, 1.0), (0.25, 1.5, 1.0 / 9.0)]),
        (
            11,
            [(0.49, -1.0, 4.0 / 9.0), (0.49, 1.0, 4.0 / 9.0)]
                .into_iter()
                .chain((0..7).map(|i| (1.0 / 350.0, f64::from(i - 3) / 2.0, 1e-4)))
                .collect(),
        ),
        (
            12,
            vec![
                (0.5, 0.0, 1.0),
                (8.0 / 31.0, -1.5, 0.16),
                (4.0 / 31.0, -0.5, 0.04),
                (2.0 / 31.0, 0.5, 0.01),
                (1.0 / 31.0, 1.5, 0.0025),
                (0.5 / 31.0, 2.5, 0.000_625),
            ],
        ),
        (
            14,
            (0..6)
                .map(|l| {
                    (
                        comb14[l],
                        (65.0 - 96.0 * 0.5f64.powi(l as i32)) / 21.0,
                        comb14[l] * comb14[l],
                    )
                })
                .collect(),
        ),
        (
            15,
            vec![
                (6.0 / 21.0, -15.0 / 7.0, 36.0 / 441.0),
                (6.0 / 21.0, -3.0 / 7.0, 36.0 / 441.0),
                (6.0 / 21.0, 9.0 / 7.0, 36.0 / 441.0),
                (1.0 / 21.0, 16.0 / 7.0, 1.0 / 441.0),
                (1.0 / 21.0, 18.0 / 7.0, 1.0 / 441.0),
                (1.0 / 21.0, 20.0 / 7.0, 1.0 / 441.0),
            ],
        ),
    ];
    for (number, parts) in table {
        let ours = density::marron_wand(number).unwrap();
        let ours = ours.normal_components().unwrap();
        assert_eq!(ours.len(), parts.len(), "mw-{number}");
        for (own, (weight, mean, variance)) in ours.iter().zip(parts) {
            let far = (own.weight - weight).abs()
                + (own.mean - mean).abs()
                + (own.deviation.powi(2) - variance).abs();
            assert!(far < 1e-14, "mw-{number}: {own:?}");
        }
    }
    let means = density::marron_wand(3).unwrap();
    let expected = [
        0.0,
        -3.0 / 3.0,
        -15.0 / 9.0,
        -57.0 / 27.0,
        -195.0 / 81.0,
        -633.0 / 243.0,
        -1995.0 / 729.0,
        -6177.0 / 2187.0,
    ];
    for (own, mean) in means.normal_components().unwrap().iter().zip(expected) {
        assert!((own.mean - mean).abs() < 1e-14);
    }
    assert!(density::marron_wand(0).is_none() && density::marron_wand(16).is_none());
}
