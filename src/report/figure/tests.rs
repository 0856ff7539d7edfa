//! What every figure must be, whatever it is given: well-formed, finite, inside its sheet, no label on another.

use super::*;
use crate::report::text::{BOLDER, width};

/// A label of a finished figure as a box: left, top, right, bottom.
#[derive(Debug)]
struct Label {
    text: String,
    sides: [f64; 4],
    /// Which share of its length stands before its place, and whether it is turned upwards.
    before: f64,
    turned: bool,
}

impl Label {
    /// Makes it longer by `length`.
    fn grow(&mut self, length: f64) {
        let (back, on) = (self.before * length, (1.0 - self.before) * length);
        let [left, top, right, bottom] = self.sides;
        self.sides = if self.turned {
            [left, top - on, right, bottom + back]
        } else {
            [left - back, top, right + on, bottom]
        };
    }
}

/// The value of an attribute of a start tag.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let start = tag.find(&format!(" {name}=\""))? + name.len() + 3;
    tag[start..].split('"').next()
}

/// Checks that tags are balanced and attributes quoted, and returns the start tags with the text directly after them.
fn parsed(svg: &str) -> Vec<(String, String)> {
    let mut open: Vec<String> = Vec::new();
    let mut tags = Vec::new();
    for piece in svg.split('<').skip(1) {
        let (tag, text) = piece.split_once('>').expect("a tag ends");
        for entity in text.split('&').skip(1).chain(tag.split('&').skip(1)) {
            let known = ["lt;", "gt;", "amp;", "quot;", "#39;"];
            assert!(
                known.iter().any(|name| entity.starts_with(name)),
                "&{entity}"
            );
        }
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "tags are nested");
            continue;
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        let name = tag.split([' ', '/']).next().unwrap_or_default();
        assert!(
            [
                "svg", "title", "desc", "g", "rect", "path", "circle", "text", "tspan"
            ]
            .contains(&name),
            "{name}"
        );
        for number in ["NaN", "inf"] {
            assert!(!tag.contains(number), "{tag}");
        }
        if !tag.ends_with('/') {
            open.push(name.to_owned());
        }
        tags.push((tag.to_owned(), text.to_owned()));
    }
    assert!(open.is_empty(), "all tags are closed");
    tags
}

/// The labels of a figure, and the size of its sheet.
fn labels(svg: &Svg) -> (Vec<Label>, (f64, f64)) {
    let tags = parsed(svg.as_str());
    let number =
        |tag: &str, name: &str| attribute(tag, name).and_then(|value| value.parse::<f64>().ok());
    let sheet = (
        number(&tags[0].0, "width").expect("a width"),
        number(&tags[0].0, "height").expect("a height"),
    );
    let mut labels: Vec<Label> = Vec::new();
    for (tag, text) in &tags {
        let text = text
            .replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&amp;", "&")
            .replace("&quot;", "\"")
            .replace("&#39;", "'");
        if tag.starts_with("tspan") {
            // The rest of the label before it.
            let size = number(tag, "font-size");
            let label = labels.last_mut().expect("a span is in a text");
            label.text.push_str(&text);
            label.grow(width(&text, size.unwrap_or(style::LABEL)));
        } else if tag.starts_with("text ") {
            let size = number(tag, "font-size").expect("a size");
            let turned = attribute(tag, "transform");
            let (x, y) = match turned {
                None => (number(tag, "x").expect("x"), number(tag, "y").expect("y")),
                Some(turn) => {
                    let place = turn
                        .trim_start_matches("translate(")
                        .split(')')
                        .next()
                        .unwrap_or_default();
                    let (x, y) = place.split_once(' ').expect("two numbers");
                    (x.parse().expect("x"), y.parse().expect("y"))
                }
            };
            let before = match attribute(tag, "text-anchor") {
                None => 0.0,
                Some("middle") => 0.5,
                Some(_) => 1.0,
            };
            // Letters reach from a little below the base line to three quarters of the size above it.
            let (up, down) = (0.75 * size, 0.1 * size);
            let turned = turned.is_some();
            let sides = if turned {
                [x - up, y, x + down, y]
            } else {
                [x, y - up, x, y + down]
            };
            let mut label = Label {
                text: text.clone(),
                sides,
                before,
                turned,
            };
            label.grow(
                width(&text, size)
                    * if tag.contains("font-weight") {
                        BOLDER
                    } else {
                        1.0
                    },
            );
            labels.push(label);
        }
    }
    (labels, sheet)
}

/// Labels on each other or off the sheet.
fn faults(svg: &Svg) -> Vec<String> {
    let (labels, sheet) = labels(svg);
    let mut faults = Vec::new();
    for (index, a) in labels.iter().enumerate() {
        let [left, top, right, bottom] = a.sides;
        if left < -0.5 || top < -0.5 || right > sheet.0 + 0.5 || bottom > sheet.1 + 0.5 {
            faults.push(format!("{a:?} is off the sheet {sheet:?}"));
        }
        for b in &labels[..index] {
            if left < b.sides[2] && b.sides[0] < right && top < b.sides[3] && b.sides[1] < bottom {
                faults.push(format!("{a:?} is on {b:?}"));
            }
        }
    }
    faults
}

