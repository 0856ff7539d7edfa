//! Light on the unit square: flat, a ramp, spots with soft edges and discs with sharp ones, in any mixture.

use super::mixture::{below, moments};
use super::slices::{area_in_disc, standard_normal};
use crate::density::{Bivariate, Builder, Density, Entry};
use crate::numeric::special::{normal_density, normal_probability, normal_quantile};
use crate::parameter::{Absent, BuildError, Kind, Parameter};
use crate::random::{Stream, open_unit};
use crate::space::{Domain, Field, Point, clipped_to_box, polygon_moments};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// One part of a density on the unit square, of mass 1 there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SquarePart {
    /// 1.
    Flat,
    /// 2x.
    Ramp,
    /// A round normal about `centre`, cut off at the walls and scaled up for what they cut.
    Spot {
        /// The place of its peak.
        centre: Point<2>,
        /// Its deviation.
        deviation: f64,
    },
    /// 1/(πR²) on a disc that lies in the square.
    Disc {
        /// Its centre.
        centre: Point<2>,
        /// Its radius R.
        radius: f64,
    },
}

/// The share of a normal of this mean and deviation that lies between 0 and 1.
fn kept(mean: f64, deviation: f64) -> f64 {
    normal_probability(-mean / deviation, (1.0 - mean) / deviation)
}

/// Mean and variance of that normal cut to \[0, 1\]. [Johnson, Kotz & Balakrishnan 1994, section 10.1]
fn cut_moments(mean: f64, deviation: f64) -> (f64, f64) {
    let (a, b) = (-mean / deviation, (1.0 - mean) / deviation);
    let kept = kept(mean, deviation);
    let shift = (normal_density(a) - normal_density(b)) / kept;
    let spread = 1.0 + (a * normal_density(a) - b * normal_density(b)) / kept - shift * shift;
    (
        deviation.mul_add(shift, mean),
        deviation * deviation * spread,
    )
}

/// ∫₀ˣ clamp(y, -s(t), s(t)) dt with s(t) = √(R² - t²): the area between the first axis and y within the disc, odd in both.
fn below_in_disc(x: f64, y: f64, radius: f64) -> f64 {
    let half = |t: f64| {
        let s = (radius * radius - t * t).max(0.0).sqrt();
        0.5 * (t * s + radius * radius * t.atan2(s))
    };
    let (x_size, y_size) = (x.abs().min(radius), y.abs().min(radius));
    let meeting = (radius * radius - y_size * y_size).max(0.0).sqrt();
    let area = if x_size <= meeting {
        y_size * x_size
    } else {
        y_size.mul_add(meeting, half(x_size) - half(meeting))
    };
    area * x.signum() * y.signum()
}

impl SquarePart {
    /// The largest value.
    fn peak(&self) -> f64 {
        match *self {
            Self::Flat => 1.0,
            Self::Ramp => 2.0,
            Self::Spot { centre, deviation } => {
                1.0 / (TAU
                    * deviation
                    * deviation
                    * kept(centre[0], deviation)
                    * kept(centre[1], deviation))
            }
            Self::Disc { radius, .. } => 1.0 / (PI * radius * radius),
        }
    }

    /// The value over the largest one.
    fn relative(&self, x: Point<2>) -> f64 {
        match *self {
            Self::Flat => 1.0,
            Self::Ramp => x[0],
            Self::Spot { centre, deviation } => {
                let (u, v) = (x[0] - centre[0], x[1] - centre[1]);
                (-0.5 * (u * u + v * v) / (deviation * deviation)).exp()
            }
            Self::Disc { centre, radius } => f64::from(u8::from(
                (x[0] - centre[0]).hypot(x[1] - centre[1]) <= radius,
            )),
        }
    }

    /// The gradient and the Laplacian, where there is no jump.
    fn derivatives(&self, x: Point<2>) -> ([f64; 2], f64) {
        match *self {
            Self::Flat | Self::Disc { .. } => ([0.0; 2], 0.0),
            Self::Ramp => ([2.0, 0.0], 0.0),
            Self::Spot { centre, deviation } => {
                let f = self.peak() * self.relative(x);
                let z = [0, 1].map(|k: usize| (x[k] - centre[k]) / deviation);
                (
                    z.map(|z| -f * z / deviation),
                    f * (z[0] * z[0] + z[1] * z[1] - 2.0) / (deviation * deviation),
                )
            }
        }
    }

