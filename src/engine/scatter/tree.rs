//! The tree over the targets: bumps in, values out.

use super::{BUDGET, CHUNK, GAUSSIAN_REACH, LEAF, MOST};
use crate::kernel::{Form, Kernel, KernelSum, Use};
use crate::numeric::Sum;
use crate::space::Grid;
use rayon::prelude::*;

/// Targets in ascending order.
pub(super) struct Places<'a> {
    pub(super) sorted: &'a [f64],
    /// Whose centres they are, if they are.
    pub(super) grid: Option<&'a Grid<1>>,
}

impl Places<'_> {
    /// The first target for which `past` holds; `past` is false, then true along the targets, and turns near `x`.
    #[inline]
    fn first(&self, x: f64, past: impl Fn(f64) -> bool) -> usize {
        let Some(grid) = self.grid else {
            return self.sorted.partition_point(|&target| !past(target));
        };
        // a cast takes what is below zero, and what is no number, to zero
        let guess = ((x - grid.low()[0]) / grid.width(0)) as usize;
        let mut found = guess.min(self.sorted.len());
        while found > 0 && past(self.sorted[found - 1]) {
            found -= 1;
        }
        while found < self.sorted.len() && !past(self.sorted[found]) {
            found += 1;
        }
        found
    }
}

/// A run of targets that one polynomial can serve, seen from its middle.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    middle: f64,
    half: f64,
}

impl Node {
    fn around(targets: &[f64]) -> Self {
        let (Some(first), Some(last)) = (targets.first(), targets.last()) else {
            return Self::default();
        };
        let half = 0.5 * last - 0.5 * first;
        Self {
            middle: first + half,
            half,
        }
    }

    /// From -1 to 1 along the node.
    fn along(&self, x: f64) -> f64 {
        if self.half > 0.0 {
            (x - self.middle) / self.half
        } else {
            0.0
        }
    }
}

/// What some data have added.
struct Table {
    /// At targets one by one.
    values: Vec<f64>,
    /// Polynomials on nodes, numbered as in a heap: the children of k are 2k and 2k + 1.
    nodes: Vec<[f64; MOST]>,
}

pub(super) struct Task<'a> {
    pub(super) sum: &'a KernelSum<1>,
    pub(super) places: &'a Places<'a>,
}

/// What is fixed while data are added.
struct Frame<'a, K> {
    kernel: K,
    sum: &'a KernelSum<1>,
    places: &'a Places<'a>,
    nodes: Vec<Node>,
    /// Leaves, a power of two.
    leaves: usize,
    /// K(u) = Σ right[k] uᵏ for u ≥ 0, and left for u ≤ 0; of a kernel that is a polynomial.
    pieces: Option<[[f64; MOST]; 2]>,
    kinked: bool,
}

impl Use for Task<'_> {
    type Output = Vec<f64>;

    fn with<K: Kernel>(self, kernel: K) -> Vec<f64> {
        let targets = self.places.sorted;
        let pieces = match kernel.form() {
            Form::Polynomial(c) => {
                let right: [f64; MOST] = std::array::from_fn(|k| c.get(k).copied().unwrap_or(0.0));
                let left = std::array::from_fn(|k| if k % 2 == 1 { -right[k] } else { right[k] });
                Some([right, left])
            }
            _ => None,
        };
        let leaves = if pieces.is_some() {
            targets.len().div_ceil(LEAF).next_power_of_two()
        } else {
            0
        };
        let mut nodes = vec![Node::default(); 2 * leaves];
        for (k, node) in nodes.iter_mut().enumerate().skip(1) {
            // how many leaves a node of this row of the heap has
            let span = LEAF * (leaves >> k.ilog2());
            let first = (k - (1 << k.ilog2())) * span;
            let end = (first + span).min(targets.len());
            *node = Node::around(targets.get(first.min(end)..end).unwrap_or_default());
        }
        let frame = Frame {
            kernel,
            sum: self.sum,
            places: self.places,
            nodes,
            leaves,
            kinked: pieces.is_some_and(|[right, left]| {
                right.iter().zip(left).any(|(r, l)| r.total_cmp(&l).is_ne())
            }),
            pieces,
        };
        frame.total()
    }
}

