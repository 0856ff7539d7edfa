//! What figures and claims are checked against.

use super::DRAWS;
use super::names::Names;
use super::node::{Item, Reader};
use super::problem::{Problem, Span, printable};
use super::value::Located;
use crate::experiment::SourceSpec;
use crate::light::scene::Scene;
use crate::parameter::{listed, nearest};
use std::collections::BTreeMap;

/// The rest of the experiment; `None` where the file is wrong about it and nothing can be said.
pub(super) struct Setting<'s> {
    pub(super) names: &'s Names,
    pub(super) sources: Option<Vec<&'s str>>,
    /// Those in which photons walk, each with its scene.
    pub(super) rooms: Option<&'s [(&'s SourceSpec, &'s Scene)]>,
    pub(super) draws: Option<&'s [usize]>,
    /// The names of the regions.
    pub(super) regions: &'s [String],
    pub(super) replicates: Option<usize>,
    /// 1 on a line, 2 in the plane.
    pub(super) dimensions: Option<usize>,
    /// Whether the truth is known.
    pub(super) truth: Option<bool>,
    /// Whether the coverage of intervals is counted.
    pub(super) interval: bool,
    /// The least ∫f² of the sources, where they are known: the error of an estimate that is zero everywhere.
    pub(super) power: Option<f64>,
    /// The names of the estimates of the error.
    pub(super) uncertainties: &'s [String],
    /// What theory can say of each estimator; those that could not be built are missing.
    pub(super) theory: &'s Theory,
}

/// What theory can say of the estimators of an experiment.
#[derive(Default)]
pub(super) struct Theory {
    /// By name.
    pub(super) known: BTreeMap<String, Known>,
    /// By name and the name of a source.
    pub(super) rungs: BTreeMap<(String, String), Rungs>,
}

/// What the errors of an estimator can be compared with on one source.
#[derive(Clone, Copy)]
pub(super) struct Rungs {
    /// Whether there is a best bandwidth or width of its kind, over the whole line or plane.
    pub(super) optimum: bool,
    /// The oracles; none where points are not independent ones of a density.
    pub(super) ladder: Option<Oracles>,
}

/// Which oracles there are.
#[derive(Clone, Copy)]
pub(super) struct Oracles {
    /// The best of its kind.
    pub(super) best: bool,
    /// The best kernel estimates.
    pub(super) kernel: bool,
}

/// What theory can say of an estimator.
pub(super) struct Known {
    /// Why it has no exact mean and variance, if so.
    pub(super) inexact: Option<String>,
}

impl Setting<'_> {
    /// Reports if `what` needs a truth, or more than one replicate, and there is none.
    pub(super) fn demand(
        &self,
        reader: &mut Reader,
        span: &Span,
        what: &str,
        truth: bool,
        replicates: bool,
    ) -> bool {
        if truth && self.truth == Some(false) {
            reader.report(
                Problem::at(
                    span.clone(),
                    format!("{what} needs a known truth, and the source is a data file"),
                )
                .help("without a truth: `modes`, `smoothing` and `energy`"),
            );
            return false;
        }
        if replicates && self.replicates.is_some_and(|r| r < 2) {
            let help = if self.truth == Some(false) {
                "a data file is one sample"
            } else {
                "set `replicates`, for instance to 400"
            };
            reader.report(
                Problem::at(
                    span.clone(),
                    format!("{what} needs at least 2 replicates, and there is 1"),
                )
                .help(help),
            );
            return false;
        }
        true
    }

    /// One of the experiment's sample sizes.
    pub(super) fn draws(&self, reader: &mut Reader, item: &Item<'_>) -> Option<usize> {
        let n = reader.count(item, "`draws`", 1, DRAWS)? as usize;
        self.knows_draws(reader, n, &item.span()).then_some(n)
    }

    /// Whether `draws`, written at `span`, is one of the experiment's sample sizes.
    pub(super) fn knows_draws(&self, reader: &mut Reader, draws: usize, span: &Span) -> bool {
        let Some(known) = self.draws.filter(|known| !known.contains(&draws)) else {
            return true;
        };
        let problem = Problem::at(
            span.clone(),
            format!("{draws} is not one of the experiment's sample sizes"),
        );
        let known: Vec<String> = known.iter().map(usize::to_string).collect();
        reader.report(if known.is_empty() {
            problem.help("a data file has a size of its own")
        } else {
            problem.allowed(known.join(", "))
        });
        false
    }

    /// One of the experiment's regions.
    pub(super) fn region(&self, reader: &mut Reader, item: &Item<'_>) -> Option<String> {
        let name = reader.text(item, "`region`")?;
        if self.regions.iter().any(|known| known == name) {
            return Some(name.to_owned());
        }
        let problem = Problem::at(
            item.span(),
            format!("there is no region \"{}\"", printable(name)),
        );
        reader.report(if self.regions.is_empty() {
            problem.help("name parts of the grid: begin each with a line [[region]]")
        } else {
            problem
                .suggest(nearest(name, self.regions.iter().map(String::as_str)))
                .allowed(listed(self.regions))
        });
        None
    }

    /// One of the experiment's sources.
    pub(super) fn source(&self, reader: &mut Reader, item: &Item<'_>) -> Option<String> {
        let name = reader.text(item, "`source`")?;
        self.knows_source(reader, name, &item.span())
            .then(|| name.to_owned())
    }

    /// Whether `name`, written at `span`, is one of the experiment's sources.
    pub(super) fn knows_source(&self, reader: &mut Reader, name: &str, span: &Span) -> bool {
        let Some(sources) = self.sources.as_ref().filter(|known| !known.contains(&name)) else {
            return true;
        };
        reader.report(
            Problem::at(
                span.clone(),
                format!("there is no source \"{}\"", printable(name)),
            )
            .suggest(nearest(name, sources.iter().copied()))
            .allowed(listed(sources)),
        );
        false
    }

    /// `at`, and in the plane `at-y`.
    pub(super) fn place(&self, reader: &mut Reader, read: &Located) -> Option<Vec<f64>> {
        let x = read.values.number("at")?;
        match (self.dimensions, read.values.number("at-y")) {
            (Some(2), Some(y)) => Some(vec![x, y]),
            (Some(2), None) => {
                reader.report(Problem::at(
                    read.place("at"),
                    "a place in the plane has two coordinates: give `at-y` too",
                ));
                None
            }
            _ => Some(vec![x]),
        }
    }
}