/// Ranges that data come in.
const RANGES: [(f64, f64); 10] = [
    (0.0, 1.0),
    (-3.0, 3.0),
    (1.7, 4.9),
    (0.0, 4e-9),
    (-2e7, 3e7),
    (1e9, 1e9 + 3.0),
    (5.0, 5.0),
    (-1e300, 1e300),
    (1e-300, 1e-200),
    (0.097, 0.103),
];

fn points(low: f64, high: f64, count: usize) -> Vec<f64> {
    (0..count)
        .map(|i| low + (high - low) * i as f64 / (count - 1) as f64)
        .collect()
}

fn series(name: &str, x: &[f64], height: f64, role: Role) -> Series {
    let middle = (x.len() / 2) as f64;
    let y = (0..x.len())
        .map(|i| height * (-((i as f64 - middle) / (0.2 * middle)).powi(2)).exp())
        .collect();
    Series {
        name: name.into(),
        x: x.to_vec(),
        y,
        role,
    }
}

/// Every kind of figure over the given ranges.
#[allow(clippy::too_many_lines)] // one list of all kinds of figure
fn figures(x: (f64, f64), y: f64, name: &str, logarithmic: bool) -> Vec<(&'static str, Svg)> {
    let axis = |label: &str| Axis {
        label: label.into(),
        unit: "unit".into(),
        logarithmic,
        range: None,
    };
    let abscissae = points(x.0, x.1, 41);
    let curves = Curves {
        title: format!("{name} and a title that says something"),
        description: name.into(),
        x: axis("x"),
        y: axis("density"),
        series: vec![
            series("truth", &abscissae, y, Role::Truth),
            series(name, &abscissae, 0.7 * y, Role::Estimate(0)),
            series("steps", &abscissae, 1.1 * y, Role::Steps(1)),
            series(
                "band",
                &abscissae,
                y,
                Role::Band {
                    colour: 2,
                    low: vec![0.5 * y; 41],
                    high: vec![y; 41],
                },
            ),
        ],
        rug: abscissae.clone(),
        markers: ["one", name, "two", "another name"]
            .iter()
            .zip([0.1, 0.11, 0.5, 1.4])
            .map(|(name, at)| Marker {
                name: (*name).into(),
                at: x.0 + at * (x.1 - x.0),
            })
            .collect(),
        dots: vec![(1, abscissae[20])],
    };
    let direct = Curves {
        rug: Vec::new(),
        series: vec![series("a", &abscissae, y, Role::Estimate(0))],
        ..curves.clone()
    };
    let measured = abscissae
        .iter()
        .map(|&at| Measured {
            at,
            value: y * (1.0 + at.abs().min(1.0)),
            low: -y,
            high: 3.0 * y,
        })
        .collect();
    let sweep = Sweep {
        title: name.into(),
        description: String::new(),
        x: axis("bandwidth"),
        y: axis("error"),
        traces: vec![
            Trace {
                name: "MISE".into(),
                part: Part::Total,
                exact: abscissae.iter().map(|&at| (at, y)).collect(),
                measured,
            },
            Trace {
                name: "bias²".into(),
                part: Part::Bias,
                exact: abscissae.iter().map(|&at| (at, y)).collect(),
                measured: Vec::new(),
            },
            Trace {
                name: name.into(),
                part: Part::Variance,
                exact: abscissae.iter().map(|&at| (at, 1.01 * y)).collect(),
                measured: Vec::new(),
            },
        ],
        interval: "95 % interval".into(),
        markers: curves.markers.clone(),
        minima: vec![(abscissae[3], y), (abscissae[9], y)],
    };
    let row = |value: f64| Row {
        name: name.into(),
        colour: 0,
        value,
        low: 0.9 * value,
        high: 1.2 * value,
        exact: Some(value),
    };
    let comparison = |values: &[f64]| Comparison {
        title: name.into(),
        axis: axis("MISE"),
        interval: "95 % interval".into(),
        rows: values.iter().map(|value| row(*value)).collect(),
        ..Comparison::default()
    };
    let small = Small {
        title: name.into(),
        series: curves.series[..2].to_vec(),
    };
    let multiples = |columns, shared| Multiples {
        title: name.into(),
        x: axis("x"),
        y: axis("density"),
        columns,
        shared,
        panels: vec![small.clone(); 7],
        ..Multiples::default()
    };
    let dot = |value: f64| Dot {
        name: name.into(),
        exact: Some(value),
        measured: Some((value, 0.9 * value, 1.1 * value)),
        cells: vec!["0.95".into(), name.into()],
    };
    let dots = Dots {
        axis: axis("efficiency"),
        headings: vec!["efficiency".into(), name.into()],
        rows: vec![dot(y), dot(1.1 * y)],
        ..Dots::default()
    };
    let modes = Modes {
        truth: Some(2),
        rows: vec![ModeCounts {
            name: name.into(),
            colour: 0,
            replicates: vec![0, 3, 400, 7, 1, 0, 0, 2, 0, 0, 1, 30],
        }],
        ..Modes::default()
    };
    vec![
        ("curves", curves.draw()),
        ("direct", direct.draw()),
        ("panels", curves.panels(3).draw()),
        ("sweep", sweep.draw()),
        ("comparison", comparison(&[y, 2.0 * y, 0.3 * y]).draw()),
        (
            "wide comparison",
            comparison(&[y, 1000.0 * y, 1e-3 * y, 0.0, f64::NAN]).draw(),
        ),
        ("multiples", multiples(3, false).draw()),
        ("shared multiples", multiples(5, true).draw()),
        ("dots", dots.draw()),
        ("modes", modes.draw()),
    ]
}

