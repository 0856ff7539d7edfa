//! The run machinery: the same numbers for any number of threads, after any interruption, from any damage.
#![allow(clippy::unwrap_used)]

use density_lab::experiment::judge::{Ruling, Verdict, judge};
use density_lab::experiment::region::RegionSpec;
use density_lab::experiment::results::Results;
use density_lab::experiment::run::{
    Bench, Existing, Identity, Opening, RunError, RunFolder, Silent, run,
};
use density_lab::experiment::{
    Claim, Elsewhere, EstimatorSpec, Experiment, GridSpec, Measure, SourceSpec, Statement, table,
};
use density_lab::parameter::{Value, Values};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

fn kernel(name: &str, bandwidth: f64) -> EstimatorSpec {
    let mut values = Values::default();
    values.set("shape", Value::Word("gaussian".to_owned()));
    values.set("bandwidth", Value::Number(bandwidth));
    EstimatorSpec {
        name: name.to_owned(),
        kind: "kernel".to_owned(),
        values,
        sweep: None,
    }
}

fn experiment() -> Experiment {
    let source = SourceSpec::Density {
        name: "bimodal".to_owned(),
        kind: "bimodal".to_owned(),
        values: Values::default(),
        paths: None,
    };
    Experiment {
        name: "test".to_owned(),
        question: "Is it the same?".to_owned(),
        notes: String::new(),
        seed: 3,
        sources: vec![source],
        draws: vec![50, 80],
        replicates: 64,
        stop: None,
        regions: Vec::new(),
        grid: Some(GridSpec {
            low: vec![-4.0],
            high: vec![4.0],
            cells: vec![64],
        }),
        interval: None,
        estimators: vec![kernel("narrow", 0.2), kernel("wide", 0.7)],
        uncertainties: Vec::new(),
        figures: Vec::new(),
        claims: Vec::new(),
    }
}

fn identity(experiment: &Experiment) -> Identity {
    Identity::of(experiment, false)
}

fn open(place: &Path, experiment: &Experiment, existing: Existing) -> RunFolder {
    match RunFolder::open(place, &identity(experiment), existing).unwrap() {
        Opening::Open(folder) => folder,
        Opening::Finished(path) => panic!("{} is finished", path.display()),
    }
}

/// All tables of a run as one text.
fn tables(bench: &Bench, folder: &RunFolder) -> String {
    let finished = run(bench, folder, &AtomicBool::new(false), &Silent).unwrap();
    let results = Results::gather(bench, finished);
    let out = folder.fresh("tables").unwrap();
    let mut text = table::replicates(&results);
    for table in [table::summary(&results), table::pairs(&results)] {
        table.write(&out).unwrap();
        text += &std::fs::read_to_string(out.join(table.file)).unwrap();
    }
    text
}

fn on_threads(threads: usize) -> String {
    let folder = tempfile::tempdir().unwrap();
    let bench = Bench::<1>::new(experiment()).unwrap();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    let opened = open(
        &folder.path().join("run"),
        bench.experiment(),
        Existing::Continue,
    );
    pool.install(|| tables(&bench, &opened))
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let one = on_threads(1);
    assert!(one.lines().count() > 2 * 2 * 64);
    assert_eq!(one, on_threads(2));
    assert_eq!(one, on_threads(7));
}

/// Raises the flag after some units of work.
struct Impatient<'a> {
    seen: AtomicU64,
    limit: u64,
    stop: &'a AtomicBool,
}

impl density_lab::experiment::run::Progress for Impatient<'_> {
    fn begin(&self, _total: u64, _done: u64) {}

    fn advance(&self, _units: u64) {
        if self.seen.fetch_add(1, Ordering::Relaxed) + 1 >= self.limit {
            self.stop.store(true, Ordering::Relaxed);
        }
    }
}

#[test]
fn an_interrupted_run_goes_on_to_the_same_bits() {
    let whole = on_threads(2);
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("run");
    let bench = Bench::<1>::new(experiment()).unwrap();
    for limit in [1, 3, 10] {
        let opened = open(&place, bench.experiment(), Existing::Continue);
        let stop = AtomicBool::new(false);
        let outcome = run(
            &bench,
            &opened,
            &stop,
            &Impatient {
                seen: AtomicU64::new(0),
                limit,
                stop: &stop,
            },
        );
        assert!(
            matches!(outcome, Err(RunError::Interrupted { done, total }) if 0 < done && done < total)
        );
    }
    assert_eq!(
        tables(
            &bench,
            &open(&place, bench.experiment(), Existing::Continue)
        ),
        whole
    );
}

fn journal(place: &Path) -> Vec<PathBuf> {
    let folder = place.with_file_name("run.partial").join("journal");
    std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect()
}

