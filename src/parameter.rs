//! Named parameters: what a thing that can be chosen by name may be told, as data.
//!
//! An estimator, a density or a selector declares its parameters once, in its own file; reading a file, checking ranges, suggesting spellings,
//! writing the schema and printing `lab list` all follow from the declaration.

use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// What values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A finite number.
    Real,
    /// A finite number above 0.
    Positive,
    /// A number from 0 to 1, both allowed.
    Fraction,
    /// A number strictly between two others.
    Between(f64, f64),
    /// A number from one to another, both allowed.
    Range(f64, f64),
    /// A whole number in a range, both ends allowed.
    Count {
        /// The least.
        least: u64,
        /// The most.
        most: u64,
    },
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A list of these words.
    Choices(&'static [&'static str]),
    /// Any text.
    Text,
    /// A text or a list of texts, at least one.
    Texts,
    /// `true` or `false`.
    Flag,
    /// A positive number or one of these words (a rule that chooses the number).
    PositiveOr(&'static [&'static str]),
    /// A whole number in a range, or one of these words (a rule that chooses the number).
    CountOr {
        /// The least.
        least: u64,
        /// The most.
        most: u64,
        /// The rules.
        words: &'static [&'static str],
    },
    /// A list of tables, each with these parameters.
    Rows(&'static [Parameter]),
}

impl Kind {
    /// The same without the words that choose a number: what each value of a sweep is, which needs numbers to be drawn against.
    pub fn numeric(self) -> Self {
        match self {
            Self::PositiveOr(_) => Self::Positive,
            Self::CountOr { least, most, .. } => Self::Count { least, most },
            other => other,
        }
    }
}

/// What is allowed, in words.
impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Real => f.write_str("a finite number"),
            Self::Positive => f.write_str("a finite number above 0"),
            Self::Fraction => f.write_str("a number from 0 to 1"),
            Self::Between(low, high) => {
                write!(f, "a number between {low} and {high}, the ends excluded")
            }
            Self::Range(least, most) => write!(f, "a number from {least} to {most}"),
            Self::Count { least, most } => write!(f, "a whole number from {least} to {most}"),
            Self::Choice(words) => write!(f, "one of {}", listed(words)),
            Self::Choices(words) => write!(f, "a list of any of {}", listed(words)),
            Self::Text => f.write_str("a text in quotes"),
            Self::Texts => f.write_str("a text in quotes, or a list of texts"),
            Self::Flag => f.write_str("true or false"),
            Self::PositiveOr(words) => {
                write!(f, "a finite number above 0, or one of {}", listed(words))
            }
            Self::CountOr { least, most, words } => write!(
                f,
                "a whole number from {least} to {most}, or one of {}",
                listed(words)
            ),
            Self::Rows(parameters) => {
                let names: Vec<&str> = parameters.iter().map(|p| p.name).collect();
                write!(f, "a list of tables with {}", listed(&names))
            }
        }
    }
}

/// Words as they are typed, separated by commas.
pub fn listed<S: AsRef<str>>(words: &[S]) -> String {
    words
        .iter()
        .map(|word| format!("`{}`", word.as_ref()))
        .collect::<Vec<_>>()
        .join(", ")
}

/// What holds when a parameter is not given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Absent {
    /// It must be given.
    Required,
    /// This number.
    Number(f64),
    /// This word.
    Word(&'static str),
    /// This flag.
    Flag(bool),
    /// Nothing: the thing decides by itself, as its help says.
    Unset,
}

/// What the numbers of a parameter measure: how they follow when the data are written in another unit or from another origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Neither: counts, shares, exponents.
    Pure,
    /// A length on the axis of the data: stretched with them.
    Length,
    /// A place on the axis of the data: stretched and moved with them.
    Place,
}

/// One parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its name, in kebab-case.
    pub name: &'static str,
    /// What values it takes.
    pub kind: Kind,
    /// What holds when it is not given.
    pub absent: Absent,
    /// Whether a list of values may be given instead of one, for a sweep.
    pub sweeps: bool,
    /// What becomes of its numbers when the data are moved or stretched.
    pub unit: Unit,
    /// The number of dimensions in which it has a meaning, if not in all. Such a parameter has no default.
    pub only: Option<usize>,
    /// What it means, its unit included.
    pub help: &'static str,
}

impl Parameter {
    /// A parameter that must be given.
    pub const fn required(name: &'static str, kind: Kind, help: &'static str) -> Self {
        Self {
            name,
            kind,
            absent: Absent::Required,
            sweeps: false,
            unit: Unit::Pure,
            only: None,
            help,
        }
    }

    /// A parameter with a default.
    pub const fn optional(
        name: &'static str,
        kind: Kind,
        absent: Absent,
        help: &'static str,
    ) -> Self {
        Self {
            name,
            kind,
            absent,
            sweeps: false,
            unit: Unit::Pure,
            only: None,
            help,
        }
    }

    /// The same, its numbers being lengths on the axis of the data.
    pub const fn length(self) -> Self {
        Self {
            unit: Unit::Length,
            ..self
        }
    }

    /// The same, its numbers being places on the axis of the data.
    pub const fn place(self) -> Self {
        Self {
            unit: Unit::Place,
            ..self
        }
    }

