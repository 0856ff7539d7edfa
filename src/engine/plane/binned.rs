//! The Gaussian sum on a grid by linear binning and a separable convolution.
//!
//! Each datum shares its weight among the four nearest nodes of a grid that refines the output grid; the masses are convolved with the kernel, cut at its reach, along one axis and then
//! along the other, at the outputs only. This is what common software does, which takes the output grid itself for the nodes; here the nodes are as fine as the tolerance asks for, as far as memory
//! allows, and an answer beyond the tolerance says so.
//!
//! # The error
//! Linear binning replaces the kernel by its bilinear interpolant between nodes. On one axis the Gaussian differs from its interpolant by at most ρ²/8 sup|φ″| = ρ²/8 of the peak, ρ = δ/h with δ the
//! distance of nodes, and neither exceeds the peak; so a product of two is off by at most (ρ₀² + ρ₁²)/8 of the ceiling. Smooth data, which do not all lie at the worst places, see far less.
//!
//! # References
//! Wand 1994, Fast computation of multivariate kernel estimators, JCGS 3; Wand & Jones 1995, Kernel Smoothing, appendix D.2.

use super::super::{Engine, Quote, Unsupported, gaussian_width};
use super::pieces::Data;
use super::{by_definition, look};
use crate::kernel::{KernelSum, Shape};
use crate::sample::Weights;
use crate::space::{Domain, Evaluation, Field, Grid, Point, Targets, Warning};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// The most nodes.
const MOST_NODES: usize = 1 << 23;

/// The most parts into which the data are cut, each with a table of masses.
const MOST_PARTS: usize = 8;

/// Numbers computed at one go.
const LANES: usize = 8;

/// Linear binning and separable convolution: Gaussian of one width on a grid. O(n + nodes · reach).
#[derive(Clone, Copy, Debug, Default)]
pub struct BinnedGrid;

#[derive(Clone, Copy, Debug)]
struct Layout {
    h: [f64; 2],
    /// Nodes per cell of the grid.
    parts: [usize; 2],
    /// Nodes on either side of a target that count.
    taps: [usize; 2],
    nodes: [usize; 2],
    error: f64,
}

impl Layout {
    fn choose(sum: &KernelSum<2>, grid: &Grid<2>, tolerance: f64) -> Result<Self, Unsupported> {
        let h = gaussian_width(sum, "binned")?;
        let width = [0, 1].map(|axis| grid.width(axis) / h[axis]);
        let cut = 0.05 * tolerance.clamp(1e-15, 0.5);
        let far = (-2.0 * cut.ln()).sqrt();
        let with = |fine: f64| {
            let parts = width.map(|width| ((width / fine).min(1e6).ceil() as usize).max(1));
            let part = [0, 1].map(|axis| width[axis] / parts[axis] as f64);
            let taps = part.map(|part| (far / part).min(1e7).ceil() as usize);
            let nodes = [0, 1].map(|a| (grid.cells()[a] - 1) * parts[a] + 1 + 2 * taps[a]);
            let rounding = 1e-16 * sum.sample().len() as f64;
            let place: f64 = (0..2)
                .map(|axis| {
                    let span = grid.low()[axis].abs().max(grid.high()[axis].abs());
                    2.0 * f64::EPSILON * span / h[axis]
                })
                .sum();
            Self {
                h,
                parts,
                taps,
                nodes,
                error: part.iter().map(|part| part * part / 8.0).sum::<f64>()
                    + 2.0 * cut
                    + rounding
                    + place
                    + 1e-14,
            }
        };
        let fits = |layout: &Self| {
            layout.nodes[0].saturating_mul(layout.nodes[1]) <= MOST_NODES
                && layout.taps.iter().all(|taps| *taps < 1 << 14)
        };
        // from what the tolerance needs to what memory allows
        let mut fine = (3.6 * tolerance.max(1e-12)).sqrt();
        while fine < 1e3 {
            let layout = with(fine);
            if fits(&layout) {
                return Ok(layout);
            }
            fine *= 1.25;
        }
        let layout = with(f64::INFINITY);
        if fits(&layout) {
            Ok(layout)
        } else {
            Err(Unsupported(format!(
                "the nodes would be more than its tables may hold ({MOST_NODES})"
            )))
        }
    }
}

