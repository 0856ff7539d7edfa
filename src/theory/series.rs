//! Orthogonal series: what they expect, and the best number of terms.

use super::Moments;
use super::integrated::{Integrated, panels_of};
use crate::density::{Density, Univariate};
use crate::numeric::orthogonal::{Basis, Placed};
use crate::numeric::{GaussLegendre, Sum, panels};
use crate::space::Point;
use rayon::prelude::*;

/// What the coefficients of a series are multiplied by, so that it does not end at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taper {
    /// Nothing: 1 for all.
    None,
    /// 1 - k/J, the mean of the first J partial sums. For cosines and Fourier's functions the estimate is then nowhere negative. [Fejér 1904]
    Fejer,
    /// 1 / (1 + (2k/J)⁴), the weights of a smoothing spline with half its strength at half of the terms. [Wahba 1981, eq. 1.5 with m = 2]
    Wahba,
}

impl Taper {
    /// The names in files.
    pub const NAMES: [&'static str; 3] = ["none", "fejer", "wahba"];

    /// The taper of that name.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "none" => Some(Self::None),
            "fejer" => Some(Self::Fejer),
            "wahba" => Some(Self::Wahba),
            _ => None,
        }
    }

    /// The factor of degree `degree` in a series of `terms`: 1 for degree 0, so that the mass is kept.
    pub fn weight(self, degree: usize, terms: usize) -> f64 {
        let share = degree as f64 / terms as f64;
        match self {
            Self::None => 1.0,
            Self::Fejer => 1.0 - share,
            Self::Wahba => (1.0 + (2.0 * share).powi(4)).recip(),
        }
    }
}

/// Places in the support of both, with weights: Σ w g(y) f(y) integrates g f for g a product of two functions of degree below `terms`.
fn nodes<B: Basis>(
    truth: &dyn Density<1>,
    placed: &Placed<B>,
    terms: usize,
) -> (Vec<f64>, Vec<f64>) {
    let (([low], [high]), [from, to]) = (truth.bulk(1e-18), placed.support());
    let (low, high) = (low.max(from), high.min(to));
    let (mut places, mut weights) = (Vec::new(), Vec::new());
    if low < high {
        let rule = GaussLegendre::new(24);
        for panel in panels_of(truth, low, high, placed.cuts(terms)).windows(2) {
            for (y, weight) in rule.on(panel[0], panel[1]) {
                places.push(y);
                weights.push(weight * truth.at([y]));
            }
        }
    }
    (places, weights)
}

/// The moments at each of `places` of the series of `terms` from `draws` points: with g(y) = Σₖ λₖ ψₖ(x) ψₖ(y), the mean of g(X) and its variance over n.
///
/// By quadrature, O((m + nodes of some ten a term) · terms).
pub fn series_moments<B: Basis>(
    truth: &dyn Density<1>,
    placed: &Placed<B>,
    terms: usize,
    taper: Taper,
    draws: f64,
    places: &[f64],
) -> Vec<Moments> {
    let (nodes, weights) = nodes(truth, placed, terms);
    let moments = |&x: &f64| {
        let mut g = placed.at(x, terms);
        for (index, value) in g.iter_mut().enumerate() {
            *value *= taper.weight(B::degree(index), terms);
        }
        let (mut mean, mut square) = (Sum::default(), Sum::default());
        for (g, weight) in placed.sum(&g, &nodes).into_iter().zip(&weights) {
            mean.add(weight * g);
            square.add(weight * g * g);
        }
        let mean = mean.value();
        Moments {
            mean,
            variance: ((square.value() - mean * mean) / draws).max(0.0),
        }
    };
    places.iter().map(moments).collect()
}

/// Panels of one axis of the plane, as places and weights, where both the density and the functions are.
fn along<B: Basis>(
    truth: &dyn Density<2>,
    placed: &Placed<B>,
    axis: usize,
    terms: usize,
) -> Vec<(f64, f64)> {
    let ((low, high), [from, to]) = (truth.bulk(1e-14), placed.support());
    let (low, high) = (low[axis].max(from), high[axis].min(to));
    if low >= high {
        return Vec::new();
    }
    let rule = GaussLegendre::new(12);
    let cuts = truth.breaks(axis).into_iter().chain(placed.cuts(2 * terms));
    let longest = 1.5 * truth.finest_scale(axis);
    let cuts = panels(low, high, cuts, longest);
    (cuts.windows(2))
        .flat_map(|panel| rule.on(panel[0], panel[1]))
        .collect()
}

