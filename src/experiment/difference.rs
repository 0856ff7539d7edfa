//! What two runs found, compared: paired where both saw the same samples.

use crate::accuracy::{Interval, compare, mean_interval, sidak};
use crate::storage::{self, StorageError};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// The columns of `replicates.csv` that are compared, with the names of their means.
const MEASURES: [(&str, &str); 6] = [
    ("ise", "mise"),
    ("iae", "miae"),
    ("ire", "mire"),
    ("integral", "integral"),
    ("modes", "modes"),
    ("smoothing", "smoothing"),
];

/// The names of what is compared.
pub const NAMES: [&str; 6] = ["mise", "miae", "mire", "integral", "modes", "smoothing"];

/// Why two folders cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum DifferenceError {
    /// A file cannot be read.
    #[error(transparent)]
    Storage(#[from] StorageError),
    /// A folder is not that of a finished run.
    #[error("{folder}: {what}")]
    NotARun {
        /// Which.
        folder: String,
        /// What is missing or wrong.
        what: String,
    },
    /// Nothing is in both.
    #[error(
        "the two runs have no source, sample size and estimator in common; estimators are matched by name.\nA: {a}\nB: {b}"
    )]
    NothingInCommon {
        /// What is in the first.
        a: String,
        /// What is in the second.
        b: String,
    },
}

/// Which numbers belong together: source, sample size, estimator.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Key {
    /// The source.
    pub source: String,
    /// The sample size.
    pub n: usize,
    /// The estimator.
    pub estimator: String,
}

/// How a comparison came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The same numbers, replicate by replicate, to within the tolerance.
    Same,
    /// The interval of the difference holds zero: not told apart.
    Open,
    /// It does not.
    Differs,
}

/// One comparison.
#[derive(Clone, Debug, Serialize)]
pub struct Difference {
    /// Of what.
    #[serde(flatten)]
    pub key: Key,
    /// Which measure.
    pub measure: &'static str,
    /// The mean in A.
    pub a: f64,
    /// The mean in B.
    pub b: f64,
    /// B - A.
    pub difference: f64,
    /// Its standard error; nothing for a single replicate.
    pub standard_error: Option<f64>,
    /// The lower end of its simultaneous interval.
    pub low: Option<f64>,
    /// The upper end.
    pub high: Option<f64>,
    /// Whether replicates were compared one by one, as both runs saw the same samples.
    pub paired: bool,
    /// Replicates that were compared: of A and of B.
    pub replicates: [usize; 2],
    /// How it came out.
    pub verdict: Verdict,
}

/// Everything that two runs have in common, and what they have not.
#[derive(Debug, Serialize)]
pub struct Differences {
    /// The comparisons.
    pub rows: Vec<Difference>,
    /// What only the first has.
    pub only_a: Vec<Key>,
    /// What only the second has.
    pub only_b: Vec<Key>,
    /// Why replicates were not paired, where they were not.
    pub remarks: Vec<String>,
    /// The simultaneous confidence of the intervals.
    pub confidence: f64,
}

#[derive(Deserialize)]
struct Manifest {
    random_generator: String,
    experiment: Value,
}

/// The numbers of one run.
struct Run {
    manifest: Manifest,
    /// The replicates of each measure.
    numbers: BTreeMap<Key, [Vec<Option<f64>>; MEASURES.len()]>,
}

impl Run {
    fn read(folder: &Path) -> Result<Self, DifferenceError> {
        let wrong = |what: String| DifferenceError::NotARun {
            folder: folder.display().to_string(),
            what,
        };
        let path = folder.join("manifest.json");
        if folder.is_dir() && !path.exists() {
            return Err(wrong(
                "not the folder of a finished run: it has no manifest.json".to_owned(),
            ));
        }
        let manifest: Manifest = serde_json::from_slice(&storage::read(&path)?)
            .map_err(|error| wrong(format!("manifest.json is not one of this program: {error}")))?;
        let bytes = storage::read(&folder.join("tables").join("replicates.csv"))?;
        let mut file = csv::Reader::from_reader(&bytes[..]);
        let damaged = |what: &str| wrong(format!("tables/replicates.csv {what}"));
        let heads = file
            .headers()
            .map_err(|_| damaged("has no header"))?
            .clone();
        let column = |name: &str| {
            let place = heads.iter().position(|head| head == name);
            place.ok_or_else(|| damaged(&format!("has no column `{name}`")))
        };
        let names = [column("source")?, column("n")?, column("estimator")?];
        let mut places = [0; MEASURES.len()];
        for (place, (name, _)) in places.iter_mut().zip(MEASURES) {
            *place = column(name)?;
        }
        let mut numbers: BTreeMap<Key, [Vec<Option<f64>>; MEASURES.len()]> = BTreeMap::new();
        for (line, row) in file.records().enumerate() {
            let at = format!("is damaged in row {}", line + 2);
            let row = row.map_err(|_| damaged(&at))?;
            let key = Key {
                source: row[names[0]].to_owned(),
                n: row[names[1]].parse().map_err(|_| damaged(&at))?,
                estimator: row[names[2]].to_owned(),
            };
            let lists = numbers.entry(key).or_default();
            for (list, place) in lists.iter_mut().zip(places) {
                let text = &row[place];
                list.push(match text {
                    "" => None,
                    text => Some(text.parse().map_err(|_| damaged(&at))?),
                });
            }
        }
        Ok(Self { manifest, numbers })
    }

