//! Tables: text at the left, numbers lined up at the right with their standard errors.

use super::caption;
use crate::report::text::{Column, escape, fixed, uncertain};
use std::fmt::Write as _;

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Nothing.
    Empty,
    /// Words.
    Text(String),
    /// A count.
    Count(u64),
    /// A number with its standard error, if it has one.
    Number {
        /// The number.
        value: f64,
        /// Its standard error.
        error: Option<f64>,
    },
}

impl Cell {
    /// An exact number.
    pub fn exact(value: f64) -> Self {
        Self::Number { value, error: None }
    }

    /// A measured number.
    pub fn measured(value: f64, error: f64) -> Self {
        Self::Number {
            value,
            error: Some(error),
        }
    }

    /// Words.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

/// A table with its caption.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// What it is called; begins the caption.
    pub title: String,
    /// What to see in it.
    pub caption: String,
    /// Headings.
    pub columns: Vec<String>,
    /// Rows of as many cells as there are headings; missing cells are empty.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    pub(super) fn render(&self, body: &mut String, number: usize) {
        let formats: Vec<Column> = (0..self.columns.len())
            .map(|column| Column::of(self.numbers(column), 4))
            .collect();
        let textual: Vec<bool> = (0..self.columns.len())
            .map(|column| self.is_textual(column))
            .collect();
        let class = |column: usize| {
            if textual[column] {
                ""
            } else {
                " class=\"number\""
            }
        };
        let name = caption(&self.title, &self.caption);
        let _ = writeln!(
            body,
            "<div class=\"wide\" role=\"region\" aria-label=\"Table {number}\" tabindex=\"0\">\n<table>\n\
             <caption><b>Table {number}.</b> {name}</caption>\n<thead><tr>"
        );
        for (column, heading) in self.columns.iter().enumerate() {
            let _ = write!(
                body,
                "<th scope=\"col\"{}>{}{}</th>",
                class(column),
                escape(heading),
                formats[column].scale()
            );
        }
        body.push_str("</tr></thead>\n<tbody>\n");
        for row in &self.rows {
            body.push_str("<tr>");
            for column in 0..self.columns.len() {
                let cell = match row.get(column).unwrap_or(&Cell::Empty) {
                    Cell::Empty => String::new(),
                    Cell::Text(text) => escape(text),
                    Cell::Count(count) => fixed(*count as f64, 0),
                    Cell::Number { value, error } => {
                        number_with_error(formats[column], *value, *error)
                    }
                };
                // The first column names the row.
                if column == 0 && textual[0] {
                    let _ = write!(
                        body,
                        "<th scope=\"row\"><span class=\"name\">{cell}</span></th>"
                    );
                } else {
                    let _ = write!(body, "<td{}>{cell}</td>", class(column));
                }
            }
            body.push_str("</tr>\n");
        }
        body.push_str("</tbody>\n</table>\n</div>\n");
    }

    fn cells(&self, column: usize) -> impl Iterator<Item = &Cell> {
        self.rows.iter().filter_map(move |row| row.get(column))
    }

    fn numbers(&self, column: usize) -> impl Iterator<Item = (f64, Option<f64>)> {
        self.cells(column).filter_map(|cell| match cell {
            Cell::Number { value, error } => Some((*value, *error)),
            _ => None,
        })
    }

    fn is_textual(&self, column: usize) -> bool {
        self.cells(column).any(|cell| matches!(cell, Cell::Text(_)))
    }
}

/// A number, and its error in smaller type.
fn number_with_error(format: Column, value: f64, error: Option<f64>) -> String {
    match error.filter(|error| error.is_finite()) {
        Some(error) if format.is_aligned() => {
            format!(
                "{} <small>± {}</small>",
                format.print(value),
                format.print(error)
            )
        }
        Some(error) => uncertain(value, error),
        None => format.print(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rendered(table: &Table) -> String {
        let mut body = String::new();
        table.render(&mut body, 1);
        body
    }

    #[test]
    fn a_column_shares_its_power_of_ten_and_its_last_digit() {
        let table = Table {
            title: "Errors".into(),
            caption: "means of 400 replicates".into(),
            columns: vec!["estimator".into(), "n".into(), "MISE".into()],
            rows: vec![
                vec![
                    Cell::text("h < 0.1"),
                    Cell::Count(100_000),
                    Cell::measured(4.5703e-5, 3.1e-7),
                ],
                vec![
                    Cell::text("h = 0.3"),
                    Cell::Count(200),
                    Cell::measured(1.2978e-4, 2.0e-6),
                ],
                vec![Cell::text("missing")],
            ],
        };
        let html = rendered(&table);
        assert!(html.contains("<b>Table 1.</b> Errors. means of 400 replicates"));
        assert!(
            html.contains("<th scope=\"col\" class=\"number\">MISE / 10⁻⁴</th>"),
            "{html}"
        );
        assert!(
            html.contains("<td class=\"number\">0.4570 <small>± 0.0031</small></td>"),
            "{html}"
        );
        assert!(
            html.contains("<td class=\"number\">1.2978 <small>± 0.0200</small></td>"),
            "{html}"
        );
        assert!(
            html.contains(
                "<th scope=\"row\"><span class=\"name\">h &lt; 0.1</span></th><td class=\"number\">100\u{202f}000</td>"
            )
        );
        assert!(html.contains(
            "<th scope=\"row\"><span class=\"name\">missing</span></th><td class=\"number\"></td><td class=\"number\"></td>"
        ));
    }
}
