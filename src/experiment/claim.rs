//! What a run must show.

use super::uncertainty::Quantity;
use super::{Measure, significant};
use serde::Serialize;
use std::fmt;

/// A statement that the run checks; a statement that is not shown makes the run fail.
///
/// In files: `[[claim]]` with an optional `says` and exactly one key that names the measure (or `oracle`), for instance
/// `mise = { of = "h = 0.3", below = "h = 0.1", by = 2.0, confidence = 0.99 }`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    /// The claim in words, as the file says it, or made from the statement.
    pub says: String,
    /// Which sample size it is about; `None`: each of the experiment's sizes.
    pub draws: Option<usize>,
    /// Which source it is about; `None`: each of the experiment's sources.
    pub source: Option<String>,
    /// Which region it is about; `None`: the whole grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub region: Option<String>,
    /// What must hold.
    pub statement: Statement,
    /// The line of the file, for messages.
    pub line: usize,
}

/// Where a number is taken that another is compared with, if not from the same samples.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Elsewhere {
    /// The source, if another.
    pub source: Option<String>,
    /// The sample size, if another.
    pub draws: Option<usize>,
}

impl Elsewhere {
    /// Whether it is the same place.
    pub fn is_here(&self) -> bool {
        *self == Self::default()
    }
}

/// As the end of a sentence; nothing for the same place.
impl fmt::Display for Elsewhere {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(source) = &self.source {
            write!(f, " on {source}")?;
        }
        match self.draws {
            Some(draws) => write!(f, " at n = {draws}"),
            None => Ok(()),
        }
    }
}

