//! One estimator, or one density, outside of an experiment.

use super::estimator as group;
use super::node::{Reader, Table};
use super::problem::{Problem, Problems, Span};
use super::source;
use super::{document, trial::try_to_build};
use crate::density::Truth;
use crate::estimator::{Context, Estimator};
use crate::experiment::EstimatorSpec;
use crate::experiment::catalogue::{Builds, Entry};

/// A value needs a key to be a document; spans are moved back afterwards.
const KEY: &str = "estimator=";

pub(super) type Single<const D: usize> = (EstimatorSpec, Option<Box<dyn Estimator<D>>>);

/// Reads one estimator, and builds it if there is a context.
pub(super) fn estimator<const D: usize>(
    text: &str,
    origin: &str,
    context: Option<&Context<D>>,
) -> Result<Single<D>, Problems>
where
    Entry: Builds<D>,
{
    let mut reader = Reader::default();
    let inline = text.trim_start().starts_with('{');
    let wrapped = if inline {
        format!("{KEY}{text}")
    } else {
        text.to_owned()
    };
    let shift = if inline { KEY.len() } else { 0 };
    let mut broken = Vec::new();
    let readable = document::close_brackets(&wrapped, &mut reader, &mut broken);
    let document = document::parse(&readable, &mut reader, &mut broken);
    let mut top = Table::new(document.get_ref(), shift..wrapped.len(), "the text");
    let table = if inline {
        top.take("estimator")
            .and_then(|entry| reader.table(entry.item, "an estimator"))
    } else {
        Some(Table::new(
            document.get_ref(),
            0..wrapped.len(),
            "an estimator",
        ))
    };
    let group = table.and_then(|table| group::group(&mut reader, table).1);
    let mut found = None;
    if let Some(group) = &group {
        if group.swept {
            reader.report(Problem::at(
                group.places.first().map_or(0..0, Clone::clone),
                "a sweep makes many estimators; one is wanted here",
            ));
        } else if let [spec] = &group.members[..] {
            found = Some((spec.clone(), None));
            if let Some(context) = context {
                match try_to_build(spec, context) {
                    Ok(built) => found = Some((spec.clone(), Some(built))),
                    Err(error) => reader.report(Problem::at(
                        group.located.place(error.parameter),
                        error.what,
                    )),
                }
            }
        }
    }
    let problems = shifted(reader, &wrapped, &broken, text, shift);
    match found {
        Some(found) if problems.is_empty() => Ok(found),
        _ if problems.is_empty() => Err(Problems::whole(
            origin,
            "an estimator is written { KIND = { settings } }, for instance { kernel = { bandwidth = 0.3 } }",
        )),
        _ => Err(Problems::new(origin, text, problems)),
    }
}

/// Reads one density with its parameters: `{ beta = { a = 2, b = 3 } }`, the outer braces may be missing.
pub(super) fn density(text: &str, origin: &str) -> Result<Truth, Problems> {
    let (before, after) = if text.trim_start().starts_with('{') {
        ("density=", "")
    } else {
        ("density={ ", " }")
    };
    let wrapped = format!("{before}{text}{after}");
    let mut reader = Reader::default();
    let mut broken = Vec::new();
    let readable = document::close_brackets(&wrapped, &mut reader, &mut broken);
    let document = document::parse(&readable, &mut reader, &mut broken);
    let mut top = Table::new(document.get_ref(), before.len()..wrapped.len(), "the text");
    let entry = top.take("density");
    let found = entry.and_then(|entry| source::one(&mut reader, entry.item));
    let more = top.finish(&mut reader, &["density"]);
    let problems = shifted(reader, &wrapped, &broken, text, before.len());
    match found.and_then(|read| read.truth) {
        Some(truth) if problems.is_empty() && !more => Ok(truth),
        _ if problems.is_empty() => Err(Problems::whole(
            origin,
            "a density is written { KIND = { parameters } }, for instance { beta = { a = 2, b = 3 } }",
        )),
        _ => Err(Problems::new(origin, text, problems)),
    }
}

/// What is wrong, placed in the `text` that begins after `shift` bytes of what was read.
fn shifted(
    reader: Reader,
    wrapped: &str,
    broken: &[Span],
    text: &str,
    shift: usize,
) -> Vec<Problem> {
    let mut problems = reader.problems;
    document::sift(&mut problems, wrapped, broken);
    for problem in &mut problems {
        for end in [&mut problem.span.start, &mut problem.span.end] {
            *end = end.saturating_sub(shift).min(text.len());
        }
    }
    problems
}
