//! The loop over the data: a footprint each, row by row. Footprints of at most eight by eight cells have a loop of their own in `narrow.rs`.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::super::pieces::Slices;
use super::super::profile::{Profile, with_profile};
use super::narrow::Narrow;
use crate::kernel::{KernelSum, Shape, Symmetry};
use crate::space::Grid;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Cells that are computed at one go.
pub(super) const LANES: usize = 8;

/// The grid as all data see it.
pub(super) struct Frame {
    /// The centres of the rows, and some beyond.
    pub x: Vec<f64>,
    /// The centres of the columns, and some beyond so that a footprint never ends within a row of lanes.
    pub y: Vec<f64>,
    pub columns: usize,
    /// The length of a row of a band: room for the lanes beyond the last column.
    pub stride: usize,
    pub inverse: [f64; 2],
    slop: [f64; 2],
    radius: f64,
    /// The common width; 0 if each datum has its own.
    pub h: [f64; 2],
}

impl Frame {
    pub(super) fn new(sum: &KernelSum<2>, grid: &Grid<2>, radius: f64, slop: [f64; 2]) -> Self {
        let [lines, columns] = grid.cells();
        let stride = columns + LANES;
        Self {
            x: (0..lines + LANES).map(|i| grid.coordinate(0, i)).collect(),
            y: (0..stride).map(|j| grid.coordinate(1, j)).collect(),
            columns,
            stride,
            inverse: [0, 1].map(|axis| grid.width(axis).recip()),
            slop,
            radius,
            h: sum.fixed().unwrap_or([0.0; 2]),
        }
    }

    /// What the common width reaches on each axis, in cells, rounding allowed for.
    pub(super) fn reach(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.radius * self.h[axis] * self.inverse[axis] + self.slop[axis])
    }

    /// Whether no datum reaches more cells than there are lanes, in both directions.
    fn narrow(&self) -> bool {
        self.reach()
            .iter()
            .all(|reach| 2.0 * reach + 1.0 < (LANES + 1) as f64)
    }

    /// The first cell and one past the last within `reach` cells of position `t`, of the cells in `range`.
    #[inline(always)]
    fn span(t: f64, reach: f64, range: &Range<usize>) -> (usize, usize) {
        let low = (t - reach).ceil();
        let high = (t + reach).floor() + 1.0;
        let (least, most) = (range.start as f64, range.end as f64);
        let low = if low > least { low } else { least };
        let high = if high < most { high } else { most };
        // both are now within the range, or in the wrong order
        (low.max(0.0) as usize, high.max(0.0) as usize)
    }
}

/// Adds the bumps of `data`, bare of all constant factors, to the `rows` of the grid that `open` holds, and to [`LANES`] rows beyond, which mean nothing.
pub(super) fn visit(
    sum: &KernelSum<2>,
    frame: &Frame,
    data: Slices<'_>,
    rows: Range<usize>,
    open: &mut [f64],
) {
    let product = sum.symmetry() == Symmetry::Product || sum.shape() == Shape::Gaussian;
    let narrow = data.width.is_none() && frame.narrow();
    let arch = Arch::new();
    with_profile!(sum.shape(), profile => match (product, narrow) {
        (true, true) => arch.dispatch(Narrow::<_, true> { profile, frame, data, rows, open }),
        (true, false) => arch.dispatch(Visit::<_, true> { profile, frame, data, rows, open }),
        (false, true) => arch.dispatch(Narrow::<_, false> { profile, frame, data, rows, open }),
        (false, false) => arch.dispatch(Visit::<_, false> { profile, frame, data, rows, open }),
    });
}

struct Visit<'a, P, const PRODUCT: bool> {
    profile: P,
    frame: &'a Frame,
    data: Slices<'a>,
    rows: Range<usize>,
    open: &'a mut [f64],
}

