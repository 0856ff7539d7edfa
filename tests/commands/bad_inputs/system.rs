//! Files that the system does not give, and what looks odd and is right.

use super::{KERNEL, bad, check};
use crate::support::Bench;

#[test]
fn files_that_the_system_does_not_give() {
    let on = |what, arguments: &[&'static str], says: &[&'static str]| {
        bad(what, arguments, 3, says).with("points.csv", "x\n1\n2\n4\n")
    };
    check(&[
        on(
            "missing",
            &["estimate", "nowhere.csv", "-e", KERNEL],
            &["nowhere.csv: No such file"],
        ),
        on(
            "misspelt",
            &["estimate", "point.csv", "-e", KERNEL],
            &["did you mean points.csv?"],
        ),
        on(
            "a folder",
            &["estimate", ".", "-e", KERNEL],
            &[".: is a folder; give a file"],
        ),
        on(
            "targets missing",
            &["estimate", "points.csv", "--at", "t.csv", "-e", KERNEL],
            &["t.csv: No such file"],
        ),
        on(
            "output is a folder",
            &["estimate", "points.csv", "-e", KERNEL, "-o", "."],
            &["it is a folder; give a file"],
        ),
        on(
            "no folder for the output",
            &[
                "estimate",
                "points.csv",
                "-e",
                KERNEL,
                "-o",
                "no/such/out.csv",
            ],
            &["no/such/out.csv: cannot be written: no/such does not exist"],
        ),
        on(
            "a file as folder",
            &[
                "estimate",
                "points.csv",
                "-e",
                KERNEL,
                "-o",
                "points.csv/out.csv",
            ],
            &["points.csv/out.csv: cannot be written: points.csv is not a folder"],
        ),
    ]);
    #[cfg(target_os = "linux")]
    check(&[
        on(
            "disk full",
            &["estimate", "points.csv", "-e", KERNEL, "-o", "/dev/full"],
            &["/dev/full: cannot be written", "No space left"],
        ),
        on(
            "picture on a full disk",
            &["sample", "--density", "claw", "--n", "9", "-o", "/dev/full"],
            &["No space left"],
        ),
        on(
            "nobody may write here",
            &[
                "sample",
                "--density",
                "claw",
                "--n",
                "9",
                "-o",
                "/proc/out.csv",
            ],
            &["/proc/out.csv: cannot be written"],
        ),
        on(
            "nobody may write here either",
            &[
                "sample",
                "--density",
                "claw",
                "--n",
                "9",
                "-o",
                "/sys/out.csv",
            ],
            &["/sys/out.csv: cannot be written"],
        ),
    ]);
}

/// What must work although it looks odd.
#[test]
fn odd_inputs_that_are_right() {
    let estimate = |text: &str| {
        let bench = Bench::new().with("x.csv", text);
        bench
            .run(&[
                "estimate", "x.csv", "-c", "x", "-e", KERNEL, "--grid", "0:5:10",
            ])
            .succeeds()
            .says_nothing()
            .stdout
    };
    let plain = estimate("x,y\n1,0\n2,0\n4,0\n");
    for text in [
        "\u{feff}x,y\n1,0\n2,0\n4,0\n",
        "x,y\r\n1,0\r\n2,0\r\n4,0\r\n",
        "\u{feff}\"x\",\"y\"\r\n\"1\",\"a, \"\"b\"\"\"\r\n\"2\",\"\nc\"\r\n4,?",
        "x;y\n1;0\n2;0\n4;0\n",
        "\n\nx,y\n\n1,0\n2,0\n\n4,0\n\n",
        "y,x\nNA,1e0\n,+2\nnan,.4e1",
    ] {
        assert_eq!(estimate(text), plain, "{text:?}");
    }
    let bench = Bench::new()
        .with("one.csv", "7\n")
        .with("same.csv", "7\n7\n7\n");
    for name in ["one.csv", "same.csv"] {
        bench
            .run(&["estimate", name, "-e", KERNEL])
            .succeeds()
            .says_nothing();
        bench
            .run(&["estimate", name, "-e", "histogram = { width = 0.5 }"])
            .succeeds()
            .says_nothing();
    }
    // an outlier does not make the histogram allocate a bin for each place between
    let bench = Bench::new().with("x.csv", "0\n1e15\n");
    bench
        .run(&[
            "estimate",
            "x.csv",
            "-e",
            "histogram = { width = 1e-3 }",
            "--grid",
            "0:1:4",
        ])
        .succeeds();
}
