//! Building what a file describes before anything is run, so that nothing can fail later.

use super::data::{Data, Holds};
use super::estimator::Group;
use super::node::Reader;
use super::problem::{Problem, printable};
use super::setting::{Known, Oracles, Rungs, Theory};
use super::source;
use crate::density::Density;
use crate::estimator::Context;
use crate::experiment::catalogue::{self, Builds, Built, Entry};
use crate::experiment::{EstimatorSpec, GridSpec, SourceSpec, ladder};
use crate::random;
use crate::sample::Sample;
use crate::space::Grid;
use std::sync::Arc;

/// Builds every estimator once for every source and size, and fits it where a sample may have no spread, so that nothing can fail later. Says what theory
/// knows of each.
pub(super) fn try_building(
    reader: &mut Reader,
    groups: &[Group],
    sources: &[source::Read],
    draws: &[usize],
    grid: Option<&GridSpec>,
) -> Theory {
    let mut theory = Theory::default();
    for source in sources {
        match source.spec.dimensions() {
            1 => try_source::<1>(reader, groups, source, (draws, grid), &mut theory),
            _ => try_source::<2>(reader, groups, source, (draws, grid), &mut theory),
        }
    }
    theory
}

fn try_source<const D: usize>(
    reader: &mut Reader,
    groups: &[Group],
    source: &source::Read,
    (draws, grid): (&[usize], Option<&GridSpec>),
    theory: &mut Theory,
) where
    Entry: Builds<D>,
    Data: Holds<D>,
{
    let data: Option<&Sample<D>> = source.sample.as_ref().and_then(Data::sample);
    let truth: Option<Arc<dyn Density<D>>> = source.truth.clone().and_then(Entry::truth);
    let spec = &source.spec;
    let alone = !matches!(spec, SourceSpec::Density { paths: Some(_), .. });
    let independent = truth.as_ref().filter(|_| alone);
    let grid: Option<Grid<D>> = grid.and_then(|grid| grid.grid().ok());
    let own;
    let sizes = match data {
        Some(sample) => {
            own = [sample.len()];
            &own[..]
        }
        None => draws,
    };
    for &draws in sizes {
        let context = Context {
            truth: truth.clone(),
            draws,
        };
        let trial = trial(data, truth.as_deref(), draws);
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
                let key = (member.name.clone(), source.spec.name().to_owned());
                theory.rungs.entry(key).or_insert_with(|| {
                    let family = built.family().filter(|family| family.is_of_estimates());
                    let errors = family
                        .zip(independent)
                        .is_some_and(|(family, truth)| family.has_errors(&**truth));
                    Rungs {
                        optimum: errors && varies_smoothing(member),
                        ladder: independent.map(|truth| Oracles {
                            kernel: ladder::has_kernel(truth),
                            best: ladder::has_best(truth, grid.as_ref(), built.as_ref(), member),
                        }),
                    }
                });
                if let Some(truth) = &truth {
                    let exact = built.expectation(&**truth, draws, &[]).is_some();
                    let known = theory.known.entry(member.name.clone());
                    known.or_insert_with(|| known_of(member, exact));
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

/// Whether the members of a sweep differ in what they smooth by, or there is no sweep.
fn varies_smoothing(member: &EstimatorSpec) -> bool {
    let smoothing = catalogue::estimator(&member.kind).and_then(|entry| entry.smoothing);
    let swept = member.sweep.as_ref().map(|sweep| sweep.parameter.as_str());
    swept.is_none_or(|swept| Some(swept) == smoothing)
}

/// What theory knows of an estimator, in words.
fn known_of(member: &EstimatorSpec, exact: bool) -> Known {
    let smoothing = catalogue::estimator(&member.kind).and_then(|entry| entry.smoothing);
    let rule = smoothing.and_then(|name| Some((name, member.values.word(name)?)));
    Known {
        inexact: (!exact).then(|| match rule {
            Some((name, rule)) => format!("its {name} is chosen from each sample (\"{rule}\")"),
            None => format!("no theory is known for `{}`", member.kind),
        }),
    }
}

/// A sample that shows before the run whether estimators can be fitted: that of a data file, if it is not large, or a single point where the
/// experiment draws no more. Larger samples of a density have a spread.
fn trial<const D: usize>(
    data: Option<&Sample<D>>,
    truth: Option<&dyn Density<D>>,
    draws: usize,
) -> Option<Sample<D>> {
    const LARGE: usize = 10_000;
    match (data, truth) {
        (Some(sample), _) => (sample.len() <= LARGE).then(|| sample.clone()),
        (None, Some(truth)) if draws == 1 => {
            let point = truth.draw(&mut random::stream(1, "trial", 0));
            Sample::equal(vec![point], truth.domain().clone()).ok()
        }
        _ => None,
    }
}

/// Builds an estimator.
pub(super) fn try_to_build<const D: usize>(spec: &EstimatorSpec, context: &Context<D>) -> Built<D>
where
    Entry: Builds<D>,
{
    let entry = catalogue::estimator(&spec.kind)
        .expect("specifications are made from entries of the catalogue");
    entry.build(&spec.values, context)
}
