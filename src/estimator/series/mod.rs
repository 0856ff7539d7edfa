//! Orthogonal series: the density as a sum of waves, each weighed by the data.
//!
//! f̂(x) = Σₖ λₖ ĉₖ ψₖ(x) with ĉₖ = Σᵢ wᵢ ψₖ(Xᵢ) and ψ orthonormal. Each ĉₖ is unbiased for ∫ψₖ f; the number of terms is what smooths. The waves do not know
//! that a density is positive: unless the taper is Fejér's on cosines, the estimate can be negative, mostly where the density is small or ends at a jump.
//!
//! | estimator | waves | where | keeps mass | file |
//! |---|---|---|---|---|
//! | `cosine-series` | √2 cos πku | an interval | yes | `interval.rs` |
//! | `legendre-series` | Legendre polynomials | an interval | yes | `interval.rs` |
//! | `fourier-series` | sines and cosines of whole periods | an interval, best one that wraps round | yes | `interval.rs` |
//! | `hermite-series` | Hermite functions | the line | no | `line.rs` |
//!
//! The interval is the domain of the data, where it has two ends; or `low` to `high`, and then data outside are left out and with them their mass.
//!
//! In the plane the functions are products of those of the axes, as many on one as on the other; the domain is a rectangle. O(n J² + m J²), on a grid O(n J² + m J).
//!
//! # How many terms
//! A number, or the one that minimises the unbiased estimate of the risk, `"cross-validation"`: with n the effective size,
//! MISE - ∫f² is estimated without bias by Σₖ λₖ² ĉₖ² - 2 λₖ (n ĉₖ² - q̂ₖ)/(n - 1), q̂ₖ = Σ wᵢ ψₖ(Xᵢ)² / Σ wᵢ; without a taper each term costs
//! (2 q̂ₖ - (n + 1) ĉₖ²)/(n - 1). The minimum is looked for among all numbers of terms up to 10 + 4√n, not at the first term that does not pay, which may come
//! too early. Or `"oracle"`: the number of least exact MISE for the known truth.
//!
//! # References
//! Čencov 1962, Soviet Mathematics 3; Kronmal & Tarter 1968, Journal of the American Statistical Association 63; Schwartz 1967, Annals of Mathematical Statistics 38
//! (Hermite); Rudemo 1982, Scandinavian Journal of Statistics 9; Diggle & Hall 1986, Journal of the American Statistical Association 81; Wahba 1981, Annals of
//! Statistics 9; Silverman 1986, section 2.7.

mod interval;
mod line;
mod plane;
mod terms;

pub use interval::{CosineSeries, FourierSeries, LegendreSeries};
pub use line::HermiteSeries;

use super::{Estimate, FitError};
use crate::numeric::orthogonal::{Basis, LANES, Placed};
use crate::sample::Sample;
use crate::space::{Domain, Evaluation, Field, Point, Targets, Warning};
use crate::theory::Taper;
use std::sync::Arc;
use terms::Terms;

/// How many terms, and how they end.
#[derive(Clone, Copy, Debug)]
struct Length {
    terms: Terms,
    taper: Taper,
}

impl Length {
    /// The number of terms, where it is the same for all samples.
    fn fixed(self) -> Option<usize> {
        match self.terms {
            Terms::Number(terms) => Some(terms),
            Terms::CrossValidation => None,
        }
    }
}

struct Fitted<B> {
    placed: Placed<B>,
    coefficients: Vec<f64>,
    terms: usize,
    /// Whether the sum is nowhere negative but for rounding.
    positive: bool,
    domain: Domain<1>,
}

impl<B: Basis> Fitted<B> {
    fn cleared(&self, value: f64) -> f64 {
        if self.positive && value < 0.0 {
            0.0
        } else {
            value
        }
    }
}

impl<B: Basis> Field<1> for Fitted<B> {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        self.cleared(self.placed.sum_at(&self.coefficients, x))
    }

    fn evaluate(&self, targets: Targets<'_, 1>) -> Evaluation {
        let places: Vec<f64> = targets.places().map(|[x]| x).collect();
        let mut values = self.placed.sum(&self.coefficients, &places);
        for value in &mut values {
            *value = self.cleared(*value);
        }
        Evaluation {
            values,
            // of some `terms` additions, relative to a value to which all terms contribute alike
            error: f64::EPSILON * (self.terms.max(LANES)) as f64,
            ..Evaluation::default()
        }
    }
}

/// The series of the total and of each channel, with the number of terms chosen from the total.
fn fit<B: Basis>(
    sample: &Sample<1>,
    placed: Placed<B>,
    length: Length,
    positive: bool,
    mut warnings: Vec<Warning>,
) -> Result<Estimate<1>, FitError> {
    let terms = match length.terms {
        Terms::Number(terms) => terms,
        Terms::CrossValidation => {
            let (terms, more) = terms::cross_validated(sample, &placed, length.taper)?;
            warnings.extend(more);
            terms
        }
    };
    let field = |sample: &Sample<1>| -> Arc<dyn Field<1>> {
        let mut coefficients = placed
            .project(sample.coordinates(), |i| sample.weight(i), terms, false)
            .sums;
        for (index, c) in coefficients.iter_mut().enumerate() {
            *c *= length.taper.weight(B::degree(index), terms);
        }
        Arc::new(Fitted {
            placed,
            coefficients,
            terms,
            positive,
            domain: sample.domain().clone(),
        })
    };
    let mut estimate = Estimate::new(field(sample)).with_channels(
        (0..sample.channels())
            .map(|c| field(&sample.channel(c)))
            .collect(),
    );
    estimate.smoothing = Some(terms as f64);
    estimate.warnings = warnings;
    Ok(estimate)
}
