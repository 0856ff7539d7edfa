//! Integrated errors of adaptive kernel estimates of the plane whose pilot is a known function.

use super::pointwise::plane_kernel_moments;
use crate::density::Bivariate;
use crate::kernel::{Kernel, Shape, Symmetry};
use crate::numeric::{GaussLegendre, Sum, panels};
use crate::space::Point;
use crate::theory::optimum::{self, Optimum};
use crate::theory::{FixedPilot, Integrated, WidthLaw, kernel_moments};
use rayon::prelude::*;
use std::sync::LazyLock;

/// Beyond so many deviations the Gaussian kernel is left out: 2e-12 of its peak.
const GAUSSIAN_REACH: f64 = 7.3;

/// Kernels that end are sampled at so many places for each width.
const FINE: f64 = 24.0;

/// The most parts of the density along an axis.
const MOST: f64 = 3000.0;

static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(6));

/// The integrated errors over the whole plane of adaptive estimates with a fixed pilot, for any bandwidth and sample size; a datum has one width for both axes.
///
/// As on the line, with variance = (R(K) ∫ f/(hs)² - ∫m²)/n, by sums over products of places: equally spaced for normal mixtures, where such sums are good to some 1e-6 of the error but for the bend of the
/// width where the clip sets in (1e-4), and panels between walls for products of densities. Kernels that end are sampled at two dozen places a width, which gives their errors to some 1e-3. Tens to hundreds of milliseconds a bandwidth.
pub struct PlaneAdaptiveError<'a> {
    truth: &'a dyn Bivariate,
    shape: Shape,
    symmetry: Symmetry,
    law: WidthLaw,
    pilot: FixedPilot,
}

/// Places along an axis, ascending, with their weights.
type Axis = Vec<(f64, f64)>;

impl<'a> PlaneAdaptiveError<'a> {
    /// The errors; `None` for a density that is neither a normal mixture nor a product, for the uniform kernel, whose jump would need more places, for a pilot that is not known in closed form or from those of the axes, and where there is next to no clip.
    pub fn new(
        truth: &'a dyn Bivariate,
        (shape, symmetry): (Shape, Symmetry),
        law: WidthLaw,
        pilot: FixedPilot,
    ) -> Option<Self> {
        let mixture = truth.normal_components().is_some();
        let product = truth.factors().is_some();
        let round = shape == Shape::Gaussian;
        let pilot_known = pilot == FixedPilot::Truth
            || (mixture && round)
            || (product && !mixture && (round || symmetry == Symmetry::Product));
        let known = (mixture || product) && shape != Shape::Uniform && pilot_known;
        let errors = Self {
            truth,
            shape,
            symmetry,
            law,
            pilot,
        };
        let known = known && law.is_held() && !truth.domain().wraps();
        (known && errors.most() > errors.deviation()).then_some(errors)
    }

    /// The greatest bandwidth for which there are not too many places.
    fn most(&self) -> f64 {
        if self.truth.normal_components().is_none() {
            return f64::INFINITY;
        }
        let longest = MOST * self.fine();
        let room = |axis: usize| (longest - self.across(axis)) / (2.0 * self.reach());
        room(0).min(room(1)) / self.law.widest()
    }

    fn deviation(&self) -> f64 {
        let (_, covariance) = self.truth.mean_and_covariance();
        covariance[0][0].max(covariance[1][1]).sqrt()
    }

    /// How far apart places are where a mixture is integrated: a bias of fourth order changes within less than the density does.
    fn fine(&self) -> f64 {
        0.2 * (self.truth.finest_scale(0)).min(self.truth.finest_scale(1))
    }

    /// Where the kernel ends, in bandwidths.
    fn reach(&self) -> f64 {
        if self.is_round() { GAUSSIAN_REACH } else { 1.0 }
    }

    /// How far apart places are, in units of the least width.
    fn step(&self) -> f64 {
        if self.is_round() { 0.6 } else { 1.0 / FINE }
    }

    fn is_round(&self) -> bool {
        self.shape == Shape::Gaussian
    }

