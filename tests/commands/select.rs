//! `lab select`.

use super::old_faithful;
use crate::support::Bench;

#[test]
fn selectors_stand_side_by_side_and_none_is_silent() {
    let all = Bench::new()
        .run(&["select", &old_faithful(), "--column", "eruption_min"])
        .succeeds()
        .says_nothing();
    assert!(all.stdout.lines().count() > 10, "{all}");
    // R's bw.nrd0, and bw.SJ summed over all pairs
    all.prints("selector,bandwidth,deviation,canonical,milliseconds,note\n")
        .prints("silverman,0.36772432238199")
        .prints("sheather-jones,0.18107139");
    let json = Bench::new()
        .run(&[
            "select",
            &old_faithful(),
            "-c",
            "eruption_min",
            "--kernel",
            "epanechnikov",
            "--selector",
            "lscv",
            "bcv",
            "--json",
        ])
        .succeeds()
        .json();
    assert_eq!(json.as_array().unwrap().len(), 2);
    assert_eq!(json[0]["selector"], "lscv");
    let (h, deviation) = (&json[1]["bandwidth"], &json[1]["deviation"]);
    let ratio = deviation.as_f64().unwrap() / h.as_f64().unwrap();
    assert!((ratio - 0.2_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn select_draws_its_criteria_and_explains_refusals() {
    let bench = Bench::new().with("one.csv", "x\n3\n3\n3\n");
    let bench = bench.with("two.csv", "x,w\n1,1\n2,3\n4,2\n7,1\n");
    bench
        .run(&[
            "select",
            "two.csv",
            "-c",
            "x",
            "-w",
            "w",
            "-s",
            "lscv",
            "silverman",
            "-o",
            "p.svg",
        ])
        .succeeds();
    bench
        .run(&["select", "one.csv"])
        .ends_with(2)
        .says("no spread")
        .prints_nothing();
    bench
        .run(&["select", "two.csv", "-c", "x", "--selector", "lsvc"])
        .ends_with(2)
        .says("did you mean `lscv`?");
    bench
        .run(&["select", "two.csv", "-c", "x", "--kernel", "gausian"])
        .ends_with(2)
        .says("did you mean `gaussian`?");
    bench
        .run(&["select", "two.csv", "-c", "x", "-o", "p.png"])
        .ends_with(2)
        .says(".svg");
    assert!(bench.listing().contains(&"p.svg".to_owned()));
}
