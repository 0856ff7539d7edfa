//! What errors are compared with: the best of the same kind, the best kernel of one bandwidth, the best at each place.

use crate::support::Bench;
use std::collections::BTreeMap;
use std::fmt::Write;

/// An experiment about this density.
fn experiment(density: &str, estimators: &[&str]) -> String {
    let estimators: Vec<String> = estimators
        .iter()
        .enumerate()
        .map(|(i, text)| format!("[[estimator]]\nname = \"e{i}\"\n{text}\n"))
        .collect();
    let plane = ["2d", "l-shape", "triangle"];
    let grid = if plane.iter().any(|part| density.contains(part)) {
        "grid = { low = [0, 0], high = [1, 1], cells = [8, 8] }\n"
    } else {
        ""
    };
    format!(
        "question = \"?\"\nseed = 1\nsource = {{ density = {density} }}\ndraws = 500\nreplicates = 8\n{grid}{}",
        estimators.concat()
    )
}

/// The measures of each estimator of an experiment about this density.
fn measures(density: &str, estimators: &[&str]) -> BTreeMap<String, BTreeMap<String, f64>> {
    measured(experiment(density, estimators))
}

fn measured(text: String) -> BTreeMap<String, BTreeMap<String, f64>> {
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
        assert!((ratio - 1.0).abs() < 1e-3, "{name}: {ratio}");
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
    assert!((common / integrated - 1.0).abs() < 1e-3);
    assert!(!found["e2"].contains_key("over-best"));
}

/// The best of a sweep by moments at places.
fn the_rung_is_the_best_of_a_sweep(density: &str, boundary: &str, from: f64) {
    let swept: Vec<String> = (0..6)
        .map(|i| from * 1.2_f64.powi(i))
        .map(|h| format!("kernel = {{ bandwidth = {h}, boundary = \"{boundary}\" }}"))
        .collect();
    let swept: Vec<&str> = swept.iter().map(String::as_str).collect();
    let found = measures(
        density,
        &[&swept[..], &["nearest-neighbour = { k = 40 }"]].concat(),
    );
    let exact = (0..6).map(|i| found[&format!("e{i}")]["exact-mise"]);
    let exact: Vec<f64> = exact.collect();
    let least = exact.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(
        exact[0] > 1.05 * least && exact[5] > 1.05 * least,
        "{exact:?}"
    );
    for (name, measures) in &found {
        let best = measures["mise"] / measures["over-kernel"];
        assert!(
            (0.998..1.05).contains(&(least / best)),
            "{name}: {least} {best}"
        );
        // a bandwidth for each place is better, but not by much where the density is smooth
        let local = measures["mise"] / measures["over-local-kernel"];
        assert!(
            (0.3..1.0).contains(&(local / best)),
            "{name}: {local} {best}"
        );
    }
}

/// In the plane between four walls kernels are reflected.
#[test]
fn the_best_kernel_between_four_walls_is_the_best_of_a_sweep() {
    the_rung_is_the_best_of_a_sweep("\"ramp-2d\"", "reflect", 0.07);
}

/// In a polygon they are cut and normalised.
#[test]
fn the_best_kernel_in_a_polygon_is_the_best_of_a_sweep() {
    let sloping = "{ l-shape = { slope-x = 1.2, slope-y = -0.6 } }";
    the_rung_is_the_best_of_a_sweep(sloping, "normalise", 0.1);
}