    /// The values of the pilot with bandwidth `b` (or of the density) on a product of places, row by row of the first axis.
    fn pilot_on(&self, b: Option<f64>, [xs, ys]: [&Axis; 2]) -> Vec<f64> {
        let factors = self
            .truth
            .factors()
            .filter(|_| self.truth.normal_components().is_none());
        if let Some(factors) = factors {
            let along = |axis: usize, places: &Axis| -> Vec<f64> {
                (places.par_iter())
                    .map(|&(x, _)| match b {
                        None => factors[axis].at([x]),
                        Some(b) => kernel_moments(factors[axis], self.shape, b, 1.0, x).mean,
                    })
                    .collect()
            };
            let (first, second) = (along(0, xs), along(1, ys));
            return (first.iter())
                .flat_map(|f| second.iter().map(move |g| f * g))
                .collect();
        }
        let value = |x: Point<2>| match b {
            None => self.truth.at(x),
            Some(b) => {
                let (shape, symmetry) = (self.shape, self.symmetry);
                plane_kernel_moments(self.truth, shape, symmetry, [b; 2], 1.0, x).mean
            }
        };
        (xs.par_iter())
            .flat_map_iter(|&(x, _)| ys.iter().map(move |&(y, _)| value([x, y])))
            .collect()
    }

    /// The densities' mass at each of a product of places.
    fn masses(&self, [xs, ys]: [&Axis; 2]) -> Vec<f64> {
        let mut values = self.pilot_on(None, [xs, ys]);
        for (row, &(_, a)) in values.chunks_mut(ys.len()).zip(xs) {
            for (value, &(_, b)) in row.iter_mut().zip(ys) {
                *value *= a * b;
            }
        }
        values
    }

    /// Places at which the density is known well, none further apart than `longest`.
    fn axis(&self, axis: usize, longest: f64) -> Axis {
        let (low, high) = self.truth.bulk(1e-14);
        let (low, high) = (low[axis], high[axis]);
        let scale = self.truth.finest_scale(0).min(self.truth.finest_scale(1));
        if self.truth.normal_components().is_some() {
            return even(low, high, longest.min(0.5 * scale));
        }
        let longest = (6.0 * longest).min(self.truth.finest_scale(axis));
        let cuts = panels(low, high, self.truth.breaks(axis), longest);
        let parts = cuts.windows(2);
        parts.flat_map(|part| RULE.on(part[0], part[1])).collect()
    }

    /// exp ∫ f log p.
    fn geometric_mean(&self, b: Option<f64>) -> f64 {
        let axes = [0, 1].map(|axis| self.axis(axis, f64::INFINITY));
        let axes = [&axes[0], &axes[1]];
        let (pilot, masses) = (self.pilot_on(b, axes), self.masses(axes));
        let (mut total, mut sum) = (Sum::default(), Sum::default());
        for (p, mass) in pilot.into_iter().zip(masses) {
            if p > 0.0 && mass > 0.0 {
                total.add(mass);
                sum.add(mass * p.ln());
            }
        }
        (sum.value() / total.value()).exp()
    }

    /// The least width over h: on some thousand places of the bulk.
    fn narrowest(&self, b: Option<f64>, mean: f64) -> f64 {
        let (low, high) = self.truth.bulk(1e-6);
        let axes = [0, 1].map(|k: usize| even(low[k], high[k], (high[k] - low[k]) / 64.0));
        let values = self.pilot_on(b, [&axes[0], &axes[1]]).into_iter();
        let stretches = values.map(|p| self.law.stretch(p, mean));
        stretches.fold(f64::INFINITY, f64::min)
    }

