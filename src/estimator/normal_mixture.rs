//! Two normals fitted by expectation and maximisation: the parametric estimator for data with two groups.

use super::normal::{likeliest, resolved};
use super::{Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws};
use crate::numeric::{Sum, special::normal_density};
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Field, Point, Warning};
use rayon::prelude::*;
use std::sync::Arc;

/// f̂ = p₁ φ((x - μ₁)/σ₁)/σ₁ + p₂ φ((x - μ₂)/σ₂)/σ₂, a maximum of the likelihood found by the EM algorithm. [Dempster, Laird & Rubin 1977]
///
/// The likelihood has several maxima, and no greatest one: it grows without bound as one normal shrinks onto one datum [Day 1969]. So five starts are
/// tried, which depend on the data only through mean and deviation, the best of what they lead to is taken, and no normal may be narrower than
/// `floor` times the deviation of all data. A warning says if that bound is what stops a normal, or if the steps run out.
///
/// In the plane each normal has a covariance of its own, and nine starts are tried.
///
/// The mixture is that of the total; a channel is the same mixture with the mass of the channel. O(n) a step; some hundred steps a start are usual.
pub struct NormalMixtureFit {
    /// The least deviation, in those of all data.
    pub(super) floor: f64,
    /// The most steps from one start.
    pub(super) steps: usize,
}

impl From<&Values> for NormalMixtureFit {
    fn from(values: &Values) -> Self {
        Self {
            floor: values.number("floor").unwrap_or(0.02),
            steps: values.count("steps").unwrap_or(3000) as usize,
        }
    }
}

/// Data handled by one task: fixed, so that sums do not depend on the number of threads.
const BLOCK: usize = 1 << 13;

/// Steps after which the starts are compared and only the best two go on.
const HEAT: usize = 50;

/// A step that changes no parameter by more than this, in deviations of the data, is the last.
const STILL: f64 = 1e-14;

/// A later start must be better than the best by so much in the mean logarithm of the likelihood.
pub(super) const BETTER: f64 = 1e-9;

/// A mixture in units of the data's deviation about their mean: [share, mean, deviation] of each normal.
type Mixture = [[f64; 3]; 2];

/// Where EM begins: one left and one right, one in the other, a small group on either side.
const STARTS: [Mixture; 5] = [
    [[0.5, -0.8, 0.6], [0.5, 0.8, 0.6]],
    [[0.5, 0.0, 0.4], [0.5, 0.0, 1.3]],
    [[0.8, -0.4, 0.7], [0.2, 1.6, 0.5]],
    [[0.2, -1.6, 0.5], [0.8, 0.4, 0.7]],
    [[0.6, -0.1, 0.9], [0.4, 0.2, 0.5]],
];

fn density([share, mean, deviation]: [f64; 3], z: f64) -> f64 {
    share * normal_density((z - mean) / deviation) / deviation
}

/// What one start has led to.
#[derive(Clone, Copy)]
struct Climb {
    mixture: Mixture,
    likelihood: f64,
    settled: bool,
}

/// Data in units of their deviation about their mean, with weights that sum to one.
struct Standard {
    z: Vec<f64>,
    weights: Vec<f64>,
}

/// Which two climbs to go on with: the best, and the best of the others. Of those that differ by rounding alone the earlier one, so that the unit of the data does not decide.
pub(super) fn promising(likelihoods: &[f64]) -> [usize; 2] {
    let best_but = |not: Option<usize>| {
        let others = || (0..likelihoods.len()).filter(move |at| Some(*at) != not);
        let most = others()
            .map(|at| likelihoods[at])
            .fold(f64::NEG_INFINITY, f64::max);
        others()
            .find(|&at| likelihoods[at] >= most - BETTER)
            .unwrap_or_default()
    };
    let first = best_but(None);
    [first, best_but(Some(first))]
}

