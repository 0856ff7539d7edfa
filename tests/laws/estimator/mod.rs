//! The laws of estimators, tried on the whole catalogue, on the line and in the plane, and on planted violators.
//!
//! A law that an estimator promises must hold on every data set tried; a law that it does not promise must be seen broken on at least one, or the promise is
//! missing. Laws without a promise hold for all. The data come from a fixed seed, so a failure repeats.

mod data;
mod expectation;
mod law;
mod plane_expectation;
mod planted;
mod promised;
mod reproduction;
mod subject;
mod universal;
mod violations;

use data::Data;
use density_lab::experiment::catalogue::{Builds, ESTIMATORS, Entry};
use law::Law;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestError, TestRng, TestRunner};
use std::sync::atomic::{AtomicUsize, Ordering};
use subject::Subject;

/// How a subject stands to a law.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Promised and kept, or universal and kept.
    Kept,
    /// Not promised, and seen broken.
    RightlyNotPromised,
    /// Promised, or universal, and broken.
    Broken(String),
    /// Not promised and never seen broken.
    KeptWithoutPromise,
}

fn runner(cases: u32) -> TestRunner {
    let config = Config {
        cases,
        failure_persistence: None,
        // a law that is tried once brings data of its own, which nothing makes smaller
        max_shrink_iters: if cases > 1 { 20 } else { 0 },
        ..Config::default()
    };
    TestRunner::new_with_rng(
        config,
        TestRng::from_seed(RngAlgorithm::ChaCha, b"the laws of estimators, seed 001"),
    )
}

/// Tries one law on one subject.
fn judge<const D: usize>(subject: &Subject<D>, law: &Law<D>) -> Verdict {
    let promised = law
        .promise
        .is_none_or(|promise| promise(&subject.plain().laws()));
    let mut runner = runner(law.cases);
    let strategy = data::data::<D>(law.data, law.walls);
    if promised {
        let outcome = runner.run(&strategy, |data: Data<D>| {
            match (law.breach)(subject, &data) {
                None => Ok(()),
                Some(what) => Err(proptest::test_runner::TestCaseError::fail(what)),
            }
        });
        return match outcome {
            Ok(()) => Verdict::Kept,
            Err(TestError::Fail(what, data)) => Verdict::Broken(format!("{what} with {data:?}")),
            Err(TestError::Abort(why)) => Verdict::Broken(why.to_string()),
        };
    }
    // some breaches are rare, and the first one ends the search
    for _ in 0..40 * law.cases {
        let data = strategy.new_tree(&mut runner).unwrap().current();
        if (law.breach)(subject, &data).is_some() {
            return Verdict::RightlyNotPromised;
        }
    }
    Verdict::KeptWithoutPromise
}

/// What `look` finds among `items`, on plain threads: laws about thread pools would wait for each other on the threads of a pool.
fn find<T: Sync>(items: &[T], look: impl Fn(&T) -> Option<String> + Sync) -> Vec<String> {
    let next = AtomicUsize::new(0);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut found: Vec<(usize, String)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| {
                scope.spawn(|| {
                    let mut found = Vec::new();
                    loop {
                        let i = next.fetch_add(1, Ordering::Relaxed);
                        let Some(item) = items.get(i) else {
                            return found;
                        };
                        found.extend(look(item).map(|what| (i, what)));
                    }
                })
            })
            .collect();
        workers
            .into_iter()
            .flat_map(|worker| worker.join().unwrap())
            .collect()
    });
    found.sort();
    found.into_iter().map(|(_, what)| what).collect()
}

/// By default every so many-th pair of a setting and a law is tried, a number that shares no factor with that of the laws. `LAB_LAWS_STRIDE=1` asks for all.
fn stride() -> usize {
    let asked = std::env::var("LAB_LAWS_STRIDE").ok();
    asked
        .and_then(|word| word.parse().ok())
        .filter(|&stride| stride > 0)
        .unwrap_or(13)
}

fn catalogue_keeps_the_laws<const D: usize>()
where
    Entry: Builds<D>,
{
    let subjects = subject::catalogue::<D>();
    let laws = law::all::<D>();
    let pairs: Vec<(&Subject<D>, &Law<D>)> = subjects
        .iter()
        .flat_map(|subject| laws.iter().map(move |law| (subject, law)))
        .filter(|(subject, law)| (law.applies)(subject))
        .step_by(stride())
        .collect();
    let spent: Vec<(&str, std::sync::Mutex<f64>)> = laws
        .iter()
        .map(|law| (law.name, std::sync::Mutex::new(0.0)))
        .collect();
    let faults = find(&pairs, |(subject, law)| {
        let start = std::time::Instant::now();
        let verdict = judge(subject, law);
        let clock = spent.iter().find(|(name, _)| *name == law.name).unwrap();
        *clock.1.lock().unwrap() += start.elapsed().as_secs_f64();
        match verdict {
            Verdict::Kept | Verdict::RightlyNotPromised => None,
            fault => {
                let fault = format!("{}: {}: {fault:?}", subject.name, law.name);
                // at once, so that a run that is cut short has said it
                eprintln!("{D}D fault: {fault}");
                Some(fault)
            }
        }
    });
    let estimators = ESTIMATORS
        .iter()
        .filter(|entry| Builds::<D>::builder(*entry).is_some())
        .count();
    eprintln!(
        "{D}D: {} settings of {estimators} estimators × {} laws = {} pairs, {} faults",
        subjects.len(),
        laws.len(),
        pairs.len(),
        faults.len()
    );
    for (name, seconds) in &spent {
        eprintln!("{D}D: {name}: {:.1} s", seconds.lock().unwrap());
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn every_estimator_of_the_line_keeps_its_promises_and_no_others() {
    catalogue_keeps_the_laws::<1>();
}

#[test]
fn every_estimator_of_the_plane_keeps_its_promises_and_no_others() {
    catalogue_keeps_the_laws::<2>();
}

fn violations_are_caught<const D: usize>()
where
    Entry: Builds<D>,
{
    let planted = violations::all::<D>();
    let laws = law::all::<D>();
    let missed = find(&planted, |(subject, expected)| {
        let law = laws.iter().find(|law| law.name == *expected).unwrap();
        match judge(subject, law) {
            Verdict::Broken(_) | Verdict::KeptWithoutPromise => None,
            missed => Some(format!("{}: {expected}: {missed:?}", subject.name)),
        }
    });
    eprintln!(
        "{D}D: {} planted violations, {} missed",
        planted.len(),
        missed.len()
    );
    assert!(missed.is_empty(), "\n{}", missed.join("\n"));
    // each law must have something to catch
    for law in &laws {
        assert!(
            planted.iter().any(|(_, name)| *name == law.name),
            "nothing planted against: {}",
            law.name
        );
    }
}

#[test]
fn every_planted_violation_on_the_line_is_caught_by_the_law_it_breaks() {
    violations_are_caught::<1>();
}

#[test]
fn every_planted_violation_in_the_plane_is_caught_by_the_law_it_breaks() {
    violations_are_caught::<2>();
}
