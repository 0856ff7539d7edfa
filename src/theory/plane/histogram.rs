//! Histograms of the plane: the probabilities of their bins, and integrated errors.

use super::deficit::PlaneDeficit;
use crate::density::{Bivariate, Density};
use crate::numeric::Sum;
use crate::space::{Lattice, Point};
use crate::theory::{Asymptotic, Integrated, Moments, NoAsymptotics, Optimum, optimum};
use rayon::prelude::*;

/// Beyond the bulk lies no more than this on each side.
const TAIL: f64 = 1e-18;

/// The probability of a bin.
fn share(truth: &dyn Bivariate, lattice: &Lattice, number: [f64; 2]) -> f64 {
    if lattice.is_turned() {
        let (low, high) = truth.bulk(TAIL);
        truth.probability_within(&lattice.within(number, low, high))
    } else {
        let [low, high] = lattice.edges(number);
        truth.probability(low, high)
    }
}

/// Mean and variance at each of `places` of the histogram with these bins over samples of `draws` points: counts are binomial. Of bins that are turned
/// [`Bivariate::probability_within`] is asked, once for each that holds a place; `None` where the density does not know it.
pub fn plane_histogram_moments(
    truth: &dyn Density<2>,
    lattice: &Lattice,
    draws: f64,
    places: &[Point<2>],
) -> Option<Vec<Moments>> {
    let area = lattice.area();
    let moments = |share: f64| Moments {
        mean: share / area,
        variance: (share * (1.0 - share)).max(0.0) / (draws * area * area),
    };
    if !lattice.is_turned() {
        let at = |x: &Point<2>| {
            let [low, high] = lattice.edges(lattice.number(*x));
            moments(truth.probability(low, high))
        };
        return Some(places.iter().map(at).collect());
    }
    let truth = truth.bivariate()?;
    let order = |a: &[f64; 2], b: &[f64; 2]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
    // adding 0 makes -0 and 0 the same bin
    let number = |x: &Point<2>| lattice.number(*x).map(|k| k + 0.0);
    let mut bins: Vec<[f64; 2]> = places.iter().map(number).collect();
    bins.sort_by(order);
    bins.dedup();
    let known: Vec<Moments> = (bins.par_iter())
        .map(|bin| moments(share(truth, lattice, *bin)))
        .collect();
    let at = |x: &Point<2>| {
        let bin = bins.partition_point(|bin| order(bin, &number(x)).is_lt());
        known[bin]
    };
    Some(places.iter().map(at).collect())
}

/// The integrated errors over the whole plane of histograms of square bins of one density, for any width and sample size.
pub struct PlaneHistogramError<'a> {
    truth: &'a dyn Bivariate,
    origin: Point<2>,
    degrees: f64,
    /// ∫f²
    roughness: f64,
}

/// Bins along an axis beyond this many take too long: some minutes.
const MOST_COLUMNS: f64 = 3e4;

/// Bins beyond this many are too fine to be searched; fewer where each costs an integral.
const MOST_BINS: f64 = 4e6;
const MOST_TURNED_BINS: f64 = 1e6;

impl<'a> PlaneHistogramError<'a> {
    /// The errors of histograms with a corner of a bin at `origin`, turned by an angle in degrees; `None` for a density whose ∫f² is not known, which is neither a normal mixture nor a product.
    pub fn new(truth: &'a dyn Bivariate, origin: Point<2>, degrees: f64) -> Option<Self> {
        Some(Self {
            truth,
            origin,
            degrees,
            roughness: PlaneDeficit::of(truth)?.total(),
        })
    }

    fn lattice(&self, width: f64) -> Lattice {
        Lattice::new([width; 2], self.origin, self.degrees)
    }

