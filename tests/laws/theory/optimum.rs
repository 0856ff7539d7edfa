//! Optima: published digits, all sizes of samples, and what is below them.

use super::{digits, gaussian, named, near};
use density_lab::kernel::{Kernel, Shape};
use density_lab::theory::{HistogramError, KernelError};

/// Bandwidth and MISE at the optimum, to the digits that were published or computed independently of this program.
#[test]
fn optima_agree_with_known_values_to_four_digits() {
    for (name, draws, h, mise) in [
        ("normal", 1e2, 0.4455, 5.410e-3),
        ("normal", 1e3, 0.2723, 1.030e-3),
        ("normal", 1e4, 0.1695, 1.808e-4),
        ("normal", 1e5, 0.1063, 3.039e-5),
        ("bimodal", 2e2, 0.3217, 4.570e-3),
        ("bimodal", 1e3, 0.2208, 1.397e-3),
        ("bimodal", 1e4, 0.1349, 2.399e-4),
        ("claw", 1e3, 0.0516, 6.668e-3),
    ] {
        let best = gaussian(name).optimum(draws);
        assert!(
            (best.at - h).abs() < 1.0e-4,
            "{name} {draws}: h = {}",
            best.at
        );
        assert!(
            digits(best.error.mise(), mise, 4),
            "{name} {draws}: {:?}",
            best.error
        );
        assert!(best.others.is_empty(), "{name} {draws}: {:?}", best.others);
    }
}

#[test]
fn the_bimodal_density_is_under_well_and_over_smoothed() {
    let errors = gaussian("bimodal");
    let least = errors.optimum(200.0).error.mise();
    for (h, ratio, squared_bias, variance) in [
        (0.1, 2.84, 2e-5, 0.0129),
        (0.3, 1.01, 0.00102, 0.00359),
        (0.6, 1.94, 0.00754, 0.00134),
    ] {
        let error = errors.at(h, 200.0);
        assert!(
            digits(error.mise() / least, ratio, 3),
            "h = {h}: {}",
            error.mise() / least
        );
        assert!(digits(error.variance, variance, 3), "h = {h}: {error:?}");
        assert!(
            digits(
                error.squared_bias,
                squared_bias,
                if h < 0.2 { 1 } else { 3 }
            ),
            "h = {h}: {error:?}"
        );
    }
    // what a variance estimate alone would not see
    let best = errors.optimum(1000.0).at;
    for (times, ratio) in [(1.0, 1.33), (2.0, 9.1), (4.0, 117.0)] {
        let error = errors.at(times * best, 1000.0);
        assert!(
            near(error.mise() / error.variance, ratio, 0.006),
            "{times}: {}",
            error.mise() / error.variance
        );
    }
}

#[test]
fn the_claw_with_fifty_points_has_two_minima() {
    let best = gaussian("claw").optimum(50.0);
    assert!(
        (best.at - 0.403).abs() < 0.001 && best.others.len() == 1,
        "{best:?}"
    );
    assert!((best.others[0].at - 0.131).abs() < 0.001, "{best:?}");
    assert!(best.others[0].value > best.error.mise());
    // a little later the fingers win
    let later = gaussian("claw").optimum(100.0);
    assert!(later.at < 0.15, "{later:?}");
}

#[test]
fn kernels_differ_by_their_efficiency() {
    let truth = named("normal");
    let least = |shape| KernelError::new(&*truth, shape).optimum(1e5).error.mise();
    let best = least(Shape::Epanechnikov);
    for shape in Shape::ALL {
        let expected = shape.efficiency().powf(-0.8);
        assert!(
            near(least(shape) / best, expected, 0.01),
            "{shape}: {} {expected}",
            least(shape) / best
        );
    }
}

#[test]
fn rates_for_finite_samples_are_the_published_ones() {
    let slope = |low: f64, high: f64, least: &dyn Fn(f64) -> f64| {
        (least(high) / least(low)).ln() / (high / low).ln()
    };
    for (name, expected) in [("normal", -0.765), ("bimodal", -0.773), ("claw", -0.784)] {
        let errors = gaussian(name);
        let got = slope(1e3, 1e5, &|draws| errors.optimum(draws).error.mise());
        assert!((got - expected).abs() < 1e-3, "{name}: {got}");
    }
    let errors = gaussian("normal");
    let got = slope(0.9e6, 1.1e6, &|draws| errors.optimum(draws).error.mise());
    assert!((got + 0.788).abs() < 1e-3, "{got}");
    for (name, expected) in [("normal", -0.655), ("bimodal", -0.656)] {
        let truth = named(name);
        let errors = HistogramError::new(&*truth, 0.0);
        let got = slope(1e3, 1e5, &|draws| errors.optimum(draws).error.mise());
        assert!((got - expected).abs() < 5e-3, "histogram, {name}: {got}");
    }
}

/// At a jump the best bandwidth falls as n^(-1/2) and the error with it; the search must follow.
#[test]
fn optima_are_found_for_any_sample_size() {
    let flat = named("uniform");
    let errors = KernelError::new(&*flat, Shape::Uniform);
    // bias² = h/3, variance ≈ 1/(2 n h)
    let best = errors.optimum(1e12);
    assert!(near(best.at, 1.5f64.sqrt() * 1e-6, 1e-3), "{best:?}");
    let smooth = gaussian("normal").optimum(1e14);
    assert!(
        near(smooth.at, 1.0592 * 1e14f64.powf(-0.2), 0.01),
        "{smooth:?}"
    );
    for name in ["normal", "smooth-comb", "exponential"] {
        let one = KernelError::new(&*named(name), Shape::Epanechnikov).optimum(1.0);
        assert!(
            one.at.is_finite() && one.error.mise() < named(name).roughness(0),
            "{name}: {one:?}"
        );
    }
}
