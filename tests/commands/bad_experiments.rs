//! Whatever is wrong with an experiment file, `lab check` and `lab run` say it before anything is computed: where, what is allowed, what was
//! probably meant. Both give the same messages, and nothing is left behind.
#![allow(clippy::too_many_lines, reason = "tables, one row a case")]

use crate::support::Bench;

/// A legal experiment; the rows below spoil one line of it.
const LEGAL: [&str; 7] = [
    "question = \"Why?\"",
    "seed = 1",
    "source = { density = \"bimodal\" }",
    "draws = 50",
    "replicates = 8",
    "[[estimator]]",
    "kernel = { bandwidth = 0.3 }",
];

/// The experiment with line `number` (from 1) replaced.
fn spoilt(number: usize, line: &str) -> String {
    let mut lines = LEGAL;
    lines[number - 1] = line;
    lines.join("\n") + "\n"
}

/// Both commands refuse `text` with a message that has all of `says`.
fn refused(text: impl AsRef<[u8]>, says: &[&str]) {
    let bench = Bench::new().with("x.toml", text);
    for arguments in [
        &["check", "x.toml"][..],
        &["run", "x.toml", "--out", "results"],
    ] {
        let mut outcome = bench.run(arguments).ends_with(2).prints_nothing();
        for fragment in says {
            outcome = outcome.says(fragment);
        }
        assert_eq!(bench.listing(), ["x.toml"], "{outcome}");
    }
}

#[test]
fn the_legal_one_is_legal() {
    let bench = Bench::new().with("x.toml", LEGAL.join("\n"));
    let told = bench.run(&["check", "x.toml"]).succeeds().says_nothing();
    told.prints("Why?").prints("bimodal").prints("cost");
    let resolved = bench.run(&["check", "x.toml", "--json"]).succeeds().json();
    assert_eq!(resolved["replicates"], 8);
    let piped = bench.shell("lab check - < x.toml").succeeds();
    assert!(piped.stdout.contains("Why?"));
}

#[test]
fn one_line_spoilt() {
    for (number, line, says) in [
        (1, "", &["`question`"][..]),
        (1, "question = 7", &["x.toml:1:12: error"]),
        (1, "question = \"Why?", &["x.toml:1:"]),
        (2, "seed = -1", &["x.toml:2:8: error"]),
        (2, "seed = nan", &["x.toml:2:8: error"]),
        (2, "seed = 1e400", &["x.toml:2:"]),
        (2, "seed = 99999999999999999999999999", &["x.toml:2:"]),
        (
            2,
            "sead = 1",
            &["x.toml:2:1: error", "did you mean `seed`?"],
        ),
        (2, "seed = 1\nseed = 2", &["x.toml:3:1"]),
        (3, "", &["`source`"]),
        (
            3,
            "source = { density = \"bimodl\" }",
            &["x.toml:3:22: error", "did you mean `bimodal`?"],
        ),
        (
            3,
            "source = { densty = \"bimodal\" }",
            &["x.toml:3:12: error", "did you mean `density`?"],
        ),
        (
            3,
            "source = { density = \"bimodal\", file = \"x.csv\" }",
            &["x.toml:3:"],
        ),
        (
            3,
            "source = { file = \"nowhere.csv\" }",
            &["x.toml:3:", "nowhere.csv"],
        ),
        (3, "source = { file = \"x.toml\" }", &["x.toml:3:"]),
        (
            3,
            "source = { density = { uniform = { low = 1, high = 0 } } }",
            &["x.toml:3:"],
        ),
        (4, "draws = 0", &["x.toml:4:9: error"]),
        (4, "draws = -5", &["x.toml:4:9: error"]),
        (4, "draws = nan", &["x.toml:4:9: error"]),
        (4, "draws = inf", &["x.toml:4:9: error"]),
        (4, "draws = 1.5", &["x.toml:4:9: error"]),
        (4, "draws = [50, \"many\"]", &["x.toml:4:14: error"]),
        (4, "draws = 1_000_000_000_000", &["x.toml:4:9: error"]),
        (4, "draws = 9223372036854775807", &["x.toml:4:9: error"]),
        (5, "replicates = 0", &["x.toml:5:14: error"]),
        (
            5,
            "replicates = 9223372036854775807",
            &["x.toml:5:14: error"],
        ),
        (
            5,
            "grid = { low = -5, high = 5, cells = 1_000_000_000_000 }",
            &["x.toml:5:38: error"],
        ),
        (
            5,
            "grid = { low = 5, high = -5, cells = 10 }",
            &["x.toml:5:"],
        ),
        (
            5,
            "grid = { low = nan, high = 5, cells = 10 }",
            &["x.toml:5:16: error"],
        ),
        (
            6,
            "[[estimater]]",
            &["x.toml:6:", "did you mean `estimator`?"],
        ),
        (6, "[estimator]", &["x.toml:6:"]),
        (7, "", &["x.toml:6:"]),
        (
            7,
            "kernl = { bandwidth = 0.3 }",
            &["x.toml:7:1: error", "did you mean `kernel`?"],
        ),
        (
            7,
            "kernel = { bandwidth = 0 }",
            &["x.toml:7:24: error", "above 0"],
        ),
        (
            7,
            "kernel = { bandwidth = -0.3 }",
            &["x.toml:7:24: error", "above 0"],
        ),
        (
            7,
            "kernel = { bandwidth = nan }",
            &["x.toml:7:24: error", "above 0"],
        ),
        (
            7,
            "kernel = { bandwidth = inf }",
            &["x.toml:7:24: error", "above 0"],
        ),
        (
            7,
            "kernel = { bandwidth = \"silvermann\" }",
            &["x.toml:7:24: error", "did you mean `silverman`?"],
        ),
        (
            7,
            "kernel = { bandwith = 0.3 }",
            &["x.toml:7:12: error", "did you mean `bandwidth`?"],
        ),
        (7, "kernel = { bandwidth = [] }", &["x.toml:7:24: error"]),
        (
            7,
            "kernel = { bandwidth = 0.3, shape = \"gausian\" }",
            &["x.toml:7:37: error", "did you mean `gaussian`?"],
        ),
        (
            7,
            "name = \"a\"\nnormal = {}\n[[estimator]]\nname = \"a\"\nnormal = {}",
            &["x.toml:10:8: error"],
        ),
        (
            7,
            "normal = {}\n[[claim]]\nmise = { of = \"nobody\", below = \"normal\" }",
            &["x.toml:9:15: error", "nobody"],
        ),
        (
            7,
            "normal = {}\n[[figure]]\ncurvs = {}",
            &["x.toml:9:1: error", "did you mean `curves`?"],
        ),
    ] {
        refused(spoilt(number, line), says);
    }
}

