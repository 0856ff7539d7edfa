//! The Gaussian sum on a grid by cell moments and Hermite functions: as exact as asked, at the price of a histogram with many columns and two sweeps.
//!
//! The plane is cut into cells about the grid points, or into an odd number of parts of these so that cells are small against h. With u the place of a target and s that of a datum, both seen from the centre of
//! the datum's cell in units of h, φ(u - s) = φ(u) Σ Heₙ(u) sⁿ/n! on each axis, so that a cell's Σ w s₀ᵃ s₁ᵇ / (a! b!) with a + b < M are all that a target needs to know. One pass over the data, put in the order of the
//! cells, adds these moments. The sum over the cells then separates: along the first axis for each (a, b), summed over a; along the second for each b.
//!
//! # The error
//! Cutting the series leaves of one datum the Taylor remainder of order M along the line from the cell's centre to it, |s|ᴹ/M! times a directional derivative of φφ, which by Cramér's bound
//! \[Abramowitz & Stegun 1964, 22.14.17\] is at most 1.0865 √(M!) times the peak: 1.0865 |s|ᴹ/√(M!) in all, |s|² ≤ r₀² + r₁² with the half widths r of a cell. Cells
//! farther than R on an axis are left out: at most exp(-(R - r)²/2) of the peak for each axis. Moments are added in runs of a few hundred data.
//!
//! # References
//! Greengard & Strain 1991, The fast Gauss transform, SIAM J. Sci. Stat. Comput. 12 (here on the cells of a grid, so that the translations become convolutions).

mod moments;
mod sweeps;

use super::super::{Engine, Quote, Unsupported, gaussian_width};
use super::pieces::RUSH;
use super::{by_definition, look};
use crate::kernel::{KernelSum, Shape};
use crate::numeric::special::normal_density_derivative;
use crate::sample::Weights;
use crate::space::{Domain, Evaluation, Field, Grid, Point, Targets};
use moments::{RUN, collect};
use pulp::Arch;
use rayon::prelude::*;
use sweeps::{Across, Down, LANES};

/// The most numbers in the tables of moments.
const MOST_MOMENTS: usize = 1 << 26;

/// The most cells that a target looks at on one axis: beyond that other ways are faster.
const MOST_TAPS: usize = 1 << 12;

/// Cell moments and Hermite functions: Gaussian of one width on a grid, to any tolerance down to about 10⁻¹² of the ceiling. O(n + m h / cell).
#[derive(Clone, Copy, Debug, Default)]
pub struct HermiteGrid;

/// How the plane is cut for one sum.
#[derive(Clone, Copy, Debug)]
struct Layout {
    h: [f64; 2],
    /// M, a multiple of 4: moments with a + b < M.
    order: usize,
    /// Cells per cell of the grid, odd.
    parts: [usize; 2],
    /// Cells on either side of a target that count.
    taps: [usize; 2],
    /// All cells on each axis.
    cells: [usize; 2],
    error: f64,
    nanoseconds: f64,
}

impl Layout {
    fn choose(sum: &KernelSum<2>, grid: &Grid<2>, tolerance: f64) -> Result<Self, Unsupported> {
        let h = gaussian_width(sum, "hermite")?;
        for axis in 0..2 {
            let span = grid.low()[axis].abs().max(grid.high()[axis].abs());
            // the rounding of a grid point, seen in units of h, moves all its values
            if !(4.0 * f64::EPSILON * span / grid.width(axis) < 0.1
                && h[axis] / grid.width(axis) < 1e6)
            {
                return Err(Unsupported(
                    "the cells are too thin beside h or beside their place".to_owned(),
                ));
            }
        }
        let candidates = [4, 8, 12, 16].into_iter().flat_map(|order| {
            [0.2, 0.35, 0.5, 0.7, 1.0].map(|wide| Self::with(sum, grid, h, tolerance, order, wide))
        });
        let mut best: Option<Self> = None;
        for layout in candidates.flatten() {
            let better = best.is_none_or(|best| {
                let met = |layout: &Self| layout.error <= tolerance;
                match (met(&layout), met(&best)) {
                    (true, true) => layout.nanoseconds < best.nanoseconds,
                    (false, false) => layout.error < best.error,
                    (met, _) => met,
                }
            });
            if better {
                best = Some(layout);
            }
        }
        best.ok_or_else(|| {
            Unsupported(format!(
                "the cells of moments would be more than its tables may hold ({MOST_MOMENTS} numbers)"
            ))
        })
    }