    /// What a source is, whatever else its run does.
    fn source(&self, name: &str) -> Option<&Value> {
        let all = self.manifest.experiment.get("sources")?.as_array()?;
        all.iter().find(|source| {
            source
                .pointer("/Density/name")
                .or(source.pointer("/File/name"))
                == Some(&Value::from(name))
        })
    }

    fn seed(&self) -> Option<&Value> {
        self.manifest.experiment.get("seed")
    }

    /// The cells and limits on which errors are integrated.
    fn grid(&self) -> Option<&Value> {
        self.manifest.experiment.get("grid")
    }

    fn listed(&self) -> String {
        let names: Vec<String> = self
            .numbers
            .keys()
            .take(8)
            .map(|key| format!("\"{}\" on {} at n = {}", key.estimator, key.source, key.n))
            .collect();
        names.join(", ")
    }
}

/// Compares B with A: simultaneous intervals at `confidence` (Šidák) for all differences, of those `measures` that both have. Numbers that agree to within `tolerance`, relative, are the same.
///
/// Replicates are paired where both runs drew the same samples: the same source, seed and generator, and errors integrated over the same grid. Then what
/// samples have in common cancels. Else the means are compared as those of independent samples \[Welch 1947\].
///
/// # Errors
/// If a folder is not that of a finished run, or nothing is in both.
pub fn differences(
    [a, b]: [&Path; 2],
    measures: &[String],
    confidence: f64,
    tolerance: f64,
) -> Result<Differences, DifferenceError> {
    let (a, b) = (Run::read(a)?, Run::read(b)?);
    let only = |here: &Run, there: &Run| -> Vec<Key> {
        let missing = |key: &&Key| !there.numbers.contains_key(*key);
        here.numbers.keys().filter(missing).cloned().collect()
    };
    let mut rows = Vec::new();
    let mut remarks = Vec::new();
    let common: Vec<&Key> = a
        .numbers
        .keys()
        .filter(|key| b.numbers.contains_key(*key))
        .collect();
    if common.is_empty() {
        return Err(DifferenceError::NothingInCommon {
            a: a.listed(),
            b: b.listed(),
        });
    }
    let wanted = |name: &str| measures.is_empty() || measures.iter().any(|m| m == name);
    let mut pairs = Vec::new();
    for key in common {
        let why_not = unpaired(&a, &b, key);
        if let Some(why) = &why_not
            && !remarks.contains(why)
        {
            remarks.push(why.clone());
        }
        for (at, (_, name)) in MEASURES
            .iter()
            .enumerate()
            .filter(|(_, (_, name))| wanted(name))
        {
            let whole = |run: &Run| -> Option<Vec<f64>> {
                run.numbers.get(key)?[at].iter().copied().collect()
            };
            if let (Some(x), Some(y)) = (whole(&a), whole(&b)) {
                pairs.push((key, *name, x, y, why_not.is_none()));
            }
        }
    }
    let each = sidak(confidence, pairs.len());
    for (key, measure, x, y, paired) in pairs {
        rows.push(one(key, measure, (&x, &y), paired, each, tolerance));
    }
    Ok(Differences {
        rows,
        only_a: only(&a, &b),
        only_b: only(&b, &a),
        remarks,
        confidence,
    })
}

