//! Pages that `lab run` makes.

use super::{PAYLOADS, state, traces};
use crate::browser::Browser;
use serde_json::json;
use std::path::PathBuf;
use std::process::Command;

/// Runs an experiment with the program itself and returns its report; whether its claims hold does not matter here.
fn run(folder: &tempfile::TempDir, name: &str, experiment: &str) -> PathBuf {
    let file = folder.path().join(format!("{name}.toml"));
    let out = folder.path().join(name);
    std::fs::write(&file, experiment).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_lab"))
        .arg("run")
        .arg(&file)
        .arg("--out")
        .arg(&out)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(
        matches!(done.status.code(), Some(0 | 1)),
        "{name}: {said}\n{experiment}"
    );
    out.join("report.html")
}

/// A string as a TOML file writes it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.into()).to_string()
}

fn assert_inert(browser: &Browser, names: &[&str], scripts: usize) {
    assert!(!browser.has_dialogue(), "{names:?}");
    let found = traces(browser);
    assert_eq!(found["fired"], serde_json::Value::Null, "{names:?}");
    for what in ["foreign", "handlers"] {
        assert_eq!(found[what], json!([]), "{what}: {names:?}");
    }
    assert_eq!(found["scripts"], scripts, "{names:?}");
    let text = browser.run("return document.body.textContent;");
    for name in names {
        assert!(
            text.as_str().unwrap().contains(name),
            "{name} is shown as it was given"
        );
    }
    assert_eq!(browser.console(), Vec::<String>::new(), "{names:?}");
}

/// The report of a run: its slider moves, and names in the experiment's file stay names.
#[test]
fn a_run_makes_a_report_whose_slider_moves_and_whose_names_are_inert() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let mut experiment = format!(
        "question = {}\nnotes = {}\nseed = 1\nsource = {{ density = \"bimodal\" }}\ndraws = 60\nreplicates = 12\n\
         grid = {{ low = -4.0, high = 4.0, cells = 80 }}\n",
        quoted(PAYLOADS[0]),
        quoted(PAYLOADS[1]),
    );
    for (number, name) in PAYLOADS[2..].iter().enumerate() {
        let bandwidth = if number == 0 {
            "{ low = 0.1, high = 1.6, steps = 5 }".to_owned()
        } else {
            format!("{:.3}", 0.2 + 0.01 * number as f64)
        };
        experiment += &format!(
            "[[estimator]]\nname = {}\nkernel = {{ shape = \"gaussian\", bandwidth = {bandwidth} }}\n",
            quoted(name)
        );
    }
    for figure in [
        format!(
            "sweep = {{ of = {}, mark = [\"h_mise\"] }}",
            quoted(PAYLOADS[2])
        ),
        format!(
            "estimators = [{}]\ncurves = {{ show = [\"truth\", \"sample\", \"rug\"] }}",
            quoted(PAYLOADS[4])
        ),
        "errors = { measure = \"mise\" }".into(),
        "modes = {}".into(),
    ] {
        let title = quoted(PAYLOADS[3]);
        experiment += &format!("[[figure]]\ntitle = {title}\ncaption = {title}\n{figure}\n");
    }
    let (says, of) = (quoted(PAYLOADS[5]), quoted(PAYLOADS[6]));
    experiment += &format!("[[claim]]\nsays = {says}\nmodes = {{ of = {of}, median = 2 }}\n");

    browser.open(&run(&folder, "names", &experiment));
    let before = state(&browser);
    browser.press("#sweep-slider", "\u{e011}");
    let low = state(&browser);
    browser.press("#sweep-slider", "\u{e010}");
    let high = state(&browser);
    assert_eq!(
        (low["value"].as_u64(), high["value"].as_u64()),
        (Some(0), Some(4))
    );
    assert_eq!(
        (low["bandwidth"].as_str(), high["bandwidth"].as_str()),
        (Some("0.100"), Some("1.60"))
    );
    for moved in ["curve", "pointer", "dots", "cells"] {
        assert_ne!(low[moved], high[moved], "{moved}");
        assert_ne!(before[moved], serde_json::Value::Null, "{moved}");
    }
    assert_inert(&browser, &PAYLOADS, 2);
    assert_eq!(browser.asked(), Vec::<String>::new());
}

/// Names of columns, too, stay names.
#[test]
fn headers_of_data_files_are_inert() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let cell = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let header: Vec<String> = PAYLOADS.iter().map(|name| cell(name)).collect();
    let mut data = header.join(",") + "\n";
    for row in 0..20 {
        let cells: Vec<String> = (0..PAYLOADS.len())
            .map(|column| (row + column % 3).to_string())
            .collect();
        data += &(cells.join(",") + "\n");
    }
    std::fs::write(folder.path().join("data.csv"), data).unwrap();
    for (number, name) in PAYLOADS.iter().enumerate() {
        let experiment = format!(
            "question = \"What is in this column?\"\nseed = 1\nsource = {{ file = \"data.csv\", columns = [{}] }}\n\
             grid = {{ low = -5.0, high = 30.0, cells = 70 }}\n\
             [[estimator]]\nname = \"kernel\"\nkernel = {{ shape = \"gaussian\", bandwidth = 2.0 }}\n\
             [[figure]]\ntitle = \"The data\"\ncurves = {{ show = [\"sample\", \"rug\"] }}\n",
            quoted(name)
        );
        browser.open(&run(&folder, &format!("column-{number}"), &experiment));
        assert_inert(&browser, &[name], 0);
    }
    assert_eq!(browser.asked(), Vec::<String>::new());
}
