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

/// N(0, I): n^(-1/6) for the Gaussian kernel, 2.40 and 2.78 times that for the round Epanechnikov and biweight kernels. [Silverman 1986, table 4.1]
#[test]
fn the_oracle_knows_the_plane() {
    let bench = Bench::new();
    let oracle = |kernel: &str, n: &str| {
        let all = [
            "oracle",
            "--density",
            "normal-2d",
            "--kernel",
            kernel,
            "--n",
            n,
            "--json",
            "--symmetry",
            "radial",
        ];
        bench.run(&all).succeeds().says_nothing().json()
    };
    let n = 4096.0_f64;
    for (kernel, constant) in [
        ("gaussian", 1.0),
        ("epanechnikov", 2.40),
        ("biweight", 2.78),
    ] {
        let told = oracle(kernel, "4096");
        let found = told["h_amise"].as_f64().unwrap() * n.powf(1.0 / 6.0);
        assert!((found - constant).abs() < 0.005, "{kernel}: {found}");
        // the exact optimum is a little wider, its error a little less
        assert!(told["h_mise"].as_f64() > told["h_amise"].as_f64(), "{told}");
        assert!(told["mise"].as_f64() < told["amise"].as_f64(), "{told}");
    }
    // the round kernel is taken, and that is said
    let quiet = bench.run(&[
        "oracle",
        "--density",
        "normal-2d",
        "--kernel",
        "epanechnikov",
        "--n",
        "100",
    ]);
    quiet.succeeds().says("--symmetry product");
}

#[test]
fn other_estimators_have_a_best_setting_too() {
    let bench = Bench::new();
    let oracle = |estimator: &str| {
        let all = [
            "oracle",
            "--density",
            "bimodal",
            "--estimator",
            estimator,
            "--n",
            "1000",
            "--json",
        ];
        bench.run(&all).succeeds().json()
    };
    let kernel = bench
        .run(&["oracle", "--density", "bimodal", "--n", "1000", "--json"])
        .succeeds()
        .json();
    for (estimator, parameter) in [
        ("histogram", "width"),
        ("frequency-polygon", "width"),
        ("nearest-neighbour", "k"),
        ("cosine-series = { low = -4, high = 4 }", "terms"),
        ("hermite-series", "terms"),
    ] {
        let told = oracle(estimator);
        assert_eq!(told["parameter"], parameter);
        let ratio = told["mise"].as_f64().unwrap() / kernel["mise"].as_f64().unwrap();
        assert!((0.5..5.0).contains(&ratio), "{estimator}: {told}");
        let best = told["h_mise"].as_f64().unwrap();
        assert!(parameter == "width" || best.fract() == 0.0, "{told}");
    }
    let series = bench.run(&[
        "oracle",
        "--density",
        "bimodal",
        "--estimator",
        "cosine-series",
        "--n",
        "10",
    ]);
    series.ends_with(2).says("low");
    let reflected = "kernel = { bandwidth = 1, boundary = \"reflect\" }";
    let all = [
        "oracle",
        "--density",
        "uniform",
        "--estimator",
        reflected,
        "--n",
        "10",
    ];
    bench.run(&all).ends_with(2).says("--estimator");
}

#[test]
fn the_best_at_a_place_is_another_than_the_best_for_all() {
    let bench = Bench::new();
    let at = |place: &str| {
        let all = [
            "oracle",
            "--density",
            "normal",
            "--n",
            "1000",
            "--at",
            place,
            "--json",
        ];
        bench.run(&all).succeeds().says_nothing().json()
    };
    // (1/(2√π n f))^(1/5) at 0, and nothing of the kind at the point of inflection
    let middle = at("0");
    let known = (0.282_094_8 / 1000.0 / 0.398_942_3_f64).powf(0.2);
    assert!(
        (middle["h_amse"].as_f64().unwrap() / known - 1.0).abs() < 1e-6,
        "{middle}"
    );
    assert!(middle["h_mse"].as_f64().unwrap() > known);
    assert!(at("1")["h_amse"].is_null());
    assert!(at("1")["h_mse"].as_f64() > at("0")["h_mse"].as_f64());
    let plane = [
        "oracle",
        "--density",
        "normal-2d",
        "--n",
        "1000",
        "--at",
        "0,0",
    ];
    bench.run(&plane).succeeds().prints("h_mse");
    let neighbours = [
        "oracle",
        "--density",
        "normal-2d",
        "--estimator",
        "nearest-neighbour",
        "--n",
        "1000",
        "--at",
        "0,0",
        "--json",
    ];
    let told = bench.run(&neighbours).succeeds().json();
    // k³ = 32π² n² f⁴/(Δf)² with Δf = -2f
    let known = (8.0 * 1e6_f64 / 4.0).cbrt();
    assert!(
        (told["h_amse"].as_f64().unwrap() / known - 1.0).abs() < 1e-6,
        "{told} {known}"
    );
    for (place, says) in [("0,0", "1 axis"), ("x", "--at"), ("1e9", "density is 0")] {
        let all = [
            "oracle",
            "--density",
            "normal",
            "--n",
            "1000",
            "--at",
            place,
        ];
        bench.run(&all).ends_with(2).says(says);
    }
}

/// Turned bins and widths that follow a pilot, in the line and in the plane.
#[test]
fn the_oracle_knows_turned_bins_and_adaptive_widths() {
    let bench = Bench::new();
    let ask = |density: &str, estimator: &str, n: &str| {
        let all = [
            "oracle",
            "--density",
            density,
            "--estimator",
            estimator,
            "--n",
            n,
            "--json",
        ];
        bench.run(&all)
    };
    let number = |told: &serde_json::Value, key: &str| told[key].as_f64().unwrap();
    // of a round density the angle changes nothing
    let straight = ask("normal-2d", "histogram", "60").succeeds().json();
    let turned = ask("normal-2d", "histogram = { angle = 30 }", "60")
        .succeeds()
        .says_nothing()
        .json();
    for key in ["h_mise", "mise", "h_amise"] {
        let ratio = number(&turned, key) / number(&straight, key);
        assert!((ratio - 1.0).abs() < 1e-5, "{key}: {turned} {straight}");
    }
    let fixed = bench
        .run(&["oracle", "--density", "normal", "--n", "10000", "--json"])
        .succeeds()
        .json();
    let adaptive = ask("normal", "abramson = { pilot = \"truth\" }", "10000")
        .succeeds()
        .json();
    assert!(adaptive["h_amise"].is_null() && adaptive["reason"].is_string());
    assert!(number(&adaptive, "mise") < 0.96 * number(&fixed, "mise"));
    let tied = ask("normal", "abramson = { pilot = \"tied\" }", "10000").succeeds();
    tied.says("noise");
    // whose pilot is chosen from each sample, theory cannot follow
    ask("normal", "abramson", "100").ends_with(2).says("pilot");
    ask("uniform-2d", "histogram = { angle = 30 }", "100")
        .ends_with(2)
        .says("normal mixtures and products");
}
