//! Sums of a compact kernel and of its convolution with itself over all pairs of data.
//!
//! The data are sorted once. For a bandwidth they are cut into cells of that width; the partners of a datum on its left are then the beginning of its own
//! cell, the end and the beginning of the one before, and the end of the one before that. As the datum moves through its cell, each of these four
//! runs only ever grows, in one direction or the other, so that running moments suffice: nothing is stored, nothing is subtracted.

use super::super::basis::{Basis, Powers, Side};
use super::convolution::{Coefficients, Pieces, degree};
use crate::kernel::{Kernel, Shape};
use crate::numeric::Sum;
use crate::sample::Sample;
use rayon::prelude::*;

/// Σᵢⱼ wᵢwⱼ [(K∗K)((Xᵢ - Xⱼ)/h) + factor · K((Xᵢ - Xⱼ)/h)] for a compact kernel, with Σw = 1 and i = j included.
///
/// Exact to rounding (about 1e-12 of the sum of the sizes). O(n log n) once, then O(n) a bandwidth, whatever the bandwidth.
pub struct CompactPairs {
    points: Vec<f64>,
    weights: Vec<f64>,
    /// Σw².
    squares: f64,
    shape: Shape,
    sums: Box<dyn Sums>,
}

/// The sums for one number of coefficients.
trait Sums: Send + Sync {
    fn beside(&self, pairs: &CompactPairs, h: f64, factor: f64) -> f64;
}

impl CompactPairs {
    /// The pairs of `sample` under the kernel `shape`; `None` for a kernel on the whole line. O(n log n).
    pub fn new(sample: &Sample<1>, shape: Shape) -> Option<Self> {
        let sums: Box<dyn Sums> = match (shape, degree(shape)) {
            (Shape::Gaussian, _) => return None,
            (_, 1) => Box::new(Coefficients::<2>::new(shape)),
            (_, 3) => Box::new(Coefficients::<4>::new(shape)),
            (_, 5) => Box::new(Coefficients::<6>::new(shape)),
            (_, 9) => Box::new(Coefficients::<10>::new(shape)),
            (_, 13) => Box::new(Coefficients::<14>::new(shape)),
            _ => Box::new(Coefficients::<16>::new(shape)),
        };
        let mass = sample.mass();
        let mut pairs: Vec<(f64, f64)> = sample
            .coordinates()
            .iter()
            .enumerate()
            .map(|(i, &x)| (x, sample.weight(i) / mass))
            .collect();
        pairs.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let (points, weights): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let squares = weights.iter().map(|w| w * w).collect::<Sum>().value();
        Some(Self {
            points,
            weights,
            squares,
            shape,
            sums,
        })
    }

    /// The sum at `h`.
    ///
    /// # Panics
    /// If `h` is not positive and finite.
    pub fn sum(&self, h: f64, factor: f64) -> f64 {
        assert!(h > 0.0 && h.is_finite(), "a width is positive and finite");
        let own = self.shape.roughness() + factor * self.shape.peak();
        self.squares * own + 2.0 * self.sums.beside(self, h, factor)
    }

    /// The cells of width `h` that hold data: where each begins among the data, and its number. A number for the end of the data at the end.
    ///
    /// Numbers count from the first datum after each gap that no pair reaches across, so that data far away cost no digits.
    fn cells(&self, h: f64) -> Vec<(usize, f64)> {
        let (mut anchor, mut base) = (self.points[0], 0.0);
        let mut before = anchor;
        let mut cells = vec![(0, 0.0)];
        let mut last = 0.0;
        for (i, &x) in self.points.iter().enumerate() {
            if (x - before) / h > 2.5 {
                (anchor, base) = (x, last + 4.0);
            }
            before = x;
            let number = base + ((x - anchor) / h).floor();
            if number > last {
                cells.push((i, number));
                last = number;
            }
        }
        cells.push((self.points.len(), f64::INFINITY));
        cells
    }
}

/// Cells that one task sums.
const TASK: usize = 64;