impl Engine<2> for BinnedGrid {
    fn name(&self) -> &'static str {
        "binned"
    }

    fn quote(
        &self,
        sum: &KernelSum<2>,
        targets: Targets<'_, 2>,
        tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        let Targets::Grid(grid) = targets else {
            return Err(Unsupported(
                "the targets are scattered: binned works on a grid".to_owned(),
            ));
        };
        let layout = Layout::choose(sum, grid, tolerance)?;
        let [lines, columns] = grid.cells().map(|cells| cells as f64);
        let nodes = (layout.nodes[0] * layout.nodes[1]) as f64;
        let taps = layout.taps.map(|taps| (2 * taps + 1) as f64);
        let reach = [0, 1].map(|axis| (layout.taps[axis] / layout.parts[axis]) as f64);
        let share = look::share(sum.sample(), grid, reach);
        // measured on one thread of a busy machine: 20 ns a datum, 40 ns where the nodes exceed the second-level cache; 0.3 ns a product
        let datum = if nodes > 2e5 { 40.0 } else { 20.0 };
        Ok(Quote {
            error: layout.error,
            nanoseconds: 30_000.0
                + sum.sample().len() as f64 * (2.0 + share * datum)
                + 4.0 * nodes
                + 0.3 * columns * (layout.nodes[0] as f64 * taps[1] + lines * taps[0]),
        })
    }

    fn prepare(&self, sum: KernelSum<2>, tolerance: f64) -> Result<Box<dyn Field<2>>, Unsupported> {
        if sum.shape() != Shape::Gaussian || sum.fixed().is_none() {
            return Err(Unsupported(
                "binned needs the Gaussian kernel and one bandwidth".to_owned(),
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
            return by_definition(&self.sum, targets, "binned");
        };
        let Ok(layout) = Layout::choose(&self.sum, grid, self.tolerance) else {
            return by_definition(&self.sum, targets, "binned");
        };
        let mut warnings = Vec::new();
        if layout.error > self.tolerance {
            let apart = [0, 1].map(|a| grid.width(a) / layout.parts[a] as f64 / layout.h[a]);
            warnings.push(Warning {
                what: format!(
                    "the nodes of the binning are {:.2} and {:.2} bandwidths apart, so that values may be off by {:.1e} of the ceiling, more than the tolerance",
                    apart[0], apart[1], layout.error
                ),
                hint: "take engine hermite, a smaller grid or a larger tolerance".to_owned(),
            });
        }
        Evaluation {
            values: on_grid(&self.sum, grid, &layout),
            error: layout.error,
            engine: Some("binned"),
            warnings,
            ..Evaluation::default()
        }
    }
}

fn on_grid(sum: &KernelSum<2>, grid: &Grid<2>, layout: &Layout) -> Vec<f64> {
    let [lines, columns] = grid.cells();
    let masses = bin(sum, grid, layout);
    let weight = match sum.sample().weights() {
        Weights::Equal(weight) => *weight,
        Weights::Each(_) => 1.0,
    };
    let taps = [0, 1].map(|axis| kernel(grid, layout, axis));
    let arch = Arch::new();
    let rows: Vec<Option<Vec<f64>>> = masses
        .par_chunks(layout.nodes[1])
        .map(|masses| {
            let occupied = masses.iter().any(|mass| *mass > 0.0);
            occupied.then(|| {
                arch.dispatch(Across {
                    masses,
                    taps: &taps[1],
                    parts: layout.parts[1],
                    columns,
                })
            })
        })
        .collect();
    let mut values = vec![0.0; lines * columns];
    values
        .par_chunks_mut(columns)
        .enumerate()
        .for_each(|(line, values)| {
            let near = &rows[line * layout.parts[0]..][..taps[0].len()];
            arch.dispatch(Down {
                near,
                taps: &taps[0],
                values,
            });
            for value in values {
                *value = *value * weight / layout.h[0] / layout.h[1];
            }
        });
    values
}

/// φ at the distances of the nodes around a target.
fn kernel(grid: &Grid<2>, layout: &Layout, axis: usize) -> Vec<f64> {
    let step = grid.width(axis) / layout.parts[axis] as f64 / layout.h[axis];
    let taps = layout.taps[axis] as f64;
    (0..=2 * layout.taps[axis])
        .map(|k| crate::numeric::special::normal_density((k as f64 - taps) * step))
        .collect()
}

/// The masses of all nodes.
fn bin(sum: &KernelSum<2>, grid: &Grid<2>, layout: &Layout) -> Vec<f64> {
    let [rows, columns] = layout.nodes;
    let step = [0, 1].map(|axis| grid.width(axis) / layout.parts[axis] as f64);
    let first = [0, 1].map(|a| grid.coordinate(a, 0) - layout.taps[a] as f64 * step[a]);
    let inverse = step.map(f64::recip);
    let last = layout.nodes.map(|nodes| (nodes - 1) as f64);
    // parts of the data that depend on sizes alone; their tables are added in order
    let most = (MOST_NODES / (rows * columns)).clamp(1, MOST_PARTS);
    let n = sum.sample().len();
    let length = n.div_ceil(most).max(1 << 16);
    let parts: Vec<Data<'_>> = Data::of(sum.sample(), None).chunks(length).collect();
    let tables: Vec<Vec<f64>> = parts
        .into_par_iter()
        .map(|part| {
            let mut table = vec![0.0; rows * columns];
            for (i, [x, y]) in part.points.iter().enumerate() {
                let (s, t) = ((x - first[0]) * inverse[0], (y - first[1]) * inverse[1]);
                // beyond the last node nothing is within reach; so written that NaN is nowhere
                if !(s >= 0.0 && s < last[0] && t >= 0.0 && t < last[1]) {
                    continue;
                }
                let weight = part.weights.map_or(1.0, |w| w[i]);
                let (row, column) = (s as usize, t as usize);
                let (f, g) = (s - row as f64, t - column as f64);
                let place = row * columns + column;
                let (near, far) = (weight * (1.0 - f), weight * f);
                table[place] += near * (1.0 - g);
                table[place + 1] += near * g;
                table[place + columns] += far * (1.0 - g);
                table[place + columns + 1] += far * g;
            }
            table
        })
        .collect();
    let mut tables = tables.into_iter();
    let mut total = tables.next().expect("a sample has at least one point");
    for table in tables {
        for (sum, mass) in total.iter_mut().zip(table) {
            *sum += mass;
        }
    }
    total
}

/// One row of nodes along the second axis, at the outputs.
struct Across<'a> {
    masses: &'a [f64],
    taps: &'a [f64],
    parts: usize,
    columns: usize,
}

impl WithSimd for Across<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<f64> {
        let (taps, rest) = self.taps.as_chunks::<LANES>();
        (0..self.columns)
            .map(|j| {
                let masses = &self.masses[j * self.parts..][..self.taps.len()];
                let (masses, mass_rest) = masses.as_chunks::<LANES>();
                let mut lanes = [0.0; LANES];
                for (masses, taps) in masses.iter().zip(taps) {
                    for l in 0..LANES {
                        lanes[l] += masses[l] * taps[l];
                    }
                }
                let rest: f64 = mass_rest.iter().zip(rest).map(|(m, t)| m * t).sum();
                lanes.iter().sum::<f64>() + rest
            })
            .collect()
    }
}

/// One line of the output from the rows around it.
struct Down<'a> {
    near: &'a [Option<Vec<f64>>],
    taps: &'a [f64],
    values: &'a mut [f64],
}

impl WithSimd for Down<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (row, tap) in self.near.iter().zip(self.taps) {
            if let Some(row) = row {
                for (value, term) in self.values.iter_mut().zip(row) {
                    *value += tap * term;
                }
            }
        }
    }
}
