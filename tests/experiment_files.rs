//! Experiment files: what good ones resolve to, and that bad ones are told all that is wrong, where, and what would be right.
#![allow(clippy::unwrap_used)]

use density_lab::estimator::Context;
use density_lab::experiment::{
    EstimatorSpec, Experiment, Figure, FigureKind, GridSpec, Measure, SourceSpec, Statement, read,
    schema, summary,
};
use density_lab::parameter::Value;
use proptest::prelude::*;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// A file as read from the root of the repository.
fn parse(text: &str) -> Result<Experiment, read::Problems> {
    let origin = Path::new(env!("CARGO_MANIFEST_DIR")).join("file.toml");
    read::experiment_text(text, &origin)
}

fn good(text: &str) -> Experiment {
    parse(text).unwrap_or_else(|problems| panic!("{problems}"))
}

/// A valid experiment in numbered lines; the tables below replace lines of it.
const BASE: [&str; 20] = [
    r#"question = "Which is better?""#,                    // 1
    r"seed = 7",                                           // 2
    r#"source = { density = "bimodal" }"#,                 // 3
    r"draws = [100, 200]",                                 // 4
    r"replicates = 20",                                    // 5
    r"grid = { low = -4, high = 4.0 }",                    // 6
    r"[[estimator]]",                                      // 7
    r#"name = "narrow""#,                                  // 8
    r#"kernel = { shape = "biweight", bandwidth = 0.3 }"#, // 9
    r"[[estimator]]",                                      // 10
    r#"name = "wide""#,                                    // 11
    r"kernel = { bandwidth = 0.6 }",                       // 12
    r"[[estimator]]",                                      // 13
    r#"name = "swept""#,                                   // 14
    r"kernel = { bandwidth = [0.1, 0.25] }",               // 15
    r"[[figure]]",                                         // 16
    r#"curves = { show = ["truth", "mean"] }"#,            // 17
    r"[[claim]]",                                          // 18
    r#"mise = { of = "narrow", below = "wide" }"#,         // 19
    "",                                                    // 20
];

fn with(changes: &[(usize, &str)]) -> String {
    let mut text = String::new();
    for (at, line) in BASE.iter().enumerate() {
        let line = changes
            .iter()
            .find(|(number, _)| *number == at + 1)
            .map_or(*line, |(_, line)| *line);
        writeln!(text, "{line}").unwrap();
    }
    text
}

#[test]
fn a_file_resolves_to_checked_values_with_defaults_filled_in() {
    let experiment = good(&with(&[(
        19,
        r#"exact-mise = { of = "swept, h = 0.25", over = "minimum", equals = -2.0, within = 0.05 }"#,
    )]));
    assert_eq!(experiment.name, "file");
    assert_eq!((experiment.seed, experiment.replicates), (7, 20));
    assert_eq!(experiment.draws, [100, 200]);
    assert_eq!(
        experiment.grid,
        Some(GridSpec {
            low: -4.0,
            high: 4.0,
            cells: 512
        })
    );
    let SourceSpec::Density { name, kind, .. } = &experiment.sources[0] else {
        panic!("a density")
    };
    assert_eq!((name.as_str(), kind.as_str()), ("bimodal", "mw-6"));
    let names: Vec<&str> = experiment
        .estimators
        .iter()
        .map(|e| e.name.as_str())
        .collect();
    assert_eq!(
        names,
        ["narrow", "wide", "swept, h = 0.1", "swept, h = 0.25"]
    );
    let wide = &experiment.estimators[1].values;
    assert_eq!(wide.word("shape"), Some("gaussian"), "the default");
    assert_eq!(wide.number("bandwidth"), Some(0.6));
    let sweep = experiment.estimators[3].sweep.as_ref().unwrap();
    assert_eq!(
        (sweep.group.as_str(), sweep.parameter.as_str(), sweep.value),
        ("swept", "bandwidth", 0.25)
    );
    let claim = &experiment.claims[0];
    assert_eq!(claim.line, 18);
    assert_eq!(
        claim.statement,
        Statement::Equals {
            measure: Measure::ExactMise,
            of: "swept, h = 0.25".to_owned(),
            over: Some("minimum".to_owned()),
            equals: -2.0,
            margin: 0.1,
            confidence: 0.99,
        }
    );
    assert_eq!(
        experiment.figures[0],
        Figure {
            title: "Estimates".to_owned(),
            caption: String::new(),
            estimators: Vec::new(),
            draws: None,
            kind: FigureKind::Curves {
                show: vec!["truth".to_owned(), "mean".to_owned()],
                panels: false,
            },
        }
    );
}

