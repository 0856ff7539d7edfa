//! Compact kernels on a grid, exact at the price of a histogram.
//!
//! With a kernel that is one polynomial on each side of 0 (or a cosine), the sum at the grid point xⱼ changes its formula only where a
//! datum enters its window at xⱼ - h, passes xⱼ itself (if the kernel has a kink there) or leaves at xⱼ + h. These breakpoints are two or three
//! interleaved arithmetic progressions; they cut the line into at most 2m + 1 (3m + 1) intervals, within each of which all data are
//! alike. One pass over the data finds the interval of each datum by rounding - no sort, no search - and adds its few
//! moments there (`regular.rs`; `merged.rs` where windows are wider than the grid); one pass over the grid puts the intervals under each window together ([`Ladder`]).
//!
//! **Data at a breakpoint.** Where rounding could put a datum on either side of a breakpoint, the definition decides: the datum is assigned
//! as found, and the difference between the definition and that assignment is added to the one grid point concerned. This is what makes a kernel
//! that jumps (uniform) agree with the definition in every bit decision, and what keeps data far from 0, whose grid points are
//! themselves rounded, exact.
//!
//! **Rounding.** Moments are kept about the centre of their interval, subtracted before scaling; runs of a few thousand additions
//! are closed and added to the total of a block, blocks to the total of all, each in a fixed order, so that the bits do not depend on
//! the number of threads.

mod lattice;
mod merged;
mod regular;
mod sweep;

use super::basis::{Basis, Parabola, Powers, Side, Waves};
use super::ladder::{Item, Ladder};
use super::{Engine, Quote, Unsupported};
use crate::kernel::{Form, Kernel, KernelSum, Shape};
use crate::sample::Weights;
use crate::space::{Domain, Evaluation, Field, Point, Targets};
pub(super) use lattice::{Lattice, Partition};
use merged::Merged;
use rayon::prelude::*;
use regular::Regular;
use sweep::{Partial, Places, sweep};

/// Interval moments: exact sums of compact kernels on a grid of a line. O(n + m) time, O(m) memory beyond the data.
#[derive(Clone, Copy, Debug, Default)]
pub struct Interval;

