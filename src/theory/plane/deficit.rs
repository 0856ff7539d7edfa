//! How much a density of the plane differs from itself a little further on.

use crate::density::{Bivariate, PlaneComponent, normal_at};
use crate::numeric::Sum;
use crate::theory::autocorrelation::Deficit;
use crate::theory::kernel::Parts;

/// Two components: the product of their weights, the distance of their means, the sum of their covariances.
pub(super) struct Pair {
    weight: f64,
    distance: [f64; 2],
    covariance: [[f64; 2]; 2],
}

pub(super) fn sum(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|i: usize| [0, 1].map(|j: usize| a[i][j] + b[i][j]))
}

/// All ordered pairs.
pub(super) fn pairs(components: &[PlaneComponent]) -> Vec<Pair> {
    let each = |a: &PlaneComponent, b: &PlaneComponent| Pair {
        weight: a.weight * b.weight,
        distance: [0, 1].map(|k: usize| a.mean[k] - b.mean[k]),
        covariance: sum(a.covariance, b.covariance),
    };
    components
        .iter()
        .flat_map(|a| components.iter().map(move |b| each(a, b)))
        .collect()
}

impl Pair {
    /// Its part of D(t), to full relative precision for small t.
    fn deficit(&self, t: [f64; 2]) -> f64 {
        let still = normal_at(self.distance, self.covariance);
        let [[a, b], [_, c]] = self.covariance;
        let determinant = a * c - b * b;
        // t'Σ⁻¹t and t'Σ⁻¹d
        let square = (c * t[0] * t[0] - 2.0 * b * t[0] * t[1] + a * t[1] * t[1]) / determinant;
        let along = t[0] * still.pull[0] + t[1] * still.pull[1];
        let density = if square < 1.0 && along.abs() < 1.0 {
            // φ(d) [1 - exp(-t'Σ⁻¹t/2) cosh(t'Σ⁻¹d)] without its cancellation
            let rise = 2.0 * (0.5 * along).sinh().powi(2);
            -still.density * (-0.5 * square).exp_m1().mul_add(along.cosh(), rise)
        } else {
            let moved = |sign: f64| {
                let place = [0, 1].map(|k: usize| self.distance[k] + sign * t[k]);
                normal_at(place, self.covariance).density
            };
            still.density - 0.5 * (moved(-1.0) + moved(1.0))
        };
        self.weight * density
    }

    /// The deviation in the narrowest direction.
    fn narrowest(&self) -> f64 {
        let [[a, b], [_, c]] = self.covariance;
        let middle = 0.5 * (a + c);
        (middle - (0.25 * (a - c) * (a - c) + b * b).sqrt()).sqrt()
    }
}

/// The closed form for the Gaussian kernel: with gₐ the mixture's autocorrelation smoothed by the covariance a·diag(h²), at 0, bias² = g₂ - 2g₁ + g₀.
/// [Wand & Jones 1993; Marron & Wand 1992, theorem 2.1, in the plane]
pub(super) fn closed(pairs: &[Pair], h: [f64; 2]) -> Parts {
    let (mut squared_bias, mut lost, mut roughness) =
        (Sum::default(), Sum::default(), Sum::default());
    for pair in pairs {
        let narrow = normal_at(pair.distance, pair.covariance);
        let rise = |a: f64| {
            let [s, t] = h.map(|h| a * h * h);
            let wide = normal_at(pair.distance, sum(pair.covariance, [[s, 0.0], [0.0, t]]));
            let [[p, r], [_, q]] = pair.covariance;
            // gₐ - g₀ by the logarithm of their quotient where they are close, so that small bandwidths lose no digits
            let determinants = (p * t + q * s + s * t) / (p * q - r * r);
            let squares = s * wide.pull[0] * narrow.pull[0] + t * wide.pull[1] * narrow.pull[1];
            let logarithm = 0.5 * (squares - determinants.ln_1p());
            if logarithm.abs() < 1.0 {
                narrow.density * logarithm.exp_m1()
            } else {
                wide.density - narrow.density
            }
        };
        let fallen = pair.weight * rise(2.0);
        squared_bias.add(fallen);
        squared_bias.add(-2.0 * pair.weight * rise(1.0));
        lost.add(-fallen);
        roughness.add(pair.weight * narrow.density);
    }
    Parts {
        squared_bias: squared_bias.value().max(0.0),
        lost: lost.value(),
        roughness: roughness.value(),
    }
}

/// D(t) of a density.
pub(super) enum PlaneDeficit {
    Mixture(Vec<Pair>),
    Product(Box<[Deficit; 2]>, [f64; 2]),
}

impl PlaneDeficit {
    pub(super) fn of(truth: &dyn Bivariate) -> Option<Self> {
        if let Some(components) = truth.normal_components() {
            return Some(Self::Mixture(pairs(components)));
        }
        let factors = truth.factors()?;
        let scales = factors.map(|factor| factor.finest_scale(0));
        Some(Self::Product(Box::new(factors.map(Deficit::of)), scales))
    }

    pub(super) fn at(&self, t: [f64; 2]) -> f64 {
        match self {
            Self::Mixture(pairs) => pairs.iter().map(|pair| pair.deficit(t)).sum(),
            Self::Product(axes, _) => {
                // c₁c₂ - (c₁ - d₁)(c₂ - d₂)
                let [d, e] = [0, 1].map(|k: usize| axes[k].at(t[k].abs()));
                axes[0].total() * e + axes[1].total() * d - d * e
            }
        }
    }

    /// ∫f².
    pub(super) fn total(&self) -> f64 {
        match self {
            Self::Mixture(pairs) => pairs
                .iter()
                .map(|pair| pair.weight * normal_at(pair.distance, pair.covariance).density)
                .sum(),
            Self::Product(axes, _) => axes[0].total() * axes[1].total(),
        }
    }

    /// Where it is not smooth, or a table of it has pieces, along an axis.
    pub(super) fn kinks(&self, axis: usize) -> Vec<f64> {
        match self {
            Self::Mixture(_) => Vec::new(),
            Self::Product(axes, _) => axes[axis].cuts().collect(),
        }
    }

    /// Over which lengths it changes, along each axis.
    pub(super) fn scales(&self) -> [f64; 2] {
        match self {
            Self::Mixture(pairs) => {
                let least = |scale: f64, pair: &Pair| scale.min(pair.narrowest());
                [pairs.iter().fold(f64::INFINITY, least); 2]
            }
            Self::Product(_, scales) => *scales,
        }
    }
}
