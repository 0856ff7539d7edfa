//! Rules of thumb: the AMISE-optimal width if the density were normal, with more or less robust measures of its spread.
//!
//! All are stated for the Gaussian kernel; for another kernel the width is rescaled by the ratio of canonical scales, so that the
//! estimate is equally smooth. \[Marron & Nolan 1988\]
//!
//! # References
//! Silverman 1986, section 3.4.2, eqs 3.28 and 3.31; Scott 1992, Multivariate Density Estimation, eq. 6.17 (with R's bw.nrd).

use super::spread::Spread;
use super::{Described, SelectError, Selection, Selector};
use crate::kernel::{Kernel, Shape};
use crate::sample::Sample;
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
        Self::NAME
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        rule(sample, shape, 0.9, true)
    }
}

impl Selector<1> for NormalReference {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        rule(sample, shape, 1.06, false)
    }
}

impl Selector<1> for Scott {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        rule(sample, shape, 1.06, true)
    }
}

impl Described for Silverman {
    const NAME: &'static str = "silverman";
    const SUMMARY: &'static str = "0.9 min(deviation, quartile range / 1.34) n^(-1/5)";
    const COST: &'static str = "O(n)";
    const REFERENCE: &'static str = "Silverman 1986, eq. 3.31; R's bw.nrd0";
}

impl Described for NormalReference {
    const NAME: &'static str = "normal-reference";
    const SUMMARY: &'static str = "1.06 deviation n^(-1/5)";
    const COST: &'static str = "O(n)";
    const REFERENCE: &'static str = "Silverman 1986, eq. 3.28";
}

impl Described for Scott {
    const NAME: &'static str = "scott";
    const SUMMARY: &'static str = "1.06 min(deviation, quartile range / 1.34) n^(-1/5)";
    const COST: &'static str = "O(n)";
    const REFERENCE: &'static str = "Scott 1992, section 6.5.1.2; R's bw.nrd";
}

fn rule(
    sample: &Sample<1>,
    shape: Shape,
    factor: f64,
    robust: bool,
) -> Result<Selection<1>, SelectError> {
    let (spread, warnings) = spread(sample, robust)?;
    let scale = shape.canonical_scale() / Shape::Gaussian.canonical_scale();
    let h = factor * spread * sample.effective_size().powf(-0.2) * scale;
    Ok(Selection::new(h, warnings))
}

