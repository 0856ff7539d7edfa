//! Mean and variance of nearest-neighbour estimates, from the exact distribution of the distance to the k-th neighbour.

mod disc;
mod error;

pub use error::NeighbourError;
pub(super) use error::best_count;

use super::Moments;
use crate::density::{Density, Univariate};
use crate::neighbour::Metric;
use crate::numeric::{GaussLegendre, Sum};
use crate::space::Point;
use disc::{Disc, EXACT};
use rayon::prelude::*;
use std::sync::LazyLock;

/// How k neighbours in a ball become a density.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Convention {
    /// (k - 1) / (n V(d_k)): unbiased where the density is even.
    Unbiased,
    /// k / (n V(d_k)), as first published; its mean is f k/(k - 1) there. [Loftsgaarden & Quesenberry 1965; Silverman 1986, eq. 5.1]
    Raw,
    /// k / (n V(r)) with r the mean of the distances to neighbours k and k + 1; about f (1 + 1/(2k)) there. [Schregle 2003]
    MeanRadius,
}

impl Convention {
    /// All.
    pub const ALL: [Self; 3] = [Self::Unbiased, Self::Raw, Self::MeanRadius];

    /// The names in the order of [`Convention::ALL`].
    pub const NAMES: [&'static str; 3] = ["unbiased", "raw", "mean-radius"];

    /// The convention of that name.
    pub fn named(name: &str) -> Option<Self> {
        let at = Self::NAMES.iter().position(|known| *known == name)?;
        Some(Self::ALL[at])
    }
}

/// Mean and variance of the k-nearest-neighbour estimate from `draws` points of `truth` at each of `places`; `None` where the probability of a ball
/// is not known, that is for what is not even on a domain that wraps round, for the mean radius in the plane, and where there are too few draws.
///
/// The probability p of the ball out to the k-th neighbour has the Beta(k, n - k + 1) distribution whatever the density, and of what is left the next
/// neighbour's shell takes a Beta(1, n - k) share: one or two quadratures over p, with the radius found by inverting the probability of the ball. Good to 1e-9; some
/// hundred microseconds a place, milliseconds for the mean radius. In the plane the probability of discs is tabulated first, in a millisecond a place. The variance is infinite at k = 2 where the density is positive.
pub fn neighbour_moments<const D: usize>(
    truth: &dyn Density<D>,
    k: usize,
    convention: Convention,
    draws: usize,
    places: &[Point<D>],
) -> Option<Vec<Moments>> {
    let least = k + usize::from(convention == Convention::MeanRadius);
    if k < 2 || draws < least {
        return None;
    }
    // before the tables of discs are made in vain
    let round = || truth.level().is_some() && Metric::new(truth.domain()).round();
    if convention == Convention::MeanRadius && truth.univariate().is_none() && !round() {
        return None;
    }
    Places::new(truth, places)?.moments(k, convention, draws)
}

/// What moments at some places need, whatever k and n are.
pub(super) struct Places<'a, const D: usize> {
    truth: &'a dyn Density<D>,
    metric: Metric<D>,
    targets: &'a [Point<D>],
    /// In the plane, one a place.
    discs: Vec<Disc>,
}

impl<'a, const D: usize> Places<'a, D> {
    /// `None` where the probability of balls is not known.
    pub(super) fn new(truth: &'a dyn Density<D>, places: &'a [Point<D>]) -> Option<Self> {
        let metric = Metric::new(truth.domain());
        let level = metric.round() && truth.level().is_some();
        if !level && metric.wraps() {
            return None;
        }
        let discs = match truth.bivariate() {
            Some(plane) if !level => (places.par_iter())
                .map(|x| Disc::about(plane, [x[0], x[1]], EXACT))
                .collect(),
            None if !level => truth.univariate().map(|_| Vec::new())?,
            _ => Vec::new(),
        };
        Some(Self {
            truth,
            metric,
            targets: places,
            discs,
        })
    }

