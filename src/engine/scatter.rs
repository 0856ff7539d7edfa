//! Widths that belong to the points: each datum adds its bump to the targets under it.
//!
//! The targets are sorted and cut into *leaves* of sixteen, over which a binary tree is laid. Where the kernel is a polynomial, the bump of a datum is one
//! polynomial over its whole window: the window is the union of a few leaves in part, whose targets are evaluated by the definition, and of O(log m)
//! nodes of the tree, each of which collects the Taylor coefficients of the bumps that cover it, about its own middle and in units of its own half
//! length. In the end the polynomials of the nodes are handed down to the leaves and evaluated. Nothing is subtracted: a polynomial is only ever used where
//! its bump is, so that narrow bumps beside wide ones cost no digits.
//!
//! The Gaussian and the cosine kernel, which are no polynomials, are evaluated target by target within their windows, the Gaussian up to nine
//! deviations and, on a grid, by a recurrence that starts anew every sixteen targets.

use super::bound::flatness;
use super::{Engine, Quote, Unsupported};
use crate::kernel::{Bandwidth, Form, Kernel, KernelSum, Shape, Use};
use crate::numeric::Sum;
use crate::space::{Domain, Evaluation, Field, Grid, Point, Targets};
use rayon::prelude::*;

/// Bumps added to sorted targets: exact sums on a line with any widths that do not depend on the target. O(n log m + m) for polynomial kernels, O(n · targets
/// in a window) for others, plus O(m) for every thousand data; memory for some numbers a target.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scatter;

/// Targets in a leaf: as many as can be evaluated in the time that a node takes.
const LEAF: usize = 16;

/// Data that are added into one table before it is merged into the total: bounds the rounding of long sums.
const CHUNK: usize = 1024;

/// Bytes of tables that are filled at the same time.
const BUDGET: usize = 64 << 20;

/// Beyond so many deviations the Gaussian is below 3e-18 of its peak.
const GAUSSIAN_REACH: f64 = 9.0;

/// The coefficients of the largest polynomial kernel, the triweight.
const MOST: usize = 7;

fn supported(sum: &KernelSum<1>) -> Result<(), Unsupported> {
    match sum.bandwidth() {
        Bandwidth::Fixed(_) | Bandwidth::PerPoint(_) => Ok(()),
        Bandwidth::PerTarget(_) => Err(Unsupported(
            "the bandwidth varies with the target".to_owned(),
        )),
    }
}

impl Engine<1> for Scatter {
    fn name(&self) -> &'static str {
        "scatter"
    }

    fn quote(
        &self,
        sum: &KernelSum<1>,
        targets: Targets<'_, 1>,
        _tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        supported(sum)?;
        let (n, m) = (sum.sample().len() as f64, targets.len() as f64);
        let spread = match targets {
            Targets::Grid(grid) => grid.high()[0] - grid.low()[0],
            Targets::Points(points) => {
                let (low, high) = points
                    .iter()
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &[x]| {
                        (low.min(x), high.max(x))
                    });
                high - low
            }
        };
        let reach = reach(sum.shape());
        let width = match sum.bandwidth() {
            Bandwidth::PerPoint(h) => {
                let step = h.len().div_ceil(1000);
                let some: Vec<f64> = h.iter().step_by(step).copied().collect();
                some.iter().sum::<f64>() / some.len() as f64
            }
            _ => sum.fixed_bandwidth().unwrap_or(1.0),
        };
        // targets under a bump, if they were spread evenly
        let under = (m * (2.0 * reach * width / spread).min(1.0)).max(1.0);
        let each = match sum.shape().form() {
            Form::Polynomial(_) => {
                60.0 + 3.0 * under.min(2.0 * LEAF as f64)
                    + 30.0 * (1.0 + under / LEAF as f64).log2()
            }
            Form::Gaussian => match targets {
                Targets::Grid(_) => 60.0 + 2.0 * under,
                Targets::Points(_) => 60.0 + 8.0 * under,
            },
            Form::Cosine => 40.0 + 12.0 * under,
        };
        let sorting = 60.0 * m;
        let tables = (n / CHUNK as f64).ceil() * 2.0 * m;
        Ok(Quote {
            error: error(sum.shape()),
            nanoseconds: 5_000.0 + each * n + sorting + tables,
        })
    }

    fn prepare(
        &self,
        sum: KernelSum<1>,
        _tolerance: f64,
    ) -> Result<Box<dyn Field<1>>, Unsupported> {
        supported(&sum)?;
        Ok(Box::new(Prepared(sum)))
    }
}

fn reach(shape: Shape) -> f64 {
    if shape == Shape::Gaussian {
        GAUSSIAN_REACH
    } else {
        1.0
    }
}

/// One rounding an addition, of terms whose coefficients exceed the kernel by at most 2ˢ = (1 + u²)ˢ where it is (1 - u²)ˢ; and a few for each level of the
/// tree, of which there are never forty. The recurrence of the Gaussian adds some LEAF²/2.
fn error(shape: Shape) -> f64 {
    let excess = match shape.form() {
        Form::Polynomial(_) => 2.0_f64.powi(flatness(shape)),
        _ => 1.0,
    };
    let levels = match shape.form() {
        Form::Polynomial(_) => 40.0,
        _ => (LEAF * LEAF) as f64,
    };
    0.5 * f64::EPSILON * excess * (CHUNK as f64 + levels)
}

