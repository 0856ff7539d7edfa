//! Integrated errors of adaptive kernel estimates whose pilot is a known function.

use super::adaptive::geometric_mean_of;
use super::optimum::{self, Optimum};
use super::{Integrated, kernel_cuts, kernel_moments, panels_of};
use crate::density::Univariate;
use crate::kernel::{Kernel, Shape};
use crate::numeric::{GaussLegendre, Piecewise, Sum, panels, sign_change};
use std::sync::LazyLock;

/// How the width of a bump follows the pilot: h (p/g)^(-α), where p counts as no less than `clip` times its geometric mean g. [Abramson 1982; Silverman 1986, section 5.3]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WidthLaw {
    /// α: ½ is Abramson's, 0 the fixed bandwidth.
    pub exponent: f64,
    /// The least p/g.
    pub clip: f64,
}

impl WidthLaw {
    /// The width over h where the pilot is `pilot` and its geometric mean `mean`; never so far that a width is beyond all numbers.
    pub fn stretch(self, pilot: f64, mean: f64) -> f64 {
        const LEAST: f64 = 1e-12;
        (pilot / mean)
            .max(self.clip)
            .max(LEAST)
            .powf(-self.exponent)
    }

    /// The greatest width over h.
    pub fn widest(self) -> f64 {
        self.stretch(0.0, 1.0)
    }

    /// Whether widths stay within reach of each other; where there is next to no clip, bumps of the tails reach over places without number.
    pub(super) fn is_held(self) -> bool {
        self.widest() <= 32.0
    }
}

/// A pilot that does not depend on the sample, so that theory can follow it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FixedPilot {
    /// The density itself.
    Truth,
    /// What a kernel estimate with this bandwidth has for its mean, K_b * f: a pilot estimate without its noise.
    Smoothed(f64),
    /// The same with the bandwidth h of the estimate.
    Tied,
}

impl FixedPilot {
    /// The bandwidth of the pilot where that of the estimate is `h`; `None` where it has none.
    pub(super) fn bandwidth(self, h: f64) -> Option<f64> {
        match self {
            Self::Truth => None,
            Self::Smoothed(b) => Some(b),
            Self::Tied => Some(h),
        }
    }
}

/// Beyond so many deviations the Gaussian kernel is left out: 1e-16 of its peak.
const GAUSSIAN_REACH: f64 = 8.6;

/// Parts of a width over which bumps that end are averaged.
const CELLS: f64 = 160.0;

static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(16));

/// The integrated errors over the whole line of adaptive estimates with a fixed pilot, for any bandwidth and sample size.
///
/// With s the width over h, m(x) = ∫ K((x - y)/h s(y))/(h s(y)) f(y) dy: bias² = ∫(m - f)², and variance = (R(K) ∫ f/(h s) - ∫m²)/n, the first of which is the integral of K² over x. \[Hall & Marron 1988\]
///
/// For the Gaussian kernel by Gauss-Legendre panels, to some 1e-8 of the error; for kernels that end, whose every bump would need cuts of its own, by bumps that are averaged over cells of a hundred and sixtieth of a width, to 1e-4. Some milliseconds a bandwidth.
pub struct AdaptiveError<'a> {
    truth: &'a dyn Univariate,
    shape: Shape,
    law: WidthLaw,
    pilot: FixedPilot,
    /// The pilot where it does not change with h.
    known: Option<Pilot<'a>>,
}

/// A function of the place of a datum, with its geometric mean over the density.
struct Pilot<'a> {
    value: Box<dyn Fn(f64) -> f64 + Send + Sync + 'a>,
    mean: f64,
}

/// Masses of the density and the widths that they are spread by.
struct Bump {
    at: f64,
    mass: f64,
    width: f64,
    /// Half of the cell that the mass is spread over; 0 for a point.
    half: f64,
}

