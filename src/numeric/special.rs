//! Special functions: the normal density with its derivatives, its distribution function and the inverse, Hermite polynomials.

pub use super::normal_quantile::{normal_quantile, normal_quantiles};

use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// φ(x) = exp(-x²/2) / √(2π), the standard normal density.
pub fn normal_density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / (2.0 * PI).sqrt()
}

/// Φ(x), the standard normal distribution function, to full relative precision in the lower tail.
pub fn normal_distribution(x: f64) -> f64 {
    0.5 * libm::erfc(-x * FRAC_1_SQRT_2)
}

/// Φ(b) - Φ(a), the standard normal probability between `low` = a and `high` = b, to full relative precision in both tails
/// (short intervals aside, where the difference cancels).
pub fn normal_probability(low: f64, high: f64) -> f64 {
    if low > 0.0 {
        normal_distribution(-low) - normal_distribution(-high)
    } else {
        normal_distribution(high) - normal_distribution(low)
    }
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
    let density = normal_density(x);
    if density == 0.0 {
        return 0.0; // where the polynomial may already be infinite
    }
    let sign = if order.is_multiple_of(2) { 1.0 } else { -1.0 };
    sign * hermite(order, x) * density
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
    fn quantile_inverts_to_the_last_bits() {
        // 40-digit values from mpmath
        for (p, x) in [
            (1e-300, -37.047_096_299_361_2),
            (1e-10, -6.361_340_902_404_056),
            (0.01, -2.326_347_874_040_841),
            (0.4, -0.253_347_103_135_799_8),
            (0.5, 0.0),
        ] {
            assert!(
                (normal_quantile(p) - x).abs() < 1e-14 * (1.0 + x.abs()),
                "{p}"
            );
        }
        for p in [1e-200, 1e-9, 0.2, 0.5, 0.7] {
            assert!(
                (normal_distribution(normal_quantile(p)) / p - 1.0).abs() < 3e-13,
                "{p}"
            );
        }
        assert!(normal_quantile(0.0) == f64::NEG_INFINITY && normal_quantile(1.0) == f64::INFINITY);
    }

    #[test]
    fn nothing_is_undefined_at_infinity() {
        for order in 0..5 {
            for x in [f64::NEG_INFINITY, f64::INFINITY, 1e200] {
                assert!(normal_density_derivative(order, x) == 0.0);
            }
        }
        assert!(
            (normal_probability(9.0, f64::INFINITY) / 1.128_588_405_953_840_6e-19 - 1.0).abs()
                < 1e-13
        );
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
