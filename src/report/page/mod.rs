//! The report: one self-contained HTML page that needs no network and makes no request.
//!
//! It is set like a paper: the question as its title, whether each claim holds, what was run, figures, tables, warnings, and the
//! command that makes it again. Where a bandwidth was swept, a slider moves the estimate and its errors together.
//!
//! Every text of a [`Page`] is escaped. A content security policy forbids the page everything but its own style and its
//! own script, both by hash, so that even a name that slipped through would run nothing.

mod slider;
mod table;

pub use slider::{Errors, Slider, Step};
pub use table::{Cell, Table};

use super::figure::Svg;
use super::text::escape;
use std::fmt::Write as _;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("slider.js");

/// SHA-256 of the two files above in base 64; a test tells the new value when one changes.
const STYLE_HASH: &str = "sha256-TBMrc95HTHD3gxQJLcWLUuJlx320ZTGTJvyK/f7YRTA=";
const SCRIPT_HASH: &str = "sha256-svuB9YKF3M4Zp6WufIa2DHCwYcvuS3NNifzv/jci5vI=";

/// How a claim fared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It holds.
    Pass,
    /// It does not.
    Fail,
    /// The run cannot tell.
    Undecided,
}

/// A claim and how it fared.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The claim as a sentence.
    pub text: String,
    /// How it fared.
    pub outcome: Outcome,
    /// The numbers it rests on.
    pub detail: String,
}

/// A figure with its caption.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What it is called; begins the caption.
    pub title: String,
    /// What to see in it.
    pub caption: String,
    /// The drawing.
    pub svg: Svg,
}

/// Something the reader should know before trusting a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// What is the matter.
    pub text: String,
    /// What can be done about it; may be empty.
    pub hint: String,
}

/// All that a report says.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// The question, which is the title.
    pub question: String,
    /// What the reader should know before the answer; paragraphs separated by empty lines.
    pub notes: String,
    /// The claims.
    pub claims: Vec<Verdict>,
    /// What was run: source, sample size, replicates, seed, estimators, as (name, value).
    pub facts: Vec<(String, String)>,
    /// What the reader should know before trusting a number.
    pub warnings: Vec<Warning>,
    /// The sweep to play with.
    pub slider: Option<Slider>,
    /// Figures.
    pub figures: Vec<Figure>,
    /// Tables.
    pub tables: Vec<Table>,
    /// What follows from them, in plain words; a paragraph each.
    pub verdict: Vec<String>,
    /// The command that makes this report again.
    pub command: String,
    /// Versions and revisions, as (name, value).
    pub versions: Vec<(String, String)>,
}

