//! Building what a file describes before anything is run, so that nothing can fail later.

use super::estimator::Group;
use super::node::Reader;
use super::problem::{Problem, printable};
use super::setting::Known;
use super::source;
use crate::density::Density;
use crate::estimator::Context;
use crate::experiment::EstimatorSpec;
use crate::experiment::catalogue::{self, Builds, Built};
use crate::sample::Sample;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Builds every estimator once for every source and size, and fits it where a sample may have no spread, so that nothing can fail later. Says what theory
/// knows of each.
pub(super) fn try_building(
    reader: &mut Reader,
    groups: &[Group],
    sources: &[source::Read],
    draws: &[usize],
) -> BTreeMap<String, Known> {
    let mut theory = BTreeMap::new();
    for source in sources {
        let own;
        let sizes = match &source.sample {
            Some(sample) => {
                own = [sample.len()];
                &own[..]
            }
            None => draws,
        };
        for &draws in sizes {
            let context = Context {
                truth: source
                    .truth
                    .clone()
                    .map(|truth| truth as Arc<dyn Density<1>>),
                draws,
            };
            let trial = trial(source, draws);
            for group in groups {
                for (at, member) in group.members.iter().enumerate() {
                    let place = |parameter: &str| match &member.sweep {
                        Some(sweep) if sweep.parameter == parameter => group.places[at].clone(),
                        _ => group.located.place(parameter),
                    };
                    let built = match try_to_build(member, &context) {
                        Ok(built) => built,
                        Err(error) => {
                            reader.report(Problem::at(place(error.parameter), error.what));
                            continue;
                        }
                    };
                    if let Some(truth) = &source.truth {
                        let exact = built.expectation(&**truth, draws, &[]).is_some();
                        theory
                            .entry(member.name.clone())
                            .or_insert_with(|| known(member, exact, built.family().is_some()));
                    }
                    if let Some(sample) = &trial
                        && let Err(error) = built.fit(sample)
                    {
                        let smoothing = catalogue::estimator(&member.kind)
                            .and_then(|entry| entry.smoothing)
                            .unwrap_or_default();
                        reader.report(Problem::at(
                            place(smoothing),
                            format!(
                                "\"{}\" cannot be fitted to {} points of \"{}\": {error}",
                                printable(&member.name),
                                sample.len(),
                                printable(source.spec.name())
                            ),
                        ));
                    }
                }
            }
        }
    }
    theory
}

/// What theory knows of an estimator, in words.
fn known(member: &EstimatorSpec, exact: bool, family: bool) -> Known {
    let smoothing = catalogue::estimator(&member.kind).and_then(|entry| entry.smoothing);
    let swept = member.sweep.as_ref().map(|sweep| sweep.parameter.as_str());
    let rule = smoothing.and_then(|name| Some((name, member.values.word(name)?)));
    Known {
        inexact: (!exact).then(|| match rule {
            Some((name, rule)) => format!("its {name} is chosen from each sample (\"{rule}\")"),
            None => format!("no theory is known for `{}`", member.kind),
        }),
        optimum: family && swept.is_none_or(|swept| Some(swept) == smoothing),
    }
}

/// A sample that shows before the run whether estimators can be fitted: that of a data file, if it is not large, or a single point where the
/// experiment draws no more. Larger samples of a density have a spread.
fn trial(source: &source::Read, draws: usize) -> Option<Sample<1>> {
    const LARGE: usize = 10_000;
    match (&source.sample, &source.truth) {
        (Some(sample), _) => (sample.len() <= LARGE).then(|| sample.clone()),
        (None, Some(truth)) if draws == 1 => {
            Sample::equal(vec![[truth.quantile(0.5)]], truth.domain().clone()).ok()
        }
        _ => None,
    }
}

/// Builds an estimator.
pub(super) fn try_to_build(spec: &EstimatorSpec, context: &Context<1>) -> Built<1> {
    let entry = catalogue::estimator(&spec.kind)
        .expect("specifications are made from entries of the catalogue");
    entry.build(&spec.values, context)
}
