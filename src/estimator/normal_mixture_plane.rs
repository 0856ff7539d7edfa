//! Two normals of the plane, each with its own covariance, fitted by expectation and maximisation.

use super::normal::{likeliest_plane, resolved_plane};
use super::normal_mixture::{BETTER, NormalMixtureFit, promising};
use super::{Build, BuildError, Context, Estimate, Estimator, FitError, Laws};
use crate::numeric::Sum;
use crate::parameter::Values;
use crate::sample::Sample;
use crate::space::{Domain, Field, Point, Warning};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

/// Data handled by one task: fixed, so that sums do not depend on the number of threads.
const BLOCK: usize = 1 << 12;

/// Steps after which the starts are compared and only the best two go on.
const HEAT: usize = 50;

/// A step that changes no parameter by more than this, in deviations of the data, is the last.
const STILL: f64 = 1e-13;

/// Σ w r, Σ w r a, Σ w r b, Σ w r a², Σ w r ab, Σ w r b² of each normal, and Σ w log f.
const SUMS: usize = 13;

/// One normal in whitened coordinates: the share, the mean, and the covariance as xx, xy, yy.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    share: f64,
    mean: [f64; 2],
    covariance: [f64; 3],
}

impl Part {
    fn round(share: f64, mean: [f64; 2], deviation: f64) -> Self {
        let variance = deviation * deviation;
        Self {
            share,
            mean,
            covariance: [variance, 0.0, variance],
        }
    }

    fn determinant(&self) -> f64 {
        let [xx, xy, yy] = self.covariance;
        xx * yy - xy * xy
    }

    fn density(&self, [x, y]: Point<2>) -> f64 {
        let [xx, xy, _] = self.covariance;
        let determinant = self.determinant();
        let (a, b) = (x - self.mean[0], y - self.mean[1]);
        if !(a.is_finite() && b.is_finite()) {
            return 0.0;
        }
        // a sum of squares, which is no difference of infinities far out
        let rest = b - xy / xx * a;
        let square = a * a / xx + rest * rest * xx / determinant;
        self.share * (-0.5 * square).exp() / (2.0 * PI * determinant.sqrt())
    }

    fn numbers(&self) -> [f64; 6] {
        let [xx, xy, yy] = self.covariance;
        [self.share, self.mean[0], self.mean[1], xx, xy, yy]
    }
}