/// Why the replicates of `key` are not of the same samples.
fn unpaired(a: &Run, b: &Run, key: &Key) -> Option<String> {
    if a.manifest.random_generator != b.manifest.random_generator {
        return Some(
            "the runs used different random generators: replicates are not paired".to_owned(),
        );
    }
    if a.seed() != b.seed() {
        let seed = |run: &Run| {
            run.seed()
                .map_or_else(|| "none".to_owned(), Value::to_string)
        };
        return Some(format!(
            "the seeds are {} and {}: replicates are not paired",
            seed(a),
            seed(b)
        ));
    }
    let name = &key.source;
    if a.source(name).is_none() || a.source(name) != b.source(name) {
        return Some(format!(
            "\"{name}\" is not the same source in both: replicates are not paired"
        ));
    }
    (a.grid() != b.grid())
        .then(|| "errors are integrated over different grids, which is part of what differs; replicates are not paired".to_owned())
}

fn one(
    key: &Key,
    measure: &'static str,
    (x, y): (&[f64], &[f64]),
    paired: bool,
    confidence: f64,
    tolerance: f64,
) -> Difference {
    let common = x.len().min(y.len());
    let (x, y) = if paired {
        (&x[..common], &y[..common])
    } else {
        (x, y)
    };
    let (of_x, of_y) = (mean_interval(x, confidence), mean_interval(y, confidence));
    let interval = if paired {
        compare(y, x, confidence).difference
    } else {
        welch(of_x, x.len(), of_y, y.len(), confidence)
    };
    let size = of_x.value.abs().max(of_y.value.abs());
    let near = |x: &f64, y: &f64| (x - y).abs() <= tolerance * x.abs().max(y.abs());
    let same = if paired {
        x.iter().zip(y).all(|(x, y)| near(x, y))
    } else {
        near(&of_x.value, &of_y.value) && interval.standard_error.is_none_or(|e| e <= 0.0)
    };
    let known = interval.standard_error;
    let beyond = interval.low > tolerance * size || interval.high < -tolerance * size;
    let verdict = match (same, beyond) {
        (true, _) => Verdict::Same,
        (false, true) => Verdict::Differs,
        (false, false) => Verdict::Open,
    };
    Difference {
        key: key.clone(),
        measure,
        a: of_x.value,
        b: of_y.value,
        difference: interval.value,
        standard_error: known,
        low: known.map(|_| interval.low),
        high: known.map(|_| interval.high),
        paired,
        replicates: [x.len(), y.len()],
        verdict,
    }
}

/// The difference of the means of independent samples. \[Welch 1947\]
fn welch(a: Interval, n: usize, b: Interval, m: usize, confidence: f64) -> Interval {
    let difference = b.value - a.value;
    let (Some(s), Some(t)) = (a.standard_error, b.standard_error) else {
        return Interval::exact(difference);
    };
    let (s, t) = (s * s, t * t);
    if s + t <= 0.0 {
        return Interval::exact(difference);
    }
    let freedom = (s + t).powi(2) / (s * s / (n as f64 - 1.0) + t * t / (m as f64 - 1.0));
    Interval::around(difference, (s + t).sqrt(), freedom, confidence)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key() -> Key {
        Key {
            source: "s".to_owned(),
            n: 10,
            estimator: "e".to_owned(),
        }
    }

    fn values(shift: f64, seed: u64) -> Vec<f64> {
        use rand::RngExt;
        let mut random = crate::random::stream(seed, "difference", 0);
        (0..40).map(|_| shift + random.random::<f64>()).collect()
    }

    #[test]
    fn pairing_finds_what_independent_samples_do_not() {
        let (x, mut y) = (values(1.0, 1), values(1.0, 1));
        for value in &mut y {
            *value += 0.01;
        }
        let of = |paired| one(&key(), "mise", (&x, &y), paired, 0.99, 1e-9).verdict;
        assert_eq!((of(true), of(false)), (Verdict::Differs, Verdict::Open));
    }

    #[test]
    fn the_same_is_the_same_and_what_is_far_apart_differs_unpaired_too() {
        let (x, z) = (values(1.0, 1), values(2.0, 2));
        let of = |x: &[f64], y: &[f64], paired| one(&key(), "mise", (x, y), paired, 0.99, 1e-9);
        assert_eq!(of(&x, &x, true).verdict, Verdict::Same);
        assert_eq!(of(&x, &z, false).verdict, Verdict::Differs);
        // rounding is no difference, though always of one sign
        let rounded: Vec<f64> = x.iter().map(|x| x * (1.0 + 1e-14)).collect();
        assert_eq!(of(&x, &rounded, true).verdict, Verdict::Same);
        // one replicate each: a plain number, the same or not
        assert_eq!(of(&[1.0], &[1.0], true).verdict, Verdict::Same);
        assert_eq!(of(&[1.0], &[1.1], true).verdict, Verdict::Differs);
        assert!(of(&[1.0], &[1.1], true).standard_error.is_none());
    }
}
