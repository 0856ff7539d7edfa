//! Histograms: how many points, or what mass, each bin holds.

use super::{BLOCK, CHUNK, ROUNDER, clamp, in_lanes, largest, split};
use crate::memory::zeros;
use pulp::{Arch, Simd, WithSimd};

/// What the bins received, and what fell outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Counts<T> {
    /// Below the first bin.
    pub below: T,
    /// In each bin.
    pub inside: Vec<T>,
    /// Above the last bin.
    pub above: T,
}

/// The half-open bins [origin + k·width, origin + (k + 1)·width) for k = first .. first + count.
///
/// There is one formula for the bin of a place, k = ⌊(x - origin) / width⌋ as computed in `f64`; so a datum at an edge and a target at the
/// same place are in the same bin, whatever the rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mesh {
    /// An edge.
    pub origin: f64,
    /// The width of a bin.
    pub width: f64,
    /// The number of the first bin wanted, whole.
    pub first: f64,
    /// How many bins are wanted, at most 2³⁰.
    pub count: usize,
}

impl Mesh {
    /// The number of the bin that holds `x`, whole, the first one wanted having the number `first`.
    #[inline(always)]
    pub fn number(&self, x: f64) -> f64 {
        // adding zero makes -0 the 0 that it equals
        ((x - self.origin) / self.width).floor() + 0.0
    }
}

/// How many of `points` lie in each bin of `mesh`.
///
/// Bins are found by a multiplication and, within rounding of an edge, by the division that defines them. O(n), about 1 ns a point below
/// 10⁴ bins.
pub fn count(points: &[f64], mesh: Mesh) -> Counts<u64> {
    let search = Search::of(mesh);
    let size = search.table();
    let table = in_lanes(
        points.len(),
        8 * size,
        |lane| {
            let points = &points[lane];
            if size <= SMALL {
                Arch::new().dispatch(Count::<SMALL> { points, search })
            } else {
                Arch::new().dispatch(Count::<0> { points, search })
            }
        },
        |sum, term| *sum += term,
    );
    search.unpack(table)
}

/// The mass of `points` in each bin of `mesh`: the sum of their `weights`, which must be finite and at least 0.
///
/// Bins as for [`count`]; sums as the module says. O(n).
pub fn weigh(points: &[f64], weights: &[f64], mesh: Mesh) -> Counts<f64> {
    let search = Search::of(mesh);
    let unit = largest(weights);
    let table = in_lanes(
        points.len(),
        16 * search.table(),
        |lane| {
            Arch::new().dispatch(Weigh {
                points: &points[lane.clone()],
                weights: &weights[lane],
                unit,
                search,
            })
        },
        |sum: &mut [f64; 2], term| {
            sum[0] += term[0];
            sum[1] += term[1];
        },
    );
    search.unpack(
        table
            .into_iter()
            .map(|[high, low]| (high + low) * unit)
            .collect(),
    )
}

/// A mesh prepared for the search.
#[derive(Clone, Copy)]
struct Search {
    mesh: Mesh,
    inverse: f64,
    /// Distance from an edge, in bins, below which the quick formula is not trusted.
    slack: f64,
}

impl Search {
    fn of(mesh: Mesh) -> Self {
        // quotient, product with the reciprocal and their distance from the first bin are each rounded once or twice
        let largest = mesh.first.abs() + mesh.count as f64 + 1.0;
        Self {
            mesh,
            inverse: mesh.width.recip(),
            slack: (4.0 * f64::EPSILON * largest).max(1e-12),
        }
    }

    /// Guard bin, bins, guard bin; rounded up to a power of two for the mask.
    fn table(&self) -> usize {
        (self.mesh.count + 2).next_power_of_two()
    }

    /// Whether every point must be divided: numbers of bins, or the reciprocal, are too large for the quick formula.
    fn always(&self) -> bool {
        self.slack >= 0.2 || !self.inverse.is_normal()
    }