    /// The probability of a box within the square.
    fn probability(&self, low: Point<2>, high: Point<2>) -> f64 {
        match *self {
            Self::Flat => (high[0] - low[0]) * (high[1] - low[1]),
            Self::Ramp => (high[0] - low[0]) * (high[0] + low[0]) * (high[1] - low[1]),
            Self::Spot { centre, deviation } => (0..2)
                .map(|k| {
                    let z = |x: f64| (x - centre[k]) / deviation;
                    normal_probability(z(low[k]), z(high[k])) / kept(centre[k], deviation)
                })
                .product(),
            Self::Disc { centre, radius } => {
                let area = |x: f64, y: f64| below_in_disc(x - centre[0], y - centre[1], radius);
                let inside = area(high[0], high[1]) - area(low[0], high[1]) - area(high[0], low[1])
                    + area(low[0], low[1]);
                inside.max(0.0) / (PI * radius * radius)
            }
        }
    }

    /// The probability of a convex polygon within the square.
    fn probability_within(&self, ring: &[Point<2>]) -> f64 {
        let about = |centre: Point<2>, scale: f64| -> Vec<Point<2>> {
            let moved = |x: &Point<2>| [0, 1].map(|k: usize| (x[k] - centre[k]) / scale);
            ring.iter().map(moved).collect()
        };
        match *self {
            Self::Flat => polygon_moments(ring)[0].max(0.0),
            Self::Ramp => 2.0 * polygon_moments(ring)[1].max(0.0),
            Self::Spot { centre, deviation } => {
                let whole = kept(centre[0], deviation) * kept(centre[1], deviation);
                standard_normal(&about(centre, deviation)) / whole
            }
            Self::Disc { centre, radius } => {
                area_in_disc(&about(centre, 1.0), radius) / (PI * radius * radius)
            }
        }
    }

    /// A place from two uniform numbers.
    fn place(&self, u: f64, v: f64) -> Point<2> {
        match *self {
            Self::Flat => [u, v],
            Self::Ramp => [u.sqrt(), v],
            Self::Spot { centre, deviation } => {
                let axis = |k: usize, p: f64| {
                    let first = below(-centre[k] / deviation);
                    let z = normal_quantile(p.mul_add(kept(centre[k], deviation), first));
                    z.mul_add(deviation, centre[k]).clamp(0.0, 1.0)
                };
                [axis(0, u), axis(1, v)]
            }
            Self::Disc { centre, radius } => {
                let (sine, cosine) = (TAU * v).sin_cos();
                let r = radius * u.sqrt();
                [
                    r.mul_add(cosine, centre[0]).clamp(0.0, 1.0),
                    r.mul_add(sine, centre[1]).clamp(0.0, 1.0),
                ]
            }
        }
    }

    fn moments(&self) -> (Point<2>, [[f64; 2]; 2]) {
        let (mean, [a, b]) = match *self {
            Self::Flat => ([0.5; 2], [1.0 / 12.0; 2]),
            Self::Ramp => ([2.0 / 3.0, 0.5], [1.0 / 18.0, 1.0 / 12.0]),
            Self::Spot { centre, deviation } => {
                let [x, y] = centre.map(|mean| cut_moments(mean, deviation));
                ([x.0, y.0], [x.1, y.1])
            }
            Self::Disc { centre, radius } => (centre, [radius * radius / 4.0; 2]),
        };
        (mean, [[a, 0.0], [0.0, b]])
    }
}

/// Σ shares × parts on the unit square, with walls all round.
#[derive(Clone, Debug, PartialEq)]
pub struct Square {
    parts: Vec<(f64, SquarePart)>,
    /// What each part adds at its largest: its share times its peak.
    peaks: Vec<f64>,
    domain: Domain<2>,
}