    pub(super) fn moments(
        &self,
        k: usize,
        convention: Convention,
        draws: usize,
    ) -> Option<Vec<Moments>> {
        let Self {
            truth,
            metric,
            targets: places,
            discs,
        } = self;
        if let Some(level) = truth.level().filter(|_| metric.round()) {
            let ball = Ball {
                mass: |r| (level * metric.ball(r)).min(1.0),
                volume: |r| metric.ball(r),
                largest: 0.5 * metric.diagonal(),
                kinks: vec![0.5 * metric.period(0), 0.5 * metric.period(D - 1)],
                positive: level > 0.0,
            };
            return Some(vec![ball.moments(k, convention, draws); places.len()]);
        }
        if let Some(line) = truth.univariate() {
            let at = |x: &Point<D>| on_line(line, x[0], k, convention, draws);
            return Some(places.par_iter().map(at).collect());
        }
        if convention == Convention::MeanRadius {
            return None;
        }
        let at = |disc: &Disc| disc.moments(k, convention, draws);
        Some(discs.par_iter().map(at).collect())
    }
}

/// The moments at one place of a line.
fn on_line(
    line: &dyn Univariate,
    x: f64,
    k: usize,
    convention: Convention,
    draws: usize,
) -> Moments {
    let ([low], [high]) = line.bulk(1e-18);
    let ball = Ball {
        // the shorter of the two tails loses no digits
        mass: |r: f64| line.probability([x - r], [x + r]),
        volume: |r: f64| 2.0 * r,
        largest: (x - low).abs().max((high - x).abs()),
        kinks: line.breaks(0).iter().map(|cut| (cut - x).abs()).collect(),
        positive: line.at([x]) > 0.0,
    };
    ball.moments(k, convention, draws)
}

/// The k that makes the asymptotic mean squared error at a place least, for the density `f` and its second derivative (the Laplacian in the plane)
/// there: k⁵ = 144 n⁴ f⁶/f''² on the line, k³ = 32 π² n² f⁴/(∆f)² in the plane. Infinite where the curvature is zero.
///
/// From bias k² f''/(24 n² f²) or k ∆f/(8π n f) and variance f²/k. [Mack & Rosenblatt 1979] In more dimensions it does not compile.
pub fn best_neighbours<const D: usize>(draws: f64, f: f64, curvature: f64) -> f64 {
    use std::f64::consts::PI;
    const { assert!(D == 1 || D == 2, "on the line and in the plane") };
    if D == 1 {
        (144.0 * draws.powi(4) * f.powi(6) / curvature.powi(2)).powf(0.2)
    } else {
        (32.0 * PI * PI * draws.powi(2) * f.powi(4) / curvature.powi(2)).cbrt()
    }
}

/// The balls about one place.
struct Ball<M, V> {
    /// The probability of the ball of a radius.
    mass: M,
    volume: V,
    /// The ball of this radius holds all.
    largest: f64,
    /// Radii where the probability is not smooth.
    kinks: Vec<f64>,
    /// Whether the density at the place is positive.
    positive: bool,
}

static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(16));

impl<M: Fn(f64) -> f64, V: Fn(f64) -> f64> Ball<M, V> {
    fn moments(&self, k: usize, convention: Convention, draws: usize) -> Moments {
        let (n, k) = (draws as f64, k as f64);
        // Beta(k, n - k + 1) relative to its mode; the norm is summed along
        let mode = ((k - 1.0) / (n - 1.0).max(1.0)).clamp(1e-300, 1.0 - 1e-16);
        let log = |p: f64| (k - 1.0) * p.ln() + (n - k) * (-p).ln_1p();
        let top = log(mode);
        let (mut norm, mut first, mut second) = (Sum::default(), Sum::default(), Sum::default());
        let mut below = 0.0;
        for panel in self.cuts(k, n).windows(2) {
            let above = self.radius(panel[1], below, self.largest);
            for (p, step) in RULE.on(panel[0], panel[1]) {
                let weight = step * (log(p) - top).exp();
                if weight == 0.0 {
                    continue;
                }
                let radius = self.radius(p, below, above);
                let [one, two] = match convention {
                    Convention::MeanRadius => self.shell(k, n, p, radius),
                    Convention::Raw => self.powers(k / n, radius),
                    Convention::Unbiased => self.powers((k - 1.0) / n, radius),
                };
                norm.add(weight);
                first.add(weight * one);
                second.add(weight * two);
            }
            below = above;
        }
        let mean = first.value() / norm.value();
        let variance = if k <= 2.0 && self.positive && convention != Convention::MeanRadius {
            f64::INFINITY
        } else {
            (second.value() / norm.value() - mean * mean).max(0.0)
        };
        Moments { mean, variance }
    }

