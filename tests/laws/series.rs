//! Orthogonal series: what theory says of them against what is known on paper, and against quadrature of the estimates themselves.

use density_lab::density::{self, Univariate};
use density_lab::estimator::{Build, Context, CosineSeries, Described, Estimator, LegendreSeries};
use density_lab::numeric::GaussLegendre;
use density_lab::numeric::orthogonal::{Basis, Cosine, Fourier, Hermite, Legendre, Placed};
use density_lab::parameter::{Value, Values};
use density_lab::sample::Sample;
use density_lab::space::{Domain, Field, Grid, Targets};
use density_lab::theory::{Integrated, SeriesError, Taper, panels_of, series_moments};
use std::f64::consts::PI;
use std::sync::Arc;

fn named(name: &str) -> Arc<dyn Univariate> {
    density::named(name).unwrap()
}

fn unit<B: Basis>() -> Placed<B> {
    Placed::between(0.0, 1.0)
}

/// f = 2x on [0, 1]: c₀ = 1, cⱼ = ∫ 2x √2 cos jπx = 2√2 ((-1)ʲ - 1)/(jπ)².
#[test]
fn coefficients_of_a_ramp_are_those_on_paper() {
    let ramp = named("ramp-up");
    let cosine = SeriesError::new(&*ramp, unit::<Cosine>(), 60);
    for (j, c) in cosine.coefficients().iter().enumerate() {
        let expected = match j {
            0 => 1.0,
            _ if j % 2 == 0 => 0.0,
            _ => -4.0 * 2.0_f64.sqrt() / (j as f64 * PI).powi(2),
        };
        assert!((c - expected).abs() < 1e-13, "{j}: {c} {expected}");
    }
    // ∫ 2x √2 sin 2πkx = -√2/(πk), and no cosines
    let fourier = SeriesError::new(&*ramp, unit::<Fourier>(), 40);
    for (i, c) in fourier.coefficients().iter().enumerate().skip(1) {
        let k = Fourier::degree(i) as f64;
        let expected = if i % 2 == 1 {
            0.0
        } else {
            -(2.0_f64.sqrt()) / (PI * k)
        };
        assert!((c - expected).abs() < 1e-13, "{i}: {c} {expected}");
    }
    // a straight line is two polynomials
    let legendre = SeriesError::new(&*ramp, unit::<Legendre>(), 30);
    for (j, c) in legendre.coefficients().iter().enumerate() {
        let expected = [1.0, 3.0_f64.sqrt() / 3.0].get(j).copied().unwrap_or(0.0);
        assert!((c - expected).abs() < 1e-13, "{j}: {c} {expected}");
    }
    // and a normal one Hermite function
    let hermite = SeriesError::new(
        &*named("normal"),
        Placed::<Hermite>::about(0.0, 0.0, 1.0),
        30,
    );
    for (j, c) in hermite.coefficients().iter().enumerate() {
        let expected = if j == 0 {
            0.5_f64.sqrt() / PI.sqrt().sqrt()
        } else {
            0.0
        };
        assert!((c - expected).abs() < 1e-13, "{j}: {c} {expected}");
    }
}

/// What lies in the span is expected exactly, and only variance is left.
#[test]
fn densities_in_the_span_have_no_bias() {
    let places: Vec<f64> = (0..41).map(|i| f64::from(i) / 40.0).collect();
    for name in ["uniform", "ramp-up", "ramp-down"] {
        let truth = named(name);
        for terms in [2, 3, 10] {
            let moments = series_moments(
                &*truth,
                &unit::<Legendre>(),
                terms,
                Taper::None,
                100.0,
                &places,
            );
            for (x, m) in places.iter().zip(moments) {
                assert!((m.mean - truth.at([*x])).abs() < 1e-12, "{name} at {x}");
            }
            let error = SeriesError::new(&*truth, unit::<Legendre>(), terms);
            assert!(error.at(terms, Taper::None, 100.0).squared_bias < 1e-14);
        }
    }
}

