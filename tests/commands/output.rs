//! Files that are written, pipes that close, disks that are full.

use super::KERNEL;
use crate::support::{Bench, table};
use std::io::{BufRead, BufReader};
use std::process::Stdio;

#[test]
fn an_output_file_appears_whole_and_alone() {
    let bench = Bench::new()
        .with("x.csv", "1\n2\n4\n")
        .with("out.csv", "old");
    bench
        .run(&["estimate", "x.csv", "-e", KERNEL, "-o", "out.csv"])
        .succeeds()
        .prints_nothing();
    assert_eq!(table(&bench.text("out.csv"), "x,density").len(), 512);
    assert_eq!(bench.listing(), ["out.csv", "x.csv"]);
    // what fails leaves the old file as it was
    bench
        .run(&[
            "estimate",
            "x.csv",
            "-e",
            "kernel = { bandwidth = 1e-320 }",
            "-o",
            "out.csv",
        ])
        .ends_with(2);
    assert_eq!(table(&bench.text("out.csv"), "x,density").len(), 512);
    assert_eq!(bench.listing(), ["out.csv", "x.csv"]);
}

#[cfg(unix)]
#[test]
fn an_output_file_is_an_ordinary_file() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let bench = Bench::new();
    bench
        .shell("umask 022; lab sample --density uniform --n 3 -o new.csv")
        .succeeds();
    let mode = |name| {
        std::fs::metadata(bench.path(name))
            .unwrap()
            .permissions()
            .mode()
            & 0o777
    };
    assert_eq!(mode("new.csv"), 0o644);
    bench
        .shell("chmod 640 new.csv; lab sample --density uniform --n 4 -o new.csv")
        .succeeds();
    assert_eq!(mode("new.csv"), 0o640);
    symlink("new.csv", bench.path("link.csv")).unwrap();
    bench
        .shell("lab sample --density uniform --n 5 -o link.csv")
        .succeeds();
    assert!(
        std::fs::symlink_metadata(bench.path("link.csv"))
            .unwrap()
            .is_symlink()
    );
    assert_eq!(table(&bench.text("new.csv"), "x").len(), 5);
    // a device or a pipe is written to, never replaced
    bench
        .shell("mkfifo pipe; lab sample --density uniform --n 6 -o pipe & cat pipe")
        .succeeds()
        .prints("x\n0.");
    bench
        .run(&[
            "sample",
            "--density",
            "uniform",
            "--n",
            "6",
            "-o",
            "/dev/null",
        ])
        .succeeds();
    assert!(!std::fs::metadata("/dev/null").unwrap().is_file());
}

#[test]
fn a_reader_that_leaves_is_no_failure() {
    let bench = Bench::new();
    let mut child = bench
        .command(&["sample", "--density", "uniform", "--n", "1e9"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = String::new();
    BufReader::new(child.stdout.take().unwrap())
        .read_line(&mut first)
        .unwrap();
    let end = child.wait_with_output().unwrap();
    assert_eq!((first.as_str(), end.status.code()), ("x\n", Some(0)));
    assert!(
        end.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&end.stderr)
    );
    for line in [
        "lab list | head -1",
        "lab --help | head -1",
        "lab completions zsh | head -1",
        "lab list --json -q | head -1",
    ] {
        bench.shell(line).succeeds();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    let bench = Bench::new().with("x.csv", "1\n2\n4\n");
    for line in [
        "lab list > /dev/full",
        "lab list --json > /dev/full",
        "lab --help > /dev/full",
        "lab --version > /dev/full",
        "lab completions bash > /dev/full",
        "lab sample --density uniform --n 3 > /dev/full",
        "lab sample --density uniform --n 1e6 > /dev/full",
        "lab sample --density uniform --n 3 -o /dev/full",
        "lab estimate x.csv -e 'kernel = { bandwidth = 1 }' > /dev/full",
        "lab estimate x.csv -e 'kernel = { bandwidth = 1 }' -o /dev/full",
    ] {
        bench
            .shell(line)
            .ends_with(3)
            .says("No space left on device");
    }
    // nobody to tell it to
    bench
        .shell("lab list > /dev/full 2> /dev/full")
        .ends_with(3);
    bench.shell("lab list nonsense 2> /dev/full").ends_with(2);
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_command_leaves_nothing_behind() {
    let bench = Bench::new();
    let line =
        "lab sample --density uniform --n 1e9 -o big.csv & sleep 0.5; ls -A; kill -INT $!; wait $!";
    let outcome = bench.shell(line).ends_with(130).prints(".lab-");
    assert!(outcome.stderr.is_empty(), "{outcome}");
    assert!(bench.listing().is_empty(), "{:?}", bench.listing());
}
