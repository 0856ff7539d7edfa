//! The binned sample that histogram, averaged shifted histogram and frequency polygon share.

use super::FitError;
use crate::numeric::Sum;
use crate::sample::{Sample, Weights};
use crate::space::Warning;
use crate::space::binning::{self, Mesh};

/// The mass of a sample in the half-open bins [origin + k·width, origin + (k + 1)·width), k whole.
///
/// There is **one formula** for the bin of a place ([`Mesh::number`]), used for data and targets alike, so that a
/// datum at an edge and a target at the same edge are in the same bin whatever the rounding. Memory is O(n) whatever the
/// width: bins are a plain row where that has at most a few cells a point, and otherwise only those with data in them are kept, in order.
///
/// k is kept as an `f64`, which stays whole and in order far beyond the range of integer types: an outlier at 1e12 with a width of 1e-9 is
/// no special case.
pub(super) struct Bins {
    origin: f64,
    width: f64,
    /// The largest magnitude of a datum.
    farthest: f64,
    store: Store,
}

enum Store {
    /// Every bin from number `first` on.
    Row { first: f64, masses: Vec<f64> },
    /// The bins with data, numbers ascending.
    Sparse { numbers: Vec<f64>, masses: Vec<f64> },
}

impl Bins {
    /// Bins `sample`. O(n) if the range holds at most a few bins a point, else O(n log n).
    pub(super) fn of(sample: &Sample<1>, origin: f64, width: f64) -> Result<Self, FitError> {
        let x = sample.coordinates();
        let (least, most) = range(sample);
        if least > most {
            // a channel without any mass
            let store = Store::Row {
                first: 0.0,
                masses: Vec::new(),
            };
            return Ok(Self {
                origin,
                width,
                farthest: 0.0,
                store,
            });
        }
        let mesh = Mesh {
            origin,
            width,
            first: 0.0,
            count: 0,
        };
        let (first, last) = (mesh.number(least), mesh.number(most));
        if !(first.is_finite() && last.is_finite() && width.recip().is_finite()) {
            return Err(FitError::TooLarge(format!(
                "the data from {least} to {most} cannot be numbered in bins of width {width} from the origin {origin}; choose a larger width"
            )));
        }
        let span = last - first + 1.0;
        let store = if span <= (4 * x.len()).max(4096) as f64 {
            let mesh = Mesh {
                first,
                count: span as usize,
                ..mesh
            };
            let masses = match sample.weights() {
                Weights::Equal(weight) => binning::count(x, mesh)
                    .inside
                    .into_iter()
                    .map(|count| count as f64 * weight)
                    .collect(),
                // only points without weight are outside the row
                Weights::Each(weights) => binning::weigh(x, weights, mesh).inside,
            };
            Store::Row { first, masses }
        } else {
            sparse(sample, mesh)
        };
        Ok(Self {
            origin,
            width,
            farthest: least.abs().max(most.abs()),
            store,
        })
    }

    /// The number of the bin that holds `x`.
    pub(super) fn number(&self, x: f64) -> f64 {
        let mesh = Mesh {
            origin: self.origin,
            width: self.width,
            first: 0.0,
            count: 0,
        };
        mesh.number(x)
    }

    /// The mass in bin `number`.
    pub(super) fn mass(&self, number: f64) -> f64 {
        match &self.store {
            Store::Row { first, masses } => {
                let place = number - first;
                if place >= 0.0 && place < masses.len() as f64 {
                    masses[place as usize]
                } else {
                    0.0
                }
            }
            Store::Sparse { numbers, masses } => numbers
                .binary_search_by(|k| k.total_cmp(&number))
                .map_or(0.0, |place| masses[place]),
        }
    }

    /// The place of bin `number` among the [`Bins::len`] that are kept, if it is.
    pub(super) fn index(&self, number: f64) -> Option<usize> {
        match &self.store {
            Store::Row { first, masses } => {
                let place = number - first;
                (place >= 0.0 && place < masses.len() as f64).then_some(place as usize)
            }
            Store::Sparse { numbers, .. } => {
                numbers.binary_search_by(|k| k.total_cmp(&number)).ok()
            }
        }
    }

    /// How many bins are kept; O(n).
    pub(super) fn len(&self) -> usize {
        match &self.store {
            Store::Row { masses, .. } | Store::Sparse { masses, .. } => masses.len(),
        }
    }

