//! Scatter: each datum adds its bump to the cells of the grid that it reaches.
//!
//! The same numbers as gathering at each target, added in another order \[Silverman 1986, eq. 4.1 read from the data's side\]: O(n · footprint + m). The rows of a footprint are whole vector
//! registers; for a product kernel a row is a multiple of one and the same row, for a radial one it is a function of u² + v² with the v² computed once for all rows. Cells beyond the end of the support
//! receive the zero that the kernel has there, so there is no branch in a row. Whether a cell is inside is decided by the same operations in the same order as in the definition.
//!
//! **Threads.** The rows of the grid are cut into bands; a band is summed by one task. Where footprints are low, it visits its own data and keeps the sums of the rows just beyond its ends, which are added
//! to its neighbours' in the end; where they are high, it visits the data of its neighbours too. So nothing is shared, and the bits do not depend on the number of threads.
//!
//! **Rounding.** Every [`RUN`] data the sums of a band are closed and added, compensated, to its totals: no chain of additions is longer, however many data fall on one place.

mod narrow;
mod visit;

use super::super::{Engine, Quote, Unsupported};
use super::pieces::{Bands, Data, NOWHERE, Piece, RUSH, pieces};
use super::profile::{reach, scale};
use super::{by_definition, look};
use crate::kernel::{Bandwidth, KernelSum, Shape, Symmetry};
use crate::sample::Weights;
use crate::space::{Domain, Evaluation, Field, Grid, Point, Targets};
use rayon::prelude::*;
use std::ops::Range;
use visit::{Frame, LANES, visit};

/// Data between two closings.
const RUN: usize = 4096;

/// Scatter onto a grid: any kernel, product or radial, one width for all or one for each point. The Gaussian is cut where it falls below half of the tolerance.
#[derive(Clone, Copy, Debug, Default)]
pub struct Splat;

impl Engine<2> for Splat {
    fn name(&self) -> &'static str {
        "splat"
    }

    fn quote(
        &self,
        sum: &KernelSum<2>,
        targets: Targets<'_, 2>,
        tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        let Targets::Grid(grid) = targets else {
            return Err(Unsupported(
                "the targets are scattered: splatting needs a grid".to_owned(),
            ));
        };
        let layout = Layout::new(sum, grid, tolerance)?;
        let n = sum.sample().len() as f64;
        // measured on one thread of a busy machine: 55 ns to order and begin a datum, 12 ns for each further band, 4 ns a row and 0.6 ns a cell; twice that a row where each must find its ends;
        // 45 ns for all of a datum whose footprint fits into the lanes
        let [rows, columns] = [0, 1].map(|axis| {
            let reach = layout.typical_reach[axis];
            (2.0 * reach + 1.0).min(grid.cells()[axis] as f64)
        });
        let round = sum.symmetry() == Symmetry::Radial || sum.shape() == Shape::Gaussian;
        let row = match sum.shape() {
            Shape::Triangular | Shape::Cosine if sum.symmetry() == Symmetry::Radial => 3.5,
            _ if round && columns > 24.0 => 2.5,
            _ => 1.0,
        };
        let further = if layout.margin > 0 {
            0.0
        } else {
            (2.0 * layout.typical_reach[0] / layout.rows as f64).min(16.0)
        };
        let share = look::share(sum.sample(), grid, layout.typical_reach);
        let square = sum.fixed().is_some() && rows.max(columns) < (LANES + 1) as f64;
        let datum = if square {
            10.0 + share * 35.0 * row
        } else {
            10.0 + share * (45.0 + 12.0 * further + row * rows * (4.0 + 0.6 * (columns + 4.0)))
        };
        Ok(Quote {
            error: layout.error(sum),
            nanoseconds: 10_000.0 + datum * n + 6.0 * grid.len() as f64,
        })
    }

    fn prepare(&self, sum: KernelSum<2>, tolerance: f64) -> Result<Box<dyn Field<2>>, Unsupported> {
        widths(&sum)?;
        Ok(Box::new(Prepared { sum, tolerance }))
    }
}

/// The widths of the points, where they differ.
fn widths(sum: &KernelSum<2>) -> Result<Option<&[f64]>, Unsupported> {
    match sum.bandwidth() {
        Bandwidth::Fixed(_) => Ok(None),
        Bandwidth::PerPoint(widths) => Ok(Some(widths)),
        Bandwidth::PerTarget(_) => Err(Unsupported(
            "the bandwidth belongs to the targets: there is nothing to scatter".to_owned(),
        )),
    }
}

/// How the grid is cut for one sum.
struct Layout<'a> {
    grid: &'a Grid<2>,
    /// Kernel's end in units of h.
    radius: f64,
    /// 0 for compact kernels, else what cutting leaves out.
    cut: f64,
    /// The widest reach on each axis, in cells, rounding allowed for.
    reach: [f64; 2],
    /// The reach to base a guess of the cost on.
    typical_reach: [f64; 2],
    /// What rounding may move a datum against the grid, in cells.
    slop: [f64; 2],
    /// Rows of a band.
    rows: usize,
    /// Rows beyond each end of a band whose sums it keeps; 0 if it visits the neighbours' data instead.
    margin: usize,
}

