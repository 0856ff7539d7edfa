//! Intervals told by one rounding for each progression of breakpoints, for windows that are wider than the grid.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::super::basis::CHUNK;
use super::lattice::{Lattice, Partition};
use super::sweep::{Places, ROUND};

/// The number of an interval of a [`Partition`] is the number of breakpoints below it.
///
/// Where breakpoints of two progressions coincide and rounding counts the wrong one as passed, their number is right all the same. So the
/// centre must be that of the *interval*, looked up: one computed from the windows entered alone would be another one.
pub(super) struct Merged<'a> {
    lattice: &'a Lattice<'a>,
    /// A power of two of them.
    centres: Vec<f64>,
}

impl<'a> Merged<'a> {
    pub fn new(lattice: &'a Lattice<'a>, partition: &Partition) -> Self {
        let mut centres = partition.centres.clone();
        centres.resize(centres.len().next_power_of_two(), 0.0);
        Self { lattice, centres }
    }
}

impl Places for Merged<'_> {
    #[inline(always)]
    fn find<const KINKED: bool, const DOUBT: bool>(
        &self,
        points: &[f64; CHUNK],
        index: &mut [u64; CHUNK],
        distance: &mut [f64; CHUNK],
    ) -> bool {
        let Lattice {
            first,
            inverse,
            scale,
            reach,
            doubt,
            ..
        } = *self.lattice;
        let most = self.lattice.grid.len() as f64;
        let limit = 0.5 - doubt;
        let shifts = [0.5 + reach, 0.5 - reach, 0.5];
        let mut doubtful = 0;
        for i in 0..CHUNK {
            let t = (points[i] - first) * inverse;
            let mut total = 0_u64;
            let mut worst = 0.0;
            for family in 0..if KINKED { 3 } else { 2 } {
                // comparisons written so that each is one instruction
                let passed = t + shifts[family];
                let passed = if passed > 0.0 { passed } else { 0.0 };
                let passed = if passed < most { passed } else { most };
                let rounded = passed + ROUND;
                total = total.wrapping_add(rounded.to_bits());
                if DOUBT {
                    let off = (passed - (rounded - ROUND)).abs();
                    worst = if off > worst { off } else { worst };
                }
            }
            if DOUBT {
                doubtful |= u64::from(worst > limit);
            }
            index[i] = total;
        }
        let mask = self.centres.len() - 1;
        for i in 0..CHUNK {
            distance[i] = (points[i] - self.centres[index[i] as usize & mask]) * scale;
        }
        doubtful != 0
    }
}
