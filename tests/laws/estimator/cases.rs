//! What is tried: estimators in several settings, and data of several kinds.

use density_lab::density::{NormalComponent, NormalMixture};
use density_lab::estimator::{Context, Estimator};
use density_lab::experiment::catalogue::{Builds, ESTIMATORS, Entry};
use density_lab::parameter::{Absent, Kind, Parameter, Unit, Value, Values};
use density_lab::sample::{Sample, Weights};
use density_lab::space::Domain;
use proptest::collection::vec;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Makes an estimator for data x ↦ scale · x + shift.
type Make = Box<dyn Fn(f64, f64) -> Box<dyn Estimator<1>> + Send + Sync>;

/// An estimator that can be had again for data that were stretched and moved.
pub struct Subject {
    /// Its kind and settings.
    pub name: String,
    /// Whether its width is the place of a minimum, which a search finds only to √ε.
    pub searched: bool,
    /// Whether its width depends on a truth and on the size of the sample.
    pub oracle: bool,
    /// Whether what decides the smoothing is a length on the axis of the data, and not a number of terms or neighbours.
    pub by_length: bool,
    make: Make,
    /// What was made already: an oracle takes its time.
    made: Mutex<BTreeMap<[u64; 2], Arc<dyn Estimator<1>>>>,
}

impl Subject {
    pub fn new(name: String, make: Make) -> Self {
        Self {
            name,
            searched: false,
            oracle: false,
            by_length: true,
            make,
            made: Mutex::default(),
        }
    }

    pub fn plain(&self) -> Arc<dyn Estimator<1>> {
        self.moved(1.0, 0.0)
    }

    /// The same estimator for data x ↦ scale · x + shift.
    pub fn moved(&self, scale: f64, shift: f64) -> Arc<dyn Estimator<1>> {
        let key = [scale.to_bits(), shift.to_bits()];
        let known = self.made.lock().unwrap().get(&key).cloned();
        // made without holding the lock, so that whatever it does with threads cannot come back to it
        known.unwrap_or_else(|| {
            let new: Arc<dyn Estimator<1>> = (self.make)(scale, shift).into();
            self.made.lock().unwrap().entry(key).or_insert(new).clone()
        })
    }

    /// Built anew.
    pub fn fresh(&self) -> Box<dyn Estimator<1>> {
        (self.make)(1.0, 0.0)
    }
}

/// Every estimator of the catalogue: for each value of what decides the smoothing, the defaults with one other parameter varied at a time.
pub fn catalogue() -> Vec<Subject> {
    // a program promises nothing; it has tests of its own
    let on_a_line = |entry: &&'static Entry| entry.line.is_some() && entry.name != "command";
    ESTIMATORS
        .iter()
        .filter(on_a_line)
        .flat_map(settings)
        .collect()
}

/// Whether an expectation is owed: the width is a number of the file, and the estimate is linear in the data.
pub fn fixed(subject: &Subject) -> bool {
    !subject.oracle && subject.plain().laws().linear
}

fn settings(entry: &'static Entry) -> Vec<Subject> {
    let mut all = Vec::new();
    let smoothing = entry.smoothing.map(|name| {
        entry
            .parameters
            .iter()
            .find(|parameter| parameter.name == name)
            .unwrap()
    });
    let mut bases = vec![Values::defaults(entry.parameters)];
    for parameter in entry.parameters {
        if parameter.absent == Absent::Required && Some(parameter.name) != entry.smoothing {
            bases[0].set(parameter.name, tried(parameter)[0].clone());
        }
    }
    for parameter in entry.parameters {
        // a window narrower than most data; without one there is no estimate on the whole line
        if matches!(parameter.name, "low" | "high") {
            bases[0].set(parameter.name, tried(parameter)[0].clone());
        }
    }
    if let Some(smoothing) = smoothing {
        bases = tried(smoothing)
            .into_iter()
            .map(|value| {
                let mut base = bases[0].clone();
                base.set(smoothing.name, value);
                base
            })
            .collect();
    }
    let mut rules = 0;
    for base in bases {
        all.push(base.clone());
        // many rules choose the same parameter: all are tried, the other parameters are varied under one of them
        let smoothing = entry.smoothing.and_then(|name| base.get(name));
        if matches!(smoothing, Some(Value::Word(_))) {
            rules += 1;
            if rules > 1 {
                continue;
            }
        }
        // everything that the data decide by default, decided
        let mut told = base.clone();
        for parameter in entry.parameters {
            if parameter.absent == Absent::Unset && parameter.only.is_none_or(|only| only == 1) {
                told.set(parameter.name, tried(parameter)[0].clone());
            }
        }
        if told != base {
            all.push(told);
        }
        for parameter in entry.parameters {
            if Some(parameter.name) == entry.smoothing
                || parameter.only.is_some_and(|only| only != 1)
            {
                continue;
            }
            for value in tried(parameter) {
                if base.get(parameter.name) != Some(&value) {
                    let mut varied = base.clone();
                    varied.set(parameter.name, value);
                    all.push(varied);
                }
            }
        }
    }
    all.into_iter()
        .map(|values| subject(entry, values))
        .collect()
}

