//! The kernel times the line that gives back what the wall took from its mass and its mean.
//!
//! f̂(x) = e₁ᵀ M⁻¹ Σ wᵢ (1, tᵢ)ᵀ K_h(tᵢ), tᵢ = (Xᵢ - x)/h, with M = ∫ (1, t)(1, t)ᵀ K over the domain: the value at x of the line that fits the data best in
//! the kernel's weighting. So it reproduces every linear density, on any polygon, and is the plain sum where the kernel is clear of walls. It can be negative and
//! need not integrate to the mass. Where M is singular (a sliver of the kernel left) the answer is that of [`super::NormaliseTargets`], and the number of such targets is reported.

use super::nearby::Nearby;
use super::{
    Boundary, BoundaryError, Bump, Compute, DomainMoments, Equivalent, Promises, one_width,
};
use crate::kernel::KernelSum;
use crate::numeric::Sum;
use crate::space::{Domain, Evaluation, Field, Point, Targets, Warning};
use rayon::prelude::*;
use std::sync::OnceLock;

/// Local linear, or its positive version f̄ exp(f̂/f̄ - 1) with f̄ cut and normalised, which agrees with it to the order of the bias. [Lejeune & Sarda 1992; Jones 1993;
/// Jones & Foster 1996, eq. 2.1]
#[derive(Clone, Copy, Debug, Default)]
pub struct LocalLinear {
    /// Whether to keep the estimate positive.
    pub positive: bool,
}

/// Below this determinant of the variance of the kernel that is left, in units of h, no line can be fitted.
const SINGULAR: f64 = 1e-12;

/// (α, β) with κ = (α + βᵀt) K: the first row of M⁻¹.
#[derive(Clone, Copy, Debug)]
struct Line<const D: usize> {
    constant: f64,
    slope: [f64; D],
    /// Whether M was singular, and only the mass is given back.
    fallback: bool,
}

impl<const D: usize> Line<D> {
    fn through(moments: &DomainMoments<D>) -> Self {
        let DomainMoments {
            mass,
            first,
            second,
        } = moments;
        let cut = Self {
            constant: if *mass > 0.0 { mass.recip() } else { 0.0 },
            slope: [0.0; D],
            fallback: true,
        };
        if *mass <= 0.0 {
            return cut;
        }
        // with the mean m and the variance V of the kernel inside: α = (1 + mᵀV⁻¹m)/a₀, β = -V⁻¹m/a₀
        let mean: [f64; D] = std::array::from_fn(|i| first[i] / mass);
        let variance: [[f64; D]; D] = std::array::from_fn(|i| {
            std::array::from_fn(|j| second[i][j] / mass - mean[i] * mean[j])
        });
        // V⁻¹m, of one equation or of two
        let [a, b] = [variance[0][0], variance[0][D - 1]];
        let (determinant, solution) = if D == 1 {
            (a, [mean[0] / a; 2])
        } else {
            let d = variance[1][1];
            let determinant = a * d - b * b;
            let x = (d * mean[0] - b * mean[1]) / determinant;
            let y = (a * mean[1] - b * mean[0]) / determinant;
            (determinant, [x, y])
        };
        if determinant.is_nan() || determinant <= SINGULAR {
            return cut;
        }
        let solved: [f64; D] = std::array::from_fn(|i| solution[i]);
        let quadratic: f64 = (0..D).map(|i| mean[i] * solved[i]).sum();
        Self {
            constant: (1.0 + quadratic) / mass,
            slope: solved.map(|s| -s / mass),
            fallback: false,
        }
    }

    fn at(&self, bump: &Bump<D>, x: Point<D>, y: Point<D>) -> f64 {
        (0..D).fold(self.constant, |line, axis| {
            self.slope[axis].mul_add((y[axis] - x[axis]) / bump.width[axis], line)
        })
    }
}

