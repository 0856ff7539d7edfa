//! Where the width of bins comes from, and the fitting that all binned estimators share.

use super::bins::Bins;
use super::{BuildError, Context, Estimate, FitError, Laws};
use crate::parameter::Values;
use crate::sample::Sample;
use crate::selector::{BinWidth, SelectError};
use crate::space::{Domain, Field, Warning};
use crate::theory::Family;
use std::sync::Arc;

/// A rule that chooses a width from the data.
pub(super) type Rule = fn(&Sample<1>) -> Result<BinWidth, SelectError>;

/// A sample in bins.
pub(super) struct Binned {
    pub(super) bins: Bins,
    /// The width that the user knows; that of the bins may be a part of it.
    pub(super) width: f64,
    pub(super) domain: Domain<1>,
}

/// A number, or a rule that finds one for each sample.
pub(super) enum Width {
    Number(f64),
    Rule(Rule),
}

impl Width {
    /// What the file says under `width`: a number, one of the `rules`, or the best of `family` for the known truth.
    pub(super) fn given(
        values: &Values,
        context: &Context<1>,
        rules: &[(&str, Rule)],
        family: Family,
    ) -> Result<Self, BuildError> {
        if let Some(width) = values.number("width") {
            return Ok(Self::Number(width));
        }
        let word = values.word("width").unwrap_or_default();
        if let Some((_, rule)) = rules.iter().find(|(name, _)| *name == word) {
            return Ok(Self::Rule(*rule));
        }
        best(context, "width", word, family).map(Self::Number)
    }

    /// The width, where it is the same for all samples.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Number(width) => Some(*width),
            Self::Rule(_) => None,
        }
    }

    /// The width for `sample`.
    fn of(&self, sample: &Sample<1>) -> Result<(f64, Vec<Warning>), FitError> {
        match self {
            Self::Number(width) => Ok((*width, Vec::new())),
            Self::Rule(rule) => {
                let chosen = rule(sample)?;
                Ok((chosen.width, chosen.warnings))
            }
        }
    }

    /// The whole of fitting a binned estimator: chooses the width, counts the sample and each of its channels alike in bins of 1/`divisions` of it from
    /// `origin`, and makes with `field` what is told of them.
    pub(super) fn fit<F: Field<1> + 'static>(
        &self,
        sample: &Sample<1>,
        divisions: f64,
        origin: f64,
        field: impl Fn(Binned) -> F,
    ) -> Result<Estimate<1>, FitError> {
        let (width, mut warnings) = self.of(sample)?;
        let binned = |sample: &Sample<1>| -> Result<Binned, FitError> {
            Ok(Binned {
                bins: Bins::of(sample, origin, width / divisions)?,
                width,
                domain: sample.domain().clone(),
            })
        };
        let total = binned(sample)?;
        warnings.extend(total.bins.warnings());
        let channels = (0..sample.channels())
            .map(|c| Ok(Arc::new(field(binned(&sample.channel(c))?)) as Arc<dyn Field<1>>))
            .collect::<Result<_, FitError>>()?;
        let mut estimate = Estimate::new(Arc::new(field(total))).with_channels(channels);
        estimate.smoothing = Some(width);
        estimate.warnings = warnings;
        Ok(estimate)
    }

    /// What holds of every average of bins of this width, continuous ones.
    pub(super) fn laws(&self) -> Laws {
        let fixed = matches!(self, Self::Number(_));
        Laws {
            mass_conserving: true,
            non_negative: true,
            linear: fixed,
            reproduces_constants: false,
            reproduces_linear: false,
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
    family: Family,
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
    let draws = context.draws as f64;
    let best = match word {
        "oracle" => {
            family
                .optimum(truth, draws)
                .ok_or_else(|| {
                    error(format!(
                        "\"{word}\": no best {parameter} is known; give a number"
                    ))
                })?
                .at
        }
        _ => family
            .asymptotic(truth, draws)
            .map_err(|why| error(format!("\"{word}\": {why}; give a number or \"oracle\"")))?
            .best(),
    };
    if best > 0.0 && best.is_finite() {
        return Ok(best);
    }
    Err(error(format!(
        "\"{word}\": the error keeps falling up to a {parameter} of {best}, so that none is best; give a number"
    )))
}