impl Engine<1> for Interval {
    fn name(&self) -> &'static str {
        "interval"
    }

    fn quote(
        &self,
        sum: &KernelSum<1>,
        targets: Targets<'_, 1>,
        _tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        let shape = sum.shape();
        let h = supported(sum)?;
        let Targets::Grid(grid) = targets else {
            return Err(Unsupported(
                "the targets are scattered: intervals need a grid".to_owned(),
            ));
        };
        let lattice = Lattice::new(grid, h, shape)?;
        Ok(Quote {
            error: lattice.error(sum),
            nanoseconds: 20_000.0
                + per_point(shape) * sum.sample().len() as f64
                + 150.0 * grid.len() as f64,
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

/// The bandwidth, if the sum is one that separates.
pub(super) fn supported(sum: &KernelSum<1>) -> Result<f64, Unsupported> {
    if sum.shape().form() == Form::Gaussian {
        return Err(Unsupported(
            "the Gaussian is not compact: it has no intervals".to_owned(),
        ));
    }
    sum.fixed_bandwidth()
        .ok_or_else(|| Unsupported("the bandwidth varies: moments need one for all".to_owned()))
}

/// Measured nanoseconds per datum on one thread.
fn per_point(shape: Shape) -> f64 {
    match shape {
        Shape::Uniform => 1.5,
        Shape::Epanechnikov => 2.0,
        Shape::Triangular => 2.5,
        Shape::Biweight | Shape::Cosine => 3.0,
        Shape::Triweight | Shape::Gaussian => 4.0,
    }
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
        let h = self.0.fixed_bandwidth().unwrap_or(f64::NAN);
        let (values, error) = match targets {
            Targets::Grid(grid) => match Lattice::new(grid, h, self.0.shape()) {
                Ok(lattice) => (on_lattice(&self.0, &lattice), lattice.error(&self.0)),
                Err(_) => (by_definition(&self.0, targets), 4.0 * f64::EPSILON),
            },
            Targets::Points(_) => (by_definition(&self.0, targets), 4.0 * f64::EPSILON),
        };
        Evaluation {
            values,
            error,
            engine: Some("interval"),
            ..Evaluation::default()
        }
    }
}

/// What `quote` refuses is still answered, slowly.
fn by_definition(sum: &KernelSum<1>, targets: Targets<'_, 1>) -> Vec<f64> {
    let places: Vec<Point<1>> = targets.places().collect();
    places.into_par_iter().map(|x| sum.at(x)).collect()
}

fn on_lattice(sum: &KernelSum<1>, lattice: &Lattice<'_>) -> Vec<f64> {
    match sum.shape().form() {
        Form::Polynomial(c) => match c.len() {
            1 => compute(sum, lattice, Powers::<1>::new(c)),
            2 => compute(sum, lattice, Powers::<2>::new(c)),
            3 => compute(sum, lattice, Parabola::new(c)),
            5..=7 => compute(sum, lattice, Powers::<8>::new(c)),
            _ => by_definition(sum, Targets::Grid(lattice.grid)),
        },
        Form::Cosine => compute(sum, lattice, Waves),
        Form::Gaussian => by_definition(sum, Targets::Grid(lattice.grid)),
    }
}

fn sweep_either<B: Basis<N>, P: Places, const N: usize>(
    sum: &KernelSum<1>,
    lattice: &Lattice<'_>,
    partition: &Partition,
    places: &P,
    basis: B,
) -> Partial<N> {
    if lattice.doubt > 0.0 {
        sweep::<B, P, N, true>(sum, lattice, partition, places, basis)
    } else {
        sweep::<B, P, N, false>(sum, lattice, partition, places, basis)
    }
}

fn compute<B: Basis<N>, const N: usize>(
    sum: &KernelSum<1>,
    lattice: &Lattice<'_>,
    basis: B,
) -> Vec<f64> {
    let (partition, total) = if let Some(regular) = Regular::new(lattice) {
        let partition = regular.partition(lattice);
        let total = sweep_either(sum, lattice, &partition, &regular, basis);
        (partition, total)
    } else {
        let partition = Partition::new(lattice);
        let merged = Merged::new(lattice, &partition);
        let total = sweep_either(sum, lattice, &partition, &merged, basis);
        (partition, total)
    };
    // what lies beyond all windows is left out
    let last = lattice.grid.len() - 1;
    let (begin, end) = (partition.windows[0][0], partition.windows[last][2]);
    let items = (begin as usize..end as usize)
        .map(|k| Item {
            low: partition.edges[k],
            high: partition.edges[k + 1],
            centre: partition.centres[k],
            moments: total.rows[k],
        })
        .collect();
    let h = lattice.h;
    let window = if B::KINKED { h } else { 2.0 * h };
    let ladder = Ladder::new(basis, h.recip(), window, items);
    let factor = match sum.sample().weights() {
        Weights::Equal(weight) => weight / h,
        Weights::Each(_) => h.recip(),
    };
    (0..lattice.grid.len())
        .into_par_iter()
        .map(|j| {
            let x = lattice.grid.coordinate(0, j);
            let [enter, pass, leave] =
                partition.windows[j].map(|k| (k as usize).wrapping_sub(begin as usize));
            let inside = if B::KINKED {
                ladder.sum(enter, pass, x, Side::Right) + ladder.sum(pass, leave, x, Side::Left)
            } else {
                ladder.sum(enter, leave, x, Side::Right)
            };
            let correction = total.corrections.get(j).copied().unwrap_or(0.0);
            // kernels and weights are not negative, so less than nothing can only be rounding
            (inside + correction).max(0.0) * factor
        })
        .collect()
}
