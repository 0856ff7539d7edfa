//! `lab sample`, and a run from end to end.

use super::KERNEL;
use crate::support::Bench;

#[test]
fn a_run_ends_with_the_verdict_on_its_claims() {
    let experiment = |factor: &str| {
        format!(
            "question = \"Which?\"\nsource = {{ density = \"normal\" }}\ndraws = 100\nreplicates = 40\n[[estimator]]\nname = \"good\"\nkernel = {{ bandwidth = 0.45 }}\n[[estimator]]\nname = \"bad\"\nkernel = {{ bandwidth = 0.05 }}\n[[claim]]\nmise = {{ of = \"good\", below = \"bad\", by = {factor} }}\n"
        )
    };
    let bench = Bench::new()
        .with("right.toml", experiment("2"))
        .with("wrong.toml", experiment("1000"));
    bench
        .run(&["run", "right.toml", "--out", "right"])
        .succeeds();
    bench
        .run(&["run", "wrong.toml", "--out", "wrong"])
        .ends_with(1);
    for folder in ["right", "wrong"] {
        assert!(bench.path(folder).join("report.html").is_file());
        assert!(bench.path(folder).join("manifest.json").is_file());
    }
    assert_eq!(
        bench.listing(),
        ["right", "right.toml", "wrong", "wrong.toml"]
    );
}

#[test]
fn a_sample_is_the_same_for_the_same_seed_only() {
    let draw = |seed| {
        Bench::new()
            .run(&["sample", "--density", "claw", "--n", "200", "--seed", seed])
            .succeeds()
            .says_nothing()
    };
    assert_eq!(draw("7").stdout, draw("7").stdout);
    assert_ne!(draw("7").stdout, draw("8").stdout);
    assert_eq!(draw("7").table("x").len(), 200);
}

#[test]
fn a_sample_follows_its_density() {
    let drawn = Bench::new()
        .run(&["sample", "--density", "uniform", "--n", "1e5"])
        .succeeds();
    let x: Vec<f64> = drawn.table("x").into_iter().map(|row| row[0]).collect();
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    // six standard errors: once in 5·10⁸ seeds
    assert!(
        (mean - 0.5).abs() < 6.0 * (1.0 / (12.0 * n)).sqrt(),
        "{mean}"
    );
    assert!(x.iter().all(|x| (0.0..=1.0).contains(x)));
}

#[test]
fn csv_and_npy_carry_the_same_numbers() {
    let bench = Bench::new();
    for name in ["x.csv", "x.npy"] {
        bench
            .run(&["sample", "--density", "mw-3", "--n", "1000", "-o", name])
            .succeeds()
            .prints_nothing()
            .says_nothing();
    }
    let estimate = |name| {
        bench
            .run(&["estimate", name, "-e", KERNEL])
            .succeeds()
            .stdout
    };
    assert_eq!(estimate("x.csv"), estimate("x.npy"));
    assert_eq!(
        std::fs::metadata(bench.path("x.npy")).unwrap().len() % 64,
        8000 % 64
    );
}
