//! What rules must do, and what the misprints do.
#![allow(clippy::unwrap_used)]

mod gathering;

use super::acceptance::{Acceptance, Dice};
use super::as_printed::AsPrinted;
use super::bias_compensated::{Weighting, history, probability, values};
use super::nested_test::p_value;
use super::*;
use crate::estimator::{Build, Context, Described, Estimator, NearestNeighbour, built};
use crate::neighbour::Brute;
use crate::parameter::Value;
use crate::random::{open_unit, stream};

fn uniform<const D: usize>(n: usize, number: u64) -> Vec<Point<D>> {
    let mut random = stream(1986, "adaptive", number);
    (0..n)
        .map(|_| [(); D].map(|()| open_unit(&mut random)))
        .collect()
}

/// Half of the points in a spot at the centre.
fn spot(n: usize, number: u64) -> Vec<Point<2>> {
    let mut random = stream(1986, "spot", number);
    let points = uniform::<2>(n, number);
    points
        .into_iter()
        .enumerate()
        .map(|(i, x)| {
            if i % 2 == 0 {
                return x;
            }
            // a polar pair, kept inside the square
            let (radius, turn) = (
                0.05 * (-2.0 * open_unit(&mut random).ln()).sqrt(),
                std::f64::consts::TAU * open_unit(&mut random),
            );
            [0.5 + radius * turn.cos(), 0.5 + radius * turn.sin()].map(|x| x.clamp(0.0, 1.0))
        })
        .collect()
}

fn range(min: u64, max: u64) -> Vec<(&'static str, Value)> {
    vec![("min", Value::Count(min)), ("max", Value::Count(max))]
}

fn word(word: &str) -> Value {
    Value::Word(word.to_owned())
}

