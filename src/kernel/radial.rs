//! From the line to the plane: a kernel of each axis, or a kernel of the distance.
//!
//! | radial kernel | K(r) on r ≤ 1 | R = ∫∫K² | k₂ = ∫∫x²K | efficiency | product: efficiency |
//! |---|---|---|---|---|---|
//! | Epanechnikov | 2/π (1 - r²) | 4/(3π) | 1/6 | 1 | 0.9824 |
//! | biweight | 3/π (1 - r²)² | 9/(5π) | 1/8 | 80/81 | 0.9705 |
//! | triweight | 4/π (1 - r²)³ | 16/(7π) | 1/10 | 35/36 | 0.9564 |
//! | triangular: the cone | 3/π (1 - r) | 3/(2π) | 3/20 | 80/81 | 0.9549 |
//! | cosine | cos(πr/2) / (4 - 8/π) | π(π+2) / (32(π-2)) | (π/2 - 12/π + 24/π²)/(π-2) | 0.9991 | 0.9814 |
//! | Gaussian | φ(x) φ(y) | 1/(4π) | 1 | 8/9 | 8/9 |
//! | uniform: the cylinder | 1/π | 1/π | 1/4 | 8/9 | 0.8488 |
//!
//! R² k₂² is what a kernel contributes to the cube of the least AMISE in the plane, so that the efficiency is R k₂ of the radial Epanechnikov kernel, the best there
//! is, over R k₂ of this one, and the least AMISE goes with efficiency^(-2/3).
//!
//! # References
//! Silverman 1986, section 4.2, eqs 4.4-4.6 and table 3.1; Wand & Jones 1995, section 4.5 (product and spherically symmetric kernels).

use super::{Kernel, Shape};
use std::f64::consts::PI;
use std::fmt;

/// How a kernel of the line becomes one of the plane. On the line both mean the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Symmetry {
    /// K(u) K(v): the support is a box.
    #[default]
    Product,
    /// c K(√(u² + v²)): the support is an ellipse, a disc if the widths are equal.
    Radial,
}

/// c, that is 2π ∫₀¹ c r K(r) dr = 1 with the K of the line.
fn factor_in_the_plane(shape: Shape) -> f64 {
    match shape {
        Shape::Epanechnikov => 8.0 / (3.0 * PI),
        Shape::Biweight => 16.0 / (5.0 * PI),
        Shape::Triweight => 128.0 / (35.0 * PI),
        Shape::Triangular => 3.0 / PI,
        Shape::Cosine => 1.0 / (PI - 2.0),
        Shape::Gaussian => (2.0 * PI).sqrt().recip(),
        Shape::Uniform => 2.0 / PI,
    }
}

impl Symmetry {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Product, Self::Radial];

    /// The names in the order of [`Symmetry::ALL`].
    pub const NAMES: [&'static str; 2] = ["product", "radial"];

    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Product => "product",
            Self::Radial => "radial",
        }
    }

    /// The symmetry of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.name() == name)
    }

    /// What a radial kernel of unit mass is, over the kernel of the line at the same distance: 1 on the line.
    pub fn factor<const D: usize>(self, shape: Shape) -> f64 {
        const { assert!(D <= 2, "kernels live on the line and in the plane") };
        if D == 2 && self == Self::Radial {
            factor_in_the_plane(shape)
        } else {
            1.0
        }
    }

    /// The kernel at its centre, the largest value.
    pub fn peak<const D: usize>(self, shape: Shape) -> f64 {
        if D == 2 && self == Self::Radial {
            shape.peak() * factor_in_the_plane(shape)
        } else {
            shape.peak().powi(D as i32)
        }
    }

    /// R = ∫ K² over the line or the plane.
    pub fn roughness<const D: usize>(self, shape: Shape) -> f64 {
        if D != 2 || self == Self::Product {
            return shape.roughness().powi(D as i32);
        }
        match shape {
            Shape::Epanechnikov => 4.0 / (3.0 * PI),
            Shape::Biweight => 9.0 / (5.0 * PI),
            Shape::Triweight => 16.0 / (7.0 * PI),
            Shape::Triangular => 1.5 / PI,
            Shape::Cosine => PI * (PI + 2.0) / (32.0 * (PI - 2.0)),
            Shape::Gaussian => 0.25 / PI,
            Shape::Uniform => 1.0 / PI,
        }
    }

    /// k₂, the variance of the kernel along one axis.
    pub fn variance<const D: usize>(self, shape: Shape) -> f64 {
        if D != 2 || self == Self::Product {
            return shape.variance();
        }
        match shape {
            Shape::Epanechnikov => 1.0 / 6.0,
            Shape::Biweight => 0.125,
            Shape::Triweight => 0.1,
            Shape::Triangular => 0.15,
            Shape::Cosine => (0.5 * PI - 12.0 / PI + 24.0 / (PI * PI)) / (PI - 2.0),
            Shape::Gaussian => 1.0,
            Shape::Uniform => 0.25,
        }
    }

    /// How many of the data the best kernel would need for the same AMISE, as a share: at most 1. On the line \[Silverman 1986, eq. 3.26\], in the plane
    /// R k₂ of the radial Epanechnikov kernel over that of this one.
    pub fn efficiency<const D: usize>(self, shape: Shape) -> f64 {
        if D != 2 {
            return shape.efficiency();
        }
        2.0 / (9.0 * PI) / (self.roughness::<D>(shape) * self.variance::<D>(shape))
    }

    /// δ₀ = (R / k₂²)^(1/(D+4)): widths in proportion to it smooth equally. \[Marron & Nolan 1988; Wand & Jones 1995, section 4.5\]
    pub fn canonical_scale<const D: usize>(self, shape: Shape) -> f64 {
        let exponent = 1.0 / (D as f64 + 4.0);
        (self.roughness::<D>(shape) / self.variance::<D>(shape).powi(2)).powf(exponent)
    }
}