    fn powers(&self, share: f64, radius: f64) -> [f64; 2] {
        let f = share / (self.volume)(radius);
        [f, f * f]
    }

    /// The mean powers of the estimate with the mean radius, given the k-th at `radius` with probability `p` inside.
    fn shell(&self, k: f64, n: f64, p: f64, radius: f64) -> [f64; 2] {
        let left = n - k;
        let (mut norm, mut first, mut second) = (0.0, 0.0, 0.0);
        let mut below = radius;
        // the share t of the rest has the density ∝ (1 - t)^(left - 1), in units of 1/left
        for panel in [0.0, 0.75, 2.0, 4.5, 9.0, 18.0, 40.0].windows(2) {
            let (a, b) = ((panel[0] / left).min(1.0), (panel[1] / left).min(1.0));
            if a >= b {
                break;
            }
            let above = self.radius(p + (1.0 - p) * b, below, self.largest);
            for (t, step) in INNER.on(a, b) {
                let weight = step * ((left - 1.0) * (-t).ln_1p()).exp();
                let next = self.radius(p + (1.0 - p) * t, below, above);
                let [one, two] = self.powers(k / n, 0.5 * (radius + next));
                norm += weight;
                first += weight * one;
                second += weight * two;
            }
            below = above;
        }
        [first / norm, second / norm]
    }

    /// The radius of the ball of probability `p`, known to be between two others: false position, kept honest by bisection.
    fn radius(&self, p: f64, low: f64, high: f64) -> f64 {
        let (mut a, mut b) = (low, high.max(low));
        let (mut fa, mut fb) = ((self.mass)(a) - p, (self.mass)(b) - p);
        if fa >= 0.0 {
            return a;
        }
        if fb <= 0.0 {
            return b;
        }
        for round in 0..200 {
            let x = if round % 3 == 2 {
                0.5 * (a + b)
            } else {
                (a - fa * (b - a) / (fb - fa)).clamp(a, b)
            };
            let fx = (self.mass)(x) - p;
            if fx.abs() <= 2e-16 * p || b - a <= 4.0 * f64::EPSILON * b {
                return x;
            }
            // the end that stays twice counts half [Dowell & Jarratt 1971]
            if fx < 0.0 {
                (a, fa) = (x, fx);
                fb *= 0.5;
            } else {
                (b, fb) = (x, fx);
                fa *= 0.5;
            }
            if round % 3 == 2 {
                (fa, fb) = ((self.mass)(a) - p, (self.mass)(b) - p);
            }
        }
        0.5 * (a + b)
    }

