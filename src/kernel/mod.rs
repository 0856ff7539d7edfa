//! The bump: kernels, the widths they are stretched to, and the weighted sum of them that every kernel estimate is.
//!
//! | kernel | K(u) | support | k₂ = ∫u²K | R(K) = ∫K² | efficiency | file |
//! |---|---|---|---|---|---|---|
//! | Epanechnikov | ¾ (1 - u²) | \|u\| ≤ 1 | 1/5 | 3/5 | 1 | `epanechnikov.rs` |
//! | biweight | 15/16 (1 - u²)² | \|u\| ≤ 1 | 1/7 | 5/7 | 0.9939 | `biweight.rs` |
//! | triweight | 35/32 (1 - u²)³ | \|u\| ≤ 1 | 1/9 | 350/429 | 0.9867 | `triweight.rs` |
//! | triangular | 1 - \|u\| | \|u\| ≤ 1 | 1/6 | 2/3 | 0.9859 | `triangular.rs` |
//! | cosine | π/4 cos(πu/2) | \|u\| ≤ 1 | 1 - 8/π² | π²/16 | 0.9995 | `cosine.rs` |
//! | Gaussian | φ(u) | all | 1 | 1/(2√π) | 0.9512 | `gaussian.rs` |
//! | uniform | ½ | \|u\| ≤ 1 | 1/3 | ½ | 0.9295 | `uniform.rs` |
//!
//! The support is **closed**: a kernel with a jump (uniform) has its full value at |u| = 1, with u = (x - X) / h computed in that order, and in the plane where
//! the kernel is radial at u·u + v·v = 1, computed in that order. What becomes of a kernel of the line in the plane: [`Symmetry`], `radial.rs`.
//!
//! Kernels are textbook ones (support \[-1, 1\], the Gaussian of unit deviation) and of unit mass. The efficiency is that of
//! \[Silverman 1986, eq. 3.26\]: (C(Epanechnikov) / C(K))^(5/4) with C(K) = k₂^(2/5) R(K)^(4/5).
//!
//! # References
//! Silverman 1986, Density Estimation for Statistics and Data Analysis, table 3.1; Wand & Jones 1995, Kernel Smoothing, section 2.7.

mod bandwidth;
mod biweight;
mod cosine;
mod epanechnikov;
mod gaussian;
mod radial;
mod shape;
mod sum;
mod triangular;
mod triweight;
mod uniform;

pub use bandwidth::Bandwidth;
pub use biweight::Biweight;
pub use cosine::Cosine;
pub use epanechnikov::Epanechnikov;
pub use gaussian::Gaussian;
pub use radial::Symmetry;
pub use shape::{Shape, Use};
pub use sum::{KernelSum, WidthError};
pub use triangular::Triangular;
pub use triweight::Triweight;
pub use uniform::Uniform;

/// What kind of function a kernel is; engines that need an algebraic form read it here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// K(u) = Σ cₖ |u|ᵏ on |u| ≤ 1, zero beyond; the coefficients from k = 0. Non-zero odd coefficients make a kink at 0.
    Polynomial(&'static [f64]),
    /// K(u) = π/4 cos(πu/2) on |u| ≤ 1, zero beyond.
    Cosine,
    /// K(u) = φ(u), on the whole line.
    Gaussian,
}

/// A symmetric probability density used as a bump.
pub trait Kernel: Copy + Send + Sync + 'static {
    /// K(u).
    fn value(self, u: f64) -> f64;

    /// K(√s) for s ≥ 0, where the squared distance is at hand: what radial kernels are computed from. Nothing for s > 1 but the Gaussian.
    fn of_square(self, square: f64) -> f64;

    /// The largest |u| with K(u) > 0; for the Gaussian the place where `f64` has no positive value left.
    fn reach(self) -> f64;

    /// R(K) = ∫ K².
    fn roughness(self) -> f64;

    /// k₂ = ∫ u² K, so that bandwidths of different kernels can be compared.
    fn variance(self) -> f64;

    /// ∫₋∞ᵗ uʳ K(u) du for `order` r = 0, 1, 2; order 0 is the distribution function. What walls and cumulative estimates need.
    fn partial_moment(self, order: u32, below: f64) -> f64;

    /// The algebraic form.
    fn form(self) -> Form;

    /// K(0), the peak.
    fn peak(self) -> f64 {
        self.value(0.0)
    }

    /// C(K) = k₂^(2/5) R(K)^(4/5): what the kernel contributes to the least AMISE. [Silverman 1986, eq. 3.22]
    fn constant(self) -> f64 {
        self.variance().powf(0.4) * self.roughness().powf(0.8)
    }

    /// (C(Epanechnikov) / C(K))^(5/4), at most 1. [Silverman 1986, eq. 3.26]
    fn efficiency(self) -> f64 {
        (Epanechnikov.constant() / self.constant()).powf(1.25)
    }

    /// δ₀ = (R(K) / k₂²)^(1/5): h / δ₀ is the canonical bandwidth, equal for equally smooth estimates with
    /// different kernels. [Marron & Nolan 1988]
    fn canonical_scale(self) -> f64 {
        (self.roughness() / self.variance().powi(2)).powf(0.2)
    }
}