/// The cells of a band that stay in the cache nearest to the processor.
const CACHED: usize = 1 << 13;

impl<'a> Layout<'a> {
    fn new(sum: &KernelSum<2>, grid: &'a Grid<2>, tolerance: f64) -> Result<Self, Unsupported> {
        let cut = 0.5 * tolerance.clamp(1e-15, 0.5);
        let radius = reach(sum.shape(), cut);
        let [widest, typical] = match (sum.bandwidth(), widths(sum)?) {
            (Bandwidth::Fixed(h), _) => [*h; 2],
            (_, Some(widths)) => {
                let widest = widths.iter().copied().fold(0.0, f64::max);
                let every = widths.len().div_ceil(64);
                let seen = widths.iter().step_by(every);
                let mean = seen.clone().sum::<f64>() / seen.count() as f64;
                [[widest; 2], [mean; 2]]
            }
            _ => unreachable!("refused above"),
        };
        let cells = |h: [f64; 2]| [0, 1].map(|axis| radius * h[axis] / grid.width(axis));
        let reach = cells(widest);
        let slop = [0, 1].map(|axis| {
            let width = grid.width(axis);
            let span = grid.low()[axis].abs().max(grid.high()[axis].abs()) / width;
            // each of some ten roundings may move a datum against the grid by half an epsilon
            8.0 * f64::EPSILON * (span + grid.cells()[axis] as f64 + reach[axis])
        });
        // not < : NaN and infinity are refused too
        if !slop.iter().all(|slop| *slop < 0.25) {
            return Err(Unsupported(
                "the cells are so thin beside h or beside their place that rounding could move data across them".to_owned(),
            ));
        }
        let [lines, columns] = grid.cells();
        // two more: the band of a datum near an edge may be off by rounding
        let margin = (reach[0] as usize).min(lines) + 2;
        let (rows, margin) = if 8 * margin <= lines {
            // some eight bands at least, and margins that are not most of the work
            let cached = (CACHED / columns).saturating_sub(2 * margin);
            // where no band fits, margins should at least be little beside it
            let cached = if cached < 2 * margin {
                16 * margin
            } else {
                cached
            };
            (cached.min(lines.div_ceil(8)).max(2 * margin), margin)
        } else {
            // as high as a footprint if that leaves some eight bands; never lower than eight rows
            let rows = (reach[0].ceil() as usize).clamp(lines.div_ceil(32), lines.div_ceil(8));
            (rows.max(8), 0)
        };
        Ok(Self {
            grid,
            radius,
            cut: if radius > 1.0 { cut } else { 0.0 },
            reach: [0, 1].map(|axis| reach[axis] + slop[axis]),
            typical_reach: cells(typical),
            slop,
            rows,
            margin,
        })
    }

    /// Relative to the ceiling: the longest chain of additions, some ten roundings of each term, what is cut.
    fn error(&self, sum: &KernelSum<2>) -> f64 {
        let chain = sum.sample().len().min(RUN) as f64;
        0.5 * f64::EPSILON * (chain + 28.0) + self.cut
    }

    fn bands(&self) -> usize {
        self.grid.cells()[0].div_ceil(self.rows)
    }

    fn locator(&self) -> Locator {
        let last = self.grid.cells().map(|cells| (cells - 1) as f64);
        Locator {
            first: [0, 1].map(|axis| self.grid.coordinate(axis, 0)),
            inverse: [0, 1].map(|axis| self.grid.width(axis).recip()),
            radius: self.radius,
            slop: self.slop,
            last,
            reach: self.reach,
            rows: (self.rows as f64).recip(),
            bands: self.bands() as f64 - 1.0,
        }
    }
}

/// What tells the band of a datum.
struct Locator {
    first: [f64; 2],
    inverse: [f64; 2],
    radius: f64,
    slop: [f64; 2],
    last: [f64; 2],
    reach: [f64; 2],
    rows: f64,
    bands: f64,
}

impl Locator {
    /// The band that holds `x`, or the nearest; nowhere if it reaches no cell. A width of 0 stands for the common one.
    #[inline]
    fn key(&self, x: Point<2>, width: f64) -> u32 {
        let mut near = true;
        let mut row = 0.0;
        for axis in 0..2 {
            let t = (x[axis] - self.first[axis]) * self.inverse[axis];
            let reach = if width > 0.0 {
                self.radius * width * self.inverse[axis] + self.slop[axis]
            } else {
                self.reach[axis]
            };
            near &= t + reach >= 0.0 && t - reach <= self.last[axis];
            if axis == 0 {
                row = t;
            }
        }
        if !near {
            return NOWHERE;
        }
        // the nearest band by rounding is never two off, and the bands around are visited one wider than the reach
        (row * self.rows).clamp(0.0, self.bands) as u32
    }
}

