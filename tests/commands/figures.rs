//! Which figures a run draws.

use crate::support::Bench;

fn experiment(sources: &str, estimators: &[&str]) -> String {
    let estimators = estimators
        .iter()
        .map(|name| format!("[[estimator]]\nname = \"{name}\"\nhistogram = {{ width = 0.5 }}\n"));
    format!(
        "question = \"?\"\nseed = 1\nsource = {{ density = {sources} }}\ndraws = 50\nreplicates = 4\ngrid = {{ low = -3, high = 3, cells = 24 }}\n{}[[figure]]\nerrors = {{ measure = \"mise\" }}\n",
        estimators.collect::<String>()
    )
}

/// Sources are beside each other in one figure where one estimator is compared on them, and have one each where several estimators are.
#[test]
fn one_estimator_on_several_sources_is_one_figure_of_errors() {
    for (sources, estimators, figures) in [
        ("[\"normal\", \"bimodal\"]", &["a"][..], 1),
        ("[\"normal\", \"bimodal\"]", &["a", "b"][..], 2),
        ("\"normal\"", &["a"][..], 1),
    ] {
        let bench = Bench::new().with("x.toml", experiment(sources, estimators));
        bench
            .run(&["run", "x.toml", "--out", "o", "--quiet"])
            .succeeds();
        let drawn: Vec<String> = std::fs::read_dir(bench.path("o/figures"))
            .expect("a folder of figures")
            .map(|file| std::fs::read_to_string(file.expect("a file").path()).expect("text"))
            .collect();
        assert_eq!(drawn.len(), figures, "{sources} {estimators:?}");
        if sources.starts_with('[') && estimators.len() == 1 {
            assert!(drawn[0].contains("normal") && drawn[0].contains("bimodal"));
        }
    }
}