    /// The errors with bandwidth `h` and `draws` points (or the effective size of a weighted sample); not numbers for widths below some thousandth of the density's (a hundredth for kernels that end), or so far above them that there would be millions of places.
    pub fn at(&self, h: f64, draws: f64) -> Integrated {
        let b = self.pilot.bandwidth(h);
        let mean = self.geometric_mean(b);
        let least = h * self.narrowest(b, mean);
        let step = least * self.step();
        if h > self.most() || (0..2).any(|axis| self.across(axis) > MOST * step) {
            // so narrow that the density has too many parts, or so wide that the estimate has: not known
            return Integrated {
                squared_bias: f64::NAN,
                variance: f64::NAN,
            };
        }
        let from = [0, 1].map(|axis| self.axis(axis, step));
        let from = [&from[0], &from[1]];
        let widths: Vec<f64> = (self.pilot_on(b, from).into_iter())
            .map(|p| h * self.law.stretch(p, mean))
            .collect();
        let masses = self.masses(from);
        let own: Sum = (masses.iter().zip(&widths))
            .map(|(mass, width)| mass / (width * width))
            .collect();
        let to = [0, 1].map(|axis| self.places(axis, least, h * self.law.widest()));
        let to = [&to[0], &to[1]];
        let smoothed = self.spread(from, &masses, &widths, to);
        let truth = self.pilot_on(None, to);
        let (mut squared_bias, mut squares) = (Sum::default(), Sum::default());
        for (i, &(_, a)) in to[0].iter().enumerate() {
            for (j, &(_, b)) in to[1].iter().enumerate() {
                let place = i * to[1].len() + j;
                squared_bias.add(a * b * (smoothed[place] - truth[place]).powi(2));
                squares.add(a * b * smoothed[place] * smoothed[place]);
            }
        }
        let own = self.symmetry.roughness::<2>(self.shape) * own.value();
        Integrated {
            squared_bias: squared_bias.value(),
            variance: ((own - squares.value()) / draws).max(0.0),
        }
    }

    fn across(&self, axis: usize) -> f64 {
        let (low, high) = self.truth.bulk(1e-14);
        high[axis] - low[axis]
    }

    /// Where m is integrated: it is as smooth as the density but for breaks, from which it is known by places that close in on them.
    fn places(&self, axis: usize, least: f64, widest: f64) -> Axis {
        let reach = self.reach();
        let (low, high) = self.truth.bulk(1e-14);
        let (low, high) = (low[axis] - reach * widest, high[axis] + reach * widest);
        if self.truth.normal_components().is_some() {
            return even(low, high, self.fine());
        }
        let mut cuts = Vec::new();
        for place in self.truth.breaks(axis) {
            let mut away = 0.5 * least;
            while away < reach * widest {
                cuts.extend([place - away, place + away]);
                away *= 2.0;
            }
            cuts.extend([place, place - reach * widest, place + reach * widest]);
        }
        cuts.retain(|cut| cut.is_finite());
        let cuts = panels(low, high, cuts, self.truth.finest_scale(axis).max(least));
        let parts = cuts.windows(2);
        parts.flat_map(|part| RULE.on(part[0], part[1])).collect()
    }

    /// m at a product of places: each mass is spread over those that it reaches. In blocks of rows, whose sums are added in their order.
    fn spread(
        &self,
        [us, vs]: [&Axis; 2],
        masses: &[f64],
        widths: &[f64],
        [xs, ys]: [&Axis; 2],
    ) -> Vec<f64> {
        const BLOCKS: usize = 8;
        let reach = self.reach();
        let product = self.is_round() || self.symmetry == Symmetry::Product;
        // a product of two Gaussians is round and has unit mass already
        let factor = if self.is_round() {
            1.0
        } else {
            self.symmetry.factor::<2>(self.shape)
        };
        let size = xs.len() * ys.len();
        let near = |axis: &Axis, place: f64, reach: f64| {
            let first = axis.partition_point(|x| x.0 < place - reach);
            first..first + axis[first..].partition_point(|x| x.0 <= place + reach)
        };
        let block = |block: usize| -> Vec<f64> {
            let mut smoothed = vec![0.0; size];
            let (mut rows, mut columns) = (Vec::new(), Vec::new());
            for i in (0..us.len()).filter(|i| i * BLOCKS / us.len() == block) {
                for j in 0..vs.len() {
                    let (mass, width) = (masses[i * vs.len() + j], widths[i * vs.len() + j]);
                    if mass < 1e-18 {
                        continue;
                    }
                    let (x, y) = (us[i].0, vs[j].0);
                    let (across, along) = (near(xs, x, reach * width), near(ys, y, reach * width));
                    let scaled = |axis: &[(f64, f64)], place: f64, into: &mut Vec<f64>| {
                        into.clear();
                        into.extend(axis.iter().map(|other| (other.0 - place) / width));
                    };
                    scaled(&xs[across.clone()], x, &mut rows);
                    scaled(&ys[along.clone()], y, &mut columns);
                    let scale = mass * factor / (width * width);
                    if product {
                        for u in rows.iter_mut().chain(&mut columns) {
                            *u = self.shape.value(*u);
                        }
                    }
                    for (row, &u) in across.zip(&rows) {
                        let line = &mut smoothed[row * ys.len()..][along.clone()];
                        if product {
                            let scale = scale * u;
                            for (sum, v) in line.iter_mut().zip(&columns) {
                                *sum += scale * v;
                            }
                        } else {
                            for (sum, v) in line.iter_mut().zip(&columns) {
                                *sum += scale * self.shape.of_square(u * u + v * v);
                            }
                        }
                    }
                }
            }
            smoothed
        };
        let blocks: Vec<Vec<f64>> = (0..BLOCKS).into_par_iter().map(block).collect();
        let mut total = vec![0.0; size];
        for block in blocks {
            total
                .iter_mut()
                .zip(block)
                .for_each(|(sum, part)| *sum += part);
        }
        total
    }

