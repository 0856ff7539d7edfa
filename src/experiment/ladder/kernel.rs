//! The rungs of all estimators: the best Gaussian kernel, of one bandwidth and of one for each place, by moments on a ladder of bandwidths.

use super::held;
use super::lattice::Lattice;
use super::moments::KernelMoments;
use crate::density::Density;
use crate::numeric::{Sum, minimise};
use crate::space::Grid;
use crate::theory::{Integrated, Moments};
use rayon::prelude::*;

/// The ratio of bandwidths that follow each other, between which moments are interpolated.
const RATIO: f64 = 1.1;
/// Bandwidths between two of these that are looked at before the best is refined.
const BETWEEN: usize = 4;

/// Moments of Gaussian kernel estimates of one point, for many bandwidths.
pub(super) struct KernelRungs {
    /// The errors over all places with each bandwidth.
    whole: Vec<Integrated>,
    /// At some of the places the density, and the moments with each bandwidth.
    few: Vec<(f64, Vec<Moments>)>,
    /// The measure of what each of these stands for.
    share: f64,
}

impl KernelRungs {
    /// On the places of a grid, where the density has the values `known`, for samples of up to `draws` points; `None` where there are no moments.
    ///
    /// Some hundred times the moments at all places, once for all sizes.
    pub fn new<const D: usize>(
        truth: &dyn Density<D>,
        grid: &Grid<D>,
        known: &[f64],
        draws: f64,
    ) -> Option<Self> {
        let source = KernelMoments::of(truth)?;
        let places = Lattice::of(truth, grid, known, source.are_closed())?;
        let [low, high] = source.range(draws);
        let steps = ((high / low).ln() / RATIO.ln()).ceil().max(4.0) as usize + 1;
        let ratio = (high / low).ln() / (steps - 1) as f64;
        let bandwidths: Vec<f64> = (0..steps).map(|i| low * (ratio * i as f64).exp()).collect();
        let of_each: Vec<(Integrated, Vec<Moments>)> = bandwidths
            .par_iter()
            .map(|&h| {
                let moments = source.at(h, &places.axes)?;
                let few = places.few.iter().map(|&i| moments[places.all[i].0]);
                Some((places.integrated(&moments), few.collect()))
            })
            .collect::<Option<_>>()?;
        let few = places.few.iter().enumerate().map(|(at, &i)| {
            let moments = of_each.iter().map(|(_, few)| few[at]);
            (places.all[i].1, moments.collect())
        });
        Some(Self {
            few: few.collect(),
            share: places.cell * places.all.len() as f64 / places.few.len() as f64,
            whole: of_each.into_iter().map(|(whole, _)| whole).collect(),
        })
    }

    /// The least MISE of estimates of one bandwidth from `draws` points, over the places; `None` where none is better than the narrowest and the widest.
    pub fn best(&self, draws: f64) -> Option<f64> {
        let steps = self.whole.len();
        let error = |t: f64| {
            let bias = between(t, steps, |i| self.whole[i].squared_bias);
            bias.max(0.0) + between(t, steps, |i| self.whole[i].variance) / draws
        };
        let (at, error) = least(error, steps);
        let inside = 0.0 < at && at < (steps - 1) as f64;
        inside.then_some(error).and_then(held)
    }

    /// ∫ of the least mean squared error at each place, of all bandwidths that there are moments for.
    pub fn local(&self, draws: f64) -> Option<f64> {
        let errors: Vec<f64> = self
            .few
            .par_iter()
            .map(|(truth, moments)| {
                let steps = moments.len();
                let error = |t: f64| {
                    let bias = between(t, steps, |i| moments[i].mean) - truth;
                    let variance = between(t, steps, |i| moments[i].variance) / draws;
                    bias.mul_add(bias, variance.max(0.0))
                };
                least(error, steps).1
            })
            .collect();
        held(errors.into_iter().collect::<Sum>().value() * self.share)
    }
}

