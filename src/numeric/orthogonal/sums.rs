//! Sums over data of functions, and sums of functions over places.

use super::{Basis, LANES, Row};
use crate::numeric::Sum;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::marker::PhantomData;

/// Data summed by one task: fixed, so that the sums do not depend on the number of threads.
const BLOCK: usize = 1 << 13;

/// A system moved to where the data are: ψₖ(x) = φₖ(u) / √length with u = (x - origin) / length.
///
/// A compact system is zero beyond its interval, the ends of which belong to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed<B> {
    basis: PhantomData<B>,
    /// The origin is the sum of the two, so that far from zero it has more digits than one number could hold.
    origin: [f64; 2],
    length: f64,
    /// The interval of a compact system.
    support: [f64; 2],
}

/// What data leave of themselves in a system.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    /// Σ w ψ(X) for each function.
    pub sums: Vec<f64>,
    /// Σ w ψ(X)² for each function; empty if not asked for.
    pub squares: Vec<f64>,
    /// Σ w of the data where the system lives.
    pub inside: f64,
}

impl<B: Basis> Placed<B> {
    /// A compact system on the interval from `low` to `high`.
    pub fn between(low: f64, high: f64) -> Self {
        Self {
            basis: PhantomData,
            origin: [low, 0.0],
            length: high - low,
            support: [low, high],
        }
    }

