//! Gather: each target looks into the cells around it.
//!
//! The data are put in order of the cells of a coarse mesh, rows of which are contiguous in memory, so that what a target needs is one run of data in each of a few rows. The mesh spans the
//! bulk of the data; what lies beyond is held by its border cells, so that outliers cost a little time but no memory, and the cells are never more than a few times the data however small h is. Data with widths of
//! their own are sorted by size first: each class of sizes within a factor of two has a mesh of its own.
//!
//! Whether a datum is inside a kernel's support is decided by the same operations as in the definition; a run of up to [`RUN`] data is summed in vector registers, runs are added compensated.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::super::{Engine, Quote, Unsupported};
use super::look;
use super::pieces::{Bands, Cells, Data, Slices, cells, pieces};
use super::profile::{Profile, reach, scale, with_profile};
use crate::kernel::{Bandwidth, KernelSum, Shape, Symmetry};
use crate::numeric::Sum;
use crate::sample::Weights;
use crate::space::{Domain, Evaluation, Field, Point, Targets};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Data summed without compensation.
const RUN: usize = 1024;

/// Vector lanes of a sum.
const LANES: usize = 8;

/// Gather at any targets: any kernel, product or radial, any rule for the width. O(n + m · (data within reach)); the Gaussian is cut where it falls below half
/// of the tolerance.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gather;

/// What cutting the Gaussian may leave out.
fn cut(tolerance: f64) -> f64 {
    0.5 * tolerance.clamp(1e-15, 0.5)
}

impl Engine<2> for Gather {
    fn name(&self) -> &'static str {
        "gather"
    }

    fn quote(
        &self,
        sum: &KernelSum<2>,
        targets: Targets<'_, 2>,
        tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        let radius = reach(sum.shape(), cut(tolerance));
        let (typical, classes) = match sum.bandwidth() {
            Bandwidth::Fixed(h) => (*h, 1.0),
            Bandwidth::PerPoint(widths) => {
                let every = widths.len().div_ceil(64);
                let seen = widths.iter().step_by(every);
                let mean = seen.clone().sum::<f64>() / seen.count() as f64;
                ([mean; 2], 6.0)
            }
            Bandwidth::PerTarget(field) => {
                let every = targets.len().div_ceil(16).max(1);
                let seen: Vec<f64> = targets
                    .places()
                    .step_by(every)
                    .map(|x| field.at(x))
                    .collect();
                let mean = seen.iter().sum::<f64>() / seen.len().max(1) as f64;
                ([mean; 2], 1.0)
            }
        };
        let near = look::neighbours(sum.sample(), typical.map(|h| 1.25 * radius * h));
        let pair = match sum.shape() {
            Shape::Gaussian => 4.0,
            Shape::Cosine => 2.5,
            Shape::Triangular | Shape::Uniform => 2.0,
            _ => 1.0,
        };
        // a guess from the other engines: 50 ns to order a datum, 250 ns a target to find its rows of cells, about 1 ns a pair
        Ok(Quote {
            error: error(sum, tolerance),
            nanoseconds: 5_000.0
                + 50.0 * sum.sample().len() as f64
                + targets.len() as f64 * (classes * 250.0 + pair * near),
        })
    }

    fn prepare(&self, sum: KernelSum<2>, tolerance: f64) -> Result<Box<dyn Field<2>>, Unsupported> {
        let radius = reach(sum.shape(), cut(tolerance));
        let classes = classes(&sum, radius);
        Ok(Box::new(Prepared {
            sum,
            tolerance,
            radius,
            classes,
        }))
    }
}

/// Relative to the ceiling: the additions of a run, some ten roundings a term, what is cut.
fn error(sum: &KernelSum<2>, tolerance: f64) -> f64 {
    let chain = sum.sample().len().min(RUN) as f64;
    let cut = if sum.shape() == Shape::Gaussian {
        cut(tolerance)
    } else {
        0.0
    };
    0.5 * f64::EPSILON * (chain + 24.0) + cut
}

/// Data of similar width in the order of the cells of one mesh.
struct Class {
    /// No datum of the class reaches farther, in the units of the axes; 0 where the width belongs to the target.
    reach: [f64; 2],
    low: [f64; 2],
    inverse: [f64; 2],
    count: [usize; 2],
    /// One for each row of cells.
    rows: Vec<Cells>,
}

