//! What figures and claims may refer to.

use super::estimator::{Given, Group};
use super::node::Reader;
use super::problem::{Problem, Span, printable};
use crate::parameter::{listed, nearest};

/// No more names than these are listed in a message.
const LISTED: usize = 12;

/// The estimators of an experiment by name.
#[derive(Default)]
pub(super) struct Names {
    single: Vec<String>,
    sweeps: Vec<(String, Vec<String>)>,
    /// Estimators with something wrong: references to them are not to be blamed.
    faulty: Vec<String>,
    /// Whether there are estimators whose names could not be found out.
    uncertain: bool,
}

impl Names {
    /// Notes one `[[estimator]]`.
    pub(super) fn add(&mut self, given: &Given, group: Option<&Group>) {
        self.uncertain |= matches!(given, Given::Faulty);
        match (group, given) {
            (Some(group), _) if group.members.is_empty() => self.faulty.push(group.name.clone()),
            (Some(group), _) if group.swept => self.sweeps.push((
                group.name.clone(),
                group.members.iter().map(|m| m.name.clone()).collect(),
            )),
            (Some(group), _) => self.single.push(group.name.clone()),
            (None, Given::Name(name, _)) => self.faulty.push(name.clone()),
            (None, _) => self.uncertain = true,
        }
    }

    /// Names that cannot be known stop references from being blamed.
    pub(super) fn doubt(&mut self) {
        self.uncertain = true;
    }

    fn excused(&self, name: &str) -> bool {
        self.uncertain
            || self.faulty.iter().any(|faulty| {
                name.strip_prefix(faulty.as_str())
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with(", "))
            })
    }

    /// One estimator; a member of a sweep by its own name.
    pub(super) fn one(&self, reader: &mut Reader, name: &str, span: &Span) -> bool {
        if self.all().any(|other| other == name) {
            return true;
        }
        if let Some((_, members)) = self.sweeps.iter().find(|(group, _)| group == name) {
            let shown: Vec<&String> = members.iter().take(LISTED).collect();
            reader.report(
                Problem::at(
                    span.clone(),
                    format!(
                        "\"{}\" is a sweep of {} estimators; name one of them",
                        printable(name),
                        members.len()
                    ),
                )
                .suggest(members.get(members.len() / 2).map(String::as_str))
                .allowed(abridged(&shown, members.len())),
            );
            return false;
        }
        self.unknown(reader, "estimator", name, span, self.all());
        false
    }

    /// Estimators by name, a sweep standing for all of its members.
    pub(super) fn many(&self, reader: &mut Reader, name: &str, span: &Span) -> Vec<String> {
        if let Some((_, members)) = self.sweeps.iter().find(|(group, _)| group == name) {
            return members.clone();
        }
        if self.all().any(|other| other == name) {
            return vec![name.to_owned()];
        }
        let known = self
            .sweeps
            .iter()
            .map(|(group, _)| group.as_str())
            .chain(self.all());
        self.unknown(reader, "estimator", name, span, known);
        Vec::new()
    }

    /// The members of a sweep.
    pub(super) fn members(&self, group: &str) -> &[String] {
        self.sweeps
            .iter()
            .find(|(name, _)| name == group)
            .map_or(&[], |(_, members)| members)
    }

    /// A sweep.
    pub(super) fn sweep(&self, reader: &mut Reader, name: &str, span: &Span) -> bool {
        if self.sweeps.iter().any(|(group, _)| group == name) {
            return true;
        }
        if self.single.iter().any(|other| other == name) {
            reader.report(
                Problem::at(
                    span.clone(),
                    format!("\"{}\" is not swept over anything", printable(name)),
                )
                .help("sweep a parameter: bandwidth = { low = 0.05, high = 2.0, steps = 25 }"),
            );
            return false;
        }
        let known = self.sweeps.iter().map(|(group, _)| group.as_str());
        self.unknown(reader, "sweep", name, span, known);
        false
    }

    /// All estimators in the order of the file, but sweeps after the others.
    fn all(&self) -> impl Iterator<Item = &str> {
        self.single
            .iter()
            .chain(self.sweeps.iter().flat_map(|(_, members)| members))
            .map(String::as_str)
    }

    fn unknown<'n>(
        &'n self,
        reader: &mut Reader,
        what: &str,
        name: &str,
        span: &Span,
        known: impl Iterator<Item = &'n str>,
    ) {
        if self.excused(name) {
            return;
        }
        let known: Vec<&str> = known
            .chain(self.faulty.iter().map(String::as_str))
            .collect();
        let mut problem = Problem::at(
            span.clone(),
            format!("there is no {what} \"{}\"", printable(name)),
        )
        .suggest(nearest(name, known.iter().copied()))
        .doubtful();
        if !known.is_empty() {
            let shown: Vec<&str> = known.iter().copied().take(LISTED).collect();
            problem = problem.allowed(abridged(&shown, known.len()));
        }
        reader.report(problem);
    }
}

fn abridged<S: AsRef<str>>(shown: &[S], all: usize) -> String {
    let safe: Vec<String> = shown.iter().map(|name| printable(name.as_ref())).collect();
    let list = listed(&safe);
    if all > shown.len() {
        format!("{list} and {} more", all - shown.len())
    } else {
        list
    }
}
