//! Widths of bins that are searched for: the number of equal bins over the range of the data that is most probable, or of least estimated error.

use super::SelectError;
use super::bin_width::BinWidth;
use super::spread::Spread;
use crate::sample::{Sample, Weights};
use crate::space::Warning;
use crate::space::binning::{Mesh, count, weigh};
use libm::lgamma;

/// The most probable number of equal bins. [Knuth 2006, Optimal data-based binning for histograms, eq. 31]
///
/// Bins start at the least datum, as in the paper; the width is used with whatever origin the histogram has.
///
/// # Errors
/// If the data have no spread.
pub fn knuth(sample: &Sample<1>) -> Result<BinWidth, SelectError> {
    best(sample, "the posterior of Knuth", |n, bins, shares| {
        let m = bins as f64;
        let cells: f64 = shares.iter().map(|p| lgamma(n * p + 0.5)).sum();
        n * m.ln() + lgamma(0.5 * m) - m * lgamma(0.5) - lgamma(n + 0.5 * m) + cells
    })
}

/// The least unbiased estimate of the integrated squared error: 2/((n - 1)w) - (n + 1)/((n - 1)w) Σ p². [Rudemo 1982, eq. 2.8; Stone 1984]
///
/// # Errors
/// If the data have no spread.
pub fn stone(sample: &Sample<1>) -> Result<BinWidth, SelectError> {
    best(
        sample,
        "the cross-validation of Stone",
        |n, bins, shares| {
            let squares: f64 = shares.iter().map(|p| p * p).sum();
            ((n + 1.0) * squares - 2.0) * bins as f64 / (n - 1.0)
        },
    )
}

/// Every number of bins up to this is tried; beyond, steps of a thirtieth.
const EVERY: usize = 60;

/// The width of the number of bins with the largest `score` of (n, bins, shares of the data in each).
///
/// Up to max(100, 3 times the bins of the Freedman-Diaconis rule, at most 10 000) bins are tried; a maximum at the end is told. O(n log bins).
fn best(
    sample: &Sample<1>,
    what: &str,
    score: impl Fn(f64, usize, &[f64]) -> f64,
) -> Result<BinWidth, SelectError> {
    let spread = Spread::of(sample)?;
    let (n, range) = (sample.effective_size(), spread.most - spread.least);
    let most = if spread.interquartile_range > 0.0 {
        1.5 * range / spread.interquartile_range * n.cbrt()
    } else {
        n.sqrt()
    };
    let most = most.clamp(100.0, 10_000.0) as usize;
    let at = |bins: usize| score(n, bins, &shares(sample, &spread, bins));
    let ladder: Vec<usize> = std::iter::successors(Some(1), |&m| {
        let next = if m < EVERY { m + 1 } else { m + m / 30 };
        (next <= most).then_some(next)
    })
    .collect();
    let scores: Vec<f64> = ladder.iter().map(|&m| at(m)).collect();
    let top = (0..ladder.len())
        .max_by(|&a, &b| scores[a].total_cmp(&scores[b]))
        .unwrap_or(0);
    // the numbers that the ladder left out around its best
    let low = ladder[top.saturating_sub(1)];
    let high = ladder[(top + 1).min(ladder.len() - 1)];
    let (bins, _) =
        (low..=high)
            .map(|m| (m, at(m)))
            .fold((ladder[top], scores[top]), |best, next| {
                if next.1 > best.1 { next } else { best }
            });
    let mut warnings = Vec::new();
    if top + 1 == ladder.len() || bins == 1 {
        warnings.push(Warning {
            what: format!("{what} is best at {bins} bins, an end of the numbers tried"),
            hint: "ties and outliers do this: compare with freedman-diaconis".to_owned(),
        });
    }
    Ok(BinWidth {
        width: range / bins as f64,
        warnings,
    })
}

/// The share of the data in each of `bins` equal bins over their range, the largest datum in the last.
fn shares(sample: &Sample<1>, spread: &Spread, bins: usize) -> Vec<f64> {
    let mesh = Mesh {
        origin: spread.least,
        width: (spread.most - spread.least) / bins as f64,
        first: 0.0,
        count: bins,
    };
    let (mut shares, above): (Vec<f64>, f64) = match sample.weights() {
        Weights::Equal(_) => {
            let counts = count(sample.coordinates(), mesh);
            let inside = counts.inside.iter().map(|&c| c as f64).collect();
            (inside, counts.above as f64)
        }
        Weights::Each(weights) => {
            let masses = weigh(sample.coordinates(), weights, mesh);
            (masses.inside, masses.above)
        }
    };
    // an end of the range that rounding puts beyond the last edge
    shares[bins - 1] += above;
    let total: f64 = shares.iter().sum();
    shares.iter().map(|c| c / total).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Domain;

    fn sample(x: &[f64]) -> Sample<1> {
        Sample::equal(x.iter().map(|&x| [x]).collect(), Domain::whole()).expect("legal")
    }

    #[test]
    fn scores_are_those_of_the_papers() {
        // by hand: 8 data, every number of bins up to 100
        let x = [0.0, 0.5, 1.1, 1.2, 1.3, 1.9, 3.5, 4.0];
        let n = 8.0;
        let by_hand = |m: usize| {
            let mut counts = vec![0.0; m];
            for x in x {
                counts[((x / 4.0 * m as f64) as usize).min(m - 1)] += 1.0;
            }
            counts
        };
        let argmax = |score: &dyn Fn(usize) -> f64| {
            (1..=100).fold(1, |best, m| if score(m) > score(best) { m } else { best })
        };
        let posterior = |m: usize| {
            n * (m as f64).ln() + lgamma(m as f64 / 2.0)
                - m as f64 * lgamma(0.5)
                - lgamma(n + m as f64 / 2.0)
                + by_hand(m).iter().map(|c| lgamma(c + 0.5)).sum::<f64>()
        };
        let error = |m: usize| {
            let h = 4.0 / m as f64;
            let squares: f64 = by_hand(m).iter().map(|c| (c / n).powi(2)).sum();
            -(2.0 / ((n - 1.0) * h) - (n + 1.0) / ((n - 1.0) * h) * squares)
        };
        let bins = |width: f64| (4.0 / width).round() as usize;
        assert_eq!(
            bins(knuth(&sample(&x)).expect("spread").width),
            argmax(&posterior)
        );
        assert_eq!(
            bins(stone(&sample(&x)).expect("spread").width),
            argmax(&error)
        );
    }

    #[test]
    fn large_samples_get_widths_near_the_best_for_the_normal() {
        // quantiles of the normal density: the ISE-optimal histogram is about 3.49 n^(-1/3) wide
        let n = 20_000;
        let x: Vec<f64> = (0..n)
            .map(|i| {
                let p = ((f64::from(i) * 0.618_033_988_749_895).fract() * 0.999_98) + 1e-5;
                crate::numeric::special::normal_quantile(p)
            })
            .collect();
        for rule in [knuth, stone] {
            let chosen = rule(&sample(&x)).expect("spread");
            let best = 3.49 * f64::from(n).powf(-1.0 / 3.0);
            assert!(
                (0.4..2.5).contains(&(chosen.width / best)),
                "{chosen:?} {best}"
            );
        }
    }

    #[test]
    fn constant_data_are_refused() {
        for rule in [knuth, stone] {
            assert!(matches!(
                rule(&sample(&[2.0; 5])),
                Err(SelectError::NoSpread { .. })
            ));
        }
    }
}
