//! Least-squares cross-validation: the bandwidth of the least unbiased estimate of the integrated squared error.

use super::functionals::{Functionals, canonical, fall_back};
use super::search::{least, search};
use super::spread::Spread;
use super::{Criterion, Described, SelectError, Selection, Selector};
use crate::engine::CompactPairs;
use crate::kernel::{Kernel, Shape};
use crate::sample::Sample;
use crate::space::Warning;
use std::f64::consts::{PI, SQRT_2};

/// The h of least ∫f̂² - 2 Σᵢ wᵢ f̂₋ᵢ(Xᵢ), which estimates ISE - ∫f² without bias. [Rudemo 1982; Bowman 1984; Silverman 1986, eq. 3.35]
///
/// For the kernel itself, whatever it is, with n (n - 1) pairs left out of one another: Σ_{i≠j} wᵢwⱼ K / Σ_{i≠j} wᵢwⱼ for weights. All local minima between 1.5 times the
/// oversmoothed bandwidth and a tenth of the best are found, and the lowest is taken. Its relative error falls like n^(-1/10) only.
#[derive(Clone, Copy, Debug, Default)]
pub struct LeastSquares;

/// R's `bw.ucv` without its bins: the same criterion for the Gaussian kernel with n² instead of n (n - 1), made least between a tenth of
/// 1.144 s n^(-1/5) and that. [Scott & Terrell 1987, eq. 3.8; Venables & Ripley 2002, section 5.6]
#[derive(Clone, Copy, Debug, Default)]
pub struct Unbiased;

/// (1/h) Σᵢⱼ wᵢwⱼ (K∗K)(d/h) - 2/(c h) Σ_{i≠j} wᵢwⱼ K(d/h) for the Gaussian, in units of the deviation; c is the share of pairs i ≠ j.
fn gaussian(sum: impl Fn(usize, f64) -> f64, squares: f64, share: f64, h: f64) -> f64 {
    let peak = squares / (2.0 * PI).sqrt();
    (sum(0, SQRT_2 * h) / SQRT_2 - 2.0 / share * (sum(0, h) - peak)) / h
}

/// The criterion of a sample for one kernel. `unit` is that of its argument.
enum Exact {
    Gaussian(Box<Functionals>),
    Compact {
        pairs: CompactPairs,
        shape: Shape,
        unit: f64,
        n: f64,
    },
}

impl Exact {
    fn new(sample: &Sample<1>, shape: Shape) -> Result<Self, SelectError> {
        Ok(match CompactPairs::new(sample, shape) {
            None => Self::Gaussian(Box::new(Functionals::new(sample)?)),
            Some(pairs) => Self::Compact {
                pairs,
                shape,
                unit: Spread::of(sample)?.deviation,
                n: sample.effective_size(),
            },
        })
    }

    fn unit(&self) -> f64 {
        match self {
            Self::Gaussian(functionals) => functionals.unit,
            Self::Compact { unit, .. } => *unit,
        }
    }

    fn n(&self) -> f64 {
        match self {
            Self::Gaussian(functionals) => functionals.n,
            Self::Compact { n, .. } => *n,
        }
    }

    /// The criterion times the unit, at h units.
    fn at(&self, h: f64) -> f64 {
        let n = self.n();
        match self {
            Self::Gaussian(functionals) => {
                let sum = |order, g| functionals.sum(order, g);
                gaussian(sum, 1.0 / n, 1.0 - 1.0 / n, h)
            }
            Self::Compact {
                pairs, shape, unit, ..
            } => {
                let factor = -2.0 / (1.0 - 1.0 / n);
                // what i = j adds to the second sum is taken out again
                (pairs.sum(h * unit, factor) - factor * shape.peak() / n) / h
            }
        }
    }