#[test]
fn damaged_records_are_computed_again() {
    let whole = on_threads(2);
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("run");
    let bench = Bench::<1>::new(experiment()).unwrap();
    assert_eq!(
        tables(
            &bench,
            &open(&place, bench.experiment(), Existing::Continue)
        ),
        whole
    );
    for (number, path) in journal(&place).into_iter().enumerate() {
        let text = std::fs::read_to_string(&path).unwrap();
        match number % 4 {
            0 => std::fs::write(&path, &text[..text.len() / 3]).unwrap(),
            1 => std::fs::write(&path, text.replacen("\"ise\":0.0", "\"ise\":0.1", 1)).unwrap(),
            2 => std::fs::remove_file(&path).unwrap(),
            _ => {}
        }
    }
    assert_eq!(
        tables(
            &bench,
            &open(&place, bench.experiment(), Existing::Continue)
        ),
        whole
    );
}

#[test]
fn another_experiment_neither_sees_nor_discards_the_journal_of_this_one() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("run");
    let bench = Bench::<1>::new(experiment()).unwrap();
    let mine = tables(
        &bench,
        &open(&place, bench.experiment(), Existing::Continue),
    );
    let other = Bench::<1>::new(Experiment {
        seed: 4,
        ..experiment()
    })
    .unwrap();
    let Err(error) = RunFolder::open(&place, &identity(other.experiment()), Existing::Continue)
    else {
        panic!("must be refused")
    };
    assert!(error.to_string().contains("another experiment"), "{error}");
    let theirs = tables(&other, &open(&place, other.experiment(), Existing::Replace));
    assert_ne!(theirs, mine);
}

#[test]
fn folders_beside_the_run_that_are_not_ours_are_never_touched() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("run");
    for name in ["run.partial", "run.replaced"] {
        std::fs::create_dir(folder.path().join(name)).unwrap();
        std::fs::write(folder.path().join(name).join("thesis.txt"), "years of work").unwrap();
    }
    let Err(error) = RunFolder::open(&place, &identity(&experiment()), Existing::Replace) else {
        panic!("must be refused")
    };
    assert!(
        error.to_string().contains("nothing in it was touched"),
        "{error}"
    );
    for name in ["run.partial", "run.replaced"] {
        assert!(folder.path().join(name).join("thesis.txt").exists());
    }
}

#[test]
fn a_folder_of_something_else_is_never_touched() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("thesis");
    std::fs::create_dir(&place).unwrap();
    std::fs::write(place.join("chapter1.tex"), "years of work").unwrap();
    for existing in [Existing::Continue, Existing::Replace] {
        let Err(error) = RunFolder::open(&place, &identity(&experiment()), existing) else {
            panic!("must be refused")
        };
        assert!(
            error.to_string().contains("not a run of this laboratory"),
            "{error}"
        );
    }
    assert_eq!(
        std::fs::read_to_string(place.join("chapter1.tex")).unwrap(),
        "years of work"
    );
    assert!(!folder.path().join("thesis.partial").exists());
}

#[test]
fn two_processes_do_not_share_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("run");
    let _first = open(&place, &experiment(), Existing::Continue);
    let Err(error) = RunFolder::open(&place, &identity(&experiment()), Existing::Continue) else {
        panic!("must be refused")
    };
    assert!(error.to_string().contains("another process"), "{error}");
}

#[test]
fn simulated_errors_agree_with_a_stand_in_whose_errors_are_known() {
    // the mean of ISE splits into bias² and variance up to the correction for the mean's own variance
    let folder = tempfile::tempdir().unwrap();
    let bench = Bench::<1>::new(experiment()).unwrap();
    let opened = open(
        &folder.path().join("run"),
        bench.experiment(),
        Existing::Continue,
    );
    let finished = run(&bench, &opened, &AtomicBool::new(false), &Silent).unwrap();
    let results = Results::gather(&bench, finished);
    for group in &results.groups {
        for outcome in &group.outcomes {
            use density_lab::experiment::Measure;
            let [mise, bias2, variance] = [Measure::Mise, Measure::Bias2, Measure::Variance]
                .map(|measure| outcome.measures[&measure].value);
            assert!(
                (mise - bias2 - variance).abs() < 1e-12 * mise,
                "{mise} {bias2} {variance}"
            );
        }
    }
}

#[test]
fn another_build_does_not_go_on_with_what_this_one_began() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("run");
    let mine = identity(&experiment());
    let other = Identity {
        build: "0123abc 0123456789abcdef".to_owned(),
        ..mine.clone()
    };
    let begun = |identity, existing| match RunFolder::open(&place, identity, existing) {
        Ok(Opening::Open(folder)) => {
            let remark = folder.remark().map(str::to_owned);
            let cells = std::fs::read_dir(place.with_file_name("run.partial").join("journal"));
            Ok((remark, cells.unwrap().count()))
        }
        Ok(Opening::Finished(path)) => panic!("{} is finished", path.display()),
        Err(error) => Err(error.to_string()),
    };
    let cell = place
        .with_file_name("run.partial")
        .join("journal")
        .join("cell.json");
    assert_eq!(begun(&other, Existing::Continue), Ok((None, 0)));
    std::fs::write(&cell, "theirs").unwrap();
    assert_eq!(begun(&other, Existing::Resume), Ok((None, 1)));
    let refused = begun(&mine, Existing::Resume).unwrap_err();
    assert!(
        refused.contains("0123abc") && refused.contains("leave --resume out"),
        "{refused}"
    );
    assert!(cell.exists(), "a refusal must not touch anything");
    let (remark, cells) = begun(&mine, Existing::Continue).unwrap();
    assert!(remark.unwrap().contains("begun anew"));
    assert_eq!(cells, 0);
    assert_eq!(begun(&mine, Existing::Resume), Ok((None, 0)));
}