    /// A system on the line about `centre` + `offset`, stretched by `length`.
    pub fn about(centre: f64, offset: f64, length: f64) -> Self {
        Self {
            basis: PhantomData,
            origin: [centre, offset],
            length,
            support: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// Where the functions are not zero.
    pub fn support(&self) -> [f64; 2] {
        self.support
    }

    /// What one unit of the system is on the axis of the data.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// [`Basis::cuts`] on the axis of the data.
    pub fn cuts(&self, terms: usize) -> Vec<f64> {
        let place = |u: f64| self.origin[0] + (self.origin[1] + self.length * u);
        B::cuts(terms).into_iter().map(place).collect()
    }

    /// Whether the system lives at `x`.
    pub fn contains(&self, x: f64) -> bool {
        self.support[0] <= x && x <= self.support[1]
    }

    #[inline(always)]
    fn unit(&self, x: f64) -> f64 {
        let u = (x - self.origin[0] - self.origin[1]) / self.length;
        // rounding must not lead beyond the end of the interval
        if B::COMPACT { u.clamp(0.0, 1.0) } else { u }
    }

    /// The functions of degree below `terms` at `x`; zeros outside.
    pub fn at(&self, x: f64, terms: usize) -> Vec<f64> {
        if !self.contains(x) {
            return vec![0.0; B::functions(terms)];
        }
        let norm = self.length.sqrt().recip();
        let mut values = B::at(self.unit(x), terms);
        for value in &mut values {
            *value *= norm;
        }
        values
    }

    /// The functions of degree below `terms` at each of `places`, the places of one function side by side; zeros outside.
    pub fn table(&self, places: &[f64], terms: usize) -> Vec<f64> {
        let n = places.len();
        let norm = self.length.sqrt().recip();
        let mut table = vec![0.0; n * B::functions(terms)];
        for (block, places) in places.chunks(LANES).enumerate() {
            let mut u = [0.5; LANES];
            let mut inside = [0.0; LANES];
            for (lane, &x) in places.iter().enumerate() {
                if self.contains(x) {
                    (u[lane], inside[lane]) = (self.unit(x), norm);
                }
            }
            B::walk(&u, terms, |index, row| {
                let start = index * n + block * LANES;
                let values = &mut table[start..start + places.len()];
                for (lane, value) in values.iter_mut().enumerate() {
                    *value = inside[lane] * row[lane];
                }
            });
        }
        table
    }

    /// The sums of the functions of degree below `terms` over `points` with their weights, and of their squares if asked for. O(n · terms).
    pub fn project(
        &self,
        points: &[f64],
        weight: impl Fn(usize) -> f64 + Sync,
        terms: usize,
        squares: bool,
    ) -> Projection {
        let count = B::functions(terms);
        let blocks: Vec<[Vec<Sum>; 2]> = (0..points.len().div_ceil(BLOCK))
            .into_par_iter()
            .map(|block| {
                let range = block * BLOCK..((block + 1) * BLOCK).min(points.len());
                let weights: Vec<f64> = range.clone().map(&weight).collect();
                Arch::new().dispatch(Project {
                    placed: *self,
                    points: &points[range],
                    weights: &weights,
                    terms,
                    squares,
                })
            })
            .collect();
        let mut totals = [vec![Sum::default(); count + 1], Vec::new()];
        totals[1] = vec![Sum::default(); if squares { count } else { 0 }];
        for block in blocks {
            for (total, part) in totals.iter_mut().zip(block) {
                for (sum, term) in total.iter_mut().zip(part) {
                    sum.merge(term);
                }
            }
        }
        let [first, second] = totals;
        // the last of the first sums is that of the weights
        let inside = first[count].value();
        let norm = self.length.sqrt().recip();
        Projection {
            sums: first[..count]
                .iter()
                .map(|sum| norm * sum.value())
                .collect(),
            squares: second.iter().map(|sum| sum.value() / self.length).collect(),
            inside,
        }
    }

    /// Σₖ cₖ ψₖ(x), the same bits as [`Placed::sum`] gives among others.
    pub fn sum_at(&self, coefficients: &[f64], x: f64) -> f64 {
        if !self.contains(x) {
            return 0.0;
        }
        let norm = self.length.sqrt().recip();
        let mut sum = 0.0;
        B::walk(
            &[self.unit(x); LANES],
            terms::<B>(coefficients),
            |index, row| {
                sum += norm * coefficients.get(index).copied().unwrap_or(0.0) * row[0];
            },
        );
        sum
    }

    /// Σₖ cₖ ψₖ(x) at each of `places`; zero outside. O(m · terms).
    pub fn sum(&self, coefficients: &[f64], places: &[f64]) -> Vec<f64> {
        let norm = self.length.sqrt().recip();
        let scaled: Vec<f64> = coefficients.iter().map(|c| norm * c).collect();
        places
            .par_chunks(8 * LANES)
            .flat_map_iter(|places| {
                Arch::new().dispatch(Evaluate {
                    placed: *self,
                    coefficients: &scaled,
                    places,
                })
            })
            .collect()
    }
}

struct Project<'a, B> {
    placed: Placed<B>,
    points: &'a [f64],
    weights: &'a [f64],
    terms: usize,
    squares: bool,
}

/// Σ of a row, in an order that suits vector registers.
#[inline(always)]
fn total(row: &Row) -> f64 {
    const REGISTER: usize = 8;
    let mut sums = [0.0; REGISTER];
    for part in row.chunks_exact(REGISTER) {
        for k in 0..REGISTER {
            sums[k] += part[k];
        }
    }
    for half in [4, 2, 1] {
        for k in 0..half {
            sums[k] += sums[k + half];
        }
    }
    sums[0]
}

impl<B: Basis> WithSimd for Project<'_, B> {
    type Output = [Vec<Sum>; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> [Vec<Sum>; 2] {
        let count = B::functions(self.terms);
        let mut first = vec![Sum::default(); count + 1];
        let mut second = vec![Sum::default(); if self.squares { count } else { 0 }];
        for (points, weights) in self.points.chunks(LANES).zip(self.weights.chunks(LANES)) {
            let (mut u, mut w) = ([0.5; LANES], [0.0; LANES]);
            for (lane, (&x, &weight)) in points.iter().zip(weights).enumerate() {
                if weight > 0.0 && self.placed.contains(x) {
                    (u[lane], w[lane]) = (self.placed.unit(x), weight);
                }
            }
            first[count].add(total(&w));
            B::walk(&u, self.terms, |index, row| {
                let mut weighed = [0.0; LANES];
                for lane in 0..LANES {
                    weighed[lane] = w[lane] * row[lane];
                }
                first[index].add(total(&weighed));
                if self.squares {
                    for lane in 0..LANES {
                        weighed[lane] *= row[lane];
                    }
                    second[index].add(total(&weighed));
                }
            });
        }
        [first, second]
    }
}

/// How many degrees these are the coefficients of.
fn terms<B: Basis>(coefficients: &[f64]) -> usize {
    coefficients
        .len()
        .checked_sub(1)
        .map_or(0, |last| B::degree(last) + 1)
}

struct Evaluate<'a, B> {
    placed: Placed<B>,
    /// Over √length already.
    coefficients: &'a [f64],
    places: &'a [f64],
}