impl<'a> AdaptiveError<'a> {
    /// The errors of estimates of `truth` with this kernel, law and pilot.
    pub fn new(truth: &'a dyn Univariate, shape: Shape, law: WidthLaw, pilot: FixedPilot) -> Self {
        let mut errors = Self {
            truth,
            shape,
            law,
            pilot,
            known: None,
        };
        if pilot != FixedPilot::Tied {
            errors.known = Some(errors.pilot(1.0));
        }
        errors
    }

    /// The pilot of estimates with bandwidth `h`.
    fn pilot(&self, h: f64) -> Pilot<'a> {
        let (truth, shape) = (self.truth, self.shape);
        let value: Box<dyn Fn(f64) -> f64 + Send + Sync + 'a> = match self.pilot.bandwidth(h) {
            None => Box::new(move |y| truth.at([y])),
            Some(b) => {
                let smoothed = move |y: f64| kernel_moments(truth, shape, b, 1.0, y).mean;
                if shape == Shape::Gaussian && truth.normal_components().is_some() {
                    Box::new(smoothed)
                } else {
                    // each value is an integral: a table of them
                    let ([low], [high]) = truth.bulk(1e-18);
                    let cuts = kernel_cuts(truth, shape, b);
                    let cuts = panels_of(truth, low, high, cuts);
                    let table = Piecewise::fit(smoothed, &cuts, 1e-10);
                    Box::new(move |y| table.at(y))
                }
            }
        };
        let mean = geometric_mean_of(self.truth, &*value);
        Pilot { value, mean }
    }

    /// The errors with bandwidth `h` and `draws` points (or the effective size of a weighted sample); not numbers for widths below a ten-thousandth of the density's.
    pub fn at(&self, h: f64, draws: f64) -> Integrated {
        if h < 0.9 * self.least() {
            return Integrated {
                squared_bias: f64::NAN,
                variance: f64::NAN,
            };
        }
        let own;
        let pilot = if let Some(known) = &self.known {
            known
        } else {
            own = self.pilot(h);
            &own
        };
        let width = |y: f64| h * self.law.stretch((pilot.value)(y), pilot.mean);
        let bumps = self.bumps(&width, self.bends(pilot));
        let own: Sum = bumps.iter().map(|bump| bump.mass / bump.width).collect();
        let widest = bumps.iter().map(|bump| bump.width).fold(0.0, f64::max);
        let (mut squared_bias, mut squares) = (Sum::default(), Sum::default());
        let reach = widest * if self.is_round() { GAUSSIAN_REACH } else { 1.0 };
        for panel in self.places(h, &width, reach).windows(2) {
            for (x, weight) in RULE.on(panel[0], panel[1]) {
                let mean = self.mean(&bumps, reach, x);
                squared_bias.add(weight * (mean - self.truth.at([x])).powi(2));
                squares.add(weight * mean * mean);
            }
        }
        let own = self.shape.roughness() * own.value();
        Integrated {
            squared_bias: squared_bias.value(),
            variance: ((own - squares.value()) / draws).max(0.0),
        }
    }

    /// The narrowest width that is gone through: below it the density has more parts than are worth their time.
    fn least(&self) -> f64 {
        let ([low], [high]) = self.truth.bulk(1e-12);
        1e-4 * (high - low)
    }

    fn is_round(&self) -> bool {
        self.shape == Shape::Gaussian
    }

    /// Where the clip sets in, so that the width bends.
    fn bends(&self, pilot: &Pilot<'_>) -> Vec<f64> {
        let ([low], [high]) = self.truth.bulk(1e-18);
        let level = self.law.clip * pilot.mean;
        let pieces = panels_of(self.truth, low, high, []);
        let pieces = panels(low, high, pieces, 0.25 * self.truth.finest_scale(0));
        let ends = pieces.windows(2);
        ends.filter_map(|ends| sign_change(|y| (pilot.value)(y) - level, ends[0], ends[1]))
            .collect()
    }

    /// The density in parts, ascending.
    fn bumps(&self, width: &impl Fn(f64) -> f64, bends: Vec<f64>) -> Vec<Bump> {
        let ([low], [high]) = self.truth.bulk(1e-18);
        let mut bumps = Vec::new();
        for panel in panels_of(self.truth, low, high, bends).windows(2) {
            let (a, b) = (panel[0], panel[1]);
            let middle = 0.5 * (a + b);
            let narrowest = [a, middle, b]
                .map(width)
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            if self.is_round() {
                for piece in panels(a, b, [], 1.25 * narrowest).windows(2) {
                    bumps.extend(RULE.on(piece[0], piece[1]).map(|(at, weight)| Bump {
                        at,
                        mass: weight * self.truth.at([at]),
                        width: width(at),
                        half: 0.0,
                    }));
                }
            } else {
                for piece in panels(a, b, [], narrowest / CELLS).windows(2) {
                    let at = 0.5 * (piece[0] + piece[1]);
                    bumps.push(Bump {
                        at,
                        mass: self.truth.probability([piece[0]], [piece[1]]),
                        width: width(at),
                        half: 0.5 * (piece[1] - piece[0]),
                    });
                }
            }
        }
        bumps
    }

    /// m(x).
    fn mean(&self, bumps: &[Bump], reach: f64, x: f64) -> f64 {
        // a cell may end where its middle is not
        let reach = 1.05 * reach;
        let first = bumps.partition_point(|bump| bump.at < x - reach);
        let near = bumps[first..]
            .iter()
            .take_while(|bump| bump.at <= x + reach);
        let mut mean = Sum::default();
        for bump in near {
            let u = (x - bump.at) / bump.width;
            let value = if self.is_round() {
                self.shape.value(u) / bump.width
            } else {
                let half = bump.half / bump.width;
                if u.abs() >= 1.0 + half {
                    continue;
                }
                let below = |u: f64| self.shape.partial_moment(0, u);
                (below(u + half) - below(u - half)) / (2.0 * bump.half)
            };
            mean.add(bump.mass * value);
        }
        mean.value()
    }

    /// Panels on which m is smooth: it changes within a width of a break, and beyond the last with the widths there.
    fn places(&self, h: f64, width: &impl Fn(f64) -> f64, reach: f64) -> Vec<f64> {
        let ([low], [high]) = self.truth.bulk(1e-18);
        let round = self.is_round();
        let mut cuts = Vec::new();
        for place in self.truth.breaks(0) {
            if !place.is_finite() {
                continue;
            }
            // the widths on both sides, which differ where the pilot jumps
            for side in [place.next_down(), place, place.next_up()] {
                let w = width(side.clamp(low, high));
                let steps: &[f64] = if round {
                    &[0.5, 1.0, 2.0, 3.0, 4.5, 6.0, 8.0]
                } else {
                    &[0.25, 0.5, 0.75, 1.0]
                };
                cuts.extend(
                    steps
                        .iter()
                        .flat_map(|step| [place - step * w, place + step * w]),
                );
            }
        }
        let beyond = panels(low - reach, low, [], 1.5 * h)
            .into_iter()
            .chain(panels(high, high + reach, [], 1.5 * h));
        cuts.extend(beyond);
        panels_of(self.truth, low - reach, high + reach, cuts)
    }

    /// The bandwidth of least MISE and other local minima that lie 30 % apart or more.
    pub fn optimum(&self, draws: f64) -> Optimum {
        let deviation = self.truth.mean_and_deviation().1;
        let least = self.truth.finest_scale(0) * 0.05_f64.min(1.0 / draws.sqrt());
        let least = least.max(self.least());
        optimum::search_coarsely(|h| self.at(h, draws), least, 8.0 * deviation)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::density::named;
    use crate::theory::{KernelError, adaptive_moments};

    const ABRAMSON: WidthLaw = WidthLaw {
        exponent: 0.5,
        clip: 0.1,
    };

    /// Widths that do not adapt are fixed ones, whose errors are known otherwise.
    #[test]
    fn exponent_zero_is_the_fixed_kernel() {
        let law = WidthLaw {
            exponent: 0.0,
            ..ABRAMSON
        };
        for (name, h) in [
            ("normal", 0.4),
            ("claw", 0.07),
            ("uniform", 0.1),
            ("exponential", 0.3),
        ] {
            let truth = named(name).unwrap();
            for (shape, digits) in [
                (Shape::Gaussian, 1e-7),
                (Shape::Epanechnikov, 2e-4),
                (Shape::Uniform, 2e-4),
            ] {
                let known = KernelError::new(&*truth, shape).at(h, 200.0);
                let found = AdaptiveError::new(&*truth, shape, law, FixedPilot::Truth).at(h, 200.0);
                for (a, b) in [
                    (found.squared_bias, known.squared_bias),
                    (found.variance, known.variance),
                ] {
                    assert!(
                        (a / b - 1.0).abs() < digits,
                        "{name} {shape}: {found:?} {known:?}"
                    );
                }
            }
        }
    }

    /// Moments at places integrated over the line, each by quadrature cut where its window ends.
    #[test]
    fn moments_at_places_integrate_to_the_errors() {
        let truth = named("bimodal").unwrap();
        for (shape, h, digits) in [(Shape::Gaussian, 0.25, 1e-5), (Shape::Biweight, 0.6, 3e-4)] {
            let errors = AdaptiveError::new(&*truth, shape, ABRAMSON, FixedPilot::Truth);
            let found = errors.at(h, 1.0);
            let mean = geometric_mean_of(&*truth, &|y| truth.at([y]));
            let width = |y: f64| h * ABRAMSON.stretch(truth.at([y]), mean);
            let cuts = errors.bends(errors.known.as_ref().unwrap());
            assert_eq!(cuts.len(), 2);
            let (mut bias, mut variance) = (Sum::default(), Sum::default());
            let step = 0.05;
            for i in -160..=160 {
                let x = f64::from(i) * step;
                let m = adaptive_moments(&*truth, shape, width, &cuts, 1.0, x);
                bias.add(step * (m.mean - truth.at([x])).powi(2));
                variance.add(step * m.variance);
            }
            let (bias, variance) = (bias.value(), variance.value());
            assert!(
                (found.squared_bias / bias - 1.0).abs() < digits,
                "{found:?} {bias}"
            );
            assert!(
                (found.variance / variance - 1.0).abs() < digits,
                "{found:?} {variance}"
            );
        }
    }

    /// What it is for: at its best the adaptive estimate has a smaller error than the best fixed one, and its best bandwidth is a low.
    #[test]
    fn the_best_member_is_better_than_its_neighbours_and_than_any_fixed_width() {
        let truth = named("normal").unwrap();
        let n = 1e4;
        let errors = AdaptiveError::new(&*truth, Shape::Gaussian, ABRAMSON, FixedPilot::Truth);
        let best = errors.optimum(n);
        for factor in [0.9, 1.1] {
            assert!(errors.at(factor * best.at, n).mise() > best.error.mise());
        }
        let fixed = KernelError::new(&*truth, Shape::Gaussian).optimum(n);
        assert!(
            best.error.mise() < 0.96 * fixed.error.mise(),
            "{best:?} {fixed:?}"
        );
        // a pilot as smooth as the estimate is hardly worse than the density itself
        for pilot in [FixedPilot::Tied, FixedPilot::Smoothed(0.2)] {
            let other = AdaptiveError::new(&*truth, Shape::Gaussian, ABRAMSON, pilot).optimum(n);
            let ratio = other.error.mise() / best.error.mise();
            assert!((0.7..1.3).contains(&ratio), "{ratio}");
        }
    }
}