/// What may be claimed of a regret is what the table has.
#[test]
fn claims_are_refused_where_the_table_has_nothing() {
    let line: &[&str] = &[
        "kernel = { bandwidth = 0.3 }",
        "kernel = { bandwidth = \"silverman\", boundary = \"reflect\" }",
        "kernel = { bandwidth = 0.3, boundary = \"jones-foster\" }",
        "histogram = { width = 0.2 }",
        "generalised-histogram = { width = 0.2 }",
        "nearest-neighbour = { k = 40 }",
        "nearest-neighbour = { k = 40, convention = \"mean-radius\" }",
        "abramson = { bandwidth = 0.3 }",
        "cosine-series = { terms = 6, low = 0.0, high = 1.0 }",
        "hermite-series = { terms = 6 }",
        "normal = {}",
    ];
    let plane: &[&str] = &[
        "kernel = { bandwidth = 0.3 }",
        "kernel = { bandwidth = 0.3, boundary = \"reflect\" }",
        "histogram = { width = 0.2 }",
        "nearest-neighbour = { k = 40 }",
        "abramson = { bandwidth = 0.3 }",
        "normal = {}",
    ];
    let mut seen = [0; 2];
    for (density, estimators) in [
        ("\"bimodal\"", line),
        ("{ truncated-exponential = { rate = 3.0 } }", line),
        ("\"half-normal\"", line),
        ("\"uniform\"", &line[..1]),
        ("{ beta = { a = 1, b = 1 } }", &line[..1]),
        ("\"normal-2d\"", plane),
        ("\"uniform-2d\"", plane),
        (
            "{ product = { x = \"uniform\", y = \"uniform\" }, name = \"2d\" }",
            &plane[..3],
        ),
        ("\"ramp-2d\"", plane),
        ("{ triangle = { slope-x = 1.2 } }", plane),
    ] {
        let found = measures(density, estimators);
        // all claims at once: each is refused on a line of its own, or not
        let mut text = experiment(density, estimators);
        let mut asked = Vec::new();
        for i in 0..estimators.len() {
            for measure in ["over-best", "over-kernel", "over-local-kernel"] {
                let _ = writeln!(
                    text,
                    "[[claim]]\n{measure} = {{ of = \"e{i}\", equals = 1, within = 0.4 }}"
                );
                asked.push((i, measure, text.lines().count()));
            }
        }
        let bench = Bench::new().with("x.toml", text);
        let told = bench.run(&["check", "x.toml"]).stderr;
        for (i, measure, line) in asked {
            let has = found[&format!("e{i}")].contains_key(measure);
            let refused = told.contains(&format!("x.toml:{line}:"));
            let what = format!("{density} {} {measure}", estimators[i]);
            assert_eq!(has, !refused, "{what}\n{told}");
            seen[usize::from(has)] += 1;
        }
    }
    assert!(seen[0] > 10 && seen[1] > 80, "{seen:?}");
}

/// Over a part of the line all errors are of that part, and integrals over the line are no measure of them.
#[test]
fn a_grid_that_is_cut_short_has_rungs_of_its_own() {
    let text = experiment(
        "\"bimodal\"",
        &[
            "kernel = { bandwidth = \"oracle\" }",
            "histogram = { width = 0.3 }",
        ],
    );
    let text = format!("grid = {{ low = -0.5, high = 0.5, cells = 50 }}\n{text}");
    let found = measured(text);
    for (over, most) in [
        ("over-best", 20.0),
        ("over-kernel", 20.0),
        ("over-local-kernel", 100.0),
    ] {
        let ratio = found["e0"][over];
        assert!((0.5..most).contains(&ratio), "{over}: {ratio}");
    }
    assert!(!found["e1"].contains_key("over-best"));
}

/// Where a kernel lays mass beyond a wall, the best is narrow, and the narrower the larger the sample: none is better than no wrong one.
#[test]
fn what_is_thinner_than_places_are_apart_is_not_compared() {
    let text = experiment("\"exponential\"", &["kernel = { bandwidth = 0.005 }"]);
    let small = measured(text.clone());
    let over = small["e0"]["exact-mise"] / small["e0"]["mise"] * small["e0"]["over-best"];
    assert!(over > 1.0, "{over}");
    let large = measured(text.replace("draws = 500", "draws = 100000"));
    assert!(!large["e0"].contains_key("over-best"));
    assert!(large["e0"].contains_key("over-kernel"));
}

/// With many sources tables are joined: a row for each, whether it has a best kernel or not.
#[test]
fn joined_tables_have_one_set_of_columns() {
    let text = experiment(
        "\"bimodal\"",
        &["kernel = { bandwidth = 0.3 }", "normal = {}"],
    );
    let sources = "[\"uniform\", \"bimodal\", \"ramp-up\", \"normal\"]";
    let text = text.replace("density = \"bimodal\"", &format!("density = {sources}"));
    let bench = Bench::new().with("x.toml", text);
    bench
        .run(&["run", "x.toml", "--out", "o", "--quiet"])
        .succeeds();
    let page = bench.text("o/report.html");
    let mut rows = 0;
    for table in page.split("<table").skip(1) {
        let table = table.split("</table>").next().unwrap();
        let (head, body) = table.split_once("</thead>").unwrap();
        let columns = head.matches("scope=\"col\"").count();
        for row in body.split("<tr>").skip(1) {
            let cells = row.matches("scope=\"row\"").count() + row.matches("<td").count();
            assert_eq!(cells, columns, "{row}");
            rows += usize::from(head.contains("Against oracles"));
        }
    }
    // for a level density the wider the better: it has the best of a kind that ignores walls alone
    assert_eq!(rows, 8, "{page}");
}