/// A band in a panel that a title names is explained once; without bands nothing is.
#[test]
fn legends_of_panels_say_what_bands_are() {
    let drawn = |role| {
        let series = Series {
            name: "kernel".to_owned(),
            x: vec![0.0, 1.0],
            y: vec![1.0, 2.0],
            role,
        };
        let panel = Small {
            title: "kernel".to_owned(),
            series: vec![series],
        };
        let panels = vec![panel.clone(), panel];
        let multiples = Multiples {
            columns: 2,
            panels,
            ..Multiples::default()
        };
        multiples
            .draw()
            .as_str()
            .matches("one standard deviation")
            .count()
    };
    let band = Role::Band {
        colour: 0,
        low: vec![0.5, 1.5],
        high: vec![1.5, 2.5],
    };
    assert_eq!([drawn(band), drawn(Role::Estimate(0))], [1, 0]);
}

#[test]
fn labels_keep_clear_of_each_other_over_all_ranges() {
    let long = "an estimator with a name as long as users give them, h = 0.25, kernel = epanechnikov, boundary = reflect";
    let mut faulty = Vec::new();
    for range in RANGES {
        for height in [0.4, 1.0, 3e-7, 2.5e6, 1e-200] {
            for (logarithmic, name) in [
                (false, "h = 0.3"),
                (false, long),
                (true, "h = 0.3"),
                (true, long),
            ] {
                for (kind, svg) in figures(range, height, name, logarithmic) {
                    for fault in faults(&svg) {
                        faulty.push(format!("{kind} over {range:?}, height {height}, logarithmic {logarithmic}: {fault}"));
                    }
                }
            }
        }
    }
    assert!(
        faulty.is_empty(),
        "{} faults:\n{}",
        faulty.len(),
        faulty.join("\n")
    );
}

#[test]
fn numbers_that_are_not_numbers_leave_gaps_and_never_break_a_figure() {
    for x in [
        (f64::NAN, f64::NAN),
        (f64::NEG_INFINITY, f64::INFINITY),
        (0.0, f64::INFINITY),
        (-f64::MAX, f64::MAX),
        (0.0, 0.0),
    ] {
        for height in [
            f64::NAN,
            f64::INFINITY,
            -1.0,
            0.0,
            f64::MAX,
            f64::MIN_POSITIVE,
        ] {
            for logarithmic in [false, true] {
                for (_, svg) in figures(x, height, "name", logarithmic) {
                    parsed(svg.as_str());
                }
            }
        }
    }
    for svg in [
        Curves::default().draw(),
        Multiples::default().draw(),
        Comparison::default().draw(),
        Sweep::default().draw(),
        Dots::default().draw(),
        Modes::default().draw(),
        Curves {
            series: vec![Series {
                name: String::new(),
                x: vec![1.0],
                y: Vec::new(),
                role: Role::Steps(0),
            }],
            ..Curves::default()
        }
        .draw(),
    ] {
        parsed(svg.as_str());
    }
}

#[test]
fn names_are_escaped_wherever_they_stand() {
    let name = "<b x='1' y=\"2\">&amp;</b>";
    for (kind, svg) in figures((0.0, 1.0), 1.0, name, false) {
        parsed(svg.as_str());
        assert!(svg.as_str().contains("&lt;b"), "{kind} shows the name");
    }
}

#[test]
fn a_figure_is_the_same_each_time_and_small() {
    let grid = points(-4.0, 4.0, 4096);
    let data = points(-3.0, 3.0, 100_000);
    let curves = || Curves {
        series: (0..8)
            .map(|index| series("estimate", &grid, 0.4, Role::Estimate(index)))
            .collect(),
        rug: data.clone(),
        ..Curves::default()
    };
    let svg = curves().draw();
    assert_eq!(svg, curves().draw());
    assert!(
        svg.as_str().len() < 60_000,
        "{} bytes for eight curves of 4096 points",
        svg.as_str().len()
    );
}