    /// With cells of at most `wide` h; `None` if the tables would be too large.
    fn with(
        sum: &KernelSum<2>,
        grid: &Grid<2>,
        h: [f64; 2],
        tolerance: f64,
        order: usize,
        wide: f64,
    ) -> Option<Self> {
        let width = [0, 1].map(|axis| grid.width(axis) / h[axis]);
        let parts = width.map(|width| ((width / wide).min(1e6).ceil() as usize).max(1) | 1);
        let part = [0, 1].map(|axis| width[axis] / parts[axis] as f64);
        let far = (-2.0 * (0.1 * tolerance.clamp(1e-15, 0.5)).ln()).sqrt();
        let taps = part.map(|part| (far / part + 0.5).ceil() as usize);
        let cells = [0, 1].map(|axis| (grid.cells()[axis] - 1) * parts[axis] + 1 + 2 * taps[axis]);
        let planes = order * (order + 1) / 2;
        let total = cells[0].checked_mul(cells[1])?;
        if total.checked_mul(planes)? > MOST_MOMENTS || taps.iter().any(|taps| *taps > MOST_TAPS) {
            return None;
        }
        let place = 0.5 * (part[0].powi(2) + part[1].powi(2)).sqrt();
        let remainder = (1..=order).fold(1.0865, |term, m| term * place / (m as f64).sqrt());
        let left_out = 2.0 * (-0.5 * far * far).exp();
        let n = sum.sample().len();
        let chain = (n.min(RUN) / 4 + n.min(RUSH) / RUN + n / RUSH + 64) as f64;
        let growth = (1.5 * place).exp();
        // the rounding of a grid point and its cell's centre, to which the slope of the Gaussian is at most 0.6 of its peak
        let rounding = (0..2).fold(0.0, |total, axis| {
            let span = grid.low()[axis].abs().max(grid.high()[axis].abs());
            total + 2.0 * f64::EPSILON * span / h[axis]
        });
        let share = look::share(
            sum.sample(),
            grid,
            [0, 1].map(|axis| (taps[axis] / parts[axis]) as f64),
        );
        let [lines, columns] = grid.cells().map(|cells| cells as f64);
        // measured on one thread of a busy machine: 50 ns to order a datum, 0.8 ns a moment; 0.15 ns a product of the convolutions
        let nanoseconds = 50_000.0
            + n as f64 * (10.0 + share * (45.0 + 0.8 * planes as f64))
            + 0.15
                * lines
                * (cells[1] as f64 * (2 * taps[0] + 1) as f64 * planes as f64
                    + columns * (2 * taps[1] + 1) as f64 * order as f64)
            + 2.0 * (total * planes) as f64;
        Some(Self {
            h,
            order,
            parts,
            taps,
            cells,
            error: remainder + left_out + rounding + 0.5 * f64::EPSILON * growth * chain,
            nanoseconds,
        })
    }

    /// The first cell's centre and the distance of cells on an axis.
    fn lattice(&self, grid: &Grid<2>, axis: usize) -> (f64, f64) {
        let width = grid.width(axis) / self.parts[axis] as f64;
        (
            grid.coordinate(axis, 0) - self.taps[axis] as f64 * width,
            width,
        )
    }
}

