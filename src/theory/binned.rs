//! Mean and variance at one place of the estimates that are linear in the counts of bins.

use super::Moments;
use super::integrated::panels_of;
use crate::density::Density;
use crate::numeric::orthogonal::{Basis, Legendre};
use crate::numeric::{GaussLegendre, Sum};

/// Moments of Σ cⱼ νⱼ where ν are the shares of `draws` points in disjoint bins, given as (low, high, c): the counts are multinomial, so
/// the variance is \[Σ cⱼ² pⱼ - (Σ cⱼ pⱼ)²\] / n.
fn linear(
    truth: &dyn Density<1>,
    draws: f64,
    bins: impl Iterator<Item = (f64, f64, f64)>,
) -> Moments {
    let (mut mean, mut square) = (0.0, 0.0);
    for (low, high, c) in bins {
        let p = truth.probability([low], [high]);
        mean += c * p;
        square += c * c * p;
    }
    Moments {
        mean,
        variance: ((square - mean * mean) / draws).max(0.0),
    }
}

/// The moments at `x` of the histogram with bins [origin + k·width, origin + (k + 1)·width). [Scott 1992, eq. 3.13]
pub fn histogram_moments(
    truth: &dyn Density<1>,
    width: f64,
    origin: f64,
    draws: f64,
    x: f64,
) -> Moments {
    shifted_histogram_moments(truth, width, 1, origin, draws, x)
}

/// The moments at `x` of the mean of `shifts` histograms whose origins are width/shifts apart: Σ_{|i|<m} (1 - |i|/m) νₖ₊ᵢ / width with ν the shares of
/// the narrow bins and k that of x. [Scott 1992, section 5.1]
pub fn shifted_histogram_moments(
    truth: &dyn Density<1>,
    width: f64,
    shifts: u32,
    origin: f64,
    draws: f64,
    x: f64,
) -> Moments {
    let m = f64::from(shifts);
    let narrow = width / m;
    let centre = ((x - origin) / narrow).floor();
    let reach = i64::from(shifts) - 1;
    linear(
        truth,
        draws,
        (-reach..=reach).map(|i| {
            let i = i as f64;
            let low = (centre + i).mul_add(narrow, origin);
            let high = (centre + i + 1.0).mul_add(narrow, origin);
            (low, high, (1.0 - i.abs() / m) / width)
        }),
    )
}

/// The moments at `x` of the polygon through the histogram's values at the centres of its bins. [Scott 1985; Scott 1992, section 4.1]
pub fn polygon_moments(
    truth: &dyn Density<1>,
    width: f64,
    origin: f64,
    draws: f64,
    x: f64,
) -> Moments {
    let place = (x - origin) / width - 0.5;
    let (left, part) = (place.floor(), place - place.floor());
    let bin = |k: f64, c: f64| {
        (
            k.mul_add(width, origin),
            (k + 1.0).mul_add(width, origin),
            c / width,
        )
    };
    linear(
        truth,
        draws,
        [bin(left, 1.0 - part), bin(left + 1.0, part)].into_iter(),
    )
}

/// The moments at `x` of the histogram whose bins each hold a polynomial of `degree`: with the functions ψₖ of the bin of x, the mean of g(X) and its
/// variance over n, where g(y) = Σₖ ψₖ(x) ψₖ(y) inside the bin and 0 outside.
pub fn generalised_histogram_moments(
    truth: &dyn Density<1>,
    width: f64,
    origin: f64,
    degree: usize,
    draws: f64,
    x: f64,
) -> Moments {
    let number = ((x - origin) / width).floor();
    let (low, high) = (
        number.mul_add(width, origin),
        (number + 1.0).mul_add(width, origin),
    );
    let unit = |y: f64| ((y - origin) / width - number).clamp(0.0, 1.0);
    let here = Legendre::at(unit(x), degree + 1);
    let rule = GaussLegendre::new(24);
    let (mut mean, mut square) = (Sum::default(), Sum::default());
    for panel in panels_of(truth, low, high, []).windows(2) {
        for (y, weight) in rule.on(panel[0], panel[1]) {
            let there = Legendre::at(unit(y), degree + 1);
            let g = here.iter().zip(there).map(|(a, b)| a * b).sum::<f64>() / width;
            let term = weight * g * truth.at([y]);
            mean.add(term);
            square.add(term * g);
        }
    }
    let mean = mean.value();
    Moments {
        mean,
        variance: ((square.value() - mean * mean) / draws).max(0.0),
    }
}
