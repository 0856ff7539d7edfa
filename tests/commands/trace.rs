//! `lab trace`

use crate::support::Bench;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

const HEADER: &str = "surface,u,v,x,y,z,flux_r,flux_g,flux_b,bounce";

fn scene(name: &str) -> String {
    format!("{}/data/scenes/{name}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn hits_carry_the_light_of_the_lamp() {
    let bench = Bench::new();
    let cube = scene("floor-cube.toml");
    let outcome = bench
        .run(&["trace", &cube, "--photons", "2000"])
        .succeeds()
        .prints(HEADER)
        .says("2000 photons, 2000 hits");
    let mut flux = 0.0;
    for line in outcome.stdout.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), 10, "{line}");
        assert_eq!(cells[9], "1", "walls are black: {line}");
        let number = |k: usize| cells[k].parse::<f64>().unwrap();
        assert!((number(7) - number(6)).abs() < 1e-12);
        let place = [number(3), number(4), number(5)];
        assert!(place.iter().all(|x| (0.0..=1.0).contains(x)), "{line}");
        flux += number(6);
    }
    // radiance 1 over an area of 1: π watts in each channel
    assert!((flux - std::f64::consts::PI).abs() < 1e-5, "{flux}");
}

#[test]
fn threads_and_formats_change_nothing() {
    let bench = Bench::new();
    let room = scene("cornell-box-rgb.toml");
    for (threads, name) in [("1", "one.npy"), ("2", "two.npy"), ("7", "seven.npy")] {
        bench
            .run(&[
                "trace",
                &room,
                "--photons",
                "7e4",
                "--threads",
                threads,
                "-o",
                name,
            ])
            .succeeds()
            .prints_nothing();
    }
    let bytes = |name: &str| fs::read(bench.path(name)).unwrap();
    assert!(bytes("one.npy") == bytes("two.npy") && bytes("one.npy") == bytes("seven.npy"));
    bench
        .run(&["trace", &room, "--photons", "7e4", "-o", "hits.csv"])
        .succeeds();
    // rows of 56 bytes after a head of at most 512
    let rows = bench.text("hits.csv").lines().count() - 1;
    let head = bytes("one.npy").len() - 56 * rows;
    assert!(head <= 512 && head.is_multiple_of(64), "{head}");
    // pieces are gone when the trace is there
    assert_eq!(
        bench.listing(),
        ["hits.csv", "one.npy", "seven.npy", "two.npy"]
    );
}

/// The pieces of a trace so far, by number, and the paths of each.
fn pieces(folder: &Path) -> BTreeMap<u64, (SystemTime, u64)> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        let Some(number) = name.strip_prefix("piece-") else {
            continue;
        };
        // a hash, a ledger, rows; the folder may be taken away at any moment
        let (Ok(bytes), Ok(about)) = (fs::read(entry.path()), entry.metadata()) else {
            continue;
        };
        let ledger = bytes.split(|&byte| byte == b'\n').nth(1).unwrap();
        let ledger: serde_json::Value = serde_json::from_slice(ledger).unwrap();
        let about = (about.modified().unwrap(), ledger["paths"].as_u64().unwrap());
        found.insert(number.parse().unwrap(), about);
    }
    found
}