impl Engine<2> for HermiteGrid {
    fn name(&self) -> &'static str {
        "hermite"
    }

    fn quote(
        &self,
        sum: &KernelSum<2>,
        targets: Targets<'_, 2>,
        tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        let Targets::Grid(grid) = targets else {
            return Err(Unsupported(
                "the targets are scattered: cells of moments need a grid".to_owned(),
            ));
        };
        let layout = Layout::choose(sum, grid, tolerance)?;
        Ok(Quote {
            error: layout.error,
            nanoseconds: layout.nanoseconds,
        })
    }

    fn prepare(&self, sum: KernelSum<2>, tolerance: f64) -> Result<Box<dyn Field<2>>, Unsupported> {
        if sum.shape() != Shape::Gaussian || sum.fixed().is_none() {
            return Err(Unsupported(
                "hermite needs the Gaussian kernel and one bandwidth".to_owned(),
            ));
        }
        Ok(Box::new(Prepared { sum, tolerance }))
    }
}

struct Prepared {
    sum: KernelSum<2>,
    tolerance: f64,
}

impl Field<2> for Prepared {
    fn domain(&self) -> &Domain<2> {
        self.sum.domain()
    }

    fn at(&self, x: Point<2>) -> f64 {
        self.sum.at(x)
    }

    fn evaluate(&self, targets: Targets<'_, 2>) -> Evaluation {
        let Targets::Grid(grid) = targets else {
            return by_definition(&self.sum, targets, "hermite");
        };
        let Ok(layout) = Layout::choose(&self.sum, grid, self.tolerance) else {
            return by_definition(&self.sum, targets, "hermite");
        };
        let values = match layout.order {
            4 => compute::<4>(&self.sum, grid, &layout),
            8 => compute::<8>(&self.sum, grid, &layout),
            12 => compute::<12>(&self.sum, grid, &layout),
            _ => compute::<16>(&self.sum, grid, &layout),
        };
        Evaluation {
            values,
            error: layout.error,
            engine: Some("hermite"),
            ..Evaluation::default()
        }
    }
}

fn compute<const M: usize>(sum: &KernelSum<2>, grid: &Grid<2>, layout: &Layout) -> Vec<f64> {
    let rows = collect::<M>(sum, grid, layout);
    let [lines, columns] = grid.cells();
    let weight = match sum.sample().weights() {
        Weights::Equal(weight) => *weight,
        Weights::Each(_) => 1.0,
    };
    let [down, across] = [0, 1].map(|axis| kernel::<M>(layout, grid, axis));
    // a few columns of cells at a time, so that what is read again and again stays in the first caches
    let blocks: Vec<Vec<[f64; LANES]>> = (0..layout.cells[1].div_ceil(LANES))
        .into_par_iter()
        .map(|block| {
            Arch::new().dispatch(Down {
                rows: &rows,
                start: block * LANES,
                taps: &down,
                layout,
                lines,
            })
        })
        .collect();
    drop(rows);
    let mut values = vec![0.0; lines * columns];
    values
        .par_chunks_mut(columns)
        .enumerate()
        .for_each(|(line, row)| {
            Arch::new().dispatch(Across {
                blocks: &blocks,
                line,
                lines,
                taps: &across,
                layout,
                row,
            });
            for value in row {
                // an expansion of next to nothing may end a rounding error below zero
                *value = value.max(0.0) * weight / layout.h[0] / layout.h[1];
            }
        });
    values
}

/// Heₙ(u) φ(u) / n! with u from each of the cells around a target to the target, in units of h: `[tap][n]`.
fn kernel<const M: usize>(layout: &Layout, grid: &Grid<2>, axis: usize) -> Vec<[f64; M]> {
    let step = grid.width(axis) / layout.parts[axis] as f64 / layout.h[axis];
    let taps = layout.taps[axis] as f64;
    (0..=2 * layout.taps[axis])
        .map(|k| {
            let u = (taps - k as f64) * step;
            let mut factorial = 1.0;
            std::array::from_fn(|n| {
                factorial *= (n as f64).max(1.0);
                // φ⁽ⁿ⁾ = (-1)ⁿ Heₙ φ
                let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
                sign * normal_density_derivative(n as u32, u) / factorial
            })
        })
        .collect()
}
