//! Integrated errors of histograms of the plane.

use super::deficit::PlaneDeficit;
use crate::density::Bivariate;
use crate::numeric::Sum;
use crate::theory::{Asymptotic, Integrated, NoAsymptotics, Optimum, optimum};

/// The integrated errors over the whole plane of histograms of square bins with a corner at (origin, origin), for any width and sample size.
pub struct PlaneHistogramError<'a> {
    truth: &'a dyn Bivariate,
    origin: f64,
    /// ∫f²
    roughness: f64,
}

/// Bins beyond this many are too fine to be searched.
const MOST_BINS: f64 = 4e6;

impl<'a> PlaneHistogramError<'a> {
    /// The errors; `None` for a density whose ∫f² is not known, which is neither a normal mixture nor a product.
    pub fn new(truth: &'a dyn Bivariate, origin: f64) -> Option<Self> {
        Some(Self {
            truth,
            origin,
            roughness: PlaneDeficit::of(truth)?.total(),
        })
    }

    /// With pⱼ the probabilities of the bins and A their area, bias² = ∫f² - Σpⱼ²/A and variance = (1 - Σpⱼ²)/(n A), as counts are multinomial.
    /// One probability for each bin that the density reaches.
    pub fn at(&self, width: f64, draws: f64) -> Integrated {
        let (low, high) = self.truth.bulk(1e-12);
        let number = |x: f64| ((x - self.origin) / width).floor();
        let edge = |k: f64| k.mul_add(width, self.origin);
        let mut squares = Sum::default();
        let [columns, rows] =
            [0, 1].map(|k: usize| (number(high[k]) - number(low[k])) as usize + 1);
        for i in 0..columns {
            let left = number(low[0]) + i as f64;
            for j in 0..rows {
                let below = number(low[1]) + j as f64;
                let p = self.truth.probability(
                    [edge(left), edge(below)],
                    [edge(left + 1.0), edge(below + 1.0)],
                );
                squares.add(p * p);
            }
        }
        let area = width * width;
        let squares = squares.value();
        Integrated {
            squared_bias: (self.roughness - squares / area).max(0.0),
            variance: (1.0 - squares) / (draws * area),
        }
    }

    /// The leading terms for large samples.
    ///
    /// # Errors
    /// If ∫|∇f|² is infinite, so that there are none.
    pub fn asymptotic(&self, draws: f64) -> Result<Asymptotic, NoAsymptotics> {
        Asymptotic::of_plane_histogram(self.truth.gradient_roughness(), draws)
    }

    /// The width of least MISE and other local minima that lie 30 % apart or more.
    pub fn optimum(&self, draws: f64) -> Optimum {
        let (low, high) = self.truth.bulk(1e-12);
        let across = (high[0] - low[0]).max(high[1] - low[1]);
        let (_, covariance) = self.truth.mean_and_covariance();
        let deviation = covariance[0][0].max(covariance[1][1]).sqrt();
        let finest = self.truth.finest_scale(0).min(self.truth.finest_scale(1));
        let least = match self.asymptotic(draws) {
            Ok(asymptotic) => (0.3 * asymptotic.best()).min(0.3 * finest),
            Err(_) => finest * draws.powf(-1.0 / 3.0).min(0.1),
        };
        let least = least.max(across / MOST_BINS.sqrt());
        optimum::search_coarsely(|width| self.at(width, draws), least, 10.0 * deviation)
    }
}