#[test]
fn little_is_enough_and_names_are_made() {
    let experiment = good(
        r#"
        question = "q"
        source = { density = [
            "claw",
            { normal-mixture = { components = [{ weight = 0.5, mean = 0, deviation = 1 }, { weight = 0.5, mean = 3, deviation = 0.5 }] }, name = "two" },
        ] }
        draws = 50
        estimator = [
            { kernel = { bandwidth = 0.3 } },
            { kernel = { shape = "gaussian", bandwidth = "silverman" } },
            { histogram = { width = { low = 0.05, high = 2, steps = 3 } } },
        ]
        "#,
    );
    assert_eq!((experiment.seed, experiment.replicates), (1, 1));
    assert_eq!(experiment.draws, [50]);
    assert_eq!(experiment.grid, None);
    let sources: Vec<&str> = experiment.sources.iter().map(SourceSpec::name).collect();
    assert_eq!(sources, ["claw", "two"]);
    let SourceSpec::Density { values, .. } = &experiment.sources[1] else {
        panic!("a density")
    };
    assert_eq!(values.rows("components").len(), 2);
    assert_eq!(values.rows("components")[1].number("mean"), Some(3.0));
    let names: Vec<&str> = experiment
        .estimators
        .iter()
        .map(|e| e.name.as_str())
        .collect();
    assert_eq!(
        names,
        [
            "kernel, h = 0.3",
            "kernel, gaussian, silverman",
            "histogram, width = 0.05",
            "histogram, width = 0.3162",
            "histogram, width = 2",
        ]
    );
    let widths: Vec<f64> = experiment.estimators[2..]
        .iter()
        .map(|e| e.values.number("width").unwrap())
        .collect();
    assert_eq!(
        (widths[0].to_bits(), widths[2].to_bits()),
        (0.05_f64.to_bits(), 2.0_f64.to_bits())
    );
    assert!((widths[1] - 0.1_f64.sqrt()).abs() < 1e-15);
}

#[test]
fn data_files_are_read_and_hashed() {
    let text = |column: &str| {
        format!(
            r#"
question = "q"
source = {{ file = "data/old_faithful_107/old_faithful_107.csv", columns = ["{column}"], domain = [0, inf] }}
[[estimator]]
kernel = {{ bandwidth = "silverman" }}
[[figure]]
curves = {{}}
[[claim]]
modes = {{ of = "kernel, silverman", equals = 2, margin = 0.5 }}
"#
        )
    };
    let experiment = good(&text("1"));
    assert!(experiment.draws.is_empty());
    let SourceSpec::File {
        name,
        domain,
        hash,
        path,
        ..
    } = &experiment.sources[0]
    else {
        panic!("a file")
    };
    assert_eq!(name, "old_faithful_107");
    assert_eq!(*domain, Some([0.0, f64::INFINITY]));
    assert_eq!(
        *hash,
        blake3::hash(&fs::read(path).unwrap()).to_hex().to_string()
    );
    assert_eq!(
        experiment.figures[0].kind,
        FigureKind::Curves {
            show: vec!["sample".to_owned()],
            panels: false
        }
    );
    let problems = parse(&text("minuts")).unwrap_err();
    assert_eq!(places(&problems), [(3, 76)]);
    assert!(problems.to_string().contains("eruption_min"), "{problems}");
}

fn places(problems: &read::Problems) -> Vec<(usize, usize)> {
    problems.list().iter().map(|p| (p.line, p.column)).collect()
}