impl<const D: usize> Boundary<D> for LocalLinear {
    fn name(&self) -> &'static str {
        if self.positive {
            "jones-foster"
        } else {
            "local-linear"
        }
    }

    fn promises(&self) -> Promises {
        Promises {
            mass_conserving: false,
            non_negative: self.positive,
            linear: !self.positive,
            // where data are even the two estimates that the positive version mixes agree
            reproduces_constants: true,
            reproduces_lines: !self.positive,
        }
    }

    fn correct(
        &self,
        sum: KernelSum<D>,
        compute: Compute<'_, D>,
    ) -> Result<Box<dyn Field<D>>, BoundaryError> {
        if !sum.sample().domain().has_walls() {
            return Ok(compute(sum));
        }
        let bump = one_width(&sum, Boundary::<D>::name(self))?;
        Ok(Box::new(Corrected {
            positive: self.positive,
            bump,
            field: compute(sum.clone()),
            nearby: OnceLock::new(),
            sum,
        }))
    }

    fn equivalent<'a>(
        &self,
        bump: &'a Bump<D>,
        domain: &'a Domain<D>,
        x: Point<D>,
    ) -> Option<Equivalent<'a, D>> {
        if self.positive {
            return None;
        }
        if bump.is_clear(domain, x) {
            return Some(Box::new(move |y| bump.value(x, y)));
        }
        let line = Line::through(&bump.moments(domain, x));
        Some(Box::new(move |y| line.at(bump, x, y) * bump.value(x, y)))
    }
}

struct Corrected<const D: usize> {
    positive: bool,
    sum: KernelSum<D>,
    bump: Bump<D>,
    /// The plain sum, for targets clear of walls.
    field: Box<dyn Field<D>>,
    nearby: OnceLock<Nearby<D>>,
}

impl<const D: usize> Corrected<D> {
    /// The value at a place that is not clear of walls, and whether the line had to be given up.
    fn near_a_wall(&self, x: Point<D>) -> (f64, bool) {
        let domain = self.sum.domain();
        if !domain.contains(x) {
            return (0.0, false);
        }
        let moments = self.bump.moments(domain, x);
        let line = Line::through(&moments);
        let nearby = self
            .nearby
            .get_or_init(|| Nearby::new(&self.sum, &self.bump));
        let (mut linear, mut plain) = (Sum::default(), Sum::default());
        nearby.visit(x, |point, weight| {
            let term = weight * self.bump.value(x, point);
            if term != 0.0 {
                linear.add(term * line.at(&self.bump, x, point));
                plain.add(term);
            }
        });
        let value = linear.value();
        if !self.positive {
            return (value, line.fallback);
        }
        let cut = if moments.mass > 0.0 {
            plain.value() / moments.mass
        } else {
            0.0
        };
        let positive = if cut > 0.0 {
            cut * (value / cut - 1.0).exp()
        } else {
            0.0
        };
        (positive, line.fallback)
    }
}

impl<const D: usize> Field<D> for Corrected<D> {
    fn domain(&self) -> &Domain<D> {
        self.sum.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        if self.bump.is_clear(self.domain(), x) {
            self.field.at(x)
        } else {
            self.near_a_wall(x).0
        }
    }

    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        let mut evaluation = self.field.evaluate(targets);
        let places: Vec<Point<D>> = targets.places().collect();
        let corrected: Vec<Option<(f64, bool)>> = places
            .into_par_iter()
            .map(|x| (!self.bump.is_clear(self.domain(), x)).then(|| self.near_a_wall(x)))
            .collect();
        let mut fallbacks = 0;
        for (value, corrected) in evaluation.values.iter_mut().zip(corrected) {
            if let Some((near, fallback)) = corrected {
                *value = near;
                fallbacks += usize::from(fallback);
            }
        }
        if fallbacks > 0 {
            evaluation.warnings.push(Warning {
                what: format!(
                    "at {fallbacks} of {} targets so little of the kernel lies inside that no line can be fitted; the estimate there is cut and normalised",
                    evaluation.values.len()
                ),
                hint: "a larger bandwidth avoids this".to_owned(),
            });
        }
        evaluation
    }
}
