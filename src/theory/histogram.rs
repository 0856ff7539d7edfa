//! Integrated errors of histograms.

use super::optimum::{self, Optimum, Oracle};
use super::{Asymptotic, Integrated, NoAsymptotics};
use crate::density::Univariate;
use crate::numeric::Sum;

/// The integrated errors over the whole line of histograms of one density with bins that start at one origin, for any width and sample size.
pub struct HistogramError<'a> {
    truth: &'a dyn Univariate,
    origin: f64,
}

impl<'a> HistogramError<'a> {
    /// Histograms of samples from `truth` with an edge at `origin`.
    pub fn new(truth: &'a dyn Univariate, origin: f64) -> Self {
        Self { truth, origin }
    }

    /// The errors with bins of this `width` and `draws` points (or the effective size of a weighted sample).
    ///
    /// With pⱼ the probabilities of the bins, bias² = R(f) - Σpⱼ²/width and variance = (1 - Σpⱼ²)/(n·width), exactly. Cost: one evaluation of the
    /// distribution function for each bin that the density reaches.
    pub fn at(&self, width: f64, draws: f64) -> Integrated {
        let ([low], [high]) = self.truth.bulk(1e-18);
        let (first, last) = (
            ((low - self.origin) / width).floor(),
            ((high - self.origin) / width).floor(),
        );
        let below = |k: f64| self.truth.distribution(k.mul_add(width, self.origin));
        let mut squares = Sum::default();
        let (mut k, mut before) = (first, below(first));
        while k <= last {
            k += 1.0;
            let now = below(k);
            squares.add((now - before).powi(2));
            before = now;
        }
        let squares = squares.value();
        Integrated {
            squared_bias: (self.truth.roughness(0) - squares / width).max(0.0),
            variance: (1.0 - squares).max(0.0) / (draws * width),
        }
    }

    /// The leading terms for large samples, which do not depend on the origin.
    ///
    /// # Errors
    /// If R(f') is infinite, so that there are none.
    pub fn asymptotic(&self, draws: f64) -> Result<Asymptotic, NoAsymptotics> {
        Asymptotic::of_histogram(self.truth.roughness(1), draws)
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
        optimum::search(|width| self.at(width, draws), low, 20.0 * deviation)
    }

    /// The optimum and the asymptotics for samples of `draws` points.
    pub fn oracle(&self, draws: f64) -> Oracle {
        Oracle {
            optimum: self.optimum(draws),
            asymptotic: self.asymptotic(draws),
        }
    }
}