/// The ladder at each of some places, shown to `look`.
fn ladders<const D: usize>(
    sample: &Sample<D>,
    places: &[Point<D>],
    range: (usize, usize),
    convention: Convention,
    mut look: impl FnMut(Point<D>, &mut Ladder<'_, D>),
) {
    let finder = Brute::new(sample);
    let channels: Vec<Sample<D>> = if sample.channels() == 0 {
        vec![sample.clone()]
    } else {
        (0..sample.channels()).map(|c| sample.channel(c)).collect()
    };
    let mut nearest = Nearest::default();
    for &x in places {
        nearest.gather(&finder, x, (range.1 + 1).min(sample.len()));
        let mut ladder = Ladder::new(&mut nearest, (&finder, x), &channels, convention, range, 0);
        look(x, &mut ladder);
    }
}

fn same_as_nearest_neighbour<const D: usize>(sample: &Sample<D>, places: &[Point<D>])
where
    Sample<D>: Searchable<D>,
{
    for (convention, name) in Convention::ALL.into_iter().zip(Convention::NAMES) {
        for k in [2, 3, 17] {
            let mut settings = range(k, k);
            settings.push(("convention", word(name)));
            let plain = NearestNeighbour::new(k as usize, convention)
                .fit(sample)
                .unwrap();
            let adaptive: BiasCompensated = built::<D, _>(&settings);
            let adaptive = adaptive.fit(sample).unwrap();
            for &x in places {
                let (a, b) = (plain.at(x), adaptive.at(x));
                assert!((a / b - 1.0).abs() < 1e-12, "{name} {k} at {x:?}: {a} {b}");
            }
        }
    }
}

/// Without a choice every rule is the nearest-neighbour estimate: the ladder has the right rungs, with weights and ties.
#[test]
fn a_range_of_one_is_the_nearest_neighbour_estimate() {
    let line = uniform::<1>(60, 1);
    let plane = uniform::<2>(300, 2);
    let lattice: Vec<Point<2>> = plane.iter().map(|x| x.map(|x| (x * 9.0).floor())).collect();
    let weights = |n: usize| (0..n).map(|i| 0.5 + (i % 5) as f64).collect::<Vec<_>>();
    same_as_nearest_neighbour(
        &Sample::equal(line.clone(), Domain::unit()).unwrap(),
        &[[0.2], [0.9], [3.0]],
    );
    same_as_nearest_neighbour(
        &Sample::normalised(line, weights(60), Domain::unit()).unwrap(),
        &[[0.2], [0.5], [-1.0]],
    );
    for points in [plane, lattice] {
        let n = points.len();
        let places = [[0.3, 0.4], [0.0, 0.0], [3.2, 5.1], [2.0, 4.0]];
        same_as_nearest_neighbour(
            &Sample::equal(points.clone(), Domain::whole()).unwrap(),
            &places,
        );
        same_as_nearest_neighbour(
            &Sample::normalised(points, weights(n), Domain::whole()).unwrap(),
            &places,
        );
    }
}

/// Terminates in ⌈log₂(max - min)⌉ steps, at a rung of the ladder, whatever the dice.
#[test]
fn halving_ends_after_as_many_steps_as_it_must() {
    let sample = Sample::equal(spot(1500, 3), Domain::unit()).unwrap();
    let places = uniform::<2>(60, 4);
    for (min, max) in [
        (2u64, 3u64),
        (10, 11),
        (10, 500),
        (2, 1400),
        (50, 51),
        (7, 7),
    ] {
        let most = ((max - min).max(1) as f64).log2().ceil() as u32;
        for acceptance in Acceptance::NAMES {
            let mut settings = range(min, max);
            settings.push(("acceptance", word(acceptance)));
            let rule: BiasCompensated = built::<2, _>(&settings);
            ladders(
                &sample,
                &places,
                (min as usize, max as usize),
                Convention::MeanRadius,
                |x, ladder| {
                    let choice = rule.choose(x, ladder);
                    assert!(choice.ended && choice.steps <= most, "{choice:?} of {most}");
                    assert!((min as usize..=max as usize).contains(&choice.neighbours));
                },
            );
        }
    }
}

/// One step of the reference written out: weights, moments and probability by their definitions.
#[test]
fn a_probability_is_the_formula_written_out() {
    let sample = Sample::equal(spot(900, 5), Domain::unit()).unwrap();
    ladders(
        &sample,
        &uniform::<2>(20, 6),
        (40, 800),
        Convention::MeanRadius,
        |_, ladder| {
            let seen = history(ladder, 40, Weighting::Square);
            let at = values(ladder, 420);
            let p = probability(&seen, &at);
            let (mut w, mut first) = (0.0, 0.0);
            for j in 1..=40 {
                let weight = (j * j) as f64;
                w += weight;
                first += weight * ladder.estimate(0, j);
            }
            let mean = first / w;
            let variance = (1..=40)
                .map(|j| (j * j) as f64 * (ladder.estimate(0, j) - mean).powi(2))
                .sum::<f64>()
                / w;
            let right = (-(at[0] - mean).powi(2) / (2.0 * variance)).exp();
            assert!((p - right).abs() < 1e-9 * right.max(1e-3), "{p} {right}");
        },
    );
}

/// Misprints S04 to S07: on an even density, where every step is likely, the slide's loop goes round in circles; with weights that decide, it returns
/// an estimate that it rejected.
#[test]
fn the_slide_does_not_terminate_or_returns_what_it_rejected() {
    let sample = Sample::equal(uniform::<2>(3000, 7), Domain::unit()).unwrap();
    let places = uniform::<2>(50, 8);
    let dice = Dice::new(Acceptance::Seeded, 0);
    let printed = AsPrinted::new((50, 2000), Weighting::Square, dice);
    let (mut endless, mut below) = (0, 0);
    ladders(
        &sample,
        &places,
        (50, 2000),
        Convention::MeanRadius,
        |x, ladder| {
            let choice = Rule::<2>::choose(&printed, x, ladder);
            endless += usize::from(!choice.ended);
            below += usize::from(choice.steps == AsPrinted::LIMIT);
        },
    );
    assert_eq!(endless, below);
    assert!(endless > 40, "{endless} of 50 places");
    // the first middle is (2000 - 50)/2 = 975, not 1025; and a range of two with an accepted step stays one of two
    let narrow = AsPrinted::new((500, 501), Weighting::Even, dice);
    let mut low = 0;
    ladders(
        &sample,
        &places,
        (500, 501),
        Convention::MeanRadius,
        |x, ladder| {
            let choice = Rule::<2>::choose(&narrow, x, ladder);
            low += usize::from(choice.neighbours < 500);
        },
    );
    assert!(
        low > 0,
        "an estimate from fewer neighbours than the least was never returned"
    );
}

/// The share of nested balls has the Beta distribution: the p-values of the test are uniform on an even density; those of bias compensation are not.
#[test]
fn p_values_of_the_nested_test_are_uniform_and_those_of_bias_compensation_are_not() {
    let (mut tested, mut compensated) = (Vec::new(), Vec::new());
    for number in 0..400 {
        let domain =
            Domain::new([0.0; 2], [1.0; 2], [[crate::space::Side::Periodic; 2]; 2]).unwrap();
        let sample = Sample::equal(uniform::<2>(500, 100 + number), domain).unwrap();
        ladders(
            &sample,
            &[[0.5, 0.5]],
            (30, 200),
            Convention::MeanRadius,
            |_, ladder| {
                let share = ladder.volume(30) / ladder.volume(110);
                tested.push(p_value(share, 30, 110));
                let seen = history(ladder, 30, Weighting::Square);
                compensated.push(probability(&seen, &values(ladder, 110)));
            },
        );
    }
    // Kolmogorov's distance, level 1e-6 for 400 values
    let distance = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        let n = values.len() as f64;
        values
            .iter()
            .enumerate()
            .map(|(i, p)| (p - i as f64 / n).abs().max((p - (i + 1) as f64 / n).abs()))
            .fold(0.0, f64::max)
    };
    let bound = (0.5 * (2.0e6_f64).ln() / 400.0).sqrt();
    let (a, b) = (distance(&mut tested), distance(&mut compensated));
    assert!(a < bound, "{a} against {bound}");
    assert!(b > bound, "{b} against {bound}");
}

