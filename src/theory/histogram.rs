//! Integrated errors of histograms and of their smoother relatives.

use super::optimum::{self, Optimum, Oracle};
use super::{Asymptotic, Integrated, NoAsymptotics, panels_of};
use crate::density::Univariate;
use crate::numeric::{GaussLegendre, Sum};

/// The integrated errors over the whole line of binned estimates of one density with bins that start at one origin, for any width and sample size.
pub struct HistogramError<'a> {
    truth: &'a dyn Univariate,
    origin: f64,
    kind: Kind,
}

/// The most shifts that are searched over all widths.
const SEARCHED: u32 = 32;

/// Σ of each `m` neighbours, the row taken to be longer by m - 1 zeros on either side: m - 1 more sums than numbers.
///
/// By differences of a compensated prefix sum, so that nothing drifts: good to 1e-16 of the total.
fn sliding(row: &[f64], m: usize) -> Vec<f64> {
    if m == 1 {
        return row.to_vec();
    }
    let mut sum = Sum::default();
    let before: Vec<f64> = std::iter::once(0.0)
        .chain(row.iter().map(|&x| {
            sum.add(x);
            sum.value()
        }))
        .collect();
    let upto = |k: usize| before[k.min(row.len())];
    (0..row.len() + m - 1)
        .map(|k| upto(k + 1) - upto((k + 1).saturating_sub(m)))
        .collect()
}

#[derive(Clone, Copy)]
enum Kind {
    /// Flat on narrow bins: the mean of so many histograms; of one, the histogram itself.
    Shifted(u32),
    /// Straight between the centres of the bins.
    Polygon,
}

impl<'a> HistogramError<'a> {
    /// Histograms of samples from `truth` with an edge at `origin`.
    pub fn new(truth: &'a dyn Univariate, origin: f64) -> Self {
        Self::shifted(truth, origin, 1)
    }

    /// Means of `shifts` histograms whose origins are width/shifts apart, one of them at `origin`.
    pub fn shifted(truth: &'a dyn Univariate, origin: f64, shifts: u32) -> Self {
        let kind = Kind::Shifted(shifts.max(1));
        Self {
            truth,
            origin,
            kind,
        }
    }

    /// Frequency polygons through the histograms with an edge at `origin`.
    pub fn polygon(truth: &'a dyn Univariate, origin: f64) -> Self {
        Self {
            truth,
            origin,
            kind: Kind::Polygon,
        }
    }

    /// The errors with bins of this `width` and `draws` points (or the effective size of a weighted sample), exactly: the counts are multinomial.
    ///
    /// For the histogram, with pⱼ the probabilities of the bins, bias² = R(f) - Σpⱼ²/width and variance = (1 - Σpⱼ²)/(n·width).
    /// Cost: one evaluation of the distribution function for each (narrow) bin that the density reaches; for polygons 24 of the density more.
    pub fn at(&self, width: f64, draws: f64) -> Integrated {
        match self.kind {
            Kind::Shifted(shifts) => self.flat(width, shifts as usize, draws),
            Kind::Polygon => self.straight(width, draws),
        }
    }

    /// The probabilities of the bins of this width that the density reaches, and the number of the first.
    fn probabilities(&self, width: f64) -> (f64, Vec<f64>) {
        let ([low], [high]) = self.truth.bulk(1e-18);
        let number = |x: f64| ((x - self.origin) / width).floor();
        let (first, last) = (number(low), number(high));
        let below = |k: f64| self.truth.distribution(k.mul_add(width, self.origin));
        let mut before = below(first);
        let bins = (last - first) as usize + 1;
        let probabilities = (1..=bins)
            .map(|i| {
                let now = below(first + i as f64);
                let inside = now - before;
                before = now;
                inside
            })
            .collect();
        (first, probabilities)
    }

    /// With δ = width/m, cᵢ = (1 - |i|/m)/width and mₖ = Σ cᵢ pₖ₊ᵢ the mean on the narrow bin k: bias² = R(f) - 2 Σ pₖ mₖ + δ Σ mₖ² and
    /// variance = (δ Σ cᵢ² - δ Σ mₖ²)/n.
    ///
    /// mₖ is the mean of the m histogram bars over bin k, and bars are m narrow bins: two sliding sums, so that the cost does not grow with m beyond
    /// the number of bins.
    fn flat(&self, width: f64, m: usize, draws: f64) -> Integrated {
        let narrow = width / m as f64;
        let (_, p) = self.probabilities(narrow);
        let (mut squares, mut overlap) = (Sum::default(), Sum::default());
        // the bars of all m histograms, then all that lie over each narrow bin
        let bars = sliding(&p, m);
        for (k, total) in sliding(&bars, m).into_iter().enumerate() {
            let mean = total / m as f64 / width;
            squares.add(mean * mean);
            if let Some(p) = k.checked_sub(m - 1).and_then(|here| p.get(here)) {
                overlap.add(p * mean);
            }
        }
        let squares = narrow * squares.value();
        let m = m as f64;
        let peak = (2.0 * m * m + 1.0) / (3.0 * m * m * width);
        Integrated {
            squared_bias: ((self.truth.roughness(0) - overlap.value())
                - (overlap.value() - squares))
                .max(0.0),
            variance: (peak - squares).max(0.0) / draws,
        }
    }

