//! The slider: one bandwidth at a time, with the estimate it gives, its place on the error curves, and its errors in numbers.
//!
//! All is worked out here, paths and printed numbers included; the script only puts the chosen step in place. Without scripts the
//! page shows the first step.

use crate::report::figure::{
    Axis, Curves, Frame, Part, Role, Series, Svg, Sweep, Trace, line_in_frame, series_colour,
};
use crate::report::text::{escape, escape_json, significant, uncertain};
use serde::Serialize;
use std::fmt::Write as _;

/// Integrated squared bias, integrated variance and MISE, each with its standard error if it was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Integrated squared bias.
    pub bias2: (f64, Option<f64>),
    /// Integrated variance.
    pub variance: (f64, Option<f64>),
    /// MISE.
    pub mise: (f64, Option<f64>),
}

/// One swept bandwidth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// The bandwidth.
    pub bandwidth: f64,
    /// The estimate from this sample, on the grid.
    pub estimate: Vec<f64>,
    /// Exact errors, if the truth is known.
    pub exact: Option<Errors>,
    /// Errors over the replicates.
    pub measured: Option<Errors>,
    /// Integrated squared error of this sample's estimate, if the truth is known.
    pub ise: Option<f64>,
}

/// A sweep over bandwidths.
#[derive(Clone, Debug, Default)]
pub struct Slider {
    /// What was swept: the estimator, the sample.
    pub caption: String,
    /// The variable.
    pub x: Axis,
    /// The density.
    pub y: Axis,
    /// Where estimates and truth are given.
    pub grid: Vec<f64>,
    /// The truth on the grid, if it is known.
    pub truth: Option<Vec<f64>>,
    /// The sample.
    pub data: Vec<f64>,
    /// The bandwidths in ascending order; there must be at least one.
    pub steps: Vec<Step>,
    /// Which step is shown first.
    pub start: usize,
    /// Error against bandwidth, if there is a truth to err from.
    pub errors: Option<Sweep>,
}

/// What the script needs for one step.
#[derive(Serialize)]
struct Shown {
    bandwidth: String,
    curve: String,
    note: String,
    /// Horizontal place on the error plot.
    at: f64,
    /// Vertical places of the dots on the error plot; null hides one.
    dots: Vec<Option<f64>>,
    /// The numbers, row by row.
    cells: Vec<String>,
}

const PARTS: [&str; 3] = ["MISE", "bias²", "variance"];

impl Slider {
    pub(super) fn render(&self, body: &mut String) {
        let (estimates, frame) = self.estimates();
        let errors = self.error_plot();
        let shown = self.shown(frame, errors.as_ref().map(|(_, frame)| *frame));
        let start = self.start.min(self.steps.len() - 1);
        let first = &shown[start];

        let _ = writeln!(
            body,
            "<section id=\"sweep\">\n<h2>One bandwidth at a time</h2>\n<p>{}</p>\n\
             <div class=\"slider\">\n<label for=\"sweep-slider\">Bandwidth</label>\n\
             <input type=\"range\" id=\"sweep-slider\" min=\"0\" max=\"{}\" step=\"1\" value=\"{start}\" disabled \
             aria-valuetext=\"{}\" aria-controls=\"sweep-estimate sweep-numbers\" autocomplete=\"off\">\n\
             <output id=\"sweep-bandwidth\" for=\"sweep-slider\">{}</output>",
            escape(&self.caption),
            self.steps.len() - 1,
            first.bandwidth,
            first.bandwidth,
        );
        for (name, step) in self.jumps() {
            let _ = writeln!(
                body,
                "<button type=\"button\" disabled data-step=\"{step}\">{name}</button>"
            );
        }
        body.push_str("</div>\n<noscript><p class=\"detail\">With scripts enabled the slider moves the curve.</p></noscript>\n");
        let _ = writeln!(
            body,
            "<figure id=\"sweep-estimate\">\n{}<figcaption>The estimate at this bandwidth. <output id=\"sweep-note\" for=\"sweep-slider\">{}</output>\
             </figcaption>\n</figure>",
            estimates.with_overlay(&overlay(frame, &first.curve)),
            first.note,
        );
        self.numbers(body, first);
        if let Some((plot, frame)) = &errors {
            let _ = writeln!(
                body,
                "<figure>\n{}<figcaption>Where this bandwidth stands: the line marks it, dots its errors.</figcaption>\n</figure>",
                plot.with_overlay(&pointer(*frame, first)),
            );
        }
        let json = serde_json::to_string(&shown).unwrap_or_else(|_| "[]".into());
        let _ = writeln!(
            body,
            "<script type=\"application/json\" id=\"sweep-data\">{}</script>\n</section>",
            escape_json(&json)
        );
    }