    /// Panels in p: about the mean of the Beta distribution, out to where nothing is left, and at kinks.
    fn cuts(&self, k: f64, n: f64) -> Vec<f64> {
        let mean = k / (n + 1.0);
        let deviation = (mean * (1.0 - mean) / (n + 2.0)).sqrt();
        let mut cuts: Vec<f64> = [
            -10.0, -8.0, -6.5, -5.0, -4.0, -3.0, -2.25, -1.5, -0.75, 0.0, 0.75, 1.5, 2.25, 3.0,
            4.0, 5.0, 6.5, 8.0, 10.0, 14.0, 20.0, 30.0, 45.0,
        ]
        .iter()
        .map(|z: &f64| z.mul_add(deviation, mean))
        .chain(self.kinks.iter().map(|r| (self.mass)(*r)))
        .filter(|p| 0.0 < *p && *p < 1.0)
        .collect();
        // towards p = 0 a power of p, towards p = 1 one of 1 - p, which may meet a radius that runs off
        cuts.extend([0.0, 1.0]);
        cuts.extend((1..12).map(|i| 1.0 - 0.25f64.powi(i)));
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        cuts
    }
}

static INNER: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(8));

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::named;

    /// Mean n f/(k-1) E and so on, where the ball never meets an end: an even density on the line, seen from its middle.
    #[test]
    fn an_even_density_has_the_moments_of_the_beta_distribution() {
        let uniform = named("uniform").expect("known");
        for (n, k) in [(1000, 10), (100, 3), (100_000, 500)] {
            let (real, kf) = (n as f64, k as f64);
            let square = (real - 1.0) * real / ((kf - 1.0) * (kf - 2.0));
            for (convention, c) in [(Convention::Unbiased, kf - 1.0), (Convention::Raw, kf)] {
                let found =
                    neighbour_moments(&*uniform, k, convention, n, &[[0.5]]).expect("on a line")[0];
                let mean = c / (kf - 1.0);
                let variance = c * c * square / (real * real) - mean * mean;
                assert!((found.mean / mean - 1.0).abs() < 1e-9, "{n} {k}: {found:?}");
                assert!(
                    (found.variance / variance - 1.0).abs() < 1e-7,
                    "{n} {k}: {found:?} {variance}"
                );
            }
        }
        let heavy = neighbour_moments(&*uniform, 2, Convention::Unbiased, 50, &[[0.5]]);
        assert!(heavy.expect("on a line")[0].variance.is_infinite());
    }

    /// Leading terms of bias and variance for a small ball in a curved density. [Mack & Rosenblatt 1979]
    #[test]
    fn curvature_biases_as_the_expansion_says() {
        let normal = named("normal").expect("known");
        let (n, k) = (1_000_000, 8000);
        let f = normal.at([0.0]);
        let found = neighbour_moments(&*normal, k, Convention::Unbiased, n, &[[0.0]])
            .expect("on a line")[0];
        let share = k as f64 / n as f64;
        let bias = share * share * -f / (24.0 * f * f);
        assert!(((found.mean - f) / bias - 1.0).abs() < 0.01, "{found:?}");
        let variance = f * f / k as f64;
        assert!((found.variance / variance - 1.0).abs() < 0.01, "{found:?}");
        let best = best_neighbours::<1>(n as f64, f, -f);
        assert!((best.powi(5) / (144.0 * 1e24 * f.powi(4)) - 1.0).abs() < 1e-12);
    }

    /// 1.051 at k = 10 in the plane and half of the raw excess on the line. [measured by simulation for the plane]
    #[test]
    fn the_mean_radius_leaves_about_half_of_the_bias() {
        let uniform = named("uniform").expect("known");
        let found = neighbour_moments(&*uniform, 10, Convention::MeanRadius, 10_000, &[[0.5]])
            .expect("on a line")[0];
        // E 2k/(G₁ + G₂) with G₁ ~ Γ(k), G₂ = G₁ + Exp: ∫∫ by hand to five digits
        let exact: f64 = {
            let rule = GaussLegendre::new(200);
            let gamma = |g: f64| (9.0 * g.ln() - g - statrs::function::gamma::ln_gamma(10.0)).exp();
            rule.integrate(
                |g| gamma(g) * rule.integrate(|e| (-e).exp() * 10.0 / (g + 0.5 * e), 0.0, 40.0),
                0.0,
                60.0,
            )
        };
        assert!((found.mean - exact).abs() < 2e-4, "{found:?} {exact}");
    }
}
