//! Quadrature against closed forms, asymptotics, scale, and the ends of the range of bandwidths.

use super::{beta, gaussian, named, near};
use density_lab::density::{self, Univariate};
use density_lab::kernel::{Kernel, Shape};
use density_lab::theory::{HistogramError, KernelError, Moments, NoAsymptotics, kernel_moments};

/// All fifteen and a mixture of very different scales, seven decades of bandwidth.
#[test]
fn quadrature_is_the_closed_form() {
    let mut worst = (0.0, 0.0);
    for number in 1..=15 {
        let truth = density::marron_wand(number).unwrap();
        let closed = KernelError::new(&truth, Shape::Gaussian);
        let quadrature = KernelError::by_quadrature(&truth, Shape::Gaussian);
        for i in -16..=8 {
            let h = 10f64.powf(f64::from(i) / 4.0);
            let (a, b) = (closed.at(h, 1e3), quadrature.at(h, 1e3));
            let bias = (a.squared_bias / b.squared_bias - 1.0).abs();
            let variance = (a.variance - b.variance).abs() / a.mise();
            let mise = (a.mise() / b.mise() - 1.0).abs();
            assert!(
                mise < 1e-10 && variance < 1e-10,
                "mw-{number} h = {h}: {a:?} {b:?}"
            );
            assert!(bias < 1e-7, "mw-{number} h = {h}: {a:?} {b:?}");
            worst = (f64::max(worst.0, mise), f64::max(worst.1, bias));
        }
    }
    println!(
        "worst relative difference: MISE {:.1e}, bias² {:.1e}",
        worst.0, worst.1
    );
}

#[test]
fn asymptotics_overstate_the_error_of_small_samples() {
    let errors = gaussian("normal");
    for (draws, over) in [(1e3, 1.29), (1e4, 1.16)] {
        let best = errors.optimum(draws);
        let leading = errors.asymptotic(draws).unwrap().at(best.at).mise();
        assert!(
            (leading / best.error.mise() - over).abs() < 0.006,
            "{}",
            leading / best.error.mise()
        );
    }
    // 1.25 C(K) (R(f'')/n⁴)^(1/5), and (4/3)^(1/5) σ n^(-1/5) for the normal
    for shape in Shape::ALL {
        let truth = named("mw-8");
        let leading = KernelError::new(&*truth, shape).asymptotic(1e4).unwrap();
        let expected = 1.25 * shape.constant() * (truth.roughness(2) / 1e16).powf(0.2);
        assert!(
            near(leading.at(leading.best()).mise(), expected, 1e-12),
            "{shape}"
        );
    }
    let silverman = errors.asymptotic(1e3).unwrap().best();
    assert!(near(
        silverman,
        (4.0f64 / 3.0).powf(0.2) * 1e3f64.powf(-0.2),
        1e-12
    ));
    // in the limit they are right
    let many = errors.optimum(1e12);
    assert!(near(
        errors.asymptotic(1e12).unwrap().at(many.at).mise(),
        many.error.mise(),
        5e-3
    ));
}

#[test]
fn without_curvature_there_are_no_asymptotics_and_the_reason_is_given() {
    for name in [
        "uniform",
        "ramp-up",
        "ramp-down",
        "exponential",
        "truncated-exponential",
        "half-normal",
        "beta",
    ] {
        let truth = named(name);
        let error = KernelError::new(&*truth, Shape::Biweight)
            .asymptotic(100.0)
            .unwrap_err();
        assert_eq!(error, NoAsymptotics::Curvature);
        assert!(error.to_string().contains("R(f'') is infinite"));
        assert!(
            HistogramError::polygon(&*truth, 0.0)
                .asymptotic(100.0)
                .is_err(),
            "{name}"
        );
        let slope = HistogramError::new(&*truth, 0.0).asymptotic(100.0).err();
        assert_eq!(
            slope,
            (name != "beta").then_some(NoAsymptotics::Slope),
            "{name}"
        );
        // the exact optimum exists all the same
        let best = KernelError::new(&*truth, Shape::Biweight).optimum(100.0);
        assert!(
            best.at > 0.0 && best.error.mise() < truth.roughness(0),
            "{name}"
        );
    }
    assert!(
        KernelError::new(&*beta(3.0, 3.5), Shape::Biweight)
            .asymptotic(100.0)
            .is_ok()
    );
}

#[test]
fn errors_scale_with_the_density_and_with_the_sample() {
    let stretched = |by: f64| {
        let parts = density::marron_wand(8)
            .unwrap()
            .normal_components()
            .unwrap()
            .iter()
            .map(|part| density::NormalComponent {
                mean: part.mean * by + 3.0 * by,
                deviation: part.deviation * by,
                ..*part
            })
            .collect();
        density::NormalMixture::new(parts).unwrap()
    };
    for by in [1e-30, 1e-6, 1e6, 1e30] {
        for shape in [Shape::Gaussian, Shape::Triweight] {
            let (one, other) = (
                KernelError::new(&stretched(1.0), shape),
                KernelError::new(&stretched(by), shape),
            );
            assert!(
                near(
                    one.at(0.2, 90.0).mise(),
                    other.at(0.2 * by, 90.0).mise() * by,
                    1e-11
                ),
                "{shape} {by}"
            );
            assert!(
                near(one.optimum(90.0).at, other.optimum(90.0).at / by, 1e-6),
                "{shape} {by}"
            );
        }
    }
    // a weighted sample counts as its effective size
    let errors = gaussian("normal");
    let (few, many) = (errors.at(0.3, 12.5), errors.at(0.3, 125.0));
    assert!(near(few.variance, 10.0 * many.variance, 1e-14));
    assert_eq!(few.squared_bias, many.squared_bias);
    let at = |draws| kernel_moments(&*named("normal"), Shape::Biweight, 0.3, draws, 0.4);
    assert!(near(at(12.5).variance, 10.0 * at(125.0).variance, 1e-14));
}

#[test]
fn limits_of_the_bandwidth() {
    for name in ["discrete-comb", "smooth-comb", "half-normal"] {
        let truth = named(name);
        for shape in Shape::ALL {
            let errors = KernelError::new(&*truth, shape);
            let narrow = errors.at(1e-9, 100.0);
            assert!(
                near(narrow.variance, shape.roughness() / 1e-7, 1e-6),
                "{name} {shape}: {narrow:?}"
            );
            let wide = errors.at(1e9, 100.0);
            assert!(
                near(wide.squared_bias, truth.roughness(0), 1e-6),
                "{name} {shape}: {wide:?}"
            );
            assert!(wide.variance.abs() < 1e-9, "{name} {shape}: {wide:?}");
            let far = kernel_moments(&*truth, shape, 0.1, 100.0, 1e12);
            assert_eq!(
                far,
                Moments {
                    mean: 0.0,
                    variance: 0.0
                }
            );
        }
    }
}