impl<const N: usize> Sums for Coefficients<N> {
    fn beside(&self, pairs: &CompactPairs, h: f64, factor: f64) -> f64 {
        let pieces = self.pieces(factor);
        let cells = pairs.cells(h);
        let count = cells.len() - 1;
        let sums: Vec<Sum> = (0..count.div_ceil(TASK))
            .into_par_iter()
            .map(|task| {
                (task * TASK..((task + 1) * TASK).min(count))
                    .map(|cell| in_cell(pairs, &pieces, &cells, cell, h))
                    .collect()
            })
            .collect();
        let mut total = Sum::default();
        for sum in sums {
            total.merge(sum);
        }
        total.value()
    }
}

/// A cell as the data see it: their positions within it are in units of h from its middle.
#[derive(Clone, Copy)]
struct Cell<'a> {
    points: &'a [f64],
    weights: &'a [f64],
    centre: f64,
}

impl<'a> Cell<'a> {
    fn new(pairs: &'a CompactPairs, cells: &[(usize, f64)], cell: usize) -> Self {
        let range = cells[cell].0..cells[cell + 1].0;
        let points = &pairs.points[range.clone()];
        Self {
            points,
            weights: &pairs.weights[range],
            centre: 0.5 * points[0] + 0.5 * points[points.len() - 1],
        }
    }
}

/// A run of data at one end of a cell that grows as the datum moves.
struct Run<'a, const N: usize> {
    cell: Cell<'a>,
    basis: Powers<N>,
    moments: [f64; N],
    count: usize,
}

impl<'a, const N: usize> Run<'a, N> {
    fn new(cell: Cell<'a>, basis: Powers<N>) -> Self {
        Self {
            cell,
            basis,
            moments: [0.0; N],
            count: 0,
        }
    }

    #[inline]
    fn add(&mut self, i: usize, h: f64) {
        let row = self.basis.at((self.cell.points[i] - self.cell.centre) / h);
        let weight = self.cell.weights[i];
        for k in 0..N {
            self.moments[k] += weight * row[k];
        }
        self.count += 1;
    }

    /// Takes in data from the left as long as `inside` says so of their distance from `x`.
    #[inline]
    fn grow_from_left(&mut self, x: f64, h: f64, inside: impl Fn(f64) -> bool) {
        while self.count < self.cell.points.len() && inside((x - self.cell.points[self.count]) / h)
        {
            self.add(self.count, h);
        }
    }

    /// The same from the right.
    #[inline]
    fn grow_from_right(&mut self, x: f64, h: f64, inside: impl Fn(f64) -> bool) {
        let points = self.cell.points;
        while self.count < points.len() && inside((x - points[points.len() - 1 - self.count]) / h) {
            self.add(points.len() - 1 - self.count, h);
        }
    }

    #[inline]
    fn value(&self, x: f64, h: f64) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        let y = (x - self.cell.centre) / h;
        self.basis.value(&self.moments, y, Side::Right)
    }
}