/// The same in the plane, where the functions are products of those of the axes, as many on one as on the other: g is the product of the two axes' g.
///
/// By quadrature over a rectangle, O(nodes) a place with some ten nodes a term on each axis. Good to some 1e-10 where the density is smooth but for lines
/// along the axes that its breaks tell.
pub fn series_moments_in_plane<B: Basis>(
    truth: &dyn Density<2>,
    placed: &[Placed<B>; 2],
    terms: usize,
    taper: Taper,
    draws: f64,
    places: &[Point<2>],
) -> Vec<Moments> {
    let [first, second] = [0, 1].map(|axis: usize| along(truth, &placed[axis], axis, terms));
    let weights: Vec<f64> = first
        .iter()
        .flat_map(|(x, a)| second.iter().map(move |(y, b)| a * b * truth.at([*x, *y])))
        .collect();
    let nodes = [&first, &second].map(|axis| axis.iter().map(|(x, _)| *x).collect::<Vec<f64>>());
    let axis = |axis: usize, x: f64| -> Vec<f64> {
        let mut g = placed[axis].at(x, terms);
        for (index, value) in g.iter_mut().enumerate() {
            *value *= taper.weight(B::degree(index), terms);
        }
        placed[axis].sum(&g, &nodes[axis])
    };
    let moments = |x: &Point<2>| {
        let (g, k) = (axis(0, x[0]), axis(1, x[1]));
        let (mut mean, mut square) = (Sum::default(), Sum::default());
        for (a, row) in g.iter().zip(weights.chunks_exact(k.len().max(1))) {
            let (mut one, mut two) = (0.0, 0.0);
            for (b, weight) in k.iter().zip(row) {
                one += weight * b;
                two += weight * b * b;
            }
            mean.add(a * one);
            square.add(a * a * two);
        }
        let mean = mean.value();
        Moments {
            mean,
            variance: ((square.value() - mean * mean) / draws).max(0.0),
        }
    };
    places.par_iter().map(moments).collect()
}

/// The integrated errors over the whole line of series estimates of one density, for any number of terms up to a greatest and any sample size.
pub struct SeriesError<B> {
    placed: Placed<B>,
    /// cₖ = E ψₖ(X) and E ψₖ(X)², for each function.
    coefficients: Vec<f64>,
    squares: Vec<f64>,
    /// ∫ f² over the whole line.
    roughness: f64,
    most: usize,
}

impl<B: Basis> SeriesError<B> {
    /// The errors of series of up to `most` terms for `truth`. By quadrature, O(most²).
    pub fn new(truth: &dyn Univariate, placed: Placed<B>, most: usize) -> Self {
        let density: &dyn Density<1> = truth;
        let (nodes, weights) = nodes(density, &placed, most);
        let found = placed.project(&nodes, |i| weights[i], most, true);
        Self {
            placed,
            coefficients: found.sums,
            squares: found.squares,
            roughness: truth.roughness(0),
            most,
        }
    }

    /// Where the functions are.
    pub fn placed(&self) -> &Placed<B> {
        &self.placed
    }

    /// cₖ = ∫ ψₖ f for each function: what the coefficients of an estimate expect.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// The errors with `terms` terms and `draws` points: bias² = ∫f² - Σ cₖ² + Σ (1 - λₖ)² cₖ² and variance = Σ λₖ² (E ψₖ² - cₖ²)/n, sums over degrees
    /// below `terms`. [Kronmal & Tarter 1968, theorem 4]
    ///
    /// # Panics
    /// If `terms` is more than was asked for in [`SeriesError::new`].
    pub fn at(&self, terms: usize, taper: Taper, draws: f64) -> Integrated {
        assert!(terms <= self.most, "{terms} terms of {}", self.most);
        let (mut squared_bias, mut variance) = (Sum::default(), Sum::default());
        squared_bias.add(self.roughness);
        for index in 0..B::functions(terms) {
            let (c, square) = (self.coefficients[index], self.squares[index]);
            let weight = taper.weight(B::degree(index), terms);
            // (1 - λ)² c² - c²
            squared_bias.add(weight * (weight - 2.0) * c * c);
            variance.add(weight * weight * (square - c * c));
        }
        Integrated {
            squared_bias: squared_bias.value().max(0.0),
            variance: variance.value().max(0.0) / draws,
        }
    }

    /// The number of terms of least MISE, the fewest where several are equal, with its errors.
    pub fn optimum(&self, taper: Taper, draws: f64) -> (usize, Integrated) {
        (1..=self.most)
            .map(|terms| (terms, self.at(terms, taper, draws)))
            .min_by(|a, b| a.1.mise().total_cmp(&b.1.mise()))
            .unwrap_or_default()
    }
}