    #[inline(always)]
    fn locate(&self, points: &[f64], index: &mut [u32; CHUNK]) {
        let Mesh {
            origin,
            first,
            count,
            ..
        } = self.mesh;
        let (inverse, top) = (self.inverse, count as f64 + 0.25);
        // rounding t - ½ is the floor; near an edge the two sides of the slack differ
        let (up, down) = (self.slack - 0.5, -self.slack - 0.5);
        let mut doubtful = u32::from(self.always());
        for (i, &x) in index.iter_mut().zip(points) {
            let t = clamp((x - origin) * inverse - first, -0.75, top);
            let above = (t + up + ROUNDER).to_bits() as u32;
            let below = (t + down + ROUNDER).to_bits() as u32;
            doubtful |= above ^ below;
            *i = below.wrapping_add(1);
        }
        if doubtful != 0 {
            self.settle(points, index);
        }
    }

    #[cold]
    #[inline(never)]
    fn settle(&self, points: &[f64], index: &mut [u32; CHUNK]) {
        let always = self.always();
        for (i, &x) in index.iter_mut().zip(points) {
            let t = (x - self.mesh.origin) * self.inverse - self.mesh.first;
            if always || (t - t.round()).abs() <= 2.0 * self.slack {
                let place = self.mesh.number(x) - self.mesh.first;
                *i = clamp(place, -1.0, self.mesh.count as f64) as i64 as u32;
                *i = i.wrapping_add(1);
            }
        }
    }

    fn unpack<T: Copy>(&self, table: Vec<T>) -> Counts<T> {
        let mut inside = table;
        let above = inside[self.mesh.count + 1];
        inside.truncate(self.mesh.count + 1);
        let below = inside.remove(0);
        Counts {
            below,
            inside,
            above,
        }
    }
}

/// Bins, guards included, below which tables have a size that the compiler knows.
const SMALL: usize = 1 << 12;

/// Counts into two tables of `SIZE` (0: any) in turn, so that points in the same bin do not wait for each other.
struct Count<'a, const SIZE: usize> {
    points: &'a [f64],
    search: Search,
}

impl<const SIZE: usize> WithSimd for Count<'_, SIZE> {
    type Output = Vec<u64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<u64> {
        let Self { points, search } = self;
        let wanted = search.table();
        let size = if SIZE > 0 { SIZE } else { wanted };
        let mut tables = (zeros(0u32, size), zeros(0u32, size));
        let mut total = zeros(0u64, wanted);
        let mut index = [0u32; CHUNK];
        // flushed long before a count of 32 bits is full
        for block in points.chunks(1 << 31) {
            for chunk in block.chunks(CHUNK) {
                search.locate(chunk, &mut index);
                let (even, odd) = (&mut tables.0[..size], &mut tables.1[..size]);
                let (pairs, last) = index[..chunk.len()].as_chunks::<2>();
                for [first, second] in pairs {
                    even[*first as usize & (size - 1)] += 1;
                    odd[*second as usize & (size - 1)] += 1;
                }
                for cell in last {
                    even[*cell as usize & (size - 1)] += 1;
                }
            }
            for table in [&mut tables.0, &mut tables.1] {
                for (sum, count) in total.iter_mut().zip(&mut table[..wanted]) {
                    *sum += u64::from(*count);
                    *count = 0;
                }
            }
        }
        total
    }
}

struct Weigh<'a> {
    points: &'a [f64],
    weights: &'a [f64],
    unit: f64,
    search: Search,
}

