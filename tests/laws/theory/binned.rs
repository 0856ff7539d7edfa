//! Histograms and their relatives.

use super::{named, near};
use density_lab::kernel::Shape;
use density_lab::theory::{
    HistogramError, Moments, histogram_moments, integrate_over, kernel_moments, polygon_moments,
    shifted_histogram_moments,
};

#[test]
fn histograms_have_the_error_of_their_bins() {
    for name in [
        "normal",
        "claw",
        "smooth-comb",
        "exponential",
        "ramp-up",
        "beta",
    ] {
        let truth = named(name);
        let deviation = truth.mean_and_deviation().1;
        for (width, origin) in [(0.3 * deviation, 0.05), (1.7 * deviation, -0.4)] {
            let ([low], [high]) = truth.bulk(1e-18);
            let (first, last) = (
                ((low - origin) / width).floor(),
                ((high - origin) / width).ceil(),
            );
            let edges: Vec<f64> = (first as i64..=last as i64)
                .map(|k| (k as f64).mul_add(width, origin))
                .collect();
            let ends = [edges[0], edges[edges.len() - 1]];
            let over = integrate_over(&*truth, ends, edges.iter().copied(), |x| {
                histogram_moments(&*truth, width, origin, 70.0, x)
            });
            let exact = HistogramError::new(&*truth, origin).at(width, 70.0);
            assert!(
                near(exact.squared_bias, over.absolute.squared_bias, 1e-9),
                "{name}: {exact:?} {over:?}"
            );
            assert!(
                near(exact.variance, over.absolute.variance, 1e-11),
                "{name}: {exact:?} {over:?}"
            );
        }
    }
    // 0.8255 R(f')^(1/3) n^(-2/3) at (6/(n R(f')))^(1/3)
    let truth = named("bimodal");
    let leading = HistogramError::new(&*truth, 0.0).asymptotic(1e3).unwrap();
    assert!(near(
        leading.best(),
        (6.0 / (1e3 * truth.roughness(1))).cbrt(),
        1e-12
    ));
    assert!(near(
        leading.at(leading.best()).mise(),
        0.825_5 * truth.roughness(1).cbrt() * 0.01,
        1e-4
    ));
}

/// Shifted histograms and polygons: by the integrals of their moments, and by their asymptotics.
#[test]
fn relatives_of_the_histogram_have_the_error_of_their_bins() {
    for name in ["normal", "claw", "exponential", "beta", "uniform"] {
        let truth = named(name);
        let deviation = truth.mean_and_deviation().1;
        for (width, origin) in [(0.3 * deviation, 0.05), (1.7 * deviation, -0.4)] {
            let ([low], [high]) = truth.bulk(1e-18);
            let places = |step: f64, offset: f64| -> Vec<f64> {
                let (first, last) = ((low - origin) / step - 8.0, (high - origin) / step + 8.0);
                (first as i64..=last as i64)
                    .map(|k| (k as f64 + offset).mul_add(step, origin))
                    .collect()
            };
            for shifts in [2, 5] {
                let cuts = places(width / f64::from(shifts), 0.0);
                let ends = [cuts[0], cuts[cuts.len() - 1]];
                let over = integrate_over(&*truth, ends, cuts, |x| {
                    shifted_histogram_moments(&*truth, width, shifts, origin, 70.0, x)
                });
                let exact = HistogramError::shifted(&*truth, origin, shifts).at(width, 70.0);
                assert!(
                    near(exact.squared_bias, over.absolute.squared_bias, 1e-9),
                    "{name} {shifts}: {exact:?} {over:?}"
                );
                assert!(
                    near(exact.variance, over.absolute.variance, 1e-11),
                    "{name} {shifts}: {exact:?} {over:?}"
                );
            }
            let cuts = places(width, 0.5);
            let ends = [cuts[0], cuts[cuts.len() - 1]];
            let over = integrate_over(&*truth, ends, cuts, |x| {
                polygon_moments(&*truth, width, origin, 70.0, x)
            });
            let exact = HistogramError::polygon(&*truth, origin).at(width, 70.0);
            assert!(
                near(exact.squared_bias, over.absolute.squared_bias, 1e-9),
                "{name}: {exact:?} {over:?}"
            );
            assert!(
                near(exact.variance, over.absolute.variance, 1e-11),
                "{name}: {exact:?} {over:?}"
            );
        }
    }
    // for large samples the leading terms are all there is
    let truth = named("bimodal");
    for errors in [
        HistogramError::new(&*truth, 0.1),
        HistogramError::shifted(&*truth, 0.1, 2),
        HistogramError::shifted(&*truth, 0.1, 8),
        HistogramError::polygon(&*truth, 0.1),
    ] {
        let draws = 1e9;
        let (leading, best) = (errors.asymptotic(draws).unwrap(), errors.optimum(draws));
        assert!(
            near(leading.best(), best.at, 0.01),
            "{} {best:?}",
            leading.best()
        );
        assert!(
            near(leading.at(leading.best()).mise(), best.error.mise(), 0.01),
            "{leading:?} {best:?}"
        );
        // the least is a least
        for other in [0.99, 1.01] {
            assert!(leading.at(other * leading.best()).mise() > leading.at(leading.best()).mise());
        }
    }
}

#[test]
fn many_shifts_tend_to_the_triangular_kernel_and_one_is_a_histogram() {
    let truth = named("skewed-bimodal");
    for x in [-1.0, 0.2, 1.5] {
        let kernel = kernel_moments(&*truth, Shape::Triangular, 0.6, 30.0, x);
        let shifted = |shifts| shifted_histogram_moments(&*truth, 0.6, shifts, 0.1, 30.0, x);
        let far = |m: Moments| {
            (m.mean - kernel.mean).abs() / kernel.mean
                + (m.variance - kernel.variance).abs() / kernel.variance
        };
        assert!(
            far(shifted(256)) < 0.02 && far(shifted(256)) < 0.05 * far(shifted(4)).max(1e-3) + 0.01,
            "{x}"
        );
        assert_eq!(shifted(1), histogram_moments(&*truth, 0.6, 0.1, 30.0, x));
    }
}
