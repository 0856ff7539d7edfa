//! Each command does what its help says, and behaves among pipes, files and full disks as a program should.
#![allow(clippy::unwrap_used)]

mod support;

use std::io::{BufRead, BufReader};
use std::process::Stdio;
use support::{Bench, table};

const KERNEL: &str = "kernel = { bandwidth = 0.3 }";

fn old_faithful() -> String {
    let root = env!("CARGO_MANIFEST_DIR");
    format!("{root}/data/old_faithful_107/old_faithful_107.csv")
}

#[test]
fn help_is_data_and_teaches_by_example() {
    for command in [
        "run",
        "check",
        "list",
        "estimate",
        "select",
        "oracle",
        "sample",
        "schema",
        "completions",
    ] {
        let help = Bench::new()
            .run(&[command, "--help"])
            .succeeds()
            .says_nothing();
        assert!(help.stdout.contains("Examples:\n  lab "), "{help}");
    }
    Bench::new()
        .run(&["--help"])
        .succeeds()
        .prints("Exit codes: 0 done");
    Bench::new().run(&["--version"]).succeeds().prints("lab 0.");
    Bench::new()
        .run(&[])
        .ends_with(2)
        .says("Usage: lab")
        .prints_nothing();
}

#[test]
fn list_shows_every_kind_as_text_and_as_json() {
    let all = Bench::new()
        .run(&["list", "--json", "--quiet"])
        .succeeds()
        .json();
    for (kind, name) in [
        ("densities", "mw-6"),
        ("estimators", "kernel"),
        ("kernels", "epanechnikov"),
        ("selectors", "silverman"),
        ("boundaries", "ignore"),
        ("engines", "direct"),
    ] {
        let rows = all[kind].as_array().unwrap();
        assert!(rows.iter().any(|row| row["name"] == name), "{kind}");
        assert!(
            rows.iter()
                .all(|row| !row["summary"].as_str().unwrap().is_empty())
        );
        Bench::new()
            .run(&["list", kind])
            .succeeds()
            .says_nothing()
            .prints(name);
        let alone = Bench::new()
            .run(&["list", kind, "--json"])
            .succeeds()
            .json();
        assert_eq!(alone, all[kind]);
    }
    let kernel = all["estimators"]
        .as_array()
        .unwrap()
        .iter()
        .find(|row| row["name"] == "kernel");
    let settings = kernel.unwrap()["parameters"].as_array().unwrap();
    assert!(
        settings
            .iter()
            .any(|setting| setting["name"] == "bandwidth" && setting["default"].is_null())
    );
}

#[test]
fn list_finds_the_experiments_of_the_folder_with_their_questions() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("experiments")).unwrap();
    let bench = bench
        .with("experiments/why.toml", "question = \"Why?\"")
        .with("experiments/broken.toml", "question = ")
        .with("experiments/notes.txt", "");
    let list = bench
        .run(&["list", "experiments"])
        .succeeds()
        .says_nothing();
    let list = list
        .prints("experiments/why.toml\n    Why?")
        .prints("not a legal experiment");
    assert!(!list.stdout.contains("notes"));
    Bench::new()
        .run(&["list", "experiments"])
        .succeeds()
        .says("there is no folder `experiments` here");
}

#[test]
fn completions_are_there_for_every_shell() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = Bench::new()
            .run(&["completions", shell])
            .succeeds()
            .says_nothing();
        script
            .prints("estimate")
            .prints("bandwidth")
            .prints("completions");
    }
    // the shell that is surely here understands its own
    Bench::new()
        .shell("source <(lab completions bash) && complete -p lab")
        .succeeds()
        .prints("_lab");
}

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

#[test]
fn the_schema_is_a_schema() {
    let schema = Bench::new()
        .run(&["schema"])
        .succeeds()
        .says_nothing()
        .json();
    assert!(
        schema["$schema"]
            .as_str()
            .unwrap()
            .contains("json-schema.org")
    );
    assert!(schema["properties"]["estimator"].is_object());
}

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

