//! The Gaussian sum by cell moments and Hermite expansions: exact, at the price of a few histograms.
//!
//! The line is cut into cells a fraction of h wide. One pass over the data gives each cell its first moments; since
//! φ(u - s) = φ(u) Σ Heₙ(u) sⁿ/n!, these moments are all that a target needs to know of the points in the cell. Moments of fine cells are
//! translated to coarser ones (16 terms, 0.35 to 0.7 h wide) and summed over the two or three dozen cells within reach of a target; where
//! targets are many, the surroundings of a cell are first expanded about its centre, and a target then costs one polynomial.
//!
//! Everything is known before the first datum is read: the setting follows from h, n and the tolerance by the bound proved in `setting.rs`. Data
//! far from zero cost no digits (cells are centred at multiples of a power of two, and positions in cells are exact), and outliers
//! cost no memory: cells exist only within reach of targets, and where even these would be too many, only occupied cells.
//!
//! # References
//! Greengard & Strain 1991, The fast Gauss transform, SIAM J. Sci. Stat. Comput. 12; Baxter & Roussos 2002, A new error estimate of the fast
//! Gauss transform, SIAM J. Sci. Comput. 24 (whose correction of the bound is the reason for a proof of our own).

mod expansion;
mod scattered;
mod setting;

pub(super) use setting::{ROUNDING, power_of_two_below, remainder, rounding_of_sums};

use super::{Engine, Quote, Unsupported, gaussian_width};
use crate::kernel::KernelSum;
use crate::sample::Weights;
use crate::space::{Domain, Evaluation, Field, Point, Targets};
use expansion::Row;
use rayon::prelude::*;
use scattered::Scattered;
use setting::Setting;
use std::sync::OnceLock;

/// Fine cells that a row may have: its tables then take at most 32 MiB.
const MOST_CELLS: f64 = (1 << 16) as f64;

/// Cell moments and Hermite expansions.
///
/// O(n + m) for the Gaussian kernel of fixed width on a line, weighted or not, at any targets; error at most the tolerance, down to about
/// 10⁻¹² of the peak. In a prototype of the inner loop, on one thread, a point cost 1.8 ns at 10⁻⁶ and 2.7 ns at 10⁻¹⁰ and 10⁻¹² (a histogram: 1 ns). When the targets span
/// more than 65 536 fine cells (thousands of h) occupied cells are sorted instead, O(n log n + m log n).
#[derive(Clone, Copy, Debug, Default)]
pub struct Hermite;

impl Hermite {
    const NAME: &'static str = "hermite";

    fn setting(sum: &KernelSum<1>, tolerance: f64) -> Result<Setting, Unsupported> {
        let [h] = gaussian_width(sum, Self::NAME)?;
        Setting::choose(h, sum.sample().len(), tolerance).ok_or_else(|| {
            Unsupported(format!(
                "hermite needs a bandwidth between 1e-290 and 1e290, not {h}"
            ))
        })
    }
}

impl Engine<1> for Hermite {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn quote(
        &self,
        sum: &KernelSum<1>,
        targets: Targets<'_, 1>,
        tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        let setting = Self::setting(sum, tolerance)?;
        let (low, high) = span(targets);
        let cells = Row::fine_cells(&setting, low, high);
        if cells.is_infinite() {
            return Err(Unsupported(format!(
                "hermite cannot tell places near {high:e} apart at the bandwidth {}",
                setting.bandwidth
            )));
        }
        let (n, m) = (sum.sample().len() as f64, targets.len() as f64);
        let weighted = matches!(sum.sample().weights(), Weights::Each(_));
        // the cost of a point without weights was measured on one thread; the other constants are counts of operations, still to be measured
        let nanoseconds = if cells > MOST_CELLS {
            n * (20.0 + 8.0 * n.log2()) + m * 600.0
        } else {
            let point = match (setting.moments, weighted) {
                (4, false) => 1.9,
                (4, true) | (_, false) => 2.8,
                (_, true) => 4.5,
            };
            let coarse = cells / setting.ratio as f64;
            10_000.0 + point * n + 40.0 * cells + (150.0 * m).min(1000.0 * coarse + 6.0 * m)
        };
        Ok(Quote {
            error: setting.error,
            nanoseconds,
        })
    }

