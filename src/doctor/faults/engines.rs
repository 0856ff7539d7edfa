//! Engines that compute another sum.

use super::Fault;
use crate::engine::{Engine, Quote, Unsupported};
use crate::kernel::{Bandwidth, KernelSum, Shape, Symmetry};
use crate::numeric::special::normal_density;
use crate::sample::Sample;
use crate::space::{Domain, Field, Point, Targets};
use std::sync::Arc;

/// An engine that is given another sum than it was asked for, or whose field is spoilt.
struct Spoilt<const D: usize> {
    good: Arc<dyn Engine<D>>,
    sum: fn(KernelSum<D>) -> KernelSum<D>,
    field: fn(KernelSum<D>, Box<dyn Field<D>>) -> Box<dyn Field<D>>,
}

impl<const D: usize> Engine<D> for Spoilt<D> {
    fn name(&self) -> &'static str {
        self.good.name()
    }

    fn quote(
        &self,
        sum: &KernelSum<D>,
        targets: Targets<'_, D>,
        tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        self.good.quote(sum, targets, tolerance)
    }

    fn prepare(&self, sum: KernelSum<D>, tolerance: f64) -> Result<Box<dyn Field<D>>, Unsupported> {
        let field = self.good.prepare((self.sum)(sum.clone()), tolerance)?;
        Ok((self.field)(sum, field))
    }
}

/// h read as the whole width of the kernel.
pub const FULL_WIDTH: Fault = Fault {
    name: "full-width",
    summary: "h is taken as the whole width of the kernel, not half of it",
    caught_by: "kernel-sum",
    plant: |subjects| {
        subjects.engine = Arc::new(Spoilt {
            good: subjects.engine.clone(),
            sum: |sum| {
                let half = sum.fixed().map_or([1.0], |[h]| [0.5 * h]);
                KernelSum::new(sum.sample().clone(), sum.shape(), Bandwidth::Fixed(half))
                    .expect("half of a legal width")
            },
            field: |_, field| field,
        });
    },
};

/// A Gaussian that ends.
struct Cut(KernelSum<1>);

impl Field<1> for Cut {
    fn domain(&self) -> &Domain<1> {
        self.0.domain()
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        let h = self.0.fixed().map_or(1.0, |[h]| h);
        let sample = self.0.sample();
        sample
            .coordinates()
            .iter()
            .enumerate()
            .filter(|(_, datum)| (x - **datum).abs() <= 3.0 * h)
            .map(|(i, datum)| sample.weight(i) * normal_density((x - datum) / h) / h)
            .sum()
    }
}

/// Where the Gaussian is thought to end.
pub const TAILS_CUT: Fault = Fault {
    name: "tails-cut",
    summary: "the Gaussian is cut off at three deviations",
    caught_by: "kernel-sum",
    plant: |subjects| {
        subjects.engine = Arc::new(Spoilt {
            good: subjects.engine.clone(),
            sum: |sum| sum,
            field: |sum, _| Box::new(Cut(sum)),
        });
    },
};

/// A loop that ends one too early.
pub const POINT_LOST: Fault = Fault {
    name: "point-lost",
    summary: "the last point is left out",
    caught_by: "kernel-sum",
    plant: |subjects| {
        subjects.engine = Arc::new(Spoilt {
            good: subjects.engine.clone(),
            sum: |sum| {
                let last = sum.sample().len() - 1;
                let rest: Option<Sample<1>> = sum.sample().part(|i| i != last, 1.0);
                let rest = rest.unwrap_or_else(|| sum.sample().clone());
                KernelSum::new(rest, sum.shape(), sum.bandwidth().clone())
                    .expect("the same legal width")
            },
            field: |_, field| field,
        });
    },
};

/// A field times a number.
struct Times<const D: usize>(f64, Box<dyn Field<D>>);

impl<const D: usize> Field<D> for Times<D> {
    fn domain(&self) -> &Domain<D> {
        self.1.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        self.0 * self.1.at(x)
    }
}

/// The constant of the line squared.
pub const PRODUCT_CONSTANT: Fault = Fault {
    name: "product-constant",
    summary: "a radial kernel in the plane has the constant of a product kernel",
    caught_by: "plane-kernel-sum",
    plant: |subjects| {
        subjects.plane_engine = Arc::new(Spoilt {
            good: subjects.plane_engine.clone(),
            sum: |sum| sum,
            field: |sum, field| {
                let shape: Shape = sum.shape();
                let product = Symmetry::Product.peak::<2>(shape);
                let radial = Symmetry::Radial.peak::<2>(shape);
                Box::new(Times(product / radial, field))
            },
        });
    },
};