#[test]
fn an_output_file_appears_whole_and_alone() {
    let bench = Bench::new()
        .with("x.csv", "1\n2\n4\n")
        .with("out.csv", "old");
    bench
        .run(&["estimate", "x.csv", "-e", KERNEL, "-o", "out.csv"])
        .succeeds()
        .prints_nothing();
    assert_eq!(table(&bench.text("out.csv"), "x,density").len(), 512);
    assert_eq!(bench.listing(), ["out.csv", "x.csv"]);
    // what fails leaves the old file as it was
    bench
        .run(&[
            "estimate",
            "x.csv",
            "-e",
            "kernel = { bandwidth = 1e-320 }",
            "-o",
            "out.csv",
        ])
        .ends_with(2);
    assert_eq!(table(&bench.text("out.csv"), "x,density").len(), 512);
    assert_eq!(bench.listing(), ["out.csv", "x.csv"]);
}

#[cfg(unix)]
#[test]
fn an_output_file_is_an_ordinary_file() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let bench = Bench::new();
    bench
        .shell("umask 022; lab sample --density uniform --n 3 -o new.csv")
        .succeeds();
    let mode = |name| {
        std::fs::metadata(bench.path(name))
            .unwrap()
            .permissions()
            .mode()
            & 0o777
    };
    assert_eq!(mode("new.csv"), 0o644);
    bench
        .shell("chmod 640 new.csv; lab sample --density uniform --n 4 -o new.csv")
        .succeeds();
    assert_eq!(mode("new.csv"), 0o640);
    symlink("new.csv", bench.path("link.csv")).unwrap();
    bench
        .shell("lab sample --density uniform --n 5 -o link.csv")
        .succeeds();
    assert!(
        std::fs::symlink_metadata(bench.path("link.csv"))
            .unwrap()
            .is_symlink()
    );
    assert_eq!(table(&bench.text("new.csv"), "x").len(), 5);
    // a device or a pipe is written to, never replaced
    bench
        .shell("mkfifo pipe; lab sample --density uniform --n 6 -o pipe & cat pipe")
        .succeeds()
        .prints("x\n0.");
    bench
        .run(&[
            "sample",
            "--density",
            "uniform",
            "--n",
            "6",
            "-o",
            "/dev/null",
        ])
        .succeeds();
    assert!(!std::fs::metadata("/dev/null").unwrap().is_file());
}

#[test]
fn a_reader_that_leaves_is_no_failure() {
    let bench = Bench::new();
    let mut child = bench
        .command(&["sample", "--density", "uniform", "--n", "1e9"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = String::new();
    BufReader::new(child.stdout.take().unwrap())
        .read_line(&mut first)
        .unwrap();
    let end = child.wait_with_output().unwrap();
    assert_eq!((first.as_str(), end.status.code()), ("x\n", Some(0)));
    assert!(
        end.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&end.stderr)
    );
    for line in [
        "lab list | head -1",
        "lab --help | head -1",
        "lab completions zsh | head -1",
        "lab list --json -q | head -1",
    ] {
        bench.shell(line).succeeds();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    let bench = Bench::new().with("x.csv", "1\n2\n4\n");
    for line in [
        "lab list > /dev/full",
        "lab list --json > /dev/full",
        "lab --help > /dev/full",
        "lab --version > /dev/full",
        "lab completions bash > /dev/full",
        "lab sample --density uniform --n 3 > /dev/full",
        "lab sample --density uniform --n 1e6 > /dev/full",
        "lab sample --density uniform --n 3 -o /dev/full",
        "lab estimate x.csv -e 'kernel = { bandwidth = 1 }' > /dev/full",
        "lab estimate x.csv -e 'kernel = { bandwidth = 1 }' -o /dev/full",
    ] {
        bench
            .shell(line)
            .ends_with(3)
            .says("No space left on device");
    }
    // nobody to tell it to
    bench
        .shell("lab list > /dev/full 2> /dev/full")
        .ends_with(3);
    bench.shell("lab list nonsense 2> /dev/full").ends_with(2);
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_command_leaves_nothing_behind() {
    let bench = Bench::new();
    let line =
        "lab sample --density uniform --n 1e9 -o big.csv & sleep 0.5; ls -A; kill -INT $!; wait $!";
    let outcome = bench.shell(line).ends_with(130).prints(".lab-");
    assert!(outcome.stderr.is_empty(), "{outcome}");
    assert!(bench.listing().is_empty(), "{:?}", bench.listing());
}

#[test]
fn colours_are_for_terminals() {
    let plain = Bench::new()
        .run(&["sample", "--density", "nonsense", "--n", "3"])
        .ends_with(2);
    assert!(!plain.stderr.contains('\u{1b}'), "{plain}");
}

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
