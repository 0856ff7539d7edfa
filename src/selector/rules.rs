//! Rules of thumb: the AMISE-optimal width if the density were normal, with more or less robust measures of its spread.
//!
//! All are stated for the Gaussian kernel; for another kernel the width is rescaled by the ratio of canonical scales, so that the
//! estimate is equally smooth. \[Marron & Nolan 1988\]
//!
//! # References
//! Silverman 1986, section 3.4.2, eqs 3.28 and 3.31; Scott 1992, Multivariate Density Estimation, eq. 6.17 (with R's bw.nrd).

use super::{SelectError, Selection, Selector};
use crate::kernel::{Bandwidth, Kernel, Shape};
use crate::sample::{Sample, Summary};
use crate::space::Warning;

/// h = 0.9 min(s, IQR/1.34) n^(-1/5). [Silverman 1986, eq. 3.31]; R's `bw.nrd0`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silverman;

/// h = 1.06 s n^(-1/5). [Silverman 1986, eq. 3.28]
#[derive(Clone, Copy, Debug, Default)]
pub struct NormalReference;

/// h = 1.06 min(s, IQR/1.34) n^(-1/5). [Scott 1992, section 6.5.1.2]; R's `bw.nrd`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scott;

impl Selector<1> for Silverman {
    fn name(&self) -> &'static str {
        "silverman"
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        rule(sample, shape, 0.9, true)
    }
}

impl Selector<1> for NormalReference {
    fn name(&self) -> &'static str {
        "normal-reference"
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        rule(sample, shape, 1.06, false)
    }
}

impl Selector<1> for Scott {
    fn name(&self) -> &'static str {
        "scott"
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        rule(sample, shape, 1.06, true)
    }
}

fn rule(
    sample: &Sample<1>,
    shape: Shape,
    factor: f64,
    robust: bool,
) -> Result<Selection<1>, SelectError> {
    let summary = Summary::of(sample);
    let mut warnings = Vec::new();
    let quartile_spread = summary.interquartile_range() / 1.34;
    let spread = if robust && quartile_spread > 0.0 {
        summary.deviation.min(quartile_spread)
    } else {
        if robust {
            warnings.push(Warning {
                what: "more than half of the data are tied, so the quartiles coincide; the standard deviation is used alone".to_owned(),
                hint: "look at the data for rounding, or give the bandwidth as a number".to_owned(),
            });
        }
        summary.deviation
    };
    // a spread below the resolution of the numbers themselves is no spread
    if spread <= 4.0 * f64::EPSILON * summary.least.abs().max(summary.most.abs()) {
        return Err(SelectError::NoSpread {
            points: sample.len(),
            place: summary.mean,
        });
    }
    let scale = shape.canonical_scale() / Shape::Gaussian.canonical_scale();
    let h = factor * spread * sample.effective_size().powf(-0.2) * scale;
    Ok(Selection {
        bandwidth: Bandwidth::Fixed([h]),
        warnings,
    })
}
