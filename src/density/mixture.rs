//! Weighted sums of normal densities: nearly any shape, and every error of a Gaussian kernel estimate in closed form.

use super::{Builder, Density, Entry, Univariate};
use crate::numeric::root;
use crate::numeric::special::{
    normal_density, normal_density_derivative, normal_distribution, normal_probability,
    normal_quantile, normal_quantiles,
};
use crate::parameter::{BuildError, Kind, Parameter, Values};
use crate::random::{Stream, open_pairs, open_unit};
use crate::space::{Domain, Field, Point};
use pulp::{Arch, Simd, WithSimd};
use std::sync::Arc;

/// One part of a normal mixture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalComponent {
    /// Its share of the mass.
    pub weight: f64,
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// Why components are not a mixture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MixtureError {
    /// There are none.
    #[error("a mixture needs at least one component")]
    Empty,
    /// A number is not one that a component can have.
    #[error(
        "component {component}: needs a positive weight, a mean within ±1e100 and a deviation from 1e-100 to 1e100"
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
        "the narrowest component is less than a millionth of the width of the whole mixture, too fine for its errors to be computed"
    )]
    Scales,
}

/// f(x) = Σ wᵢ φ((x - μᵢ) / σᵢ) / σᵢ.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMixture {
    components: Vec<NormalComponent>,
    domain: Domain<1>,
}

impl NormalMixture {
    /// The mixture of `components`, whose weights sum to 1 within 1e-9 (and are then scaled to sum to 1 exactly).
    ///
    /// # Errors
    /// If there is no component, one of its numbers is out of range, the weights are not shares, or the components differ too much in scale.
    pub fn new(mut components: Vec<NormalComponent>) -> Result<Self, MixtureError> {
        if components.is_empty() {
            return Err(MixtureError::Empty);
        }
        for (i, part) in components.iter().enumerate() {
            let legal = part.weight > 0.0
                && part.weight.is_finite()
                && part.mean.abs() <= 1e100
                && (1e-100..=1e100).contains(&part.deviation);
            if !legal {
                return Err(MixtureError::Component { component: i + 1 });
            }
        }
        let sum: f64 = components.iter().map(|part| part.weight).sum();
        if (sum - 1.0).abs() > 1e-9 {
            return Err(MixtureError::Weights { sum });
        }
        for part in &mut components {
            part.weight /= sum;
        }
        let mixture = Self {
            components,
            domain: Domain::whole(),
        };
        let ([low], [high]) = mixture.bulk(1e-3);
        if high - low > 1e6 * mixture.finest_scale(0) {
            return Err(MixtureError::Scales);
        }
        Ok(mixture)
    }

    /// Σ wᵢ g(component, standardised x).
    fn sum(&self, x: f64, g: impl Fn(&NormalComponent, f64) -> f64) -> f64 {
        self.components
            .iter()
            .map(|part| part.weight * g(part, (x - part.mean) / part.deviation))
            .sum()
    }

    /// The least and the greatest of the components' places that lie `z` deviations from their means.
    fn extremes(&self, z: f64) -> (f64, f64) {
        self.components.iter().fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(least, greatest), part| {
                let place = z.mul_add(part.deviation, part.mean);
                (least.min(place), greatest.max(place))
            },
        )
    }
}

/// Draws treated together: some thousand, for which lists are laid out once.
const CHUNK: usize = 1024;

/// Turns standard normal `places` into places of the component that each of `shares` chooses.
struct Place<'a> {
    components: &'a [NormalComponent],
    shares: &'a mut [f64],
    places: &'a mut [f64],
}

/// `yes` where the mask is all ones, `no` where it is zero.
#[inline(always)]
fn masked(mask: u64, yes: f64, no: f64) -> f64 {
    f64::from_bits((yes.to_bits() & mask) | (no.to_bits() & !mask))
}

impl WithSimd for Place<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Some((last, others)) = self.components.split_last() else {
            return;
        };
        if let [first] = others {
            // two, as often: their numbers stay in registers
            for (place, share) in self.places.iter_mut().zip(&*self.shares) {
                let chosen = u64::from(share - first.weight < 0.0).wrapping_neg();
                let mean = masked(chosen, first.mean, last.mean);
                let deviation = masked(chosen, first.deviation, last.deviation);
                *place = place.mul_add(deviation, mean);
            }
            return;
        }
        let count = self.places.len();
        let (mut means, mut deviations) = ([last.mean; CHUNK], [last.deviation; CHUNK]);
        for part in others {
            let chosen = means[..count].iter_mut().zip(&mut deviations[..count]);
            for (share, (mean, deviation)) in self.shares.iter_mut().zip(chosen) {
                let left = *share - part.weight;
                // once below zero it stays there; a mask and no branch, which would be guessed wrong half of the time
                let here = (u64::from(*share >= 0.0) & u64::from(left < 0.0)).wrapping_neg();
                *mean = masked(here, part.mean, *mean);
                *deviation = masked(here, part.deviation, *deviation);
                *share = left;
            }
        }
        let chosen = means[..count].iter().zip(&deviations[..count]);
        for (place, (mean, deviation)) in self.places.iter_mut().zip(chosen) {
            *place = place.mul_add(*deviation, *mean);
        }
    }
}

impl Field<1> for NormalMixture {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        self.sum(x, |part, z| normal_density(z) / part.deviation)
    }
}