/// Values of a parameter that are worth trying; irrational enough to keep edges of bins away from data that have few binary digits.
fn tried(parameter: &Parameter) -> Vec<Value> {
    let numbers =
        |numbers: &[f64]| -> Vec<Value> { numbers.iter().map(|&x| Value::Number(x)).collect() };
    let words = |words: &[&str]| -> Vec<Value> {
        words.iter().map(|&w| Value::Word(w.to_owned())).collect()
    };
    if parameter.name == "engine" {
        // those of the plane are judged by the laws of engines
        let names: Vec<&str> = density_lab::engine::LINE.iter().map(|e| e.name()).collect();
        return words(&[&["auto"], names.as_slice()].concat());
    }
    if parameter.name == "tolerance" {
        // how far an approximate engine may be off is judged by the laws of engines
        return numbers(&[1e-12, 1e-11]);
    }
    if parameter.name == "min" {
        return vec![Value::Count(2), Value::Count(5)];
    }
    if parameter.name == "max" {
        return vec![Value::Count(12), Value::Count(60)];
    }
    if parameter.name == "k" {
        // the data have from three points on; what is more than that is refused
        return vec![Value::Count(2), Value::Count(5)];
    }
    match parameter.name {
        // with few binary digits, so that moving them is exact
        "low" => return numbers(&[-589.0 / 256.0]),
        "high" => return numbers(&[695.0 / 256.0]),
        _ => {}
    }
    match parameter.kind {
        Kind::Real => numbers(&[0.0, -157.0 / 256.0]),
        Kind::Positive => numbers(&[0.371_73, 1.717_3]),
        Kind::Fraction => numbers(&[0.0, 0.5, 1.0]),
        Kind::Count { least, most } => [least, least + 6, most.min(100)]
            .into_iter()
            .filter(|count| *count <= most)
            .map(Value::Count)
            .collect(),
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
            let mut values: Vec<Value> = [least, least + 6, most.min(40)]
                .into_iter()
                .filter(|count| *count <= most)
                .map(Value::Count)
                .collect();
            values.extend(words(choices));
            values
        }
        Kind::Range(least, most) => numbers(&[least, 0.5 * (least + most), most]),
        Kind::Between(low, high) => numbers(&[low + 0.3 * (high - low), low + 0.9 * (high - low)]),
        Kind::Text | Kind::Texts | Kind::Choices(_) | Kind::Rows(_) => {
            panic!("teach the suite what to try for {}", parameter.name)
        }
    }
}

fn subject(entry: &'static Entry, values: Values) -> Subject {
    let shown: Vec<String> = values
        .iter()
        .map(|(name, value)| format!("{name} = {value:?}"))
        .collect();
    let says = |word: &str| {
        values
            .iter()
            .any(|(_, value)| *value == Value::Word(word.to_owned()))
    };
    let oracle = says("oracle");
    // integrals over a truth lose digits far from zero, as searches do
    let by_search = [
        "lscv",
        "ucv",
        "bcv",
        "likelihood-cross-validation",
        "k-fold-likelihood",
        "oracle-ise",
    ];
    let searched = oracle || says("truth") || by_search.into_iter().any(says);
    let subject = Subject::new(
        format!("{} {{ {} }}", entry.name, shown.join(", ")),
        Box::new(move |scale, shift| {
            let mut moved = values.clone();
            for parameter in entry.parameters {
                if let Some(Value::Number(x)) = values.get(parameter.name) {
                    let there = match parameter.unit {
                        Unit::Pure => *x,
                        Unit::Length => scale * x,
                        Unit::Place => scale * x + shift,
                    };
                    moved.set(parameter.name, Value::Number(there));
                }
            }
            entry
                .build(&moved, &context(scale, shift))
                .unwrap_or_else(|error| panic!("{}: {error}", entry.name))
        }),
    );
    let by_length = entry
        .parameters
        .iter()
        .any(|parameter| Some(parameter.name) == entry.smoothing && parameter.unit == Unit::Length);
    Subject {
        searched,
        oracle,
        by_length,
        ..subject
    }
}