    /// The bandwidth of least MISE and other local minima that lie 30 % apart or more.
    pub fn optimum(&self, draws: f64) -> Optimum {
        let finest = self.truth.finest_scale(0).min(self.truth.finest_scale(1));
        let least = finest * 0.1_f64.min(0.5 / draws.sqrt());
        let b = self.pilot.bandwidth(least);
        let narrowest = self.narrowest(b, self.geometric_mean(b));
        let across = self.across(0).max(self.across(1));
        let least = least.max(1.1 * across / (MOST * self.step() * narrowest));
        optimum::search_coarsely(
            |h| self.at(h, draws),
            least,
            self.most().min(5.0 * self.deviation()),
        )
    }
}

/// Places `step` apart or a little less, each with the length that it stands for.
fn even(low: f64, high: f64, step: f64) -> Axis {
    let parts = ((high - low) / step).ceil().max(1.0);
    let step = (high - low) / parts;
    (0..parts as usize)
        .map(|i| ((i as f64 + 0.5).mul_add(step, low), step))
        .collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::density::{PlaneComponent, PlaneMixture, Product, named, named_in_plane};
    use crate::theory::PlaneKernelError;
    use std::f64::consts::PI;

    const ABRAMSON: WidthLaw = WidthLaw {
        exponent: 0.5,
        clip: 0.1,
    };

    fn close(found: Integrated, known: Integrated, digits: f64, what: &str) {
        for (a, b) in [
            (found.squared_bias, known.squared_bias),
            (found.variance, known.variance),
        ] {
            assert!((a / b - 1.0).abs() < digits, "{what}: {found:?} {known:?}");
        }
    }

    /// Widths that do not adapt are fixed ones, whose errors are known otherwise.
    #[test]
    fn exponent_zero_is_the_fixed_kernel() {
        let law = WidthLaw {
            exponent: 0.0,
            ..ABRAMSON
        };
        let mixture = PlaneMixture::new(vec![
            PlaneComponent::new(0.5, [-1.0, 0.0], [0.5, 0.8], 0.6),
            PlaneComponent::new(0.5, [1.0, 0.5], [0.7, 0.4], 0.0),
        ])
        .unwrap();
        let product = Product::new([named("ramp-up").unwrap(), named("bimodal").unwrap()]);
        for (truth, h) in [(&mixture as &dyn Bivariate, 0.3), (&product, 0.2)] {
            for (shape, symmetry, digits) in [
                (Shape::Gaussian, Symmetry::Product, 1e-5),
                (Shape::Gaussian, Symmetry::Radial, 1e-5),
                (Shape::Epanechnikov, Symmetry::Radial, 3e-3),
                (Shape::Biweight, Symmetry::Product, 3e-3),
            ] {
                let known = PlaneKernelError::new(truth, shape, symmetry).unwrap();
                let found =
                    PlaneAdaptiveError::new(truth, (shape, symmetry), law, FixedPilot::Truth)
                        .unwrap()
                        .at(h, 100.0);
                close(found, known.at([h; 2], 100.0), digits, shape.name());
            }
        }
    }

    /// A round density under a round kernel: m by circles, on which the kernel has a closed integral, and its errors by rings.
    #[test]
    fn circles_and_rings_agree() {
        const CIRCLES: usize = 20_000;
        let truth = named_in_plane("normal-2d").unwrap();
        let f = |r: f64| truth.at([r, 0.0]);
        let kernel = (Shape::Epanechnikov, Symmetry::Radial);
        let h = 0.6;
        let errors = PlaneAdaptiveError::new(&*truth, kernel, ABRAMSON, FixedPilot::Truth).unwrap();
        let mean = 1.0 / (2.0 * PI * std::f64::consts::E);
        // the radius of a circle, its mass over 2π, and the width there
        let circles: Vec<[f64; 3]> = (0..CIRCLES)
            .map(|i| {
                let r = (i as f64 + 0.5) * 9.0 / CIRCLES as f64;
                let mass = r * f(r) * 9.0 / CIRCLES as f64;
                [r, mass, h * ABRAMSON.stretch(f(r), mean)]
            })
            .collect();
        let smoothed = |x: f64| -> f64 {
            let parts = circles.iter().map(|&[r, mass, width]| {
                let square = width * width;
                let end = ((x * x + r * r - square) / (2.0 * x * r))
                    .clamp(-1.0, 1.0)
                    .acos();
                let level = 1.0 - (x * x + r * r) / square;
                // (2/π) ∫ (1 - |x - y|²/width²) over the angles that the kernel reaches
                let inside = 2.0 * (level * end + 2.0 * x * r / square * end.sin());
                mass * 2.0 / PI / square * inside
            });
            parts.sum()
        };
        let (mut bias, mut squares) = (Sum::default(), Sum::default());
        for ring in panels(0.0, 7.0, [], 0.5).windows(2) {
            for (x, weight) in RULE.on(ring[0], ring[1]) {
                let (ring, m) = (2.0 * PI * x * weight, smoothed(x));
                bias.add(ring * (m - f(x)).powi(2));
                squares.add(ring * m * m);
            }
        }
        let own: f64 = (circles.iter())
            .map(|[_, mass, width]| 2.0 * PI * mass / (width * width))
            .sum();
        let known = Integrated {
            squared_bias: bias.value(),
            variance: 4.0 / (3.0 * PI) * own - squares.value(),
        };
        close(errors.at(h, 1.0), known, 2e-3, "circles");
    }

    #[test]
    fn the_best_member_is_better_than_its_neighbours_and_than_any_fixed_width() {
        let truth = named_in_plane("normal-2d").unwrap();
        let n = 1e4;
        let kernel = (Shape::Gaussian, Symmetry::Product);
        let errors = |pilot| PlaneAdaptiveError::new(&*truth, kernel, ABRAMSON, pilot).unwrap();
        let best = errors(FixedPilot::Truth).optimum(n);
        for factor in [0.9, 1.1] {
            let other = errors(FixedPilot::Truth).at(factor * best.at, n);
            assert!(other.mise() > best.error.mise());
        }
        // at walls the best is narrow
        let walls = Product::new([named("ramp-up").unwrap(), named("ramp-down").unwrap()]);
        let errors_at_walls =
            PlaneAdaptiveError::new(&walls, kernel, ABRAMSON, FixedPilot::Truth).unwrap();
        let narrow = errors_at_walls.optimum(1000.0);
        assert!((0.01..0.2).contains(&narrow.at), "{narrow:?}");
        for factor in [0.8, 1.25] {
            let other = errors_at_walls.at(factor * narrow.at, 1000.0);
            assert!(other.mise() > narrow.error.mise(), "{narrow:?} {other:?}");
        }
        assert!(errors_at_walls.at(1e-6, 1000.0).mise().is_nan());
        let fixed = PlaneKernelError::new(&*truth, kernel.0, kernel.1)
            .unwrap()
            .optimum(n);
        assert!(
            best.error.mise() < 0.98 * fixed.error.mise(),
            "{best:?} {fixed:?}"
        );
        let tied = errors(FixedPilot::Tied).at(best.at, n).mise() / best.error.mise();
        assert!((0.7..1.3).contains(&tied), "{tied}");
        let disc = named_in_plane("disc").unwrap();
        let refused = PlaneAdaptiveError::new(&*disc, kernel, ABRAMSON, FixedPilot::Truth);
        assert!(refused.is_none());
    }
}