/// The cubic through the four values about `t`, of `steps` values at 0, 1, 2 ...
fn between(t: f64, steps: usize, value: impl Fn(usize) -> f64) -> f64 {
    let from = (t as usize).saturating_sub(1).min(steps - 4);
    let u = t - from as f64;
    let weights = [
        -(u - 1.0) * (u - 2.0) * (u - 3.0) / 6.0,
        u * (u - 2.0) * (u - 3.0) / 2.0,
        -u * (u - 1.0) * (u - 3.0) / 2.0,
        u * (u - 1.0) * (u - 2.0) / 6.0,
    ];
    (0..4).map(|k| weights[k] * value(from + k)).sum()
}

/// Where a function of 0 to `steps` - 1 is least, ends included, and how low it is there. All lows are refined: where the bias passes through zero, that of a large sample is a narrow one.
fn least(error: impl Fn(f64) -> f64, steps: usize) -> (f64, f64) {
    let last = (steps - 1) * BETWEEN;
    let place = |i: usize| i as f64 / BETWEEN as f64;
    let values: Vec<f64> = (0..=last).map(|i| error(place(i))).collect();
    let ends = [0, last].map(|i| (place(i), values[i]));
    let lows = (1..last).filter(|&i| values[i] <= values[i - 1] && values[i] <= values[i + 1]);
    let refined = lows.map(|i| {
        let found = minimise(&error, place(i - 1), place(i + 1), 1e-6);
        if found.value < values[i] {
            (found.at, found.value)
        } else {
            (place(i), values[i])
        }
    });
    let all = ends.into_iter().chain(refined);
    all.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(ends[0])
}

#[cfg(test)]
mod tests {
    use super::KernelRungs;
    use crate::density::{self, Density, PlaneComponent, PlaneMixture, Product, Univariate};
    use crate::experiment::ladder::moments::KernelMoments;
    use crate::kernel::Shape;
    use crate::numeric::{Sum, local_minima};
    use crate::parameter::{Value, Values};
    use crate::space::Grid;
    use crate::theory::{Family, kernel_moments};

    fn rungs<const D: usize>(truth: &dyn Density<D>, grid: &Grid<D>) -> KernelRungs {
        let known: Vec<f64> = grid.centres().map(|x| truth.at(x)).collect();
        KernelRungs::new(truth, grid, &known, 1e6).expect("moments")
    }

    /// Over all of the plane, in closed form.
    fn optimum<const D: usize>(truth: &dyn Density<D>, draws: f64) -> f64 {
        let best = Family::Kernel(Shape::Gaussian).optimum_of(truth, draws);
        best.expect("closed").error.mise()
    }

    /// By trying many bandwidths at each place, of densities with one scale and with details a hundred times as fine.
    #[test]
    fn on_a_line_rungs_are_those_of_closed_forms() {
        for (name, cells) in [("bimodal", 100), ("mw-11", 700), ("mw-14", 700)] {
            let line = density::named(name).expect("in the catalogue");
            let grid = Grid::new([-4.0], [4.0], [cells]).expect("legal");
            rungs_are_those_of_closed_forms(&*line, &grid);
        }
    }

    fn rungs_are_those_of_closed_forms(line: &dyn Univariate, grid: &Grid<1>) {
        let truth: &dyn Density<1> = line;
        let found = rungs(truth, grid);
        let [low, high] = KernelMoments::of(truth).expect("moments").range(1e8);
        for draws in [40.0, 1000.0, 1e6] {
            let ratio = found.best(draws).expect("inside") / optimum(truth, draws);
            // of details a few cells wide, a sum over the grid is off by that much
            assert!((ratio - 1.0).abs() < 2e-3, "{draws}: {ratio}");
            let least = |[x]: [f64; 1]| {
                let error = |h: f64| {
                    let m = kernel_moments(line, Shape::Gaussian, h, draws, x);
                    (m.mean - line.at([x])).powi(2) + m.variance
                };
                let inside = local_minima(error, low, high, 300);
                let inside = inside.first().map_or(f64::INFINITY, |best| best.value);
                inside.min(error(low)).min(error(high))
            };
            let all: Sum = grid.centres().map(least).collect();
            let ratio = found.local(draws).expect("inside") / (all.value() * grid.cell_measure());
            assert!((ratio - 1.0).abs() < 2e-3, "{draws}: {ratio}");
        }
    }

