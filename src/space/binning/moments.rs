//! Moments of the points of each cell about the centre of the cell.

use super::{BLOCK, CHUNK, ROUNDER, clamp, in_lanes, largest, split};
use crate::memory::zeros;
use pulp::{Arch, Simd, WithSimd};

/// Cells centred at whole multiples of a power of two.
///
/// So a centre is an exact number, and the position of a point in its cell is computed without any rounding, however far the data are from zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// The width of a cell: a power of two.
    pub width: f64,
    /// The first cell is centred at `first · width`; an integer below 2⁵⁰ in magnitude.
    pub first: f64,
    /// How many cells.
    pub count: usize,
}

impl Lattice {
    /// The centre of cell `i`, exact.
    pub fn centre(&self, i: usize) -> f64 {
        (self.first + i as f64) * self.width
    }
}

/// Four, eight or sixteen moments of each cell: Σ w uᵏ for k < M, with u = X / width - cell in [-½, ½]. Points in no cell are dropped.
///
/// Without `weights` each point counts 1. Moments of a cell are contiguous and aligned, so that a point costs one vector
/// addition for each four: about 1.8 ns for 4 moments, 2.1 ns for 8 and 2.7 ns for 16. O(n + cells).
///
/// # Panics
/// If `M` is not 4, 8 or 16.
pub fn moments<const M: usize>(
    points: &[f64],
    weights: Option<&[f64]>,
    lattice: Lattice,
) -> Vec<[f64; M]> {
    match (M, weights) {
        (4, None) => collect::<M, 1>(points, None, lattice),
        (8, None) => collect::<M, 2>(points, None, lattice),
        (4, Some(_)) => collect::<M, 2>(points, weights, lattice),
        (8, Some(_)) => collect::<M, 4>(points, weights, lattice),
        (16, None) => collect::<M, 4>(points, None, lattice),
        (16, Some(_)) => collect::<M, 6>(points, weights, lattice),
        _ => panic!("4, 8 or 16 moments"),
    }
}

fn collect<const M: usize, const QUADS: usize>(
    points: &[f64],
    weights: Option<&[f64]>,
    lattice: Lattice,
) -> Vec<[f64; M]> {
    let unit = weights.map_or(1.0, largest);
    let rows = lattice.count + 2;
    // lanes keep a table and its total
    let bytes = 2 * 32 * QUADS * rows;
    let lines = in_lanes(
        points.len(),
        bytes,
        |lane| {
            Arch::new().dispatch(Scatter::<QUADS> {
                points: &points[lane.clone()],
                weights: weights.map(|w| &w[lane]),
                unit,
                lattice,
                rows,
            })
        },
        |sum: &mut Line, term: Line| sum.add(&term),
    );
    let quad = |q: usize| lines[q / 2].0[q % 2];
    (1..=lattice.count)
        .map(|row| {
            let mut moments = [0.0; M];
            for (q, four) in moments.as_chunks_mut::<4>().0.iter_mut().enumerate() {
                *four = quad(row * QUADS + q).map(|moment| moment * unit);
            }
            if weights.is_some() {
                let mass = quad(row * QUADS)[0];
                moments[0] = (mass + quad(row * QUADS + M / 4)[0]) * unit;
            }
            moments
        })
        .collect()
}

/// Two groups of four moments: one line of the cache.
#[repr(align(64))]
#[derive(Clone, Copy)]
struct Line([[f64; 4]; 2]);

impl Line {
    const ZERO: Self = Self([[0.0; 4]; 2]);

    #[inline(always)]
    fn add(&mut self, other: &Self) {
        for half in 0..2 {
            for k in 0..4 {
                self.0[half][k] += other.0[half][k];
            }
        }
    }
}

/// Adds the moments of points to rows of `QUADS` groups of four. Row 0 and row `rows - 1` collect what lies outside.
///
/// `QUADS` without weights: 1 for four moments, 2 for eight, 4 for sixteen; with weights one group more for the rest of the mass (made even).
struct Scatter<'a, const QUADS: usize> {
    points: &'a [f64],
    weights: Option<&'a [f64]>,
    unit: f64,
    lattice: Lattice,
    rows: usize,
}

