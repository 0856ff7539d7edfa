//! Interruptions of `lab run` from outside: killed at random moments, asked to stop, run again after the end.
#![allow(clippy::unwrap_used)]

use rand::RngExt;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

const EXPERIMENT: &str = r#"
question   = "Does an interruption change anything?"
seed       = 5
source     = { density = "bimodal" }
draws      = [200, 400]
replicates = 320
grid       = { low = -4.0, high = 4.0, cells = 256 }

[[estimator]]
name   = "narrow"
kernel = { bandwidth = 0.1, engine = "direct" }

[[estimator]]
name   = "rule"
kernel = { bandwidth = "silverman", engine = "direct" }

[[estimator]]
name      = "bins"
histogram = { width = 0.5 }

[[figure]]
curves = { show = ["truth", "sample"] }

[[claim]]
mise = { of = ["narrow", "bins"], agrees-with = "exact", confidence = 0.9999 }
"#;

fn lab(experiment: &Path, out: &Path, threads: usize) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lab"));
    command
        .arg("run")
        .arg(experiment)
        .arg("--out")
        .arg(out)
        .arg("--threads")
        .arg(threads.to_string());
    command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .stdin(Stdio::null());
    command
}

fn experiment(folder: &Path) -> PathBuf {
    let path = folder.join("interrupted.toml");
    fs::write(&path, EXPERIMENT).unwrap();
    path
}

/// Everything in the run folder but what says when and how it was made.
fn contents(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for folder in ["tables", "figures"] {
        for entry in fs::read_dir(out.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            found.insert(
                path.strip_prefix(out).unwrap().display().to_string(),
                fs::read(&path).unwrap(),
            );
        }
    }
    assert!(found.len() >= 5, "{:?}", found.keys());
    found
}

fn uninterrupted(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let out = folder.join("whole");
    assert!(
        lab(&experiment(folder), &out, 2)
            .status()
            .unwrap()
            .success()
    );
    contents(&out)
}

fn ended(child: &mut Child, within: Duration) -> bool {
    let start = Instant::now();
    while start.elapsed() < within {
        if child.try_wait().unwrap().is_some() {
            return true;
        }
        sleep(Duration::from_millis(2));
    }
    false
}

#[test]
fn twenty_kills_and_a_resume_give_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let whole = uninterrupted(folder.path());
    let path = experiment(folder.path());
    let out = folder.path().join("killed");
    // moments are random but the same on every run of the test
    let mut random = density_lab::random::stream(20, "kills", 0);
    let mut killed = 0;
    for attempt in 0..200 {
        let mut child = lab(&path, &out, 1 + attempt % 3).spawn().unwrap();
        if ended(
            &mut child,
            Duration::from_millis(random.random_range(5..120)),
        ) {
            // it got to its end before its time: begin again with an empty folder
            fs::remove_dir_all(&out).unwrap();
            continue;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        killed += 1;
        assert!(
            !out.exists(),
            "a killed run left a folder that looks finished"
        );
        if killed == 20 {
            break;
        }
    }
    assert_eq!(
        killed, 20,
        "the machine is too fast for this test: make the experiment longer"
    );
    assert!(
        lab(&path, &out, 7)
            .arg("--resume")
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(contents(&out), whole);
    assert!(!folder.path().join("killed.partial").exists());
}

#[test]
#[cfg(unix)]
fn an_interrupt_saves_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let whole = uninterrupted(folder.path());
    let path = experiment(folder.path());
    let out = folder.path().join("stopped");
    let journal = folder.path().join("stopped.partial").join("journal");
    let mut child = lab(&path, &out, 1).stderr(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while fs::read_dir(&journal).map_or(0, Iterator::count) < 3 {
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "no cell was finished"
        );
        sleep(Duration::from_millis(1));
    }
    assert!(
        Command::new("kill")
            .arg("-INT")
            .arg(child.id().to_string())
            .status()
            .unwrap()
            .success()
    );
    assert!(
        ended(&mut child, Duration::from_secs(20)),
        "it does not stop"
    );
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(message.contains("cells finished and saved"), "{message}");
    assert!(!out.exists());
    assert!(lab(&path, &out, 2).status().unwrap().success());
    assert_eq!(contents(&out), whole);
}

#[test]
fn a_finished_run_is_reused_and_force_replaces_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = experiment(folder.path());
    let out = folder.path().join("again");
    assert!(lab(&path, &out, 2).status().unwrap().success());
    let first = fs::metadata(out.join("manifest.json"))
        .unwrap()
        .modified()
        .unwrap();
    assert!(lab(&path, &out, 2).status().unwrap().success());
    assert_eq!(
        fs::metadata(out.join("manifest.json"))
            .unwrap()
            .modified()
            .unwrap(),
        first,
        "it was computed again"
    );
    assert!(
        lab(&path, &out, 2)
            .arg("--force")
            .status()
            .unwrap()
            .success()
    );
    assert_ne!(
        fs::metadata(out.join("manifest.json"))
            .unwrap()
            .modified()
            .unwrap(),
        first,
        "it was not computed again"
    );
    fs::write(
        &path,
        EXPERIMENT.replace("seed       = 5", "seed       = 6"),
    )
    .unwrap();
    assert_eq!(
        lab(&path, &out, 2).status().unwrap().code(),
        Some(2),
        "another experiment took the folder"
    );
    assert!(
        lab(&path, &out, 2)
            .arg("--force")
            .status()
            .unwrap()
            .success()
    );
}
