//! Waves of light on the unit square, without a spot or an edge.

use super::slices::{Change, sliced};
use crate::density::{Bivariate, Builder, Density, Entry};
use crate::numeric::root;
use crate::parameter::{Absent, Kind, Parameter};
use crate::random::{Stream, open_unit};
use crate::space::{Domain, Field, Point, clipped_to_box};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// f(x, y) = 1 + a sin 2πx sin 2πy on the unit square, |a| < 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Smooth {
    amplitude: f64,
    domain: Domain<2>,
}

impl Smooth {
    /// The waves of this amplitude; `None` unless it lies within ±1.
    pub fn new(amplitude: f64) -> Option<Self> {
        (amplitude.abs() <= 1.0).then(|| Self {
            amplitude,
            domain: Domain::unit(),
        })
    }

    fn inside(&self, x: Point<2>, value: impl Fn(f64, f64) -> f64) -> f64 {
        if self.domain.contains(x) {
            value(TAU * x[0], TAU * x[1])
        } else {
            0.0
        }
    }
}

impl Field<2> for Smooth {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        self.inside(x, |u, v| 1.0 + self.amplitude * u.sin() * v.sin())
    }
}

impl Density<2> for Smooth {
    /// Two random words a draw, always: x is uniform, and the distribution function of y given x is inverted.
    fn draw(&self, random: &mut Stream) -> Point<2> {
        let (x, p) = (open_unit(random), open_unit(random));
        let wave = self.amplitude * (TAU * x).sin() / TAU;
        let excess = |y: f64| wave.mul_add(1.0 - (TAU * y).cos(), y) - p;
        [x, root(excess, 0.0, 1.0).unwrap_or(p)]
    }

    fn probability(&self, low: Point<2>, high: Point<2>) -> f64 {
        let (low, high) = (
            low.map(|x| x.clamp(0.0, 1.0)),
            high.map(|x| x.clamp(0.0, 1.0)),
        );
        let area = (high[0] - low[0]).max(0.0) * (high[1] - low[1]).max(0.0);
        if area == 0.0 {
            return 0.0;
        }
        // ∫ sin 2πt dt as a product, so that small boxes lose no digits
        let wave =
            |k: usize| (PI * (high[k] + low[k])).sin() * (PI * (high[k] - low[k])).sin() / PI;
        area + self.amplitude * wave(0) * wave(1)
    }

    fn breaks(&self, _axis: usize) -> Vec<f64> {
        vec![0.0, 1.0]
    }

    fn finest_scale(&self, _axis: usize) -> f64 {
        1.0 / TAU
    }

    fn bulk(&self, _tail: f64) -> (Point<2>, Point<2>) {
        ([0.0; 2], [1.0; 2])
    }

    fn bivariate(&self) -> Option<&dyn Bivariate> {
        Some(self)
    }
}

impl Bivariate for Smooth {
    /// By slices, with ∫ sin 2πt dt as a product, so that short ones lose no digits.
    fn probability_within(&self, corners: &[Point<2>]) -> f64 {
        let change = Change {
            breaks: [Vec::new(), Vec::new()],
            scales: [1.0 / TAU; 2],
        };
        let ring = clipped_to_box(corners, [0.0; 2], [1.0; 2]);
        sliced(&ring, &change, |x, bottom, top| {
            let wave = (PI * (top + bottom)).sin() * (PI * (top - bottom)).sin() / PI;
            (self.amplitude * (TAU * x).sin()).mul_add(wave, top - bottom)
        })
    }

    fn gradient(&self, x: Point<2>) -> [f64; 2] {
        let a = TAU * self.amplitude;
        [
            self.inside(x, |u, v| a * u.cos() * v.sin()),
            self.inside(x, |u, v| a * u.sin() * v.cos()),
        ]
    }

    fn laplacian(&self, x: Point<2>) -> f64 {
        self.inside(x, |u, v| {
            -2.0 * TAU * TAU * self.amplitude * u.sin() * v.sin()
        })
    }

    /// Infinite: the density jumps at the walls.
    fn gradient_roughness(&self) -> f64 {
        f64::INFINITY
    }

    fn laplacian_roughness(&self) -> f64 {
        f64::INFINITY
    }

    fn mean_and_covariance(&self) -> (Point<2>, [[f64; 2]; 2]) {
        let shared = self.amplitude / (TAU * TAU);
        ([0.5; 2], [[1.0 / 12.0, shared], [shared, 1.0 / 12.0]])
    }
}

pub(in crate::density) const ENTRIES: &[Entry] = &[Entry {
    names: &["smooth"],
    summary: "in the plane: 1 + a sin 2πx sin 2πy on the unit square",
    reference: "-",
    parameters: &[Parameter::optional(
        "amplitude",
        Kind::Between(-1.0, 1.0),
        Absent::Number(0.8),
        "a, how high the waves are",
    )],
    build: Builder::Plane(|values| {
        let amplitude = values.number("amplitude").unwrap_or(0.8);
        Ok(Arc::new(
            Smooth::new(amplitude).expect("checked to lie between -1 and 1"),
        ))
    }),
}];
