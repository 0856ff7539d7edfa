//! Rules of thumb for the width of bins: the AMISE-optimal width if the density were normal.
//!
//! # References
//! Scott 1979, On optimal and data-based histograms; Freedman & Diaconis 1981, On the histogram as a density estimator; Scott 1985, Frequency
//! polygons: theory and application; Scott 1985, Averaged shifted histograms; Scott 1992, Multivariate Density Estimation, chapters 3-5.

use super::rules::{NormalReference, spread};
use super::spread::Spread;
use super::{SelectError, Selector};
use crate::kernel::{Bandwidth, Shape};
use crate::sample::{Sample, Summary};
use crate::space::Warning;
use std::f64::consts::PI;

/// A width for bins, with what the reader should know about how it came about.
#[derive(Clone, Debug)]
pub struct BinWidth {
    /// The width.
    pub width: f64,
    /// Fallbacks taken.
    pub warnings: Vec<Warning>,
}

/// A histogram's width for normal data: (24 √π)^(1/3) s n^(-1/3) ≈ 3.49 s n^(-1/3). [Scott 1979, eq. 3.1]
///
/// # Errors
/// If the data have no spread.
pub fn scott(sample: &Sample<1>) -> Result<BinWidth, SelectError> {
    let (spread, warnings) = spread(sample, false)?;
    let width = (24.0 * PI.sqrt()).cbrt() * spread / sample.effective_size().cbrt();
    Ok(BinWidth { width, warnings })
}

/// A histogram's width that does not mind outliers: 2 IQR n^(-1/3). [Freedman & Diaconis 1981] Where the quartiles coincide, [`scott`] with a warning.
///
/// # Errors
/// If the data have no spread.
pub fn freedman_diaconis(sample: &Sample<1>) -> Result<BinWidth, SelectError> {
    let range = Summary::of(sample).interquartile_range;
    if range > 0.0 {
        return Ok(BinWidth {
            width: 2.0 * range / sample.effective_size().cbrt(),
            warnings: Vec::new(),
        });
    }
    let mut chosen = scott(sample)?;
    chosen.warnings.push(Warning {
        what: "more than half of the data are tied, so the quartiles coincide; Scott's rule with the standard deviation is used instead".to_owned(),
        hint: "look at the data for rounding, or give the width as a number".to_owned(),
    });
    Ok(chosen)
}

/// The range over ⌈log₂ n⌉ + 1 bins: what a binomial distribution would need. [Sturges 1926] Far too wide for large n; known for its age.
///
/// # Errors
/// If the data have no spread.
pub fn sturges(sample: &Sample<1>) -> Result<BinWidth, SelectError> {
    let spread = Spread::of(sample)?;
    let bins = sample.effective_size().log2().ceil() + 1.0;
    Ok(BinWidth {
        width: (spread.most - spread.least) / bins,
        warnings: Vec::new(),
    })
}

/// A frequency polygon's width for normal data: 2 (15 / (49 R(φ″)))^(1/5) s n^(-1/5) ≈ 2.15 s n^(-1/5). [Scott 1992, eq. 4.11]
///
/// # Errors
/// If the data have no spread.
pub fn frequency_polygon(sample: &Sample<1>) -> Result<BinWidth, SelectError> {
    let (spread, warnings) = spread(sample, false)?;
    // R(φ″) of the standard normal
    let roughness = 3.0 / (8.0 * PI.sqrt());
    let width = 2.0 * (15.0 / (49.0 * roughness) / sample.effective_size()).powf(0.2) * spread;
    Ok(BinWidth { width, warnings })
}

/// An averaged shifted histogram's width for normal data: that of the triangular kernel, which it tends to, ≈ 2.576 s n^(-1/5). [Scott 1992, section 5.1.3]
///
/// # Errors
/// If the data have no spread.
pub fn shifted_histogram(sample: &Sample<1>) -> Result<BinWidth, SelectError> {
    let selection = NormalReference.select(sample, Shape::Triangular)?;
    let Bandwidth::Fixed([width]) = selection.bandwidth else {
        unreachable!("a rule of thumb gives one number");
    };
    Ok(BinWidth {
        width,
        warnings: selection.warnings,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Domain;

    fn sample(x: &[f64]) -> Sample<1> {
        Sample::equal(x.iter().map(|&x| [x]).collect(), Domain::whole()).expect("legal")
    }

    #[test]
    fn the_rules_have_their_textbook_factors() {
        let data = sample(&[1.0, 2.0, 4.0, 7.0, 7.5, 9.0, 11.0, 14.0]);
        let summary = Summary::of(&data);
        let n = 8.0_f64;
        let near = |chosen: Result<BinWidth, SelectError>, expected: f64, digits: f64| {
            let width = chosen.expect("spread").width;
            assert!(
                (width / expected - 1.0).abs() < digits,
                "{width} {expected}"
            );
        };
        // log₂ 8 + 1 bins over 13
        near(sturges(&data), 13.0 / 4.0, 1e-14);
        near(scott(&data), 3.49 * summary.deviation / n.cbrt(), 1e-3);
        near(
            freedman_diaconis(&data),
            2.0 * summary.interquartile_range / 2.0,
            1e-14,
        );
        near(
            frequency_polygon(&data),
            2.15 * summary.deviation / n.powf(0.2),
            2e-3,
        );
        // 1.06 in the rule stands for 1.0592
        near(
            shifted_histogram(&data),
            2.576 * summary.deviation / n.powf(0.2),
            2e-3,
        );
    }

    #[test]
    fn tied_quartiles_fall_back_with_a_warning_and_constant_data_are_refused() {
        let tied = sample(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 5.0]);
        let chosen = freedman_diaconis(&tied).expect("spread");
        assert_eq!(chosen.warnings.len(), 1);
        assert!((chosen.width - scott(&tied).expect("spread").width).abs() < 1e-15);
        for rule in [
            scott,
            sturges,
            freedman_diaconis,
            frequency_polygon,
            shifted_histogram,
        ] {
            assert!(matches!(
                rule(&sample(&[2.0; 5])),
                Err(SelectError::NoSpread { .. })
            ));
            assert!(matches!(
                rule(&sample(&[2.0])),
                Err(SelectError::NoSpread { .. })
            ));
        }
    }
}