fn classes(sum: &KernelSum<2>, radius: f64) -> Vec<Class> {
    let sample = sum.sample();
    match sum.bandwidth() {
        Bandwidth::Fixed(h) => vec![Class::new(
            sum,
            Data::of(sample, None),
            h.map(|h| radius * h),
        )],
        Bandwidth::PerTarget(_) => vec![Class::new(sum, Data::of(sample, None), [0.0; 2])],
        Bandwidth::PerPoint(widths) => {
            let mut sizes: Vec<(i32, u32)> = (0_u32..)
                .zip(widths.iter())
                .map(|(i, h)| (h.log2().floor() as i32, i))
                .collect();
            sizes.sort_unstable();
            sizes
                .chunk_by(|a, b| a.0 == b.0)
                .map(|class| {
                    let pick = |from: &dyn Fn(usize) -> f64| -> Vec<f64> {
                        class.iter().map(|(_, i)| from(*i as usize)).collect()
                    };
                    let points: Vec<Point<2>> = class
                        .iter()
                        .map(|(_, i)| sample.points()[*i as usize])
                        .collect();
                    let weights = match sample.weights() {
                        Weights::Equal(_) => None,
                        Weights::Each(weights) => Some(pick(&|i| weights[i])),
                    };
                    let own = pick(&|i| widths[i]);
                    let widest = own.iter().copied().fold(0.0, f64::max);
                    let data = Data {
                        points: &points,
                        weights: weights.as_deref(),
                        widths: Some(&own),
                    };
                    Class::new(sum, data, [radius * widest; 2])
                })
                .collect()
        }
    }
}

impl Class {
    fn new(sum: &KernelSum<2>, data: Data<'_>, reach: [f64; 2]) -> Self {
        let n = data.points.len() as f64;
        let core = look::core(sum.sample());
        let length = core.map(|[low, high]| (high - low).min(f64::MAX));
        // rows of a fifth of a window, cells of an eighth; where that makes too many, all wider by one factor
        let fractions = [2.5, 4.0];
        let most = (4.0 * n).max(64.0);
        let wish = [0, 1].map(|axis| {
            let cells = fractions[axis] * length[axis] / reach[axis];
            // NaN where there is no length and no reach
            if cells >= 1.0 { cells.min(1e15) } else { 1.0 }
        });
        let too_many = (wish[0] * wish[1] / most).max(1.0);
        let mut count = wish.map(|wish| wish / too_many.sqrt());
        for axis in 0..2 {
            // one axis may have few cells anyhow
            if count[axis] < 1.0 {
                count[1 - axis] *= count[axis];
                count[axis] = 1.0;
            }
        }
        // a row of cells is a table of its own: not too many of these
        let count = [(count[0], 1 << 13), (count[1], 1 << 20)]
            .map(|(count, most)| (count.ceil() as usize).clamp(1, most));
        let inverse = [0, 1].map(|axis| {
            let inverse = count[axis] as f64 / length[axis];
            if inverse.is_finite() { inverse } else { 0.0 }
        });
        let mut class = Self {
            reach,
            low: core.map(|[low, _]| low),
            inverse,
            count,
            rows: Vec::new(),
        };
        let bands = Bands {
            bands: count[0],
            cells: count[1],
        };
        let pieces = pieces(data, bands, |x, _| {
            (class.cell(0, x[0]) * class.count[1] + class.cell(1, x[1])) as u32
        });
        class.rows = (0..count[0])
            .into_par_iter()
            .map(|row| cells(&pieces, bands, row))
            .collect();
        class
    }

    /// The cell of a coordinate: never decreasing in it, and within the mesh for any number.
    #[inline]
    fn cell(&self, axis: usize, x: f64) -> usize {
        // to an integer without overflow: NaN (0 × ∞) and what is below become 0
        (((x - self.low[axis]) * self.inverse[axis]) as usize).min(self.count[axis] - 1)
    }

    /// The cells within `reach` of `x` on an axis, first and last; rounding of the distance allowed for.
    #[inline]
    fn around(&self, axis: usize, x: f64, reach: f64) -> [usize; 2] {
        let more = reach + 4.0 * f64::EPSILON * (x.abs() + reach);
        [self.cell(axis, x - more), self.cell(axis, x + more)]
    }
}

struct Prepared {
    sum: KernelSum<2>,
    tolerance: f64,
    radius: f64,
    classes: Vec<Class>,
}