    /// Truth, data and axes, without an estimate.
    fn estimates(&self) -> (Svg, Frame) {
        let peak = |values: &[f64]| {
            values
                .iter()
                .copied()
                .filter(|v| v.is_finite())
                .fold(0.0, f64::max)
        };
        let mut peaks: Vec<f64> = self.steps.iter().map(|step| peak(&step.estimate)).collect();
        peaks.sort_by(f64::total_cmp);
        let truth = self.truth.as_deref().map_or(0.0, peak);
        // The spikes of a tiny bandwidth must not press everything else to the floor.
        let usual = if truth > 0.0 {
            truth
        } else {
            peaks[peaks.len() / 2]
        };
        let top = peaks[peaks.len() - 1].max(truth).min(2.5 * usual);
        let low = self
            .steps
            .iter()
            .flat_map(|step| &step.estimate)
            .copied()
            .filter(|v| v.is_finite())
            .fold(0.0, f64::min);
        let y = if self.y.range.is_none() && top > low {
            self.y.clone().over(low, 1.04 * top)
        } else {
            self.y.clone()
        };
        let mut series = Vec::new();
        if let Some(truth) = &self.truth {
            series.push(Series {
                name: "truth".into(),
                x: self.grid.clone(),
                y: truth.clone(),
                role: Role::Truth,
            });
        }
        // A legend entry and nothing else: the curve itself is the script's.
        series.push(Series {
            name: "estimate".into(),
            x: self.grid.clone(),
            y: vec![f64::NAN; self.grid.len()],
            role: Role::Estimate(ESTIMATE),
        });
        let title = "Estimate at the chosen bandwidth".to_owned();
        Curves {
            description: title,
            x: self.x.clone(),
            y,
            series,
            rug: self.data.clone(),
            ..Curves::default()
        }
        .draw_stage()
    }

    /// The error curves, with those of this sample among them.
    fn error_plot(&self) -> Option<(Svg, Frame)> {
        let mut plot = self.errors.clone()?;
        let ise: Vec<(f64, f64)> = self
            .steps
            .iter()
            .filter_map(|step| Some((step.bandwidth, step.ise?)))
            .collect();
        if !ise.is_empty() {
            plot.traces.push(Trace {
                name: "ISE, this sample".into(),
                part: Part::Other(ISE),
                exact: ise,
                measured: Vec::new(),
            });
        }
        Some(plot.draw_in_frame())
    }

    fn shown(&self, frame: Frame, errors: Option<Frame>) -> Vec<Shown> {
        let rounded = |value: f64| (value * 100.0).round() / 100.0;
        let shown = |step: &Step| {
            let peak = step
                .estimate
                .iter()
                .copied()
                .fold(f64::NEG_INFINITY, f64::max);
            let note = if frame.y.place(peak) > 1.0 {
                format!("It peaks at {}, beyond the frame.", significant(peak, 3))
            } else {
                String::new()
            };
            let best = step.exact.or(step.measured);
            let values = [
                step.ise,
                best.map(|e| e.variance.0),
                best.map(|e| e.bias2.0),
                best.map(|e| e.mise.0),
            ];
            let height = |value: Option<f64>| {
                let frame = errors?;
                let value = value?;
                (0.0..=1.0)
                    .contains(&frame.y.place(value))
                    .then(|| rounded(frame.down(value)))
            };
            let mut cells = Vec::new();
            for errors in [step.exact, step.measured] {
                let values = errors.map(|e| [e.mise, e.bias2, e.variance]);
                cells.extend((0..3).map(|part| match values {
                    Some(values) => number(values[part]),
                    None => "–".into(),
                }));
            }
            cells.push(step.ise.map_or("–".into(), |ise| number((ise, None))));
            Shown {
                bandwidth: significant(step.bandwidth, 3),
                curve: line_in_frame(&frame, &self.grid, &step.estimate),
                note,
                at: errors.map_or(0.0, |frame| rounded(frame.across(step.bandwidth))),
                dots: values.into_iter().map(height).collect(),
                cells,
            }
        };
        self.steps.iter().map(shown).collect()
    }