    /// The bins with data among those `within` on either side of bin `number`: their distance from it, signed, and their mass; ascending.
    pub(super) fn around(&self, number: f64, within: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let (low, high) = (number - within, number + within);
        let (numbers, offset, masses): (&[f64], f64, &[f64]) = match &self.store {
            Store::Row { first, masses } => {
                let bins = masses.len() as f64;
                let from = (low - first).clamp(0.0, bins) as usize;
                let to = (high - first + 1.0).clamp(from as f64, bins) as usize;
                (&[], first + from as f64, &masses[from..to])
            }
            Store::Sparse { numbers, masses } => {
                let from = numbers.partition_point(|&k| k < low);
                let to = numbers.partition_point(|&k| k <= high).max(from);
                (&numbers[from..to], 0.0, &masses[from..to])
            }
        };
        masses
            .iter()
            .enumerate()
            .map(move |(i, &mass)| {
                let k = numbers.get(i).copied().unwrap_or(offset + i as f64);
                (k - number, mass)
            })
            .filter(|&(_, mass)| mass > 0.0)
    }

    /// What to say if bins are narrower than the numbers around them can tell apart.
    pub(super) fn warnings(&self) -> Vec<Warning> {
        let largest = self.farthest.max(self.origin.abs());
        if self.width >= 2.0 * f64::EPSILON * largest {
            return Vec::new();
        }
        vec![Warning {
            what: format!(
                "bins of width {} are narrower than the distance between neighbouring numbers near {largest}",
                self.width
            ),
            hint: "choose a larger width, or subtract a constant from the data".to_owned(),
        }]
    }
}

/// The least and the greatest place with any mass.
fn range(sample: &Sample<1>) -> (f64, f64) {
    let widen = |(least, most): (f64, f64), x: f64| {
        (
            if x < least { x } else { least },
            if x > most { x } else { most },
        )
    };
    let nothing = (f64::INFINITY, f64::NEG_INFINITY);
    let x = sample.coordinates();
    match sample.weights() {
        Weights::Equal(_) => binning::range(x),
        Weights::Each(weights) => x
            .iter()
            .zip(weights.iter())
            .filter(|&(_, &weight)| weight > 0.0)
            .map(|(&x, _)| x)
            .fold(nothing, widen),
    }
}