impl Page {
    /// The page as HTML.
    pub fn render(&self) -> String {
        let mut body = String::new();
        self.header(&mut body);
        self.claims(&mut body);
        definitions(&mut body, "What was run", &self.facts);
        self.warnings(&mut body);
        if let Some(slider) = self
            .slider
            .as_ref()
            .filter(|slider| !slider.steps.is_empty())
        {
            slider.render(&mut body);
        }
        self.figures(&mut body);
        self.tables(&mut body);
        self.verdict(&mut body);
        self.origin(&mut body);
        let script = if self.slider.is_some() {
            format!("<script>{SCRIPT}</script>\n")
        } else {
            String::new()
        };
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src '{STYLE_HASH}'; \
             script-src '{SCRIPT_HASH}'; img-src data:; base-uri 'none'; form-action 'none'\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"referrer\" content=\"no-referrer\">\n\
             <link rel=\"icon\" href=\"data:,\">\n\
             <title>{}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n{script}</body>\n</html>\n",
            escape(&self.question),
        )
    }

    fn header(&self, body: &mut String) {
        let _ = writeln!(body, "<header>\n<h1>{}</h1>", escape(&self.question));
        let count = |outcome: Outcome| {
            self.claims
                .iter()
                .filter(|claim| claim.outcome == outcome)
                .count()
        };
        let (pass, fail, open) = (
            count(Outcome::Pass),
            count(Outcome::Fail),
            count(Outcome::Undecided),
        );
        let summary = match (self.claims.len(), pass, fail, open) {
            (0, ..) => String::new(),
            (1, 1, ..) => "The claim holds.".into(),
            (1, _, 1, _) => "The claim fails.".into(),
            (1, ..) => "The claim is undecided.".into(),
            (all, pass, 0, 0) if all == pass => format!("All {all} claims hold."),
            (all, ..) => {
                let one = |count: usize, single: &str, several: &str| match count {
                    0 => None,
                    1 => Some(format!("1 {single}")),
                    _ => Some(format!("{count} {several}")),
                };
                let parts = [
                    one(pass, "holds", "hold"),
                    one(fail, "fails", "fail"),
                    one(open, "is undecided", "are undecided"),
                ];
                let parts: Vec<String> = parts.into_iter().flatten().collect();
                format!("Of {all} claims, {}.", parts.join(", "))
            }
        };
        if !summary.is_empty() {
            let _ = writeln!(body, "<p class=\"summary\">{summary}</p>");
        }
        for paragraph in self
            .notes
            .split("\n\n")
            .map(str::trim)
            .filter(|text| !text.is_empty())
        {
            let _ = writeln!(body, "<p>{}</p>", escape(paragraph));
        }
        body.push_str("</header>\n");
    }

    fn claims(&self, body: &mut String) {
        if self.claims.is_empty() {
            return;
        }
        body.push_str("<section>\n<h2>Claims</h2>\n<ul class=\"claims\">\n");
        for claim in &self.claims {
            let (class, mark, word) = match claim.outcome {
                Outcome::Pass => ("pass", "✓", "holds"),
                Outcome::Fail => ("fail", "✗", "fails"),
                Outcome::Undecided => ("open", "?", "undecided"),
            };
            let _ = writeln!(
                body,
                "<li class=\"{class}\"><span class=\"mark\" aria-hidden=\"true\">{mark}</span> \
                 <span class=\"outcome\">{word}</span> <div><p>{}</p>{}</div></li>",
                escape(&claim.text),
                paragraph("detail", &claim.detail),
            );
        }
        body.push_str("</ul>\n</section>\n");
    }

    fn warnings(&self, body: &mut String) {
        if self.warnings.is_empty() {
            return;
        }
        body.push_str("<section>\n<h2>Warnings</h2>\n<ul class=\"warnings\">\n");
        for warning in &self.warnings {
            let _ = writeln!(
                body,
                "<li><p>{}</p>{}</li>",
                escape(&warning.text),
                paragraph("detail", &warning.hint)
            );
        }
        body.push_str("</ul>\n</section>\n");
    }

    fn figures(&self, body: &mut String) {
        if self.figures.is_empty() {
            return;
        }
        body.push_str("<section>\n<h2>Figures</h2>\n");
        for (index, figure) in self.figures.iter().enumerate() {
            let _ = writeln!(
                body,
                "<figure>\n{}<figcaption><b>Figure {}.</b> {}</figcaption>\n</figure>",
                figure.svg,
                index + 1,
                caption(&figure.title, &figure.caption),
            );
        }
        body.push_str("</section>\n");
    }

    fn tables(&self, body: &mut String) {
        if self.tables.is_empty() {
            return;
        }
        body.push_str("<section>\n<h2>Tables</h2>\n");
        for (index, table) in self.tables.iter().enumerate() {
            table.render(body, index + 1);
        }
        body.push_str("</section>\n");
    }

    fn verdict(&self, body: &mut String) {
        if self.verdict.is_empty() {
            return;
        }
        body.push_str("<section>\n<h2>Verdict</h2>\n");
        for said in &self.verdict {
            let _ = writeln!(body, "<p>{}</p>", escape(said));
        }
        body.push_str("</section>\n");
    }

    fn origin(&self, body: &mut String) {
        if self.command.is_empty() && self.versions.is_empty() {
            return;
        }
        body.push_str("<footer>\n<h2>How this was made</h2>\n");
        if !self.command.is_empty() {
            let _ = writeln!(
                body,
                "<p>This command makes the same numbers again, on any number of threads:</p>"
            );
            let _ = writeln!(
                body,
                "<pre tabindex=\"0\"><code>{}</code></pre>",
                escape(&self.command)
            );
        }
        list(body, &self.versions);
        body.push_str("</footer>\n");
    }
}

fn paragraph(class: &str, text: &str) -> String {
    if text.is_empty() {
        String::new()
    } else {
        format!("<p class=\"{class}\">{}</p>", escape(text))
    }
}

/// A title as a sentence, then the caption.
fn caption(title: &str, caption: &str) -> String {
    let ended = title.ends_with(['.', '?', '!']) || title.is_empty();
    let stop = if ended { "" } else { "." };
    format!("{}{stop} {}", escape(title), escape(caption))
        .trim()
        .to_owned()
}

fn definitions(body: &mut String, heading: &str, pairs: &[(String, String)]) {
    if pairs.is_empty() {
        return;
    }
    let _ = writeln!(body, "<section>\n<h2>{heading}</h2>");
    list(body, pairs);
    body.push_str("</section>\n");
}

fn list(body: &mut String, pairs: &[(String, String)]) {
    if pairs.is_empty() {
        return;
    }
    body.push_str("<dl>\n");
    for (name, value) in pairs {
        let _ = writeln!(body, "<dt>{}</dt><dd>{}</dd>", escape(name), escape(value));
    }
    body.push_str("</dl>\n");
}

#[cfg(test)]
mod tests;
