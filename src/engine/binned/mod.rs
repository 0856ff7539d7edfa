//! The Gaussian sum on a grid by linear binning and convolution.
//!
//! Each point shares its mass between the two nearest nodes of a grid that refines the output grid; the masses are then convolved with the
//! kernel at the nodes, directly at the outputs where these are few, by one real transform where they are many. The step δ of the nodes is
//! chosen from h and the tolerance, before any datum is read.
//!
//! # The error bound
//! Linear binning replaces the kernel by its interpolant, which for a smooth kernel is too high by f(1-f)/2 · δ²K″ where f is the place of
//! the datum between two nodes. The factor lies in [0, 1/8]; its middle is known beforehand, so the kernel is corrected by -δ²K″/16, which
//! halves the error for any data (and takes three quarters of it off smooth data, where the mean of f(1-f)/2 is 1/12). With Peano's form
//! of the remainder what is left is at most δ²/16 |K″| + 3δ³/16 sup|K‴|. Summed over the data with their weights, and with the constants
//! C(M, s) = 1.0865 √2 √(M!) exp(s/√8)/√(1 - s/√2) by which sums of derivatives are bounded by the **peak** of the estimate (the proof is
//! in `hermite/setting.rs`), this is, with ρ = δ/h,
//!
//! ```text
//! error ≤ (ρ²/16 C(2, 0) + 3ρ³/16 C(3, ρ)) · peak  ≈  0.136 (δ/h)² · peak
//! ```
//!
//! to which the kernel's cut at its reach R adds 2.3 exp(-R²/2), and a wrap round the end of the transform nothing: the nodes beyond
//! the outputs are as wide as the reach. Rounding adds what `bound` lists. For ρ > ½ the correction does more harm than good and is left
//! out; the bound is then ρ²/8 C(2, ρ), soon worthless, and says so.
//!
//! # References
//! Silverman 1982, Algorithm AS 176, Applied Statistics 31; Jones & Lotwick 1984, Applied Statistics 33; Wand 1994, JCGS 3.

mod convolve;

use super::direct::by_definition;
use super::{Engine, Quote, Unsupported, gaussian_width};
use crate::kernel::KernelSum;
use crate::numeric::special::normal_density;
use crate::sample::Weights;
use crate::space::binning::{Nodes, linear};
use crate::space::{Domain, Evaluation, Field, Grid, Point, Targets, Warning};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};
use std::num::NonZeroUsize;

/// The most nodes in one binning.
const MOST_NODES: f64 = (1 << 20) as f64;

/// Linear binning and convolution.
///
/// O(n + nodes log nodes) for the Gaussian kernel of fixed width on a uniform grid, weighted or not. At an error of 10⁻⁶ of the peak a point
/// costs about 2 ns, at 10⁻⁴ 1.3 ns; the nodes are 370 (37) per bandwidth. It cannot go below about 10⁻⁸ on ordinary grids.
#[derive(Clone, Copy, Debug, Default)]
pub struct Binned {
    refinement: Option<NonZeroUsize>,
}

impl Binned {
    const NAME: &'static str = "binned";

    /// As many nodes as the tolerance needs.
    pub const AUTOMATIC: Self = Self { refinement: None };

    /// Bins at `refinement` nodes per cell of the output grid, whatever the tolerance says. With 1 it does what common software does. Where
    /// the bound then exceeds the tolerance, the answer carries a warning.
    pub fn with_refinement(refinement: NonZeroUsize) -> Self {
        Self {
            refinement: Some(refinement),
        }
    }
}

