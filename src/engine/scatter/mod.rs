//! Widths that belong to the points: each datum adds its bump to the targets under it.
//!
//! The targets are sorted and cut into *leaves* of sixteen, over which a binary tree is laid. Where the kernel is a polynomial, the bump of a datum is one
//! polynomial over its whole window: the window is the union of a few leaves in part, whose targets are evaluated by the definition, and of O(log m)
//! nodes of the tree, each of which collects the Taylor coefficients of the bumps that cover it, about its own middle and in units of its own half
//! length. In the end the polynomials of the nodes are handed down to the leaves and evaluated. Nothing is subtracted: a polynomial is only ever used where
//! its bump is, so that narrow bumps beside wide ones cost no digits.
//!
//! The Gaussian and the cosine kernel, which are no polynomials, are evaluated target by target within their windows, the Gaussian up to nine
//! deviations and, on a grid, by a recurrence that starts anew every sixteen targets.

mod tree;

use super::bound::flatness;
use super::{Engine, Quote, Unsupported};
use crate::kernel::{Bandwidth, Form, Kernel, KernelSum, Shape};
use crate::space::{Domain, Evaluation, Field, Point, Targets};
use rayon::prelude::*;
use tree::{Places, Task};

/// Bumps added to sorted targets: exact sums on a line with any widths that do not depend on the target. O(n log m + m) for polynomial kernels, O(n · targets
/// in a window) for others, plus O(m) for every thousand data; memory for some numbers a target.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scatter;

/// Targets in a leaf: as many as can be evaluated in the time that a node takes.
const LEAF: usize = 16;

/// Data that are added into one table before it is merged into the total: bounds the rounding of long sums.
const CHUNK: usize = 1024;

/// Bytes of tables that are filled at the same time.
const BUDGET: usize = 64 << 20;

/// Beyond so many deviations the Gaussian is below 3e-18 of its peak.
const GAUSSIAN_REACH: f64 = 9.0;

/// The coefficients of the largest polynomial kernel, the triweight.
const MOST: usize = 7;

fn supported(sum: &KernelSum<1>) -> Result<(), Unsupported> {
    match sum.bandwidth() {
        Bandwidth::Fixed(_) | Bandwidth::PerPoint(_) => Ok(()),
        Bandwidth::PerTarget(_) => Err(Unsupported(
            "the bandwidth varies with the target".to_owned(),
        )),
    }
}

impl Engine<1> for Scatter {
    fn name(&self) -> &'static str {
        "scatter"
    }

    fn quote(
        &self,
        sum: &KernelSum<1>,
        targets: Targets<'_, 1>,
        _tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        supported(sum)?;
        let (n, m) = (sum.sample().len() as f64, targets.len() as f64);
        let spread = match targets {
            Targets::Grid(grid) => grid.high()[0] - grid.low()[0],
            Targets::Points(points) => {
                let (low, high) = points
                    .iter()
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &[x]| {
                        (low.min(x), high.max(x))
                    });
                high - low
            }
        };
        let reach = reach(sum.shape());
        let width = match sum.bandwidth() {
            Bandwidth::PerPoint(h) => {
                let step = h.len().div_ceil(1000);
                let some: Vec<f64> = h.iter().step_by(step).copied().collect();
                some.iter().sum::<f64>() / some.len() as f64
            }
            _ => sum.fixed_bandwidth().unwrap_or(1.0),
        };
        // targets under a bump, if they were spread evenly
        let under = (m * (2.0 * reach * width / spread).min(1.0)).max(1.0);
        let each = match sum.shape().form() {
            Form::Polynomial(_) => {
                60.0 + 3.0 * under.min(2.0 * LEAF as f64)
                    + 30.0 * (1.0 + under / LEAF as f64).log2()
            }
            Form::Gaussian => match targets {
                Targets::Grid(_) => 60.0 + 2.0 * under,
                Targets::Points(_) => 60.0 + 8.0 * under,
            },
            Form::Cosine => 40.0 + 12.0 * under,
        };
        let sorting = 60.0 * m;
        let tables = (n / CHUNK as f64).ceil() * 2.0 * m;
        Ok(Quote {
            error: error(sum.shape()),
            nanoseconds: 5_000.0 + each * n + sorting + tables,
        })
    }

    fn prepare(
        &self,
        sum: KernelSum<1>,
        _tolerance: f64,
    ) -> Result<Box<dyn Field<1>>, Unsupported> {
        supported(&sum)?;
        Ok(Box::new(Prepared(sum)))
    }
}

fn reach(shape: Shape) -> f64 {
    if shape == Shape::Gaussian {
        GAUSSIAN_REACH
    } else {
        1.0
    }
}

/// One rounding an addition, of terms whose coefficients exceed the kernel by at most 2ˢ = (1 + u²)ˢ where it is (1 - u²)ˢ; and a few for each level of the
/// tree, of which there are never forty. The recurrence of the Gaussian adds some LEAF²/2.
fn error(shape: Shape) -> f64 {
    let excess = match shape.form() {
        Form::Polynomial(_) => 2.0_f64.powi(flatness(shape)),
        _ => 1.0,
    };
    let levels = match shape.form() {
        Form::Polynomial(_) => 40.0,
        _ => (LEAF * LEAF) as f64,
    };
    0.5 * f64::EPSILON * excess * (CHUNK as f64 + levels)
}

struct Prepared(KernelSum<1>);

impl Field<1> for Prepared {
    fn domain(&self) -> &Domain<1> {
        self.0.domain()
    }

    fn at(&self, x: Point<1>) -> f64 {
        self.0.at(x)
    }

    fn evaluate(&self, targets: Targets<'_, 1>) -> Evaluation {
        let values = match targets {
            Targets::Grid(grid) => {
                let places: Vec<f64> = grid.centres().map(|[x]| x).collect();
                self.values(&Places {
                    sorted: &places,
                    grid: Some(grid),
                })
            }
            Targets::Points(points) => {
                let mut order: Vec<u32> = (0..points.len() as u32).collect();
                order.par_sort_by(|&a, &b| points[a as usize][0].total_cmp(&points[b as usize][0]));
                let sorted: Vec<f64> = order.iter().map(|&i| points[i as usize][0]).collect();
                let found = self.values(&Places {
                    sorted: &sorted,
                    grid: None,
                });
                let mut values = vec![0.0; points.len()];
                for (value, &i) in found.into_iter().zip(&order) {
                    values[i as usize] = value;
                }
                values
            }
        };
        Evaluation {
            // where a bump vanishes, rounding may fall below zero
            values: values
                .into_iter()
                .map(|v| if v < 0.0 { 0.0 } else { v })
                .collect(),
            error: error(self.0.shape()),
            engine: Some("scatter"),
            ..Evaluation::default()
        }
    }
}

impl Prepared {
    fn values(&self, places: &Places<'_>) -> Vec<f64> {
        let task = Task {
            sum: &self.0,
            places,
        };
        self.0.shape().apply(task)
    }
}

#[cfg(test)]
mod tests;