impl Density<1> for NormalMixture {
    /// Two random words a draw, always: the first chooses the component, the second is inverted.
    fn draw(&self, random: &mut Stream) -> Point<1> {
        let (mut share, z) = (open_unit(random), normal_quantile(open_unit(random)));
        let last = self.components.len() - 1;
        let chosen = self.components[..last]
            .iter()
            .find(|part| {
                share -= part.weight;
                share < 0.0
            })
            .unwrap_or(&self.components[last]);
        [z.mul_add(chosen.deviation, chosen.mean)]
    }

    fn draws(&self, many: usize, random: &mut Stream) -> Vec<Point<1>> {
        let mut points = vec![[0.0]; many];
        let mut shares = [0.0; CHUNK];
        for places in points.as_flattened_mut().chunks_mut(CHUNK) {
            let shares = &mut shares[..places.len()];
            open_pairs(random, shares, places);
            normal_quantiles(places);
            Arch::new().dispatch(Place {
                components: &self.components,
                shares,
                places,
            });
        }
        points
    }

    fn probability(&self, [low]: Point<1>, [high]: Point<1>) -> f64 {
        self.sum(low, |part, z| {
            normal_probability(z, (high - part.mean) / part.deviation)
        })
    }

    fn breaks(&self, _axis: usize) -> Vec<f64> {
        Vec::new()
    }

    fn finest_scale(&self, _axis: usize) -> f64 {
        self.components
            .iter()
            .map(|part| part.deviation)
            .fold(f64::INFINITY, f64::min)
    }

    fn bulk(&self, tail: f64) -> (Point<1>, Point<1>) {
        let z = normal_quantile(tail.clamp(1e-300, 0.5));
        ([self.extremes(z).0], [self.extremes(-z).1])
    }

    fn univariate(&self) -> Option<&dyn Univariate> {
        Some(self)
    }
}

impl Univariate for NormalMixture {
    fn distribution(&self, x: f64) -> f64 {
        self.sum(x, |_, z| normal_distribution(z))
    }

    /// By bisection between the least and the greatest quantile of the components, in the tail that p lies in: about 60 evaluations.
    fn quantile(&self, p: f64) -> f64 {
        if !(0.0..=1.0).contains(&p) {
            return f64::NAN;
        }
        let (tail, sign) = if p <= 0.5 { (p, 1.0) } else { (1.0 - p, -1.0) };
        let z = sign * normal_quantile(tail);
        let (least, greatest) = self.extremes(z);
        if z.is_infinite() || least >= greatest {
            return least;
        }
        let excess = |x| self.sum(x, |_, z| normal_distribution(sign * z)) - tail;
        // rounding may hide the change of sign when all mass is in one component
        root(excess, least, greatest).unwrap_or_else(|| {
            if excess(least).abs() <= excess(greatest).abs() {
                least
            } else {
                greatest
            }
        })
    }

    fn derivative(&self, order: u32, x: f64) -> f64 {
        self.sum(x, |part, z| {
            normal_density_derivative(order, z) / part.deviation.powi(order as i32 + 1)
        })
    }

    /// (-1)ʳ Σ wᵢ wⱼ φ⁽²ʳ⁾(μᵢ - μⱼ; σᵢ² + σⱼ²). [Marron & Wand 1992, theorem 4.1]
    fn roughness(&self, order: u32) -> f64 {
        let sign = if order.is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut total = 0.0;
        for a in &self.components {
            for b in &self.components {
                let s = a.deviation.hypot(b.deviation);
                total += a.weight
                    * b.weight
                    * normal_density_derivative(2 * order, (a.mean - b.mean) / s)
                    / s.powi(2 * order as i32 + 1);
            }
        }
        sign * total
    }

    fn mean_and_deviation(&self) -> (f64, f64) {
        let of = |g: &dyn Fn(&NormalComponent) -> f64| -> f64 {
            self.components
                .iter()
                .map(|part| part.weight * g(part))
                .sum()
        };
        let mean = of(&|part| part.mean);
        let variance = of(&|part| part.deviation.powi(2) + (part.mean - mean).powi(2));
        (mean, variance.sqrt())
    }

    fn normal_components(&self) -> Option<&[NormalComponent]> {
        Some(&self.components)
    }
}

pub(super) const ENTRIES: &[Entry] = &[Entry {
    names: &["normal-mixture"],
    summary: "weighted normals, given component by component",
    reference: "Marron & Wand 1992, eq. 2.1",
    parameters: &[Parameter::required(
        "components",
        Kind::Rows(&[
            Parameter::required(
                "weight",
                Kind::Positive,
                "its share of the mass; all shares sum to 1",
            ),
            Parameter::required("mean", Kind::Real, "its mean"),
            Parameter::required("deviation", Kind::Positive, "its standard deviation"),
        ]),
        "the normals: a list of { weight, mean, deviation }",
    )],
    build: Builder::Line(build),
}];

fn build(values: &Values) -> Result<Arc<dyn Univariate>, BuildError> {
    let number = |row: &Values, name| row.number(name).unwrap_or(f64::NAN);
    let components = values
        .rows("components")
        .iter()
        .map(|row| NormalComponent {
            weight: number(row, "weight"),
            mean: number(row, "mean"),
            deviation: number(row, "deviation"),
        })
        .collect();
    match NormalMixture::new(components) {
        Ok(mixture) => Ok(Arc::new(mixture)),
        Err(error) => Err(BuildError {
            parameter: "components",
            what: error.to_string(),
        }),
    }
}
