//! What holds of every known truth in the plane. A density added to the catalogue is tested here without another line.

use crate::chance::{holm, two_sided};
use density_lab::density::{self, Bivariate};
use density_lab::numeric::{GaussLegendre, Sum, panels};
use density_lab::parameter::{Value, Values};
use density_lab::random::{Stream, open_unit, stream};
use density_lab::space::Point;
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};
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
    let more: [(&str, Vec<(&'static str, Value)>); 9] = [
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
    ];
    for (number, (name, settings)) in more.iter().enumerate() {
        all.push((format!("{name} #{number}"), built(name, settings)));
    }
    all
}

const WHOLE: [Point<2>; 2] = [[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]];

/// A place in the bulk.
fn somewhere(truth: &dyn Bivariate, tail: f64, random: &mut Stream) -> Point<2> {
    let (low, high) = truth.bulk(tail);
    [0, 1].map(|k: usize| open_unit(random).mul_add(high[k] - low[k], low[k]))
}

/// The least deviation, which sets the scale for what is small.
fn deviation(truth: &dyn Bivariate) -> f64 {
    let (_, covariance) = truth.mean_and_covariance();
    covariance[0][0].min(covariance[1][1]).sqrt()
}

/// Probabilities add up over parts and are, of a small box, its area times the density: so they are the integral of the density.
#[test]
fn probabilities_are_the_integral_of_the_density() {
    all().par_iter().for_each(|(name, truth)| {
        let mut random = stream(7, "boxes", 0);
        let total = truth.probability(WHOLE[0], WHOLE[1]);
        assert!((total - 1.0).abs() < 1e-12, "{name}: {total}");
        for _ in 0..50 {
            let cut = somewhere(&**truth, 1e-3, &mut random);
            let sum: Sum = (0..4)
                .map(|quarter| {
                    let (mut low, mut high) = (WHOLE[0], WHOLE[1]);
                    for k in 0..2 {
                        if quarter >> k & 1 == 0 {
                            high[k] = cut[k];
                        } else {
                            low[k] = cut[k];
                        }
                    }
                    let part = truth.probability(low, high);
                    assert!((-1e-15..=1.0 + 1e-12).contains(&part), "{name}: {part}");
                    part
                })
                .collect();
            assert!((sum.value() - 1.0).abs() < 1e-12, "{name}: cut at {cut:?}");
        }
        let finest = truth.finest_scale(0).min(truth.finest_scale(1));
        let side = 1e-3 * finest.min(deviation(&**truth));
        let peak = (0..2000)
            .map(|_| truth.at(somewhere(&**truth, 1e-3, &mut random)))
            .fold(0.0, f64::max);
        let (mut tested, mut skipped) = (0, 0);
        while tested < 500 {
            let x = somewhere(&**truth, 1e-3, &mut random);
            let corner = |a: f64, b: f64| truth.at([x[0] + a * side, x[1] + b * side]);
            let around = [
                corner(0.5, 0.5),
                corner(-0.5, 0.5),
                corner(0.5, -0.5),
                corner(-0.5, -0.5),
            ];
            let f = truth.at(x);
            // a jump runs through the box
            if around
                .iter()
                .any(|v| (v - f).abs() > 0.01 * f + 1e-5 * peak)
            {
                skipped += 1;
                assert!(skipped < 200, "{name}: jumps everywhere");
                continue;
            }
            tested += 1;
            let (low, high) = (x.map(|x| x - side / 2.0), x.map(|x| x + side / 2.0));
            let mean = truth.probability(low, high) / ((high[0] - low[0]) * (high[1] - low[1]));
            assert!(
                (mean - f).abs() < 2e-6 * (f + peak),
                "{name} at {x:?}: {mean} {f}"
            );
        }
    });
}

#[test]
fn derivatives_are_differences() {
    all().par_iter().for_each(|(name, truth)| {
        let mut random = stream(8, "differences", 0);
        let finest = truth.finest_scale(0).min(truth.finest_scale(1));
        let step = 3e-3 * finest;
        let mut scale = [0.0_f64; 2];
        let mut found = Vec::new();
        for _ in 0..400 {
            let x = somewhere(&**truth, 1e-2, &mut random);
            let f = |a: f64, b: f64| truth.at([a.mul_add(step, x[0]), b.mul_add(step, x[1])]);
            let gradient = truth.gradient(x);
            let laplacian = truth.laplacian(x);
            scale[0] = scale[0]
                .max(gradient[0].hypot(gradient[1]))
                .max(truth.at(x) * 1e-3 / finest);
            scale[1] = scale[1]
                .max(laplacian.abs())
                .max(truth.at(x) * 1e-3 / (finest * finest));
            // fourth-order differences
            let first = |a: f64, b: f64| {
                (8.0 * (f(a, b) - f(-a, -b)) - (f(2.0 * a, 2.0 * b) - f(-2.0 * a, -2.0 * b)))
                    / (12.0 * step)
            };
            let second = |a: f64, b: f64| {
                (16.0 * (f(a, b) + f(-a, -b))
                    - (f(2.0 * a, 2.0 * b) + f(-2.0 * a, -2.0 * b))
                    - 30.0 * f(0.0, 0.0))
                    / (12.0 * step * step)
            };
            found.push((
                x,
                (first(1.0, 0.0) - gradient[0]).hypot(first(0.0, 1.0) - gradient[1]),
                (second(1.0, 0.0) + second(0.0, 1.0) - laplacian).abs(),
            ));
        }
        let wrong = found
            .iter()
            .filter(|(_, first, second)| *first > 1e-6 * scale[0] || *second > 1e-5 * scale[1])
            .count();
        // differences across an edge are not derivatives; few places are so near one
        assert!(
            wrong <= 24,
            "{name}: {wrong} of 400 wrong, for instance {:?}",
            found
                .iter()
                .find(|(_, a, b)| *a > 1e-6 * scale[0] || *b > 1e-5 * scale[1])
        );
    });
}

#[test]
fn roughnesses_are_integrals_or_infinite_at_walls() {
    let (mut finite, mut infinite) = (0, 0);
    for (name, truth) in all() {
        let claimed = [truth.gradient_roughness(), truth.laplacian_roughness()];
        for (kind, claimed) in claimed.into_iter().enumerate() {
            if claimed.is_infinite() {
                assert!(truth.domain().has_walls(), "{name}: why infinite?");
                infinite += 1;
                continue;
            }
            let (low, high) = truth.bulk(1e-14);
            let cuts = |axis: usize| {
                panels(
                    low[axis],
                    high[axis],
                    truth.breaks(axis),
                    1.5 * truth.finest_scale(axis),
                )
            };
            let (rule, x_cuts, y_cuts) = (GaussLegendre::new(12), cuts(0), cuts(1));
            let square = |x: Point<2>| match kind {
                0 => truth.gradient(x).iter().map(|g| g * g).sum(),
                _ => truth.laplacian(x).powi(2),
            };
            let got = rule.integrate_panels(
                |x| rule.integrate_panels(|y| square([x, y]), &y_cuts),
                &x_cuts,
            );
            assert!(
                (got / claimed - 1.0).abs() < 1e-8,
                "{name}: {claimed} {got}"
            );
            finite += 1;
        }
    }
    assert!(finite >= 7 && infinite >= 10, "{finite} {infinite}");
}

#[test]
fn nothing_lies_outside_the_support_and_nothing_is_undefined() {
    for (name, truth) in all() {
        let domain = truth.domain().clone();
        let mut random = stream(11, "support", 0);
        for _ in 0..20_000 {
            let x = truth.draw(&mut random);
            assert!(domain.contains(x) && truth.at(x) > 0.0, "{name} at {x:?}");
        }
        let odd = [
            f64::NEG_INFINITY,
            -1e200,
            -1.0,
            -0.0,
            0.3,
            1.0 + 1e-9,
            1e200,
            f64::INFINITY,
        ];
        for x in odd {
            for y in odd {
                let f = truth.at([x, y]);
                assert!(f >= 0.0 && f.is_finite(), "{name} at {x}, {y}: {f}");
                let [a, b] = truth.gradient([x, y]);
                assert!(
                    a.is_finite() && b.is_finite() && truth.laplacian([x, y]).is_finite(),
                    "{name} at {x}, {y}"
                );
                assert!(f == 0.0 || domain.contains([x, y]), "{name}");
            }
        }
        for tail in [0.2, 1e-3, 1e-12, 0.0] {
            let (low, high) = truth.bulk(tail);
            for k in 0..2 {
                assert!(
                    low[k].is_finite() && high[k].is_finite() && low[k] < high[k],
                    "{name}"
                );
                let (mut below, mut above) = (WHOLE, WHOLE);
                below[1][k] = low[k];
                above[0][k] = high[k];
                for side in [below, above] {
                    let beyond = truth.probability(side[0], side[1]);
                    assert!(
                        beyond <= tail * (1.0 + 1e-9) + 1e-12,
                        "{name} tail {tail}: {beyond}"
                    );
                }
            }
        }
        assert!(truth.bivariate().is_some() && truth.univariate().is_none());
        assert!(truth.breaks(0).is_sorted() && truth.breaks(1).is_sorted());
    }
}

const DRAWS: usize = 400_000;

/// Cells on each axis; the outer ones go on to infinity.
const CELLS: usize = 12;

/// P-values for points that should follow `truth`: Pearson's over cells, and of two means, two variances and the covariance.
fn suspicions(truth: &dyn Bivariate, cells: &[f64], points: &[Point<2>]) -> [f64; 6] {
    let n = points.len() as f64;
    let (low, high) = truth.bulk(2e-2);
    let mut counts = vec![0.0; CELLS * CELLS];
    for x in points {
        let [i, j] = [0, 1].map(|k: usize| {
            let t = (x[k] - low[k]) / (high[k] - low[k]) * CELLS as f64;
            (t.max(0.0) as usize).min(CELLS - 1)
        });
        counts[i * CELLS + j] += 1.0;
    }
    let (mut statistic, mut freedom) = (0.0, -1.0);
    let mut rest = (0.0, 0.0);
    for (count, probability) in counts.iter().zip(cells) {
        let expected = n * probability;
        if expected < 20.0 {
            rest = (rest.0 + count, rest.1 + expected);
            continue;
        }
        statistic += (count - expected).powi(2) / expected;
        freedom += 1.0;
    }
    if rest.1 > 5.0 {
        statistic += (rest.0 - rest.1).powi(2) / rest.1;
        freedom += 1.0;
    } else if rest.0 > rest.1 + 30.0 {
        statistic = f64::INFINITY;
    }
    let (mean, covariance) = truth.mean_and_covariance();
    let test = |value: &dyn Fn(f64, f64) -> f64, expected: f64| {
        let values = points
            .iter()
            .map(|x| value(x[0] - mean[0], x[1] - mean[1]) - expected);
        let (sum, squares) = values.fold((0.0, 0.0), |(s, q), v| (s + v, q + v * v));
        two_sided(sum / squares.sqrt())
    };
    [
        ChiSquared::new(freedom).unwrap().sf(statistic),
        test(&|x, _| x, 0.0),
        test(&|_, y| y, 0.0),
        test(&|x, _| x * x, covariance[0][0]),
        test(&|_, y| y * y, covariance[1][1]),
        test(&|x, y| x * y, covariance[0][1]),
    ]
}

fn cell_probabilities(truth: &dyn Bivariate) -> Vec<f64> {
    let (low, high) = truth.bulk(2e-2);
    let edge = |k: usize, i: usize| match i {
        0 => f64::NEG_INFINITY,
        CELLS => f64::INFINITY,
        _ => (high[k] - low[k]).mul_add(i as f64 / CELLS as f64, low[k]),
    };
    (0..CELLS * CELLS)
        .map(|cell| {
            let (i, j) = (cell / CELLS, cell % CELLS);
            truth.probability([edge(0, i), edge(1, j)], [edge(0, i + 1), edge(1, j + 1)])
        })
        .collect()
}

/// The indices of the densities that any of the tests rejects, at most one true sampler in a thousand runs of all.
fn accused(suspicions: &[[f64; 6]]) -> Vec<usize> {
    let rejected = holm(suspicions.as_flattened(), 1e-3);
    (0..suspicions.len())
        .filter(|i| rejected[6 * i..6 * i + 6].contains(&true))
        .collect()
}

#[test]
fn samplers_follow_their_density_and_one_percent_of_fault_is_seen() {
    let all = all();
    let tested: Vec<[[f64; 6]; 4]> = all
        .par_iter()
        .enumerate()
        .map(|(number, (_, truth))| {
            let mut random = stream(1986, "law of samplers in the plane", number as u64);
            let points: Vec<Point<2>> = (0..DRAWS).map(|_| truth.draw(&mut random)).collect();
            let (mean, covariance) = truth.mean_and_covariance();
            let [s, t] = [covariance[0][0].sqrt(), covariance[1][1].sqrt()];
            let changed = |change: &dyn Fn(Point<2>) -> Point<2>| -> Vec<Point<2>> {
                points.iter().map(|&x| change(x)).collect()
            };
            let cells = cell_probabilities(&**truth);
            let check = |points: &[Point<2>]| suspicions(&**truth, &cells, points);
            [
                check(&points),
                check(&changed(&|x| [0.01f64.mul_add(s, x[0]), x[1]])),
                check(&changed(&|x| {
                    [x[0], 1.01f64.mul_add(x[1] - mean[1], mean[1])]
                })),
                // a wrong correlation
                check(&changed(&|x| {
                    [x[0], (0.015 * t / s).mul_add(x[0] - mean[0], x[1])]
                })),
            ]
        })
        .collect();
    let [fair, shifted, stretched, sheared] =
        [0, 1, 2, 3].map(|kind| tested.iter().map(|of| of[kind]).collect::<Vec<_>>());
    let names =
        |faults: Vec<usize>| -> Vec<&str> { faults.iter().map(|&i| all[i].0.as_str()).collect() };
    assert_eq!(names(accused(&fair)), [""; 0], "{fair:?}");
    for (fault, seen) in [
        ("shift", shifted),
        ("stretch", stretched),
        ("shear", sheared),
    ] {
        assert_eq!(
            accused(&seen).len(),
            all.len(),
            "{fault} seen only in {:?}",
            names(accused(&seen))
        );
    }
}

#[test]
fn draws_take_the_words_that_are_documented() {
    for (name, truth) in all() {
        let mut random = stream(3, "words", 0);
        let taken: Vec<u128> = (0..500)
            .map(|_| {
                let before = random.get_word_pos();
                truth.draw(&mut random);
                (random.get_word_pos() - before) / 2
            })
            .collect();
        assert!(
            taken
                .iter()
                .all(|words| *words == taken[0] && (2..=4).contains(words)),
            "{name}: {taken:?}"
        );
    }
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
