//! Series in the plane: products of the functions of two axes.

use super::terms::{chosen, risk};
use super::{Length, Terms};
use crate::estimator::{Estimate, FitError};
use crate::numeric::Sum;
use crate::numeric::orthogonal::{Basis, Placed};
use crate::sample::Sample;
use crate::space::{Domain, Evaluation, Field, Point, Targets, Warning};
use rayon::prelude::*;
use std::sync::Arc;

/// Data and targets handled by one task: fixed, so that sums do not depend on the number of threads.
const BLOCK: usize = 1024;

/// The most terms an axis that cross-validation looks at.
const MOST: usize = 40;

/// f̂(x, y) = Σⱼ Σₖ λⱼ λₖ ĉⱼₖ ψⱼ(x) ψₖ(y), as many terms on one axis as on the other.
struct Fitted<B> {
    placed: [Placed<B>; 2],
    /// ĉⱼₖ with its tapers, k fastest.
    coefficients: Vec<f64>,
    terms: usize,
    /// Whether the sum is nowhere negative but for rounding.
    positive: bool,
    domain: Domain<2>,
}

impl<B: Basis> Fitted<B> {
    /// Σⱼ aⱼ Σₖ cⱼₖ bₖ, the inner sums given.
    fn value(&self, a: impl Iterator<Item = f64>, inner: impl Fn(usize) -> f64) -> f64 {
        let sum: f64 = a.enumerate().map(|(j, a)| a * inner(j)).sum();
        if self.positive && sum < 0.0 { 0.0 } else { sum }
    }

    fn inner(&self, j: usize, b: impl Iterator<Item = f64>) -> f64 {
        let functions = B::functions(self.terms);
        self.coefficients[j * functions..(j + 1) * functions]
            .iter()
            .zip(b)
            .map(|(c, b)| c * b)
            .sum()
    }
}

impl<B: Basis> Field<2> for Fitted<B> {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, [x, y]: Point<2>) -> f64 {
        let a = self.placed[0].at(x, self.terms);
        let b = self.placed[1].at(y, self.terms);
        self.value(a.iter().copied(), |j| self.inner(j, b.iter().copied()))
    }

    fn evaluate(&self, targets: Targets<'_, 2>) -> Evaluation {
        let functions = B::functions(self.terms);
        let values = match targets {
            Targets::Grid(grid) => {
                // the sums over k are shared by all cells of a column
                let [nx, ny] = grid.cells();
                let along = |axis: usize, n: usize| -> Vec<f64> {
                    (0..n).map(|i| grid.coordinate(axis, i)).collect()
                };
                let a = self.placed[0].table(&along(0, nx), self.terms);
                let b = self.placed[1].table(&along(1, ny), self.terms);
                let inner: Vec<f64> = (0..functions * ny)
                    .map(|at| {
                        let (j, iy) = (at / ny, at % ny);
                        self.inner(j, (0..functions).map(|k| b[k * ny + iy]))
                    })
                    .collect();
                (0..nx)
                    .into_par_iter()
                    .flat_map_iter(|ix| {
                        let (a, inner) = (&a, &inner);
                        (0..ny).map(move |iy| {
                            let row = (0..functions).map(|j| a[j * nx + ix]);
                            self.value(row, |j| inner[j * ny + iy])
                        })
                    })
                    .collect()
            }
            Targets::Points(points) => points
                .par_chunks(BLOCK)
                .flat_map_iter(|points| {
                    let n = points.len();
                    let axis =
                        |axis: usize| -> Vec<f64> { points.iter().map(|x| x[axis]).collect() };
                    let a = self.placed[0].table(&axis(0), self.terms);
                    let b = self.placed[1].table(&axis(1), self.terms);
                    (0..n).map(move |i| {
                        let row = (0..functions).map(|j| a[j * n + i]);
                        self.value(row, |j| self.inner(j, (0..functions).map(|k| b[k * n + i])))
                    })
                })
                .collect(),
        };
        Evaluation {
            values,
            error: f64::EPSILON * functions.max(16).pow(2) as f64,
            ..Evaluation::default()
        }
    }
}

/// Σ w ψⱼ(X) ψₖ(Y) and, if asked for, Σ w ψⱼ(X)² ψₖ(Y)². O(n J²).
fn project<B: Basis>(
    sample: &Sample<2>,
    placed: &[Placed<B>; 2],
    terms: usize,
    squares: bool,
) -> [Vec<f64>; 2] {
    let functions = B::functions(terms);
    let count = functions * functions;
    let blocks: Vec<[Vec<f64>; 2]> = sample
        .points()
        .par_chunks(BLOCK)
        .enumerate()
        .map(|(block, points)| {
            let n = points.len();
            let axis = |axis: usize| -> Vec<f64> { points.iter().map(|x| x[axis]).collect() };
            let a = placed[0].table(&axis(0), terms);
            let b = placed[1].table(&axis(1), terms);
            let w: Vec<f64> = (0..n).map(|i| sample.weight(block * BLOCK + i)).collect();
            let mut sums = [vec![0.0; count], vec![0.0; if squares { count } else { 0 }]];
            for j in 0..functions {
                let weighed: Vec<f64> = w.iter().zip(&a[j * n..]).map(|(w, a)| w * a).collect();
                for k in 0..functions {
                    let rows = weighed.iter().zip(&a[j * n..]).zip(&b[k * n..]);
                    let (mut first, mut second) = (0.0, 0.0);
                    for ((wa, a), b) in rows {
                        first += wa * b;
                        second += wa * a * b * b;
                    }
                    sums[0][j * functions + k] = first;
                    if squares {
                        sums[1][j * functions + k] = second;
                    }
                }
            }
            sums
        })
        .collect();
    [0, 1].map(|which: usize| {
        let mut totals = vec![Sum::default(); blocks.first().map_or(0, |block| block[which].len())];
        for block in &blocks {
            for (total, term) in totals.iter_mut().zip(&block[which]) {
                total.add(*term);
            }
        }
        totals.into_iter().map(Sum::value).collect()
    })
}

