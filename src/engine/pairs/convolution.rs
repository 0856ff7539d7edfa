//! A compact kernel convolved with itself, as polynomials.

use super::super::basis::Powers;
use crate::kernel::{Form, Kernel, Shape};
use crate::numeric::{GaussLegendre, panels};
use std::f64::consts::PI;

/// K∗K is a polynomial of degree 2k + 1 on [0, 1] and on [1, 2] where K is one of degree k; for the cosine kernel degree 15 is as good as
/// its numbers are (1e-14).
pub(super) fn degree(shape: Shape) -> usize {
    match shape.form() {
        Form::Polynomial(c) => 2 * c.len() - 1,
        Form::Cosine | Form::Gaussian => 15,
    }
}

/// The polynomials of one kernel in |u|.
pub(super) struct Pieces<const N: usize> {
    /// (K∗K)(u) + factor · K(u) for 0 ≤ u ≤ 1.
    pub near: Powers<N>,
    /// (K∗K)(u) for 1 < u ≤ 2.
    pub far: Powers<N>,
}

/// What does not depend on the factor: coefficients of K∗K on either piece, and of K.
#[derive(Clone, Debug)]
pub(super) struct Coefficients<const N: usize> {
    near: [f64; N],
    far: [f64; N],
    kernel: [f64; N],
}

impl<const N: usize> Coefficients<N> {
    /// Those of `shape`; N is its degree and one more.
    pub fn new(shape: Shape) -> Self {
        let convolution = |u: f64| convolution(shape, u);
        let kinked = matches!(shape.form(), Form::Polynomial(c) if c.iter().skip(1).step_by(2).any(|c| *c != 0.0));
        let (near, far) = if kinked {
            (fit(convolution, 0.0, 1.0), fit(convolution, 1.0, 2.0))
        } else {
            let whole = fit(convolution, 0.0, 2.0);
            (whole, whole)
        };
        let kernel = match shape.form() {
            Form::Polynomial(c) => std::array::from_fn(|k| c.get(k).copied().unwrap_or(0.0)),
            _ => fit(|u| shape.value(u), 0.0, 1.0),
        };
        Self { near, far, kernel }
    }

    pub fn pieces(&self, factor: f64) -> Pieces<N> {
        let near: [f64; N] = std::array::from_fn(|k| self.near[k] + factor * self.kernel[k]);
        Pieces {
            near: Powers::new(&near),
            far: Powers::new(&self.far),
        }
    }
}

/// (K∗K)(u) = ∫ K(t) K(u - t) dt over u - 1 ≤ t ≤ 1, 0 ≤ u ≤ 2, by quadrature that is exact for polynomials of degree 31.
pub(in crate::engine) fn convolution(shape: Shape, u: f64) -> f64 {
    if u >= 2.0 {
        return 0.0;
    }
    let cuts = panels(u - 1.0, 1.0, [0.0, u], 1.0);
    GaussLegendre::new(16).integrate_panels(|t| shape.value(t) * shape.value(u - t), &cuts)
}

/// The coefficients of the polynomial of degree N - 1 through N Chebyshev points of `f` between `low` and `high`.
fn fit<const N: usize>(f: impl Fn(f64) -> f64, low: f64, high: f64) -> [f64; N] {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let angle = |k: usize| PI * (k as f64 + 0.5) / N as f64;
    let values: [f64; N] = std::array::from_fn(|k| f(half.mul_add(angle(k).cos(), middle)));
    // Σ cⱼ Tⱼ(v) in powers of v, by T_{j+1} = 2v Tⱼ - T_{j-1}
    let mut powers = [0.0; N];
    let (mut before, mut now) = ([0.0; N], [0.0; N]);
    now[0] = 1.0;
    for j in 0..N {
        let sum: f64 = (0..N)
            .map(|k| values[k] * (j as f64 * angle(k)).cos())
            .sum();
        let c = sum * if j == 0 { 1.0 } else { 2.0 } / N as f64;
        for k in 0..N {
            powers[k] += c * now[k];
        }
        let mut next = [0.0; N];
        for k in 0..N {
            let raised = if k > 0 { now[k - 1] } else { 0.0 };
            next[k] = if j == 0 {
                raised
            } else {
                2.0 * raised - before[k]
            };
        }
        (before, now) = (now, next);
    }
    // v = (u - middle)/half
    let mut scale = 1.0;
    for c in &mut powers {
        *c *= scale;
        scale /= half;
    }
    // the triangle of Horner steps moves the origin from `middle` to 0
    for k in 0..N {
        for i in (k..N - 1).rev() {
            powers[i] -= middle * powers[i + 1];
        }
    }
    powers
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value<const N: usize>(c: &[f64; N], u: f64) -> f64 {
        c.iter().rev().fold(0.0, |sum, &c| f64::mul_add(sum, u, c))
    }

    fn polynomials_are_the_convolution<const N: usize>(shape: Shape) {
        assert_eq!(degree(shape) + 1, N);
        let c = Coefficients::<N>::new(shape);
        for i in 0..=200 {
            let u = f64::from(i) * 0.01;
            let piece = if u <= 1.0 { &c.near } else { &c.far };
            let (got, exact) = (value(piece, u), convolution(shape, u));
            assert!((got - exact).abs() < 2e-12, "{shape} {u}: {got} {exact}");
            if u < 1.0 {
                assert!(
                    (value(&c.kernel, u) - shape.value(u)).abs() < 1e-12,
                    "{shape} {u}"
                );
            }
        }
        assert!(
            (value(&c.near, 0.0) - shape.roughness()).abs() < 1e-12,
            "{shape}"
        );
    }

    #[test]
    fn every_compact_kernel() {
        polynomials_are_the_convolution::<2>(Shape::Uniform);
        polynomials_are_the_convolution::<4>(Shape::Triangular);
        polynomials_are_the_convolution::<6>(Shape::Epanechnikov);
        polynomials_are_the_convolution::<10>(Shape::Biweight);
        polynomials_are_the_convolution::<14>(Shape::Triweight);
        polynomials_are_the_convolution::<16>(Shape::Cosine);
        // 3/160 (2 - u)³ (u² + 6u + 4) [Silverman 1986, section 3.4.3, rescaled]
        for u in [0.0, 0.3, 1.0, 1.7] {
            let known = 3.0 / 160.0 * (2.0_f64 - u).powi(3) * (u * u + 6.0 * u + 4.0);
            assert!((convolution(Shape::Epanechnikov, u) - known).abs() < 1e-15);
        }
    }
}
