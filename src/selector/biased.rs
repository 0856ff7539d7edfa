//! Biased cross-validation: the bandwidth of least AMISE, with R(f″) estimated by the very estimate whose bandwidth is sought.

use super::functionals::{Functionals, canonical};
use super::least_squares::ends;
use super::search::least;
use super::{Criterion, Described, SelectError, Selection, Selector};
use crate::kernel::Shape;
use crate::sample::Sample;
use std::f64::consts::{PI, SQRT_2};

/// The h of least R(K)/(nh) + h⁴/4 · (R(f̂″) - R(K″)/(nh⁵)), the AMISE with its unknown estimated, the diagonal left out; for the Gaussian kernel, between a tenth of 1.144 s n^(-1/5) and
/// that. [Scott & Terrell 1987, eq. 3.13]; R's `bw.bcv` without its bins. Beyond the interval the criterion falls to 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct Biased;

impl Biased {
    /// The criterion in units of the deviation.
    fn at(functionals: &Functionals, h: f64) -> f64 {
        Self::of(functionals, functionals.sum(4, SQRT_2 * h), h)
    }

    fn glance(functionals: &Functionals, h: f64) -> f64 {
        Self::of(functionals, functionals.glance(4, SQRT_2 * h), h)
    }

    fn of(functionals: &Functionals, sum: f64, h: f64) -> f64 {
        let diagonal = 3.0 / (2.0 * PI).sqrt() / functionals.n;
        let pairs = (sum - diagonal) / SQRT_2.powi(5);
        (functionals.roughness() + 0.25 * pairs) / h
    }
}

impl Selector<1> for Biased {
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
        Ok(Selection::new(h, ends(at_end, "biased cross-validation")))
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

impl Described for Biased {
    const NAME: &'static str = "bcv";
    const SUMMARY: &'static str = "biased cross-validation: the least AMISE with R(f'') of the estimate itself, within 0.11 to 1.144 s n^(-1/5)";
    const COST: &'static str = "O(n)";
    const REFERENCE: &'static str = "Scott & Terrell 1987, eq. 3.13; R's bw.bcv, unbinned";
}
