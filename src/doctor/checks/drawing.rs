//! Densities: draws, distribution function, quantiles and derivatives are of one and the same density.

use super::{Check, Evidence, Finding, Subjects};
use crate::accuracy::chance::kolmogorov_smirnov;
use crate::numeric::GaussLegendre;
use crate::theory::panels_of;

/// Draws follow the distribution function.
pub const DISTRIBUTION: Check = Check {
    name: "draws",
    states: "draws follow the distribution function, and have its mean and variance",
    run: distribution,
};

fn distribution(subjects: &Subjects, seed: u64) -> Finding {
    const DRAWS: usize = 200_000;
    /// Sorting more would cost more than all the rest.
    const SORTED: usize = 20_000;
    let sample = subjects.sample(seed, "doctor/draws", 0, DRAWS);
    let x = sample.coordinates();
    let (mean, deviation) = subjects.density.mean_and_deviation();
    let mut evidence = Evidence::default();
    evidence.mean("mean", x, mean);
    evidence.variance("variance", x, deviation * deviation);
    let probabilities = x[..SORTED.min(x.len())]
        .iter()
        .map(|x| subjects.density.distribution(*x))
        .collect();
    let sharp = 0.5 / (SORTED as f64).sqrt();
    evidence.test("distribution", kolmogorov_smirnov(probabilities), sharp);
    evidence.finding()
}

/// Quantiles invert the distribution function.
pub const QUANTILES: Check = Check {
    name: "quantiles",
    states: "F(F⁻¹(p)) = p",
    run: quantiles,
};

fn quantiles(subjects: &Subjects, _seed: u64) -> Finding {
    let density = &subjects.density;
    let mut evidence = Evidence::default();
    let pairs = (1..200).map(|i| {
        let p = f64::from(i) / 200.0;
        (density.distribution(density.quantile(p)), p)
    });
    evidence.exact("F(F⁻¹(p))", pairs, 1.0, 1e-9);
    evidence.finding()
}

/// The density is the derivative of its distribution function.
pub const MASS: Check = Check {
    name: "density-mass",
    states: "∫f over an interval is the difference of the distribution function",
    run: mass,
};

fn mass(subjects: &Subjects, _seed: u64) -> Finding {
    let density = &subjects.density;
    let rule = GaussLegendre::new(24);
    let mut evidence = Evidence::default();
    let pairs = (-8..8).map(|i| {
        let (low, high) = (f64::from(i) / 2.0, f64::from(i + 1) / 2.0);
        let panels = panels_of(&**density, low, high, []);
        let mass = rule.integrate_panels(|x| density.at([x]), &panels);
        (mass, density.distribution(high) - density.distribution(low))
    });
    evidence.exact("∫f", pairs, 0.1, 1e-9);
    evidence.finding()
}

/// R(f″) is what asymptotic theory rests on.
pub const ROUGHNESS: Check = Check {
    name: "roughness",
    states: "R(f), R(f′) and R(f″) are the integrals they claim to be",
    run: roughness,
};

fn roughness(subjects: &Subjects, _seed: u64) -> Finding {
    let density = &subjects.density;
    let rule = GaussLegendre::new(24);
    let ([low], [high]) = density.bulk(1e-16);
    let panels = panels_of(&**density, low, high, []);
    let mut evidence = Evidence::default();
    for order in 0..=2 {
        let value = |x: f64| match order {
            0 => density.at([x]),
            order => density.derivative(order, x),
        };
        let integral = rule.integrate_panels(|x| value(x).powi(2), &panels);
        let claimed = density.roughness(order);
        let name = format!("R of derivative {order}");
        evidence.exact(&name, [(claimed, integral)], integral, 1e-8);
    }
    evidence.finding()
}