/// ∫ of the moments at places is the sum over coefficients.
#[test]
fn integrated_errors_are_the_integrals_of_the_errors_at_places() {
    fn check<B: Basis>(name: &str, placed: Placed<B>, [low, high]: [f64; 2]) {
        let truth = named(name);
        let errors = SeriesError::new(&*truth, placed, 20);
        for taper in [Taper::None, Taper::Fejer, Taper::Wahba] {
            for terms in [1, 4, 17] {
                let rule = GaussLegendre::new(24);
                let (mut places, mut weights) = (Vec::new(), Vec::new());
                for panel in panels_of(&*truth, low, high, placed.cuts(terms)).windows(2) {
                    for (x, weight) in rule.on(panel[0], panel[1]) {
                        places.push(x);
                        weights.push(weight);
                    }
                }
                let moments = series_moments(&*truth, &placed, terms, taper, 70.0, &places);
                let mut a = Integrated::default();
                for ((x, weight), m) in places.iter().zip(&weights).zip(moments) {
                    a.squared_bias += weight * (m.mean - truth.at([*x])).powi(2);
                    a.variance += weight * m.variance;
                }
                let error = errors.at(terms, taper, 70.0);
                let b = error;
                assert!(
                    (a.squared_bias - b.squared_bias).abs() < 1e-11
                        && (a.variance - b.variance).abs() < 1e-11 * (1.0 + b.variance),
                    "{name} {taper:?} {terms}: {a:?} {b:?}"
                );
            }
        }
    }
    check("truncated-exponential", unit::<Cosine>(), [0.0, 1.0]);
    check("truncated-exponential", unit::<Fourier>(), [0.0, 1.0]);
    check("ramp-down", unit::<Legendre>(), [0.0, 1.0]);
    check("bimodal", Placed::<Cosine>::between(-4.0, 4.0), [-9.0, 9.0]);
    check(
        "claw",
        Placed::<Hermite>::about(0.1, 0.0, 0.9),
        [-14.0, 14.0],
    );
}

/// At an end where the density jumps from 2 to 0 going round, the Fourier series stays at their mean, 1, however many terms; the cosine
/// series comes closer like 1/J, and the Legendre series is there.
#[test]
fn only_the_fourier_series_keeps_an_error_of_order_one_at_the_ends() {
    let ramp = named("ramp-up");
    let at_zero = |terms: usize| {
        let moments = [
            series_moments(&*ramp, &unit::<Fourier>(), terms, Taper::None, 1.0, &[0.0])[0],
            series_moments(&*ramp, &unit::<Cosine>(), terms, Taper::None, 1.0, &[0.0])[0],
            series_moments(&*ramp, &unit::<Legendre>(), terms, Taper::None, 1.0, &[0.0])[0],
        ];
        moments.map(|m| m.mean)
    };
    for terms in [10, 100, 200] {
        let [fourier, cosine, legendre] = at_zero(terms);
        assert!((fourier - 1.0).abs() < 1e-9, "{fourier}");
        // Σ_{odd j ≥ J} 8/(jπ)² ≈ 4/(π² J)
        let expected = 4.0 / (PI * PI * terms as f64);
        assert!(
            (cosine / expected - 1.0).abs() < 0.11 / (terms as f64 / 10.0),
            "{cosine}"
        );
        assert!(legendre.abs() < 1e-9, "{legendre}");
    }
    // Gibbs: near the end the Fourier series overshoots by 8.9 % of the jump [Si(π)/π - 1/2]
    let places: Vec<f64> = (0..40).map(|i| 1.0 - f64::from(i) * 5e-5).collect();
    let most = series_moments(&*ramp, &unit::<Fourier>(), 400, Taper::None, 1.0, &places)
        .iter()
        .map(|m| m.mean)
        .fold(0.0, f64::max);
    assert!((most - (2.0 + 2.0 * 0.089_489_872)).abs() < 0.01, "{most}");
}

