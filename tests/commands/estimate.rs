//! `lab estimate`.

use super::{KERNEL, old_faithful};
use crate::support::Bench;

#[test]
fn a_picture_is_drawn_where_a_picture_is_asked_for() {
    let bench = Bench::new();
    bench
        .run(&[
            "estimate",
            &old_faithful(),
            "-c",
            "eruption_min",
            "-e",
            KERNEL,
            "-o",
            "a.svg",
        ])
        .succeeds()
        .prints_nothing()
        .says_nothing();
    let picture = bench.text("a.svg");
    assert!(picture.starts_with("<svg") || picture.starts_with("<?xml"));
    assert!(picture.ends_with("</svg>") || picture.ends_with("</svg>\n"));
    assert!(picture.contains("eruption_min"));
    // names are text, not markup
    let bench = Bench::new().with("x.csv", "<script>\n1\n2\n");
    bench
        .run(&[
            "estimate", "x.csv", "-c", "<script>", "-e", KERNEL, "-o", "b.svg",
        ])
        .succeeds();
    assert!(!bench.text("b.svg").contains("<script>"));
}

#[test]
fn an_estimate_is_a_density_over_the_range_of_the_data_and_three_bandwidths_more() {
    let estimate = Bench::new().run(&[
        "estimate",
        &old_faithful(),
        "--column",
        "eruption_min",
        "-e",
        KERNEL,
    ]);
    let rows = estimate.succeeds().says_nothing().table("x,density");
    assert_eq!(rows.len(), 512);
    let width = rows[1][0] - rows[0][0];
    let (low, high) = (rows[0][0] - 0.5 * width, rows[511][0] + 0.5 * width);
    // 1.67 and 4.93 are the shortest and the longest of the 107 eruptions
    assert!(
        (low - (1.67 - 0.9)).abs() < 1e-9 && (high - (4.93 + 0.9)).abs() < 1e-9,
        "{low} {high}"
    );
    let mass: f64 = rows.iter().map(|row| row[1] * width).sum();
    assert!((0.999..=1.000_001).contains(&mass), "{mass}");
}

#[test]
fn an_estimate_is_what_the_definition_says() {
    let bench = Bench::new()
        .with("x.csv", "x,w\n0,1\n1,3\n")
        .with("t.csv", "x\n-0.5\n0\n0.25\n1\n7\n");
    let epanechnikov = |u: f64| {
        if u.abs() <= 1.0 {
            0.75 * (1.0 - u * u)
        } else {
            0.0
        }
    };
    let rule = "kernel = { shape = \"epanechnikov\", bandwidth = 0.8 }";
    let rows = bench.run(&[
        "estimate", "x.csv", "-c", "x", "-w", "w", "-e", rule, "--at", "t.csv",
    ]);
    for row in rows.succeeds().table("x,density") {
        let expected =
            (0.25 * epanechnikov(row[0] / 0.8) + 0.75 * epanechnikov((row[0] - 1.0) / 0.8)) / 0.8;
        assert!((row[1] - expected).abs() < 1e-12, "{row:?} {expected}");
    }
    let grid = bench.run(&[
        "estimate",
        "x.csv",
        "-c",
        "1",
        "-e",
        "{ histogram = { width = 0.5 } }",
        "--grid",
        "-1:2:6",
    ]);
    let rows = grid.succeeds().table("x,density");
    let expected = [
        (-0.75, 0.0),
        (-0.25, 0.0),
        (0.25, 1.0),
        (0.75, 0.0),
        (1.25, 1.0),
        (1.75, 0.0),
    ];
    for (row, (x, density)) in rows.iter().zip(expected) {
        assert!(
            (row[0] - x).abs() < 1e-12 && (row[1] - density).abs() < 1e-12,
            "{row:?}"
        );
    }
}

#[test]
fn walls_end_the_grid() {
    let bench = Bench::new().with("x.csv", "0.1\n0.5\n0.9\n");
    let rows = bench
        .run(&["estimate", "x.csv", "-e", KERNEL, "--domain", "0:"])
        .succeeds()
        .table("x,density");
    let width = rows[1][0] - rows[0][0];
    assert!((rows[0][0] - 0.5 * width).abs() < 1e-12);
    assert!((rows[511][0] + 0.5 * width - 1.8).abs() < 1e-9);
}