impl<P: Profile, const PRODUCT: bool> WithSimd for Visit<'_, P, PRODUCT> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self {
            profile,
            frame,
            data,
            rows,
            open,
        } = self;
        // written with numbered loops: closures and adaptors of iterators are functions, and one that is not inlined is not compiled for wide registers
        let (first_x, first_y) = (frame.x[0], frame.y[0]);
        let limit = frame.radius * frame.radius;
        let mut across = vec![[0.0; LANES]; frame.stride.div_ceil(LANES)];
        let mut down = vec![[0.0; LANES]; rows.len().div_ceil(LANES)];
        let mut squares = down.clone();
        let all = 0..frame.columns;
        let mut size = Size::new(frame, frame.h);
        for d in 0..data.x.len() {
            let (x, y) = (data.x[d], data.y[d]);
            let mut weight = data.weight.map_or(1.0, |w| w[d]);
            if let Some(widths) = data.width {
                weight = weight / widths[d] / widths[d];
                size = Size::new(frame, [widths[d]; 2]);
            }
            let t = (x - first_x) * frame.inverse[0];
            let (top, bottom) = Frame::span(t, size.reach[0] + frame.slop[0], &rows);
            let place = (y - first_y) * frame.inverse[1];
            let (left, right) = Frame::span(place, size.reach[1] + frame.slop[1], &all);
            if top >= bottom || left >= right {
                continue;
            }
            let blocks = (right - left).div_ceil(LANES);
            // each block is read, computed and written as a whole: registers know nothing of overlap
            for k in 0..blocks {
                let mut block = lanes(&frame.y, left + k * LANES);
                for l in 0..LANES {
                    let v = size.scaled::<P>(block[l] - y, 1);
                    block[l] = if PRODUCT { profile.bare(v * v) } else { v * v };
                }
                across[k] = block;
            }
            for k in 0..(bottom - top).div_ceil(LANES) {
                let (mut square, mut value) = (lanes(&frame.x, top + k * LANES), [0.0; LANES]);
                for l in 0..LANES {
                    let u = size.scaled::<P>(square[l] - x, 0);
                    square[l] = u * u;
                    if PRODUCT {
                        value[l] = weight * profile.bare(square[l]);
                    }
                }
                (squares[k], down[k]) = (square, value);
            }
            let (down, squares) = (down.as_flattened(), squares.as_flattened());
            for i in top..bottom {
                let (here, square) = (down[i - top], squares[i - top]);
                let start = (i - rows.start) * frame.stride + left;
                // of a wide footprint only the part within the ellipse, one cell more for rounding; of a few blocks all, which is cheaper than a root
                let (from, to) = if (PRODUCT && P::COMPACT) || blocks <= 3 {
                    (0, blocks)
                } else {
                    let rest = limit - square;
                    if rest < 0.0 && rest < -1e-9 * limit {
                        continue;
                    }
                    let half =
                        size.reach[1] * (if rest > 0.0 { rest } else { 0.0 } / limit).sqrt() + 1.0;
                    let (from, to) = Frame::span(place, half, &(left..right));
                    if from >= to {
                        continue;
                    }
                    ((from - left) / LANES, (to - left).div_ceil(LANES))
                };
                let (row, _) =
                    open[start + from * LANES..start + to * LANES].as_chunks_mut::<LANES>();
                let across = &across[from..to];
                for k in 0..row.len().min(across.len()) {
                    add::<P, PRODUCT>(profile, &mut row[k], &across[k], here, square, weight);
                }
            }
        }
    }
}

/// A width as the grid sees it.
#[derive(Clone, Copy)]
pub(super) struct Size {
    h: [f64; 2],
    /// 1 / h.
    inverse: [f64; 2],
    /// In cells.
    reach: [f64; 2],
}

impl Size {
    #[inline(always)]
    pub(super) fn new(frame: &Frame, h: [f64; 2]) -> Self {
        Self {
            h,
            inverse: [1.0 / h[0], 1.0 / h[1]],
            reach: [
                frame.radius * h[0] * frame.inverse[0],
                frame.radius * h[1] * frame.inverse[1],
            ],
        }
    }

    /// (x - X) / h as in the definition where the kernel jumps; one multiplication where that is as good.
    #[inline(always)]
    pub(super) fn scaled<P: Profile>(&self, difference: f64, axis: usize) -> f64 {
        if P::JUMPS {
            difference / self.h[axis]
        } else {
            difference * self.inverse[axis]
        }
    }
}

/// The numbers from `start` on.
#[inline(always)]
pub(super) fn lanes(of: &[f64], start: usize) -> [f64; LANES] {
    *of[start..]
        .first_chunk()
        .expect("there are some beyond the last for this")
}

/// One row of lanes; `across` holds the kernel's values of the columns for a product, where `here` is the weight times the kernel's value of the row, or their v² for a radial
/// kernel, where `square` is the row's u².
#[inline(always)]
pub(super) fn add<P: Profile, const PRODUCT: bool>(
    profile: P,
    row: &mut [f64; LANES],
    across: &[f64; LANES],
    here: f64,
    square: f64,
    weight: f64,
) {
    let (mut sums, across) = (*row, *across);
    for l in 0..LANES {
        sums[l] += if PRODUCT {
            here * across[l]
        } else {
            weight * profile.bare(square + across[l])
        };
    }
    *row = sums;
}