impl WithSimd for Weigh<'_> {
    type Output = Vec<[f64; 2]>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<[f64; 2]> {
        let Self {
            points,
            weights,
            unit,
            search,
        } = self;
        let size = search.table();
        let mut table = zeros([0.0; 2], size);
        let mut index = [0u32; CHUNK];
        let mut parts = [[0.0f64; 2]; CHUNK];
        for (points, weights) in points.chunks(BLOCK).zip(weights.chunks(BLOCK)) {
            for (chunk, weights) in points.chunks(CHUNK).zip(weights.chunks(CHUNK)) {
                search.locate(chunk, &mut index);
                for (parts, &weight) in parts.iter_mut().zip(weights) {
                    *parts = split(weight / unit).into();
                }
                let table = table.as_mut_slice();
                for (&cell, parts) in index[..chunk.len()].iter().zip(&parts) {
                    let row = &mut table[cell as usize & (size - 1)];
                    for part in 0..2 {
                        row[part] += parts[part];
                    }
                }
            }
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn mesh(origin: f64, width: f64, count: usize) -> Mesh {
        Mesh {
            origin,
            width,
            first: 0.0,
            count,
        }
    }

    /// The definition.
    fn judge(points: &[f64], mesh: Mesh) -> Counts<u64> {
        let mut counts = Counts {
            below: 0,
            inside: vec![0; mesh.count],
            above: 0,
        };
        for &x in points {
            let place = mesh.number(x) - mesh.first;
            if place < 0.0 {
                counts.below += 1;
            } else if place >= mesh.count as f64 {
                counts.above += 1;
            } else {
                counts.inside[place as usize] += 1;
            }
        }
        counts
    }

    #[test]
    fn a_lattice_of_data_on_the_edges_goes_where_the_formula_says() {
        // 0.1 i is rarely a binary number, and dividing it by 0.1 rounds either way
        let points: Vec<f64> = (0..10_000).map(|i| f64::from(i) * 0.1).collect();
        let mesh = mesh(0.0, 0.1, 9990);
        let counts = count(&points, mesh);
        assert_eq!(counts, judge(&points, mesh));
        assert_eq!(
            counts.below + counts.above + counts.inside.iter().sum::<u64>(),
            10_000
        );
    }

    #[test]
    fn a_million_ties_are_counted_and_weighed() {
        let mesh = mesh(0.0, 1.0, 4);
        let points = vec![1.5; 1_000_003];
        assert_eq!(count(&points, mesh).inside, [0, 1_000_003, 0, 0]);
        let mass = weigh(&points, &vec![0.1; points.len()], mesh).inside[1];
        assert!((mass / 100_000.3 - 1.0).abs() < 1e-15, "{mass}");
    }

    #[test]
    fn threads_do_not_change_a_bit() {
        let points: Vec<f64> = (0..700_001)
            .map(|i| (f64::from(i) * 0.618).fract())
            .collect();
        let weights: Vec<f64> = points.iter().map(|x| 1.0 / (x + 1e-3)).collect();
        let mesh = mesh(0.1, 0.02, 37);
        let run = |threads| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("threads")
                .install(|| weigh(&points, &weights, mesh))
        };
        let one = run(1);
        assert_eq!(one, run(2));
        assert_eq!(one, run(7));
    }

    #[test]
    fn bins_thinner_than_rounding_and_outliers_are_no_special_case() {
        let points = [1e9, 1e9 + 1e-7, -1e300, 1e300, 5.0];
        for (width, first) in [(1e-9, 1e18), (1e-320, 0.0), (1e300, -2.0)] {
            let mesh = Mesh {
                origin: 0.0,
                width,
                first,
                count: 5,
            };
            assert_eq!(count(&points, mesh), judge(&points, mesh), "{width}");
        }
    }

    proptest! {
        #[test]
        fn counts_are_those_of_the_formula(
            origin in -1e3..1e3_f64, offset in prop::sample::select(vec![0.0, 1e9]), width in 1e-3..10.0_f64,
            first in -50..50_i32, bins in 1usize..40, unit in prop::collection::vec(-0.2..1.2_f64, 1..200),
            on_edges in any::<bool>(),
        ) {
            let mesh = Mesh { origin: origin + offset, width, first: f64::from(first), count: bins };
            let points: Vec<f64> = unit.iter().map(|u| {
                let t = mesh.first + u * bins as f64;
                mesh.origin + width * if on_edges { t.round() } else { t }
            }).collect();
            let expected = judge(&points, mesh);
            prop_assert_eq!(&count(&points, mesh), &expected);
            let mass = weigh(&points, &vec![0.5; points.len()], mesh);
            for (m, c) in mass.inside.iter().zip(&expected.inside) {
                prop_assert!((m - 0.5 * *c as f64).abs() < 1e-12);
            }
        }
    }
}
