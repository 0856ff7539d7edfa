//! Weighted normals in the plane, with any covariance.

use super::slices::standard_normal;
use crate::density::{Bivariate, Builder, Density, Entry};
use crate::numeric::special::{
    normal_density, normal_distribution, normal_probability, normal_quantile,
};
use crate::numeric::{GaussLegendre, panels};
use crate::parameter::{Absent, BuildError, Kind, Parameter, Values};
use crate::random::{Stream, open_unit};
use crate::space::{Domain, Field, Point};
use std::f64::consts::TAU;
use std::sync::Arc;

/// One part of a mixture of normals in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneComponent {
    /// Its share of the mass.
    pub weight: f64,
    /// Its mean.
    pub mean: Point<2>,
    /// Its covariance matrix.
    pub covariance: [[f64; 2]; 2],
}

impl PlaneComponent {
    /// The component with these deviations of the axes and this correlation.
    pub fn new(weight: f64, mean: Point<2>, deviation: [f64; 2], correlation: f64) -> Self {
        let [s, t] = deviation;
        let shared = correlation * s * t;
        Self {
            weight,
            mean,
            covariance: [[s * s, shared], [shared, t * t]],
        }
    }

    fn deviations(&self) -> [f64; 2] {
        [0, 1].map(|axis: usize| self.covariance[axis][axis].sqrt())
    }

    fn correlation(&self) -> f64 {
        let [s, t] = self.deviations();
        self.covariance[0][1] / s / t
    }
}

/// φ_Σ(d), |Σ⁻¹d|² - tr Σ⁻¹ and the factor of Δ²: what φ, its gradient, Laplacian and bilaplacian are made of.
pub struct NormalAt {
    /// φ_Σ(d) = exp(-dᵀΣ⁻¹d / 2) / (2π √det Σ).
    pub density: f64,
    /// q = Σ⁻¹d; ∇φ = -φ q.
    pub pull: [f64; 2],
    /// Δφ/φ = |q|² - tr Σ⁻¹.
    pub laplacian: f64,
    /// Δ²φ/φ = (Δφ/φ)² - 4 qᵀΣ⁻¹q + 2 tr Σ⁻².
    pub bilaplacian: f64,
}

/// The normal density with covariance `covariance` at the distance `d` from its mean, with its derivatives as multiples of it.
pub fn normal_at(d: [f64; 2], covariance: [[f64; 2]; 2]) -> NormalAt {
    let [[a, b], [_, c]] = covariance;
    let determinant = a * c - b * b;
    let (p, r, s) = (c / determinant, -b / determinant, a / determinant);
    let pull = [p * d[0] + r * d[1], r * d[0] + s * d[1]];
    let square = pull[0] * d[0] + pull[1] * d[1];
    let laplacian = pull[0] * pull[0] + pull[1] * pull[1] - p - s;
    let around = p * pull[0] * pull[0] + 2.0 * r * pull[0] * pull[1] + s * pull[1] * pull[1];
    NormalAt {
        density: (-0.5 * square).exp() / (TAU * determinant.sqrt()),
        pull,
        laplacian,
        bilaplacian: laplacian * laplacian - 4.0 * around + 2.0 * (p * p + 2.0 * r * r + s * s),
    }
}

/// Why components are not a mixture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlaneMixtureError {
    /// There are none.
    #[error("a mixture needs at least one component")]
    Empty,
    /// A number is not one that a component can have.
    #[error(
        "component {component}: needs a positive weight, means within ±1e100, deviations from 1e-100 to 1e100 and a correlation within ±0.999"
    )]
    Component {
        /// Which, from 1.
        component: usize,
    },
    /// The weights are not shares.
    #[error("the weights must sum to 1; they sum to {sum}")]
    Weights {
        /// What they sum to.
        sum: f64,
    },
    /// Details too fine for the whole.
    #[error(
        "the narrowest component is less than a ten-thousandth of the width of the whole mixture, too fine for its errors to be computed"
    )]
    Scales,
}

