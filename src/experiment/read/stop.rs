//! `stop`: when a run has seen enough.

use super::node::{Entry, Reader};
use super::problem::Problem;
use super::value;
use crate::experiment::stop::StopRule;
use crate::parameter::{Absent, Kind, Parameter};

/// `stop`.
pub(crate) const STOP: &[Parameter] = &[
    Parameter::optional(
        "relative-error",
        Kind::Between(0.0, 1.0),
        Absent::Unset,
        "ends the run when every MISE is known to within this share of itself",
    ),
    Parameter::optional(
        "rank",
        Kind::Choice(&["estimators"]),
        Absent::Unset,
        "ends the run when the order of all estimators by MISE is known",
    ),
    Parameter::optional(
        "confidence",
        Kind::Range(0.9, 0.9999),
        Absent::Number(0.99),
        "the probability that what is then stated is right, however often the run looked",
    ),
];

/// Reads `stop`. `truth` is whether errors can be known, `replicates` how many there are at most.
pub(super) fn stop(
    reader: &mut Reader,
    entry: Entry<'_>,
    truth: Option<bool>,
    replicates: Option<usize>,
) -> Option<StopRule> {
    let mut table = reader.table(entry.item, "`stop`")?;
    table.span = entry.key_span();
    let read = value::values(reader, STOP, table, "`stop`");
    if !read.complete {
        return None;
    }
    let confidence = read.values.number("confidence")?;
    let within = read.values.number("relative-error");
    let rule = match (within, read.values.word("rank")) {
        (Some(within), None) => StopRule::RelativeError { within, confidence },
        (None, Some(_)) => StopRule::Rank { confidence },
        _ => {
            reader.report(
                Problem::at(
                    entry.key_span(),
                    "`stop` needs one thing that must be known",
                )
                .allowed("`relative-error` or `rank`"),
            );
            return None;
        }
    };
    let grounds = match (truth, replicates) {
        (Some(false), _) => Some("`stop` is about errors, which need a known truth"),
        (_, Some(0..=2)) => {
            Some("`stop` needs replicates to leave out: set `replicates` to the most there may be")
        }
        _ => None,
    };
    if let Some(what) = grounds {
        reader.report(Problem::at(entry.key_span(), what));
        return None;
    }
    Some(rule)
}