impl Engine<1> for Binned {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn quote(
        &self,
        sum: &KernelSum<1>,
        targets: Targets<'_, 1>,
        tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        let Targets::Grid(grid) = targets else {
            return Err(Unsupported(
                "binned works on a uniform grid, not at scattered targets".to_owned(),
            ));
        };
        let [h] = gaussian_width(sum, Self::NAME)?;
        let layout = Layout::choose(grid, h, sum.sample().len(), tolerance, self.refinement)?;
        let weighted = matches!(sum.sample().weights(), Weights::Each(_));
        // points without weights measured on one thread (tables beyond the second-level cache cost more); the rest estimated
        let point =
            if weighted { 2.6 } else { 1.3 } + 0.8 * (layout.nodes.count as f64 / 1e5).min(3.0);
        let nanoseconds = 5_000.0
            + point * sum.sample().len() as f64
            + 12.0 * layout.nodes.count as f64
            + convolve::nanoseconds(layout.nodes.count, layout.margin, grid.len());
        Ok(Quote {
            error: layout.error,
            nanoseconds,
        })
    }

    fn prepare(&self, sum: KernelSum<1>, tolerance: f64) -> Result<Box<dyn Field<1>>, Unsupported> {
        let [bandwidth] = gaussian_width(&sum, Self::NAME)?;
        Ok(Box::new(Prepared {
            sum,
            bandwidth,
            tolerance,
            refinement: self.refinement,
        }))
    }
}

/// Where the nodes lie for one grid and bandwidth.
#[derive(Clone, Copy, Debug)]
struct Layout {
    nodes: Nodes,
    /// Nodes in one cell of the grid.
    refinement: usize,
    /// Nodes on either side of a target that the kernel reaches; the first target is this many nodes from the first node.
    margin: usize,
    /// δ / h.
    ratio: f64,
    /// The bound on the error relative to the peak, or to the ceiling where that is less.
    error: f64,
}

impl Layout {
    fn choose(
        grid: &Grid<1>,
        h: f64,
        points: usize,
        tolerance: f64,
        forced: Option<NonZeroUsize>,
    ) -> Result<Self, Unsupported> {
        let (width, cells) = (grid.width(0), grid.cells()[0]);
        let reach = (2.0 * (16.0 * 2.3 / tolerance.clamp(1e-12, 1e-2)).ln()).sqrt();
        // nodes = (cells - 1) q + 2 (reach h q / width + 1) + 1, at most the limit
        let most = ((MOST_NODES - 5.0) / ((cells - 1) as f64 + 2.0 * reach * h / width)).floor();
        let wanted = forced.map_or_else(
            || (width / (h * ratio_for(0.8 * tolerance))).ceil().max(1.0),
            |forced| forced.get() as f64,
        );
        let legal = most >= 1.0 && (forced.is_none() || wanted <= most);
        if !legal || !(width / h).is_normal() {
            return Err(Unsupported(format!(
                "binned needs more than 2²⁰ nodes to reach {reach:.1} bandwidths of {h} beyond a grid of cells of width {width}"
            )));
        }
        let refinement = wanted.min(most);
        let step = width / refinement;
        let margin = (reach * h / step).ceil() + 1.0;
        let first = grid.coordinate(0, 0);
        let nodes = Nodes {
            low: margin.mul_add(-step, first),
            step,
            count: ((cells - 1) as f64 * refinement + 2.0 * margin + 1.0) as usize,
        };
        let far = nodes
            .low
            .abs()
            .max((nodes.count as f64).mul_add(step, nodes.low).abs());
        Ok(Self {
            nodes,
            refinement: refinement as usize,
            margin: margin as usize,
            ratio: step / h,
            error: bound(step / h, reach, far / h, nodes.count, points).min(1.0),
        })
    }

    /// The corrected kernel at the nodes from 0 to `margin` steps away, times h.
    fn kernel(&self) -> Vec<f64> {
        let correction = if self.ratio <= 0.5 {
            self.ratio * self.ratio / 16.0
        } else {
            0.0
        };
        (0..=self.margin)
            .map(|i| {
                let u = i as f64 * self.ratio;
                normal_density(u) * (1.0 - correction * (u * u - 1.0))
            })
            .collect()
    }
}

