//! Runs that end when their question is settled: at the same replicate whatever the threads and interruptions.
#![allow(clippy::unwrap_used)]

use density_lab::experiment::results::Results;
use density_lab::experiment::run::{
    Bench, Existing, Identity, Opening, Progress, RunError, RunFolder, Silent, run,
};
use density_lab::experiment::{read, table};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

fn bench(stop: &str) -> Bench {
    let text = format!(
        r#"question = "Which?"
        seed = 3
        source = {{ density = "bimodal" }}
        draws = 100
        replicates = 160
        {stop}
        grid = {{ low = -4.0, high = 4.0, cells = 64 }}
        estimator = [{{ name = "good", kernel = {{ bandwidth = 0.37 }} }}, {{ name = "bad", kernel = {{ bandwidth = 0.1 }} }}]"#
    );
    Bench::new(read::experiment_text(&text, Path::new("stopping.toml")).unwrap()).unwrap()
}

fn open(place: &Path, bench: &Bench) -> RunFolder {
    let identity = Identity::of(bench.experiment(), false);
    match RunFolder::open(place, &identity, Existing::Continue).unwrap() {
        Opening::Open(folder) => folder,
        Opening::Finished(path) => panic!("{} is finished", path.display()),
    }
}

/// The replicates as a table, and what the run says.
fn outcome(bench: &Bench, place: &Path) -> (Vec<String>, Vec<String>) {
    let finished = run(bench, &open(place, bench), &AtomicBool::new(false), &Silent).unwrap();
    let said = finished.warnings.keys().map(|w| w.what.clone()).collect();
    let results = Results::gather(bench, finished);
    let rows = table::replicates(&results);
    (rows.lines().skip(1).map(str::to_owned).collect(), said)
}

const RANK: &str = r#"stop = { rank = "estimators", confidence = 0.95 }"#;

#[test]
fn what_is_settled_early_ends_early_and_is_part_of_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, nothing) = outcome(&bench(""), &folder.path().join("whole"));
    let (early, said) = outcome(&bench(RANK), &folder.path().join("early"));
    assert_eq!(whole.len(), 2 * 160);
    // h = 0.1 is more than twice as bad: the first look, after two of sixteen blocks, tells
    assert_eq!(early.len(), 2 * 20, "{said:?}");
    assert!(early.iter().all(|row| whole.contains(row)));
    assert!(nothing.is_empty());
    assert!(
        said[0].contains("stopped after 20 of 160 replicates"),
        "{said:?}"
    );
    // an error to a millionth is not to be had
    let exact = "stop = { relative-error = 1e-6 }";
    let (all, _) = outcome(&bench(exact), &folder.path().join("exact"));
    assert_eq!(all, whole);
}

/// Raises the flag at the first unit of work.
struct Impatient<'a>(&'a AtomicBool);

impl Progress for Impatient<'_> {
    fn begin(&self, _total: u64, _done: u64) {}

    fn advance(&self, _units: u64) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[test]
fn interruptions_and_threads_do_not_move_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let rule = "stop = { relative-error = 0.3 }";
    let bench = bench(rule);
    let straight = outcome(&bench, &folder.path().join("straight"));
    let place = folder.path().join("interrupted");
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    for _ in 0..3 {
        let stop = AtomicBool::new(false);
        let opened = open(&place, &bench);
        let ended = one.install(|| run(&bench, &opened, &stop, &Impatient(&stop)));
        assert!(matches!(ended, Err(RunError::Interrupted { .. })));
    }
    assert_eq!(one.install(|| outcome(&bench, &place)), straight);
}

#[test]
fn a_rule_that_cannot_be_followed_is_refused() {
    let refused = |stop: &str| {
        let text = format!(
            "question = \"Which?\"\nsource = {{ density = \"bimodal\" }}\ndraws = 10\nreplicates = 20\n{stop}\nestimator = [{{ kernel = {{ bandwidth = 0.3 }} }}]"
        );
        let found = read::experiment_text(&text, Path::new("stopping.toml"));
        found.err().map(|problems| problems.to_string())
    };
    for wrong in [
        "stop = {}",
        "stop = { relative-error = 0.1, rank = \"estimators\" }",
        "stop = { relative-error = 1.5 }",
        "stop = { rank = \"bandwidths\" }",
        "stop = 0.1",
    ] {
        assert!(
            refused(wrong).is_some_and(|what| what.contains("stop")
                || what.contains("rank")
                || what.contains("relative-error")),
            "{wrong}"
        );
    }
    assert_eq!(refused("stop = { relative-error = 0.1 }"), None);
}
