//! What holds of every known truth. A density added to the catalogue is tested here without another line.

use crate::chance::{equally_likely, holm, kolmogorov_smirnov, two_sided};
use density_lab::density::{self, Univariate};
use density_lab::numeric::{GaussLegendre, panels};
use density_lab::parameter::{Value, Values};
use density_lab::random::{Stream, stream};
use rayon::prelude::*;
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

/// ∫ g between two places, cut where the density needs it.
fn integral(truth: &dyn Univariate, g: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let cuts = panels(low, high, truth.breaks(0), truth.finest_scale(0));
    GaussLegendre::new(24).integrate_panels(g, &cuts)
}

fn ends(truth: &dyn Univariate) -> (f64, f64) {
    let ([low], [high]) = truth.bulk(1e-18);
    (low, high)
}

/// Probabilities in the middle and in both tails.
const PROBABILITIES: [f64; 13] = [
    1e-12,
    1e-6,
    0.001,
    0.02,
    0.1,
    0.3,
    0.5,
    0.6,
    0.77,
    0.9,
    0.99,
    0.9999,
    1.0 - 1e-9,
];

#[test]
fn the_mass_is_one_and_the_moments_are_integrals() {
    for (name, truth) in all() {
        let (low, high) = ends(&*truth);
        let mass = integral(&*truth, |x| truth.at([x]), low, high);
        assert!((mass - 1.0).abs() < 1e-12, "{name}: {mass}");
        let (mean, deviation) = truth.mean_and_deviation();
        let first = integral(&*truth, |x| (x - mean) * truth.at([x]), low, high);
        let second = integral(&*truth, |x| (x - mean).powi(2) * truth.at([x]), low, high);
        assert!(
            first.abs() < 1e-12 * (mean.abs() + deviation),
            "{name}: mean off by {first}"
        );
        assert!(
            (second.sqrt() / deviation - 1.0).abs() < 1e-11,
            "{name}: {second} {deviation}"
        );
    }
}

#[test]
fn the_distribution_function_is_the_integral() {
    for (name, truth) in all() {
        let (low, _) = ends(&*truth);
        for p in PROBABILITIES {
            let x = truth.quantile(p);
            let area = integral(&*truth, |x| truth.at([x]), low, x.max(low + 1e-300));
            let got = truth.distribution(x);
            assert!((got - area).abs() < 1e-12, "{name} at {x}: {got} {area}");
            let between = truth.probability([truth.quantile(0.2)], [x]);
            let difference = got - truth.distribution(truth.quantile(0.2));
            assert!(
                (between - difference).abs() < 1e-12,
                "{name}: {between} {difference}"
            );
        }
    }
}

/// To some units in the last place of p, and of x as far as the density lets it through; in either tail.
#[test]
fn quantiles_invert() {
    for (name, truth) in all() {
        let mut before = f64::NEG_INFINITY;
        for p in PROBABILITIES {
            let x = truth.quantile(p);
            assert!(x > before, "{name}: not ascending at {p}");
            before = x;
            let slack = |tail: f64| 1e-12 * tail + 1e-15 * (x.abs() + 1e-300) * truth.at([x]);
            if p <= 0.5 {
                let got = truth.distribution(x);
                assert!((got - p).abs() <= slack(p), "{name} at {p}: {got}");
            } else {
                let (tail, got) = (1.0 - p, truth.probability([x], [f64::INFINITY]));
                assert!(
                    (got - tail).abs() <= slack(tail),
                    "{name} above {p}: {got} {tail}"
                );
            }
        }
        let domain = truth.domain();
        assert!(truth.quantile(0.0) == domain.low()[0], "{name}");
        assert!(truth.quantile(1.0) == domain.high()[0], "{name}");
        assert!(
            [-0.1, 1.1, f64::NAN]
                .iter()
                .all(|&p| truth.quantile(p).is_nan()),
            "{name}"
        );
    }
}