/// What must hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Statement {
    /// `MEASURE = { of = A, below = B, by = FACTOR, confidence = C }`: A's mean times the factor is below B's, one-sided and paired
    /// over replicates, at the confidence; B's from another source or sample size with `other-source` and `other-draws`. For exact measures a plain comparison.
    Below {
        /// What is compared.
        measure: Measure,
        /// The estimator that is better.
        of: String,
        /// The estimator that is worse.
        below: String,
        /// Where it is worse.
        #[serde(skip_serializing_if = "Elsewhere::is_here")]
        other: Elsewhere,
        /// At least by this factor; 1 if not given.
        by: f64,
        /// Confidence of the paired one-sided interval; 0.99 if not given.
        confidence: f64,
    },
    /// `MEASURE = { of = A, [over = B | "minimum"], equals = V, (within = REL | margin = ABS), [confidence = C] }`: an equivalence. For a simulated measure
    /// the whole confidence interval must lie inside the margins; an exact one must itself. `over` divides by another estimator's value, or by the
    /// least MISE that any bandwidth gives with the same kernel and truth (`minimum`, exact-mise only); that value from another source or sample size with
    /// `other-source` and `other-draws`, and of the same estimator where `over` is not given.
    Equals {
        /// What is compared.
        measure: Measure,
        /// The estimator.
        of: String,
        /// What to divide by.
        over: Option<String>,
        /// Where the value is taken that is divided by.
        #[serde(skip_serializing_if = "Elsewhere::is_here")]
        other: Elsewhere,
        /// The expected value.
        equals: f64,
        /// The margin, absolute.
        margin: f64,
        /// Confidence of the interval; 0.99 if not given.
        confidence: f64,
    },
    /// `MEASURE = { [of = [A, ..]], agrees-with = "exact", [confidence = C] }`: the exact value lies inside the simulated interval for all of them at once
    /// (Šidák over the family). For mise, bias2 and variance.
    AgreesWithExact {
        /// What is compared.
        measure: Measure,
        /// The estimators; all if empty.
        of: Vec<String>,
        /// Simultaneous confidence; 0.99 if not given.
        confidence: f64,
    },
    /// `modes = { of = A, median = M, [confidence = C] }`: the median number of modes is M, and no other number lies inside its confidence interval.
    MedianModes {
        /// The estimator.
        of: String,
        /// The expected median.
        median: u64,
        /// Confidence of the interval; 0.99 if not given.
        confidence: f64,
    },
    /// `modes = { of = A, count = K, share = P, margin = E, [confidence = C] }`: the whole confidence interval for the share of samples with K modes lies
    /// within E of P.
    ShareOfModes {
        /// The estimator.
        of: String,
        /// How many modes.
        count: usize,
        /// The expected share.
        share: f64,
        /// The margin, absolute.
        margin: f64,
        /// Confidence of the interval; 0.99 if not given.
        confidence: f64,
    },
    /// `regret = { of = A, over = B, median = V, margin = ABS, [below = C], [confidence = P] }`: the interval of the median, over the replicates, of the ISE of A over that of B on the same
    /// sample lies within the margin of V, and that of A over C lies below 1.
    Regret {
        /// The estimator.
        of: String,
        /// What to divide by, sample by sample: commonly the best that there is for each.
        over: String,
        /// The expected median.
        median: f64,
        /// The margin, absolute.
        margin: f64,
        /// An estimator that is worse on more than half of the samples.
        below: Option<String>,
        /// Confidence of the intervals; 0.99 if not given.
        confidence: f64,
    },
    /// `uncertainty = { of = A, by = U, quantity = Q, [equals = V, margin = ABS], [above = B], [confidence = C] }`: the interval of what an estimate of the error gives lies within the margin,
    /// or above the bound.
    Uncertainty {
        /// The estimator.
        of: String,
        /// The estimate of its error.
        by: String,
        /// What is asked of it.
        quantity: Quantity,
        /// The expected value and the margin, absolute.
        equals: Option<(f64, f64)>,
        /// A lower bound.
        above: Option<f64>,
        /// Confidence of the interval; 0.99 if not given.
        confidence: f64,
    },
    /// `slope = { of = A, [measure = M], (equals = V | agrees-with = "exact"), margin = ABS, [confidence = P] }`: the exponent with which the measure falls as samples grow, the
    /// least squares slope of its logarithm over that of n through all of the experiment's sizes, lies within the margin with its whole interval. The exact
    /// slope is that of the exact values at the same sizes, not the one for endless samples.
    Slope {
        /// What falls.
        measure: Measure,
        /// The estimator.
        of: String,
        /// The expected slope; `None`: the exact one.
        equals: Option<f64>,
        /// The margin, absolute.
        margin: f64,
        /// Confidence of the interval; 0.99 if not given.
        confidence: f64,
    },
    /// `coverage = { of = A, at = X, [target = "mean" | "truth"], equals = P, margin = ABS, [confidence = C] }`: the share of the replicates whose interval about the estimate at the
    /// target nearest to X holds the mean of the estimate, or the truth, lies within the margin of P with its whole interval.
    Coverage {
        /// The estimator.
        of: String,
        /// The place.
        at: Vec<f64>,
        /// Whether the truth is to be held, not the mean.
        truth: bool,
        /// The expected share.
        equals: f64,
        /// The margin, absolute.
        margin: f64,
        /// Confidence of the interval for the share; 0.99 if not given.
        confidence: f64,
    },
    /// `everywhere = { [of = [A, ..]], agrees-with = "exact", [confidence = C] }`: at every target the mean of the simulated estimates agrees with the exact mean, given the exact
    /// variance, for all targets and estimators at once; targets that too few points reach for a normal mean are left out.
    Everywhere {
        /// The estimators; all when empty.
        of: Vec<String>,
        /// The probability that nothing true is rejected; 0.99 if not given.
        confidence: f64,
    },
    /// `best = { of = SWEEP, near = "oracle" | "exact", within = REL }`: the simulated MISE of the sweep is least within REL of the exact optimum: that over the whole line or plane
    /// whatever was swept (`oracle`), or that of the exact values of the same sweep over the same cells (`exact`).
    BestIsNear {
        /// The swept estimator.
        of: String,
        /// Whether the optimum is that of the same sweep over the same cells.
        swept: bool,
        /// How near, relative.
        within: f64,
    },
    /// `oracle = { quantity = "h_mise", kernel = "gaussian", equals = V, digits = 4 }`: theory alone.
    Oracle {
        /// `h_mise`, `mise`, `bias2`, `variance`, `h_amise`, `amise` or `amise_over_mise`.
        quantity: String,
        /// The kernel.
        kernel: String,
        /// In the plane, whether it is a product or a function of the distance.
        symmetry: String,
        /// The expected value.
        equals: f64,
        /// How many significant digits must agree.
        digits: u32,
    },
}