/// The standard deviation, or if `robust` the lesser of it and IQR/1.34.
///
/// Where the quartiles coincide the standard deviation stands alone, as in R's bw.nrd0 (not bw.nrd, which gives 0), with a warning. Where that is zero too R
/// goes on to |x₁| and then to 1; we refuse, because no such number is a property of the data.
pub(super) fn spread(sample: &Sample<1>, robust: bool) -> Result<(f64, Vec<Warning>), SelectError> {
    let summary = Spread::of(sample)?;
    let quartile_spread = summary.interquartile_range / 1.34;
    if robust && quartile_spread > 0.0 {
        return Ok((summary.deviation.min(quartile_spread), Vec::new()));
    }
    let warnings = if robust {
        vec![Warning {
            what: "more than half of the data are tied, so the quartiles coincide; the standard deviation is used alone".to_owned(),
            hint: "look at the data for rounding, or give the bandwidth as a number".to_owned(),
        }]
    } else {
        Vec::new()
    };
    Ok((summary.deviation, warnings))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Bandwidth;
    use crate::sample::Summary;
    use crate::space::Domain;

    /// The number in a cell of a CSV file under `data/`.
    fn column(path: &str, name: &str) -> Vec<f64> {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("data")
            .join(path);
        let mut file = csv::Reader::from_path(path).expect("readable");
        let place = file
            .headers()
            .expect("a header")
            .iter()
            .position(|h| h == name)
            .expect(name);
        file.records()
            .map(|row| row.expect("a row")[place].parse().expect("a number"))
            .collect()
    }

    fn chosen(rule: &dyn Selector<1>, sample: &Sample<1>) -> f64 {
        match rule
            .select(sample, Shape::Gaussian)
            .expect("spread")
            .bandwidth
        {
            Bandwidth::Fixed([h]) => h,
            _ => unreachable!("a rule of thumb gives one number"),
        }
    }

    fn equal(x: &[f64]) -> Sample<1> {
        Sample::equal(x.iter().map(|&x| [x]).collect(), Domain::whole()).expect("legal")
    }

    /// bw.nrd0 and bw.nrd as R computes them, on every measured column.
    #[test]
    fn the_rules_are_those_of_r() {
        let path =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("data/reference/bandwidths.csv");
        let mut file = csv::Reader::from_path(path).expect("readable");
        let mut seen = 0;
        for row in file.records() {
            let row = row.expect("a row");
            let (set, name) = (&row[0], &row[1]);
            let expected = |i: usize| row[i].parse::<f64>().expect("a number");
            let sample = equal(&column(&format!("{set}/{set}.csv"), name));
            let summary = Summary::of(&sample);
            let pairs = [
                (sample.len() as f64, expected(2)),
                (summary.mean, expected(3)),
                (summary.deviation, expected(4)),
                (summary.quartiles[0], expected(5)),
                (summary.quartiles[2], expected(6)),
                (chosen(&Silverman, &sample), expected(7)),
                (chosen(&Scott, &sample), expected(8)),
                // Silverman's eq. 3.28 has no counterpart in R but is one product
                (
                    chosen(&NormalReference, &sample),
                    1.06 * expected(4) * expected(2).powf(-0.2),
                ),
            ];
            for (i, (got, wanted)) in pairs.into_iter().enumerate() {
                assert!(
                    (got / wanted - 1.0).abs() < 4e-15,
                    "{set} {name} number {i}: {got} {wanted}"
                );
            }
            seen += 1;
        }
        assert_eq!(seen, 9);
    }

    #[test]
    fn weights_count_through_the_effective_size() {
        let x = [1.0, 2.0, 4.0, 7.0];
        // doubling all weights is no new information
        let points = || x.iter().map(|&x| [x]).collect::<Vec<_>>();
        let twice = Sample::normalised(points(), vec![2.0; 4], Domain::whole()).expect("legal");
        for rule in [&Silverman as &dyn Selector<1>, &NormalReference, &Scott] {
            assert!((chosen(rule, &twice) / chosen(rule, &equal(&x)) - 1.0).abs() < 1e-14);
        }
        let uneven = Sample::normalised(points(), vec![3.0, 1.0, 1.0, 1.0], Domain::whole());
        let uneven = uneven.expect("legal");
        assert!((uneven.effective_size() - 3.0).abs() < 1e-14);
        let deviation = Summary::of(&uneven).deviation;
        let expected = 1.06 * deviation * 3.0_f64.powf(-0.2);
        assert!((chosen(&NormalReference, &uneven) / expected - 1.0).abs() < 1e-14);
        // Σw(x-μ)² / (1 - Σw²) with w = (3, 1, 1, 1)/6 and μ = 16/6
        let variance = (3.0 * (1.0 - 8.0 / 3.0_f64).powi(2)
            + (2.0 - 8.0 / 3.0_f64).powi(2)
            + (4.0 - 8.0 / 3.0_f64).powi(2)
            + (7.0 - 8.0 / 3.0_f64).powi(2))
            / 6.0
            / (1.0 - 12.0 / 36.0);
        assert!((deviation / variance.sqrt() - 1.0).abs() < 1e-14);
    }

    /// R: bw.nrd0(c(1, 1, 1, 1, 1, 1, 5)) = 0.9 sd n^(-1/5) where the quartiles coincide; no spread at all is refused.
    #[test]
    fn ties_fall_back_to_the_deviation_and_constants_are_refused() {
        let tied = equal(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 5.0]);
        let selection = Silverman.select(&tied, Shape::Gaussian).expect("spread");
        assert_eq!(selection.warnings.len(), 1);
        let deviation = (16.0 / 7.0_f64).sqrt();
        let expected = 0.9 * deviation * 7.0_f64.powf(-0.2);
        assert!((chosen(&Silverman, &tied) / expected - 1.0).abs() < 1e-14);
        for x in [vec![3.0], vec![3.0; 5], vec![1e9 / 3.0; 5], vec![0.0; 2]] {
            for rule in [&Silverman as &dyn Selector<1>, &NormalReference, &Scott] {
                let refused = rule.select(&equal(&x), Shape::Gaussian);
                assert!(
                    matches!(refused, Err(SelectError::NoSpread { .. })),
                    "{x:?}"
                );
            }
        }
    }

    #[test]
    fn other_kernels_get_equally_smooth_widths() {
        let sample = equal(&[1.0, 2.0, 4.0, 7.0]);
        let Bandwidth::Fixed([h]) = Silverman
            .select(&sample, Shape::Epanechnikov)
            .expect("spread")
            .bandwidth
        else {
            unreachable!("a rule of thumb gives one number")
        };
        // δ₀ of Epanechnikov 15^(1/5), of the Gaussian (1/4π)^(1/10): their ratio is 2.2138 [Marron & Nolan 1988]
        assert!((h / chosen(&Silverman, &sample) - 2.2138).abs() < 1e-3);
    }
}