    #[test]
    fn products_are_mixtures() {
        let normal = || density::named("normal").expect("in the catalogue");
        let product = Product::new([normal(), normal()]);
        let mixture = PlaneMixture::new(vec![PlaneComponent {
            weight: 1.0,
            mean: [0.0; 2],
            covariance: [[1.0, 0.0], [0.0, 1.0]],
        }]);
        let mixture = mixture.expect("legal");
        let grid = Grid::new([-5.0; 2], [5.0; 2], [60; 2]).expect("legal");
        let (one, other) = (rungs(&product, &grid), rungs(&mixture, &grid));
        for draws in [40.0, 1000.0, 1e6] {
            let ratio = one.best(draws).expect("inside") / optimum(&mixture, draws);
            assert!((ratio - 1.0).abs() < 1e-3, "{draws}: {ratio}");
            for rung in [KernelRungs::best, KernelRungs::local] {
                let ratio =
                    rung(&one, draws).expect("inside") / rung(&other, draws).expect("inside");
                assert!((ratio - 1.0).abs() < 1e-9, "{draws}: {ratio}");
            }
        }
    }

    /// Between walls no bandwidth that is tried by itself is better, and some are as good.
    #[test]
    fn no_bandwidth_beats_the_rungs_between_walls() {
        for (name, draws) in [
            ("smooth", 3000.0),
            ("highlight", 3000.0),
            ("disc", 1e5),
            ("triangle", 1e5),
        ] {
            let mut values = Values::default();
            if name == "triangle" {
                values.set("slope-x", Value::Number(1.2));
            }
            let entry = density::entry(name).expect("in the catalogue");
            let truth = entry.build(&values).expect("legal").plane().expect("plane");
            let truth: &dyn Density<2> = &*truth;
            let grid = Grid::new([0.0; 2], [1.0; 2], [40; 2]).expect("legal");
            let known: Vec<f64> = grid.centres().map(|x| truth.at(x)).collect();
            let found = rungs(truth, &grid);
            let source = KernelMoments::of(truth).expect("walls");
            let axis: Vec<f64> = (0..40).map(|i| grid.coordinate(0, i)).collect();
            let axes = [axis.clone(), axis];
            let inside = grid.centres().map(|x| truth.domain().contains(x));
            let inside: Vec<bool> = inside.collect();
            let mut least = vec![f64::INFINITY; grid.len()];
            let mut best = f64::INFINITY;
            let [low, high] = source.range(1e6);
            for i in 0..=400 {
                let h = low * (high / low).powf(f64::from(i) / 400.0);
                let moments = source.at(h, &axes).expect("moments");
                let mut whole = Sum::default();
                for (i, (m, f)) in moments.iter().zip(&known).enumerate() {
                    let error = (m.mean - f).powi(2) + m.variance / draws;
                    let error = if inside[i] { error } else { 0.0 };
                    whole.add(error);
                    least[i] = error.min(least[i]);
                }
                best = best.min(whole.value());
            }
            let cell = grid.cell_measure();
            let ratio = found.best(draws).expect("inside") / (best * cell);
            assert!((0.998..1.000_1).contains(&ratio), "{name}: {ratio}");
            let local = least.into_iter().collect::<Sum>().value() * cell;
            let ratio = found.local(draws).expect("inside") / local;
            assert!((0.99..1.000_1).contains(&ratio), "{name}: {ratio}");
        }
    }
}