impl<K: Kernel> Frame<'_, K> {
    fn total(&self) -> Vec<f64> {
        let (n, m) = (self.sum.sample().len(), self.places.sorted.len());
        let bytes = 8 * m + 8 * MOST * self.nodes.len();
        let together = (BUDGET / bytes.max(1)).clamp(1, 64);
        let mut values = vec![Sum::default(); m];
        let mut nodes = vec![[Sum::default(); MOST]; self.nodes.len()];
        let chunks: Vec<usize> = (0..n).step_by(CHUNK).collect();
        // merged in the order of the data, for any number of threads
        for group in chunks.chunks(together) {
            let tables: Vec<Table> = group
                .par_iter()
                .map(|&start| self.table(start..(start + CHUNK).min(n)))
                .collect();
            for table in tables {
                for (sum, term) in values.iter_mut().zip(table.values) {
                    sum.add(term);
                }
                for (sums, terms) in nodes.iter_mut().zip(table.nodes) {
                    for (sum, term) in sums.iter_mut().zip(terms) {
                        sum.add(term);
                    }
                }
            }
        }
        let nodes = nodes.into_iter().map(|sums| sums.map(Sum::value)).collect();
        let values = values.into_iter().map(Sum::value).collect();
        self.handed_down(nodes, values)
    }

    fn table(&self, data: std::ops::Range<usize>) -> Table {
        let mut table = Table {
            values: vec![0.0; self.places.sorted.len()],
            nodes: vec![[0.0; MOST]; self.nodes.len()],
        };
        let sample = self.sum.sample();
        for i in data {
            let weight = sample.weight(i);
            if weight > 0.0 {
                let point = sample.coordinates()[i];
                let [h] = self.sum.bandwidth().between(i, [point]);
                self.add(&mut table, point, h, weight);
            }
        }
        table
    }

    fn add(&self, table: &mut Table, point: f64, h: f64, weight: f64) {
        let reach = if self.kernel.form() == Form::Gaussian {
            GAUSSIAN_REACH
        } else {
            1.0
        };
        // closed, and decided as the definition does
        let first = self
            .places
            .first(point - reach * h, |x| (x - point) / h >= -reach);
        let end = self
            .places
            .first(point + reach * h, |x| (x - point) / h > reach);
        if first >= end {
            return;
        }
        let factor = weight / h;
        match (self.pieces, self.kernel.form()) {
            (Some([right, left]), _) if self.kinked => {
                let middle = self.places.first(point, |x| x > point).clamp(first, end);
                self.piece(table, first..middle, (point, h, factor), &left);
                self.piece(table, middle..end, (point, h, factor), &right);
            }
            (Some([right, _]), _) => {
                self.piece(table, first..end, (point, h, factor), &right);
            }
            (None, Form::Gaussian) => self.bell(table, first..end, (point, h, factor)),
            _ => self.one_by_one(table, first..end, (point, h, factor)),
        }
    }

    /// By the definition.
    #[inline]
    fn one_by_one(
        &self,
        table: &mut Table,
        range: std::ops::Range<usize>,
        (point, h, factor): (f64, f64, f64),
    ) {
        let targets = &self.places.sorted[range.clone()];
        for (value, x) in table.values[range].iter_mut().zip(targets) {
            *value += factor * self.kernel.value((x - point) / h);
        }
    }

    /// A window, or the part of it on one side of a kink.
    fn piece(
        &self,
        table: &mut Table,
        range: std::ops::Range<usize>,
        bump: (f64, f64, f64),
        coefficients: &[f64; MOST],
    ) {
        let (mut low, mut high) = (range.start.div_ceil(LEAF), range.end / LEAF);
        // the last leaf of all may be short and yet whole
        if range.end == self.places.sorted.len() {
            high = range.end.div_ceil(LEAF);
        }
        if low >= high {
            self.one_by_one(table, range, bump);
            return;
        }
        self.one_by_one(table, range.start..low * LEAF, bump);
        self.one_by_one(table, (high * LEAF).min(range.end)..range.end, bump);
        low += self.leaves;
        high += self.leaves;
        while low < high {
            if low % 2 == 1 {
                self.cover(table, low, bump, coefficients);
                low += 1;
            }
            if high % 2 == 1 {
                high -= 1;
                self.cover(table, high, bump, coefficients);
            }
            low /= 2;
            high /= 2;
        }
    }

    /// Adds the Taylor coefficients of a bump about the middle of a node.
    #[inline]
    fn cover(
        &self,
        table: &mut Table,
        number: usize,
        (point, h, factor): (f64, f64, f64),
        coefficients: &[f64; MOST],
    ) {
        let node = &self.nodes[number];
        let taylor = shifted(coefficients, (node.middle - point) / h, node.half / h);
        for (sum, term) in table.nodes[number].iter_mut().zip(taylor) {
            *sum += factor * term;
        }
    }

    /// A Gaussian: on a grid φ(u + kδ) follows from two exponentials, φ(u) and exp(-uδ - δ²/2), which shrinks by exp(-δ²) a step.
    fn bell(
        &self,
        table: &mut Table,
        range: std::ops::Range<usize>,
        (point, h, factor): (f64, f64, f64),
    ) {
        let targets = self.places.sorted;
        let (first, last) = (targets[range.start], targets[range.end - 1]);
        let step = self
            .places
            .grid
            .map_or(f64::INFINITY, |grid| grid.width(0) / h);
        // how far the centres as they are rounded are from evenly spaced
        let uneven = f64::EPSILON * first.abs().max(last.abs()) / h;
        if range.len() < 6 || step > 1.0 || uneven > 1e-15 {
            self.one_by_one(table, range, (point, h, factor));
            return;
        }
        let shrink = (-step * step).exp();
        let mut start = range.start;
        while start < range.end {
            let end = (start + LEAF).min(range.end);
            let u = (targets[start] - point) / h;
            let mut value = factor * self.kernel.value(u);
            let mut ratio = (-step * (u + 0.5 * step)).exp();
            for sum in &mut table.values[start..end] {
                *sum += value;
                value *= ratio;
                ratio *= shrink;
            }
            start = end;
        }
    }

    /// Each node's polynomial to its children, and at the leaves to their targets.
    fn handed_down(&self, mut nodes: Vec<[f64; MOST]>, mut values: Vec<f64>) -> Vec<f64> {
        if self.leaves == 0 {
            return values;
        }
        for parent in 1..self.leaves {
            let above = self.nodes[parent];
            let polynomial = nodes[parent];
            if polynomial.iter().all(|c| *c == 0.0) {
                continue;
            }
            for child in [2 * parent, 2 * parent + 1] {
                let below = self.nodes[child];
                let scale = if above.half > 0.0 {
                    below.half / above.half
                } else {
                    0.0
                };
                let handed = shifted(&polynomial, above.along(below.middle), scale);
                for (sum, term) in nodes[child].iter_mut().zip(handed) {
                    *sum += term;
                }
            }
        }
        let targets = self.places.sorted.chunks(LEAF).zip(values.chunks_mut(LEAF));
        for (leaf, (targets, values)) in targets.enumerate() {
            let number = self.leaves + leaf;
            let (node, polynomial) = (self.nodes[number], &nodes[number]);
            for (x, value) in targets.iter().zip(values) {
                let s = node.along(*x);
                *value += polynomial.iter().rev().fold(0.0, |sum, c| sum * s + c);
            }
        }
        values
    }
}

/// The coefficients in s of the polynomial at y + scale · s.
#[inline]
fn shifted(coefficients: &[f64; MOST], y: f64, scale: f64) -> [f64; MOST] {
    let mut taylor = *coefficients;
    // dividing by (u - y) again and again leaves the Taylor coefficients at y
    for k in 0..MOST - 1 {
        for i in (k..MOST - 1).rev() {
            taylor[i] += y * taylor[i + 1];
        }
    }
    let mut power = 1.0;
    for c in &mut taylor {
        *c *= power;
        power *= scale;
    }
    taylor
}