fn sparse(sample: &Sample<1>, mesh: Mesh) -> Store {
    let mut order: Vec<(f64, usize)> = sample
        .coordinates()
        .iter()
        .enumerate()
        .map(|(i, &x)| (mesh.number(x), i))
        .collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let (mut numbers, mut masses) = (Vec::new(), Vec::new());
    #[expect(clippy::float_cmp, reason = "bin numbers are whole")]
    for bin in order.chunk_by(|a, b| a.0 == b.0) {
        let mass = match sample.weights() {
            Weights::Equal(weight) => bin.len() as f64 * weight,
            Weights::Each(weights) => bin
                .iter()
                .map(|&(_, i)| weights[i])
                .collect::<Sum>()
                .value(),
        };
        if mass > 0.0 {
            numbers.push(bin[0].0);
            masses.push(mass);
        }
    }
    Store::Sparse { numbers, masses }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Domain;

    fn equal(x: &[f64]) -> Sample<1> {
        Sample::equal(x.iter().map(|&x| [x]).collect(), Domain::whole()).expect("legal")
    }

    fn same(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-15 * b.abs()
    }

    #[test]
    fn edges_belong_to_the_right_and_zero_has_one_sign() {
        let bins = Bins::of(&equal(&[-0.0, 0.0, 0.25, -0.25, 0.5]), 0.0, 0.25).expect("small");
        for (number, mass) in [
            (-2.0, 0.0),
            (-1.0, 0.2),
            (0.0, 0.4),
            (1.0, 0.2),
            (2.0, 0.2),
            (3.0, 0.0),
        ] {
            assert!(same(bins.mass(number), mass), "bin {number}");
        }
        assert!(same(bins.mass(bins.number(-0.0)), 0.4));
    }

    #[test]
    fn a_tenth_that_is_no_tenth_is_binned_like_its_own_target() {
        // 0.3 / 0.1 is below 3 in binary: wherever the datum went, the target at its place must look there
        let x: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.1).collect();
        let bins = Bins::of(&equal(&x), 0.0, 0.1).expect("small");
        assert!(x.iter().all(|&x| bins.mass(bins.number(x)) > 0.0));
    }

    #[test]
    fn a_row_and_a_sparse_store_hold_the_same() {
        let mut x: Vec<f64> = (0..500)
            .map(|i| (f64::from(i) * 0.737).sin() * 3.0)
            .collect();
        let row = Bins::of(&equal(&x), 0.1, 0.01).expect("small");
        assert!(matches!(row.store, Store::Row { .. }));
        x.push(1e12);
        let weights = |n: usize| (0..n).map(|i| 1.0 + (i % 3) as f64).collect::<Vec<_>>();
        let sparse = Bins::of(&equal(&x), 0.1, 0.01).expect("small");
        assert!(matches!(sparse.store, Store::Sparse { .. }));
        assert!(same(sparse.mass(sparse.number(1e12)), 1.0 / 501.0));
        for &at in &x[..500] {
            let k = row.number(at);
            assert!(same(sparse.mass(k) * 501.0, row.mass(k) * 500.0));
            let around = |bins: &Bins| bins.around(k, 3.0).map(|(i, _)| i).collect::<Vec<_>>();
            assert_eq!(around(&row), around(&sparse));
        }
        let weighted = |x: &[f64]| {
            let points = x.iter().map(|&x| [x]).collect();
            let weights = Weights::Each(weights(x.len()).into());
            Bins::of(
                &Sample::new(points, weights, Domain::whole()).expect("legal"),
                0.1,
                0.01,
            )
        };
        let (row, sparse) = (
            weighted(&x[..500]).expect("small"),
            weighted(&x).expect("small"),
        );
        for &at in &x[..500] {
            assert!(same(sparse.mass(row.number(at)), row.mass(row.number(at))));
        }
    }

    #[test]
    fn an_outlier_or_a_tiny_width_costs_no_memory() {
        let bins = Bins::of(&equal(&[0.0, 1.0, 1e12, -1e290]), 0.0, 1e-9).expect("sparse");
        assert!(same(bins.mass(bins.number(1e12)), 0.25));
        assert!(same(bins.mass(bins.number(1.0)), 0.25));
        let Store::Sparse { numbers, .. } = &bins.store else {
            panic!("a row")
        };
        assert_eq!(numbers.len(), 4);
        assert_eq!(bins.warnings().len(), 1);
        assert!(Bins::of(&equal(&[-1e300, 1e300]), 0.0, 1e-12).is_err());
    }

    /// Blocks and threads are no part of the result.
    #[test]
    fn many_points_are_counted_alike_by_any_number_of_threads() {
        let n = 3 * (1_usize << 18) + 17;
        let x: Vec<f64> = (0..n).map(|i| (i as f64 * 0.618).fract()).collect();
        let weights: Vec<f64> = (0..n).map(|i| 0.1 + (i % 7) as f64).collect();
        let points: Vec<[f64; 1]> = x.iter().map(|&x| [x]).collect();
        let sample = Sample::normalised(points, weights.clone(), Domain::whole()).expect("legal");
        let masses = |threads: usize| -> Vec<u64> {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| {
                let equal = Bins::of(&equal(&x), 0.0, 0.01).expect("small");
                let weighted = Bins::of(&sample, 0.0, 0.01).expect("small");
                (0..100)
                    .flat_map(|k| [&equal, &weighted].map(|bins| bins.mass(f64::from(k)).to_bits()))
                    .collect()
            })
        };
        let one = masses(1);
        assert_eq!(one, masses(2));
        assert_eq!(one, masses(7));
        // against counting one by one
        let (mut count, mut mass) = (vec![0u32; 100], vec![0.0; 100]);
        let total: f64 = weights.iter().sum();
        for (x, w) in x.iter().zip(&weights) {
            let k = (x / 0.01).floor() as usize;
            count[k] += 1;
            mass[k] += w / total;
        }
        for k in 0..100 {
            let (equal, weighted) = (f64::from_bits(one[2 * k]), f64::from_bits(one[2 * k + 1]));
            assert!(same(equal, f64::from(count[k]) / n as f64));
            assert!((weighted - mass[k]).abs() < 1e-12);
        }
    }
}