impl fmt::Display for Symmetry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::{GaussLegendre, panels};

    fn integral(f: impl Fn(f64) -> f64, high: f64) -> f64 {
        GaussLegendre::new(24).integrate_panels(f, &panels(0.0, high, [0.0, 1.0], 0.25))
    }

    #[test]
    fn every_constant_of_the_plane_is_the_integral_it_claims_to_be() {
        let radial = Symmetry::Radial;
        for shape in Shape::ALL {
            let reach = shape.reach().min(12.0);
            let kernel = |r: f64| radial.factor::<2>(shape) * shape.value(r);
            let ring = |r: f64| 2.0 * PI * r;
            let mass = integral(|r| ring(r) * kernel(r), reach);
            let variance = 0.5 * integral(|r| ring(r) * r * r * kernel(r), reach);
            let roughness = integral(|r| ring(r) * kernel(r).powi(2), reach);
            for (name, got, expected) in [
                ("mass", 1.0, mass),
                ("variance", radial.variance::<2>(shape), variance),
                ("roughness", radial.roughness::<2>(shape), roughness),
                ("peak", radial.peak::<2>(shape), kernel(0.0)),
            ] {
                assert!(
                    (got - expected).abs() < 1e-13,
                    "{shape}: {name} {got} {expected}"
                );
            }
        }
    }

    #[test]
    fn efficiencies_are_those_of_the_table() {
        let radial = [1.0, 0.9991, 80.0 / 81.0, 35.0 / 36.0, 80.0 / 81.0];
        let product = [0.9824, 0.9814, 0.9705, 0.9564, 0.9549];
        let flat = [(8.0 / 9.0, 8.0 / 9.0), (8.0 / 9.0, 0.8488)];
        let table = radial.into_iter().zip(product).chain(flat);
        for (shape, (radial, product)) in Shape::ALL.into_iter().zip(table) {
            for (symmetry, expected) in [(Symmetry::Radial, radial), (Symmetry::Product, product)] {
                let got = symmetry.efficiency::<2>(shape);
                assert!(
                    (got - expected).abs() < 5e-5,
                    "{symmetry} {shape}: {got} {expected}"
                );
            }
        }
    }

    #[test]
    fn on_the_line_both_are_the_kernel_itself() {
        for shape in Shape::ALL {
            for symmetry in Symmetry::ALL {
                let got = [
                    symmetry.factor::<1>(shape),
                    symmetry.peak::<1>(shape),
                    symmetry.roughness::<1>(shape),
                    symmetry.variance::<1>(shape),
                    symmetry.efficiency::<1>(shape),
                    symmetry.canonical_scale::<1>(shape),
                ];
                let expected = [
                    1.0,
                    shape.peak(),
                    shape.roughness(),
                    shape.variance(),
                    shape.efficiency(),
                    shape.canonical_scale(),
                ];
                for (g, e) in got.into_iter().zip(expected) {
                    assert!((g - e).abs() < 1e-15, "{symmetry} {shape}: {g} {e}");
                }
            }
        }
    }

    #[test]
    fn names_lead_back() {
        for (symmetry, name) in Symmetry::ALL.into_iter().zip(Symmetry::NAMES) {
            assert_eq!(symmetry.name(), name);
            assert_eq!(Symmetry::named(name), Some(symmetry));
        }
        assert_eq!(Symmetry::named("round"), None);
    }
}
