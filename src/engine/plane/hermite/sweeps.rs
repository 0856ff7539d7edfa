//! The sums over the cells around each grid point, along one axis and then along the other.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::Layout;
use super::moments::{Row, plane};
use pulp::{Simd, WithSimd};

/// Columns that are computed at one go.
pub(super) const LANES: usize = 8;

/// Lines that are computed at one go.
const LINES: usize = 4;

/// The sums over the first axis for [`LANES`] columns of cells: `[b][line]`, lines filled up to a multiple of [`LINES`].
pub(super) struct Down<'a, const M: usize> {
    pub rows: &'a [Row],
    pub start: usize,
    pub taps: &'a [[f64; M]],
    pub layout: &'a Layout,
    pub lines: usize,
}

impl<const M: usize> WithSimd for Down<'_, M> {
    type Output = Vec<[f64; LANES]>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<[f64; LANES]> {
        let Self {
            rows,
            start,
            taps,
            layout,
            lines,
        } = self;
        let (count, parts) = (layout.cells[1], layout.parts[0]);
        let width = LANES.min(count - start);
        let groups = lines.div_ceil(LINES);
        let mut sums = vec![[0.0; LANES]; M * groups * LINES];
        if rows.iter().all(Option::is_none) {
            return sums;
        }
        // neighbouring lines see the same cells through kernels that are `parts` cells apart: zeros before and after make that one loop
        let margin = (LINES - 1) * parts;
        let mut padded = vec![0.0; taps.len() + 2 * margin];
        let mut column = vec![[0.0; LANES]; rows.len() + margin];
        for b in 0..M {
            for a in 0..M - b {
                for (tap, padded) in taps.iter().zip(&mut padded[margin..]) {
                    *padded = tap[a];
                }
                let from = plane(M, a, b) * count + start;
                for (cells, row) in column.iter_mut().zip(rows) {
                    if let Some(row) = row {
                        cells[..width].copy_from_slice(&row[from..from + width]);
                    }
                }
                let (here, _) =
                    sums[b * groups * LINES..][..groups * LINES].as_chunks_mut::<LINES>();
                for (group, sums) in here.iter_mut().enumerate() {
                    let mut lanes = *sums;
                    let cells = &column[group * LINES * parts..];
                    for (k, cells) in cells[..taps.len() + margin].iter().enumerate() {
                        for q in 0..LINES {
                            let tap = padded[k + margin - q * parts];
                            for l in 0..LANES {
                                lanes[q][l] += tap * cells[l];
                            }
                        }
                    }
                    *sums = lanes;
                }
            }
        }
        sums
    }
}

/// One line of the grid from the sums over the first axis.
pub(super) struct Across<'a, const M: usize> {
    pub blocks: &'a [Vec<[f64; LANES]>],
    pub line: usize,
    pub lines: usize,
    pub taps: &'a [[f64; M]],
    pub layout: &'a Layout,
    pub row: &'a mut [f64],
}

impl<const M: usize> WithSimd for Across<'_, M> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self {
            blocks,
            line,
            lines,
            taps,
            layout,
            row,
        } = self;
        let (count, parts) = (layout.cells[1], layout.parts[1]);
        let groups = lines.div_ceil(LINES);
        // every `parts`-th cell side by side, so that neighbouring targets read neighbouring numbers
        let stride = count.div_ceil(parts).next_multiple_of(LANES) + LANES;
        let mut phases = vec![0.0; stride * parts];
        for b in 0..M {
            for cell in 0..count {
                let sums = &blocks[cell / LANES][b * groups * LINES + line];
                phases[(cell % parts) * stride + cell / parts] = sums[cell % LANES];
            }
            for (block, values) in row.chunks_mut(LANES).enumerate() {
                let mut lanes = [0.0; LANES];
                for (k, tap) in taps.iter().enumerate() {
                    let from = (k % parts) * stride + k / parts + block * LANES;
                    let cells: &[f64; LANES] = phases[from..]
                        .first_chunk()
                        .expect("a phase has room for the lanes");
                    for l in 0..LANES {
                        lanes[l] += tap[b] * cells[l];
                    }
                }
                for (value, lane) in values.iter_mut().zip(lanes) {
                    *value += lane;
                }
            }
        }
    }
}
