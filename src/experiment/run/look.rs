//! Looking at what a run has found so far, to see whether it is enough.

use super::{Bench, Cell, Record, block_length};
use crate::experiment::stop;
use crate::space::Warning;
use std::collections::BTreeMap;

/// After how many blocks to look: all, for an experiment that does not stop early.
pub(super) fn looks<const D: usize>(bench: &Bench<D>) -> Vec<usize> {
    let experiment = bench.experiment();
    let blocks = experiment.replicates.div_ceil(block_length(experiment));
    match experiment.stop {
        Some(_) => stop::looks(blocks),
        None => vec![blocks],
    }
}

/// That the first `look` blocks settle the question, if they do; there are so many looks in all.
pub(super) fn enough<const D: usize>(
    bench: &Bench<D>,
    records: &BTreeMap<Cell, Record>,
    look: usize,
    looks: usize,
) -> Option<Warning> {
    let experiment = bench.experiment();
    let rule = experiment.stop?;
    let mut groups: BTreeMap<(usize, usize), BTreeMap<usize, Vec<f64>>> = BTreeMap::new();
    for (cell, record) in records.iter().filter(|(cell, _)| cell.block < look) {
        let group = groups.entry((cell.source, cell.size)).or_default();
        let errors = group.entry(cell.estimator).or_default();
        for replicate in &record.replicates {
            errors.push(replicate.errors?.ise);
        }
    }
    let groups: Vec<Vec<Vec<f64>>> = groups
        .into_values()
        .map(|group| group.into_values().collect())
        .collect();
    let how = rule.settled(&groups, looks)?;
    let seen = (look * block_length(experiment)).min(experiment.replicates);
    Some(Warning {
        what: format!(
            "the run stopped after {seen} of {} replicates: {how}, with confidence {} over all looks",
            experiment.replicates,
            rule.confidence()
        ),
        hint: "leave `stop` out for all of them".to_owned(),
    })
}