#[test]
fn derivatives_are_differences() {
    for (name, truth) in all() {
        let scale = truth.finest_scale(0);
        let ([low], [high]) = truth.bulk(1e-6);
        let peak = (0..2000)
            .map(|i| truth.at([(high - low).mul_add((f64::from(i) + 0.5) / 2000.0, low)]))
            .fold(0.0, f64::max);
        let walls = [truth.domain().low()[0], truth.domain().high()[0]];
        let mut tested = 0;
        for i in 0..400 {
            let x = (high - low).mul_add((f64::from(i) + 0.5) / 400.0, low);
            let wall = walls
                .iter()
                .map(|wall| (x - wall).abs())
                .fold(f64::INFINITY, f64::min);
            // a power of the distance from a wall is smooth on the scale of that distance
            let step = (1e-3 * scale).min(5e-3 * wall);
            if wall < 1e-4 * scale {
                continue;
            }
            tested += 1;
            let f = |k: f64| truth.at([k.mul_add(step, x)]);
            // fourth order in the step
            let first = (f(-2.0) - 8.0 * f(-1.0) + 8.0 * f(1.0) - f(2.0)) / (12.0 * step);
            let second = (-f(-2.0) + 16.0 * f(-1.0) - 30.0 * f(0.0) + 16.0 * f(1.0) - f(2.0))
                / (12.0 * step * step);
            for (order, difference, slack) in [(1, first, 1e-8), (2, second, 1e-6)] {
                let got = truth.derivative(order as u32, x);
                // near a wall a power grows faster than the scale tells
                let unit = (peak / scale.powi(order)).max(got.abs());
                let rounding = 1e-14 * peak / step.powi(order);
                assert!(
                    (got - difference).abs() < slack * unit + rounding,
                    "{name} order {order} at {x}: {got} {difference}"
                );
            }
        }
        assert!(tested > 300, "{name}: only {tested} places");
    }
}

/// Finite roughness is an integral; infinite roughness has a reason that can be seen.
#[test]
fn roughness_is_the_integral_or_infinite_for_a_reason() {
    let (mut finite, mut infinite) = (0, 0);
    for (name, truth) in all() {
        let (domain, (mut low, mut high)) = (truth.domain().clone(), ends(&*truth));
        if domain.has_walls() {
            // where the density is small its slope need not be
            low = domain.low()[0];
            if domain.high()[0].is_finite() {
                high = domain.high()[0];
            }
        }
        let derivative = |order: u32, x: f64| match order {
            0 => truth.at([x]),
            _ => truth.derivative(order, x),
        };
        for order in 0..3 {
            let claimed = truth.roughness(order);
            if claimed.is_finite() {
                let got = integral(&*truth, |x| derivative(order, x).powi(2), low, high);
                assert!(
                    (got / claimed - 1.0).abs() < 1e-9,
                    "{name} order {order}: {claimed} {got}"
                );
                finite += 1;
            } else {
                let walls = [domain.low()[0], domain.high()[0]];
                let jumps = (0..order).any(|lower| {
                    walls
                        .iter()
                        .any(|&wall| wall.is_finite() && derivative(lower, wall).abs() > 1e-9)
                });
                let near = |distance: f64| {
                    let edge = |wall: f64, sign: f64| {
                        if wall.is_finite() {
                            derivative(order, sign.mul_add(distance, wall)).powi(2) * distance
                        } else {
                            0.0
                        }
                    };
                    edge(walls[0], 1.0) + edge(walls[1], -1.0)
                };
                // f⁽ʳ⁾² × distance must vanish towards a wall if its integral is to exist
                assert!(
                    jumps || near(1e-8) >= near(1e-6),
                    "{name} order {order}: why infinite?"
                );
                infinite += 1;
            }
        }
    }
    assert!(
        finite >= 55 && infinite >= 20,
        "{finite} finite, {infinite} infinite"
    );
}

#[test]
fn nothing_lies_outside_the_support_and_nothing_is_undefined() {
    for (name, truth) in all() {
        let domain = truth.domain().clone();
        let ([low], [high]) = (domain.low(), domain.high());
        for x in [
            f64::NEG_INFINITY,
            -f64::MAX,
            -1e200,
            -1e3,
            -1.0,
            -1e-300,
            -0.0,
            0.0,
            0.3,
            1.0,
            1.0 + 1e-9,
            7.0,
            1e200,
            f64::MAX,
            f64::INFINITY,
        ] {
            let values = [
                truth.at([x]),
                truth.derivative(1, x),
                truth.derivative(2, x),
            ];
            assert!(
                values.iter().all(|value| !value.is_nan()),
                "{name} at {x}: {values:?}"
            );
            assert!(values[0] >= 0.0 && values[0].is_finite(), "{name} at {x}");
            if x < low || x > high || x.is_infinite() {
                assert_eq!(values, [0.0; 3], "{name} at {x}");
            }
            let below = truth.distribution(x);
            assert!(
                (0.0..=1.0 + 1e-15).contains(&below),
                "{name} at {x}: {below}"
            );
            assert!(x > low || below == 0.0, "{name} at {x}: {below}");
            assert!(
                x < high || (below - 1.0).abs() < 1e-15,
                "{name} at {x}: {below}"
            );
            let parts = truth.probability([f64::NEG_INFINITY], [x])
                + truth.probability([x], [f64::INFINITY]);
            assert!((parts - 1.0).abs() < 1e-13, "{name} cut at {x}: {parts}");
        }
        for tail in [0.2, 1e-3, 1e-12, 1e-40, 0.0] {
            let (low, high) = truth.bulk(tail);
            assert!(
                low[0].is_finite() && high[0].is_finite() && low < high,
                "{name}"
            );
            let slack = tail * (1.0 + 1e-9) + 1e-290;
            assert!(truth.distribution(low[0]) <= slack, "{name} tail {tail}");
            assert!(
                truth.probability(high, [f64::INFINITY]) <= slack,
                "{name} tail {tail}"
            );
        }
        let mut random = stream(11, "support", 0);
        assert!(
            (0..20_000).all(|_| domain.contains(truth.draw(&mut random))),
            "{name}"
        );
        assert!(truth.univariate().is_some(), "{name}");
        assert!(truth.breaks(0).is_sorted(), "{name}");
    }
}