/// Expected: line, column, and what the rendered problem says.
type Expected<'e> = (usize, usize, &'e [&'e str]);

/// One changed line of the base, and all of its problems in order.
const CHANGED: &[(usize, &str, &[Expected<'static>])] = &[
    // The top level.
    (1, "", &[(1, 1, &["needs `question`"])]),
    (
        1,
        r#"qestion = "x""#,
        &[(1, 1, &["no key `qestion`", "did you mean `question`?"])],
    ),
    (1, r#"question = """#, &[(1, 12, &["`question` is empty"])]),
    (
        1,
        "question = 3",
        &[(1, 12, &["must be a text in quotes, not the integer 3"])],
    ),
    (
        2,
        "seed = -1",
        &[(2, 8, &["from 0 to 9223372036854775807, not -1"])],
    ),
    (
        2,
        "seed = 9223372036854775808",
        &[(2, 8, &["from 0 to 9223372036854775807"])],
    ),
    (
        2,
        "seed = 99999999999999999999999999999999999999999999",
        &[(2, 8, &["this large"])],
    ),
    (
        2,
        "seed = 1.0",
        &[(2, 8, &["the decimal number 1.0", "did you mean `1`?"])],
    ),
    (2, "seed = \"one\"", &[(2, 8, &["not the text \"one\""])]),
    (
        2,
        "sed = 7",
        &[(2, 1, &["did you mean `seed`?", "allowed: `question`"])],
    ),
    (2, "seed = 2026-11-21", &[(2, 8, &["not a date or time"])]),
    (4, "", &[(1, 1, &["needs `draws`"])]),
    (4, "draws = 0", &[(4, 9, &["from 1 to 1000000000, not 0"])]),
    (4, "draws = []", &[(4, 9, &["empty list"])]),
    (
        4,
        "draws = [100, 100]",
        &[(4, 15, &["100 is in the list twice"])],
    ),
    (
        4,
        "draws = 9223372036854775807",
        &[(4, 9, &["from 1 to 1000000000, not 9223372036854775807"])],
    ),
    (
        4,
        "draws = nan",
        &[(4, 9, &["from 1 to 1000000000, not the decimal number nan"])],
    ),
    (
        4,
        "draws = [100, 1e400, -inf]",
        &[
            (4, 15, &["1e400 is larger than any number"]),
            (4, 22, &["-inf"]),
        ],
    ),
    (
        5,
        "replicates = 1",
        &[
            (17, 19, &["`mean` needs"]),
            (19, 1, &["at least 2 replicates", "set `replicates`"]),
        ],
    ),
    (
        5,
        "replicates = 1_000_000_000",
        &[(5, 14, &["from 1 to 10000000"])],
    ),
    (5, "replicates = true", &[(5, 14, &["not true"])]),
    (
        6,
        "grid = { low = 4, high = -4 }",
        &[(6, 26, &["low < high"])],
    ),
    (
        6,
        "grid = { low = 4, hihg = 5 }",
        &[(6, 19, &["no key `hihg`", "did you mean `high`?"])],
    ),
    (
        6,
        "grid = { low = 4 }",
        &[(6, 8, &["`grid` needs `high`: the upper end"])],
    ),
    (
        6,
        "grid = { low = 0, high = 1, cells = 1_000_000_000_000 }",
        &[(6, 37, &["from 1 to 10000000"])],
    ),
    (
        6,
        "grid = { low = 1e9, high = 1000000000.0000001 }",
        &[(6, 8, &["thinner than"])],
    ),
    (
        6,
        "grid = { low = nan, high = inf }",
        &[
            (6, 16, &["`low` must be a finite number"]),
            (6, 28, &["not inf"]),
        ],
    ),
    (
        6,
        "grid = [0, 1]",
        &[(6, 8, &["must be a table { .. }, not a list"])],
    ),
    // The source.
    (3, "", &[(1, 1, &["needs `source`"])]),
    (
        3,
        r#"source = "bimodal""#,
        &[(3, 10, &["write source = { density = \"bimodal\" }"])],
    ),
    (
        3,
        r#"source = { density = "bimodl" }"#,
        &[(3, 22, &["did you mean `bimodal`?"])],
    ),
    (
        3,
        r#"source = { desnity = "bimodal" }"#,
        &[(3, 12, &["did you mean `density`?"])],
    ),
    (
        3,
        "source = {}",
        &[(3, 10, &["neither a density nor a file"])],
    ),
    (
        3,
        r#"source = { density = "normal-mixture" }"#,
        &[(3, 22, &["needs parameters", "normal-mixture = {"])],
    ),
    (
        3,
        r"source = { density = { uniform = { low = 1, high = 0 } } }",
        &[(3, 52, &[])],
    ),
    (
        3,
        r"source = { density = { unifrom = { low = 0, high = 1 } } }",
        &[(3, 24, &["did you mean `uniform`?"])],
    ),
    (
        3,
        r"source = { density = { uniform = { low = 0, hi = 1 } } }",
        &[(3, 45, &["no key `hi`"])],
    ),
    (
        3,
        r#"source = { density = ["claw", "claw"] }"#,
        &[(3, 31, &["already"])],
    ),
    (3, "source = { density = [] }", &[(3, 22, &["empty list"])]),
    (
        3,
        "source = { density = 6 }",
        &[(3, 22, &["not the integer 6"])],
    ),
    (
        3,
        r#"source = { density = "claw", file = "x.csv" }"#,
        &[(3, 30, &["is a density already"])],
    ),
    (
        3,
        r#"source = { file = "no-such.csv", columns = ["x"] }"#,
        &[
            (3, 19, &["cannot read", "no-such.csv"]),
            (4, 1, &["has a size of its own"]),
            (5, 14, &["has no replicates"]),
            (17, 19, &[]),
            (19, 1, &["`mise` needs a known truth", "data file"]),
        ],
    ),
    // Estimators.
    (
        8,
        r#"name = """#,
        &[(8, 8, &["name of an estimator is empty"])],
    ),
    (8, "name = \"a\\u0007b\"", &[(8, 8, &["control character"])]),
    (
        8,
        "name = \" a\"",
        &[(8, 8, &["begins or ends with a space"])],
    ),
    (
        8,
        r#"name = "wide""#,
        &[
            (11, 8, &["\"wide\" already"]),
            (19, 15, &["no estimator \"narrow\""]),
        ],
    ),
    (8, "nmae = \"narrow\"", &[(8, 1, &["did you mean `name`?"])]),
    (
        9,
        "kernal = { bandwidth = 0.3 }",
        &[(9, 1, &["no key `kernal`", "did you mean `kernel`?"])],
    ),
    (9, "kernel = 0.3", &[(9, 10, &["must be a table"])]),
    (9, "", &[(7, 1, &["has no kind", "`kernel`"])]),
    (
        9,
        "bandwidth = 0.3",
        &[(9, 1, &["settings stand in the estimator's own table"])],
    ),
    (9, "kernel = {}", &[(9, 1, &["`kernel` needs `bandwidth`"])]),
    (
        9,
        "kernel = { bandwith = 0.3 }",
        &[(9, 12, &["did you mean `bandwidth`?"])],
    ),
    (
        9,
        "kernel = { bandwidth = 0 }",
        &[(9, 24, &["above 0", "not 0"])],
    ),
    (
        9,
        "kernel = { bandwidth = -0.5 }",
        &[(9, 24, &["not -0.5"])],
    ),
    (9, "kernel = { bandwidth = nan }", &[(9, 24, &["not NaN"])]),
    (9, "kernel = { bandwidth = inf }", &[(9, 24, &["not inf"])]),
    (
        9,
        "kernel = { bandwidth = 1e-320 }",
        &[(9, 24, &["too small"])],
    ),
    (
        9,
        "kernel = { bandwidth = 1e999 }",
        &[(9, 24, &["larger than any number"])],
    ),
    (
        9,
        "kernel = { bandwidth = \"silvermann\" }",
        &[(9, 24, &["did you mean `silverman`?", "`scott`"])],
    ),
    (
        9,
        "kernel = { bandwidth = true }",
        &[(9, 24, &["not true"])],
    ),
    (
        9,
        "kernel = { bandwidth = 0.3, shape = \"Gaussian\" }",
        &[(9, 37, &["did you mean `gaussian`?"])],
    ),
    (
        9,
        "kernel = { bandwidth = 0.3, shape = 1 }",
        &[(9, 37, &["not the integer 1"])],
    ),
    (
        9,
        "kernel = { bandwidth = 0.3 }\nhistogram = { width = 1 }",
        &[(10, 1, &["is a `kernel` already"])],
    ),
    (
        9,
        "kernel = { bandwidth = 0.3 }\nreplicates = 3",
        &[(10, 1, &["move the line above the first [[..]]"])],
    ),
    (
        15,
        "kernel = { bandwidth = [] }",
        &[(15, 24, &["nothing to sweep over"])],
    ),
    (
        15,
        "kernel = { bandwidth = [0.1, 0.1] }",
        &[(15, 30, &["twice"])],
    ),
    (
        15,
        "kernel = { bandwidth = [0.1, -1, \"scott\"] }",
        &[(15, 30, &["not -1"]), (15, 34, &["scott"])],
    ),
    (
        15,
        "kernel = { bandwidth = { low = 2, high = 1, steps = 5 } }",
        &[(15, 42, &["low < high"])],
    ),
    (
        15,
        "kernel = { bandwidth = { low = 1, high = 2, steps = 1 } }",
        &[(15, 53, &["from 2 to 10000"])],
    ),
    (
        15,
        "kernel = { bandwidth = { low = 1, high = 2, step = 5 } }",
        &[(15, 45, &["did you mean `steps`?"])],
    ),
    (
        15,
        "kernel = { bandwidth = { low = 1, high = 1.0000000000000002, steps = 50 } }",
        &[(15, 70, &["not 50 different numbers"])],
    ),
    (
        15,
        "kernel = { bandwidth = [0.1], shape = [\"gaussian\"] }",
        &[(15, 39, &["not a list"])],
    ),
    // Figures.
    (17, "", &[(16, 1, &["this figure has no kind"])]),
    (17, "curvs = {}", &[(17, 1, &["did you mean `curves`?"])]),
    (17, "curves = { show = [] }", &[(17, 19, &["empty list"])]),
    (
        17,
        "curves = { show = \"truth\" }",
        &[(17, 19, &["must be a list"])],
    ),
    (
        17,
        "curves = { show = [\"truht\"] }",
        &[(17, 20, &["did you mean `truth`?"])],
    ),
    (
        17,
        "curves = {}\nmodes = {}",
        &[(18, 1, &["shows `curves` already"])],
    ),
    (
        17,
        "curves = {}\nestimators = [\"narow\"]",
        &[(18, 15, &["did you mean `narrow`?"])],
    ),
    (
        17,
        "curves = {}\ndraws = 300",
        &[(18, 9, &["300 is not one of", "allowed: 100, 200"])],
    ),
    (
        17,
        "show = [\"truth\"]",
        &[(17, 1, &["belongs to the kind of figure: curves"])],
    ),
    (
        17,
        "sweep = { of = \"wide\" }",
        &[(17, 16, &["not swept over anything"])],
    ),
    (
        17,
        "sweep = { of = \"sweept\" }",
        &[(17, 16, &["did you mean `swept`?"])],
    ),
    (
        17,
        "errors = { measure = \"mse\" }",
        &[(17, 22, &["did you mean `mise`?"])],
    ),
    // Claims.
    (19, "", &[(18, 1, &["states nothing"])]),
    (19, "mse = {}", &[(19, 1, &["did you mean `mise`?"])]),
    (
        19,
        "mise = {}",
        &[(
            19,
            1,
            &["compared with nothing", "`below`, `equals`, `agrees-with`"],
        )],
    ),
    (
        19,
        "mise = { of = \"narow\", below = \"wdie\" }",
        &[
            (19, 15, &["did you mean `narrow`?"]),
            (19, 32, &["did you mean `wide`?"]),
        ],
    ),
    (
        19,
        "mise = { of = \"narrow\", belo = \"wide\" }",
        &[(19, 25, &["did you mean `below`?"])],
    ),
    (
        19,
        "mise = { below = \"wide\" }",
        &[(19, 1, &["needs `of`"])],
    ),
    (
        19,
        "mise = { of = \"wide\", below = \"wide\" }",
        &[(19, 31, &["below itself"])],
    ),
    (
        19,
        "mise = { of = \"swept\", below = \"wide\" }",
        &[(19, 15, &["a sweep of 2 estimators"])],
    ),
    (
        19,
        "mise = { of = \"wide\", below = \"narrow\", equals = 1 }",
        &[(19, 41, &["has `below` already"])],
    ),
    (
        19,
        "mise = { of = \"wide\", below = \"narrow\", confidence = 1 }",
        &[(19, 54, &["between 0.5 and 1"])],
    ),
    (
        19,
        "mise = { of = \"wide\", below = \"narrow\", by = 0 }",
        &[(19, 46, &["above 0"])],
    ),
    (
        19,
        "mise = { of = \"wide\", equals = 1 }",
        &[(19, 32, &["how far off is still equal?", "`within`"])],
    ),
    (
        19,
        "mise = { of = \"wide\", equals = 0, within = 0.1 }",
        &[(19, 44, &["share of 0 is 0"])],
    ),
    (
        19,
        "mise = { of = \"wide\", equals = 1, within = 0.1, margin = 1 }",
        &[(19, 58, &["not both"])],
    ),
    (
        19,
        "mise = { of = \"wide\", over = \"minimum\", equals = 1, within = 0.1 }",
        &[(19, 30, &["`exact-mise` only"])],
    ),
    (
        19,
        "energy = { agrees-with = \"exact\" }",
        &[(19, 1, &["no exact value for `energy`"])],
    ),
    (
        19,
        "mise = { agrees-with = \"exact\", of = [] }",
        &[(19, 38, &["empty list"])],
    ),
    (
        19,
        "modes = { of = \"wide\", count = 2 }",
        &[(19, 1, &["needs `share`"]), (19, 1, &["needs `margin`"])],
    ),
    (
        19,
        "mise = { of = \"wide\", median = 2 }",
        &[(19, 23, &["no key `median`"])],
    ),
    (
        19,
        "best = { of = \"wide\", near = \"oracle\", within = 0.1 }",
        &[(19, 15, &["not swept"])],
    ),
    (
        19,
        "oracle = { quantity = \"h_mis\", equals = 0.3 }",
        &[(19, 23, &["did you mean `h_mise`?"])],
    ),
    (
        19,
        "oracle = { quantity = \"h_mise\", equals = 0.3, digits = 40 }",
        &[(19, 56, &["from 1 to 12"])],
    ),
    (
        19,
        "mise = { of = \"wide\", below = \"narrow\" }\nsource = \"claw\"",
        &[(20, 10, &["no source \"claw\"", "`bimodal`"])],
    ),
    (
        19,
        "mise = { of = \"wide\", below = \"narrow\" }\ndraws = 7",
        &[(20, 9, &["not one of"])],
    ),
    (
        19,
        "mise = { of = \"wide\", below = \"narrow\" }\nmiae = { of = \"wide\", below = \"narrow\" }",
        &[(20, 1, &["about `mise` already"])],
    ),
    // The syntax.
    (2, "seed = ", &[(2, 0, &[])]),
    (2, "seed 7", &[(2, 0, &[])]),
    (2, "seed = 7\nseed = 8", &[(3, 1, &["given twice"])]),
    (
        2,
        "seed = seven",
        &[(2, 8, &["must stand in quotes", "did you mean `\"seven\"`?"])],
    ),
    (4, "draws = [100, 200", &[(4, 9, &["`[` is never closed"])]),
    (
        9,
        "kernel = { bandwidth = 0.3",
        &[(9, 10, &["`{` is never closed"])],
    ),
    (1, "question = \"never ended", &[(1, 0, &[])]),
    (20, "[claim]", &[(20, 0, &[])]),
];

#[test]
fn each_problem_is_located_and_says_what_is_right() {
    let mut faults = String::new();
    for (line, changed, expected) in CHANGED {
        let text = with(&[(*line, changed)]);
        let Err(problems) = parse(&text) else {
            writeln!(faults, "accepted: {changed}").unwrap();
            continue;
        };
        let shown = problems.to_string();
        let found = places(&problems);
        let as_wanted = found.len() == expected.len()
            && found
                .iter()
                .zip(*expected)
                .all(|(found, (line, column, _))| {
                    // Column 0: wherever the parser of the syntax puts it.
                    found.0 == *line && (*column == 0 || found.1 == *column)
                });
        let says = problems
            .list()
            .iter()
            .zip(*expected)
            .all(|(problem, (.., fragments))| {
                let place = format!("file.toml:{}:{}: error: ", problem.line, problem.column);
                let from = shown.find(&place).map_or("", |at| &shown[at..]);
                let until = from[1.min(from.len())..]
                    .find("file.toml:")
                    .unwrap_or(from.len());
                !from.is_empty()
                    && problem.end > problem.column
                    && fragments.iter().all(|fragment| {
                        from[..until].contains(fragment) || problem.message.contains(fragment)
                    })
            });
        if !as_wanted || !says || problems.is_input_output() {
            let wanted: Vec<_> = expected.iter().map(|(l, c, says)| (l, c, says)).collect();
            writeln!(
                faults,
                "{changed}\nexpected {wanted:?}, found {found:?}\n{shown}"
            )
            .unwrap();
        }
    }
    assert!(faults.is_empty(), "{faults}");
    assert!(CHANGED.len() > 100);
}

#[test]
fn all_problems_of_a_file_are_reported_in_its_order() {
    let text = with(&[
        (2, "seed = -1"),
        (3, r#"source = { density = "bimodl" }"#),
        (6, "grid = { low = 1, hihg = 2 }"),
        (9, r#"kernel = { shape = "gausian", bandwidth = 0 }"#),
        (12, "histgram = { width = 1 }"),
        (17, "curves = { show = [\"all\"] }"),
        (19, r#"mise = { of = "narow", equals = 1 }"#),
        (20, "author = \"me\""),
    ]);
    let problems = parse(&text).unwrap_err();
    let lines: Vec<usize> = problems.list().iter().map(|p| p.line).collect();
    assert_eq!(lines, [2, 3, 6, 9, 9, 12, 17, 19, 19, 20], "{problems}");
    // What has something wrong can still be what was meant.
    assert_eq!(problems.list()[7].suggestion.as_deref(), Some("narrow"));
}

#[test]
fn a_broken_line_does_not_hide_the_others() {
    let text = with(&[
        (2, "seed = = 3"),
        (9, "kernel = { bandwidth = -1 }"),
        (11, "name = wide"),
        (17, "curvs = {}"),
    ]);
    let problems = parse(&text).unwrap_err();
    let lines: Vec<usize> = problems.list().iter().map(|p| p.line).collect();
    assert_eq!(lines, [2, 9, 11, 17], "{problems}");
}

#[test]
fn problems_are_drawn_with_the_line_and_the_mark() {
    let problems = parse(&with(&[(9, "kernel = { bandwith = 0.3 }")])).unwrap_err();
    let origin = Path::new(env!("CARGO_MANIFEST_DIR")).join("file.toml");
    let shown = problems
        .to_string()
        .replace(&origin.display().to_string(), "file.toml");
    assert_eq!(
        shown,
        "file.toml:9:12: error: `kernel` has no key `bandwith`
  |
9 | kernel = { bandwith = 0.3 }
  |            ^^^^^^^^
  |
  = help: did you mean `bandwidth`?
  = note: allowed: `shape`, `bandwidth`, `boundary`
"
        .replace("`shape`, `bandwidth`, `boundary`", &kernel_settings())
    );
    assert!(!shown.contains('\u{1b}'));
    assert!(problems.render(true).contains('\u{1b}'));
}

fn kernel_settings() -> String {
    let entry = density_lab::experiment::catalogue::estimator("kernel").unwrap();
    let names: Vec<&str> = entry.parameters.iter().map(|p| p.name).collect();
    density_lab::parameter::listed(&names)
}

#[test]
fn names_from_files_cannot_write_to_the_terminal() {
    let text = with(&[(
        9,
        "kernel = { \"\\u001b[31mred\\u202e\" = 1, bandwidth = 0.3 }",
    )]);
    let shown = parse(&text).unwrap_err().to_string();
    assert!(!shown.contains(['\u{1b}', '\u{202e}']), "{shown}");
    let text = with(&[(9, "kernel = { bandwidth = \"\u{1b}]0;x\u{7}\" }")]);
    let shown = parse(&text).unwrap_err().to_string();
    assert!(!shown.contains(['\u{1b}', '\u{7}']), "{shown}");
}

#[test]
fn large_counts_are_refused_with_what_they_would_need() {
    for (line, changed, place, says) in [
        (4, "draws = 1_000_000_000", (4, 9), "samples"),
        (
            5,
            "replicates = 10_000_000",
            (5, 14),
            "errors of each replicate",
        ),
        (
            6,
            "grid = { low = 0, high = 1, cells = 10_000_000 }",
            (6, 8),
            "on the grid",
        ),
    ] {
        let text = with(&[(line, changed)]);
        match parse(&text) {
            // A machine may be large enough.
            Ok(experiment) => assert!(
                density_lab::experiment::budget::budget(&experiment)
                    .check(1 << 30)
                    .unwrap_err()
                    .what
                    .contains(says)
            ),
            Err(problems) => {
                assert_eq!(places(&problems), [place], "{problems}");
                let shown = problems.to_string();
                assert!(
                    shown.contains("GiB of memory") && shown.contains(says),
                    "{shown}"
                );
            }
        }
    }
    let text = with(&[
        (4, "draws = 100_000_000"),
        (5, "replicates = 10_000_000"),
        (6, "grid = { low = 0, high = 1, cells = 1 }"),
    ]);
    let problems = parse(&text).unwrap_err();
    assert!(
        problems.list().iter().all(|p| p.line == 4 || p.line == 5),
        "{problems}"
    );
}

#[test]
fn files_that_cannot_be_read_are_told_from_wrong_ones() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let read = |path: &Path| read::experiment(path).unwrap_err();
    assert!(read(&path("missing.toml")).is_input_output());
    assert!(read(folder.path()).is_input_output());

    fs::write(
        path("latin.toml"),
        b"question = \"a\"\nnotes = \"caf\xe9\"\n",
    )
    .unwrap();
    let problems = read(&path("latin.toml"));
    assert!(!problems.is_input_output());
    assert_eq!(places(&problems), [(2, 13)]);
    assert!(problems.to_string().contains("0xe9"), "{problems}");

    fs::write(path("large.toml"), "#".repeat(read::LARGEST + 1)).unwrap();
    let problems = read(&path("large.toml"));
    assert!(!problems.is_input_output() && problems.to_string().contains("8 MiB"));

    // A byte order mark and the line ends of another system are no faults.
    let text = format!("\u{feff}{}", with(&[]).replace('\n', "\r\n"));
    fs::write(path("dos.toml"), text).unwrap();
    assert_eq!(read::experiment(&path("dos.toml")).unwrap().name, "dos");
}

#[test]
fn data_without_spread_are_refused_where_a_rule_wants_one() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("tied.csv"), "x\n1\n1\n1\n").unwrap();
    let text = |bandwidth: &str| {
        format!(
            "question = \"q\"\nsource = {{ file = \"tied.csv\", columns = [\"x\"] }}\n[[estimator]]\nkernel = {{ bandwidth = {bandwidth} }}\n"
        )
    };
    let origin = folder.path().join("x.toml");
    let problems = read::experiment_text(&text("\"silverman\""), &origin).unwrap_err();
    assert_eq!(places(&problems), [(4, 24)], "{problems}");
    assert!(problems.to_string().contains("no spread"), "{problems}");
    assert!(read::experiment_text(&text("0.3"), &origin).is_ok());
    let problems = read::experiment_text(&text("\"oracle\""), &origin).unwrap_err();
    assert_eq!(places(&problems), [(4, 24)], "{problems}");

    let one = with(&[(4, "draws = 1"), (12, "kernel = { bandwidth = \"scott\" }")]);
    assert_eq!(places(&parse(&one).unwrap_err()), [(12, 24)]);
}

#[test]
fn one_estimator_is_read_with_or_without_braces() {
    let context = Context {
        truth: None,
        draws: 10,
    };
    for text in [
        "{ kernel = { shape = \"cosine\", bandwidth = 0.3 } }",
        "kernel = { shape = \"cosine\", bandwidth = 0.3 }",
    ] {
        let (spec, _) = read::estimator_in(text, "--estimator", &context).unwrap();
        let EstimatorSpec { kind, values, .. } = spec;
        assert_eq!(kind, "kernel");
        assert_eq!(values.get("bandwidth"), Some(&Value::Number(0.3)));
        assert_eq!(values.word("shape"), Some("cosine"));
    }
    for (text, column, says) in [
        ("{ kernel = { bandwidth = -1 } }", 26, "above 0"),
        ("{ kernl = { bandwidth = 1 } }", 3, "did you mean `kernel`?"),
        ("kernel = { bandwith = 1 }", 12, "did you mean `bandwidth`?"),
        (
            "{ kernel = { bandwidth = [1, 2] } }",
            27,
            "a sweep makes many",
        ),
        ("{ kernel = { bandwidth = 1 }", 1, "never closed"),
        ("kernel", 1, ""),
        ("", 1, "no kind"),
        ("{}", 1, "no kind"),
        ("3", 1, ""),
        ("{ kernel = { bandwidth = 1 } } extra", 32, ""),
    ] {
        let problems = read::estimator(text, "--estimator").unwrap_err();
        let shown = problems.to_string();
        let first = &problems.list()[0];
        assert!(shown.contains(says), "{text}\n{shown}");
        assert!(
            first.line == 1 && (says.is_empty() || first.column == column),
            "{text}\n{shown}"
        );
    }
    let problems = read::estimator_in("kernel = { bandwidth = \"oracle\" }", "x", &context);
    assert_eq!(places(&problems.err().unwrap()), [(1, 24)]);
}

#[test]
fn deep_nesting_and_long_lines_are_refused_in_bounded_time_and_space() {
    for text in [
        "a = ".to_owned() + &"[".repeat(100_000),
        "a = ".to_owned() + &"{a=".repeat(100_000),
        "a.".repeat(100_000) + "b = 1",
        format!("[{}b]", "a.".repeat(100_000)),
        "[[x]]\n".repeat(100_000),
        "=".repeat(1_000_000),
        "x".repeat(8_000_000),
        format!("question = \"{}\"", "y".repeat(8_000_000)),
        format!("{} = 1", "z".repeat(1_000_000)),
        "\"".repeat(200_000),
        "a = 1\n".repeat(40_000),
    ] {
        let problems = parse(&text).unwrap_err();
        assert!(problems.to_string().len() < 200_000);
    }
}

#[test]
fn a_summary_says_what_will_be_done() {
    let experiment = good(&with(&[]));
    let text = summary(&experiment);
    for fragment in [
        "question    Which is better?",
        "the density bimodal (mw-6)",
        "\"swept\": kernel",
        "2 values of bandwidth from 0.1 to 0.25",
        "line 18: mise of narrow is below that of wide",
        "160 estimates",
        "of memory",
    ] {
        assert!(text.contains(fragment), "no {fragment} in\n{text}");
    }
}

/// Every experiment that comes with the program.
fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments");
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut found: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    found.sort();
    found
}

#[test]
fn shipped_experiments_are_sound_and_obey_the_schema() {
    let schema = schema::json_schema();
    for path in shipped() {
        read::experiment(&path).unwrap_or_else(|problems| panic!("{problems}"));
        let document: toml::Value = toml::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        obeys(&document, &schema).unwrap_or_else(|fault| panic!("{}: {fault}", path.display()));
    }
    let document: toml::Value = toml::from_str(&with(&[])).unwrap();
    obeys(&document, &schema).unwrap();
}

#[test]
fn the_schema_refuses_what_it_can_express_and_explains_what_it_takes() {
    let schema = schema::json_schema();
    for (line, changed) in [
        (1, ""),
        (2, "seed = -1"),
        (2, "sed = 7"),
        (4, "draws = 0"),
        (4, "draws = 1.5"),
        (6, "grid = { low = 0 }"),
        (3, "source = { density = \"bimodl\" }"),
        (9, "kernel = { bandwidth = 0 }"),
        (9, "kernel = { bandwith = 0.3 }"),
        (9, "kernel = { bandwidth = \"silvermann\" }"),
        (9, "kernel = { bandwidth = 0.3 }\nhistogram = { width = 1 }"),
        (17, "curves = { show = [\"truht\"] }"),
        (19, "mise = { of = \"wide\", belo = \"narrow\" }"),
        (19, ""),
    ] {
        let document: toml::Value = toml::from_str(&with(&[(line, changed)])).unwrap();
        assert!(obeys(&document, &schema).is_err(), "{changed}");
    }
    let estimators = &schema["properties"]["estimator"]["items"]["properties"];
    for entry in density_lab::experiment::catalogue::ESTIMATORS {
        for parameter in entry.parameters {
            let help = &estimators[entry.name]["properties"][parameter.name]["description"];
            assert_eq!(help, parameter.help, "{} {}", entry.name, parameter.name);
        }
    }
}

/// Whether `value` has the form that `schema` describes, as far as our schemas use the language.
fn obeys(value: &toml::Value, schema: &serde_json::Value) -> Result<(), String> {
    let fault = |what: &str| Err(format!("{value} {what}"));
    for (keyword, wanted) in schema.as_object().unwrap() {
        let number = value
            .as_float()
            .or_else(|| value.as_integer().map(|i| i as f64));
        let limit = wanted.as_f64();
        let sound = match keyword.as_str() {
            "$schema" | "title" | "description" | "default" => true,
            "type" => match wanted.as_str().unwrap() {
                "object" => value.is_table(),
                "array" => value.is_array(),
                "string" => value.is_str(),
                "boolean" => value.is_bool(),
                "integer" => value.is_integer(),
                "number" => number.is_some(),
                other => panic!("type {other}"),
            },
            "enum" => wanted
                .as_array()
                .unwrap()
                .iter()
                .any(|word| word.as_str() == value.as_str() && value.is_str()),
            "minimum" => number.is_none_or(|x| x >= limit.unwrap()),
            "maximum" => number.is_none_or(|x| x <= limit.unwrap()),
            "exclusiveMinimum" => number.is_none_or(|x| x > limit.unwrap()),
            "exclusiveMaximum" => number.is_none_or(|x| x < limit.unwrap()),
            "minLength" => value
                .as_str()
                .is_none_or(|s| s.chars().count() as f64 >= limit.unwrap()),
            "maxLength" => value
                .as_str()
                .is_none_or(|s| s.chars().count() as f64 <= limit.unwrap()),
            "minItems" => value
                .as_array()
                .is_none_or(|a| a.len() as f64 >= limit.unwrap()),
            "maxItems" => value
                .as_array()
                .is_none_or(|a| a.len() as f64 <= limit.unwrap()),
            "uniqueItems" => value
                .as_array()
                .is_none_or(|a| a.iter().enumerate().all(|(i, x)| !a[..i].contains(x))),
            "items" => {
                for item in value.as_array().into_iter().flatten() {
                    obeys(item, wanted)?;
                }
                true
            }
            "properties" => {
                for (key, item) in value.as_table().into_iter().flatten() {
                    if let Some(schema) = wanted.get(key) {
                        obeys(item, schema).map_err(|fault| format!("{key}: {fault}"))?;
                    }
                }
                true
            }
            "additionalProperties" => {
                assert_eq!(wanted.as_bool(), Some(false));
                let known = schema["properties"].as_object().unwrap();
                value
                    .as_table()
                    .is_none_or(|table| table.keys().all(|key| known.contains_key(key)))
            }
            "required" => value.as_table().is_none_or(|table| {
                wanted
                    .as_array()
                    .unwrap()
                    .iter()
                    .all(|key| table.contains_key(key.as_str().unwrap()))
            }),
            "anyOf" => wanted
                .as_array()
                .unwrap()
                .iter()
                .any(|one| obeys(value, one).is_ok()),
            "oneOf" => {
                wanted
                    .as_array()
                    .unwrap()
                    .iter()
                    .filter(|one| obeys(value, one).is_ok())
                    .count()
                    == 1
            }
            other => panic!("the keyword {other} is not checked"),
        };
        if !sound {
            return fault(&format!("against {keyword}"));
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    /// Whatever happens to a file, the answer is an experiment or a list of located problems.
    #[test]
    fn damaged_files_are_answered(
        damage in prop::collection::vec((any::<prop::sample::Index>(), 0_u8..6, any::<prop::sample::Index>(), any::<char>()), 1..6)
    ) {
        let mut text: Vec<char> = with(&[]).chars().collect();
        const PIECES: &[&str] = &["[", "]", "{", "}", "\"", "'", "=", "\n", ",", ".", "nan", "-inf", "9223372036854775807", "1e400", "[[", "\"\"\"", "#", "\\u", "0x", "name", "kernel", "\u{0}"];
        for (place, kind, other, letter) in damage {
            let at = place.index(text.len() + 1);
            let to = (at + other.index(30)).min(text.len());
            match kind {
                0 => { text.drain(at..to); }
                1 => text.insert(at, letter),
                2 => { let copy: Vec<char> = text[at..to].to_vec(); text.splice(at..at, copy); }
                3 => { text.splice(at..at, PIECES[other.index(PIECES.len())].chars()); }
                4 => { text.splice(at..to, PIECES[other.index(PIECES.len())].chars()); }
                _ => text.truncate(text.len() - other.index(text.len() / 2 + 1)),
            }
        }
        let text: String = text.into_iter().collect();
        if let Err(problems) = parse(&text) {
            prop_assert!(!problems.list().is_empty());
            let lines = text.split('\n').count();
            for problem in problems.list() {
                prop_assert!((1..=lines).contains(&problem.line) && problem.column >= 1, "{problems}");
            }
            let _ = problems.render(true);
        }
    }

    #[test]
    fn damaged_estimators_are_answered(text in "[\\[\\]{}='\", a-z0-9.\\-]{0,40}") {
        let _ = read::estimator(&text, "x").map_err(|problems| problems.to_string());
    }
}
