//! A kernel of the plane convolved with itself: what ∫ f̂² is a sum of.
//!
//! | kernel | K∗K | computed |
//! |---|---|---|
//! | Gaussian | exp(-(u² + v²)/4) / (4π) | as it stands |
//! | product | a product of two convolutions of the line, polynomials on [0, 1] and [1, 2] | from a table of the polynomials |
//! | radial | ∫ over the lens where two discs overlap | from a table in θ = arccos(r/2) |
//!
//! In elliptic coordinates about the two centres (distances a, b = f (cosh μ ± cos ν), f = r/2) the area is f² (cosh²μ - cos²ν) dμ dν and every kernel is smooth inside the lens, so that Gauss
//! panels see no singularity; in θ the result is smooth at r = 2, where in r it ends with a half power. Relative to K∗K (0) the tables are good to 1e-11, which the tests check against known closed forms.
//! They are made once a process, on first use.

use super::super::pairs::convolution::convolution;
use crate::kernel::{Kernel, Shape, Symmetry};
use crate::numeric::{GaussLegendre, Piecewise, panels};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI};
use std::sync::OnceLock;

/// K∗K and K for one kernel of unit width.
#[derive(Clone, Copy)]
pub(super) struct Overlap {
    shape: Shape,
    symmetry: Symmetry,
    factor: f64,
    table: Option<&'static Piecewise>,
}

static PRODUCTS: [OnceLock<Piecewise>; 7] = [const { OnceLock::new() }; 7];
static RADIALS: [OnceLock<Piecewise>; 7] = [const { OnceLock::new() }; 7];

impl Overlap {
    pub fn new(shape: Shape, symmetry: Symmetry) -> Self {
        let number = Shape::ALL.iter().position(|&other| other == shape);
        let number = number.expect("all shapes are in the list");
        let factor = symmetry.factor::<2>(shape);
        let table = match (shape, symmetry) {
            (Shape::Gaussian, _) => None,
            (_, Symmetry::Product) => Some(PRODUCTS[number].get_or_init(|| {
                Piecewise::fit(|u| convolution(shape, u), &[0.0, 1.0, 2.0], 1e-14)
            })),
            (_, Symmetry::Radial) => Some(RADIALS[number].get_or_init(|| {
                let lens = Lens::new(shape);
                let of_angle = |theta: f64| factor * factor * lens.integral(2.0 * theta.cos());
                let small = 1e-12 * symmetry.roughness::<2>(shape);
                Piecewise::fit(of_angle, &[0.0, FRAC_PI_3, FRAC_PI_2], small)
            })),
        };
        Self {
            shape,
            symmetry,
            factor,
            table,
        }
    }

    /// How far K∗K reaches, on one axis and as a distance; beyond it a Gaussian is below 1e-17 of its peak.
    pub fn reach(&self) -> f64 {
        if self.table.is_some() { 2.0 } else { 12.6 }
    }

    /// (K∗K)(u, v).
    #[inline]
    pub fn at(&self, u: f64, v: f64) -> f64 {
        let Some(table) = self.table else {
            return (-0.25 * u.mul_add(u, v * v)).exp() * (0.25 / PI);
        };
        match self.symmetry {
            Symmetry::Product => {
                let (u, v) = (u.abs(), v.abs());
                if u >= 2.0 || v >= 2.0 {
                    return 0.0;
                }
                table.at(u) * table.at(v)
            }
            Symmetry::Radial => {
                let square = u.mul_add(u, v * v);
                if square >= 4.0 {
                    return 0.0;
                }
                table.at((0.5 * square.sqrt()).acos())
            }
        }
    }

    /// K(u, v).
    #[inline]
    pub fn kernel(&self, u: f64, v: f64) -> f64 {
        match self.symmetry {
            Symmetry::Product => {
                let first = self.shape.value(u);
                if first == 0.0 {
                    0.0
                } else {
                    first * self.shape.value(v)
                }
            }
            Symmetry::Radial => self.factor * self.shape.of_square(u.mul_add(u, v * v)),
        }
    }
}

/// ∫ K(a) K(b) over the lens of points within 1 of both of two centres, K being that of the line.
struct Lens {
    shape: Shape,
    rule: GaussLegendre,
}

impl Lens {
    fn new(shape: Shape) -> Self {
        Self {
            shape,
            rule: GaussLegendre::new(20),
        }
    }