/// f(x) = Σ wᵢ φ_Σᵢ(x - μᵢ).
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneMixture {
    components: Vec<PlaneComponent>,
    domain: Domain<2>,
}

impl PlaneMixture {
    /// The mixture of `components`, whose weights sum to 1 within 1e-9 (and are then scaled to sum to 1 exactly).
    ///
    /// # Errors
    /// If there is no component, one of its numbers is out of range, the weights are not shares, or the components differ too much in scale.
    pub fn new(mut components: Vec<PlaneComponent>) -> Result<Self, PlaneMixtureError> {
        if components.is_empty() {
            return Err(PlaneMixtureError::Empty);
        }
        for (i, part) in components.iter().enumerate() {
            let [s, t] = part.deviations();
            let legal = part.weight > 0.0
                && part.weight.is_finite()
                && part.mean.iter().all(|mean| mean.abs() <= 1e100)
                && [s, t].iter().all(|s| (1e-100..=1e100).contains(s))
                && (part.covariance[0][1] - part.covariance[1][0]).abs() <= 1e-12 * s * t
                && part.correlation().abs() <= 0.999;
            if !legal {
                return Err(PlaneMixtureError::Component { component: i + 1 });
            }
        }
        let sum: f64 = components.iter().map(|part| part.weight).sum();
        if (sum - 1.0).abs() > 1e-9 {
            return Err(PlaneMixtureError::Weights { sum });
        }
        for part in &mut components {
            part.weight /= sum;
        }
        let mixture = Self {
            components,
            domain: Domain::whole(),
        };
        let (low, high) = mixture.bulk(1e-3);
        if (0..2).any(|axis| high[axis] - low[axis] > 1e4 * mixture.finest_scale(axis)) {
            return Err(PlaneMixtureError::Scales);
        }
        Ok(mixture)
    }

    /// N(0, I).
    pub fn standard() -> Self {
        Self {
            components: vec![PlaneComponent::new(1.0, [0.0; 2], [1.0; 2], 0.0)],
            domain: Domain::whole(),
        }
    }

    fn sum(&self, x: Point<2>, g: impl Fn(&NormalAt) -> f64) -> f64 {
        self.components
            .iter()
            .map(|part| {
                let d = [x[0] - part.mean[0], x[1] - part.mean[1]];
                let at = normal_at(d, part.covariance);
                // far out the factors overflow where the density has long been zero
                if at.density > 0.0 {
                    part.weight * at.density * g(&at)
                } else {
                    0.0
                }
            })
            .sum()
    }

    /// Σᵢⱼ wᵢ wⱼ g of the normal with covariance Σᵢ + Σⱼ at μᵢ - μⱼ.
    fn pairs(&self, g: impl Fn(&NormalAt) -> f64) -> f64 {
        let mut total = 0.0;
        for a in &self.components {
            for b in &self.components {
                let d = [a.mean[0] - b.mean[0], a.mean[1] - b.mean[1]];
                let mut covariance = a.covariance;
                for (row, more) in covariance.iter_mut().zip(b.covariance) {
                    row.iter_mut().zip(more).for_each(|(x, y)| *x += y);
                }
                let at = normal_at(d, covariance);
                if at.density > 0.0 {
                    total += a.weight * b.weight * at.density * g(&at);
                }
            }
        }
        total
    }
}

impl Field<2> for PlaneMixture {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        if x.iter().any(|x| x.is_infinite()) {
            return 0.0;
        }
        self.sum(x, |_| 1.0)
    }
}

/// The probability that a standard normal pair with this correlation lies in the box: by Gauss-Legendre panels over the first coordinate, to about
/// 1e-14.
fn box_probability(low: [f64; 2], high: [f64; 2], correlation: f64) -> f64 {
    if correlation == 0.0 {
        return normal_probability(low[0], high[0]) * normal_probability(low[1], high[1]);
    }
    let rest = (1.0 - correlation * correlation).sqrt();
    let given = |u: f64| {
        let from = |v: f64| (v - correlation * u) / rest;
        normal_density(u) * normal_probability(from(low[1]), from(high[1]))
    };
    // beyond 9 deviations lies less than 1e-18
    let (from, to) = (low[0].max(-9.0), high[0].min(9.0));
    if from >= to {
        return 0.0;
    }
    let steps = [low[1], high[1]].into_iter().flat_map(|v| {
        // where the inner probability rises or falls
        [-3.0, 0.0, 3.0].map(|z| (v - z * rest) / correlation)
    });
    let scale = (rest / correlation.abs()).min(1.0);
    GaussLegendre::new(16).integrate_panels(
        given,
        &panels(from, to, steps.filter(|cut| cut.is_finite()), scale),
    )
}

