//! What a run says on the terminal when it is done.

use crate::experiment::Experiment;
use crate::experiment::judge::short;
use crate::experiment::manifest::{Line, SummaryRow};
use comfy_table::{Cell, CellAlignment, Table, presets};
use std::fmt::Write;
use std::path::Path;

/// At most so many rows: sweeps of hundreds belong in the tables and the report.
const SHOWN: usize = 48;

/// The summary for people.
pub fn text(experiment: &Experiment, lines: &[Line], rows: &[SummaryRow], place: &Path) -> String {
    let mut text = format!("{}\n\n", experiment.question);
    let known = rows.iter().any(|row| row.mise.is_some());
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    let headings: &[&str] = if known {
        &[
            "source",
            "n",
            "estimator",
            "h",
            "MISE",
            "± s.e.",
            "exact",
            "bias²",
            "variance",
            "energy",
            "modes",
        ]
    } else {
        &["source", "n", "estimator", "h", "energy", "modes"]
    };
    let right = |text: String| Cell::new(text).set_alignment(CellAlignment::Right);
    table.set_header(headings.iter().enumerate().map(|(i, h)| {
        let aligned = if i == 0 || i == 2 {
            CellAlignment::Left
        } else {
            CellAlignment::Right
        };
        Cell::new(h).set_alignment(aligned)
    }));
    let number = |value: Option<f64>| right(value.map_or_else(|| "–".to_owned(), short));
    for row in rows.iter().take(SHOWN) {
        let mut cells = vec![
            Cell::new(&row.source),
            right(row.draws.to_string()),
            Cell::new(&row.estimator),
            number(row.smoothing),
        ];
        if known {
            cells.extend(
                [
                    row.mise,
                    row.standard_error,
                    row.exact,
                    row.bias2,
                    row.variance,
                ]
                .map(number),
            );
        }
        cells.extend([number(row.energy), number(Some(row.modes))]);
        table.add_row(cells);
    }
    // writing to a string cannot fail
    let _ = writeln!(text, "{}", table.trim_fmt());
    if rows.len() > SHOWN {
        let _ = writeln!(
            text,
            "… and {} more in {}",
            rows.len() - SHOWN,
            place.join("tables/summary.csv").display()
        );
    }
    text.push('\n');
    for line in lines {
        let mark = if line.holds { "✓" } else { "✗" };
        let _ = writeln!(text, "{mark} {}: {}", line.claim, line.detail);
    }
    let held = lines.iter().filter(|line| line.holds).count();
    let _ = writeln!(
        text,
        "{held} of {} claims hold. Report: {}",
        lines.len(),
        place.join("report.html").display()
    );
    text
}

/// The summary for programs.
pub fn json(experiment: &Experiment, lines: &[Line], rows: &[SummaryRow], place: &Path) -> String {
    let all = serde_json::json!({
        "question": experiment.question,
        "folder": place,
        "claims_hold": lines.iter().all(|line| line.holds),
        "claims": lines,
        "rows": rows,
    });
    format!("{all:#}\n")
}
