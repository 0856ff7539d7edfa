//! `lab oracle`, and densities in arguments.

use crate::support::Bench;

#[test]
fn the_oracle_knows_the_published_optima() {
    let oracle = |density, n| {
        let all = [
            "oracle",
            "--density",
            density,
            "--kernel",
            "gaussian",
            "--n",
            n,
            "--json",
        ];
        Bench::new().run(&all).succeeds().says_nothing().json()
    };
    let near = |value: &serde_json::Value, expected: f64| {
        let value = value.as_f64().unwrap();
        assert!((value / expected - 1.0).abs() < 2e-4, "{value} {expected}");
    };
    let normal = oracle("normal", "100");
    near(&normal["h_mise"], 0.4455);
    near(&normal["mise"], 5.410e-3);
    let bimodal = oracle("bimodal", "200");
    near(&bimodal["h_mise"], 0.3217);
    near(&bimodal["mise"], 4.570e-3);
    assert!(bimodal["h_amise"].is_number() && bimodal["amise"].is_number());
    let sum = bimodal["bias2"].as_f64().unwrap() + bimodal["variance"].as_f64().unwrap();
    near(&bimodal["mise"], sum);
    // the claw has a second low
    let claw = oracle("claw", "50");
    assert_eq!(claw["other_minima"].as_array().unwrap().len(), 1);
    assert!(claw["other_minima"][0]["mise"].as_f64() > claw["mise"].as_f64());
    // where a density jumps there is no AMISE, and the answer says why
    let uniform = oracle("uniform", "100");
    assert!(uniform["h_amise"].is_null() && uniform["amise"].is_null());
    assert!(uniform["reason"].as_str().unwrap().contains("infinite"));
}

#[test]
fn densities_with_parameters_are_written_as_in_a_file() {
    let bench = Bench::new();
    let oracle = |density| {
        let answer = bench.run(&["oracle", "--density", density, "--n", "200", "--json"]);
        answer.succeeds().json()["h_mise"].as_f64().unwrap()
    };
    // number 6 of Marron and Wand, by its components
    let mixture = "normal-mixture = { components = [ { weight = 0.5, mean = -1, deviation = 0.6666666666666666 }, { weight = 0.5, mean = 1, deviation = 0.6666666666666666 } ] }";
    assert!((oracle(mixture) / oracle("bimodal") - 1.0).abs() < 1e-9);
    let exponential = oracle("exponential = { rate = 2 }");
    assert!((2.0 * exponential / oracle("{ exponential = { rate = 1 } }") - 1.0).abs() < 1e-6);
    let drawn = bench
        .run(&[
            "sample",
            "--density",
            "{ beta = { a = 2, b = 3 } }",
            "--n",
            "20000",
        ])
        .succeeds()
        .says_nothing()
        .table("x");
    let mean = drawn.iter().map(|row| row[0]).sum::<f64>() / 20_000.0;
    // a/(a + b), give or take five standard errors
    assert!(
        (mean - 0.4).abs() < 5.0 * 0.2 / 20_000.0_f64.sqrt(),
        "{mean}"
    );
}

#[test]
fn the_oracle_prices_another_bandwidth() {
    let told = Bench::new()
        .run(&[
            "oracle",
            "--density",
            "bimodal",
            "--n",
            "200",
            "--bandwidth",
            "0.1",
            "--json",
        ])
        .succeeds()
        .json();
    assert!(
        (told["ratio"].as_f64().unwrap() - 2.84).abs() < 0.005,
        "{told}"
    );
    assert!(
        (told["variance"].as_f64().unwrap() - 0.0129).abs() < 5e-5,
        "{told}"
    );
    let text = Bench::new()
        .run(&[
            "oracle",
            "--density",
            "bimodal",
            "--n",
            "200",
            "--bandwidth",
            "0.1",
        ])
        .succeeds();
    text.prints("h_mise    0.32171\n")
        .prints("at bandwidth 0.1:\n  ratio     2.83554\n");
}