impl Standard {
    /// One step: the likelihood of `mixture`, and the mixture that its shares of the data make likeliest.
    fn step(&self, mixture: Mixture, floor: f64) -> (Mixture, f64) {
        // Σ w r, Σ w r (z - μ), Σ w r (z - μ)² for each normal, about its present mean, and Σ w log f
        let blocks: Vec<[Sum; 7]> = self
            .z
            .par_chunks(BLOCK)
            .zip(self.weights.par_chunks(BLOCK))
            .map(|(z, w)| {
                let mut sums = [Sum::default(); 7];
                for (&z, &w) in z.iter().zip(w) {
                    let parts = mixture.map(|normal| density(normal, z));
                    let total = parts[0] + parts[1];
                    // beyond all numbers from both: it belongs to the wider
                    let shares = if total > 0.0 {
                        [parts[0] / total, parts[1] / total]
                    } else {
                        let first = f64::from(u8::from(mixture[0][2] >= mixture[1][2]));
                        [first, 1.0 - first]
                    };
                    for k in 0..2 {
                        let away = z - mixture[k][1];
                        sums[3 * k].add(w * shares[k]);
                        sums[3 * k + 1].add(w * shares[k] * away);
                        sums[3 * k + 2].add(w * shares[k] * away * away);
                    }
                    sums[6].add(w * total.max(f64::MIN_POSITIVE).ln());
                }
                sums
            })
            .collect();
        let mut totals = [Sum::default(); 7];
        for block in blocks {
            for (total, sum) in totals.iter_mut().zip(block) {
                total.merge(sum);
            }
        }
        let sums = totals.map(Sum::value);
        let next = [0, 1].map(|k: usize| {
            let share = sums[3 * k];
            // a normal that has lost all data stays where it is
            if share <= f64::MIN_POSITIVE {
                return [0.0, mixture[k][1], mixture[k][2]];
            }
            let by = sums[3 * k + 1] / share;
            let variance = sums[3 * k + 2] / share - by * by;
            [
                share,
                mixture[k][1] + by,
                variance.max(0.0).sqrt().max(floor),
            ]
        });
        (next, sums[6])
    }

    fn climb(&self, from: Climb, floor: f64, steps: usize) -> Climb {
        let mut now = from;
        for _ in 0..steps {
            if now.settled {
                break;
            }
            let (next, likelihood) = self.step(now.mixture, floor);
            let moved = next
                .as_flattened()
                .iter()
                .zip(now.mixture.as_flattened())
                .fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            now = Climb {
                mixture: next,
                likelihood,
                settled: moved <= STILL,
            };
        }
        now
    }

    fn likeliest(&self, floor: f64, steps: usize) -> Climb {
        let heat = HEAT.min(steps);
        let climbs: Vec<Climb> = STARTS
            .iter()
            .map(|&mixture| {
                let start = Climb {
                    mixture,
                    likelihood: f64::NEG_INFINITY,
                    settled: false,
                };
                self.climb(start, floor, heat)
            })
            .collect();
        let likelihoods: Vec<f64> = climbs.iter().map(|climb| climb.likelihood).collect();
        let ends = promising(&likelihoods).map(|at| self.climb(climbs[at], floor, steps - heat));
        if ends[1].likelihood > ends[0].likelihood + BETTER {
            ends[1]
        } else {
            ends[0]
        }
    }
}

struct Fitted {
    mass: f64,
    centre: f64,
    offset: f64,
    deviation: f64,
    mixture: Mixture,
    domain: Domain<1>,
}

impl Field<1> for Fitted {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        let z = (x - self.centre - self.offset) / self.deviation;
        let sum: f64 = self.mixture.iter().map(|normal| density(*normal, z)).sum();
        self.mass * sum / self.deviation
    }
}

impl Estimator<1> for NormalMixtureFit {
    fn laws(&self) -> Laws {
        Laws {
            mass_conserving: true,
            non_negative: true,
            linear: false,
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: true,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: true,
        }
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let (centre, offset, deviation) = likeliest(sample);
        if !resolved(sample, deviation) {
            return Err(FitError::Degenerate(format!(
                "all {} points are at {}: no mixture of normals is likeliest for data without spread; choose another estimator",
                sample.len(),
                centre + offset
            )));
        }
        let (mut z, mut weights) = (Vec::new(), Vec::new());
        for (i, x) in sample.coordinates().iter().enumerate() {
            if sample.weight(i) > 0.0 {
                z.push((x - centre - offset) / deviation);
                weights.push(sample.weight(i) / sample.mass());
            }
        }
        let found = Standard { z, weights }.likeliest(self.floor, self.steps);
        let mut estimate = {
            let field = |mass| -> Arc<dyn Field<1>> {
                Arc::new(Fitted {
                    mass,
                    centre,
                    offset,
                    deviation,
                    mixture: found.mixture,
                    domain: sample.domain().clone(),
                })
            };
            Estimate::new(field(sample.mass())).with_channels(
                (0..sample.channels())
                    .map(|c| field(sample.channel(c).mass()))
                    .collect(),
            )
        };
        let narrow = |normal: &[f64; 3]| normal[0] > 0.0 && normal[2] <= self.floor;
        if found.mixture.iter().any(narrow) {
            estimate.warnings.push(Warning {
                what: format!(
                    "one of the two normals shrinks onto few points and is held at {} deviations of the data",
                    self.floor
                ),
                hint: "the likelihood has no maximum there; look at the data for ties, or do without a second normal".to_owned(),
            });
        }
        if !found.settled {
            estimate.warnings.push(Warning {
                what: format!("the two normals still moved after {} steps", self.steps),
                hint: "raise `steps`, or take the fit for what it is".to_owned(),
            });
        }
        Ok(estimate)
    }
}

