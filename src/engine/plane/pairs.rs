//! Sums over all pairs of data in the plane, of which the criterion of least-squares cross-validation is made.

use super::overlap::Overlap;
use crate::kernel::{Shape, Symmetry};
use crate::numeric::{Sum, forward_transform, inverse_transform};
use crate::sample::Sample;
use crate::space::Point;
use rayon::prelude::*;
use realfft::num_complex::Complex;
use std::sync::OnceLock;

/// Nodes on an axis of the lattices, coarse to fine.
const NODES: [usize; 4] = [128, 256, 512, 1024];

/// A lattice serves bandwidths of at least this many distances between nodes.
const FINE: f64 = 8.0;

/// Data whose pairs are summed at one go.
const BLOCK: usize = 64;

/// Σᵢⱼ wᵢwⱼ [(K∗K)(Xᵢ - Xⱼ; h) + factor · K(Xᵢ - Xⱼ; h)], with Σw = 1 and i = j included, for a kernel of unit width stretched by h on each axis (not divided by h₁h₂).
///
/// | way | error | cost at one bandwidth |
/// |---|---|---|
/// | [`PlanePairs::sum`] | 1e-11 of the sum of the sizes, from the tables of K∗K | n × (data within 2h on the first axis) |
/// | [`PlanePairs::glance`] | 1e-6 to 1e-4, see there | the lags within 2h, whatever n |
pub struct PlanePairs {
    /// In the order of the first axis.
    points: Vec<Point<2>>,
    weights: Vec<f64>,
    /// Σw².
    squares: f64,
    overlap: Overlap,
    height: f64,
    peak: f64,
    low: Point<2>,
    extent: [f64; 2],
    lattices: [OnceLock<Lattice>; NODES.len()],
}

impl PlanePairs {
    /// The pairs of `sample` under a kernel. O(n log n).
    pub fn new(sample: &Sample<2>, shape: Shape, symmetry: Symmetry) -> Self {
        let mass = sample.mass();
        let mut data: Vec<(Point<2>, f64)> = sample
            .points()
            .iter()
            .enumerate()
            .map(|(i, &x)| (x, sample.weight(i) / mass))
            .filter(|&(_, w)| w > 0.0)
            .collect();
        data.par_sort_unstable_by(|a, b| {
            let key = |it: &(Point<2>, f64)| [it.0[0], it.0[1], it.1];
            let (a, b) = (key(a), key(b));
            (a[0].total_cmp(&b[0]))
                .then(a[1].total_cmp(&b[1]))
                .then(a[2].total_cmp(&b[2]))
        });
        let (points, weights): (Vec<Point<2>>, Vec<f64>) = data.into_iter().unzip();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for x in &points {
            for axis in 0..2 {
                low[axis] = low[axis].min(x[axis]);
                high[axis] = high[axis].max(x[axis]);
            }
        }
        Self {
            squares: weights.iter().map(|w| w * w).collect::<Sum>().value(),
            overlap: Overlap::new(shape, symmetry),
            height: symmetry.roughness::<2>(shape),
            peak: symmetry.peak::<2>(shape),
            extent: [high[0] - low[0], high[1] - low[1]],
            points,
            weights,
            low,
            lattices: [const { OnceLock::new() }; NODES.len()],
        }
    }

    /// Data of positive weight.
    pub fn count(&self) -> usize {
        self.points.len()
    }

    /// Σw² for Σw = 1: what the pairs i = j weigh.
    pub fn squares(&self) -> f64 {
        self.squares
    }

