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

/// What `lab run` says, and its exit code.
fn says(command: &mut Command) -> (Option<i32>, String) {
    let output = command.stderr(Stdio::piped()).output().unwrap();
    (
        output.status.code(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

/// The manifest in `out`, as if another build had written it.
fn by_another_build(out: &Path) -> String {
    let path = out.join("manifest.json");
    let text = fs::read_to_string(&path).unwrap();
    let mut manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(manifest["build"].as_str().unwrap().len() > 16);
    manifest["build"] = "0123abc 0123456789abcdef".into();
    let text = manifest.to_string();
    fs::write(path, &text).unwrap();
    text
}

#[test]
fn a_run_finished_by_another_build_is_computed_anew_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = experiment(folder.path());
    let out = folder.path().join("old");
    assert!(lab(&path, &out, 2).status().unwrap().success());
    let whole = contents(&out);
    let theirs = by_another_build(&out);
    fs::write(out.join("notes.txt"), "years of work").unwrap();
    let (code, message) = says(&mut lab(&path, &out, 2));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("notes.txt"), "{message}");
    assert_eq!(
        fs::read_to_string(out.join("manifest.json")).unwrap(),
        theirs
    );
    fs::remove_file(out.join("notes.txt")).unwrap();
    fs::remove_file(out.join("tables/summary.csv")).unwrap();
    let (code, message) = says(&mut lab(&path, &out, 2));
    assert_eq!(code, Some(0), "{message}");
    assert!(
        message.contains("0123abc") && message.contains("computed anew"),
        "{message}"
    );
    assert_eq!(contents(&out), whole);
    let (_, message) = says(&mut lab(&path, &out, 2));
    assert!(message.contains("was finished before"), "{message}");
    let names: Vec<_> = fs::read_dir(folder.path()).unwrap().flatten().collect();
    assert_eq!(names.len(), 2, "something is left: {names:?}");
}

#[test]
fn a_quick_run_is_not_taken_for_a_whole_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = experiment(folder.path());
    // the same number of replicates both ways
    let text = EXPERIMENT.replace("replicates = 320", "replicates = 20");
    fs::write(&path, text).unwrap();
    let out = folder.path().join("quick");
    assert!(
        lab(&path, &out, 2)
            .arg("--quick")
            .status()
            .unwrap()
            .success()
    );
    let (code, message) = says(&mut lab(&path, &out, 2));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("another run"), "{message}");
    let (code, message) = says(lab(&path, &out, 2).arg("--quick"));
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("was finished before"), "{message}");
}

/// A file system of its own in memory, gone when dropped.
#[cfg(target_os = "linux")]
struct Disk(PathBuf);

#[cfg(target_os = "linux")]
impl Disk {
    /// `None` where nobody may mount anything here.
    fn new(place: &Path, size: &str) -> Option<Self> {
        fs::create_dir(place).unwrap();
        let made = Self::mount(place, &format!("size={size}"));
        made.then(|| Self(place.to_owned()))
    }

    fn grow(&self, size: &str) {
        assert!(Self::mount(&self.0, &format!("remount,size={size}")));
    }

    fn mount(place: &Path, options: &str) -> bool {
        let mut mount = Command::new("mount");
        mount
            .args(["-t", "tmpfs", "-o", options, "tmpfs"])
            .arg(place);
        mount
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|status| status.success())
    }
}

#[cfg(target_os = "linux")]
impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_ends_a_run_with_the_file_at_fault_and_more_room_lets_it_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let Some(disk) = Disk::new(&folder.path().join("disk"), "8k") else {
        eprintln!("skipped: only root may mount a small disk");
        return;
    };
    let path = experiment(folder.path());
    let whole = uninterrupted(folder.path());
    let out = disk.0.join("run");
    // from the first file to the last: the fingerprint, a cell, a table, a figure, the report
    let mut full = 0;
    for size in ["8k", "64k", "256k", "512k", "640k", "768k", "1m"] {
        disk.grow(size);
        let (code, message) = says(&mut lab(&path, &out, 2));
        if code == Some(0) {
            break;
        }
        assert_eq!(code, Some(3), "{size}: {message}");
        assert!(message.contains("No space left"), "{size}: {message}");
        assert!(message.contains("run.partial"), "{size}: {message}");
        assert!(!out.exists(), "{size}: something took the final name");
        full += 1;
    }
    assert!(full >= 2, "the disk was never full");
    disk.grow("64m");
    assert!(lab(&path, &out, 2).status().unwrap().success());
    assert_eq!(contents(&out), whole);
}
