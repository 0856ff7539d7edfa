//! Densities of which one part is not of the others.

use super::Fault;
use crate::density::{Density, NormalComponent, Univariate};
use crate::doctor::Subjects;
use crate::random::Stream;
use crate::sample::Drawn;
use crate::space::{Domain, Field, Point};
use std::sync::Arc;

/// A density with something done to its answers.
#[derive(Clone)]
struct Spoilt {
    good: Arc<dyn Univariate>,
    draws_times: f64,
    value_times: f64,
    quantile_plus: f64,
    curvature_times: f64,
}

impl Spoilt {
    fn plant(subjects: &mut Subjects, spoil: impl FnOnce(&mut Self)) {
        let mut spoilt = Self {
            good: subjects.density.clone(),
            draws_times: 1.0,
            value_times: 1.0,
            quantile_plus: 0.0,
            curvature_times: 1.0,
        };
        spoil(&mut spoilt);
        let spoilt = Arc::new(spoilt);
        subjects.source = Arc::new(Drawn(spoilt.clone()));
        subjects.density = spoilt;
    }
}

impl Field<1> for Spoilt {
    fn domain(&self) -> &Domain<1> {
        self.good.domain()
    }

    fn at(&self, x: Point<1>) -> f64 {
        self.value_times * self.good.at(x)
    }
}

impl Density<1> for Spoilt {
    fn draw(&self, random: &mut Stream) -> Point<1> {
        self.good.draw(random).map(|x| self.draws_times * x)
    }

    fn probability(&self, low: Point<1>, high: Point<1>) -> f64 {
        self.good.probability(low, high)
    }

    fn breaks(&self, axis: usize) -> Vec<f64> {
        self.good.breaks(axis)
    }

    fn finest_scale(&self, axis: usize) -> f64 {
        self.good.finest_scale(axis)
    }

    fn bulk(&self, tail: f64) -> (Point<1>, Point<1>) {
        self.good.bulk(tail)
    }

    fn univariate(&self) -> Option<&dyn Univariate> {
        Some(self)
    }
}

impl Univariate for Spoilt {
    fn distribution(&self, x: f64) -> f64 {
        self.good.distribution(x)
    }

    fn quantile(&self, p: f64) -> f64 {
        self.good.quantile((p + self.quantile_plus).min(1.0))
    }

    fn derivative(&self, order: u32, x: f64) -> f64 {
        self.good.derivative(order, x)
    }

    fn roughness(&self, order: u32) -> f64 {
        let times = if order == 2 {
            self.curvature_times
        } else {
            1.0
        };
        times * self.good.roughness(order)
    }

    fn mean_and_deviation(&self) -> (f64, f64) {
        self.good.mean_and_deviation()
    }

    fn normal_components(&self) -> Option<&[NormalComponent]> {
        self.good.normal_components()
    }
}

/// The sampler's scale.
pub const WIDE_DRAWS: Fault = Fault {
    name: "wide-draws",
    summary: "draws are spread 1 % too wide",
    caught_by: "draws",
    plant: |subjects| Spoilt::plant(subjects, |spoilt| spoilt.draws_times = 1.01),
};

/// The inverse of another function.
pub const QUANTILE_OFF: Fault = Fault {
    name: "quantile-off",
    summary: "quantiles are those of p + 0.001",
    caught_by: "quantiles",
    plant: |subjects| Spoilt::plant(subjects, |spoilt| spoilt.quantile_plus = 0.001),
};

/// A normalising constant.
pub const TOO_HIGH: Fault = Fault {
    name: "density-too-high",
    summary: "the density is 1 % too high everywhere",
    caught_by: "density-mass",
    plant: |subjects| Spoilt::plant(subjects, |spoilt| spoilt.value_times = 1.01),
};

/// What the AMISE rests on.
pub const CURVATURE_OFF: Fault = Fault {
    name: "curvature-off",
    summary: "R(f″) is 1 % too large",
    caught_by: "roughness",
    plant: |subjects| Spoilt::plant(subjects, |spoilt| spoilt.curvature_times = 1.01),
};