    fn prepare(&self, sum: KernelSum<1>, tolerance: f64) -> Result<Box<dyn Field<1>>, Unsupported> {
        let setting = Self::setting(&sum, tolerance)?;
        Ok(Box::new(Prepared {
            sum,
            setting,
            whole: OnceLock::new(),
        }))
    }
}

/// The least and the largest target.
fn span(targets: Targets<'_, 1>) -> (f64, f64) {
    match targets {
        Targets::Grid(grid) => (
            grid.coordinate(0, 0),
            grid.coordinate(0, grid.cells()[0] - 1),
        ),
        Targets::Points(points) => range(points.as_flattened()),
    }
}

fn range(places: &[f64]) -> (f64, f64) {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    places
        .iter()
        .fold(start, |(low, high), &x| (low.min(x), high.max(x)))
}

enum Cells {
    Row(Row),
    Scattered(Scattered),
}

struct Prepared {
    sum: KernelSum<1>,
    setting: Setting,
    /// Cells that serve single targets anywhere among the data, with the range of the data.
    whole: OnceLock<(f64, f64, Option<Cells>)>,
}

impl Prepared {
    fn weights(&self) -> Option<&[f64]> {
        match self.sum.sample().weights() {
            Weights::Equal(_) => None,
            Weights::Each(weights) => Some(weights),
        }
    }

    /// What turns sums of φ into the estimate.
    fn scale(&self) -> f64 {
        match self.sum.sample().weights() {
            Weights::Equal(weight) => weight / self.setting.bandwidth,
            Weights::Each(_) => self.setting.bandwidth.recip(),
        }
    }

    /// Cells for targets between `low` and `high`; `None` where numbers are too coarse for cells.
    fn cells(&self, low: f64, high: f64) -> Option<Cells> {
        let points = self.sum.sample().coordinates();
        let count = Row::fine_cells(&self.setting, low, high);
        if count <= MOST_CELLS {
            Some(Cells::Row(Row::collect(
                &self.setting,
                points,
                self.weights(),
                low,
                high,
            )))
        } else if count.is_finite() {
            Some(Cells::Scattered(Scattered::collect(
                &self.setting,
                points,
                self.weights(),
                low,
                high,
            )))
        } else {
            None
        }
    }

    fn values(&self, cells: &Cells, targets: &[f64]) -> Vec<f64> {
        let mut values = match cells {
            Cells::Row(row) => row.evaluate(targets),
            Cells::Scattered(cells) => targets.par_iter().map(|&x| cells.at(x)).collect(),
        };
        let scale = self.scale();
        for value in &mut values {
            // an expansion of next to nothing may end a rounding error below zero
            *value = value.max(0.0) * scale;
        }
        values
    }
}

impl Field<1> for Prepared {
    fn domain(&self) -> &Domain<1> {
        self.sum.domain()
    }

    fn at(&self, x: Point<1>) -> f64 {
        let (low, high, cells) = self.whole.get_or_init(|| {
            let reach = self.setting.reach * self.setting.bandwidth;
            let (least, most) = range(self.sum.sample().coordinates());
            let (low, high) = (least - reach, most + reach);
            (low, high, self.cells(low, high))
        });
        match cells {
            Some(cells) if (*low..=*high).contains(&x[0]) => self.values(cells, &x)[0],
            Some(_) if !x[0].is_nan() => 0.0,
            _ => self.sum.at(x),
        }
    }

    fn evaluate(&self, targets: Targets<'_, 1>) -> Evaluation {
        let places: Vec<f64> = targets.places().map(|[x]| x).collect();
        let (low, high) = range(&places);
        let legal = !places.is_empty() && places.iter().all(|x| x.is_finite());
        let values = match legal.then(|| self.cells(low, high)).flatten() {
            Some(cells) => self.values(&cells, &places),
            None => places.par_iter().map(|&x| self.sum.at([x])).collect(),
        };
        Evaluation {
            values,
            error: self.setting.error,
            engine: Some(Hermite::NAME),
            ..Evaluation::default()
        }
    }
}

#[cfg(test)]
mod tests;
