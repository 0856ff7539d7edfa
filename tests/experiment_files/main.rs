//! Experiment files: what good ones resolve to, and that bad ones are told all that is wrong, where, and what would be right.
#![allow(clippy::unwrap_used)]

mod changed;
mod claims;
mod damage;
mod limits;
mod schema;

use changed::CHANGED;
use density_lab::estimator::Context;
use density_lab::experiment::{
    Elsewhere, EstimatorSpec, Experiment, Figure, FigureKind, GridSpec, Limits, Measure,
    SourceSpec, Statement, read, summary,
};
use density_lab::parameter::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

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
            low: vec![-4.0],
            high: vec![4.0],
            cells: vec![512]
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
            other: Elsewhere::default(),
            equals: -2.0,
            margin: 0.1,
            confidence: 0.99,
        }
    );
    assert_eq!(
        experiment.figures[0],
        Figure {
            region: None,
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
    assert_eq!(*domain, Some(Limits::Box(vec![[0.0, f64::INFINITY]])));
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
fn one_estimator_is_read_with_or_without_braces() {
    let context: Context<1> = Context {
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
