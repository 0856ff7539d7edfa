//! Programs that answer well, badly, late or not at all.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use super::*;
use crate::space::Grid;
use std::time::Instant;

fn shell(script: &str, format: Format, seconds: f64) -> Command {
    Command {
        program: "sh".to_owned(),
        arguments: vec!["-c".to_owned(), script.to_owned()],
        timeout: Duration::from_secs_f64(seconds),
        format,
    }
}

fn sample() -> Sample<1> {
    let points = vec![[0.1], [0.25], [1e-300], [1.0 / 3.0]];
    Sample::normalised(points, vec![1.0, 2.0, 0.0, 5.0], Domain::whole()).unwrap()
}

fn answer(command: &Command) -> Evaluation {
    let grid = Grid::new([0.0], [1.0], [5]).unwrap();
    command
        .fit(&sample())
        .unwrap()
        .evaluate(Targets::Grid(&grid))
}

fn failure(script: &str) -> String {
    let found = answer(&shell(script, Format::Csv, 20.0));
    assert_eq!(found.values.len(), 5);
    assert!(found.values.iter().all(|v| v.is_nan()));
    found.failure.unwrap()
}

#[test]
fn a_program_is_told_points_weights_and_targets_in_full() {
    let fitted = Fitted {
        command: shell("", Format::Csv, 1.0),
        sample: sample(),
    };
    let told = String::from_utf8(fitted.input(&[[0.5], [2.0]])).unwrap();
    assert_eq!(
        told,
        "4 2 1\n0.1,0.125\n0.25,0.25\n1e-300,0.0\n0.3333333333333333,0.625\n0.5\n2.0\n"
    );
    let fitted = Fitted {
        command: shell("", Format::Binary, 1.0),
        sample: sample(),
    };
    let told = fitted.input(&[[0.5], [2.0]]);
    assert_eq!(&told[..6], b"4 2 1\n");
    assert_eq!(told.len(), 6 + 8 * (4 * 2 + 2));
    assert_eq!(told[6 + 8 * 9..], 2.0_f64.to_le_bytes());
}

#[test]
fn answers_arrive_in_both_formats() {
    // gives the targets back
    let text = shell("sed -n '6,$p'", Format::Csv, 20.0);
    assert_eq!(
        answer(&text).values,
        [
            0.1,
            0.300_000_000_000_000_04,
            0.5,
            0.700_000_000_000_000_1,
            0.9
        ]
    );
    assert!(answer(&text).failure.is_none());
    let bytes = shell("tail -c 40", Format::Binary, 20.0);
    assert_eq!(
        answer(&bytes).values,
        [
            0.1,
            0.300_000_000_000_000_04,
            0.5,
            0.700_000_000_000_000_1,
            0.9
        ]
    );
    // one place alone
    assert_eq!(text.fit(&sample()).unwrap().at([0.5]), 0.5);
}

#[test]
fn what_goes_wrong_is_said() {
    for (script, said) in [
        (
            "cat > /dev/null; echo no luck >&2; exit 3",
            "exit status: 3; it said: no luck",
        ),
        (
            "cat > /dev/null; printf '1\\n2\\n'",
            "2 numbers for 5 targets",
        ),
        (
            "cat > /dev/null; yes 1 | head -n 6",
            "6 numbers for 5 targets",
        ),
        (
            "cat > /dev/null; printf '1\\n2\\nNaN\\n4\\n5\\n'",
            "NaN for target 3 at [0.5]",
        ),
        (
            "cat > /dev/null; printf '1\\n2\\nsoon\\n4\\n5\\n'",
            "line 3 of its answer is no number: \"soon\"",
        ),
        ("yes 1", "more than"),
        ("kill -9 $$", "signal: 9"),
        // does not even read
        ("exit 0", "0 numbers"),
    ] {
        let found = failure(script);
        assert!(
            found.contains("`sh`") && found.contains(said),
            "{script}: {found}"
        );
    }
    let missing = Command {
        program: "/nonexistent/estimator".to_owned(),
        ..shell("", Format::Csv, 1.0)
    };
    let found = answer(&missing).failure.unwrap();
    assert!(found.contains("cannot be started"), "{found}");
    let short = answer(&shell("tail -c 39", Format::Binary, 20.0))
        .failure
        .unwrap();
    assert!(short.contains("39 bytes"), "{short}");
}

#[test]
fn a_slow_program_is_killed_with_what_it_started() {
    let start = Instant::now();
    // the child of the shell holds the pipe open as well
    let found = answer(&shell("sleep 100 & sleep 100", Format::Csv, 0.3));
    assert!(start.elapsed() < Duration::from_secs(20));
    let failure = found.failure.unwrap();
    assert!(failure.contains("longer than 0.3 s"), "{failure}");
}

/// More than fits into the pipes at once, in both directions.
#[test]
fn much_input_and_output_do_not_wait_for_each_other() {
    let n = 200_000;
    let points = (0..n).map(|i| [f64::from(i)]).collect();
    let sample = Sample::equal(points, Domain::whole()).unwrap();
    let grid = Grid::new([0.0], [1.0], [100_000]).unwrap();
    let echo = shell("sed -n '200002,$p'", Format::Csv, 60.0);
    let found = echo.fit(&sample).unwrap().evaluate(Targets::Grid(&grid));
    assert!(found.failure.is_none(), "{:?}", found.failure);
    assert_eq!(found.values[99_999], grid.coordinate(0, 99_999));
}
