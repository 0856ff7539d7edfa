//! Linear binning: each point shares its mass between the two nearest nodes so that the first moment is kept.
//!
//! # References
//! Jones & Lotwick 1984, A remark on algorithm AS 176, Applied Statistics 33; Wand 1994, Fast computation of multivariate kernel
//! estimators, JCGS 3, section 2; Hall & Wand 1996, On the accuracy of binned kernel density estimators, JMVA 56.

use super::{BLOCK, CHUNK, ROUNDER, clamp, in_lanes, largest};
use crate::memory::zeros;
use pulp::{Arch, Simd, WithSimd};

/// Equally spaced nodes `low + i·step`, at least two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nodes {
    /// The first node.
    pub low: f64,
    /// The distance between nodes.
    pub step: f64,
    /// How many.
    pub count: usize,
}

/// Bits of the fraction of a cell that an unweighted point keeps.
const FRACTION_BITS: u32 = 20;

/// Where the count begins in a word.
const COUNT_BIT: u32 = 42;

/// Points of one flush of the packed table: fewer than 2²², so that their fractions stay below the counts and the counts below bit 64.
const PACKED_BLOCK: usize = (1 << 22) - CHUNK;

/// The most nodes of an unweighted binning: the cell number must fit between fraction and count.
pub(super) const MOST_NODES: usize = 1 << 20;

/// Shares each of `points` between its two nearest `nodes`; points below the first node, and those not below the
/// last one, are dropped.
///
/// Without `weights` a point counts 1. Then a point costs one integer addition: its fraction of the cell goes to the low half of a 64-bit word
/// and a one to the high half, and count and sum of fractions of a cell are all there is to know. The fraction is rounded to
/// 2⁻²⁰ cells. Up to 2³² points the sums are exact integers, so that even the order of the points does not matter. O(n), 1.3 to 2 ns a point.
///
/// # Panics
/// If there are fewer than 2 or more than 2²⁰ nodes.
pub fn linear(points: &[f64], weights: Option<&[f64]>, nodes: Nodes) -> Vec<f64> {
    assert!(
        (2..=MOST_NODES).contains(&nodes.count),
        "between 2 and 2²⁰ nodes"
    );
    // cells between nodes, and a guard cell at either end
    let size = (nodes.count + 1).next_power_of_two();
    let (table, unit) = match weights {
        None => {
            let table = in_lanes(
                points.len(),
                16 * nodes.count,
                |lane| {
                    Arch::new().dispatch(Packed {
                        points: &points[lane],
                        nodes,
                        size,
                    })
                },
                |sum, term| *sum += term,
            );
            (table, (f64::from(1u32 << FRACTION_BITS)).recip())
        }
        Some(weights) => {
            let unit = largest(weights);
            let rows = in_lanes(
                points.len(),
                32 * nodes.count,
                |lane| {
                    Arch::new().dispatch(Weighted {
                        points: &points[lane.clone()],
                        weights: &weights[lane],
                        unit,
                        nodes,
                        size,
                    })
                },
                |sum: &mut [f64; 2], term| {
                    sum[0] += term[0];
                    sum[1] += term[1];
                },
            );
            (share(&rows, nodes.count), unit)
        }
    };
    table[1..=nodes.count]
        .iter()
        .map(|mass| mass * unit)
        .collect()
}

/// From (mass, mass × fraction) of the cells to the mass of the nodes; cell c lies between the nodes at c and c + 1 of the result.
fn share(rows: &[[f64; 2]], nodes: usize) -> Vec<f64> {
    let mut shared = vec![0.0; rows.len()];
    for c in 1..nodes {
        let [mass, right] = rows[c];
        shared[c] += mass - right;
        shared[c + 1] += right;
    }
    shared
}

struct Packed<'a> {
    points: &'a [f64],
    nodes: Nodes,
    size: usize,
}

impl WithSimd for Packed<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<f64> {
        // the unit of the last place of this number is 2⁻²⁰
        const FIXED: f64 = ROUNDER / (1u64 << FRACTION_BITS) as f64;
        const FRACTION: u64 = (1 << FRACTION_BITS) - 1;
        const ONE: u64 = 1 << COUNT_BIT;
        let Self {
            points,
            nodes,
            size,
        } = self;
        let inverse = nodes.step.recip();
        // cell c lies between the nodes c - 1 and c; cell 0 is below the first node and cell `count` above the last
        let origin = nodes.low;
        let top = nodes.count as f64 + 0.5;
        let mut table = zeros(0u64, size);
        let mut shared = zeros(0.0f64, nodes.count + 1);
        let mut fixed = [0u64; CHUNK];
        for block in points.chunks(PACKED_BLOCK) {
            for chunk in block.chunks(CHUNK) {
                for (v, &x) in fixed.iter_mut().zip(chunk) {
                    let t = clamp((x - origin) * inverse + 1.0, 0.5, top);
                    *v = (t + FIXED).to_bits().wrapping_sub(FIXED.to_bits());
                }
                let table = table.as_mut_slice();
                for &v in &fixed[..chunk.len()] {
                    let cell = (v >> FRACTION_BITS) as usize & (size - 1);
                    table[cell] += (v & FRACTION) | ONE;
                }
            }
            // what lies below the first node and above the last is dropped
            table[0] = 0;
            table[nodes.count] = 0;
            for (c, shared) in shared.iter_mut().enumerate().skip(1) {
                let right = table[c - 1] & (ONE - 1);
                let left = ((table[c] >> COUNT_BIT) << FRACTION_BITS) - (table[c] & (ONE - 1));
                *shared += (left + right) as f64;
            }
            table[..=nodes.count].fill(0);
        }
        shared
    }
}

