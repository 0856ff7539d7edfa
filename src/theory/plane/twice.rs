//! K * K in the plane, the kernel smoothed by itself.

use crate::kernel::{Kernel, Shape, Symmetry};
use crate::numeric::{GaussLegendre, Piecewise, panels};
use crate::theory::kernel::Twice;
use std::f64::consts::PI;

pub(super) enum PlaneTwice {
    /// The same on each axis.
    Product(Twice),
    /// A function of the distance.
    Radial(Box<dyn Fn(f64) -> f64 + Send + Sync>),
}

impl PlaneTwice {
    pub(super) fn of(shape: Shape, symmetry: Symmetry) -> Self {
        match (shape, symmetry) {
            (Shape::Gaussian, Symmetry::Radial) => {
                Self::Radial(Box::new(|r| (-0.25 * r * r).exp() / (4.0 * PI)))
            }
            (_, Symmetry::Product) => Self::Product(Twice::of(shape)),
            (_, Symmetry::Radial) => {
                let rule = GaussLegendre::new(24);
                let peak = symmetry.roughness::<2>(shape);
                let overlap = |r: f64| overlap(shape, r, &rule);
                // towards 2 the overlap vanishes like a broken power: pieces that shrink towards it
                let ladder = (0..14).map(|k| 2.0 - 0.5f64.powi(k));
                let cuts = panels(0.0, 2.0, ladder, f64::INFINITY);
                let table = Piecewise::fit(overlap, &cuts, 1e-13 * peak);
                Self::Radial(Box::new(move |r| if r < 2.0 { table.at(r) } else { 0.0 }))
            }
        }
    }

    /// Nothing lies beyond.
    pub(super) fn reach(&self) -> f64 {
        match self {
            Self::Product(Twice::Compact(_)) => 2.0,
            Self::Radial(table) if table(13.0) == 0.0 => 2.0,
            _ => 13.0,
        }
    }
}

/// ∫ K(v) K(v - r e) dv over the lens where both are positive: twice the half that is nearer to r e, on which |v| ≤ 1 is the narrower condition. With
/// v = (cos φ, s sin φ) the half is a rectangle in φ and s, and nothing is singular at its rim.
fn overlap(shape: Shape, r: f64, rule: &GaussLegendre) -> f64 {
    let factor = Symmetry::Radial.factor::<2>(shape);
    let widest = (0.5 * r).clamp(-1.0, 1.0).acos();
    // v = r e, where a cone has its tip
    let tip = (r < 1.0).then(|| r.acos());
    let cuts = panels(0.0, widest, tip, 0.8);
    let half = rule.integrate_panels(
        |angle| {
            let (sine, x) = angle.sin_cos();
            let strip = |s: f64| {
                let square = (s * sine).powi(2);
                let (own, other) = (x * x + square, (x - r).powi(2) + square);
                shape.of_square(own) * shape.of_square(other)
            };
            sine * sine * rule.integrate(strip, 0.0, 1.0)
        },
        &cuts,
    );
    // both halves, above and below
    4.0 * factor * factor * half
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The overlap is a density, of twice the variance, with ∫K² at 0.
    #[test]
    fn a_kernel_smoothed_by_itself_is_a_kernel() {
        for shape in Shape::ALL {
            let twice = PlaneTwice::of(shape, Symmetry::Radial);
            let reach = twice.reach();
            let PlaneTwice::Radial(table) = twice else {
                panic!("radial")
            };
            let rule = GaussLegendre::new(24);
            let moment = |order: i32| {
                rule.integrate_panels(
                    |r| 2.0 * PI * r * table(r) * r.powi(order),
                    &panels(0.0, reach, [1.0], 0.25),
                )
            };
            let variance = Symmetry::Radial.variance::<2>(shape);
            assert!((moment(0) - 1.0).abs() < 1e-6, "{shape}: {}", moment(0));
            assert!((0.25 * moment(2) / variance - 1.0).abs() < 1e-6, "{shape}");
            let peak = Symmetry::Radial.roughness::<2>(shape);
            assert!((table(0.0) / peak - 1.0).abs() < 1e-6, "{shape}");
        }
        // two discs: the area of a lens
        let PlaneTwice::Radial(table) = PlaneTwice::of(Shape::Uniform, Symmetry::Radial) else {
            panic!("radial")
        };
        for r in [0.1f64, 0.7, 1.3, 1.9, 1.999] {
            let lens = 2.0 * (0.5 * r).acos() - 0.5 * r * (4.0 - r * r).sqrt();
            assert!((table(r) / (lens / PI / PI) - 1.0).abs() < 1e-10, "{r}");
        }
    }
}
