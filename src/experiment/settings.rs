//! Settings of an estimator that differ in what they do: what the law suite tries, and what `lab list` reads promises from.

use super::catalogue::{Builds, Entry};
use crate::engine;
use crate::estimator::{Context, Laws};
use crate::parameter::{Absent, Kind, Parameter, Value, Values};

/// Values of `parameter` in `D` dimensions that are worth trying; irrational enough to keep edges of bins away from data that have few binary digits. None for
/// texts, which only programs from outside take.
pub fn tried<const D: usize>(parameter: &Parameter) -> Vec<Value> {
    let numbers =
        |numbers: &[f64]| -> Vec<Value> { numbers.iter().map(|&x| Value::Number(x)).collect() };
    let words = |words: &[&str]| -> Vec<Value> {
        words.iter().map(|&w| Value::Word(w.to_owned())).collect()
    };
    let counts = |least: u64, most: u64, far: u64| -> Vec<Value> {
        let mut counts = vec![least, least + 6, most.min(far)];
        counts.retain(|count| *count <= most);
        counts.dedup();
        counts.into_iter().map(Value::Count).collect()
    };
    match parameter.name {
        "engine" => {
            let engines: Vec<&str> = if D == 1 {
                engine::LINE.iter().map(|engine| engine.name()).collect()
            } else {
                engine::PLANE.iter().map(|engine| engine.name()).collect()
            };
            return words(&[&["auto"], engines.as_slice()].concat());
        }
        // how far an approximate engine may be off is judged by the laws of engines
        "tolerance" => return numbers(&[1e-12, 1e-11]),
        "max" => return vec![Value::Count(12), Value::Count(60)],
        // small samples must have as many points
        "k" | "min" => return vec![Value::Count(2), Value::Count(5)],
        // a window narrower than most data, with few binary digits, so that moving it is exact
        "low" => return numbers(&[WINDOW[0]]),
        "high" => return numbers(&[WINDOW[1]]),
        _ => {}
    }
    match parameter.kind {
        Kind::Real => numbers(&[0.0, -157.0 / 256.0]),
        Kind::Positive => numbers(&[0.371_73, 1.717_3]),
        Kind::Fraction => numbers(&[0.0, 0.5, 1.0]),
        Kind::Count { least, most } => counts(least, most, 100),
        Kind::Choice(choices) => words(choices),
        Kind::Flag => vec![Value::Flag(false), Value::Flag(true)],
        Kind::PositiveOr(choices) => {
            let mut values = numbers(&[0.371_73, 1.717_3]);
            values.extend(words(choices));
            values
        }
        Kind::CountOr {
            least,
            most,
            words: choices,
        } => {
            let mut values = counts(least, most, if D == 1 { 40 } else { 12 });
            values.extend(words(choices));
            values
        }
        Kind::Range(least, most) => numbers(&[least, 0.5 * (least + most), most]),
        Kind::Between(low, high) => numbers(&[low + 0.3 * (high - low), low + 0.9 * (high - low)]),
        Kind::Text | Kind::Texts | Kind::Choices(_) | Kind::Rows(_) => Vec::new(),
    }
}

/// The interval tried for what lives on one, on each axis.
pub const WINDOW: [f64; 2] = [-589.0 / 256.0, 695.0 / 256.0];

/// Whether a parameter decides what a result costs, not what it is.
fn only_costs(parameter: &Parameter) -> bool {
    matches!(parameter.name, "engine" | "tolerance")
}