/// ∫₋₁ᵗ uʳ Σ cₖ|u|ᵏ du for -1 ≤ t ≤ 1, the partial moment of a polynomial kernel.
fn polynomial_partial_moment(coefficients: &[f64], order: u32, below: f64) -> f64 {
    let t = below.clamp(-1.0, 1.0);
    let parity = if order.is_multiple_of(2) { 1.0 } else { -1.0 };
    let mut total = 0.0;
    for (k, &c) in coefficients.iter().enumerate() {
        let power = k as i32 + order as i32 + 1;
        // ∫₀^|t| u^(r+k) du, and the same from -1 to 0 with the sign of uʳ there
        let whole = 1.0 / f64::from(power);
        let part = t.abs().powi(power) * whole;
        total += c * if t < 0.0 {
            parity * (whole - part)
        } else {
            parity * whole + part
        };
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::{GaussLegendre, panels};

    fn integral(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
        GaussLegendre::new(24).integrate_panels(f, &panels(low, high, [-1.0, 0.0, 1.0], 0.5))
    }

    #[test]
    fn every_constant_is_the_integral_it_claims_to_be() {
        for shape in Shape::ALL {
            let reach = shape.reach().min(12.0);
            let mass = integral(|u| shape.value(u), -reach, reach);
            let variance = integral(|u| u * u * shape.value(u), -reach, reach);
            let roughness = integral(|u| shape.value(u).powi(2), -reach, reach);
            assert!((mass - 1.0).abs() < 1e-13, "{shape}: mass {mass}");
            assert!(
                (variance - shape.variance()).abs() < 1e-13,
                "{shape}: variance {variance}"
            );
            assert!(
                (roughness - shape.roughness()).abs() < 1e-13,
                "{shape}: roughness {roughness}"
            );
        }
    }

    #[test]
    fn partial_moments_are_integrals() {
        for shape in Shape::ALL {
            let reach = shape.reach().min(12.0);
            for order in 0..3 {
                for below in [-3.0, -1.0, -0.7, 0.0, 0.25, 1.0, 1.5] {
                    let exact = if below <= -reach {
                        0.0
                    } else {
                        integral(
                            |u| u.powi(order as i32) * shape.value(u),
                            -reach,
                            below.min(reach),
                        )
                    };
                    let got = shape.partial_moment(order, below);
                    assert!(
                        (got - exact).abs() < 1e-13,
                        "{shape} order {order} below {below}: {got} {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn forms_are_the_kernels() {
        for shape in Shape::ALL {
            for u in [-1.5, -1.0, -0.6, -0.1, 0.0, 0.3, 0.99, 1.0, 1.0 + 1e-12_f64] {
                let inside = u.abs() <= 1.0;
                let value = match shape.form() {
                    Form::Polynomial(c) if inside => c
                        .iter()
                        .rev()
                        .fold(0.0, |sum, &c| f64::mul_add(sum, u.abs(), c)),
                    Form::Cosine if inside => {
                        std::f64::consts::FRAC_PI_4 * (std::f64::consts::FRAC_PI_2 * u).cos()
                    }
                    Form::Gaussian => crate::numeric::special::normal_density(u),
                    _ => 0.0,
                };
                assert!((value - shape.value(u)).abs() < 1e-15, "{shape} at {u}");
                assert!(
                    (value - shape.of_square(u * u)).abs() < 1e-15,
                    "{shape} at {u}²"
                );
            }
        }
    }

    #[test]
    fn efficiencies_are_the_textbook_ones() {
        let table = [
            (Shape::Epanechnikov, 1.0),
            (Shape::Biweight, 0.9939),
            (Shape::Triweight, 0.9867),
            (Shape::Triangular, 0.9859),
            (Shape::Cosine, 0.9995),
            (Shape::Gaussian, 0.9512),
            (Shape::Uniform, 0.9295),
        ];
        for (shape, expected) in table {
            assert!(
                (shape.efficiency() - expected).abs() < 5e-5,
                "{shape}: {}",
                shape.efficiency()
            );
        }
        assert!((Shape::Epanechnikov.constant() - 0.34909).abs() < 5e-6);
        assert!((Shape::Gaussian.constant() - 0.36334).abs() < 5e-6);
    }
}
