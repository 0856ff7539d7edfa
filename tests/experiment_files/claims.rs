//! Claims that could not fail, could not be shown, or rest on theory that is not there: found before anything is computed.

use super::parse;

/// Line 20 is the claim.
const EXPERIMENT: &str = r#"question = "Which?"
source = { density = "bimodal" }
draws = 100
replicates = 400
[[estimator]]
name = "rule"
kernel = { bandwidth = "silverman" }
[[estimator]]
name = "best"
kernel = { bandwidth = "oracle" }
[[estimator]]
name = "wide"
kernel = { bandwidth = 0.6 }
[[estimator]]
name = "parametric"
normal = {}
[[estimator]]
name = "bars"
histogram = { width = [0.3, 0.5, 0.8] }
[[claim]]
"#;

/// What is told of the claim, with its place on its line.
fn told(replicates: usize, claim: &str) -> Result<(), (usize, String)> {
    let text = EXPERIMENT.replace("400", &replicates.to_string()) + claim;
    parse(&text).map(|_| ()).map_err(|problems| {
        let [problem] = problems.list() else {
            panic!("{claim}\n{problems}")
        };
        assert_eq!(problem.line, 21, "{problems}");
        (problem.column, problems.to_string())
    })
}

/// The claim is refused, the mark standing under `at`.
fn refused(replicates: usize, claim: &str, at: &str, says: &[&str]) {
    let (column, message) = told(replicates, claim).expect_err(claim);
    let place = claim.find(at).unwrap() + 1;
    assert_eq!(column, place, "{message}");
    for fragment in says {
        assert!(message.contains(fragment), "no {fragment:?} in\n{message}");
    }
}

#[test]
fn what_is_shown_only_by_luck_needs_more_replicates() {
    let share = r#"modes = { of = "wide", count = 2, share = 0.79, margin = 0.06 }"#;
    refused(
        20,
        share,
        "0.06",
        &[
            "20 replicates cannot show this",
            "`replicates` of more than",
        ],
    );
    assert_eq!(told(400, share), Ok(()));
    let median = r#"modes = { of = "wide", median = 2 }"#;
    refused(
        7,
        median,
        "2 }",
        &["no interval at confidence 0.99", "`replicates` to 8"],
    );
    assert_eq!(told(8, median), Ok(()));
    let bias = r#"bias2 = { of = "wide", agrees-with = "exact" }"#;
    refused(
        2,
        bias,
        "bias2",
        &["too few for an interval", "set `replicates` to"],
    );
}

#[test]
fn what_could_hardly_fail_is_refused_with_what_is_allowed() {
    for (claim, at, says) in [
        (
            r#"modes = { of = "wide", count = 2, share = 0.5, margin = 1 }"#,
            "1 }",
            &["between 0 and 0.5"][..],
        ),
        (
            r#"modes = { of = "wide", count = 2, share = 0.5, margin = 0.4 }"#,
            "0.4",
            &["more than half of all", "at most 0.25"],
        ),
        (
            r#"modes = { of = "wide", count = 2, share = 0.1, margin = 0.45 }"#,
            "0.45",
            &["at most 0.4"],
        ),
        (
            r#"mise = { of = "wide", over = "rule", equals = 1.1, within = 10 }"#,
            "10 }",
            &["between 0 and 0.5"],
        ),
        (
            r#"mise = { of = "wide", over = "rule", equals = 1.1, margin = 0.6 }"#,
            "0.6",
            &["half of the expected value", "below 0.55"],
        ),
        (
            r#"mise = { of = "wide", over = "rule", equals = 0, margin = 2 }"#,
            "2 }",
            &["below 1"],
        ),
        (
            r#"mise = { of = "wide", equals = 0, margin = 5 }"#,
            "5 }",
            &["zero everywhere", "below 0.23"],
        ),
        (
            r#"energy = { of = "wide", equals = 1, margin = 1 }"#,
            "1 }",
            &["below 0.5"],
        ),
        (
            r#"best = { of = "bars", near = "oracle", within = 3 }"#,
            "3 }",
            &["between 0 and 0.5"],
        ),
        (
            r#"mise = { of = "best", below = "rule", by = 0.001 }"#,
            "0.001",
            &["from 0.5 to 1000000000"],
        ),
        (
            r#"mise = { of = "best", below = "rule", confidence = 0.51 }"#,
            "0.51",
            &["from 0.9 to 0.9999"],
        ),
        (
            r#"mise = { of = "wide", agrees-with = "exact", confidence = 0.999999999 }"#,
            "0.999999999",
            &["from 0.9 to 0.9999"],
        ),
        (
            r#"oracle = { quantity = "mise", equals = 0 }"#,
            "0 }",
            &["above 0"],
        ),
    ] {
        refused(400, claim, at, says);
    }
    for claim in [
        r#"modes = { of = "wide", count = 2, share = 0.1, margin = 0.35 }"#,
        r#"mise = { of = "wide", over = "rule", equals = 1.1, margin = 0.5 }"#,
        r#"mise = { of = "wide", equals = 0, margin = 0.1 }"#,
        r#"mise = { of = "best", below = "rule", by = 0.9 }"#,
    ] {
        assert_eq!(told(400, claim), Ok(()), "{claim}");
    }
}