impl Prepared {
    fn value(&self, x: Point<2>) -> f64 {
        let sum = &self.sum;
        let product = sum.symmetry() == Symmetry::Product || sum.shape() == Shape::Gaussian;
        let h = match sum.bandwidth() {
            Bandwidth::Fixed(h) => *h,
            Bandwidth::PerTarget(field) => [field.at(x); 2],
            Bandwidth::PerPoint(_) => [1.0; 2],
        };
        let mut total = Sum::default();
        for class in &self.classes {
            let reach = match sum.bandwidth() {
                Bandwidth::PerTarget(_) => h.map(|h| self.radius * h),
                _ => class.reach,
            };
            let [top, bottom] = class.around(0, x[0], reach[0]);
            let [left, right] = class.around(1, x[1], reach[1]);
            for row in &class.rows[top..=bottom] {
                let mut data = row.range(left..right + 1);
                while !data.x.is_empty() {
                    let (now, later) = data.split_at(RUN);
                    total.add(run(sum.shape(), product, x, h, now));
                    data = later;
                }
            }
        }
        let weight = match sum.sample().weights() {
            Weights::Equal(weight) => *weight,
            Weights::Each(_) => 1.0,
        };
        total.value() * weight * scale(sum) / h[0] / h[1]
    }
}

fn run(shape: Shape, product: bool, x: Point<2>, h: [f64; 2], data: Slices<'_>) -> f64 {
    let arch = Arch::new();
    with_profile!(shape, profile => if product {
        arch.dispatch(Run::<_, true> { profile, x, h, data })
    } else {
        arch.dispatch(Run::<_, false> { profile, x, h, data })
    })
}

/// Σ of bare kernels over a run of data.
struct Run<'a, P, const PRODUCT: bool> {
    profile: P,
    x: Point<2>,
    h: [f64; 2],
    data: Slices<'a>,
}

impl<P: Profile, const PRODUCT: bool> WithSimd for Run<'_, P, PRODUCT> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let Self {
            profile,
            x: [x, y],
            h,
            data,
        } = self;
        let inverse = h.map(f64::recip);
        let term = |px: f64, py: f64| {
            // (x - X) / h as in the definition where the kernel jumps; a multiplication where that is as good
            let (u, v) = if P::JUMPS {
                ((x - px) / h[0], (y - py) / h[1])
            } else {
                ((x - px) * inverse[0], (y - py) * inverse[1])
            };
            if PRODUCT {
                profile.bare(u * u) * profile.bare(v * v)
            } else {
                profile.bare(u * u + v * v)
            }
        };
        let own = |px: f64, py: f64, h: f64| {
            let (u, v) = ((x - px) / h, (y - py) / h);
            let value = if PRODUCT {
                profile.bare(u * u) * profile.bare(v * v)
            } else {
                profile.bare(u * u + v * v)
            };
            value / h / h
        };
        let mut lanes = [0.0; LANES];
        let mut rest = 0.0;
        let (xs, x_rest) = data.x.as_chunks::<LANES>();
        let (ys, y_rest) = data.y.as_chunks::<LANES>();
        let done = LANES * xs.len();
        match (data.weight, data.width) {
            (None, None) => {
                for (xs, ys) in xs.iter().zip(ys) {
                    for l in 0..LANES {
                        lanes[l] += term(xs[l], ys[l]);
                    }
                }
                for (px, py) in x_rest.iter().zip(y_rest) {
                    rest += term(*px, *py);
                }
            }
            (Some(weights), None) => {
                let (ws, w_rest) = weights.as_chunks::<LANES>();
                for ((xs, ys), ws) in xs.iter().zip(ys).zip(ws) {
                    for l in 0..LANES {
                        lanes[l] += ws[l] * term(xs[l], ys[l]);
                    }
                }
                for ((px, py), w) in x_rest.iter().zip(y_rest).zip(w_rest) {
                    rest += w * term(*px, *py);
                }
            }
            (weights, Some(widths)) => {
                let (hs, h_rest) = widths.as_chunks::<LANES>();
                let weight = |i: usize| weights.map_or(1.0, |w| w[i]);
                for (k, ((xs, ys), hs)) in xs.iter().zip(ys).zip(hs).enumerate() {
                    for l in 0..LANES {
                        lanes[l] += weight(k * LANES + l) * own(xs[l], ys[l], hs[l]);
                    }
                }
                for (i, ((px, py), h)) in x_rest.iter().zip(y_rest).zip(h_rest).enumerate() {
                    rest += weight(done + i) * own(*px, *py, *h);
                }
            }
        }
        lanes.iter().sum::<f64>() + rest
    }
}

impl Field<2> for Prepared {
    fn domain(&self) -> &Domain<2> {
        self.sum.domain()
    }

    fn at(&self, x: Point<2>) -> f64 {
        self.value(x)
    }

    fn evaluate(&self, targets: Targets<'_, 2>) -> Evaluation {
        let places: Vec<Point<2>> = targets.places().collect();
        Evaluation {
            values: places
                .into_par_iter()
                .with_min_len(64)
                .map(|x| self.value(x))
                .collect(),
            error: error(&self.sum, self.tolerance),
            engine: Some("gather"),
            ..Evaluation::default()
        }
    }
}