impl Described for NormalMixtureFit {
    const NAME: &'static str = "normal-mixture-fit";
    const SUMMARY: &'static str =
        "the likeliest mixture of two normals, by expectation and maximisation";
    const COST: &'static str = "O(n) a step, some hundred steps from each of five starts, and O(m)";
    const REFERENCE: &'static str = "Dempster, Laird & Rubin 1977, Journal of the Royal Statistical Society B 39; Day 1969, Biometrika 56";
    const SMOOTHING: Option<&'static str> = None;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::optional(
            "floor",
            Kind::Between(0.0, 0.5),
            Absent::Number(0.02),
            "the least deviation of a normal, as a share of that of the data: without one the likelihood has no maximum",
        ),
        Parameter::optional(
            "steps",
            Kind::Count {
                least: 10,
                most: 100_000,
            },
            Absent::Number(3000.0),
            "the most steps from one start",
        ),
    ];
}

impl Build<1> for NormalMixtureFit {
    fn build(values: &Values, _context: &Context<1>) -> Result<Self, BuildError> {
        Ok(Self::from(values))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::named;
    use crate::random::stream;

    fn fit(points: Vec<Point<1>>) -> Estimate<1> {
        let sample = Sample::equal(points, Domain::whole()).expect("legal");
        let estimator = NormalMixtureFit {
            floor: 0.02,
            steps: 3000,
        };
        estimator.fit(&sample).expect("spread")
    }

    /// Number 6 of Marron & Wand is what is fitted: with 20 000 points the error is that of five parameters, far below any kernel's.
    #[test]
    fn two_normals_are_found_again() {
        let truth = named("bimodal").expect("known");
        let mut random = stream(1, "em", 0);
        let estimate = fit((0..20_000).map(|_| truth.draw(&mut random)).collect());
        assert!(estimate.warnings.is_empty(), "{:?}", estimate.warnings);
        for i in -30..=30 {
            let x = [0.1 * f64::from(i)];
            assert!((estimate.at(x) - truth.at(x)).abs() < 0.012, "at {x:?}");
        }
    }

    #[test]
    fn the_likelihood_never_falls() {
        let truth = named("skewed").or_else(|| named("mw-2")).expect("known");
        let mut random = stream(2, "em", 0);
        let z: Vec<f64> = (0..500).map(|_| truth.draw(&mut random)[0]).collect();
        let data = Standard {
            weights: vec![1.0 / 500.0; 500],
            z,
        };
        for start in STARTS {
            let (mut mixture, mut last) = (start, f64::NEG_INFINITY);
            for _ in 0..200 {
                let (next, likelihood) = data.step(mixture, 1e-3);
                assert!(likelihood >= last - 1e-13, "{last} {likelihood}");
                (mixture, last) = (next, likelihood);
            }
            assert!((mixture[0][0] + mixture[1][0] - 1.0).abs() < 1e-12);
        }
    }

    /// Ties are where the likelihood is unbounded: held, and said.
    #[test]
    fn ties_are_held_at_the_floor_with_a_warning() {
        let mut points = vec![[0.5]; 30];
        points.extend((0..30).map(|i| [f64::from(i) * 0.1 - 1.5]));
        let estimate = fit(points);
        assert!(estimate.warnings.iter().any(|w| w.what.contains("held")));
        assert!(estimate.at([0.5]).is_finite());
        let alike = Sample::equal(vec![[3.0]; 9], Domain::whole()).expect("legal");
        let estimator = NormalMixtureFit {
            floor: 0.02,
            steps: 100,
        };
        assert!(matches!(
            estimator.fit(&alike),
            Err(FitError::Degenerate(_))
        ));
    }
}
