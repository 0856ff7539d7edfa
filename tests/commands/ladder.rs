//! What errors are compared with: the best of the same kind, the best kernel of one bandwidth, the best at each place.

use crate::support::Bench;
use std::collections::BTreeMap;

/// The measures of each estimator of an experiment about this density.
fn measures(density: &str, estimators: &[&str]) -> BTreeMap<String, BTreeMap<String, f64>> {
    let estimators: Vec<String> = estimators
        .iter()
        .enumerate()
        .map(|(i, text)| format!("[[estimator]]\nname = \"e{i}\"\n{text}\n"))
        .collect();
    let grid = if density.contains("2d") {
        "grid = { low = [0, 0], high = [1, 1], cells = [12, 12] }\n"
    } else {
        ""
    };
    let text = format!(
        "question = \"?\"\nseed = 1\nsource = {{ density = {density} }}\ndraws = 500\nreplicates = 8\n{grid}{}",
        estimators.concat()
    );
    let bench = Bench::new().with("x.toml", text);
    bench
        .run(&["run", "x.toml", "--out", "o", "--quiet"])
        .succeeds();
    let table = bench.text("o/tables/summary.csv");
    let mut all: BTreeMap<String, BTreeMap<String, f64>> = BTreeMap::new();
    for row in table.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        if let Ok(value) = cells[4].parse() {
            let measures = all.entry(cells[2].to_owned()).or_default();
            measures.insert(cells[3].to_owned(), value);
        }
    }
    all
}

/// Between walls all errors are over the same grid: the best of a kind is no worse than any member, and one rung serves all estimators.
#[test]
fn between_walls_nothing_is_better_than_the_best() {
    let reflected = |h: f64| format!("kernel = {{ bandwidth = {h}, boundary = \"reflect\" }}");
    let [narrow, middle, wide] = [0.04, 0.09, 0.3].map(reflected);
    let found = measures(
        "{ truncated-exponential = { rate = 3.0 } }",
        &[
            &narrow,
            &middle,
            &wide,
            "nearest-neighbour = { k = 40 }",
            "nearest-neighbour = { k = 40, convention = \"mean-radius\" }",
            "histogram = { width = 0.1 }",
            "kernel = { bandwidth = 0.09, boundary = \"jones-foster\" }",
            "cosine-series = { terms = 6 }",
        ],
    );
    let best = |name: &str, over: &str| {
        let measures = &found[name];
        measures["mise"] / measures[over]
    };
    for (name, measures) in &found {
        if let (Some(exact), Some(over)) = (measures.get("exact-mise"), measures.get("over-best")) {
            let least = measures["mise"] / over;
            assert!(exact / least > 0.999, "{name}: {exact} {least}");
            assert!(*exact / least < 20.0, "{name}: {exact} {least}");
        }
        let common = best(name, "over-kernel") / best("e0", "over-kernel");
        assert!((common - 1.0).abs() < 1e-9, "{name}");
    }
    for name in ["e0", "e1", "e2"] {
        let ratio = best(name, "over-best") / best(name, "over-kernel");
        assert!((ratio - 1.0).abs() < 1e-9, "{name}: {ratio}");
    }
    // theory says nothing of the last kernel, is dear for mean radii, and bins have many lows
    for name in ["e4", "e5", "e6"] {
        assert!(!found[name].contains_key("over-best"), "{name}");
    }
    for name in ["e3", "e7"] {
        assert!(found[name].contains_key("over-best"), "{name}");
    }
}

/// Without walls what is integrated over the line and what is searched over a grid are the same.
#[test]
fn a_search_finds_what_theory_integrates() {
    let found = measures(
        "\"bimodal\"",
        &[
            "kernel = { bandwidth = 0.3 }",
            "kernel = { bandwidth = 0.3, boundary = \"reflect\" }",
            "abramson = { bandwidth = 0.3 }",
        ],
    );
    let best = |name: &str, over: &str| found[name]["mise"] / found[name][over];
    let [integrated, searched] = ["e0", "e1"].map(|name| best(name, "over-best"));
    assert!(
        (searched / integrated - 1.0).abs() < 1e-4,
        "{searched} {integrated}"
    );
    let common = best("e2", "over-kernel");
    assert!((common / integrated - 1.0).abs() < 1e-9);
    assert!(!found["e2"].contains_key("over-best"));
}

/// In the plane between four walls the best kernel is found by cosines: as good as the best of a sweep by moments at places.
#[test]
fn the_best_kernel_between_four_walls_is_the_best_of_a_sweep() {
    let swept: Vec<String> = (0..5)
        .map(|i| 0.06 * 1.3_f64.powi(i))
        .map(|h| format!("kernel = {{ bandwidth = {h}, boundary = \"reflect\" }}"))
        .collect();
    let swept: Vec<&str> = swept.iter().map(String::as_str).collect();
    let found = measures(
        "\"ramp-2d\"",
        &[&swept[..], &["nearest-neighbour = { k = 40 }"]].concat(),
    );
    let exact = found.values().filter_map(|m| m.get("exact-mise").copied());
    let least = exact.fold(f64::INFINITY, f64::min);
    for (name, measures) in &found {
        let best = measures["mise"] / measures["over-kernel"];
        assert!(
            (0.98..1.05).contains(&(least / best)),
            "{name}: {least} {best}"
        );
    }
}