#[test]
fn every_fault_is_told_at_once() {
    let mut lines = LEGAL;
    lines[1] = "seed = -1";
    lines[2] = "source = { density = \"bimodl\" }";
    lines[3] = "draws = 0";
    lines[6] = "kernel = { bandwidth = nan, shap = \"gaussian\" }";
    refused(
        lines.join("\n"),
        &[
            "x.toml:2:8:",
            "x.toml:3:22:",
            "x.toml:4:9:",
            "x.toml:7:24:",
            "x.toml:7:29:",
        ],
    );
}

#[test]
fn texts_that_are_no_experiment() {
    refused("", &["`question`"]);
    refused(b"\x00\x01\x02garbage", &["x.toml"]);
    refused(b"question = \"\xff\xfe\"", &["x.toml"]);
    refused("question", &["x.toml:1:"]);
    refused(
        format!("question = {}", "[".repeat(100_000)),
        &["x.toml:1:"],
    );
    refused(
        format!("question = {}1", "{ a = ".repeat(50_000)),
        &["x.toml:1:"],
    );
    refused(format!("seed = {}", "9".repeat(100_000)), &["x.toml:1:"]);
    refused("x,density\n1,2\n", &["x.toml:1:"]);
}

#[test]
fn data_files_in_fault_are_told_with_both_places() {
    let source = |rest: &str| {
        spoilt(3, &format!("source = {{ file = \"x.csv\", {rest} }}"))
            .replace("draws = 50\nreplicates = 8\n", "")
    };
    for (data, rest, says) in [
        (
            "minutes,b\n1,2\n3,4\n",
            "columns = [\"minute\"]",
            &["x.toml:3:", "minutes"][..],
        ),
        (
            "x\n1\noops\n",
            "columns = [\"x\"]",
            &["x.toml:3:", "x.csv:3:1", "oops"],
        ),
        ("x\n1\n\u{feff},\n", "columns = [\"x\"]", &["x.csv:3:"]),
        ("", "columns = [\"x\"]", &["x.csv", "empty"]),
    ] {
        let bench = Bench::new()
            .with("x.toml", source(rest))
            .with("x.csv", data);
        let mut outcome = bench
            .run(&["check", "x.toml"])
            .ends_with(2)
            .prints_nothing();
        for fragment in says {
            outcome = outcome.says(fragment);
        }
    }
}

#[test]
fn what_the_system_refuses() {
    let bench = Bench::new()
        .with("x.toml", LEGAL.join("\n"))
        .with("file", "");
    for (arguments, says) in [
        (&["check", "nowhere.toml"][..], "nowhere.toml"),
        (&["run", "nowhere.toml"], "nowhere.toml"),
        (&["check", "."], "."),
        (&["run", "x.toml", "--out", "file/results"], "file/results"),
        (
            &["run", "x.toml", "--out", "/proc/results"],
            "/proc/results",
        ),
    ] {
        bench
            .run(arguments)
            .ends_with(3)
            .prints_nothing()
            .says(says);
        assert_eq!(bench.listing(), ["file", "x.toml"]);
    }
    for (arguments, says) in [
        (&["run", "x.toml", "--out", "file"][..], "file"),
        (&["run", "x.toml", "--replicates", "0"], "--replicates"),
        (&["run", "x.toml", "--replicates", "nan"], "--replicates"),
        (&["run", "x.toml", "--seed=-1"], "--seed"),
        (
            &["run", "x.toml", "--quick", "--replicates", "5"],
            "cannot be used with",
        ),
        (
            &["run", "x.toml", "--resume", "--force"],
            "cannot be used with",
        ),
        (&["run"], "EXPERIMENT"),
    ] {
        bench
            .run(arguments)
            .ends_with(2)
            .prints_nothing()
            .says(says);
        assert_eq!(bench.listing(), ["file", "x.toml"]);
    }
    bench
        .shell("lab check x.toml > /dev/full")
        .ends_with(3)
        .says("No space left");
    bench
        .shell("lab schema > /dev/full")
        .ends_with(3)
        .says("No space left");
}

#[test]
fn a_folder_that_holds_something_else_is_not_touched() {
    let bench = Bench::new().with("x.toml", LEGAL.join("\n"));
    std::fs::create_dir(bench.path("mine")).unwrap();
    std::fs::write(bench.path("mine/thesis.tex"), "years of work").unwrap();
    bench
        .run(&["run", "x.toml", "--out", "mine"])
        .ends_with(2)
        .says("mine");
    assert_eq!(bench.text("mine/thesis.tex"), "years of work");
    assert_eq!(std::fs::read_dir(bench.path("mine")).unwrap().count(), 1);
}