impl<const QUADS: usize> WithSimd for Scatter<'_, QUADS> {
    type Output = Vec<Line>;

    #[expect(
        clippy::too_many_lines,
        reason = "one loop, with an arm for each layout of a row"
    )]
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<Line> {
        let Self {
            points,
            weights,
            unit,
            lattice,
            rows,
        } = self;
        let inverse = lattice.width.recip();
        let (low, high) = (lattice.first - 1.0, lattice.first + lattice.count as f64);
        let origin = (low + ROUNDER).to_bits() as u32;
        let used = (rows * QUADS).div_ceil(2);
        let size = used.next_power_of_two();
        let mut table = zeros(Line::ZERO, size);
        let blocks = points.len().div_ceil(BLOCK);
        let mut total = zeros(Line::ZERO, if blocks > 1 { used } else { 0 });
        let mut index = [0u32; CHUNK];
        let mut place = [0.0f64; CHUNK];
        let mut scaled = [0.0f64; CHUNK];
        for (number, block) in points.chunks(BLOCK).enumerate() {
            for (part, chunk) in block.chunks(CHUNK).enumerate() {
                for ((i, u), &x) in index.iter_mut().zip(&mut place).zip(chunk) {
                    // both steps are exact: the scale is a power of two, and t and its cell are close
                    let t = clamp(x * inverse, low, high);
                    let cell = t + ROUNDER;
                    *i = (cell.to_bits() as u32).wrapping_sub(origin);
                    *u = t - (cell - ROUNDER);
                }
                let table = table.as_mut_slice();
                let (index, place) = (&index[..chunk.len()], &place[..chunk.len()]);
                match weights {
                    None => {
                        for (&i, &u) in index.iter().zip(place) {
                            let square = u * u;
                            let mut powers = [1.0, u, square, u * square];
                            if QUADS == 1 {
                                let line = &mut table[(i >> 1) as usize & (size - 1)];
                                let quad = &mut line.0[(i & 1) as usize];
                                for k in 0..4 {
                                    quad[k] += powers[k];
                                }
                            } else if QUADS == 2 {
                                // what is fastest for two quads is not for four
                                let fourth = square * square;
                                let line = &mut table[i as usize & (size - 1)];
                                for k in 0..4 {
                                    line.0[0][k] += powers[k];
                                }
                                for k in 0..4 {
                                    line.0[1][k] = fourth.mul_add(powers[k], line.0[1][k]);
                                }
                            } else {
                                let fourth = square * square;
                                for half in 0..QUADS / 2 {
                                    let at = i as usize * (QUADS / 2) + half;
                                    let line = &mut table[at & (size - 1)];
                                    for quad in &mut line.0 {
                                        for k in 0..4 {
                                            quad[k] += powers[k];
                                            powers[k] *= fourth;
                                        }
                                    }
                                }
                            }
                        }
                    }
                    Some(weights) => {
                        let start = number * BLOCK + part * CHUNK;
                        let weights = &weights[start..start + chunk.len()];
                        for (v, &weight) in scaled.iter_mut().zip(weights) {
                            *v = weight / unit;
                        }
                        for ((&i, &u), &v) in index.iter().zip(place).zip(&scaled) {
                            let (mass, rest) = split(v);
                            let square = u * u;
                            let powers = [mass, v * u, v * square, v * (u * square)];
                            if QUADS == 2 {
                                let line = &mut table[i as usize & (size - 1)];
                                for k in 0..4 {
                                    line.0[0][k] += powers[k];
                                }
                                line.0[1][0] += rest;
                            } else {
                                let fourth = square * square;
                                let all = [v, powers[1], powers[2], powers[3]];
                                let first = i as usize * (QUADS / 2);
                                let mut factor = fourth;
                                let line = &mut table[first & (size - 1)];
                                for k in 0..4 {
                                    line.0[0][k] += powers[k];
                                    line.0[1][k] += factor * all[k];
                                }
                                for half in 1..QUADS / 2 - 1 {
                                    let line = &mut table[(first + half) & (size - 1)];
                                    for quad in 0..2 {
                                        factor *= fourth;
                                        for k in 0..4 {
                                            line.0[quad][k] += factor * all[k];
                                        }
                                    }
                                }
                                let last = first + QUADS / 2 - 1;
                                table[last & (size - 1)].0[0][0] += rest;
                            }
                        }
                    }
                }
            }
            for (sum, line) in total.iter_mut().zip(&mut table) {
                sum.add(line);
                *line = Line::ZERO;
            }
        }
        if blocks <= 1 {
            // what lies behind is empty
            table.truncate(used);
            return table;
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::Sum;
    use proptest::prelude::*;

    fn judge<const M: usize>(points: &[f64], weights: &[f64], lattice: Lattice) -> Vec<[f64; M]> {
        let mut sums = vec![[Sum::default(); M]; lattice.count];
        for (x, w) in points.iter().zip(weights) {
            let t = x / lattice.width;
            let cell = t.round_ties_even() - lattice.first;
            if (0.0..lattice.count as f64).contains(&cell) {
                let u = t - t.round_ties_even();
                for (k, sum) in sums[cell as usize].iter_mut().enumerate() {
                    sum.add(w * u.powi(k as i32));
                }
            }
        }
        sums.iter().map(|row| row.map(Sum::value)).collect()
    }

    fn compare<const M: usize>(points: &[f64], weights: &[f64], lattice: Lattice) {
        let ones = vec![1.0; points.len()];
        for (given, effective) in [(None, &ones[..]), (Some(weights), weights)] {
            let (got, expected) = (
                moments::<M>(points, given, lattice),
                judge::<M>(points, effective, lattice),
            );
            for (g, e) in got.iter().zip(&expected) {
                for k in 0..M {
                    assert!(
                        (g[k] - e[k]).abs() <= 1e-15 * (points.len() as f64).sqrt() * e[0],
                        "{k}: {} {}",
                        g[k],
                        e[k]
                    );
                }
            }
        }
    }

    #[test]
    fn ties_sum_without_loss() {
        let lattice = Lattice {
            width: 0.125,
            first: -3.0,
            count: 9,
        };
        let points = vec![0.1; 1_000_001];
        let rows = moments::<8>(&points, Some(&vec![0.1; points.len()]), lattice);
        assert!(
            (rows[4][0] / 100_000.1 - 1.0).abs() < 1e-15,
            "{}",
            rows[4][0]
        );
    }

    #[test]
    fn threads_do_not_change_a_bit() {
        let points: Vec<f64> = (0..900_001)
            .map(|i| (f64::from(i) * 0.618_034).fract())
            .collect();
        let weights: Vec<f64> = points.iter().map(|x| 1.0 / (x + 1e-3)).collect();
        let lattice = Lattice {
            width: 1.0 / 64.0,
            first: 3.0,
            count: 50,
        };
        let run = |threads| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("threads")
                .install(|| {
                    (
                        moments::<8>(&points, None, lattice),
                        moments::<4>(&points, Some(&weights), lattice),
                    )
                })
        };
        let one = run(1);
        assert_eq!(one, run(2));
        assert_eq!(one, run(7));
    }

    proptest! {
        #[test]
        fn moments_are_those_of_the_definition(
            exponent in -8..3_i32, first in -20i32..20, count in 1usize..40,
            offset in prop::sample::select(vec![0.0, 1.0 / 3.0, 1e9]),
            raw in prop::collection::vec((-0.3..1.3_f64, 0.0..3.0_f64), 1..600),
        ) {
            let width = 2f64.powi(exponent);
            let lattice = Lattice { width, first: f64::from(first) + (offset / width).round(), count };
            let points: Vec<f64> = raw.iter().map(|(u, _)| (u * count as f64 + lattice.first) * width).collect();
            let weights: Vec<f64> = raw.iter().map(|(_, w)| *w).collect();
            compare::<4>(&points, &weights, lattice);
            compare::<8>(&points, &weights, lattice);
            compare::<16>(&points, &weights, lattice);
        }
    }
}
