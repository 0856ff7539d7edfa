//! Integrals by Gauss-Legendre panels.
//!
//! The integrands here are piecewise smooth with known breakpoints (edges of a support, of a bin, of a kernel), so fixed rules on the
//! pieces converge fast and, unlike adaptive rules, give results that vary smoothly with a parameter such as the bandwidth.

use super::Sum;
use gauss_quad::GaussLegendre as Rule;
use std::num::NonZeroUsize;

/// A Gauss-Legendre rule, kept as nodes and weights on [-1, 1].
#[derive(Clone, Debug)]
pub struct GaussLegendre {
    nodes: Vec<(f64, f64)>,
}

impl GaussLegendre {
    /// The rule with `degree` nodes (at least 1): exact for polynomials up to degree 2·`degree` - 1.
    pub fn new(degree: usize) -> Self {
        let degree = NonZeroUsize::new(degree).unwrap_or(NonZeroUsize::MIN);
        Self {
            nodes: Rule::new(degree)
                .iter()
                .map(|(node, weight)| (*node, *weight))
                .collect(),
        }
    }

    /// The nodes and weights moved to `[low, high]`.
    pub fn on(&self, low: f64, high: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let (half, middle) = (0.5 * (high - low), 0.5 * (high + low));
        self.nodes
            .iter()
            .map(move |&(node, weight)| (half.mul_add(node, middle), half * weight))
    }

    /// ∫ f over `[low, high]` with one application of the rule.
    pub fn integrate(&self, f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
        self.on(low, high).map(|(x, weight)| weight * f(x)).sum()
    }

    /// ∫ f over consecutive panels, the pieces between the `breaks` (ascending).
    pub fn integrate_panels(&self, f: impl Fn(f64) -> f64, breaks: &[f64]) -> f64 {
        breaks
            .windows(2)
            .map(|panel| self.integrate(&f, panel[0], panel[1]))
            .collect::<Sum>()
            .value()
    }
}

/// Cuts `[low, high]` at those `breaks` that lie inside it, and each piece so that no panel is longer than `longest`. Ascending, with both ends.
pub fn panels(
    low: f64,
    high: f64,
    breaks: impl IntoIterator<Item = f64>,
    longest: f64,
) -> Vec<f64> {
    let mut cuts: Vec<f64> = breaks
        .into_iter()
        .filter(|&cut| low < cut && cut < high)
        .collect();
    cuts.push(low);
    cuts.push(high);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    let mut fine = Vec::with_capacity(cuts.len());
    for piece in cuts.windows(2) {
        let parts = ((piece[1] - piece[0]) / longest).ceil().clamp(1.0, 1e6) as usize;
        fine.extend(
            (0..parts).map(|i| (piece[1] - piece[0]).mul_add(i as f64 / parts as f64, piece[0])),
        );
    }
    fine.push(high);
    fine
}

#[cfg(test)]
mod tests {
    use super::{GaussLegendre, panels};

    #[test]
    fn polynomials_up_to_the_promised_degree_are_exact() {
        let rule = GaussLegendre::new(8);
        for degree in 0..16 {
            let exact = 1.0 / f64::from(degree + 1);
            assert!(
                (rule.integrate(|x| x.powi(degree), 0.0, 1.0) - exact).abs() < 1e-14,
                "degree {degree}"
            );
        }
    }

    #[test]
    fn panels_honour_breaks_and_length() {
        let cuts = panels(0.0, 1.0, [0.3, 2.0, 0.3], 0.25);
        assert!(cuts.contains(&0.3) && !cuts.contains(&2.0));
        assert!(
            cuts.windows(2)
                .all(|p| p[1] > p[0] && p[1] - p[0] <= 0.25 + 1e-12)
        );
        let rule = GaussLegendre::new(4);
        assert!(
            (rule.integrate_panels(|x| if x < 0.3 { 0.0 } else { 1.0 }, &cuts) - 0.7).abs() < 1e-14
        );
    }
}
