//! Where the width of bins comes from, and the fitting that all binned estimators share.

use super::bins::Bins;
use super::{BuildError, Context, Estimate, FitError, Laws};
use crate::density::Univariate;
use crate::parameter::Values;
use crate::sample::Sample;
use crate::selector::{BinWidth, SelectError};
use crate::space::{Domain, Field, Warning};
use crate::theory::NoAsymptotics;
use std::sync::Arc;

/// A rule that chooses a width from the data.
pub(super) type Rule = fn(&Sample<1>) -> Result<BinWidth, SelectError>;

/// A number, or a rule that finds one for each sample.
pub(super) enum Width {
    Number(f64),
    Rule(Rule),
}

impl Width {
    /// What the file says under `width`: a number, one of the `rules`, or a word that `optimum` turns into a number with the known truth.
    pub(super) fn given(
        values: &Values,
        context: &Context<1>,
        rules: &[(&str, Rule)],
        optimum: impl Fn(&str, &dyn Univariate, f64) -> Result<f64, NoAsymptotics>,
    ) -> Result<Self, BuildError> {
        if let Some(width) = values.number("width") {
            return Ok(Self::Number(width));
        }
        let word = values.word("width").unwrap_or_default();
        if let Some((_, rule)) = rules.iter().find(|(name, _)| *name == word) {
            return Ok(Self::Rule(*rule));
        }
        best(context, "width", word, optimum).map(Self::Number)
    }

    /// The width, where it is the same for all samples.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Number(width) => Some(*width),
            Self::Rule(_) => None,
        }
    }

    /// The width for `sample`.
    pub(super) fn of(&self, sample: &Sample<1>) -> Result<(f64, Vec<Warning>), FitError> {
        match self {
            Self::Number(width) => Ok((*width, Vec::new())),
            Self::Rule(rule) => {
                let chosen = rule(sample)?;
                Ok((chosen.width, chosen.warnings))
            }
        }
    }

    /// What holds of every average of bins of this width, continuous ones.
    pub(super) fn laws(&self) -> Laws {
        let fixed = matches!(self, Self::Number(_));
        Laws {
            mass_conserving: true,
            non_negative: true,
            linear: fixed,
            continuous: true,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: fixed,
        }
    }
}

/// The number behind a word that means "the best width for the true density".
pub(super) fn best(
    context: &Context<1>,
    parameter: &'static str,
    word: &str,
    optimum: impl Fn(&str, &dyn Univariate, f64) -> Result<f64, NoAsymptotics>,
) -> Result<f64, BuildError> {
    let error = |what| BuildError { parameter, what };
    let Some(truth) = &context.truth else {
        return Err(error(format!(
            "\"{word}\" is the best {parameter} for a known density, and the density of measured data is not known; give a number or a rule that looks at the data alone"
        )));
    };
    let Some(truth) = truth.univariate() else {
        return Err(error(format!(
            "\"{word}\": no theory of the best {parameter} is known for this density; give a number"
        )));
    };
    let best = optimum(word, truth, context.draws as f64).map_err(|why| {
        error(format!(
            "\"{word}\": {why}; give a number, or \"oracle\" where it is allowed"
        ))
    })?;
    if best > 0.0 && best.is_finite() {
        return Ok(best);
    }
    Err(error(format!(
        "\"{word}\": the error keeps falling up to a {parameter} of {best}, so that none is best; give a number"
    )))
}

/// Bins the sample and each of its channels alike and makes the fields over them. `smoothing` is the width that the user knows, `width` that of the bins.
pub(super) fn binned(
    sample: &Sample<1>,
    mut warnings: Vec<Warning>,
    smoothing: f64,
    width: f64,
    origin: f64,
    field: impl Fn(Bins, Domain<1>) -> Arc<dyn Field<1>>,
) -> Result<Estimate<1>, FitError> {
    let total = Bins::of(sample, origin, width)?;
    warnings.extend(total.warnings(sample));
    let channels = (0..sample.channels())
        .map(|c| {
            Ok(field(
                Bins::of(&sample.channel(c), origin, width)?,
                sample.domain().clone(),
            ))
        })
        .collect::<Result<_, FitError>>()?;
    let mut estimate = Estimate::new(field(total, sample.domain().clone())).with_channels(channels);
    estimate.smoothing = Some(smoothing);
    estimate.warnings = warnings;
    Ok(estimate)
}
