//! The number of terms: given, chosen from the data, or the best for a known truth.

use super::Length;
use crate::density::Univariate;
use crate::estimator::{BuildError, FitError};
use crate::numeric::Sum;
use crate::numeric::orthogonal::{Basis, Placed};
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::Warning;
use crate::theory::{SeriesError, Taper};

/// The most terms that can be asked for, and that are looked at when they are chosen.
const MOST: usize = 1000;

/// The most terms among which an oracle looks: finding their errors costs their square.
const MOST_OF_ORACLE: usize = 300;

/// How many terms.
#[derive(Clone, Copy, Debug)]
pub(super) enum Terms {
    /// This many.
    Number(usize),
    /// As many as the unbiased estimate of the risk asks for.
    CrossValidation,
}

/// The number of terms as a parameter.
pub(super) const TERMS: Parameter = Parameter::optional(
    "terms",
    Kind::CountOr {
        least: 1,
        most: MOST as u64,
        words: &["cross-validation", "oracle"],
    },
    Absent::Word("cross-validation"),
    "how many terms, the constant or lowest included; a sine and a cosine of one frequency are one",
)
.swept();

/// The taper as a parameter.
pub(super) const TAPER: Parameter = Parameter::optional(
    "taper",
    Kind::Choice(&Taper::NAMES),
    Absent::Word("none"),
    "how the terms fade towards the last; fejer keeps cosine and Fourier series from being negative",
);

impl Length {
    /// What the file says; `line` is the truth and `place` says where the functions are, for an oracle.
    pub(super) fn given<B: Basis>(
        values: &Values,
        line: Option<&dyn Univariate>,
        draws: usize,
        place: impl Fn(&dyn Univariate) -> Result<Placed<B>, BuildError>,
    ) -> Result<Self, BuildError> {
        let taper = values
            .word("taper")
            .and_then(Taper::named)
            .unwrap_or(Taper::None);
        let terms = match (values.count("terms"), values.word("terms")) {
            (Some(terms), _) => Terms::Number(terms as usize),
            (None, Some("oracle")) => {
                let error = |what: String| BuildError {
                    parameter: "terms",
                    what,
                };
                let Some(truth) = line else {
                    return Err(error("\"oracle\" is the best number for a known density on a line, which is not given here; give a number or \"cross-validation\"".to_owned()));
                };
                let errors = SeriesError::new(truth, place(truth)?, MOST_OF_ORACLE);
                let (terms, _) = errors.optimum(taper, draws as f64);
                if terms == MOST_OF_ORACLE {
                    return Err(error(format!(
                        "\"oracle\": the error keeps falling up to {MOST_OF_ORACLE} terms, the most that are looked at; give a number"
                    )));
                }
                Terms::Number(terms)
            }
            _ => Terms::CrossValidation,
        };
        Ok(Self { terms, taper })
    }
}

/// The number of terms of least estimated risk. O(n · terms), and with a taper the square of terms.
pub(super) fn cross_validated<B: Basis>(
    sample: &Sample<1>,
    placed: &Placed<B>,
    taper: Taper,
) -> Result<(usize, Vec<Warning>), FitError> {
    let n = sample.effective_size();
    let most = ((10.0 + 4.0 * n.sqrt()) as usize).min(MOST);
    let found = placed.project(sample.coordinates(), |i| sample.weight(i), most, true);
    let mass = sample.mass();
    let row = |index: usize, terms: usize| {
        let weight = taper.weight(B::degree(index), terms);
        (
            weight,
            found.sums[index] / mass,
            found.squares[index] / mass,
        )
    };
    // without a taper the terms cost each for itself; with one, each number of terms changes all
    let mut costs = vec![0.0; most + 1];
    if taper == Taper::None {
        let mut total = Sum::default();
        let mut index = 0;
        for (terms, cost) in costs.iter_mut().enumerate().skip(1) {
            while index < B::functions(terms) {
                total.add(risk(std::iter::once(row(index, terms)), n));
                index += 1;
            }
            *cost = total.value();
        }
    }
    chosen(n, most, |terms| match taper {
        Taper::None => costs[terms],
        _ => risk((0..B::functions(terms)).map(|index| row(index, terms)), n),
    })
}