/// The covariance with no deviation below `floor`, and whether one was.
fn held([xx, xy, yy]: [f64; 3], floor: f64) -> ([f64; 3], bool) {
    let (middle, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let (least, most) = (middle - half, middle + half);
    let bound = floor * floor;
    if least >= bound {
        return ([xx, xy, yy], false);
    }
    if most <= bound || half <= 0.0 {
        return ([most.max(bound), 0.0, most.max(bound)], true);
    }
    // most P + bound (1 - P), with the projection P = (C - least) / (most - least)
    let onto = [
        (xx - least) / (2.0 * half),
        xy / (2.0 * half),
        (yy - least) / (2.0 * half),
    ];
    let wide = most - bound;
    (
        [
            wide.mul_add(onto[0], bound),
            wide * onto[1],
            wide.mul_add(onto[2], bound),
        ],
        true,
    )
}

/// Where EM begins: two groups side by side in four directions, one in the other, a small group in four.
fn starts() -> Vec<[Part; 2]> {
    let direction = |eighths: u32| {
        let (sine, cosine) = (PI * f64::from(eighths) / 4.0).sin_cos();
        [cosine, sine]
    };
    let along = |[x, y]: [f64; 2], by: f64| [by * x, by * y];
    let mut starts: Vec<[Part; 2]> = (0..4)
        .map(|eighths| {
            let d = direction(eighths);
            [
                Part::round(0.5, along(d, -0.8), 0.7),
                Part::round(0.5, along(d, 0.8), 0.7),
            ]
        })
        .collect();
    starts.push([
        Part::round(0.5, [0.0; 2], 0.5),
        Part::round(0.5, [0.0; 2], 1.3),
    ]);
    starts.extend((0..4).map(|quarters| {
        let d = direction(2 * quarters);
        [
            Part::round(0.8, along(d, -0.4), 0.8),
            Part::round(0.2, along(d, 1.6), 0.5),
        ]
    }));
    starts
}

#[derive(Clone, Copy)]
struct Climb {
    mixture: [Part; 2],
    likelihood: f64,
    settled: bool,
    held: bool,
}

/// Whitened data, with weights that sum to one.
struct Standard {
    z: Vec<Point<2>>,
    weights: Vec<f64>,
}

impl Standard {
    /// One step: the mixture that the shares of `mixture` in the data make likeliest, the likelihood of `mixture`, and whether a normal was held at the floor.
    fn step(&self, mixture: &[Part; 2], floor: f64) -> ([Part; 2], f64, bool) {
        let blocks: Vec<[Sum; SUMS]> = self
            .z
            .par_chunks(BLOCK)
            .zip(self.weights.par_chunks(BLOCK))
            .map(|(z, w)| {
                let mut sums = [Sum::default(); SUMS];
                for (z, &w) in z.iter().zip(w) {
                    let parts = [mixture[0].density(*z), mixture[1].density(*z)];
                    let total = parts[0] + parts[1];
                    // beyond all numbers from both: it belongs to the wider
                    let shares = if total > 0.0 {
                        [parts[0] / total, parts[1] / total]
                    } else {
                        let wider = mixture[0].determinant() >= mixture[1].determinant();
                        let first = f64::from(u8::from(wider));
                        [first, 1.0 - first]
                    };
                    for k in 0..2 {
                        let share = w * shares[k];
                        let (a, b) = (z[0] - mixture[k].mean[0], z[1] - mixture[k].mean[1]);
                        let terms = [1.0, a, b, a * a, a * b, b * b];
                        for (sum, term) in sums[6 * k..].iter_mut().zip(terms) {
                            sum.add(share * term);
                        }
                    }
                    sums[SUMS - 1].add(w * total.max(f64::MIN_POSITIVE).ln());
                }
                sums
            })
            .collect();
        let mut totals = [Sum::default(); SUMS];
        for block in blocks {
            for (total, sum) in totals.iter_mut().zip(block) {
                total.merge(sum);
            }
        }
        let sums = totals.map(Sum::value);
        let mut any = false;
        let next = [0, 1].map(|k: usize| {
            let own = &sums[6 * k..6 * k + 6];
            let (share, now) = (own[0], &mixture[k]);
            // a normal that has lost all data stays where it is
            if share <= f64::MIN_POSITIVE {
                return Part { share: 0.0, ..*now };
            }
            let [a, b] = [own[1] / share, own[2] / share];
            let (covariance, bound) = held(
                [
                    own[3] / share - a * a,
                    own[4] / share - a * b,
                    own[5] / share - b * b,
                ],
                floor,
            );
            any |= bound;
            Part {
                share,
                mean: [now.mean[0] + a, now.mean[1] + b],
                covariance,
            }
        });
        (next, sums[SUMS - 1], any)
    }

    fn climb(&self, from: Climb, floor: f64, steps: usize) -> Climb {
        let mut now = from;
        for _ in 0..steps {
            if now.settled {
                break;
            }
            let (mixture, likelihood, held) = self.step(&now.mixture, floor);
            let moved = (0..2)
                .flat_map(|k| {
                    let pairs = mixture[k]
                        .numbers()
                        .into_iter()
                        .zip(now.mixture[k].numbers());
                    pairs.map(|(a, b)| (a - b).abs())
                })
                .fold(0.0, f64::max);
            now = Climb {
                mixture,
                likelihood,
                settled: moved <= STILL,
                held,
            };
        }
        now
    }

    fn likeliest(&self, floor: f64, steps: usize) -> Climb {
        let heat = HEAT.min(steps);
        let climbs: Vec<Climb> = starts()
            .into_iter()
            .map(|mixture| {
                let start = Climb {
                    mixture,
                    likelihood: f64::NEG_INFINITY,
                    settled: false,
                    held: false,
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
    /// To whitened coordinates.
    white: White,
    mixture: [Part; 2],
    domain: Domain<2>,
}

/// (x, y) → ((x - a)/s, (y - b - slope (x - a))/t): uncorrelated, of deviation one.
#[derive(Clone, Copy)]
struct White {
    centre: Point<2>,
    offset: Point<2>,
    deviation: [f64; 2],
    slope: f64,
}

impl White {
    fn of(&self, x: Point<2>) -> Point<2> {
        let [u, v] = [0, 1].map(|k: usize| x[k] - self.centre[k] - self.offset[k]);
        let [s, t] = self.deviation;
        [u / s, (v - self.slope * u) / t]
    }
}

impl Field<2> for Fitted {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        let z = self.white.of(x);
        let sum: f64 = self.mixture.iter().map(|part| part.density(z)).sum();
        let [s, t] = self.white.deviation;
        self.mass * sum / s / t
    }
}

impl Estimator<2> for NormalMixtureFit {
    fn laws(&self) -> Laws {
        Estimator::<1>::laws(self)
    }

    /// Begins in coordinates in which the data are uncorrelated and of deviation one; there no normal may be thinner than `floor` in any direction.
    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        let normal = likeliest_plane(sample);
        if !resolved_plane(sample, &normal) {
            return Err(FitError::Degenerate(format!(
                "all {} points are at one place or on one line: no mixture of normals is likeliest for data without spread; choose another estimator",
                sample.len()
            )));
        }
        let white = White {
            centre: normal.centre,
            offset: normal.offset,
            deviation: normal.deviation,
            slope: normal.slope,
        };
        let (mut z, mut weights) = (Vec::new(), Vec::new());
        for (i, &x) in sample.points().iter().enumerate() {
            if sample.weight(i) > 0.0 {
                z.push(white.of(x));
                weights.push(sample.weight(i) / sample.mass());
            }
        }
        let found = Standard { z, weights }.likeliest(self.floor, self.steps);
        let field = |mass| -> Arc<dyn Field<2>> {
            Arc::new(Fitted {
                mass,
                white,
                mixture: found.mixture,
                domain: sample.domain().clone(),
            })
        };
        let mut estimate = Estimate::new(field(sample.mass())).with_channels(
            (0..sample.channels())
                .map(|c| field(sample.channel(c).mass()))
                .collect(),
        );
        if found.held {
            estimate.warnings.push(Warning {
                what: format!(
                    "one of the two normals shrinks onto few points or a line and is held at {} deviations of the data",
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

impl Build<2> for NormalMixtureFit {
    fn build(values: &Values, _context: &Context<2>) -> Result<Self, BuildError> {
        Ok(Self::from(values))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::density;
    use crate::estimator::Described;
    use crate::random;
    use crate::space::Grid;

    fn fitted(sample: &Sample<2>) -> Estimate<2> {
        let values = Values::defaults(NormalMixtureFit::PARAMETERS);
        Estimator::<2>::fit(&NormalMixtureFit::from(&values), sample).unwrap()
    }

    /// Two tilted groups: a third at (-2, 1) long along (1, 1), two thirds at (2, 0) round.
    fn points(n: u32) -> Vec<Point<2>> {
        let mut stream = random::stream(12, "mixture in the plane", 0);
        let normal = density::named_in_plane("normal-2d").unwrap();
        (0..n)
            .map(|i| {
                let [a, b] = normal.draw(&mut stream);
                if i % 3 == 0 {
                    [-2.0 + 0.8 * a + 0.2 * b, 1.0 + 0.8 * a - 0.2 * b]
                } else {
                    [2.0 + 0.5 * a, 0.5 * b]
                }
            })
            .collect()
    }

    #[test]
    fn two_groups_are_found_with_their_covariances() {
        let sample = Sample::equal(points(6000), Domain::whole()).unwrap();
        let estimate = fitted(&sample);
        assert!(estimate.warnings.is_empty(), "{:?}", estimate.warnings);
        let bell = |u: f64, v: f64, area: f64| (-0.5 * (u * u + v * v)).exp() / (2.0 * PI * area);
        let truth = |[x, y]: Point<2>| {
            let (u, v) = (x + 2.0, y - 1.0);
            // a = (u + v)/1.6, b = (u - v)/0.4, of determinant 0.32
            bell((u + v) / 1.6, (u - v) / 0.4, 0.32) / 3.0
                + bell((x - 2.0) / 0.5, y / 0.5, 0.25) * 2.0 / 3.0
        };
        let grid = Grid::new([-7.0, -4.0], [5.0, 5.0], [240, 180]).unwrap();
        let (mut error, mut peak) = (0.0_f64, 0.0_f64);
        for x in grid.centres() {
            error = error.max((estimate.at(x) - truth(x)).abs());
            peak = peak.max(truth(x));
        }
        // six thousand points: some per cent
        assert!(error < 0.06 * peak, "{error} {peak}");
        assert!((estimate.on(&grid).integral() - 1.0).abs() < 1e-6);
    }

    /// At a maximum of the likelihood neither parameter can be improved: shares, means and covariances are those of the shares of the data.
    #[test]
    fn it_is_a_maximum_and_follows_units_and_weights() {
        let all = points(300);
        let sample = Sample::equal(all.clone(), Domain::whole()).unwrap();
        let estimate = fitted(&sample);
        let logarithm = |f: &dyn Fn(Point<2>) -> f64| all.iter().map(|x| f(*x).ln()).sum::<f64>();
        let best = logarithm(&|x| estimate.at(x));
        for moved in [[0.02, 0.0], [0.0, 0.02], [-0.02, 0.01]] {
            let there = logarithm(&|x| estimate.at([x[0] + moved[0], x[1] + moved[1]]));
            assert!(there < best, "{moved:?}");
        }
        let scaled = all
            .iter()
            .map(|x| [1e-6 * x[0], 1e5 * x[1] + 3e6])
            .collect();
        let scaled = fitted(&Sample::equal(scaled, Domain::whole()).unwrap());
        for x in [[-2.0, 1.0], [2.0, 0.2], [0.0, 0.0]] {
            let there = scaled.at([1e-6 * x[0], 1e5 * x[1] + 3e6]) * 0.1;
            assert!((there / estimate.at(x) - 1.0).abs() < 1e-6, "{x:?}");
        }
        let twice: Vec<Point<2>> = all.iter().chain(&all[..150]).copied().collect();
        let weights = (0..300).map(|i| if i < 150 { 2.0 } else { 1.0 }).collect();
        let weighted = fitted(&Sample::normalised(all, weights, Domain::whole()).unwrap());
        let repeated = fitted(&Sample::equal(twice, Domain::whole()).unwrap());
        for x in [[-2.0, 1.0], [2.0, 0.2]] {
            assert!((weighted.at(x) / repeated.at(x) - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn what_would_shrink_is_held_and_what_has_no_spread_refused() {
        // a third of the data on one spot
        let mut all = points(60);
        all.extend([[0.5, 0.5]; 30]);
        let estimate = fitted(&Sample::equal(all, Domain::whole()).unwrap());
        assert!(!estimate.warnings.is_empty());
        assert!(estimate.at([0.5, 0.5]).is_finite());
        let line = (0..20)
            .map(|i| [f64::from(i), 2.0 * f64::from(i)])
            .collect();
        let line = Sample::equal(line, Domain::whole()).unwrap();
        let values = Values::defaults(NormalMixtureFit::PARAMETERS);
        let refused = Estimator::<2>::fit(&NormalMixtureFit::from(&values), &line);
        assert!(matches!(refused, Err(FitError::Degenerate(_))));
    }

    #[test]
    fn a_floor_is_a_floor_in_every_direction() {
        let (same, bound) = held([2.0, 0.5, 1.0], 0.1);
        assert!(!bound && (same[1] - 0.5).abs() < 1e-15);
        // along (1, 1) of variance 2, across of 0
        let (wider, bound) = held([1.0, 1.0, 1.0], 0.5);
        let [xx, xy, yy] = wider;
        assert!(bound && (xx + 2.0 * xy + yy - 4.0).abs() < 1e-12);
        assert!((xx - 2.0 * xy + yy - 0.5).abs() < 1e-12, "{wider:?}");
    }
}
