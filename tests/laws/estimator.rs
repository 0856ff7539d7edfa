//! The laws of estimators, tried on the whole catalogue and on planted violators.
//!
//! A law that an estimator promises must hold on every data set tried; a law that it does not promise must be seen broken on at least one, or the promise is
//! missing. Laws without a promise hold for all. The data come from a fixed seed, so a failure repeats.

mod cases;
mod expectation;
mod law;
mod plane_expectation;
mod planted;

use cases::{Data, Subject};
use law::{LAWS, Law};
use proptest::strategy::Strategy;
use proptest::test_runner::{Config, RngAlgorithm, TestError, TestRng, TestRunner};
use std::sync::atomic::{AtomicUsize, Ordering};

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
        max_shrink_iters: 20,
        ..Config::default()
    };
    TestRunner::new_with_rng(
        config,
        TestRng::from_seed(RngAlgorithm::ChaCha, b"the laws of estimators, seed 001"),
    )
}

/// Tries one law on one subject.
pub fn judge(subject: &Subject, law: &Law) -> Verdict {
    let promised = law
        .promise
        .is_none_or(|promise| promise(&subject.plain().laws()));
    let mut runner = runner(law.cases);
    let strategy = cases::data(law.data);
    if promised {
        let outcome = runner.run(&strategy, |data: Data| match (law.breach)(subject, &data) {
            None => Ok(()),
            Some(what) => Err(proptest::test_runner::TestCaseError::fail(what)),
        });
        return match outcome {
            Ok(()) => Verdict::Kept,
            Err(TestError::Fail(what, data)) => Verdict::Broken(format!("{what} with {data:?}")),
            Err(TestError::Abort(why)) => Verdict::Broken(why.to_string()),
        };
    }
    // some breaches are rare, and the first one ends the search
    for _ in 0..20 * law.cases {
        use proptest::strategy::ValueTree;
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

#[test]
fn every_estimator_of_the_catalogue_keeps_its_promises_and_no_others() {
    let subjects = cases::catalogue();
    let pairs: Vec<(&Subject, &Law)> = subjects
        .iter()
        .flat_map(|subject| LAWS.iter().map(move |law| (subject, law)))
        .collect();
    let faults = find(&pairs, |(subject, law)| match judge(subject, law) {
        Verdict::Kept | Verdict::RightlyNotPromised => None,
        fault => Some(format!("{}: {}: {fault:?}", subject.name, law.name)),
    });
    eprintln!(
        "{} settings of {} estimators × {} laws = {} pairs, {} faults",
        subjects.len(),
        density_lab::experiment::catalogue::ESTIMATORS.len(),
        LAWS.len(),
        pairs.len(),
        faults.len()
    );
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn every_planted_violation_is_caught_by_the_law_it_breaks() {
    let planted = planted::all();
    let missed = find(&planted, |(subject, expected)| {
        let law = LAWS.iter().find(|law| law.name == *expected).unwrap();
        match judge(subject, law) {
            Verdict::Broken(_) | Verdict::KeptWithoutPromise => None,
            missed => Some(format!("{}: {expected}: {missed:?}", subject.name)),
        }
    });
    eprintln!(
        "{} planted violations, {} missed",
        planted.len(),
        missed.len()
    );
    assert!(missed.is_empty(), "\n{}", missed.join("\n"));
    // each law must have something to catch
    for law in LAWS {
        assert!(
            planted.iter().any(|(_, name)| *name == law.name),
            "nothing planted against: {}",
            law.name
        );
    }
}
