//! Special functions: the normal density with its derivatives, its distribution function, Hermite polynomials.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// φ(x) = exp(-x²/2) / √(2π), the standard normal density.
pub fn normal_density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / (2.0 * PI).sqrt()
}

/// Φ(x), the standard normal distribution function, to full relative precision in the lower tail.
pub fn normal_distribution(x: f64) -> f64 {
    0.5 * libm::erfc(-x * FRAC_1_SQRT_2)
}

/// Heᵣ(x), the probabilists' Hermite polynomial: He₀ = 1, He₁ = x, Heᵣ₊₁ = x Heᵣ - r Heᵣ₋₁.
pub fn hermite(order: u32, x: f64) -> f64 {
    let (mut before, mut now) = (0.0, 1.0);
    for r in 0..order {
        (before, now) = (now, x.mul_add(now, -f64::from(r) * before));
    }
    now
}

/// φ⁽ʳ⁾(x) = (-1)ʳ Heᵣ(x) φ(x), the derivatives of the standard normal density.
pub fn normal_density_derivative(order: u32, x: f64) -> f64 {
    let sign = if order.is_multiple_of(2) { 1.0 } else { -1.0 };
    sign * hermite(order, x) * normal_density(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hermite_polynomials_match_their_closed_forms() {
        for x in [-2.5, -1.0, 0.0, 0.3, 4.0_f64] {
            assert!((hermite(2, x) - (x * x - 1.0)).abs() < 1e-13);
            assert!(
                (hermite(4, x) - (x.powi(4) - 6.0 * x * x + 3.0)).abs() < 1e-12 * (1.0 + x.powi(4))
            );
        }
    }

    #[test]
    fn distribution_function_agrees_with_tables() {
        assert!((normal_distribution(1.959_963_984_540_054) - 0.975).abs() < 1e-15);
        assert!((normal_distribution(-10.0) / 7.619_853_024_160_526e-24 - 1.0).abs() < 1e-13);
    }

    #[test]
    fn derivative_agrees_with_a_difference() {
        let step = 1e-5;
        for order in 0..4 {
            let difference = (normal_density_derivative(order, 0.7 + step)
                - normal_density_derivative(order, 0.7 - step))
                / (2.0 * step);
            assert!((difference - normal_density_derivative(order + 1, 0.7)).abs() < 1e-8);
        }
    }
}
