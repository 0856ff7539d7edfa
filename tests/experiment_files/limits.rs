//! What is too large, too deep, unreadable or without spread is refused in words.

use super::{parse, places, with};
use density_lab::experiment::read;
use std::fs;
use std::path::Path;

#[test]
fn large_counts_are_refused_with_what_they_would_need() {
    for (line, changed, place, says) in [
        (4, "draws = 1_000_000_000", (4, 9), "samples"),
        (
            5,
            "replicates = 10_000_000",
            (5, 14),
            "errors of each replicate",
        ),
        (
            6,
            "grid = { low = 0, high = 1, cells = 10_000_000 }",
            (6, 8),
            "on the grid",
        ),
    ] {
        let text = with(&[(line, changed)]);
        match parse(&text) {
            // A machine may be large enough.
            Ok(experiment) => assert!(
                density_lab::experiment::budget::budget(&experiment)
                    .check(1 << 30)
                    .unwrap_err()
                    .what
                    .contains(says)
            ),
            Err(problems) => {
                assert_eq!(places(&problems), [place], "{problems}");
                let shown = problems.to_string();
                assert!(
                    shown.contains("GiB of memory") && shown.contains(says),
                    "{shown}"
                );
            }
        }
    }
    let text = with(&[
        (4, "draws = 100_000_000"),
        (5, "replicates = 10_000_000"),
        (6, "grid = { low = 0, high = 1, cells = 1 }"),
    ]);
    let problems = parse(&text).unwrap_err();
    assert!(
        problems.list().iter().all(|p| p.line == 4 || p.line == 5),
        "{problems}"
    );
}

#[test]
fn files_that_cannot_be_read_are_told_from_wrong_ones() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let read = |path: &Path| read::experiment(path).unwrap_err();
    assert!(read(&path("missing.toml")).is_input_output());
    assert!(read(folder.path()).is_input_output());

    fs::write(
        path("latin.toml"),
        b"question = \"a\"\nnotes = \"caf\xe9\"\n",
    )
    .unwrap();
    let problems = read(&path("latin.toml"));
    assert!(!problems.is_input_output());
    assert_eq!(places(&problems), [(2, 13)]);
    assert!(problems.to_string().contains("0xe9"), "{problems}");

    fs::write(path("large.toml"), "#".repeat(read::LARGEST + 1)).unwrap();
    let problems = read(&path("large.toml"));
    assert!(!problems.is_input_output() && problems.to_string().contains("8 MiB"));

    // A byte order mark and the line ends of another system are no faults.
    let text = format!("\u{feff}{}", with(&[]).replace('\n', "\r\n"));
    fs::write(path("dos.toml"), text).unwrap();
    assert_eq!(read::experiment(&path("dos.toml")).unwrap().name, "dos");
}

#[test]
fn data_without_spread_are_refused_where_a_rule_wants_one() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("tied.csv"), "x\n1\n1\n1\n").unwrap();
    let text = |bandwidth: &str| {
        format!(
            "question = \"q\"\nsource = {{ file = \"tied.csv\", columns = [\"x\"] }}\n[[estimator]]\nkernel = {{ bandwidth = {bandwidth} }}\n"
        )
    };
    let origin = folder.path().join("x.toml");
    let problems = read::experiment_text(&text("\"silverman\""), &origin).unwrap_err();
    assert_eq!(places(&problems), [(4, 24)], "{problems}");
    assert!(problems.to_string().contains("no spread"), "{problems}");
    assert!(read::experiment_text(&text("0.3"), &origin).is_ok());
    let problems = read::experiment_text(&text("\"oracle\""), &origin).unwrap_err();
    assert_eq!(places(&problems), [(4, 24)], "{problems}");

    let one = with(&[(4, "draws = 1"), (12, "kernel = { bandwidth = \"scott\" }")]);
    assert_eq!(places(&parse(&one).unwrap_err()), [(12, 24)]);
}

#[test]
fn deep_nesting_and_long_lines_are_refused_in_bounded_time_and_space() {
    for text in [
        "a = ".to_owned() + &"[".repeat(100_000),
        "a = ".to_owned() + &"{a=".repeat(100_000),
        "a.".repeat(100_000) + "b = 1",
        format!("[{}b]", "a.".repeat(100_000)),
        "[[x]]\n".repeat(100_000),
        "=".repeat(1_000_000),
        "x".repeat(8_000_000),
        format!("question = \"{}\"", "y".repeat(8_000_000)),
        format!("{} = 1", "z".repeat(1_000_000)),
        "\"".repeat(200_000),
        "a = 1\n".repeat(40_000),
    ] {
        let problems = parse(&text).unwrap_err();
        assert!(problems.to_string().len() < 200_000);
    }
}