/// What an oracle is told: a normal truth that is stretched and moved with the data.
pub fn context(scale: f64, shift: f64) -> Context<1> {
    let component = NormalComponent {
        weight: 1.0,
        mean: shift + 0.1 * scale,
        deviation: 1.3 * scale,
    };
    Context {
        truth: Some(Arc::new(NormalMixture::new(vec![component]).unwrap())),
        draws: 20,
    }
}

/// A data set with places to look at.
#[derive(Clone, Debug)]
pub struct Data {
    pub points: Vec<f64>,
    /// Whole numbers from 1.
    pub weights: Vec<u32>,
    pub targets: Vec<f64>,
    /// Something to choose by.
    pub choice: usize,
}

/// What data a law is tried on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// At least three points in general position.
    General,
    /// From one point on, also tied, on lattices that share places with the edges of bins, and in clusters.
    Any,
    /// One point, or several at one place.
    OnePlace,
}

/// A number with 20 binary digits after the point, so that adding 10⁹ or multiplying by a power of two is exact.
fn place(low: f64, high: f64) -> impl Strategy<Value = f64> {
    let unit = f64::from(1 << 20);
    ((low * unit) as i64..(high * unit) as i64).prop_map(move |k| k as f64 / unit)
}

pub fn data(sort: Sort) -> BoxedStrategy<Data> {
    let general = || vec(place(-3.0, 3.0), 3..24).boxed();
    let points = match sort {
        Sort::General => general(),
        Sort::Any => prop_oneof![
            4 => general(),
            1 => vec(place(-3.0, 3.0), 1..3),
            2 => vec((-8i32..8).prop_map(f64::from), 2..24),
            2 => vec((-30i32..30).prop_map(|k| f64::from(k) * 0.1), 2..24),
            // edges of bins of the width that is tried
            2 => vec((-8i32..8).prop_map(|k| f64::from(k) * 0.371_73), 2..24),
            1 => (vec(place(-0.01, 0.01), 2..12), vec(place(900.0, 901.0), 1..3)).prop_map(|(near, far)| [near, far].concat()),
        ]
        .boxed(),
        Sort::OnePlace => (place(-3.0, 3.0), 1usize..9, prop_oneof![Just(0.0), Just(1e9), Just(1e-9)])
            .prop_map(|(x, n, offset)| vec![x + offset; n])
            .boxed(),
    };
    (points, 0usize..1000)
        .prop_flat_map(|(points, choice)| {
            let n = points.len();
            let (low, high) = span(&points);
            (
                Just(points),
                vec(1u32..5, n),
                vec(place(low - 3.0, high + 3.0), 24),
                Just(choice),
            )
        })
        .prop_map(|(points, weights, mut targets, choice)| {
            targets.extend(&points);
            Data {
                points,
                weights,
                targets,
                choice,
            }
        })
        .boxed()
}

pub fn span(points: &[f64]) -> (f64, f64) {
    points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| {
            (low.min(x), high.max(x))
        })
}

/// A sample of `points` with `weights` as they are.
pub fn weighted(points: &[f64], weights: Vec<f64>) -> Sample<1> {
    let points = points.iter().map(|&x| [x]).collect();
    Sample::new(points, Weights::Each(weights.into()), Domain::whole()).unwrap()
}

/// A sample of `points`, 1/n each.
pub fn equal(points: &[f64]) -> Sample<1> {
    Sample::equal(points.iter().map(|&x| [x]).collect(), Domain::whole()).unwrap()
}

impl Data {
    /// With the weights of the data, of mass 1.
    pub fn sample(&self) -> Sample<1> {
        let total: u32 = self.weights.iter().sum();
        weighted(
            &self.points,
            self.weights
                .iter()
                .map(|&w| f64::from(w) / f64::from(total))
                .collect(),
        )
    }
}