    /// K(0), what each pair i = j adds of the kernel itself.
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// The sum at widths `h`, pair by pair.
    pub fn sum(&self, h: [f64; 2], factor: f64) -> f64 {
        let reach = self.overlap.reach();
        let far = reach * h[0];
        let blocks: Vec<f64> = (0..self.points.len().div_ceil(BLOCK))
            .into_par_iter()
            .map(|block| {
                let mut total = Sum::default();
                let range = block * BLOCK..((block + 1) * BLOCK).min(self.points.len());
                for i in range {
                    let x = self.points[i];
                    let mut own = 0.0;
                    for (j, y) in self.points.iter().enumerate().skip(i + 1) {
                        let along = y[0] - x[0];
                        if along > far {
                            break;
                        }
                        let (u, v) = (along / h[0], (y[1] - x[1]) / h[1]);
                        if v.abs() <= reach {
                            let value = self.overlap.at(u, v) + factor * self.overlap.kernel(u, v);
                            own += self.weights[j] * value;
                        }
                    }
                    total.add(self.weights[i] * own);
                }
                total.value()
            })
            .collect();
        let others = blocks.into_iter().collect::<Sum>().value();
        self.squares
            .mul_add(self.height + factor * self.peak, 2.0 * others)
    }

    /// How many distances between nodes of the finest lattice there are to the narrower of the widths `h`: below `FINE` the glance is coarse.
    pub fn resolution(&self, h: [f64; 2]) -> f64 {
        self.finest_of(h, NODES.len() - 1)
    }

    /// The same sum from masses shared among the nodes of a lattice: each datum gives its weight to the 16 nodes about it such that cubic polynomials are summed exactly, and pairs
    /// of nodes are counted by their distance with one transform. The lattice is chosen so that the narrower width spans 8 to 16 distances between nodes; a smooth
    /// kernel is then off by some 1e-6 of the sum, one with a kink at its edge by some 1e-4; more where the finest lattice is too coarse (see [`PlanePairs::resolution`]). O(nodes²) once for each of four
    /// lattices, then a bandwidth costs as many steps as there are lags within its reach.
    pub fn glance(&self, h: [f64; 2], factor: f64) -> f64 {
        let level = (0..NODES.len())
            .find(|&level| self.finest_of(h, level) >= FINE)
            .unwrap_or(NODES.len() - 1);
        let lattice = self.lattices[level].get_or_init(|| self.lattice(NODES[level]));
        let others = lattice.sum(&self.overlap, h, factor);
        self.squares
            .mul_add(self.height + factor * self.peak, others)
    }

    fn step(&self, axis: usize, nodes: usize) -> f64 {
        // one interval beyond the data on either side for the four nodes of each datum
        let step = self.extent[axis] / (nodes - 4) as f64;
        if step > 0.0 { step } else { 1.0 }
    }

    fn finest_of(&self, h: [f64; 2], level: usize) -> f64 {
        (0..2)
            .filter(|&axis| self.extent[axis] > 0.0)
            .map(|axis| h[axis] / self.step(axis, NODES[level]))
            .fold(f64::INFINITY, f64::min)
    }

    /// The masses of all lags on a lattice of `nodes` × `nodes`.
    fn lattice(&self, nodes: usize) -> Lattice {
        let step = [self.step(0, nodes), self.step(1, nodes)];
        let mut mass = vec![0.0; nodes * nodes];
        // what a datum makes of itself on the lattice, lag by lag: taken out again, since i = j is counted exactly
        let mut own = [[0.0; 4]; 4];
        for (x, &w) in self.points.iter().zip(&self.weights) {
            let mut shares = [[0.0; 4]; 2];
            let mut first = [0; 2];
            for axis in 0..2 {
                let t = (x[axis] - self.low[axis]) / step[axis];
                let cell = (t.floor().max(0.0) as usize).min(nodes - 4);
                first[axis] = cell;
                shares[axis] = cubic(t - cell as f64);
            }
            for (i, a) in shares[0].iter().enumerate() {
                let row = (first[0] + i) * nodes + first[1];
                for (j, b) in shares[1].iter().enumerate() {
                    mass[row + j] += w * a * b;
                }
            }
            let lags = shares.map(|s| {
                std::array::from_fn::<f64, 4, _>(|l| (0..4 - l).map(|i| s[i] * s[i + l]).sum())
            });
            for (i, a) in lags[0].iter().enumerate() {
                for (j, b) in lags[1].iter().enumerate() {
                    own[i][j] += w * w * a * b;
                }
            }
        }
        Lattice::new(nodes, step, &mass, own)
    }
}

