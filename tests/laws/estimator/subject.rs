//! Who is tried: the estimators of the catalogue in several settings.

use density_lab::density::{Density, NormalComponent, NormalMixture};
use density_lab::estimator::{Context, Estimator};
use density_lab::experiment::catalogue::{Builds, ESTIMATORS, Entry};
use density_lab::experiment::settings::{settings, tried};
use density_lab::parameter::{Unit, Value, Values};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Makes an estimator for data x ↦ scale · x + shift (the same on each axis).
type Make<const D: usize> = Box<dyn Fn(f64, f64) -> Box<dyn Estimator<D>> + Send + Sync>;

/// An estimator that can be had again for data that were stretched and moved.
#[expect(clippy::struct_excessive_bools, reason = "a list of facts")]
pub struct Subject<const D: usize> {
    /// Its kind and settings.
    pub name: String,
    /// Whether its width is the place of a minimum, which a search finds only to √ε.
    pub searched: bool,
    /// Whether its width depends on a truth and on the size of the sample.
    pub oracle: bool,
    /// Whether what decides the smoothing is a length on the axis of the data, and not a number of terms or neighbours.
    pub by_length: bool,
    /// Whether only the way of computing differs from that of another subject.
    pub computed_otherwise: bool,
    make: Make<D>,
    /// What was made already: an oracle takes its time.
    made: Mutex<BTreeMap<[u64; 2], Arc<dyn Estimator<D>>>>,
}

impl<const D: usize> Subject<D> {
    pub fn new(name: String, make: Make<D>) -> Self {
        Self {
            name,
            searched: false,
            oracle: false,
            by_length: true,
            computed_otherwise: false,
            make,
            made: Mutex::default(),
        }
    }

    pub fn plain(&self) -> Arc<dyn Estimator<D>> {
        self.moved(1.0, 0.0)
    }

    /// The same estimator for data x ↦ scale · x + shift.
    pub fn moved(&self, scale: f64, shift: f64) -> Arc<dyn Estimator<D>> {
        let key = [scale.to_bits(), shift.to_bits()];
        let known = self.made.lock().unwrap().get(&key).cloned();
        // made without holding the lock, so that whatever it does with threads cannot come back to it
        known.unwrap_or_else(|| {
            let new: Arc<dyn Estimator<D>> = (self.make)(scale, shift).into();
            self.made.lock().unwrap().entry(key).or_insert(new).clone()
        })
    }

    /// Built anew.
    pub fn fresh(&self) -> Box<dyn Estimator<D>> {
        (self.make)(1.0, 0.0)
    }
}

/// Every estimator of the catalogue with each of its settings that is worth trying.
pub fn catalogue<const D: usize>() -> Vec<Subject<D>>
where
    Entry: Builds<D>,
{
    // a program promises nothing; it has tests of its own
    let ours =
        |entry: &&'static Entry| Builds::<D>::builder(*entry).is_some() && entry.name != "command";
    ESTIMATORS
        .iter()
        .filter(ours)
        .flat_map(|entry| {
            for parameter in entry.parameters {
                assert!(
                    parameter.only.is_some_and(|only| only != D)
                        || !tried::<D>(parameter).is_empty(),
                    "teach the suite what to try for {} of {}",
                    parameter.name,
                    entry.name
                );
            }
            let all = settings::<D>(entry, &context(1.0, 0.0));
            assert!(!all.is_empty(), "{}", entry.name);
            all.into_iter().map(|values| subject(entry, values))
        })
        .collect()
}

/// Whether an expectation is owed: the width is a number of the file, and the estimate is linear in the data.
pub fn fixed<const D: usize>(subject: &Subject<D>) -> bool {
    !subject.oracle && subject.plain().laws().linear
}

fn subject<const D: usize>(entry: &'static Entry, values: Values) -> Subject<D>
where
    Entry: Builds<D>,
{
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
        "lscv-common",
        "ucv",
        "bcv",
        "likelihood-cross-validation",
        "k-fold-likelihood",
        "oracle-ise",
    ];
    let searched = oracle || says("truth") || by_search.into_iter().any(says);
    let computed_otherwise = values.word("engine").is_some_and(|word| word != "auto")
        || values
            .number("tolerance")
            .is_some_and(|tolerance| tolerance > 1e-12);
    let by_length = entry
        .parameters
        .iter()
        .any(|parameter| Some(parameter.name) == entry.smoothing && parameter.unit == Unit::Length);
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
            Builds::<D>::build(entry, &moved, &context(scale, shift))
                .unwrap_or_else(|error| panic!("{}: {error}", entry.name))
        }),
    );
    Subject {
        searched,
        oracle,
        by_length,
        computed_otherwise,
        ..subject
    }
}

/// What an oracle is told: on the line a normal truth that is stretched and moved with the data. In the plane there is none, and settings that need one are left
/// out.
fn context<const D: usize>(scale: f64, shift: f64) -> Context<D> {
    let component = NormalComponent {
        weight: 1.0,
        mean: shift + 0.1 * scale,
        deviation: 1.3 * scale,
    };
    let truth: Arc<dyn Density<1>> = Arc::new(NormalMixture::new(vec![component]).unwrap());
    let truth: Box<dyn std::any::Any> = Box::new(truth);
    Context {
        truth: truth.downcast_ref::<Arc<dyn Density<D>>>().cloned(),
        draws: 20,
    }
}