    /// With Aₖ = pₖ/width at the centres: ∫ mean² = width Σ (Aₖ² + Aₖ Aₖ₊₁ + Aₖ₊₁²)/3 and variance = (2/(3 width) - ∫ mean²)/n.
    fn straight(&self, width: f64, draws: f64) -> Integrated {
        let (first, p) = self.probabilities(width);
        let value = |k: isize| {
            let inside = usize::try_from(k).ok().and_then(|k| p.get(k));
            inside.map_or(0.0, |p| p / width)
        };
        let centre = |k: isize| (first + k as f64 + 0.5).mul_add(width, self.origin);
        let last = p.len() as isize;
        let squares: Sum = (-1..last)
            .map(|k| {
                let (a, b) = (value(k), value(k + 1));
                width * (a * a + a * b + b * b) / 3.0
            })
            .collect();
        let rule = GaussLegendre::new(24);
        let ends = (centre(-1), centre(last));
        let mut squared_bias = Sum::default();
        for panel in panels_of(self.truth, ends.0, ends.1, (0..last).map(centre)).windows(2) {
            let place = (0.5 * (panel[0] + panel[1]) - ends.0) / width;
            let left = place.floor() as isize - 1;
            let (start, a, b) = (centre(left), value(left), value(left + 1));
            squared_bias.add(rule.integrate(
                |x| {
                    let mean = ((x - start) / width).mul_add(b - a, a);
                    (mean - self.truth.at([x])).powi(2)
                },
                panel[0],
                panel[1],
            ));
        }
        Integrated {
            squared_bias: squared_bias.value(),
            variance: (2.0 / (3.0 * width) - squares.value()).max(0.0) / draws,
        }
    }

    /// The leading terms for large samples, which do not depend on the origin.
    ///
    /// # Errors
    /// If R(f') or, for the smoother relatives, R(f'') is infinite, so that there are none.
    pub fn asymptotic(&self, draws: f64) -> Result<Asymptotic, NoAsymptotics> {
        let (slope, curvature) = (self.truth.roughness(1), self.truth.roughness(2));
        match self.kind {
            Kind::Shifted(1) => Asymptotic::of_histogram(slope, draws),
            Kind::Shifted(shifts) => {
                Asymptotic::of_shifted_histogram(slope, curvature, f64::from(shifts), draws)
            }
            Kind::Polygon => Asymptotic::of_polygon(curvature, draws),
        }
    }

    /// The width of least MISE and all other local minima, searched from far below the finest scale of the density to 20 of its deviations.
    pub fn optimum(&self, draws: f64) -> Optimum {
        let deviation = self.truth.mean_and_deviation().1;
        let finest = self.truth.finest_scale(0);
        let low = match self.asymptotic(draws) {
            // details that small samples cannot show only ask for wider bins
            Ok(asymptotic) => (0.1 * asymptotic.best()).min(0.1 * finest),
            // at a jump the best width falls as n^(-1/2)
            Err(_) => finest * 0.1_f64.min(0.3 / draws.sqrt()),
        };
        let high = 20.0 * deviation;
        let error = |width| self.at(width, draws);
        match self.kind {
            // the error of many shifts is that of fewer to 1/m²: these are searched, at less cost, and their lows refined
            Kind::Shifted(shifts) if shifts > SEARCHED => {
                let coarse = Self::shifted(self.truth, self.origin, SEARCHED);
                optimum::refine(
                    &optimum::search(|width| coarse.at(width, draws), low, high),
                    error,
                )
            }
            _ => optimum::search(error, low, high),
        }
    }

    /// The optimum and the asymptotics for samples of `draws` points.
    pub fn oracle(&self, draws: f64) -> Oracle {
        Oracle {
            optimum: self.optimum(draws),
            asymptotic: self.asymptotic(draws),
        }
    }
}
