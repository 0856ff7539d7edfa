//! How fast an error falls as samples grow.

use super::short;
use crate::accuracy::Interval;
use crate::experiment::Measure;
use crate::experiment::results::Group;
use crate::numeric::Sum;

/// The slope of ln(measure) over ln(n) through the groups of one source, by least squares, with its interval at `confidence`; `None` for fewer than two
/// sizes, or values that have no logarithm.
///
/// With weights cⱼ = (xⱼ - x̄)/Σ(x - x̄)², x = ln n, the slope is Σ cⱼ ln mⱼ. A simulated mean mⱼ = Σᵢ eᵢⱼ/R makes that, to first order, the mean over replicates of
/// Σⱼ cⱼ (eᵢⱼ/mⱼ - 1), whose spread is the standard error: replicates of different sizes begin with the same points, and this is what that does to a slope.
pub fn slope<const D: usize>(
    groups: &[&Group<D>],
    of: &str,
    measure: Measure,
    confidence: f64,
) -> Option<Interval> {
    let outcomes: Vec<_> = groups
        .iter()
        .map(|group| group.outcome(of).map(|outcome| (*group, outcome)))
        .collect::<Option<_>>()?;
    let values: Vec<f64> = outcomes
        .iter()
        .map(|(_, outcome)| outcome.measures.get(&measure).map(|m| m.value))
        .collect::<Option<_>>()?;
    let x: Vec<f64> = groups
        .iter()
        .map(|group| (group.draws as f64).ln())
        .collect();
    let centre = x.iter().sum::<f64>() / x.len() as f64;
    let spread: f64 = x.iter().map(|x| (x - centre).powi(2)).sum();
    if spread <= 0.0 || values.iter().any(|value| *value <= 0.0) {
        return None;
    }
    let weights: Vec<f64> = x.iter().map(|x| (x - centre) / spread).collect();
    let slope: f64 = weights.iter().zip(&values).map(|(c, v)| c * v.ln()).sum();
    if measure.is_exact() {
        return Some(Interval::exact(slope));
    }
    let errors: Vec<Vec<f64>> = outcomes
        .iter()
        .map(|(group, outcome)| outcome.per_replicate(measure, group.truth_integral()))
        .collect::<Option<_>>()?;
    let replicates = errors.iter().map(Vec::len).min().filter(|r| *r > 1)?;
    let influence = |i: usize| -> f64 {
        let parts = weights.iter().zip(&errors).zip(&values);
        parts.map(|((c, e), m)| c * (e[i] / m - 1.0)).sum()
    };
    let squares: Sum = (0..replicates).map(|i| influence(i).powi(2)).collect();
    let r = replicates as f64;
    let error = (squares.value() / (r - 1.0) / r).sqrt();
    Some(Interval::around(slope, error, r - 1.0, confidence))
}

/// Whether the whole interval of the slope lies within the margin of what is expected.
pub(super) fn has_slope<const D: usize>(
    groups: &[&Group<D>],
    (of, measure): (&str, Measure),
    equals: Option<f64>,
    margin: f64,
    confidence: f64,
) -> Option<(bool, String)> {
    let found = slope(groups, of, measure, confidence)?;
    let expected = match equals {
        Some(expected) => expected,
        None => slope(groups, of, Measure::ExactMise, confidence)?.value,
    };
    let detail = if found.standard_error.is_some() {
        format!(
            "slope {} (interval {} to {}), expected {} ± {margin}",
            short(found.value),
            short(found.low),
            short(found.high),
            short(expected)
        )
    } else {
        format!(
            "slope {}, expected {} ± {margin}",
            short(found.value),
            short(expected)
        )
    };
    let holds = expected - margin <= found.low && found.high <= expected + margin;
    Some((holds, detail))
}