#[test]
fn theory_that_is_not_there_is_missed_at_once() {
    for (claim, at, says) in [
        (
            r#"exact-mise = { of = "rule", below = "wide" }"#,
            "\"rule\"",
            &["chosen from each sample (\"silverman\")", "\"oracle\""][..],
        ),
        (
            r#"exact-mise = { of = "wide", below = "parametric" }"#,
            "\"parametric\"",
            &["no theory is known for `normal`"],
        ),
        (
            r#"exact-bias2 = { of = "wide", over = "rule", equals = 1, within = 0.1 }"#,
            "\"rule\"",
            &["chosen from each sample"],
        ),
        (
            r#"mise = { agrees-with = "exact" }"#,
            "mise",
            &[
                "no exact value for \"parametric\"",
                "name in `of`",
                "`best`",
                "`wide`",
            ],
        ),
        (
            r#"mise = { of = ["wide", "rule"], agrees-with = "exact" }"#,
            "[\"wide\"",
            &["no exact value for \"rule\""],
        ),
        (
            r#"exact-mise = { of = "parametric", over = "minimum", equals = 1, within = 0.1 }"#,
            "\"parametric\"",
            &["no theory is known for `normal`"],
        ),
        (
            r#"over-best = { of = "parametric", equals = 1, within = 0.1 }"#,
            "\"parametric\"",
            &["the best of the kind of \"parametric\"", "`over-kernel`"],
        ),
        (
            r#"over-best = { of = "wide", over = "parametric", equals = 1, within = 0.1 }"#,
            "\"parametric\"",
            &["the best of the kind of \"parametric\""],
        ),
        (
            r#"bias2 = { of = "wide", below = "best" }"#,
            "\"best\"",
            &["sample by sample", "`exact-bias2`"],
        ),
        (
            r#"variance = { of = "wide", over = "best", equals = 1, within = 0.1 }"#,
            "\"best\"",
            &["sample by sample", "`exact-variance`"],
        ),
    ] {
        refused(400, claim, at, says);
    }
    for claim in [
        r#"exact-mise = { of = "best", below = "wide" }"#,
        r#"over-best = { of = "rule", equals = 1.1, within = 0.1 }"#,
        r#"over-kernel = { of = "parametric", below = "best", by = 1.5 }"#,
        r#"over-local-kernel = { of = "parametric", equals = 1, within = 0.1 }"#,
        r#"exact-mise = { of = "bars, width = 0.5", over = "minimum", equals = 1.1, within = 0.3 }"#,
        r#"mise = { of = ["wide", "best", "bars"], agrees-with = "exact" }"#,
        r#"best = { of = "bars", near = "oracle", within = 0.3 }"#,
    ] {
        assert_eq!(told(400, claim), Ok(()), "{claim}");
    }
}

#[test]
fn another_source_or_size_must_be_one_of_the_experiment_and_simulated() {
    refused(
        400,
        r#"mise = { of = "wide", equals = 1.0, within = 0.1, other-draws = 200 }"#,
        "200",
        &["200 is not one of the experiment's sample sizes", "100"],
    );
    refused(
        400,
        r#"mise = { of = "wide", below = "wide", other-source = "bimodl" }"#,
        "\"bimodl\"",
        &["there is no source \"bimodl\"", "bimodal"],
    );
    refused(
        400,
        r#"exact-mise = { of = "wide", below = "best", other-draws = 100 }"#,
        "100",
        &["exact values are compared on one source and sample size"],
    );
    refused(
        400,
        r#"mise = { of = "wide", below = "wide" }"#,
        "\"wide\" }",
        &["an estimator cannot be below itself"],
    );
    let elsewhere = r#"mise = { of = "wide", below = "wide", other-draws = 100 }"#;
    assert_eq!(told(400, elsewhere), Ok(()));
}

/// Regrets are over the whole grid, and of independent points.
#[test]
fn regrets_are_refused_where_there_is_no_least_error() {
    let of = |source: &str, claim: &str| {
        let text = format!(
            "question = \"?\"\nsource = {{ density = {source} }}\ndraws = 100\nreplicates = 400\n[[region]]\nname = \"part\"\nlow-x = 0.1\nhigh-x = 0.4\n[[estimator]]\nname = \"one\"\nnearest-neighbour = {{ k = 9 }}\n[[claim]]\n{claim}\n"
        );
        parse(&text)
            .map(|_| ())
            .map_err(|problems| problems.to_string())
    };
    let regret =
        |measure: &str| format!("{measure} = {{ of = \"one\", equals = 1, within = 0.3 }}");
    for measure in ["over-best", "over-kernel", "over-local-kernel"] {
        let claim = regret(measure);
        assert_eq!(of("\"bimodal\"", &claim), Ok(()), "{measure}");
        let part = format!("region = \"part\"\n{claim}");
        let told = of("\"bimodal\"", &part).expect_err(measure);
        assert!(
            told.contains("over the whole grid") && told.contains("leave out `region`"),
            "{told}"
        );
        let paths = "\"bimodal\", paths = { hits = 3, spread = 0.1 }";
        let told = of(paths, &claim).expect_err(measure);
        assert!(told.contains("independent points"), "{told}");
    }
    // of each source by itself, and over there
    let both = "[\"bimodal\", \"uniform\"]";
    for (more, at, sound) in [
        ("", "", false),
        ("source = \"bimodal\"\n", "", true),
        (
            "source = \"bimodal\"\n",
            ", other-source = \"uniform\"",
            false,
        ),
    ] {
        let claim = format!("{more}over-kernel = {{ of = \"one\", equals = 1, within = 0.3{at} }}");
        let told = of(both, &claim);
        assert_eq!(told.is_ok(), sound, "{claim}\n{told:?}");
        if let Err(told) = told {
            assert!(
                told.contains("no best kernel, for the source \"uniform\""),
                "{told}"
            );
        }
    }
    // the best of all k in the plane would take longer than most experiments
    let plane = |measure: &str| of("\"ramp-2d\"", &regret(measure));
    let told = plane("over-best").expect_err("dear");
    assert!(told.contains("`over-kernel` compares any"), "{told}");
    for measure in ["over-kernel", "over-local-kernel"] {
        assert_eq!(plane(measure), Ok(()), "{measure}");
    }
}