struct Prepared(KernelSum<1>);

impl Field<1> for Prepared {
    fn domain(&self) -> &Domain<1> {
        self.0.domain()
    }

    fn at(&self, x: Point<1>) -> f64 {
        self.0.at(x)
    }

    fn evaluate(&self, targets: Targets<'_, 1>) -> Evaluation {
        let values = match targets {
            Targets::Grid(grid) => {
                let places: Vec<f64> = grid.centres().map(|[x]| x).collect();
                self.values(&Places {
                    sorted: &places,
                    grid: Some(grid),
                })
            }
            Targets::Points(points) => {
                let mut order: Vec<u32> = (0..points.len() as u32).collect();
                order.par_sort_by(|&a, &b| points[a as usize][0].total_cmp(&points[b as usize][0]));
                let sorted: Vec<f64> = order.iter().map(|&i| points[i as usize][0]).collect();
                let found = self.values(&Places {
                    sorted: &sorted,
                    grid: None,
                });
                let mut values = vec![0.0; points.len()];
                for (value, &i) in found.into_iter().zip(&order) {
                    values[i as usize] = value;
                }
                values
            }
        };
        Evaluation {
            // where a bump vanishes, rounding may fall below zero
            values: values
                .into_iter()
                .map(|v| if v < 0.0 { 0.0 } else { v })
                .collect(),
            error: error(self.0.shape()),
            engine: Some("scatter"),
            ..Evaluation::default()
        }
    }
}

impl Prepared {
    fn values(&self, places: &Places<'_>) -> Vec<f64> {
        let task = Task {
            sum: &self.0,
            places,
        };
        self.0.shape().apply(task)
    }
}

/// Targets in ascending order.
struct Places<'a> {
    sorted: &'a [f64],
    /// Whose centres they are, if they are.
    grid: Option<&'a Grid<1>>,
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

struct Task<'a> {
    sum: &'a KernelSum<1>,
    places: &'a Places<'a>,
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
            kinked: pieces.is_some_and(|[right, left]| right != left),
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
            if polynomial == [0.0; MOST] {
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::sample::Sample;

    /// Data with widths from a thousandth to a hundred times the usual, weights, ties and coarse numbers far from zero.
    fn sums(shape: Shape, offset: f64) -> KernelSum<1> {
        let n = 3000;
        let points = (0..n)
            .map(|i| {
                let x = (f64::from(i) * 0.618).fract() * 4.0 - 2.0;
                [if i % 5 == 0 {
                    (x * 8.0).round() / 8.0
                } else {
                    x
                } + offset]
            })
            .collect();
        let weights = (0..n).map(|i| f64::from(i % 4)).collect();
        let widths: Vec<f64> = (0..n)
            .map(|i| match i % 50 {
                0 => 30.0,
                1 => 3e-4,
                k => 0.02 * f64::from(k),
            })
            .collect();
        let sample = Sample::normalised(points, weights, Domain::whole()).unwrap();
        KernelSum::new(sample, shape, Bandwidth::PerPoint(widths.into())).unwrap()
    }

    #[test]
    fn bumps_of_all_widths_sum_to_the_definition() {
        for shape in Shape::ALL {
            for offset in [0.0, 1e9] {
                let sum = sums(shape, offset);
                let Bandwidth::PerPoint(widths) = sum.bandwidth() else {
                    unreachable!("made so")
                };
                // all points at one place
                let ceiling: f64 = (0..widths.len())
                    .map(|i| sum.sample().weight(i) * shape.peak() / widths[i])
                    .sum();
                let field = Scatter.prepare(sum.clone(), 0.0).unwrap();
                for cells in [1, 15, 16, 17, 100, 513, 2000] {
                    let grid = Grid::new([offset - 3.0], [offset + 2.5], [cells]).unwrap();
                    let mut scattered: Vec<Point<1>> = grid.centres().collect();
                    scattered.reverse();
                    scattered.push([offset + 0.125]);
                    scattered.push([offset + 1e6]);
                    for targets in [Targets::Grid(&grid), Targets::Points(&scattered)] {
                        let found = field.evaluate(targets);
                        assert!(found.error <= crate::engine::EXACT);
                        for (x, value) in targets.places().zip(&found.values) {
                            let exact = sum.at(x);
                            assert!(
                                (value - exact).abs() <= found.error * ceiling,
                                "{shape}, {cells} cells, at {x:?}: {value} {exact}"
                            );
                            if exact == 0.0 {
                                assert!(value.abs() <= 3e-18 * ceiling, "{shape} at {x:?}");
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn bits_do_not_depend_on_threads() {
        let grid = Grid::new([-3.0], [3.0], [777]).unwrap();
        for shape in [Shape::Biweight, Shape::Gaussian] {
            let bits = |threads: usize| -> Vec<u64> {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .unwrap();
                pool.install(|| {
                    let field = Scatter.prepare(sums(shape, 0.0), 0.0).unwrap();
                    let found = field.evaluate(Targets::Grid(&grid));
                    found.values.iter().map(|v| v.to_bits()).collect()
                })
            };
            assert_eq!(bits(1), bits(3));
        }
    }
}