/// Names of estimators in a sentence.
fn several(of: &[String]) -> String {
    match of {
        [] => "all estimators".to_owned(),
        [one] => one.clone(),
        many => format!("{} estimators", many.len()),
    }
}

/// The statement as a sentence.
impl fmt::Display for Statement {
    #[expect(clippy::too_many_lines, reason = "one sentence a statement")]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Below {
                measure,
                of,
                below,
                other,
                by,
                ..
            } => {
                write!(
                    f,
                    "{} of {of} is below that of {below}{other}",
                    measure.name()
                )?;
                if (by - 1.0).abs() < f64::EPSILON {
                    Ok(())
                } else {
                    write!(f, " by a factor of {by} or more")
                }
            }
            Self::Equals {
                measure,
                of,
                over,
                other,
                equals,
                margin,
                ..
            } => {
                let margin = significant(*margin, 3);
                write!(f, "{} of {of} is {equals} ± {margin}", measure.name())?;
                match over.as_deref() {
                    None => Ok(()),
                    Some("minimum") => f.write_str(" times the least of any bandwidth"),
                    Some(over) => write!(f, " times that of {over}{other}"),
                }
            }
            Self::Everywhere { of, .. } => {
                let of = several(of);
                write!(
                    f,
                    "the mean estimate of {of} agrees with the exact one everywhere"
                )
            }
            Self::AgreesWithExact { measure, of, .. } => {
                let of = several(of);
                let name = measure.name();
                write!(f, "simulated {name} of {of} agrees with the exact value")
            }
            Self::MedianModes { of, median, .. } => {
                write!(f, "the median number of modes of {of} is {median}")
            }
            Self::ShareOfModes {
                of,
                count,
                share,
                margin,
                ..
            } => write!(
                f,
                "{of} has {count} modes in {share} ± {margin} of the samples"
            ),
            Self::Regret {
                of,
                over,
                median,
                margin,
                below,
                ..
            } => {
                write!(
                    f,
                    "the median error of {of} over that of {over} is {median} ± {margin}"
                )?;
                match below {
                    Some(below) => write!(f, ", below that of {below}"),
                    None => Ok(()),
                }
            }
            Self::Uncertainty {
                of,
                by,
                quantity,
                equals,
                above,
                ..
            } => {
                write!(f, "the {} of {by} for {of} is", quantity.name())?;
                if let Some((equals, margin)) = equals {
                    write!(f, " {equals} ± {}", significant(*margin, 3))?;
                }
                match above {
                    Some(above) => write!(f, " above {above}"),
                    None => Ok(()),
                }
            }
            Self::Slope {
                measure,
                of,
                equals,
                margin,
                ..
            } => {
                let expected = equals.map_or_else(|| "the exact one".to_owned(), |v| v.to_string());
                let name = measure.name();
                write!(f, "the slope of {name} of {of} is {expected} ± {margin}")
            }
            Self::Coverage {
                of,
                at,
                truth,
                equals,
                margin,
                ..
            } => {
                let place: Vec<String> = at.iter().map(f64::to_string).collect();
                let target = if *truth { "the truth" } else { "its mean" };
                write!(
                    f,
                    "the interval of {of} at {} holds {target} in {equals} ± {margin} of the samples",
                    place.join(", ")
                )
            }
            Self::BestIsNear { of, swept, within } => {
                let within = significant(100.0 * within, 3);
                let best = ["exact optimum, swept or not", "same sweep's exact best"];
                let best = best[usize::from(*swept)];
                write!(f, "the best of {of} lies within {within} % of the {best}")
            }
            Self::Oracle {
                quantity,
                kernel,
                equals,
                digits,
                ..
            } => write!(
                f,
                "{quantity} for the {kernel} kernel is {equals} to {digits} digits"
            ),
        }
    }
}

impl Statement {
    /// Whether theory alone decides it, without simulation.
    pub fn is_theory(&self) -> bool {
        match self {
            Self::Oracle { .. } => true,
            Self::Below { measure, .. }
            | Self::Equals { measure, .. }
            | Self::Slope { measure, .. } => measure.is_exact() || measure.is_probe(),
            _ => false,
        }
    }
}