struct Weighted<'a> {
    points: &'a [f64],
    weights: &'a [f64],
    unit: f64,
    nodes: Nodes,
    size: usize,
}

impl WithSimd for Weighted<'_> {
    type Output = Vec<[f64; 2]>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<[f64; 2]> {
        let Self {
            points,
            weights,
            unit,
            nodes,
            size,
        } = self;
        let inverse = nodes.step.recip();
        let origin = nodes.low;
        let top = nodes.count as f64 + 0.5;
        let mut table = zeros([0.0; 2], size);
        let mut total = zeros([0.0; 2], nodes.count + 1);
        let mut index = [0u32; CHUNK];
        let mut fraction = [0.0; CHUNK];
        let mut scaled = [0.0; CHUNK];
        for (points, weights) in points.chunks(BLOCK).zip(weights.chunks(BLOCK)) {
            for (points, weights) in points.chunks(CHUNK).zip(weights.chunks(CHUNK)) {
                for ((i, f), &x) in index.iter_mut().zip(&mut fraction).zip(points) {
                    let t = clamp((x - origin) * inverse + 1.0, 0.5, top);
                    let floor = (t - 0.5) + ROUNDER;
                    *i = floor.to_bits() as u32;
                    *f = t - (floor - ROUNDER);
                }
                for (v, &weight) in scaled.iter_mut().zip(weights) {
                    *v = weight / unit;
                }
                let table = table.as_mut_slice();
                for ((&i, &f), &v) in index[..points.len()].iter().zip(&fraction).zip(&scaled) {
                    let row = &mut table[i as usize & (size - 1)];
                    row[0] += v;
                    row[1] += v * f;
                }
            }
            for (sum, row) in total.iter_mut().zip(&mut table) {
                sum[0] += row[0];
                sum[1] += row[1];
                *row = [0.0; 2];
            }
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn judge(points: &[f64], weights: &[f64], nodes: Nodes) -> Vec<f64> {
        let mut mass = vec![0.0; nodes.count];
        for (x, w) in points.iter().zip(weights) {
            let t = (x - nodes.low) / nodes.step;
            if t >= 0.0 && t < (nodes.count - 1) as f64 {
                let (i, f) = (t as usize, t.fract());
                mass[i] += w * (1.0 - f);
                mass[i + 1] += w * f;
            }
        }
        mass
    }

    #[test]
    fn mass_and_mean_are_kept() {
        let nodes = Nodes {
            low: -1.0,
            step: 0.01,
            count: 301,
        };
        let points: Vec<f64> = (0..1_200_000)
            .map(|i| (f64::from(i) * 0.618_034).fract() * 1.9)
            .collect();
        let mass = linear(&points, None, nodes);
        let total: f64 = mass.iter().sum();
        let mean = mass
            .iter()
            .enumerate()
            .map(|(i, m)| m * (i as f64 * 0.01 - 1.0))
            .sum::<f64>()
            / total;
        let expected = points.iter().sum::<f64>() / points.len() as f64;
        assert!((total - 1_200_000.0).abs() < 1e-6, "{total}");
        assert!((mean - expected).abs() < 1e-8, "{mean} {expected}");
    }

    #[test]
    fn the_order_of_the_points_does_not_matter() {
        let nodes = Nodes {
            low: 0.0,
            step: 0.003,
            count: 300,
        };
        let mut points: Vec<f64> = (0..400_000)
            .map(|i| (f64::from(i) * 0.618_034).fract())
            .collect();
        let forth = linear(&points, None, nodes);
        points.reverse();
        assert_eq!(forth, linear(&points, None, nodes));
    }

    proptest! {
        #[test]
        fn nodes_receive_what_the_definition_says(
            low in -10.0..10.0_f64, step in 0.01..2.0_f64, count in 2usize..50,
            raw in prop::collection::vec((-0.3..1.3_f64, 0.0..3.0_f64), 1..300),
        ) {
            let nodes = Nodes { low, step, count };
            let points: Vec<f64> = raw.iter().map(|(u, _)| (u * (count - 1) as f64).mul_add(step, low)).collect();
            let weights: Vec<f64> = raw.iter().map(|(_, w)| *w).collect();
            let ones = vec![1.0; points.len()];
            for (got, expected) in [
                (linear(&points, None, nodes), judge(&points, &ones, nodes)),
                (linear(&points, Some(&weights), nodes), judge(&points, &weights, nodes)),
            ] {
                for (g, e) in got.iter().zip(&expected) {
                    // a fraction is rounded to 2⁻²⁰
                    prop_assert!((g - e).abs() < 3.0 * points.len() as f64 * 2f64.powi(-21), "{} {}", g, e);
                }
            }
        }
    }
}