#[test]
fn quick_runs_are_runs_of_their_own() {
    let whole = Identity::of(&experiment(), false);
    let quick = Identity::of(&experiment(), true);
    assert_ne!(whole.fingerprint, quick.fingerprint);
    assert_ne!(
        RunFolder::default_place("test", &whole),
        RunFolder::default_place("test", &quick)
    );
}

/// The variance of an estimate of fixed bandwidth falls as 1/n: what n = 50 has over n = 80 is 1.6, and a claim that says otherwise fails.
#[test]
fn claims_reach_over_sizes_and_sources() {
    let folder = tempfile::tempdir().unwrap();
    let mut experiment = experiment();
    experiment.replicates = 800;
    experiment.sources.push(SourceSpec::Density {
        name: "the same again".to_owned(),
        kind: "bimodal".to_owned(),
        values: Values::default(),
        paths: None,
    });
    let claim = |says: &str, statement: Statement| Claim {
        says: says.to_owned(),
        draws: Some(50),
        source: Some("bimodal".to_owned()),
        region: None,
        statement,
        line: 1,
    };
    let smaller = Elsewhere {
        source: None,
        draws: Some(80),
    };
    let twin = Elsewhere {
        source: Some("the same again".to_owned()),
        draws: None,
    };
    let times = |other: &Elsewhere, equals: f64| Statement::Equals {
        measure: Measure::Mise,
        of: "narrow".to_owned(),
        over: Some("narrow".to_owned()),
        other: other.clone(),
        equals,
        margin: 0.1,
        confidence: 0.99,
    };
    let below = |by: f64| Statement::Below {
        measure: Measure::Mise,
        of: "wide".to_owned(),
        below: "narrow".to_owned(),
        other: smaller.clone(),
        by,
        confidence: 0.99,
    };
    experiment.claims = vec![
        // bias² is a tenth of the whole
        claim("right", times(&smaller, 1.55)),
        claim("wrong", times(&smaller, 1.35)),
        claim("paired", times(&twin, 1.0)),
        claim("the other way", times(&twin, 1.2)),
        claim("never", below(5.0)),
    ];
    let bench = Bench::<1>::new(experiment).unwrap();
    let opened = open(
        &folder.path().join("run"),
        bench.experiment(),
        Existing::Continue,
    );
    let finished = run(&bench, &opened, &AtomicBool::new(false), &Silent).unwrap();
    let verdicts = judge(&bench, &Results::gather(&bench, finished));
    let holds: Vec<bool> = verdicts
        .iter()
        .map(|verdict| verdict.outcome == Ruling::Holds)
        .collect();
    assert_eq!(holds, [true, false, true, false, false], "{verdicts:#?}");
}

/// What is claimed of a region is compared with the same region, of this source and of another.
#[test]
fn claims_about_a_region_compare_within_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut experiment = experiment();
    experiment.sources.push(SourceSpec::Density {
        name: "the same again".to_owned(),
        kind: "bimodal".to_owned(),
        values: Values::default(),
        paths: None,
    });
    experiment.regions = vec![RegionSpec {
        name: "left".to_owned(),
        limits: vec![[-4.0, -0.5]],
        ring: None,
    }];
    let claim = |measure, source: Option<&str>, margin| Claim {
        says: "as large as itself".to_owned(),
        draws: Some(50),
        source: Some("bimodal".to_owned()),
        region: Some("left".to_owned()),
        statement: Statement::Equals {
            measure,
            of: "narrow".to_owned(),
            over: Some("narrow".to_owned()),
            other: Elsewhere {
                source: source.map(ToOwned::to_owned),
                draws: None,
            },
            equals: 1.0,
            margin,
            confidence: 0.99,
        },
        line: 1,
    };
    experiment.claims = vec![
        claim(Measure::Mise, None, 1e-9),
        // the whole has more than twice the error of the part
        claim(Measure::Mise, Some("the same again"), 0.4),
    ];
    let bench = Bench::<1>::new(experiment).unwrap();
    let place = folder.path().join("run");
    let opened = open(&place, bench.experiment(), Existing::Continue);
    let finished = run(&bench, &opened, &AtomicBool::new(false), &Silent).unwrap();
    let verdicts = judge(&bench, &Results::gather(&bench, finished));
    let holds = |verdict: &Verdict| verdict.outcome == Ruling::Holds;
    assert!(verdicts.iter().all(holds), "{verdicts:#?}");
}