    /// The same, with a meaning in so many dimensions only.
    pub const fn only_in(self, dimensions: usize) -> Self {
        Self {
            only: Some(dimensions),
            ..self
        }
    }

    /// The same, allowing a list for a sweep.
    pub const fn swept(self) -> Self {
        Self {
            sweeps: true,
            ..self
        }
    }
}

/// The one of `allowed` that `word` was probably meant to be, for "did you mean".
///
/// Few edits (a swap of neighbours is one) compared with the length, whatever the case, or a beginning that fits one only; nothing rather than
/// a wild guess.
pub fn nearest<'a>(word: &str, allowed: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Nobody mistypes a paragraph, and comparing costs the product of the lengths.
    const LONGEST: usize = 100;
    let plain = |word: &str| word.trim().to_lowercase().replace('_', "-");
    if word.trim().is_empty() || word.len() > LONGEST {
        return None;
    }
    let word = plain(word);
    let mut best: Option<(usize, &str)> = None;
    let mut beginning = Vec::new();
    for candidate in allowed {
        let lower = plain(candidate);
        let edits = strsim::damerau_levenshtein(&word, &lower);
        let longest = word.chars().count().max(lower.chars().count());
        if 3 * edits <= longest && best.is_none_or(|(least, _)| edits < least) {
            best = Some((edits, candidate));
        }
        if word.chars().count() >= 3 && lower.starts_with(&word) {
            beginning.push(candidate);
        }
    }
    match (best, &beginning[..]) {
        (Some((_, candidate)), _) => Some(candidate),
        (None, [only]) => Some(only),
        _ => None,
    }
}

/// A checked value.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A number of any numeric kind.
    Number(f64),
    /// A whole number.
    Count(u64),
    /// A word.
    Word(String),
    /// A flag.
    Flag(bool),
    /// Words or texts.
    Words(Vec<String>),
    /// Rows of further values.
    Rows(Vec<Values>),
}

/// Checked values by name: every required parameter is there, every value is of its kind, defaults are filled in.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Values(BTreeMap<&'static str, Value>);

impl Values {
    /// Sets a value; for whoever reads and checks.
    pub fn set(&mut self, name: &'static str, value: Value) {
        self.0.insert(name, value);
    }

    /// All defaults of `parameters` that are values.
    pub fn defaults(parameters: &[Parameter]) -> Self {
        let mut values = Self::default();
        for parameter in parameters {
            match parameter.absent {
                Absent::Number(x) if matches!(parameter.kind.numeric(), Kind::Count { .. }) => {
                    values.set(parameter.name, Value::Count(x as u64));
                }
                Absent::Number(x) => values.set(parameter.name, Value::Number(x)),
                Absent::Word(word) => values.set(parameter.name, Value::Word(word.to_owned())),
                Absent::Flag(flag) => values.set(parameter.name, Value::Flag(flag)),
                Absent::Required | Absent::Unset => {}
            }
        }
        values
    }

    /// The value of that name, if set.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.0.get(name)
    }

    /// All values in the order of their names.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.0.iter().map(|(name, value)| (*name, value))
    }

    /// A number, if set as one.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.get(name) {
            Some(Value::Number(x)) => Some(*x),
            Some(Value::Count(x)) => Some(*x as f64),
            _ => None,
        }
    }

    /// A whole number, if set as one.
    pub fn count(&self, name: &str) -> Option<u64> {
        match self.get(name) {
            Some(Value::Count(x)) => Some(*x),
            _ => None,
        }
    }

    /// A word, if set as one.
    pub fn word(&self, name: &str) -> Option<&str> {
        match self.get(name) {
            Some(Value::Word(word)) => Some(word),
            _ => None,
        }
    }

    /// A flag, if set as one.
    pub fn flag(&self, name: &str) -> Option<bool> {
        match self.get(name) {
            Some(Value::Flag(flag)) => Some(*flag),
            _ => None,
        }
    }

    /// Words or texts, if set.
    pub fn words(&self, name: &str) -> &[String] {
        match self.get(name) {
            Some(Value::Words(words)) => words,
            _ => &[],
        }
    }

    /// Rows, if set.
    pub fn rows(&self, name: &str) -> &[Values] {
        match self.get(name) {
            Some(Value::Rows(rows)) => rows,
            _ => &[],
        }
    }
}

/// Why a thing could not be built from values that are each legal.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}")]
pub struct BuildError {
    /// The parameter at fault.
    pub parameter: &'static str,
    /// What is wrong and what would be right.
    pub what: String,
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn slips_are_understood_and_wild_guesses_are_not_made() {
        let allowed = ["gaussian", "epanechnikov", "uniform", "h", "width"];
        for (word, meant) in [
            ("gausian", Some("gaussian")),
            ("Gaussian", Some("gaussian")),
            ("epan", Some("epanechnikov")),
            ("unifrom", Some("uniform")),
            ("widht", Some("width")),
            ("quartic", None),
            ("", None),
            (&"gaussian".repeat(1000), None),
        ] {
            assert_eq!(nearest(word, allowed), meant, "{word}");
        }
    }
}