impl<B: Basis> WithSimd for Evaluate<'_, B> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<f64> {
        let terms = terms::<B>(self.coefficients);
        let mut values = Vec::with_capacity(self.places.len());
        for places in self.places.chunks(LANES) {
            let mut u = [0.5; LANES];
            for (lane, &x) in places.iter().enumerate() {
                if self.placed.contains(x) {
                    u[lane] = self.placed.unit(x);
                }
            }
            let mut sums = [0.0; LANES];
            B::walk(&u, terms, |index, row| {
                let c = self.coefficients.get(index).copied().unwrap_or(0.0);
                for lane in 0..LANES {
                    sums[lane] += c * row[lane];
                }
            });
            values.extend(
                places.iter().zip(sums).map(
                    |(&x, sum)| {
                        if self.placed.contains(x) { sum } else { 0.0 }
                    },
                ),
            );
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Cosine, Fourier, Hermite, Legendre};
    use super::*;

    fn points() -> Vec<f64> {
        (0..BLOCK + 1234)
            .map(|i| 7.0 + 4.0 * (i as f64 * 0.618).fract())
            .collect()
    }

    fn check<B: Basis>(placed: Placed<B>, terms: usize) {
        let points = points();
        let weight = |i: usize| (i % 5) as f64 * 0.25;
        let found = placed.project(&points, weight, terms, true);
        let mut sums = vec![[Sum::default(); 2]; B::functions(terms)];
        let mut inside = Sum::default();
        for (i, &x) in points.iter().enumerate() {
            for (sum, value) in sums.iter_mut().zip(placed.at(x, terms)) {
                sum[0].add(weight(i) * value);
                sum[1].add(weight(i) * value * value);
            }
            if placed.contains(x) {
                inside.add(weight(i));
            }
        }
        let mass = inside.value();
        assert!((found.inside / mass - 1.0).abs() < 1e-14);
        for (k, sum) in sums.iter().enumerate() {
            assert!((found.sums[k] - sum[0].value()).abs() < 1e-13 * mass, "{k}");
            assert!(
                (found.squares[k] - sum[1].value()).abs() < 1e-12 * mass,
                "{k}"
            );
        }
        let few: Vec<f64> = points[..77].to_vec();
        let table = placed.table(&few, terms);
        for (i, x) in few.iter().enumerate() {
            for (k, value) in placed.at(*x, terms).into_iter().enumerate() {
                // adding zero makes -0 the 0 that it equals
                let (found, expected) = (table[k * 77 + i] + 0.0, value + 0.0);
                assert_eq!(found.to_bits(), expected.to_bits());
            }
        }
        // the other way round, with any coefficients
        let coefficients: Vec<f64> = (0..sums.len()).map(|k| (k as f64).cos()).collect();
        let places: Vec<f64> = (0..77).map(|i| 6.0 + 0.1 * f64::from(i)).collect();
        for (x, value) in places.iter().zip(placed.sum(&coefficients, &places)) {
            let expected: f64 = placed
                .at(*x, terms)
                .iter()
                .zip(&coefficients)
                .map(|(v, c)| v * c)
                .sum();
            assert!(
                (value - expected).abs() < 1e-12,
                "at {x}: {value} {expected}"
            );
            assert_eq!(placed.sum_at(&coefficients, *x).to_bits(), value.to_bits());
        }
        let threads = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| {
                let found = placed.project(&points, weight, terms, true);
                (found, placed.sum(&coefficients, &places))
            })
        };
        assert_eq!(threads(1), threads(3));
    }

    #[test]
    fn sums_are_those_of_the_functions_one_by_one() {
        check(Placed::<Cosine>::between(7.1, 10.9), 40);
        check(Placed::<Fourier>::between(7.1, 10.9), 20);
        check(Placed::<Legendre>::between(7.0, 11.0), 40);
        check(Placed::<Hermite>::about(9.0, 0.125, 0.7), 40);
    }
}