impl Square {
    /// The mixture of `parts` with masses in proportion to the numbers before them; `None` unless those are positive and finite, spots have a
    /// deviation from 1e-4 to 10 and a peak in the square, and discs lie in the square and have a radius of 1e-4 at least.
    pub fn new(mut parts: Vec<(f64, SquarePart)>) -> Option<Self> {
        let total: f64 = parts.iter().map(|part| part.0).sum();
        let within = |centre: Point<2>, margin: f64| {
            centre.iter().all(|x| (margin..=1.0 - margin).contains(x))
        };
        let legal = parts.iter().all(|(mass, part)| {
            *mass > 0.0
                && mass.is_finite()
                && match *part {
                    SquarePart::Flat | SquarePart::Ramp => true,
                    SquarePart::Spot { centre, deviation } => {
                        (1e-4..=10.0).contains(&deviation) && within(centre, 0.0)
                    }
                    SquarePart::Disc { centre, radius } => radius >= 1e-4 && within(centre, radius),
                }
        });
        if !(legal && total > 0.0 && total.is_finite()) {
            return None;
        }
        for part in &mut parts {
            part.0 /= total;
        }
        let peaks = parts
            .iter()
            .map(|(share, part)| share * part.peak())
            .collect();
        Some(Self {
            parts,
            peaks,
            domain: Domain::unit(),
        })
    }

    fn sum(&self, x: Point<2>, value: impl Fn(&SquarePart) -> f64) -> f64 {
        if !self.domain.contains(x) {
            return 0.0;
        }
        self.parts
            .iter()
            .map(|(share, part)| share * value(part))
            .sum()
    }
}

impl Field<2> for Square {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        if !self.domain.contains(x) {
            return 0.0;
        }
        // peaks are known beforehand: those of spots take error functions
        self.parts
            .iter()
            .zip(&self.peaks)
            .map(|((_, part), peak)| peak * part.relative(x))
            .sum()
    }
}

impl Density<2> for Square {
    /// Three random words a draw, always: the first chooses the part.
    fn draw(&self, random: &mut Stream) -> Point<2> {
        let mut share = open_unit(random);
        let (u, v) = (open_unit(random), open_unit(random));
        let last = self.parts.len() - 1;
        let (_, chosen) = self.parts[..last]
            .iter()
            .find(|part| {
                share -= part.0;
                share < 0.0
            })
            .unwrap_or(&self.parts[last]);
        chosen.place(u, v)
    }

    fn probability(&self, low: Point<2>, high: Point<2>) -> f64 {
        let (low, high) = (
            low.map(|x| x.clamp(0.0, 1.0)),
            high.map(|x| x.clamp(0.0, 1.0)),
        );
        if low[0] >= high[0] || low[1] >= high[1] {
            return 0.0;
        }
        self.parts
            .iter()
            .map(|(share, part)| share * part.probability(low, high))
            .sum()
    }

    fn breaks(&self, axis: usize) -> Vec<f64> {
        let mut breaks = vec![0.0, 1.0];
        for (_, part) in &self.parts {
            if let SquarePart::Disc { centre, radius } = part {
                breaks.extend([centre[axis] - radius, centre[axis] + radius]);
            }
        }
        breaks.sort_by(f64::total_cmp);
        breaks
    }

    fn finest_scale(&self, _axis: usize) -> f64 {
        self.parts
            .iter()
            .map(|(_, part)| match part {
                SquarePart::Flat | SquarePart::Ramp => 1.0,
                SquarePart::Spot { deviation, .. } => *deviation,
                SquarePart::Disc { radius, .. } => *radius,
            })
            .fold(1.0, f64::min)
    }

    fn bulk(&self, _tail: f64) -> (Point<2>, Point<2>) {
        ([0.0; 2], [1.0; 2])
    }

    fn level(&self) -> Option<f64> {
        let flat = |(_, part): &(f64, SquarePart)| *part == SquarePart::Flat;
        self.parts.iter().all(flat).then_some(1.0)
    }

    fn bivariate(&self) -> Option<&dyn Bivariate> {
        Some(self)
    }
}

impl Bivariate for Square {
    fn probability_within(&self, corners: &[Point<2>]) -> f64 {
        let ring = clipped_to_box(corners, [0.0; 2], [1.0; 2]);
        self.parts
            .iter()
            .map(|(share, part)| share * part.probability_within(&ring))
            .sum()
    }

    fn gradient(&self, x: Point<2>) -> [f64; 2] {
        [0, 1].map(|axis: usize| self.sum(x, |part| part.derivatives(x).0[axis]))
    }

    fn laplacian(&self, x: Point<2>) -> f64 {
        self.sum(x, |part| part.derivatives(x).1)
    }

    /// Infinite: the density jumps at the walls.
    fn gradient_roughness(&self) -> f64 {
        f64::INFINITY
    }

