//! The parametric estimators: what they cost if their assumption is right, and what they never get rid of if it is wrong.

use density_lab::density::{NormalComponent, NormalMixture, named};
use density_lab::estimator::{Build, Context, Described, Estimator, Normal, NormalMixtureFit};
use density_lab::numeric::{GaussLegendre, panels};
use density_lab::parameter::Values;
use density_lab::random::stream;
use density_lab::sample::Sample;
use density_lab::space::{Domain, Field};
use rayon::prelude::*;
use std::f64::consts::PI;

fn built<E: Build<1> + Described>() -> E {
    let context = Context {
        truth: None,
        draws: 100,
    };
    E::build(&Values::defaults(E::PARAMETERS), &context).unwrap()
}

/// The ISE of `estimator` on samples of `draws` points of the density called `name`, one a replicate.
fn errors(estimator: &dyn Estimator<1>, name: &str, draws: usize, replicates: u64) -> Vec<f64> {
    let truth = named(name).unwrap();
    let rule = GaussLegendre::new(16);
    let cuts = panels(-9.0, 9.0, [], 0.75);
    (0..replicates)
        .into_par_iter()
        .map(|replicate| {
            let mut random = stream(11, name, replicate);
            let points = (0..draws).map(|_| truth.draw(&mut random)).collect();
            let sample = Sample::equal(points, Domain::whole()).unwrap();
            let estimate = estimator.fit(&sample).unwrap();
            rule.integrate_panels(|x| (estimate.at([x]) - truth.at([x])).powi(2), &cuts)
        })
        .collect()
}

fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (square / n).sqrt())
}

/// MISE → 7 / (16 √π σ n).
#[test]
fn a_right_assumption_costs_seven_sixteenths_over_root_pi_n() {
    let limit = 7.0 / (16.0 * PI.sqrt());
    for draws in [1000, 4000] {
        let (mean, error) = mean_and_error(&errors(&Normal, "normal", draws, 3000));
        let found = mean * draws as f64;
        // the next order is of some 1/n
        let margin = 3.5 * error * draws as f64 + 3.0 * limit / draws as f64;
        assert!(
            (found - limit).abs() < margin,
            "{draws}: {found} {limit} {margin}"
        );
    }
}

/// The nearest normal, in the sense of Kullback, has the mean and the variance of the density; its distance is what is left.
#[test]
fn a_wrong_assumption_leaves_its_distance() {
    let truth = named("bimodal").unwrap();
    let nearest = NormalMixture::new(vec![NormalComponent {
        weight: 1.0,
        mean: 0.0,
        deviation: (1.0 + 4.0 / 9.0_f64).sqrt(),
    }])
    .unwrap();
    let rule = GaussLegendre::new(16);
    let distance = rule.integrate_panels(
        |x| (nearest.at([x]) - truth.at([x])).powi(2),
        &panels(-9.0, 9.0, [], 0.5),
    );
    let (few, _) = mean_and_error(&errors(&Normal, "bimodal", 1000, 100));
    let (many, error) = mean_and_error(&errors(&Normal, "bimodal", 30_000, 40));
    assert!(
        (many - distance).abs() < 4.0 * error + 0.01 * distance,
        "{many} {distance}"
    );
    assert!(few / many < 1.1 && few > many - 4.0 * error, "{few} {many}");
    // the mixture of two has no such error
    let (mixture, _) = mean_and_error(&errors(&built::<NormalMixtureFit>(), "bimodal", 3000, 20));
    assert!(mixture < 0.02 * distance, "{mixture} {distance}");
}