#[test]
fn the_order_of_things_in_a_pipe_is_theirs() {
    let bench = Bench::new();
    let line = format!(
        "lab sample --density bimodal --n 500 | lab estimate - -e '{KERNEL}' --grid -4:4:100"
    );
    let piped = bench.shell(&line).succeeds();
    assert_eq!(piped.table("x,density").len(), 100);
    bench
        .shell("lab sample --density bimodal --n 500 -o x.csv")
        .succeeds();
    let filed = bench
        .run(&[
            "estimate", "x.csv", "-e", KERNEL, "--grid", "-4:4:100", "-o", "-",
        ])
        .succeeds();
    assert_eq!(piped.stdout, filed.stdout);
    let numpy = format!(
        "lab sample --density bimodal --n 500 -o x.npy && lab estimate - -e '{KERNEL}' --grid -4:4:100 < x.npy"
    );
    assert_eq!(bench.shell(&numpy).succeeds().stdout, piped.stdout);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let bench = Bench::new();
    bench
        .shell("lab sample --density claw --n 5000 -o x.npy")
        .succeeds();
    let estimate = |threads| {
        bench
            .run(&["estimate", "x.npy", "-e", KERNEL, "--threads", threads])
            .succeeds()
            .stdout
    };
    assert_eq!(estimate("1"), estimate("2"));
    assert_eq!(estimate("1"), estimate("7"));
}

#[test]
fn explain_tells_the_plan_and_the_time_of_each_phase() {
    let bench = Bench::new().with("x.csv", "1\n2\n4\n");
    let told = bench
        .run(&["estimate", "x.csv", "-e", KERNEL, "--explain"])
        .succeeds()
        .says("engine ")
        .says("error at most ");
    let phases: Vec<&str> = told
        .stderr
        .lines()
        .filter(|line| line.starts_with("phase "))
        .collect();
    let names: Vec<&str> = phases
        .iter()
        .map(|line| line.split(' ').nth(1).unwrap())
        .collect();
    assert_eq!(names, ["read", "fit", "evaluate", "write"]);
    for phase in phases {
        let words: Vec<&str> = phase.split(' ').collect();
        assert!(words[2] == "wall" && words[4] == "cpu", "{phase}");
        let seconds: Vec<f64> = [3, 5].iter().map(|&i| words[i].parse().unwrap()).collect();
        assert!(seconds.iter().all(|&s| (0.0..60.0).contains(&s)), "{phase}");
    }
    bench
        .run(&["estimate", "x.csv", "-e", KERNEL, "--explain", "--quiet"])
        .succeeds()
        .says_nothing();
}

#[test]
fn warnings_are_told_beside_the_data() {
    let bench = Bench::new().with("x.csv", "1\n1\n1\n1\n1\n2\n");
    let rule = "kernel = { bandwidth = \"silverman\" }";
    bench
        .run(&["estimate", "x.csv", "-e", rule])
        .succeeds()
        .says("warning: more than half of the data are tied");
    bench
        .run(&["estimate", "x.csv", "-e", rule, "-q"])
        .succeeds()
        .says_nothing();
}

/// The interval about the estimate is z √(Σ (K - f̂)²/(n(n - 1))) on each side.
#[test]
fn an_interval_is_two_more_columns() {
    let bench = Bench::new()
        .with("x.csv", "x\n0\n0.1\n0.5\n0.9\n")
        .with("at.csv", "x\n0.2\n");
    let all = [
        "estimate",
        "x.csv",
        "-e",
        "kernel = { shape = \"uniform\", bandwidth = 0.35 }",
        "--at",
        "at.csv",
        "--interval",
        "0.95",
    ];
    let told = bench
        .run(&all)
        .succeeds()
        .says_nothing()
        .table("x,density,lower,upper");
    // three of four bumps of height 1/0.7
    let (height, n) = (1.0 / 0.7, 4.0);
    let mean = 0.75 * height;
    let variance = (0.75 * height * height - mean * mean) / (n - 1.0);
    let half = 1.959_963_985 * f64::sqrt(variance);
    let expected = [0.2, mean, mean - half, mean + half];
    for (told, expected) in told[0].iter().zip(expected) {
        assert!((told - expected).abs() < 1e-8, "{told} {expected}");
    }
    let all = [
        "estimate",
        "x.csv",
        "-e",
        "histogram = { width = 1 }",
        "--interval",
        "0.95",
    ];
    bench.run(&all).ends_with(2).says("--interval");
    let all = ["estimate", "x.csv", "-e", KERNEL, "--interval", "95"];
    bench.run(&all).ends_with(2).says("0.5 to 0.9999");
}
