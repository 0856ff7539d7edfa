//! Help, lists, completions, the schema.

use crate::support::Bench;

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
fn colours_are_for_terminals() {
    let plain = Bench::new()
        .run(&["sample", "--density", "nonsense", "--n", "3"])
        .ends_with(2);
    assert!(!plain.stderr.contains('\u{1b}'), "{plain}");
}

/// Laws come from the estimators themselves, with the settings that change them.
#[test]
fn estimators_are_listed_with_what_they_promise() {
    let listed = Bench::new()
        .run(&["list", "estimators", "--json"])
        .succeeds()
        .json();
    let of = |name: &str| {
        let rows = listed.as_array().unwrap();
        rows.iter().find(|row| row["name"] == name).unwrap().clone()
    };
    let law = |row: &serde_json::Value, space: &str, name: &str| {
        let laws = row["laws"].as_array().unwrap();
        let here = laws.iter().find(|laws| {
            let spaces = laws["space"].as_array().unwrap();
            spaces.iter().any(|known| known == space)
        });
        let laws = here.unwrap()["laws"].as_array().unwrap();
        laws.iter().find(|law| law["name"] == name).unwrap().clone()
    };
    let kernel = of("kernel");
    for space in ["line", "plane"] {
        let mass = law(&kernel, space, "mass-conserving");
        assert_eq!(mass["holds"], true, "{mass}");
        let treatments = mass["unless"]["boundary"].as_array().unwrap();
        assert!(treatments.iter().any(|t| t == "normalise"), "{mass}");
        assert!(!treatments.iter().any(|t| t == "reflect"), "{mass}");
        let even = law(&kernel, space, "reproduces-constants");
        assert_eq!(even["holds"], false, "{even}");
        let treatments = even["unless"]["boundary"].as_array().unwrap();
        assert!(treatments.iter().any(|t| t == "local-linear"), "{even}");
        let linear = law(&kernel, space, "linear");
        assert_eq!(linear["unless"]["bandwidth"][0], "a rule", "{linear}");
    }
    let nearest = of("nearest-neighbour");
    assert_eq!(law(&nearest, "plane", "mass-conserving")["holds"], false);
    assert!(law(&nearest, "line", "mass-conserving")["unless"].is_null());
    let text = Bench::new().run(&["list", "estimators"]).succeeds();
    text.prints("    laws on a line and in the plane: ")
        .prints("      reproduces-constants with boundary = ")
        .prints("    cost: ")
        .prints("    source: ");
}
