//! A page to look at.

use density_lab::report::figure::{
    Axis, Comparison, Curves, Dot, Dots, Marker, Measured, ModeCounts, Modes, Part, Role, Row,
    Series, Svg, Sweep, Trace,
};
use density_lab::report::page::{
    Cell, Errors, Figure, Outcome, Page, Slider, Step, Table, Verdict, Warning,
};

pub const BANDWIDTHS: [f64; 6] = [0.1, 0.2, 0.4, 0.8, 1.6, 3.2];

/// A normal density of deviation `s`.
fn normal(x: f64, s: f64) -> f64 {
    (-0.5 * (x / s).powi(2)).exp() / (s * std::f64::consts::TAU.sqrt())
}

pub fn errors_at(h: f64) -> Errors {
    let (bias2, variance) = (0.01 * h.powi(4), 0.001 / h);
    Errors {
        bias2: (bias2, Some(0.1 * bias2)),
        variance: (variance, None),
        mise: (bias2 + variance, Some(0.05 * variance)),
    }
}

/// A page in which every text is `name`.
#[allow(clippy::too_many_lines)] // one of everything
pub fn page(name: &str) -> Page {
    let grid: Vec<f64> = (0..101).map(|i| -5.0 + 0.1 * f64::from(i)).collect();
    let truth: Vec<f64> = grid.iter().map(|&x| normal(x, 1.0)).collect();
    let axis = || Axis::new(name, name);
    let series = |role| Series {
        name: name.into(),
        x: grid.clone(),
        y: truth.clone(),
        role,
    };
    let marker = || Marker {
        name: name.into(),
        at: 0.5,
    };
    let measured = |f: fn(Errors) -> f64| {
        let points = BANDWIDTHS.map(|h| {
            let value = f(errors_at(h));
            Measured {
                at: h,
                value,
                low: 0.9 * value,
                high: 1.1 * value,
            }
        });
        points.to_vec()
    };
    let trace = |part, f: fn(Errors) -> f64| Trace {
        name: name.into(),
        part,
        exact: Vec::new(),
        measured: measured(f),
    };
    let sweep = Sweep {
        title: name.into(),
        description: name.into(),
        x: axis().logarithmic(),
        y: axis().logarithmic(),
        traces: vec![
            trace(Part::Total, |e| e.mise.0),
            trace(Part::Bias, |e| e.bias2.0),
            trace(Part::Variance, |e| e.variance.0),
        ],
        interval: name.into(),
        markers: vec![
            marker(),
            Marker {
                at: 50.0,
                ..marker()
            },
        ],
        minima: Vec::new(),
    };
    let curves = Curves {
        title: name.into(),
        description: name.into(),
        x: axis(),
        y: axis(),
        series: vec![
            series(Role::Truth),
            series(Role::Estimate(0)),
            series(Role::Steps(1)),
        ],
        rug: vec![0.0, 1.0],
        markers: vec![marker()],
        dots: vec![(1, 0.0)],
    };
    let row = |value| Row {
        name: name.into(),
        colour: 0,
        value,
        low: 0.9 * value,
        high: 1.1 * value,
        exact: Some(value),
    };
    let comparison = Comparison {
        title: name.into(),
        description: name.into(),
        axis: axis(),
        interval: name.into(),
        rows: vec![row(1.0), row(2.0)],
    };
    let modes = Modes {
        title: name.into(),
        description: name.into(),
        truth: Some(2),
        rows: vec![ModeCounts {
            name: name.into(),
            colour: 0,
            replicates: vec![0, 10, 30],
        }],
    };
    let dots = Dots {
        title: name.into(),
        description: name.into(),
        axis: axis(),
        interval: name.into(),
        headings: vec![name.into()],
        rows: vec![Dot {
            name: name.into(),
            exact: Some(1.0),
            measured: Some((1.0, 0.9, 1.1)),
            cells: vec![name.into()],
        }],
    };
    let steps = BANDWIDTHS.map(|h| Step {
        bandwidth: h,
        estimate: grid
            .iter()
            .map(|&x| normal(x, (1.0 + h * h).sqrt()))
            .collect(),
        exact: None,
        measured: Some(errors_at(h)),
        ise: Some(0.002 + 0.01 * (h - 0.4).powi(2)),
    });
    let slider = Slider {
        caption: name.into(),
        x: axis(),
        y: axis(),
        grid: grid.clone(),
        truth: Some(truth.clone()),
        data: vec![-1.0, 0.3],
        steps: steps.to_vec(),
        start: 2,
        errors: Some(sweep.clone()),
    };
    let figure = |svg: Svg| Figure {
        title: name.into(),
        caption: name.into(),
        svg,
    };
    Page {
        verdict: vec!["A sentence that follows from the tables.".to_owned()],
        question: name.into(),
        notes: name.into(),
        claims: vec![Verdict {
            text: name.into(),
            outcome: Outcome::Fail,
            detail: name.into(),
        }],
        facts: vec![(name.into(), name.into())],
        warnings: vec![Warning {
            text: name.into(),
            hint: name.into(),
        }],
        slider: Some(slider),
        figures: [
            curves.draw(),
            curves.panels(2).draw(),
            sweep.draw(),
            comparison.draw(),
            modes.draw(),
            dots.draw(),
        ]
        .map(figure)
        .to_vec(),
        tables: vec![Table {
            title: name.into(),
            caption: name.into(),
            columns: vec![name.into(), name.into()],
            rows: vec![vec![Cell::text(name), Cell::measured(1.0, 0.1)]],
        }],
        command: name.into(),
        versions: vec![(name.into(), name.into())],
    }
}
