//! The loop over the data where no footprint is larger than a square of lanes: always the whole square, so that there is nothing to decide.
//!
//! A cell of the square that the datum does not reach receives the zero that the kernel has there. The processor need not guess how many rows a
//! footprint has, which is what a datum costs most where footprints are small.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::super::pieces::Slices;
use super::super::profile::Profile;
use super::visit::{Frame, LANES, Size, add, lanes};
use pulp::{Simd, WithSimd};
use std::ops::Range;

pub(super) struct Narrow<'a, P, const PRODUCT: bool> {
    pub profile: P,
    pub frame: &'a Frame,
    pub data: Slices<'a>,
    pub rows: Range<usize>,
    pub open: &'a mut [f64],
}

impl<P: Profile, const PRODUCT: bool> WithSimd for Narrow<'_, P, PRODUCT> {
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
        // numbered loops, see `visit.rs`
        let (first_x, first_y) = (frame.x[0], frame.y[0]);
        let size = Size::new(frame, frame.h);
        let reach = frame.reach();
        let (first_row, last_row) = (rows.start as f64, (rows.end - 1) as f64);
        let last_column = (frame.columns - 1) as f64;
        for d in 0..data.x.len() {
            let (x, y) = (data.x[d], data.y[d]);
            let weight = data.weight.map_or(1.0, |w| w[d]);
            let top = ((x - first_x) * frame.inverse[0] - reach[0]).ceil();
            let left = ((y - first_y) * frame.inverse[1] - reach[1]).ceil();
            // squares that begin before the rows or columns are moved to their start: they hold all the same cells that count
            let top = if top > first_row { top } else { first_row };
            let top = if top < last_row { top } else { last_row } as usize;
            let left = if left > 0.0 { left } else { 0.0 };
            let left = if left < last_column {
                left
            } else {
                last_column
            } as usize;
            let mut across = lanes(&frame.y, left);
            for l in 0..LANES {
                let v = size.scaled::<P>(across[l] - y, 1);
                across[l] = if PRODUCT { profile.bare(v * v) } else { v * v };
            }
            let (mut squares, mut down) = (lanes(&frame.x, top), [0.0; LANES]);
            for l in 0..LANES {
                let u = size.scaled::<P>(squares[l] - x, 0);
                squares[l] = u * u;
                if PRODUCT {
                    down[l] = weight * profile.bare(squares[l]);
                }
            }
            let start = (top - rows.start) * frame.stride + left;
            let window = &mut open[start..][..(LANES - 1) * frame.stride + LANES];
            for i in 0..LANES {
                let row: &mut [f64; LANES] = window[i * frame.stride..]
                    .first_chunk_mut()
                    .expect("the window ends with a row of lanes");
                add::<P, PRODUCT>(profile, row, &across, down[i], squares[i], weight);
            }
        }
    }
}