/// Light of one chromaticity is chosen for as its total is, and keeps its chromaticity; a dark channel says nothing.
#[test]
fn colours_are_smoothed_alike() {
    let points = spot(800, 9);
    let n = points.len();
    let grey: Vec<f64> = (0..n).map(|i| 1.0 + (i % 3) as f64).collect();
    let scaled = |s: f64| grey.iter().map(|w| s * w).collect::<Vec<_>>();
    let colour = Sample::with_channels(
        points.clone(),
        vec![scaled(0.5), scaled(0.0), scaled(0.25)],
        Domain::unit(),
    )
    .unwrap();
    let total = Sample::new(
        points.clone(),
        crate::sample::Weights::Each(scaled(0.75).into()),
        Domain::unit(),
    )
    .unwrap();
    let rule = BiasCompensated::new(20, 300);
    let (colour, total) = (rule.fit(&colour).unwrap(), rule.fit(&total).unwrap());
    for x in uniform::<2>(40, 10) {
        let (red, dark, blue) = (
            colour.channel(0).unwrap().at(x),
            colour.channel(1).unwrap().at(x),
            colour.channel(2).unwrap().at(x),
        );
        assert!(
            (red / blue - 2.0).abs() < 1e-12 && dark == 0.0,
            "{red} {blue}"
        );
        assert!((colour.at(x) / total.at(x) - 1.0).abs() < 1e-12);
    }
}

/// The rules at their limits: no tolerance takes the least rung, all tolerance the last; more level in the test stops earlier.
#[test]
fn rules_are_monotone_in_what_they_allow() {
    let sample = Sample::equal(spot(1200, 11), Domain::unit()).unwrap();
    let lepski = |c: f64| -> Lepski {
        let mut settings = range(10, 800);
        settings.push(("deviations", Value::Number(c)));
        built::<2, _>(&settings)
    };
    ladders(
        &sample,
        &uniform::<2>(30, 12),
        (10, 800),
        Convention::Unbiased,
        |x, ladder| {
            let at = |c: f64, ladder: &mut Ladder<'_, 2>| lepski(c).choose(x, ladder).neighbours;
            let chosen = [1e-9, 0.5, 1.5, 3.0, 1e9].map(|c| at(c, ladder));
            assert!(
                chosen.windows(2).all(|pair| pair[0] <= pair[1]),
                "{chosen:?}"
            );
            assert_eq!((chosen[0], chosen[4]), (10, 800));
        },
    );
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let sample = Sample::equal(spot(2000, 13), Domain::unit()).unwrap();
    let places = uniform::<2>(300, 14);
    let bits = |threads: usize| -> Vec<u64> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let estimate = BiasCompensated::new(20, 500).fit(&sample).unwrap();
            let values = estimate.evaluate(Targets::Points(&places)).values;
            values.into_iter().map(f64::to_bits).collect()
        })
    };
    let one = bits(1);
    assert!(one == bits(2) && one == bits(7));
}

#[test]
fn points_at_one_place_are_passed_over() {
    let mut points = uniform::<2>(100, 15);
    points.extend(vec![[0.5, 0.5]; 60]);
    let sample = Sample::equal(points, Domain::unit()).unwrap();
    for (min, max) in [(2, 20), (10, 100), (59, 60), (60, 158), (2, 5000)] {
        let estimate = BiasCompensated::new(min, max).fit(&sample).unwrap();
        let evaluation = estimate.evaluate(Targets::Points(&[[0.5, 0.5], [0.1, 0.1]]));
        assert!(
            evaluation.values.iter().all(|v| v.is_finite() && *v > 0.0),
            "{evaluation:?}"
        );
        assert!(
            min > 60
                || evaluation
                    .warnings
                    .iter()
                    .any(|w| w.what.contains("coincide"))
        );
    }
    let one = Sample::equal(vec![[0.5, 0.5]; 9], Domain::unit()).unwrap();
    assert!(matches!(
        BiasCompensated::new(2, 5).fit(&one).map(|_| ()),
        Err(FitError::Degenerate(_))
    ));
    let two = Sample::equal(vec![[0.5, 0.5], [0.1, 0.2]], Domain::unit()).unwrap();
    assert!(BiasCompensated::new(2, 5).fit(&two).is_err());
}

#[test]
fn a_range_that_is_none_is_refused() {
    let mut values = Values::defaults(<Lepski as Described>::PARAMETERS);
    values.set("min", Value::Count(9));
    values.set("max", Value::Count(8));
    let context = Context {
        truth: None,
        draws: 9,
    };
    let refused = <Lepski as Build<2>>::build(&values, &context);
    assert!(refused.is_err_and(|error| error.parameter == "max"));
}
