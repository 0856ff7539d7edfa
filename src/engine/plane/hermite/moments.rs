//! The pass over the data: to each cell its moments.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::super::pieces::{Bands, Cells, Data, NOWHERE, RUSH, Slices, cells, pieces};
use super::Layout;
use crate::kernel::KernelSum;
use crate::space::{Grid, Point};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Data summed without closing.
pub(super) const RUN: usize = 512;

/// One row of cells: planes of moments, plane (a, b) at [`plane`], each as long as the row; none if there are no data.
pub(super) type Row = Option<Vec<f64>>;

/// The number of the plane with the moments of order (a, b), those of the same b together.
pub(super) const fn plane(order: usize, a: usize, b: usize) -> usize {
    // b = 0 has `order` planes, b = 1 one less ...
    b * order - b * b.saturating_sub(1) / 2 + a
}

/// The moments of all cells, row by row.
pub(super) fn collect<const M: usize>(
    sum: &KernelSum<2>,
    grid: &Grid<2>,
    layout: &Layout,
) -> Vec<Row> {
    let lattices = [0, 1].map(|axis| layout.lattice(grid, axis));
    let bands = Bands {
        bands: layout.cells[0],
        cells: layout.cells[1],
    };
    let key = |x: Point<2>, _: f64| {
        let mut cell = [0; 2];
        for axis in 0..2 {
            let (first, width) = lattices[axis];
            let t = (x[axis] - first) / width + 0.5;
            // so written that NaN is nowhere
            if !(t >= 0.0 && t < layout.cells[axis] as f64) {
                return NOWHERE;
            }
            cell[axis] = t as usize;
        }
        (cell[0] * bands.cells + cell[1]) as u32
    };
    let planes = M * (M + 1) / 2;
    let mut rows: Vec<Row> = vec![None; bands.bands];
    for rush in Data::of(sum.sample(), None).chunks(RUSH) {
        let pieces = pieces(rush, bands, key);
        rows.par_iter_mut().enumerate().for_each(|(number, row)| {
            let ordered = cells(&pieces, bands, number);
            if ordered.columns.x.is_empty() {
                return;
            }
            let row = row.get_or_insert_with(|| vec![0.0; planes * bands.cells]);
            let (first, width) = lattices[0];
            Arch::new().dispatch(Add::<M> {
                ordered: &ordered,
                centre: (number as f64).mul_add(width, first),
                across: lattices[1],
                scales: layout.h.map(f64::recip),
                row,
            });
        });
    }
    rows
}

/// Adds the moments of one row of cells.
struct Add<'a, const M: usize> {
    ordered: &'a Cells,
    centre: f64,
    across: (f64, f64),
    scales: [f64; 2],
    row: &'a mut [f64],
}

impl<const M: usize> WithSimd for Add<'_, M> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let count = self.ordered.start.len() - 1;
        for cell in 0..count {
            let data = self.ordered.range(cell..cell + 1);
            if data.x.is_empty() {
                continue;
            }
            let (first, width) = self.across;
            let centres = [self.centre, (cell as f64).mul_add(width, first)];
            let (now, mut data) = data.split_at(RUN);
            let mut total = sum_run::<M>(now, centres, self.scales);
            while !data.x.is_empty() {
                let (now, later) = data.split_at(RUN);
                let run = sum_run::<M>(now, centres, self.scales);
                for (total, run) in total.iter_mut().zip(&run) {
                    for (total, run) in total.iter_mut().zip(run) {
                        *total += run;
                    }
                }
                data = later;
            }
            for b in 0..M {
                for a in 0..M - b {
                    self.row[plane(M, a, b) * count + cell] += total[a][b];
                }
            }
        }
    }
}

/// Σ w s₀ᵃ s₁ᵇ of a run of data: `[a][b]`, what is not needed of it half done.
#[inline(always)]
fn sum_run<const M: usize>(data: Slices<'_>, centres: [f64; 2], scales: [f64; 2]) -> [[f64; M]; M] {
    let mut sums = [[0.0; M]; M];
    for i in 0..data.x.len() {
        let s = (data.x[i] - centres[0]) * scales[0];
        let t = (data.y[i] - centres[1]) * scales[1];
        let mut across = [1.0; M];
        for b in 1..M {
            // products of halves rather than a chain
            across[b] = if b == 1 {
                t
            } else {
                across[b / 2] * across[b - b / 2]
            };
        }
        let mut down = data.weight.map_or(1.0, |w| w[i]);
        for a in 0..M {
            // a multiple of four, for the registers
            let needed = (M - a).next_multiple_of(4).min(M);
            for b in 0..needed {
                sums[a][b] += down * across[b];
            }
            down *= s;
        }
    }
    sums
}