impl Density<2> for PlaneMixture {
    /// Three random words a draw, always: the first chooses the component.
    fn draw(&self, random: &mut Stream) -> Point<2> {
        let mut share = open_unit(random);
        let (u, v) = (
            normal_quantile(open_unit(random)),
            normal_quantile(open_unit(random)),
        );
        let last = self.components.len() - 1;
        let chosen = self.components[..last]
            .iter()
            .find(|part| {
                share -= part.weight;
                share < 0.0
            })
            .unwrap_or(&self.components[last]);
        let ([s, t], correlation) = (chosen.deviations(), chosen.correlation());
        let rest = (1.0 - correlation * correlation).sqrt();
        [
            s.mul_add(u, chosen.mean[0]),
            t.mul_add(correlation.mul_add(u, rest * v), chosen.mean[1]),
        ]
    }

    fn probability(&self, low: Point<2>, high: Point<2>) -> f64 {
        self.components
            .iter()
            .map(|part| {
                let deviation = part.deviations();
                let standard =
                    |x: Point<2>| [0, 1].map(|k: usize| (x[k] - part.mean[k]) / deviation[k]);
                part.weight * box_probability(standard(low), standard(high), part.correlation())
            })
            .sum()
    }

    fn breaks(&self, _axis: usize) -> Vec<f64> {
        Vec::new()
    }

    /// The least deviation along `axis` on a line of that direction: that given the other coordinate.
    fn finest_scale(&self, axis: usize) -> f64 {
        self.components
            .iter()
            .map(|part| part.deviations()[axis] * (1.0 - part.correlation().powi(2)).sqrt())
            .fold(f64::INFINITY, f64::min)
    }

    fn bulk(&self, tail: f64) -> (Point<2>, Point<2>) {
        let z = normal_quantile(tail.clamp(1e-300, 0.5));
        let extreme = |axis: usize, sign: f64| {
            self.components
                .iter()
                .map(|part| sign * (sign * z).mul_add(part.deviations()[axis], part.mean[axis]))
                .fold(f64::INFINITY, f64::min)
                * sign
        };
        (
            [extreme(0, 1.0), extreme(1, 1.0)],
            [extreme(0, -1.0), extreme(1, -1.0)],
        )
    }

    fn bivariate(&self) -> Option<&dyn Bivariate> {
        Some(self)
    }
}

impl Bivariate for PlaneMixture {
    /// In coordinates in which a component is round.
    fn probability_within(&self, corners: &[Point<2>]) -> f64 {
        self.components
            .iter()
            .map(|part| {
                let ([s, t], correlation) = (part.deviations(), part.correlation());
                let rest = (1.0 - correlation * correlation).sqrt();
                let round = |x: &Point<2>| {
                    let u = (x[0] - part.mean[0]) / s;
                    let v = (x[1] - part.mean[1]) / t;
                    [u, (v - correlation * u) / rest]
                };
                let ring: Vec<Point<2>> = corners.iter().map(round).collect();
                part.weight * standard_normal(&ring)
            })
            .sum()
    }

    fn gradient(&self, x: Point<2>) -> [f64; 2] {
        [0, 1].map(|axis: usize| -self.sum(x, |at| at.pull[axis]))
    }

    fn laplacian(&self, x: Point<2>) -> f64 {
        self.sum(x, |at| at.laplacian)
    }

    /// -Σ wᵢ wⱼ Δφ(μᵢ - μⱼ; Σᵢ + Σⱼ).
    fn gradient_roughness(&self) -> f64 {
        -self.pairs(|at| at.laplacian)
    }