/// The U shape: the exact optimum is a minimum of bias² + variance, moves outwards with n, and adding the term after it costs more than it brings.
#[test]
fn the_best_number_of_terms_balances_bias_and_variance() {
    let truth = named("bimodal");
    let errors = SeriesError::new(&*truth, Placed::<Cosine>::between(-4.0, 4.0), 100);
    let mut last = 0;
    for draws in [50.0, 200.0, 1000.0, 10_000.0, 100_000.0] {
        let (best, error) = errors.optimum(Taper::None, draws);
        for terms in 1..=100 {
            assert!(errors.at(terms, Taper::None, draws).mise() >= error.mise());
        }
        assert!(best >= last, "{best} after {last}");
        last = best;
        // a term pays if n c² > E ψ² - c²; all after the best together do not
        let more = errors.at(best + 2, Taper::None, draws).mise();
        assert!(more > error.mise(), "{draws}");
    }
    // nine at 200 and at 1000 points
    assert!(last > 9, "{last}");
}

fn series<E: Build<1> + Described>(settings: &[(&'static str, Value)]) -> E {
    let mut values = Values::defaults(E::PARAMETERS);
    for (name, value) in settings {
        values.set(name, value.clone());
    }
    let context = Context {
        truth: None,
        draws: 100,
    };
    E::build(&values, &context).unwrap()
}

/// On a domain with two ends no window is needed, the mass is kept, and points on the walls count in full.
#[test]
fn the_domain_is_the_interval_where_it_has_two_ends() {
    let mut points: Vec<[f64; 1]> = (0..200)
        .map(|i| [2.0 + 3.0 * (f64::from(i) * 0.618).fract().powi(2)])
        .collect();
    points.extend([[2.0], [5.0], [2.0], [5.0]]);
    let sample = Sample::equal(points.clone(), Domain::walled([2.0], [5.0]).unwrap()).unwrap();
    let terms = |count| ("terms", Value::Count(count));
    for estimator in [
        Box::new(series::<CosineSeries>(&[terms(12)])) as Box<dyn Estimator<1>>,
        Box::new(series::<LegendreSeries>(&[terms(12)])),
        Box::new(series::<CosineSeries>(&[])),
    ] {
        assert!(estimator.laws().mass_conserving);
        let estimate = estimator.fit(&sample).unwrap();
        let grid = Grid::new([2.0], [5.0], [3000]).unwrap();
        let values = estimate.evaluate(Targets::Grid(&grid)).values;
        let mass: f64 = values.iter().sum::<f64>() * 0.001;
        assert!((mass - 1.0).abs() < 1e-3, "{mass}");
        assert!(estimate.at([1.999]) == 0.0 && estimate.at([5.0]) > 0.0);
        // an open domain has no ends
        let open = Sample::equal(points.clone(), Domain::whole()).unwrap();
        let refused = estimator.fit(&open).err().unwrap().to_string();
        assert!(refused.contains("`low` and `high`"), "{refused}");
    }
}

/// Fejér's kernel is positive: so is what it makes of any data.
#[test]
fn a_fejer_taper_keeps_cosines_positive_without_clearing() {
    let (points, weights) = ([0.013, 0.5, 0.93], [0.2, 0.3, 0.5]);
    let placed = unit::<Cosine>();
    for terms in [2, 7, 40] {
        let mut c = placed.project(&points, |i| weights[i], terms, false).sums;
        for (k, c) in c.iter_mut().enumerate() {
            *c *= Taper::Fejer.weight(k, terms);
        }
        let places: Vec<f64> = (0..=1000).map(|i| f64::from(i) / 1000.0).collect();
        let least = placed.sum(&c, &places).into_iter().fold(1.0, f64::min);
        assert!(least > -1e-12, "{terms}: {least}");
    }
}