    /// The integral for centres `r` apart, 0 ≤ r ≤ 2.
    fn integral(&self, r: f64) -> f64 {
        let focus = 0.5 * r;
        if focus < 1e-9 {
            // the ring integral at r = 0
            let ring = |s: f64| 2.0 * PI * s * self.shape.value(s).powi(2);
            return self.rule.integrate(ring, 0.0, 1.0);
        }
        if focus >= 1.0 {
            return 0.0;
        }
        // where the lens begins: cosh μ ≥ 1 needs cos ν ≤ 1/f - 1
        let start = (1.0 / focus - 1.0).min(1.0).acos();
        let length = FRAC_PI_2 - start;
        // the upper limit of μ opens like a root at the start, so ν = start + length s²
        let outer = |s: f64| {
            let nu = start + length * s * s;
            let cosine = nu.cos();
            // cosh μ - 1 without its cancellation
            let above = (1.0 / focus - cosine - 1.0).max(0.0);
            let most = (above + (above * (above + 2.0)).sqrt()).ln_1p();
            let inner = |mu: f64| {
                let cosh = mu.cosh();
                let (a, b) = (focus * (cosh + cosine), focus * (cosh - cosine));
                // what rounding puts beyond the edge is on it
                let value = self.shape.value(a.min(1.0)) * self.shape.value(b.clamp(0.0, 1.0));
                value * focus * focus * (cosh - cosine) * (cosh + cosine)
            };
            2.0 * s
                * length
                * self
                    .rule
                    .integrate_panels(inner, &panels(0.0, most, [], 2.0))
        };
        let cuts = [0.0, 0.02, 0.1, 0.3, 0.65, 1.0];
        4.0 * self.rule.integrate_panels(outer, &cuts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discs_overlap_as_geometry_says() {
        let overlap = Overlap::new(Shape::Uniform, Symmetry::Radial);
        for r in [0.0_f64, 1e-6, 0.3, 0.999, 1.0, 1.4, 1.9, 1.999_99, 2.0] {
            let half = 0.5 * r;
            // the area of the lens over the square of that of the disc
            let lens = 2.0 * half.acos() - r * (1.0 - half * half).sqrt();
            let got = overlap.at(r * 0.6, r * 0.8);
            assert!((got - lens / (PI * PI)).abs() < 1e-11, "{r}: {got}");
        }
    }

    /// K∗K of unit mass, height R(K) and, at one place, equal to a plain sum over a fine grid.
    #[test]
    fn every_overlap_has_its_height_its_mass_and_its_values() {
        let rule = GaussLegendre::new(24);
        for shape in Shape::ALL {
            for symmetry in Symmetry::ALL {
                let overlap = Overlap::new(shape, symmetry);
                let height = symmetry.roughness::<2>(shape);
                assert!((overlap.at(0.0, 0.0) - height).abs() < 1e-11 * height);
                let far = overlap.reach().min(12.0);
                let cuts = panels(0.0, far, [1.0, 2.0], 0.5);
                let row = |v: f64| {
                    // the edge of a disc runs through the square
                    let edge = (4.0 - v * v).max(0.0).sqrt();
                    let cuts = panels(0.0, far, [1.0, edge, edge - 0.05, edge - 0.3], 0.5);
                    rule.integrate_panels(|u| overlap.at(u, v), &cuts)
                };
                let mass = 4.0 * rule.integrate_panels(row, &cuts);
                assert!((mass - 1.0).abs() < 2e-6, "{symmetry} {shape}: {mass}");
                // ∫∫ K(x) K(x - d) dx by definition, on a fine midpoint grid
                let (d, step, most) = ([0.7, -0.45], 0.008, if far > 2.0 { 7.0 } else { 1.0 });
                let count = (2.0 * most / step) as u32;
                let place = |i: u32| step * (f64::from(i) + 0.5) - most;
                let sum: f64 = (0..count)
                    .flat_map(|i| (0..count).map(move |j| (place(i), place(j))))
                    .map(|(x, y)| overlap.kernel(x, y) * overlap.kernel(x - d[0], y - d[1]))
                    .sum();
                let (got, sum) = (overlap.at(d[0], d[1]), sum * step * step);
                // midpoints see an edge with a jump to a hundredth only
                let jump = if shape == Shape::Uniform { 1e-2 } else { 2e-5 };
                assert!(
                    (got / sum - 1.0).abs() < jump,
                    "{symmetry} {shape}: {got} {sum}"
                );
            }
        }
    }
}