/// The series of the total and of each channel, with the number of terms chosen from the total.
pub(super) fn fit<B: Basis>(
    sample: &Sample<2>,
    placed: [Placed<B>; 2],
    length: Length,
    positive: bool,
    mut warnings: Vec<Warning>,
) -> Result<Estimate<2>, FitError> {
    let terms = match length.terms {
        Terms::Number(terms) => terms,
        Terms::CrossValidation => {
            let n = sample.effective_size();
            let most = ((6.0 + 4.0 * n.powf(0.25)) as usize).min(MOST);
            let functions = B::functions(most);
            let [sums, squares] = project(sample, &placed, most, true);
            let mass = sample.mass();
            let (terms, more) = chosen(n, most, |terms| {
                let inside = (0..functions * functions)
                    .map(|at| (at, [at / functions, at % functions].map(B::degree)))
                    .filter(|(_, degrees)| degrees.iter().all(|degree| *degree < terms));
                let pairs = inside.map(|(at, degrees)| {
                    let weight: f64 = degrees
                        .iter()
                        .map(|degree| length.taper.weight(*degree, terms))
                        .product();
                    (weight, sums[at] / mass, squares[at] / mass)
                });
                risk(pairs, n)
            })?;
            warnings.extend(more);
            terms
        }
    };
    let functions = B::functions(terms);
    let field = |sample: &Sample<2>| -> Arc<dyn Field<2>> {
        let [mut coefficients, _] = project(sample, &placed, terms, false);
        for (at, c) in coefficients.iter_mut().enumerate() {
            for index in [at / functions, at % functions] {
                *c *= length.taper.weight(B::degree(index), terms);
            }
        }
        Arc::new(Fitted {
            placed,
            coefficients,
            terms,
            positive,
            domain: sample.domain().clone(),
        })
    };
    let mut estimate = Estimate::new(field(sample)).with_channels(
        (0..sample.channels())
            .map(|c| field(&sample.channel(c)))
            .collect(),
    );
    estimate.smoothing = Some(terms as f64);
    estimate.warnings = warnings;
    Ok(estimate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::orthogonal::{Cosine, Fourier, Legendre};
    use crate::space::Grid;
    use crate::theory::Taper;

    fn sample() -> Sample<2> {
        let points = (0..2100)
            .map(|i| {
                let x = (f64::from(i) * 0.618).fract();
                [1.0 + x.sqrt(), 3.0 * (f64::from(i) * 0.414).fract() * x]
            })
            .collect();
        let weights = (0..2100).map(|i| f64::from(i % 3)).collect();
        let domain = Domain::walled([1.0, 0.0], [2.0, 3.0]).expect("legal");
        Sample::normalised(points, weights, domain).expect("legal")
    }

    fn check<B: Basis>(taper: Taper, terms: usize, positive: bool) {
        let sample = sample();
        let placed = [Placed::<B>::between(1.0, 2.0), Placed::between(0.0, 3.0)];
        let length = Length {
            terms: Terms::Number(terms),
            taper,
        };
        let estimate = fit(&sample, placed, length, positive, Vec::new()).expect("legal");
        let grid = Grid::new([0.9, -0.2], [2.1, 3.1], [13, 17]).expect("small");
        let places: Vec<Point<2>> = grid.centres().collect();
        let on_grid = estimate.evaluate(Targets::Grid(&grid)).values;
        let at_points = estimate.evaluate(Targets::Points(&places)).values;
        for (i, [x, y]) in places.iter().enumerate() {
            // the definition: a sum over data of products of the two kernels
            let kernel = |axis: usize, x: f64, point: f64| -> f64 {
                let rows = placed[axis].at(x, terms);
                let data = placed[axis].at(point, terms);
                (0..rows.len())
                    .map(|k| taper.weight(B::degree(k), terms) * rows[k] * data[k])
                    .sum()
            };
            let exact: f64 = sample
                .points()
                .iter()
                .enumerate()
                .map(|(i, p)| sample.weight(i) * kernel(0, *x, p[0]) * kernel(1, *y, p[1]))
                .sum();
            for value in [on_grid[i], at_points[i], estimate.at([*x, *y])] {
                assert!(
                    (value - exact).abs() < 1e-10,
                    "at {x}, {y}: {value} {exact}"
                );
            }
            assert_eq!(on_grid[i].to_bits(), at_points[i].to_bits());
        }
    }

    #[test]
    fn the_plane_is_a_product_of_lines() {
        check::<Cosine>(Taper::None, 6, false);
        check::<Cosine>(Taper::Fejer, 5, true);
        check::<Fourier>(Taper::Wahba, 4, false);
        check::<Legendre>(Taper::None, 1, true);
    }

    #[test]
    fn the_number_of_terms_follows_the_data() {
        let sample = sample();
        let placed = [
            Placed::<Legendre>::between(1.0, 2.0),
            Placed::between(0.0, 3.0),
        ];
        let length = Length {
            terms: Terms::CrossValidation,
            taper: Taper::None,
        };
        let estimate = fit(&sample, placed, length, false, Vec::new()).expect("legal");
        assert!(estimate.smoothing.is_some_and(|terms| terms > 2.0));
    }
}