const DRAWS: usize = 400_000;

/// Four p-values for points that should follow `truth`: Kolmogorov and Smirnov's, Pearson's over 64 equally likely cells, mean, variance.
fn suspicions(truth: &dyn Univariate, points: &[f64]) -> [f64; 4] {
    let n = points.len() as f64;
    let probabilities: Vec<f64> = points.iter().map(|&x| truth.distribution(x)).collect();
    let mut counts = [0; 64];
    for p in &probabilities {
        counts[((p * 64.0) as usize).min(63)] += 1;
    }
    let (mean, deviation) = truth.mean_and_deviation();
    let power = |k: i32| {
        points
            .iter()
            .map(|x| ((x - mean) / deviation).powi(k))
            .sum::<f64>()
            / n
    };
    let (second, fourth) = (power(2), power(4));
    [
        kolmogorov_smirnov(probabilities),
        equally_likely(&counts),
        two_sided(power(1) * n.sqrt()),
        two_sided((second - 1.0) * n.sqrt() / (fourth - second * second).sqrt()),
    ]
}

/// The indices of the densities that any of the four tests rejects, at most one true sampler in a thousand runs of all.
fn accused(suspicions: &[[f64; 4]]) -> Vec<usize> {
    let rejected = holm(suspicions.as_flattened(), 1e-3);
    (0..suspicions.len())
        .filter(|i| rejected[4 * i..4 * i + 4].contains(&true))
        .collect()
}

#[test]
fn samplers_follow_their_distribution_and_one_percent_of_fault_is_seen() {
    let all = all();
    let tested: Vec<[[f64; 4]; 3]> = all
        .par_iter()
        .enumerate()
        .map(|(number, (_, truth))| {
            let mut random = stream(1986, "law of samplers", number as u64);
            let points: Vec<f64> = (0..DRAWS).map(|_| truth.draw(&mut random)[0]).collect();
            let (mean, deviation) = truth.mean_and_deviation();
            let moved: Vec<f64> = points
                .iter()
                .map(|x| 0.01f64.mul_add(deviation, *x))
                .collect();
            let wider: Vec<f64> = points
                .iter()
                .map(|x| 1.01f64.mul_add(x - mean, mean))
                .collect();
            [&points, &moved, &wider].map(|points| suspicions(&**truth, points))
        })
        .collect();
    let [fair, shifted, stretched] =
        [0, 1, 2].map(|kind| tested.iter().map(|of| of[kind]).collect::<Vec<_>>());
    let names = |faults: Vec<usize>| {
        faults
            .iter()
            .map(|&i| all[i].0.as_str())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(accused(&fair)), [""; 0], "{fair:?}");
    assert_eq!(
        accused(&shifted).len(),
        all.len(),
        "shifts unseen: {:?}",
        names(accused(&shifted))
    );
    assert_eq!(
        accused(&stretched).len(),
        all.len(),
        "stretches unseen: {:?}",
        names(accused(&stretched))
    );
}

/// Documented numbers of random words, so that a stream can be split by counting.
#[test]
fn draws_take_the_words_that_are_documented() {
    let words = |truth: &dyn Univariate, random: &mut Stream| {
        let before = random.get_word_pos();
        truth.draw(random);
        (random.get_word_pos() - before) / 2
    };
    for (name, truth) in all() {
        let mut random = stream(3, "words", 0);
        let taken: Vec<u128> = (0..1000).map(|_| words(&*truth, &mut random)).collect();
        if truth.normal_components().is_some() {
            assert!(taken.iter().all(|&words| words == 2), "{name}");
        } else if name.starts_with("beta") {
            let mean = taken.iter().sum::<u128>() as f64 / 1000.0;
            assert!(
                taken.iter().all(|&words| words >= 2) && mean < 4.0,
                "{name}: {mean}"
            );
        } else {
            assert!(taken.iter().all(|&words| words == 1), "{name}");
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