/// C(M, s): sums of |K⁽ᴹ⁾| at places moved by up to s are at most this times the peak.
fn constant(order: i32, shift: f64) -> f64 {
    let factorial: f64 = (1..=order).map(f64::from).product();
    if shift < 1.4 {
        1.0865 * SQRT_2 * factorial.sqrt() * (shift / (2.0 * SQRT_2)).exp()
            / (1.0 - shift * FRAC_1_SQRT_2).sqrt()
    } else {
        f64::INFINITY
    }
}

fn interpolation(ratio: f64) -> f64 {
    if ratio <= 0.5 {
        ratio * ratio / 16.0 * constant(2, 0.0) + 3.0 * ratio.powi(3) / 16.0 * constant(3, ratio)
    } else {
        ratio * ratio / 8.0 * constant(2, ratio)
    }
}

/// The largest δ / h whose interpolation error is at most `tolerance`.
fn ratio_for(tolerance: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.4);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if interpolation(middle) <= tolerance {
            low = middle;
        } else {
            high = middle;
        }
    }
    low.max(1e-12)
}

fn bound(ratio: f64, reach: f64, far: f64, nodes: usize, points: usize) -> f64 {
    let unit = f64::EPSILON / 2.0;
    let slope = constant(1, 0.0);
    interpolation(ratio)
        + 2.3 * (-0.5 * reach * reach).exp()
        // places rounded to 2⁻²⁰ of a step, and as coordinates
        + slope * (ratio * 2f64.powi(-21) + 6.0 * unit * far)
        // sums of weights, at most a sixteenth of all points in a row
        + unit * (points as f64 / 16.0).max((points as f64).min(131_072.0))
        // transforms, whose error is relative to their largest value
        + 8.0 * unit * (nodes as f64).log2() * (1.0 + 1.0 / ratio).min(nodes as f64)
}

struct Prepared {
    sum: KernelSum<1>,
    bandwidth: f64,
    tolerance: f64,
    refinement: Option<NonZeroUsize>,
}

impl Prepared {
    fn on_grid(&self, grid: &Grid<1>, layout: &Layout) -> Evaluation {
        let sample = self.sum.sample();
        let (weights, scale) = match sample.weights() {
            Weights::Equal(weight) => (None, weight / self.bandwidth),
            Weights::Each(weights) => (Some(&**weights), self.bandwidth.recip()),
        };
        let mass = linear(sample.coordinates(), weights, layout.nodes);
        let mut values = convolve::convolve(&mass, &layout.kernel(), layout.refinement, grid.len());
        for value in &mut values {
            // a transform may leave a rounding error below zero
            *value = value.max(0.0) * scale;
        }
        let mut warnings = Vec::new();
        if layout.error > self.tolerance {
            warnings.push(Warning {
                what: format!(
                    "The binning grid is too coarse for the bandwidth: at {:.3} bandwidths a step the error may reach {:.1e} of the peak, and {:.1e} was asked",
                    layout.ratio, layout.error, self.tolerance
                ),
                hint: format!(
                    "Leave the engine to the planner, or bin at {} nodes per bandwidth or more",
                    ratio_for(0.8 * self.tolerance).recip().ceil()
                ),
            });
        }
        Evaluation {
            values,
            error: layout.error,
            engine: Some(Binned::NAME),
            warnings,
            ..Evaluation::default()
        }
    }
}

impl Field<1> for Prepared {
    fn domain(&self) -> &Domain<1> {
        self.sum.domain()
    }

    /// By definition: a single place gains nothing from binning.
    fn at(&self, x: Point<1>) -> f64 {
        self.sum.at(x)
    }

    /// Binned on a grid; by definition elsewhere.
    fn evaluate(&self, targets: Targets<'_, 1>) -> Evaluation {
        if let Targets::Grid(grid) = targets {
            let points = self.sum.sample().len();
            if let Ok(layout) = Layout::choose(
                grid,
                self.bandwidth,
                points,
                self.tolerance,
                self.refinement,
            ) {
                return self.on_grid(grid, &layout);
            }
        }
        by_definition(&self.sum, targets, "direct")
    }
}

#[cfg(test)]
mod tests;