/// The weights of the nodes -1, 0, 1, 2 (here numbered from 0) for a place at `t` beyond node 0: Lagrange's through four nodes.
fn cubic(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

/// How much mass times mass is how far apart.
struct Lattice {
    nodes: usize,
    step: [f64; 2],
    /// The transforms of the rows of masses, zero beyond them.
    spectra: Vec<Vec<Complex<f64>>>,
    own: [[f64; 4]; 4],
    /// By lag on the first axis: Σ of the products of masses that lag, and the lag on the second axis from 0 to nodes - 1 and from there backwards, as a transform gives them.
    rows: Vec<OnceLock<Vec<f64>>>,
}

impl Lattice {
    fn new(nodes: usize, step: [f64; 2], mass: &[f64], own: [[f64; 4]; 4]) -> Self {
        let transform = forward_transform(2 * nodes);
        let spectra = mass
            .par_chunks(nodes)
            .map(|row| {
                let mut padded = row.to_vec();
                padded.resize(2 * nodes, 0.0);
                let mut spectrum = transform.make_output_vec();
                transform
                    .process(&mut padded, &mut spectrum)
                    .expect("the lengths are those of the plan");
                spectrum
            })
            .collect();
        Self {
            nodes,
            step,
            spectra,
            own,
            rows: (0..nodes).map(|_| OnceLock::new()).collect(),
        }
    }

    /// The masses at one lag on the first axis, by lag on the second.
    fn row(&self, lag: usize) -> &[f64] {
        self.rows[lag].get_or_init(|| {
            let nodes = self.nodes;
            let mut product = vec![Complex::new(0.0, 0.0); nodes + 1];
            for (a, b) in self.spectra.iter().zip(&self.spectra[lag..]) {
                for (sum, (a, b)) in product.iter_mut().zip(a.iter().zip(b)) {
                    *sum += a.conj() * b;
                }
            }
            // rounding leaves an imaginary part where a real signal has none
            for end in [0, nodes] {
                product[end].im = 0.0;
            }
            let back = inverse_transform(2 * nodes);
            let mut masses = back.make_output_vec();
            back.process(&mut product, &mut masses)
                .expect("the lengths are those of the plan");
            for mass in &mut masses {
                *mass /= 2.0 * nodes as f64;
            }
            masses
        })
    }

    /// The sum over pairs i ≠ j.
    fn sum(&self, overlap: &Overlap, h: [f64; 2], factor: f64) -> f64 {
        // e^(-9.5²/4) = 1.6e-10 is below what the lattice is good to
        let reach = overlap.reach().min(9.5);
        let most = [0, 1].map(|axis| {
            ((reach * h[axis] / self.step[axis]).min(1e9) as usize).min(self.nodes - 1)
        });
        let rows: Vec<f64> = (0..=most[0])
            .into_par_iter()
            .map(|i| {
                let row = self.row(i);
                let u = i as f64 * self.step[0] / h[0];
                let mut total = Sum::default();
                for j in 0..=most[1] {
                    let v = j as f64 * self.step[1] / h[1];
                    // both signs of the second lag
                    let both = if j == 0 {
                        row[0]
                    } else {
                        row[j] + row[2 * self.nodes - j]
                    };
                    let own = if i < 4 && j < 4 {
                        self.own[i][j] * if j == 0 { 1.0 } else { 2.0 }
                    } else {
                        0.0
                    };
                    let mass = both - own;
                    if mass != 0.0 {
                        total.add(mass * (overlap.at(u, v) + factor * overlap.kernel(u, v)));
                    }
                }
                // both signs of the first
                total.value() * if i == 0 { 1.0 } else { 2.0 }
            })
            .collect();
        rows.into_iter().collect::<Sum>().value()
    }
}