/// The number of terms up to `most` of least `risk`, the fewest where several are equal, with a warning if that is the last.
pub(super) fn chosen(
    n: f64,
    most: usize,
    risk: impl Fn(usize) -> f64,
) -> Result<(usize, Vec<Warning>), FitError> {
    // what one heavy point says cannot be checked against another
    if n <= 1.0 + 1e-9 {
        return Err(FitError::Degenerate(
            "cross-validation needs at least two points with weight; give the number of terms"
                .to_owned(),
        ));
    }
    let mut best = (1, f64::INFINITY);
    for terms in 1..=most {
        let total = risk(terms);
        if total < best.1 {
            best = (terms, total);
        }
    }
    let warnings = if best.0 == most {
        vec![Warning {
            what: format!("cross-validation asks for more terms than the {most} that it looks at"),
            hint: "look at the data for ties and rounding, or give the number of terms".to_owned(),
        }]
    } else {
        Vec::new()
    };
    Ok((best.0, warnings))
}

/// The unbiased estimate of MISE - ∫f² from the factor λ and the pair ĉ, q̂ of each function, and the effective size n.
pub(super) fn risk(rows: impl Iterator<Item = (f64, f64, f64)>, n: f64) -> f64 {
    rows.map(|(weight, c, q)| weight * weight * c * c - 2.0 * weight * (n * c * c - q) / (n - 1.0))
        .collect::<Sum>()
        .value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::orthogonal::{Cosine, Fourier};
    use crate::space::Domain;

    fn sample() -> Sample<1> {
        let points = (0..40)
            .map(|i| [(f64::from(i) * 0.618).fract().powi(2)])
            .collect();
        Sample::equal(points, Domain::unit()).expect("legal")
    }

    /// ∫f̂² - 2 Σᵢ f̂₋ᵢ(Xᵢ)/n, each datum left out in turn, as written.
    fn by_definition<B: Basis>(x: &[f64], placed: &Placed<B>, taper: Taper, terms: usize) -> f64 {
        let n = x.len() as f64;
        let rows: Vec<Vec<f64>> = x.iter().map(|&x| placed.at(x, terms)).collect();
        let factor = |k: usize| taper.weight(B::degree(k), terms);
        let mut total = 0.0;
        for k in 0..B::functions(terms) {
            let sum: f64 = rows.iter().map(|row| row[k]).sum();
            total += (factor(k) * sum / n).powi(2);
            for row in &rows {
                total -= 2.0 / n * factor(k) * row[k] * (sum - row[k]) / (n - 1.0);
            }
        }
        total
    }

    #[test]
    fn the_risk_is_that_of_leaving_each_datum_out() {
        fn check<B: Basis>() {
            let sample = sample();
            let placed = Placed::<B>::between(0.0, 1.0);
            for taper in [Taper::None, Taper::Fejer, Taper::Wahba] {
                let risks: Vec<f64> = (1..=35)
                    .map(|terms| by_definition(sample.coordinates(), &placed, taper, terms))
                    .collect();
                let found = placed.project(sample.coordinates(), |i| sample.weight(i), 35, true);
                for (i, expected) in risks.iter().enumerate() {
                    let rows = (0..B::functions(i + 1)).map(|k| {
                        let weight = taper.weight(B::degree(k), i + 1);
                        (weight, found.sums[k], found.squares[k])
                    });
                    let got = risk(rows, 40.0);
                    assert!(
                        (got - expected).abs() < 1e-11,
                        "{taper:?} {i}: {got} {expected}"
                    );
                }
                // 10 + 4√40 = 35 are looked at
                let (best, _) = cross_validated(&sample, &placed, taper).expect("two points");
                let least = risks.iter().copied().fold(f64::INFINITY, f64::min);
                assert!((risks[best - 1] - least).abs() < 1e-11, "{taper:?}");
                assert!(best > 1, "the data are not flat");
            }
        }
        check::<Cosine>();
        check::<Fourier>();
    }

    #[test]
    fn ties_are_warned_about_and_one_heavy_point_is_refused() {
        let tied = Sample::equal(vec![[0.3]; 50], Domain::unit()).expect("legal");
        let placed = Placed::<Cosine>::between(0.0, 1.0);
        let (terms, warnings) = cross_validated(&tied, &placed, Taper::None).expect("fifty points");
        assert_eq!((terms, warnings.len()), (38, 1));
        let one = Sample::equal(vec![[0.3]], Domain::unit()).expect("legal");
        assert!(cross_validated(&one, &placed, Taper::None).is_err());
    }
}