    /// With pⱼ the probabilities of the bins and A their area, bias² = ∫f² - Σpⱼ²/A and variance = (1 - Σpⱼ²)/(n A), as counts are multinomial.
    /// One probability for each bin that the density reaches; not numbers where those are more than can be gone through.
    pub fn at(&self, width: f64, draws: f64) -> Integrated {
        let (low, high) = self.truth.bulk(1e-12);
        let lattice = self.lattice(width);
        let [first, last] = lattice.numbers(low, high);
        let [columns, rows] = [0, 1].map(|k: usize| (last[k] - first[k]) as usize + 1);
        if columns.max(rows) as f64 > MOST_COLUMNS {
            return Integrated {
                squared_bias: f64::NAN,
                variance: f64::NAN,
            };
        }
        let column = |i: usize| -> f64 {
            let squares = (0..rows).map(|j| {
                let number = [first[0] + i as f64, first[1] + j as f64];
                share(self.truth, &lattice, number).powi(2)
            });
            squares.collect::<Sum>().value()
        };
        let squares: Vec<f64> = (0..columns).into_par_iter().map(column).collect();
        let squares = squares.into_iter().collect::<Sum>().value();
        let area = width * width;
        Integrated {
            squared_bias: (self.roughness - squares / area).max(0.0),
            variance: (1.0 - squares) / (draws * area),
        }
    }

    /// The leading terms for large samples, which depend neither on the origin nor on the angle.
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
        let bins = if self.lattice(1.0).is_turned() {
            MOST_TURNED_BINS
        } else {
            MOST_BINS
        };
        let least = least.max(across / bins.sqrt());
        optimum::search_coarsely(|width| self.at(width, draws), least, 10.0 * deviation)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::density::{PlaneComponent, PlaneMixture, Product, named, named_in_plane};
    use crate::numeric::GaussLegendre;
    use crate::space::Field;

    /// The mixture turned by an angle about 0.
    fn turned(parts: &[PlaneComponent], degrees: f64) -> PlaneMixture {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let axes = [[cosine, -sine], [sine, cosine]];
        let turn = |part: &PlaneComponent| {
            let entry = |i: usize, j: usize| -> f64 {
                (0..4)
                    .map(|k| (k / 2, k % 2))
                    .map(|(a, b)| axes[i][a] * part.covariance[a][b] * axes[j][b])
                    .sum()
            };
            PlaneComponent {
                weight: part.weight,
                mean: axes.map(|row| row[0] * part.mean[0] + row[1] * part.mean[1]),
                covariance: [[entry(0, 0), entry(0, 1)], [entry(0, 1), entry(1, 1)]],
            }
        };
        PlaneMixture::new(parts.iter().map(turn).collect()).unwrap()
    }

    /// Integrated errors are what moments at places add up to, bin by bin.
    #[test]
    fn moments_at_places_integrate_to_the_errors() {
        let truth = PlaneMixture::new(vec![
            PlaneComponent::new(0.6, [-1.0, 0.2], [0.5, 0.8], 0.6),
            PlaneComponent::new(0.4, [1.0, -0.5], [0.7, 0.4], -0.3),
        ])
        .unwrap();
        let (width, draws, rule) = (0.4, 70.0, GaussLegendre::new(5));
        let axis: Vec<(f64, f64)> = (-17..17)
            .flat_map(|bin| rule.on(f64::from(bin) * width, f64::from(bin + 1) * width))
            .collect();
        for degrees in [0.0, 30.0] {
            let (sine, cosine) = f64::to_radians(degrees).sin_cos();
            let lattice = Lattice::new([width; 2], [0.0; 2], degrees);
            let (mut squared_bias, mut variance) = (0.0, 0.0);
            for &(u, a) in &axis {
                let turn = |&(v, _): &(f64, f64)| [cosine * u - sine * v, sine * u + cosine * v];
                let places: Vec<Point<2>> = axis.iter().map(turn).collect();
                let moments = plane_histogram_moments(&truth, &lattice, draws, &places).unwrap();
                for ((x, moments), (_, b)) in places.iter().zip(moments).zip(&axis) {
                    squared_bias += a * b * (moments.mean - truth.at(*x)).powi(2);
                    variance += a * b * moments.variance;
                }
            }
            let errors = PlaneHistogramError::new(&truth, [0.0; 2], degrees).unwrap();
            let found = errors.at(width, draws);
            assert!(
                (found.variance / variance - 1.0).abs() < 1e-9,
                "{degrees} {found:?} {variance}"
            );
            assert!(
                (found.squared_bias / squared_bias - 1.0).abs() < 1e-6,
                "{degrees} {found:?} {squared_bias}"
            );
        }
    }