#[test]
fn a_killed_trace_loses_at_most_the_block_on_its_way() {
    const BLOCK: u64 = 4096;
    let bench = Bench::new();
    let room = scene("cornell-box.toml");
    let arguments = [
        "trace",
        &room,
        "--photons",
        "4e5",
        "--threads",
        "1",
        "-o",
        "hits.npy",
    ];
    let folder = bench.path(".hits.npy.trace");
    let mut kept = BTreeMap::new();
    // killed as soon as there are some blocks, and again after some more
    for least in [3, 8] {
        let mut child = bench
            .command(&arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let last = folder.join(format!("piece-{:07}", least - 1));
        let start = Instant::now();
        while !last.exists() && start.elapsed() < Duration::from_secs(120) {
            sleep(Duration::from_millis(1));
        }
        let finished = child.try_wait().unwrap().is_some();
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(!finished, "the trace was too short to be killed");
        assert!(!bench.path("hits.npy").exists());
        let found = pieces(&folder);
        // one thread: every block that was begun but the last is there, whole
        assert!(found.keys().copied().eq(0..found.len() as u64));
        assert!(found.len() as u64 >= least && found.len() < 98);
        assert!(found.values().all(|&(_, paths)| paths == BLOCK));
        // and what was there is not traced again
        for (number, about) in &kept {
            assert_eq!(found.get(number), Some(about));
        }
        kept = found;
    }
    bench.run(&arguments).succeeds();
    let resumed = fs::read(bench.path("hits.npy")).unwrap();
    let whole = Bench::new();
    whole.run(&arguments).succeeds();
    assert!(resumed == fs::read(whole.path("hits.npy")).unwrap());
}

#[test]
fn what_cannot_be_traced_is_said() {
    let bench = Bench::new().with("bad.toml", "[[surface]]\nname = 3\n");
    bench
        .run(&["trace", "bad.toml", "--photons", "10"])
        .ends_with(2)
        .says("bad.toml:2:8")
        .prints_nothing();
    bench
        .run(&["trace", "nowhere.toml", "--photons", "10"])
        .ends_with(3)
        .says("cannot read the scene");
    let room = scene("furnace.toml");
    bench.run(&["trace", &room, "--photons", "0"]).ends_with(2);
    bench
        .run(&["trace", &room, "--photons", "5e9"])
        .ends_with(2)
        .says("allowed are 1 to 4000000000");
    bench
        .run(&["trace", &room, "--photons", "10", "-o", "nowhere/hits.csv"])
        .ends_with(3);
    let gap = fs::read_to_string(&room).unwrap().replacen(
        "u = [1.0, 0.0, 0.0]",
        "u = [0.5, 0.0, 0.0]",
        1,
    );
    let bench = bench.with("gap.toml", gap);
    bench
        .run(&["trace", "gap.toml", "--photons", "1e5", "-o", "hits.csv"])
        .ends_with(2)
        .says("light leaks");
    assert_eq!(bench.listing(), ["bad.toml", "gap.toml"]);
}

/// Columns are an optional part: without it the answer says how to get it.
#[cfg(not(feature = "parquet"))]
#[test]
fn parquet_is_refused_with_how_to_get_it() {
    let room = scene("cornell-box-rgb.toml");
    let bench = Bench::new().with("some.parquet", b"PAR1");
    bench
        .run(&["trace", &room, "--photons", "10", "-o", "hits.parquet"])
        .ends_with(2)
        .says("--features parquet");
    assert!(!bench.path("hits.parquet").exists());
    bench
        .run(&["select", "some.parquet", "--column", "u"])
        .ends_with(2)
        .says("--features parquet");
}

/// In several pieces, by any number of threads; read by the names of its columns.
#[cfg(feature = "parquet")]
#[test]
fn parquet_is_written_and_read_again() {
    let bench = Bench::new();
    let room = scene("cornell-box-rgb.toml");
    for (threads, name) in [
        ("1", "one.parquet"),
        ("2", "two.parquet"),
        ("2", "hits.csv"),
    ] {
        let threads = ["--threads", threads, "-o", name];
        let all = ["trace", &room, "--photons", "7e4"]
            .into_iter()
            .chain(threads);
        bench.run(&all.collect::<Vec<_>>()).succeeds();
    }
    let bytes = |name: &str| fs::read(bench.path(name)).unwrap();
    assert!(bytes("one.parquet") == bytes("two.parquet"));
    let selected = |name: &str| {
        let all = [
            "select",
            name,
            "--column",
            "u",
            "--weight",
            "flux_g",
            "--selector",
            "silverman",
            "--json",
        ];
        let found = bench.run(&all).succeeds().json();
        found[0]["bandwidth"].as_f64().expect("a bandwidth")
    };
    // a table holds the shortest decimal of what a column holds in single precision
    let (columns, table) = (selected("one.parquet"), selected("hits.csv"));
    assert!(
        (columns / table - 1.0).abs() < 1e-8 && table > 0.01,
        "{columns} {table}"
    );
    bench
        .run(&["select", "one.parquet", "--column", "w"])
        .ends_with(2)
        .says("the columns are \"surface\"");
}
