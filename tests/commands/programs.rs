//! Programs as estimators: what `lab` starts, when, and what it does when they fail.

use crate::support::Bench;

/// An experiment with a good program, a bad one and an estimator of our own.
const FILE: &str = r#"
question   = "What do programs say?"
source     = { density = "uniform" }
draws      = 20
replicates = 8
grid       = { low = 0.0, high = 1.0, cells = 10 }

[[estimator]]
name    = "flat"
command = { program = "awk", arguments = ["NR == 1 { n = $1 } NR > n + 1 { print 1 }"], timeout = 20 }

[[estimator]]
name    = "lost"
command = { program = "sh", arguments = ["-c", "cat > started; echo no licence >&2; exit 7"], timeout = 20 }

[[estimator]]
name   = "ours"
kernel = { bandwidth = 0.2 }

[[claim]]
mise = { of = "flat", below = "ours" }
"#;

#[test]
fn nothing_is_started_without_leave() {
    let bench = Bench::new().with("programs.toml", FILE);
    let checked = bench.run(&["check", "programs.toml"]);
    assert_eq!(checked.code, Some(0), "{checked}");
    assert!(
        checked.stdout.contains("awk") && checked.stdout.contains("licence"),
        "{checked}"
    );
    let refused = bench.run(&["run", "programs.toml"]);
    assert_eq!(refused.code, Some(2), "{refused}");
    assert!(
        refused.stderr.contains("--allow-commands") && refused.stderr.contains("awk"),
        "{refused}"
    );
    assert_eq!(bench.listing(), ["programs.toml"]);
}

#[test]
fn a_program_that_fails_is_left_out_and_the_others_go_on() {
    let bench = Bench::new().with("programs.toml", FILE);
    let run = [
        "run",
        "programs.toml",
        "--allow-commands",
        "--out",
        "results",
    ];
    let done = bench.run(&run);
    // the claim holds, but one estimator has no numbers
    assert_eq!(done.code, Some(1), "{done}");
    assert!(
        done.stdout.contains("flat") && done.stdout.contains("ours"),
        "{done}"
    );
    assert!(
        done.stderr.contains("\"lost\" failed")
            && done.stderr.contains("exit status: 7; it said: no licence"),
        "{done}"
    );
    assert!(done.stdout.contains("\"lost\" can be computed"), "{done}");
    let summary = bench.text("results/tables/summary.csv");
    assert!(summary.contains("flat") && summary.contains("ours") && !summary.contains("lost"));
    // what is finished stays so, with the same verdict
    let again = bench.run(&run);
    assert_eq!(again.code, Some(1), "{again}");
    assert!(again.stdout.contains("\"lost\" can be computed"), "{again}");
}

#[test]
fn if_no_estimator_is_left_there_are_no_results() {
    let alone: String = FILE
        .split("\n[[")
        .filter(|part| !part.contains("flat") && !part.contains("ours"))
        .collect::<Vec<_>>()
        .join("\n[[");
    let bench = Bench::new().with("programs.toml", alone);
    let done = bench.run(&["run", "programs.toml", "--allow-commands"]);
    assert_eq!(done.code, Some(2), "{done}");
    assert!(done.stderr.contains("no licence"), "{done}");
}

#[test]
fn one_estimate_by_a_program_on_the_command_line() {
    let bench = Bench::new().with("points.csv", "x\n1\n2\n3\n");
    let estimator = r#"command = { program = "awk", arguments = ["NR == 1 { n = $1 } NR > n + 1 { print $1 }"] }"#;
    let found = bench.run(&[
        "estimate",
        "points.csv",
        "--column",
        "x",
        "--estimator",
        estimator,
        "--grid",
        "0:4:4",
    ]);
    assert_eq!(found.code, Some(0), "{found}");
    assert_eq!(
        found.stdout,
        "x,density\n0.5,0.5\n1.5,1.5\n2.5,2.5\n3.5,3.5\n"
    );
    let failed = bench.run(&[
        "estimate",
        "points.csv",
        "--column",
        "x",
        "--estimator",
        r#"command = { program = "/nowhere/program" }"#,
        "--grid",
        "0:4:4",
    ]);
    assert_eq!(failed.code, Some(2), "{failed}");
    assert!(failed.stderr.contains("cannot be started"), "{failed}");
}