    /// Turning the bins is turning the density the other way.
    #[test]
    fn turned_bins_see_a_turned_density() {
        let parts = [
            PlaneComponent::new(0.6, [-1.0, 0.2], [0.5, 0.8], 0.6),
            PlaneComponent::new(0.4, [1.0, -0.5], [0.7, 0.3], -0.3),
        ];
        let still = PlaneMixture::new(parts.to_vec()).unwrap();
        let straight = PlaneHistogramError::new(&still, [0.0; 2], 0.0).unwrap();
        for degrees in [30.0, 90.0, 131.0, -45.0] {
            let truth = turned(&parts, degrees);
            let tilted = PlaneHistogramError::new(&truth, [0.0; 2], degrees).unwrap();
            for width in [0.25, 1.1] {
                let (a, b) = (tilted.at(width, 50.0), straight.at(width, 50.0));
                assert!(
                    (a.squared_bias / b.squared_bias - 1.0).abs() < 1e-9,
                    "{degrees} {a:?} {b:?}"
                );
                assert!(
                    (a.variance / b.variance - 1.0).abs() < 1e-11,
                    "{degrees} {a:?} {b:?}"
                );
            }
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let places = [[0.1, 0.3], [-0.7, 0.4], [2.1, -2.1]];
            let there = places.map(|[x, y]| [cosine * x - sine * y, sine * x + cosine * y]);
            let moments = |truth: &PlaneMixture, degrees, places: &[Point<2>]| {
                let lattice = Lattice::new([0.6, 0.5], [0.0; 2], degrees);
                plane_histogram_moments(truth, &lattice, 80.0, places).unwrap()
            };
            let (a, b) = (
                moments(&truth, degrees, &there),
                moments(&still, 0.0, &places),
            );
            for (a, b) in a.iter().zip(&b) {
                assert!((a.mean - b.mean).abs() < 1e-12, "{a:?} {b:?}");
                assert!((a.variance - b.variance).abs() < 1e-12, "{a:?} {b:?}");
            }
        }
        let same = PlaneHistogramError::new(&still, [0.0; 2], 360.0).unwrap();
        assert_eq!(same.at(0.3, 10.0), straight.at(0.3, 10.0));
    }

    /// A quarter of a turn changes nothing of a square and nothing of what the axes share.
    #[test]
    fn a_quarter_of_a_turn_is_an_exchange_of_axes() {
        let plane = |x: &str, y: &str| Product::new([named(x).unwrap(), named(y).unwrap()]);
        let (one, other) = (
            plane("ramp-up", "exponential"),
            plane("exponential", "ramp-up"),
        );
        let (straight, quarter) = (
            PlaneHistogramError::new(&one, [0.0; 2], 0.0).unwrap(),
            PlaneHistogramError::new(&other, [0.0; 2], 90.0).unwrap(),
        );
        for width in [0.07, 0.4] {
            let (a, b) = (straight.at(width, 9.0), quarter.at(width, 9.0));
            assert!(
                (a.squared_bias / b.squared_bias - 1.0).abs() < 1e-11,
                "{a:?} {b:?}"
            );
            assert!((a.variance / b.variance - 1.0).abs() < 1e-12, "{a:?} {b:?}");
        }
    }

    /// Of a round density the angle changes nothing: neither the best width nor its error.
    #[test]
    fn a_round_density_knows_no_angle() {
        let truth = named_in_plane("normal-2d").unwrap();
        let best = |degrees| {
            let errors = PlaneHistogramError::new(&*truth, [0.0; 2], degrees).unwrap();
            errors.optimum(200.0)
        };
        let (a, b) = (best(0.0), best(27.0));
        assert!((a.at / b.at - 1.0).abs() < 1e-6, "{a:?} {b:?}");
        assert!((a.error.mise() / b.error.mise() - 1.0).abs() < 1e-11);
    }
}
