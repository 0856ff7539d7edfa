//! Integrals, inverses and derivatives.

use super::all;
use density_lab::density::Univariate;
use density_lab::numeric::{GaussLegendre, panels};
use density_lab::random::stream;

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