/// Σ over the data of one cell and their partners on the left, each pair once.
fn in_cell<const N: usize>(
    pairs: &CompactPairs,
    pieces: &Pieces<N>,
    cells: &[(usize, f64)],
    cell: usize,
    h: f64,
) -> f64 {
    let here = Cell::new(pairs, cells, cell);
    let number = cells[cell].1;
    // neighbours by number; a gap in the numbers is a gap in the data
    let back = |steps: u8| {
        (1..=2)
            .filter_map(|k| cell.checked_sub(k))
            .find(|&other| (number - cells[other].1 - f64::from(steps)).abs() < 0.5)
            .map(|other| Cell::new(pairs, cells, other))
    };
    let (one, two) = (back(1), back(2));
    let mut total = 0.0;
    // what grows while the datum moves to the right: the data before it in its cell, and those more than h away in the cell before
    let mut own = Run::new(here, pieces.near);
    let mut beyond = one.map(|cell| Run::new(cell, pieces.far));
    for (i, (&x, w)) in here.points.iter().zip(here.weights).enumerate() {
        let mut near = own.value(x, h);
        own.add(i, h);
        if let Some(run) = &mut beyond {
            run.grow_from_left(x, h, |u| u > 1.0);
            near += run.value(x, h);
        }
        total += w * near;
    }
    // what grows while it moves to the left
    let mut within = one.map(|cell| Run::new(cell, pieces.near));
    let mut last = two.map(|cell| Run::new(cell, pieces.far));
    if within.is_some() || last.is_some() {
        for (&x, w) in here.points.iter().zip(here.weights).rev() {
            let mut near = 0.0;
            if let Some(run) = &mut within {
                run.grow_from_right(x, h, |u| u <= 1.0);
                near += run.value(x, h);
            }
            if let Some(run) = &mut last {
                run.grow_from_right(x, h, |u| u <= 2.0);
                near += run.value(x, h);
            }
            total += w * near;
        }
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::{GaussLegendre, panels};
    use crate::sample::Weights;
    use crate::space::Domain;

    fn sample(points: &[f64], weights: Option<&[f64]>) -> Sample<1> {
        let points = points.iter().map(|&x| [x]).collect();
        match weights {
            None => Sample::equal(points, Domain::whole()),
            Some(w) => Sample::new(points, Weights::Each(w.to_vec().into()), Domain::whole()),
        }
        .expect("legal")
    }

    fn judge(points: &[f64], weights: Option<&[f64]>, shape: Shape, h: f64, factor: f64) -> f64 {
        let quadrature = GaussLegendre::new(16);
        let convolution = |u: f64| {
            if u >= 2.0 {
                return 0.0;
            }
            quadrature.integrate_panels(
                |t| shape.value(t) * shape.value(u - t),
                &panels(u - 1.0, 1.0, [0.0, u], 1.0),
            )
        };
        let mass = weights.map_or(points.len() as f64, |w| w.iter().sum());
        let weight = |i: usize| weights.map_or(1.0, |w| w[i]) / mass;
        let mut sum = Sum::default();
        for (i, x) in points.iter().enumerate() {
            for (j, y) in points.iter().enumerate() {
                let u = ((x - y) / h).abs();
                sum.add(weight(i) * weight(j) * (convolution(u) + factor * shape.value(u)));
            }
        }
        sum.value()
    }

    #[test]
    fn sums_are_those_of_the_definition() {
        let points: Vec<f64> = (0..150)
            .map(|i| {
                let u = (f64::from(i) * 0.618_033_988_749_895).fract();
                (6.0 * u).sin() + 3.0 * u * u
            })
            .collect();
        let weights: Vec<f64> = points.iter().map(|x| 5.0 * x * x).collect();
        let tied: Vec<f64> = points.iter().map(|x| (x * 8.0).round() / 8.0).collect();
        let far: Vec<f64> = points.iter().map(|x| x + 1e5).collect();
        let mut outliers = points.clone();
        outliers.extend([1e9, -1e20, 1e300, 1.000_000_000_000_1e300]);
        for shape in Shape::ALL {
            if shape == Shape::Gaussian {
                assert!(CompactPairs::new(&sample(&points, None), shape).is_none());
                continue;
            }
            for (points, weights) in [
                (&points, None),
                (&points, Some(&weights[..])),
                (&tied, None),
                (&far, None),
                (&outliers, None),
            ] {
                let pairs = CompactPairs::new(&sample(points, weights), shape).expect("compact");
                for h in [0.011, 0.25, 0.7, 3.0, 50.0] {
                    for factor in [0.0, -2.0] {
                        let exact = judge(points, weights, shape, h, factor);
                        let got = pairs.sum(h, factor);
                        assert!(
                            (got - exact).abs() < 2e-12,
                            "{shape} {h} {factor}: {got} {exact}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn threads_do_not_change_a_bit() {
        let points: Vec<f64> = (0..40_000)
            .map(|i| (f64::from(i) * 0.618_034).fract())
            .collect();
        let pairs = CompactPairs::new(&sample(&points, None), Shape::Biweight).expect("compact");
        let run = |threads| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("threads")
                .install(|| pairs.sum(0.001, -2.0).to_bits())
        };
        assert_eq!(run(1), run(3));
    }
}