    /// Σ wᵢ wⱼ Δ²φ(μᵢ - μⱼ; Σᵢ + Σⱼ). [Wand & Jones 1995, section 4.3]
    fn laplacian_roughness(&self) -> f64 {
        self.pairs(|at| at.bilaplacian)
    }

    fn mean_and_covariance(&self) -> (Point<2>, [[f64; 2]; 2]) {
        moments(
            self.components
                .iter()
                .map(|part| (part.weight, part.mean, part.covariance)),
        )
    }

    fn normal_components(&self) -> Option<&[PlaneComponent]> {
        Some(&self.components)
    }
}

/// The mean and covariance of a mixture of parts with these weights, means and covariances.
#[expect(
    clippy::needless_pass_by_value,
    reason = "an iterator is a value; it is walked several times"
)]
pub(super) fn moments(
    parts: impl Iterator<Item = (f64, Point<2>, [[f64; 2]; 2])> + Clone,
) -> (Point<2>, [[f64; 2]; 2]) {
    let mean = [0, 1].map(|k: usize| parts.clone().map(|(w, m, _)| w * m[k]).sum::<f64>());
    let covariance = [0, 1].map(|i: usize| {
        [0, 1].map(|j: usize| {
            parts
                .clone()
                .map(|(w, m, c)| w * (c[i][j] + (m[i] - mean[i]) * (m[j] - mean[j])))
                .sum()
        })
    });
    (mean, covariance)
}

pub(in crate::density) const ENTRIES: &[Entry] = &[
    Entry {
        names: &["normal-2d", "gaussian-2d"],
        summary: "in the plane: the standard normal density, round",
        reference: "Wand & Jones 1995, section 4.2",
        parameters: &[],
        build: Builder::Plane(|_| Ok(Arc::new(PlaneMixture::standard()))),
    },
    Entry {
        names: &["normal-mixture-2d"],
        summary: "in the plane: weighted normals, given component by component",
        reference: "Wand & Jones 1993, Comparison of smoothing parameterizations, JASA 88",
        parameters: &[Parameter::required(
            "components",
            Kind::Rows(&[
                Parameter::required(
                    "weight",
                    Kind::Positive,
                    "its share of the mass; all shares sum to 1",
                ),
                Parameter::required("mean-x", Kind::Real, "its mean on the first axis"),
                Parameter::required("mean-y", Kind::Real, "its mean on the second axis"),
                Parameter::required(
                    "deviation-x",
                    Kind::Positive,
                    "its standard deviation on the first axis",
                ),
                Parameter::optional(
                    "deviation-y",
                    Kind::Positive,
                    Absent::Unset,
                    "its standard deviation on the second axis; that of the first by default",
                ),
                Parameter::optional(
                    "correlation",
                    Kind::Between(-1.0, 1.0),
                    Absent::Number(0.0),
                    "the correlation of the two coordinates, within ±0.999",
                ),
            ]),
            "the normals: a list of { weight, mean-x, mean-y, deviation-x, deviation-y, correlation }",
        )],
        build: Builder::Plane(build),
    },
];

fn build(values: &Values) -> Result<Arc<dyn Bivariate>, BuildError> {
    let number = |row: &Values, name| row.number(name).unwrap_or(f64::NAN);
    let components = values
        .rows("components")
        .iter()
        .map(|row| {
            let deviation = number(row, "deviation-x");
            PlaneComponent::new(
                number(row, "weight"),
                [number(row, "mean-x"), number(row, "mean-y")],
                [deviation, row.number("deviation-y").unwrap_or(deviation)],
                row.number("correlation").unwrap_or(0.0),
            )
        })
        .collect();
    match PlaneMixture::new(components) {
        Ok(mixture) => Ok(Arc::new(mixture)),
        Err(error) => Err(BuildError {
            parameter: "components",
            what: error.to_string(),
        }),
    }
}

/// Φ, for others that draw and measure truncated normals.
pub(super) fn below(z: f64) -> f64 {
    normal_distribution(z)
}
