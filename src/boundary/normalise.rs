//! What kernels lay outside is made up for by what they lay inside: cut and normalise.
//!
//! *From the target*: f̂(x) / a₀(x), a₀ the share of the kernel around x inside. Exact for a uniform density, but the mass is not kept. *From the point*: each
//! bump is divided by its own share, so that it lays all of its mass inside; the mass is kept, but even a uniform density comes out wrong near
//! the wall, as the bumps that are cut and those that are not meet there. The two are different estimators.

use super::within::Within;
use super::{Boundary, BoundaryError, Bump, Compute, Equivalent, Promises, one_width};
use crate::kernel::KernelSum;
use crate::sample::{Sample, Weights};
use crate::space::{Domain, Evaluation, Field, Point, Targets};
use rayon::prelude::*;

/// f̂(x) / a₀(x). [Gasser & Müller 1979] Bias O(h) where the density has a slope at the wall.
#[derive(Clone, Copy, Debug, Default)]
pub struct NormaliseTargets;

/// Σ wᵢ K_h(x - Xᵢ) / a₀(Xᵢ).
#[derive(Clone, Copy, Debug, Default)]
pub struct NormalisePoints;

/// 1 / a₀(x), and zero where no kernel is left.
fn inverse_share<const D: usize>(bump: &Bump<D>, domain: &Domain<D>, x: Point<D>) -> f64 {
    if bump.is_clear(domain, x) {
        return 1.0;
    }
    let share = bump.moments(domain, x).mass;
    if share > 0.0 { share.recip() } else { 0.0 }
}

impl<const D: usize> Boundary<D> for NormaliseTargets {
    fn name(&self) -> &'static str {
        "normalise"
    }

    fn promises(&self) -> Promises {
        Promises {
            mass_conserving: false,
            non_negative: true,
            linear: true,
            reproduces_constants: true,
            reproduces_lines: false,
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
        let bump = one_width(&sum, "normalise")?;
        Ok(Box::new(Normalised {
            domain: sum.sample().domain().clone(),
            bump,
            field: compute(sum),
        }))
    }

    fn equivalent<'a>(
        &self,
        bump: &'a Bump<D>,
        domain: &'a Domain<D>,
        x: Point<D>,
    ) -> Option<Equivalent<'a, D>> {
        let factor = inverse_share(bump, domain, x);
        Some(Box::new(move |y| factor * bump.value(x, y)))
    }
}

struct Normalised<const D: usize> {
    domain: Domain<D>,
    bump: Bump<D>,
    field: Box<dyn Field<D>>,
}

impl<const D: usize> Normalised<D> {
    fn factor(&self, x: Point<D>) -> f64 {
        if self.domain.contains(x) {
            inverse_share(&self.bump, &self.domain, x)
        } else {
            0.0
        }
    }
}

impl<const D: usize> Field<D> for Normalised<D> {
    fn domain(&self) -> &Domain<D> {
        &self.domain
    }

    fn at(&self, x: Point<D>) -> f64 {
        let factor = self.factor(x);
        if factor > 0.0 {
            factor * self.field.at(x)
        } else {
            0.0
        }
    }

    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        let mut evaluation = self.field.evaluate(targets);
        let places: Vec<Point<D>> = targets.places().collect();
        let factors: Vec<f64> = places.into_par_iter().map(|x| self.factor(x)).collect();
        let mut largest = 1.0_f64;
        for (value, factor) in evaluation.values.iter_mut().zip(factors) {
            *value *= factor;
            largest = largest.max(factor);
        }
        evaluation.error *= largest;
        evaluation
    }
}

impl<const D: usize> Boundary<D> for NormalisePoints {
    fn name(&self) -> &'static str {
        "normalise-points"
    }

    fn promises(&self) -> Promises {
        Promises {
            mass_conserving: true,
            non_negative: true,
            linear: true,
            reproduces_constants: false,
            reproduces_lines: false,
        }
    }

    fn correct(
        &self,
        sum: KernelSum<D>,
        compute: Compute<'_, D>,
    ) -> Result<Box<dyn Field<D>>, BoundaryError> {
        let sample = sum.sample();
        let domain = sample.domain().clone();
        if !domain.has_walls() {
            return Ok(compute(sum));
        }
        if matches!(sum.bandwidth(), crate::kernel::Bandwidth::PerTarget(_)) {
            return Err(BoundaryError(
                "the boundary \"normalise-points\" divides each bump by its own share inside, which a bandwidth of the target does not have; use ignore".to_owned(),
            ));
        }
        let weights: Vec<f64> = sample
            .points()
            .par_iter()
            .enumerate()
            .map(|(i, x)| sample.weight(i) * inverse_share(&Bump::of(&sum, i, *x), &domain, *x))
            .collect();
        let lifted = Sample::new(
            sample.points().to_vec(),
            Weights::Each(weights.into()),
            domain.clone(),
        )
        .map_err(|error| BoundaryError(error.to_string()))?;
        let sum = KernelSum::new(lifted, sum.shape(), sum.bandwidth().clone())
            .map_err(|error| BoundaryError(error.to_string()))?
            .with_symmetry(sum.symmetry());
        Ok(Box::new(Within {
            domain,
            field: compute(sum),
        }))
    }

    fn equivalent<'a>(
        &self,
        bump: &'a Bump<D>,
        domain: &'a Domain<D>,
        x: Point<D>,
    ) -> Option<Equivalent<'a, D>> {
        Some(Box::new(move |y| {
            let value = bump.value(x, y);
            // far more places are out of reach than within
            if value == 0.0 {
                0.0
            } else {
                value * inverse_share(bump, domain, y)
            }
        }))
    }
}