    fn laplacian_roughness(&self) -> f64 {
        f64::INFINITY
    }

    fn mean_and_covariance(&self) -> (Point<2>, [[f64; 2]; 2]) {
        moments(self.parts.iter().map(|(share, part)| {
            let (mean, covariance) = part.moments();
            (*share, mean, covariance)
        }))
    }
}

/// The share of light in a highlight or disc.
const SHARE: Parameter = Parameter::optional(
    "share",
    Kind::Between(0.0, 1.0),
    Absent::Number(0.4),
    "its share of all the mass; the rest lies flat on the square",
);

pub(in crate::density) const ENTRIES: &[Entry] = &[
    Entry {
        names: &["uniform-2d"],
        summary: "in the plane: flat on the unit square, with walls",
        reference: "-",
        parameters: &[],
        build: Builder::Plane(|_| made("uniform-2d", vec![(1.0, SquarePart::Flat)])),
    },
    Entry {
        names: &["ramp-2d"],
        summary: "in the plane: 2x on the unit square, rising to a wall",
        reference: "-",
        parameters: &[],
        build: Builder::Plane(|_| made("ramp-2d", vec![(1.0, SquarePart::Ramp)])),
    },
    Entry {
        names: &["highlight"],
        summary: "in the plane: a Gaussian highlight at the centre of an evenly lit unit square",
        reference: "after Myszkowski 1997, Lighting reconstruction using fast and adaptive density estimation techniques",
        parameters: &[
            SHARE,
            Parameter::optional(
                "deviation",
                Kind::Between(0.0, 1.0),
                Absent::Number(0.1),
                "the standard deviation of the highlight",
            ),
        ],
        build: Builder::Plane(|values| {
            let share = values.number("share").unwrap_or(0.4);
            let deviation = values.number("deviation").unwrap_or(0.1);
            let centre = [0.5; 2];
            let spot = SquarePart::Spot { centre, deviation };
            made(
                "deviation",
                vec![(1.0 - share, SquarePart::Flat), (share, spot)],
            )
        }),
    },
    Entry {
        names: &["disc"],
        summary: "in the plane: a bright disc with a sharp edge at the centre of an evenly lit unit square",
        reference: "after Myszkowski 1997, Lighting reconstruction using fast and adaptive density estimation techniques",
        parameters: &[
            SHARE,
            Parameter::optional(
                "radius",
                Kind::Between(0.0, 0.5),
                Absent::Number(0.12),
                "the radius of the disc",
            ),
        ],
        build: Builder::Plane(|values| {
            let share = values.number("share").unwrap_or(0.4);
            let radius = values.number("radius").unwrap_or(0.12);
            let centre = [0.5; 2];
            let disc = SquarePart::Disc { centre, radius };
            made(
                "radius",
                vec![(1.0 - share, SquarePart::Flat), (share, disc)],
            )
        }),
    },
    Entry {
        names: &["mix"],
        summary: "in the plane: a ramp, a small highlight and a sharp disc together on the unit square",
        reference: "after Walter 1998, Density estimation techniques for global illumination",
        parameters: &[],
        build: Builder::Plane(|_| {
            // 0.3 + 0.6 x + 6 exp(-r²/(2·0.04²)) + 2·[disc], scaled to mass 1
            let (centre, deviation) = ([0.3, 0.35], 0.04);
            let peak = TAU * deviation * deviation * kept(0.3, deviation) * kept(0.35, deviation);
            let radius = 0.15;
            made(
                "mix",
                vec![
                    (0.3, SquarePart::Flat),
                    (0.3, SquarePart::Ramp),
                    (6.0 * peak, SquarePart::Spot { centre, deviation }),
                    (
                        2.0 * PI * radius * radius,
                        SquarePart::Disc {
                            centre: [0.65; 2],
                            radius,
                        },
                    ),
                ],
            )
        }),
    },
];

fn made(
    parameter: &'static str,
    parts: Vec<(f64, SquarePart)>,
) -> Result<Arc<dyn Bivariate>, BuildError> {
    Square::new(parts)
        .map(|square| Arc::new(square) as Arc<dyn Bivariate>)
        .ok_or_else(|| BuildError {
            parameter,
            what: format!("`{parameter}` must be at least 1e-4"),
        })
}