    fn glance(&self, h: f64) -> f64 {
        match self {
            Self::Gaussian(functionals) => {
                let n = functionals.n;
                let sum = |order, g| functionals.glance(order, g);
                gaussian(sum, 1.0 / n, 1.0 - 1.0 / n, h)
            }
            Self::Compact { .. } => self.at(h),
        }
    }
}

impl Selector<1> for LeastSquares {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        let exact = Exact::new(sample, shape)?;
        let widest = 1.5 * 1.144 * exact.n().powf(-0.2) * canonical(shape);
        // one pass over the data serves a search that ends at a tenth of the widths that large samples ask for
        if let Exact::Gaussian(functionals) = &exact {
            functionals.expect(0.03 * widest);
        }
        let found = search(|h| exact.glance(h), |h| exact.at(h), 1e-4 * widest, widest)
            .in_units_of(exact.unit());
        match found.choose("least-squares cross-validation") {
            Some((h, warnings)) => Ok(Selection::new(h, warnings)),
            None => fall_back(
                sample,
                shape,
                "least-squares cross-validation has no minimum but towards bandwidth 0 or infinity",
            ),
        }
    }

    fn criterion(
        &self,
        sample: &Sample<1>,
        shape: Shape,
    ) -> Result<Option<Criterion>, SelectError> {
        let exact = Exact::new(sample, shape)?;
        let unit = exact.unit();
        Ok(Some(Box::new(move |h| exact.at(h / unit) / unit)))
    }
}

impl Unbiased {
    /// R's criterion, in units of the deviation.
    fn at(functionals: &Functionals, h: f64) -> f64 {
        let sum = |order, g| functionals.sum(order, g);
        gaussian(sum, 1.0 / functionals.n, 1.0, h)
    }

    fn glance(functionals: &Functionals, h: f64) -> f64 {
        let sum = |order, g| functionals.glance(order, g);
        gaussian(sum, 1.0 / functionals.n, 1.0, h)
    }
}

impl Selector<1> for Unbiased {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        let functionals = Functionals::new(sample)?;
        let widest = functionals.oversmoothed();
        let (h, at_end) = least(
            |h| Self::glance(&functionals, h),
            |h| Self::at(&functionals, h),
            0.1 * widest,
            widest,
        );
        let h = h * functionals.unit * canonical(shape);
        Ok(Selection::new(h, ends(at_end, "unbiased cross-validation")))
    }

    fn criterion(
        &self,
        sample: &Sample<1>,
        shape: Shape,
    ) -> Result<Option<Criterion>, SelectError> {
        let functionals = Functionals::new(sample)?;
        let unit = functionals.unit;
        Ok(Some(Box::new(move |h| {
            Self::at(&functionals, h / unit / canonical(shape)) / unit
        })))
    }
}

/// The warning that R gives too.
pub(super) fn ends(at_end: bool, what: &str) -> Vec<Warning> {
    if !at_end {
        return Vec::new();
    }
    vec![Warning {
        what: format!(
            "{what} is least at an end of the interval from 0.11 to 1.144 s n^(-1/5) in which it is looked for"
        ),
        hint: "the criterion does not determine a bandwidth here: compare with sheather-jones"
            .to_owned(),
    }]
}

impl Described for LeastSquares {
    const NAME: &'static str = "lscv";
    const SUMMARY: &'static str = "least-squares cross-validation with the kernel itself: the least unbiased estimate of MISE";
    const COST: &'static str = "O(n); O(n log n), then O(n) a bandwidth, for compact kernels";
    const REFERENCE: &'static str = "Rudemo 1982; Bowman 1984; Silverman 1986, eq. 3.35";
}

impl Described for Unbiased {
    const NAME: &'static str = "ucv";
    const SUMMARY: &'static str = "least-squares cross-validation as R has it: Gaussian, n squared pairs, within 0.11 to 1.144 s n^(-1/5)";
    const COST: &'static str = "O(n)";
    const REFERENCE: &'static str = "Scott & Terrell 1987, eq. 3.8; R's bw.ucv, unbinned";
}