/// For each value of what decides the smoothing, the defaults and the defaults with one other parameter varied at a time; only what can be built in `D`
/// dimensions when `context` is known.
pub fn settings<const D: usize>(entry: &Entry, context: &Context<D>) -> Vec<Values>
where
    Entry: Builds<D>,
{
    if Builds::<D>::builder(entry).is_none() {
        return Vec::new();
    }
    let here = |parameter: &&Parameter| parameter.only.is_none_or(|only| only == D);
    let parameters: Vec<&Parameter> = entry.parameters.iter().filter(here).collect();
    let mut plain = Values::defaults(entry.parameters);
    for parameter in &parameters {
        let wanted = parameter.absent == Absent::Required
            && Some(parameter.name) != entry.smoothing
            || matches!(parameter.name, "low" | "high");
        if let (true, Some(value)) = (wanted, tried::<D>(parameter).first()) {
            plain.set(parameter.name, value.clone());
        }
    }
    let smoothing = parameters
        .iter()
        .find(|parameter| Some(parameter.name) == entry.smoothing);
    let bases: Vec<Values> = match smoothing {
        None => vec![plain],
        Some(smoothing) => tried::<D>(smoothing)
            .into_iter()
            .map(|value| {
                let mut base = plain.clone();
                base.set(smoothing.name, value);
                base
            })
            .collect(),
    };
    let buildable = |values: &Values| Builds::<D>::build(entry, values, context).is_ok();
    let mut all: Vec<Values> = Vec::new();
    let mut add = |values: Values| {
        if !all.contains(&values) && buildable(&values) {
            all.push(values);
        }
    };
    let mut varied_under_a_rule = false;
    for (number, base) in bases.into_iter().enumerate() {
        add(base.clone());
        let value = entry.smoothing.and_then(|name| base.get(name));
        // many rules choose the same parameter: all are tried, the others are varied under one of them
        if matches!(value, Some(Value::Word(_))) {
            if varied_under_a_rule || !buildable(&base) {
                continue;
            }
            varied_under_a_rule = true;
        }
        // everything that the data decide by default, decided
        let mut told = base.clone();
        for parameter in &parameters {
            if parameter.absent == Absent::Unset
                && base.get(parameter.name).is_none()
                && let Some(value) = tried::<D>(parameter).first()
            {
                told.set(parameter.name, value.clone());
            }
        }
        add(told);
        for parameter in &parameters {
            if Some(parameter.name) == entry.smoothing || (number > 0 && only_costs(parameter)) {
                continue;
            }
            for value in tried::<D>(parameter) {
                let mut varied = base.clone();
                varied.set(parameter.name, value);
                add(varied);
            }
        }
    }
    all
}

/// How an estimator stands to one law over all its [`settings`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Promise {
    /// The law, as in [`Laws::NAMES`].
    pub law: &'static str,
    /// Whether it holds with the first settings tried: a number for the smoothing and defaults for the rest.
    pub holds: bool,
    /// The parameters that change this, each with its values that do, as a file writes them.
    pub unless: Vec<(&'static str, Vec<String>)>,
}

/// What the estimator promises in `D` dimensions, law by law; empty where it does not exist.
pub fn promises<const D: usize>(entry: &Entry) -> Vec<Promise>
where
    Entry: Builds<D>,
{
    let context = Context {
        truth: None,
        draws: 100,
    };
    let all: Vec<(Values, [bool; 10])> = settings(entry, &context)
        .into_iter()
        .filter_map(|values| {
            let built = Builds::<D>::build(entry, &values, &context).ok()?;
            Some((values, built.laws().all()))
        })
        .collect();
    let Some((plain, usual)) = all.first() else {
        return Vec::new();
    };
    (0..usual.len())
        .map(|law| Promise {
            law: Laws::NAMES[law],
            holds: usual[law],
            unless: entry
                .parameters
                .iter()
                .filter_map(|parameter| {
                    let values = changing(parameter, plain, &all, |laws| laws[law] != usual[law]);
                    (!values.is_empty()).then_some((parameter.name, values))
                })
                .collect(),
        })
        .collect()
}

/// The values of `parameter` that alone change a promise.
fn changing(
    parameter: &Parameter,
    plain: &Values,
    all: &[(Values, [bool; 10])],
    changes: impl Fn(&[bool; 10]) -> bool,
) -> Vec<String> {
    let others = |values: &Values| -> Vec<(&'static str, Value)> {
        let others = values.iter().filter(|(name, _)| *name != parameter.name);
        others.map(|(name, value)| (name, value.clone())).collect()
    };
    let alone = |values: &Values| {
        (others(values) == others(plain))
            .then(|| values.get(parameter.name).cloned())
            .flatten()
    };
    let mut seen = Vec::new();
    let mut kept_by_a_word = false;
    for (values, laws) in all {
        if let Some(value) = alone(values) {
            if changes(laws) {
                seen.push(value);
            } else {
                kept_by_a_word |= matches!(value, Value::Word(_));
            }
        }
    }
    let rules = seen
        .iter()
        .filter(|value| matches!(value, Value::Word(_)))
        .count();
    if rules == seen.len() && rules > 2 && !kept_by_a_word {
        // a rule instead of the number
        return vec!["a rule".to_owned()];
    }
    seen.iter()
        .map(|value| match value {
            Value::Number(x) => x.to_string(),
            Value::Count(count) => count.to_string(),
            Value::Word(word) => word.clone(),
            Value::Flag(flag) => flag.to_string(),
            Value::Words(words) => words.join(" "),
            Value::Rows(_) => "rows".to_owned(),
        })
        .collect()
}