/// The rows of one band, its margins included, and what was added to them.
struct Band {
    rows: Range<usize>,
    /// The sums of the current run, and some rows beyond them that mean nothing.
    open: Vec<f64>,
    /// The sums of the closed runs and what rounding took from them; empty before the first closing.
    closed: Vec<[f64; 2]>,
    since: usize,
}

impl Band {
    fn new(rows: Range<usize>, stride: usize) -> Self {
        Self {
            open: vec![0.0; (rows.len() + LANES) * stride],
            rows,
            closed: Vec::new(),
            since: 0,
        }
    }

    fn close(&mut self) {
        self.closed.resize(self.open.len(), [0.0; 2]);
        for ([total, lost], open) in self.closed.iter_mut().zip(&mut self.open) {
            // Knuth's sum of two: exact whichever is larger, and without a branch
            let next = *total + *open;
            let added = next - *total;
            *lost += (*total - (next - added)) + (*open - added);
            *total = next;
            *open = 0.0;
        }
        self.since = 0;
    }

    /// Adds what it has of row `i` to `values`.
    fn give(&self, i: usize, stride: usize, values: &mut [f64]) {
        if !self.rows.contains(&i) {
            return;
        }
        let start = (i - self.rows.start) * stride;
        if self.closed.is_empty() {
            for (value, open) in values.iter_mut().zip(&self.open[start..]) {
                *value += open;
            }
        } else {
            for (value, [total, lost]) in values.iter_mut().zip(&self.closed[start..]) {
                *value += total + lost;
            }
        }
    }
}

fn on_grid(sum: &KernelSum<2>, layout: &Layout<'_>) -> Vec<f64> {
    let Layout {
        grid, rows, margin, ..
    } = *layout;
    let [lines, columns] = grid.cells();
    let frame = Frame::new(sum, grid, layout.radius, layout.slop);
    let mut bands: Vec<Band> = (0..layout.bands())
        .map(|b| {
            let range = (b * rows).saturating_sub(margin)..((b + 1) * rows + margin).min(lines);
            Band::new(range, frame.stride)
        })
        .collect();
    let cut = Bands {
        bands: bands.len(),
        cells: 1,
    };
    let around = if margin > 0 {
        0
    } else {
        // one more: the band of a datum near an edge may be off by rounding
        ((layout.reach[0] / rows as f64).floor() as usize + 1).min(bands.len())
    };
    let locator = layout.locator();
    let widths = widths(sum).unwrap_or_default();
    for rush in Data::of(sum.sample(), widths).chunks(RUSH / 4) {
        let pieces: Vec<Piece> = pieces(rush, cut, |x, width| locator.key(x, width));
        bands.par_iter_mut().enumerate().for_each(|(b, band)| {
            let near = b.saturating_sub(around)..(b + around + 1).min(cut.bands);
            for piece in &pieces {
                let mut data = piece.bands(near.clone());
                while !data.x.is_empty() {
                    let (now, later) = data.split_at(RUN - band.since);
                    visit(sum, &frame, now, band.rows.clone(), &mut band.open);
                    band.since += now.x.len();
                    if band.since == RUN {
                        band.close();
                    }
                    data = later;
                }
            }
        });
    }
    bands.par_iter_mut().for_each(|band| {
        if !band.closed.is_empty() {
            band.close();
        }
    });
    let mut values = vec![0.0; grid.len()];
    let scale = factor(sum);
    values
        .par_chunks_mut(columns)
        .enumerate()
        .for_each(|(i, values)| {
            // margins are lower than bands: only the neighbours have some of a row
            let b = i / rows;
            for band in &bands[b.saturating_sub(1)..(b + 2).min(bands.len())] {
                band.give(i, frame.stride, values);
            }
            for value in values {
                *value = scale.iter().fold(*value, |value, s| value * s);
            }
        });
    values
}

/// What turns sums of bare kernels into densities; several factors, each of which is an ordinary number where their product may not be.
fn factor(sum: &KernelSum<2>) -> [f64; 3] {
    let weight = match sum.sample().weights() {
        Weights::Equal(weight) => *weight,
        Weights::Each(_) => 1.0,
    };
    let [h0, h1] = sum.fixed().unwrap_or([1.0; 2]);
    [weight * scale(sum), h0.recip(), h1.recip()]
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
            return by_definition(&self.sum, targets, "splat");
        };
        match Layout::new(&self.sum, grid, self.tolerance) {
            Ok(layout) => Evaluation {
                values: on_grid(&self.sum, &layout),
                error: layout.error(&self.sum),
                engine: Some("splat"),
                ..Evaluation::default()
            },
            Err(_) => by_definition(&self.sum, targets, "splat"),
        }
    }
}