    /// Steps worth a button.
    fn jumps(&self) -> Vec<(&'static str, usize)> {
        let least = |of: fn(&Step) -> Option<f64>| {
            let values = self
                .steps
                .iter()
                .enumerate()
                .filter_map(|(index, step)| Some((of(step).filter(|v| v.is_finite())?, index)));
            values
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .map(|(_, index)| index)
        };
        let mise = least(|step| step.exact.or(step.measured).map(|e| e.mise.0));
        let ise = least(|step| step.ise);
        [("least MISE", mise), ("least ISE", ise)]
            .into_iter()
            .filter_map(|(name, step)| Some((name, step?)))
            .collect()
    }

    fn numbers(&self, body: &mut String, first: &Shown) {
        let any = |of: fn(&Step) -> bool| self.steps.iter().any(of);
        let rows = [
            ("exact", any(|step| step.exact.is_some())),
            ("Monte Carlo", any(|step| step.measured.is_some())),
        ];
        let ise = any(|step| step.ise.is_some());
        if !(ise || rows.iter().any(|row| row.1)) {
            return;
        }
        body.push_str("<div class=\"wide\"><table id=\"sweep-numbers\">\n<thead><tr><th scope=\"col\">at this bandwidth</th>");
        for part in PARTS {
            let _ = write!(body, "<th scope=\"col\" class=\"number\">{part}</th>");
        }
        body.push_str("</tr></thead>\n<tbody>\n");
        let cell = |index: usize| {
            format!(
                "<output for=\"sweep-slider\" aria-live=\"off\" data-cell=\"{index}\">{}</output>",
                first.cells[index]
            )
        };
        for (row, (name, _)) in rows.iter().enumerate().filter(|(_, row)| row.1) {
            let _ = write!(body, "<tr><th scope=\"row\">{name}</th>");
            for part in 0..3 {
                let _ = write!(body, "<td class=\"number\">{}</td>", cell(3 * row + part));
            }
            body.push_str("</tr>\n");
        }
        if ise {
            let _ = writeln!(
                body,
                "<tr><th scope=\"row\">this sample: ISE</th><td class=\"number\">{}</td><td></td><td></td></tr>",
                cell(6)
            );
        }
        body.push_str("</tbody>\n</table></div>\n");
    }
}

/// Series number of the moving estimate, and of the ISE.
const ESTIMATE: usize = 1;
const ISE: usize = 2;

fn number((value, error): (f64, Option<f64>)) -> String {
    match error {
        Some(error) => uncertain(value, error),
        None => significant(value, 4),
    }
}

/// The moving curve, in a viewport of its own that cuts it at the frame.
fn overlay(frame: Frame, curve: &str) -> String {
    let Frame {
        left,
        top,
        width,
        height,
        ..
    } = frame;
    format!(
        "<svg x=\"{left:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" viewBox=\"{left:.2} {top:.2} {width:.2} {height:.2}\">\
         <path id=\"sweep-curve\" d=\"{curve}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\" stroke-linejoin=\"round\"/></svg>\n",
        series_colour(ESTIMATE),
    )
}

/// The moving line on the error plot, with a dot on each curve.
fn pointer(frame: Frame, first: &Shown) -> String {
    let mut markup = format!(
        "<g id=\"sweep-pointer\" transform=\"translate({} 0)\"><path d=\"M0 {:.2}V{:.2}\" stroke=\"#262626\" stroke-width=\"1.2\"/>",
        first.at,
        frame.top,
        frame.bottom()
    );
    let colours = [
        series_colour(ISE),
        series_colour(1),
        series_colour(0),
        "#262626".to_owned(),
    ];
    for (dot, colour) in first.dots.iter().zip(colours) {
        let hidden = if dot.is_none() {
            " visibility=\"hidden\""
        } else {
            ""
        };
        let y = dot.unwrap_or(0.0);
        let _ = write!(
            markup,
            "<circle cy=\"{y}\" r=\"4.2\" fill=\"{colour}\" stroke=\"#ffffff\" stroke-width=\"1.2\"{hidden}/>"
        );
    }
    markup.push_str("</g>\n");
    markup
}
