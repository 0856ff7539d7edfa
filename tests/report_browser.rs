//! The report in a real browser: the slider moves curve and numbers, nothing fails, nothing is asked of a network, and no name
//! becomes a program. Skipped, with a message, where there is no chromium with its driver.

#![allow(clippy::unwrap_used, clippy::format_push_string)]

#[path = "support/browser.rs"]
mod browser;

use browser::Browser;
use density_lab::report::figure::{
    Axis, Comparison, Curves, Dot, Dots, Marker, Measured, ModeCounts, Modes, Part, Role, Row,
    Series, Svg, Sweep, Trace,
};
use density_lab::report::page::{
    Cell, Errors, Figure, Outcome, Page, Slider, Step, Table, Verdict, Warning,
};
use density_lab::report::text::{significant, uncertain};
use serde_json::json;
use std::path::PathBuf;
use std::process::Command;

const BANDWIDTHS: [f64; 6] = [0.1, 0.2, 0.4, 0.8, 1.6, 3.2];

/// A normal density of deviation `s`.
fn normal(x: f64, s: f64) -> f64 {
    (-0.5 * (x / s).powi(2)).exp() / (s * std::f64::consts::TAU.sqrt())
}

fn errors_at(h: f64) -> Errors {
    let (bias2, variance) = (0.01 * h.powi(4), 0.001 / h);
    Errors {
        bias2: (bias2, Some(0.1 * bias2)),
        variance: (variance, None),
        mise: (bias2 + variance, Some(0.05 * variance)),
    }
}

/// A page in which every text is `name`.
#[allow(clippy::too_many_lines)] // one of everything
fn page(name: &str) -> Page {
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

/// Writes a page where the browser finds it.
fn write(folder: &tempfile::TempDir, name: &str, html: &str) -> PathBuf {
    let file = folder.path().join(name);
    std::fs::write(&file, html).unwrap();
    file
}

/// The state of everything that the slider moves.
fn state(browser: &Browser) -> serde_json::Value {
    browser.run(
        "const all = (q, f) => Array.from(document.querySelectorAll(q), f);
         return {
           value: document.querySelector('#sweep-slider').valueAsNumber,
           disabled: document.querySelector('#sweep-slider').disabled,
           spoken: document.querySelector('#sweep-slider').getAttribute('aria-valuetext'),
           bandwidth: document.querySelector('#sweep-bandwidth').textContent,
           curve: document.querySelector('#sweep-curve').getAttribute('d'),
           highest: document.querySelector('#sweep-curve').getBBox().y,
           pointer: document.querySelector('#sweep-pointer').getAttribute('transform'),
           dots: all('#sweep-pointer circle', e => e.getAttribute('cy')),
           cells: all('#sweep [data-cell]', e => e.textContent),
         };",
    )
}

/// The numbers that must be shown for a step.
fn expected(step: usize) -> serde_json::Value {
    let h = BANDWIDTHS[step];
    let errors = errors_at(h);
    let print = |(value, error): (f64, Option<f64>)| {
        error.map_or(significant(value, 4), |error| uncertain(value, error))
    };
    let ise = significant(0.002 + 0.01 * (h - 0.4).powi(2), 4);
    json!([
        print(errors.mise),
        print(errors.bias2),
        print(errors.variance),
        ise
    ])
}

#[test]
fn the_slider_moves_the_curve_and_the_numbers_together() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    browser.open(&write(
        &folder,
        "report.html",
        &page("Which bandwidth?").render(),
    ));

    let mut seen = vec![state(&browser)];
    assert_eq!(seen[0]["value"], 2);
    assert_eq!(seen[0]["disabled"], false, "the script enables the slider");
    let mut visit = |step: usize| {
        let now = state(&browser);
        assert_eq!(now["value"], step);
        assert_eq!(
            now["bandwidth"].as_str(),
            Some(significant(BANDWIDTHS[step], 3).as_str())
        );
        assert_eq!(now["spoken"], now["bandwidth"]);
        assert_eq!(now["cells"], expected(step), "numbers of step {step}");
        seen.push(now);
    };
    visit(2);
    browser.press("#sweep-slider", "\u{e014}"); // right arrow
    visit(3);
    browser.press("#sweep-slider", "\u{e011}"); // home
    visit(0);
    browser.press("#sweep-slider", "\u{e010}"); // end
    visit(5);
    browser.drag("#sweep-slider", 0.995, 0.2);
    visit(1);
    browser.click("#sweep [data-step]"); // least MISE: 0.01 h⁴ + 0.001/h is least at h = 0.48
    visit(2);

    for (position, now) in seen.iter().enumerate().skip(1) {
        for before in &seen[..position] {
            let same = before["value"] == now["value"];
            for moved in ["curve", "pointer", "dots", "cells", "bandwidth"] {
                assert_eq!(
                    before[moved] == now[moved],
                    same,
                    "{moved} at {} and {}",
                    before["value"],
                    now["value"]
                );
            }
            // Wider smoothing lowers the peak, so the curve's box begins further down the page.
            if before["value"].as_f64() < now["value"].as_f64() {
                assert!(
                    before["highest"].as_f64() < now["highest"].as_f64(),
                    "the peak sinks as the bandwidth grows"
                );
            }
        }
    }
    assert_eq!(
        browser.console(),
        Vec::<String>::new(),
        "no error and no refused request"
    );
    assert_eq!(
        browser.asked(),
        Vec::<String>::new(),
        "nothing is asked of a network"
    );

    // The policy forbids even what a script asks; without it the asking is seen.
    let asks = "const image = new Image(); image.src = 'http://asked.invalid/picture'; document.body.append(image);";
    browser.run(asks);
    assert!(!browser.console().is_empty(), "the policy refuses");
    let open = write(
        &folder,
        "open.html",
        "<title>No policy</title><img src='http://asked.invalid/picture'>",
    );
    browser.open(&open);
    assert!(
        browser
            .asked()
            .iter()
            .any(|url| url == "http://asked.invalid/picture")
    );
    let reached: Vec<String> = browser
        .requests()
        .into_iter()
        .filter(|line| line.contains("asked.invalid"))
        .collect();
    assert_eq!(
        reached.len(),
        1,
        "only the page without a policy reaches the proxy: {reached:?}"
    );
}

/// Names that would run `window.fired` or ask a network, if they were read as markup, script, style or an address.
const PAYLOADS: [&str; 36] = [
    "<script>window.fired=1</script>",
    "</script><script>window.fired=1</script>",
    "</title><script>window.fired=1</script>",
    "</style><script>window.fired=1</script>",
    "<img src=x onerror=window.fired=1>",
    "\"><img src=x onerror=window.fired=1>",
    "'><img src=x onerror=window.fired=1>",
    "<svg onload=window.fired=1>",
    "</svg><svg onload=window.fired=1>",
    "</text><script>window.fired=1</script>",
    "</desc></svg><script>window.fired=1</script>",
    "<svg><animate onbegin=window.fired=1 attributeName=x dur=1s>",
    "<svg><set attributeName=onmouseover to=window.fired=1>",
    "<body onload=window.fired=1>",
    "<iframe srcdoc='<script>parent.fired=1</script>'>",
    "<iframe src=javascript:parent.fired=1>",
    "<a href=javascript:window.fired=1 autofocus onfocus=window.fired=1>x</a>",
    "<input autofocus onfocus=window.fired=1>",
    "<details open ontoggle=window.fired=1>",
    "<video><source onerror=window.fired=1></video>",
    "<math><mtext><script>window.fired=1</script></mtext></math>",
    "<base href=http://leak.invalid/>",
    "<meta http-equiv=refresh content='0;url=http://leak.invalid/'>",
    "<link rel=stylesheet href=http://leak.invalid/x.css>",
    "<style>@import 'http://leak.invalid/x.css';*{display:none}</style>",
    "\" onmouseover=\"window.fired=1\" x=\"",
    "' autofocus onfocus='window.fired=1",
    "\" style=\"background:url(http://leak.invalid/)\"",
    "javascript:window.fired=1",
    "${window.fired=1}",
    "`${window.fired=1}`",
    "{{constructor.constructor('window.fired=1')()}}",
    "&lt;script&gt;window.fired=1&lt;/script&gt;",
    "&#60;img src=x onerror=window.fired=1&#62;",
    "\\u003cscript\\u003ewindow.fired=1\\u003c/script\\u003e",
    "<!--><script>window.fired=1</script>-->",
];

/// What running or planting something would leave behind.
fn traces(browser: &Browser) -> serde_json::Value {
    browser.run(
        "const foreign = 'img,iframe,object,embed,video,audio,base,a,form,animate,set,body [autofocus],details,style:not(head style),link[rel=stylesheet]';
         return {
           fired: window.fired ?? null,
           foreign: Array.from(document.querySelectorAll(foreign), e => e.outerHTML.slice(0, 80)),
           handlers: Array.from(document.querySelectorAll('*')).flatMap(e => Array.from(e.attributes))
             .filter(a => a.name.startsWith('on') || a.name === 'style' || /^\\s*javascript:/.test(a.value)).map(a => a.name),
           scripts: document.querySelectorAll('script').length,
           heading: document.querySelector('h1').textContent,
           mentions: document.body.textContent.split(document.querySelector('h1').textContent).length - 1,
         };",
    )
}

#[test]
fn no_name_becomes_a_program() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let plain = {
        browser.open(&write(&folder, "plain.html", &page("plain name").render()));
        traces(&browser)
    };
    let separators = [
        "line\u{2028}window.fired=1//",
        "paragraph\u{2029}window.fired=1//",
        "nul\u{0}<script>window.fired=1</script>",
    ];
    for (index, payload) in PAYLOADS.into_iter().chain(separators).enumerate() {
        browser.open(&write(
            &folder,
            &format!("{index}.html"),
            &page(payload).render(),
        ));
        // Let the mouse and the slider touch what a payload may have planted.
        browser.run("for (const e of document.querySelectorAll('*')) e.dispatchEvent(new MouseEvent('mouseover', { bubbles: true }));");
        browser.press("#sweep-slider", "\u{e014}");
        assert!(!browser.has_dialogue(), "{payload}");
        let found = traces(&browser);
        assert_eq!(found["fired"], serde_json::Value::Null, "{payload}");
        for what in ["foreign", "handlers", "scripts"] {
            assert_eq!(found[what], plain[what], "{what}: {payload}");
        }
        if index < PAYLOADS.len() {
            assert_eq!(
                found["heading"], payload,
                "the name is shown as it was given"
            );
            assert!(
                found["mentions"].as_u64() >= Some(20),
                "in all its places: {found}"
            );
        }
        assert_eq!(browser.console(), Vec::<String>::new(), "{payload}");
    }
    assert_eq!(browser.asked(), Vec::<String>::new());
    assert!(
        !browser
            .requests()
            .iter()
            .any(|line| line.contains("invalid"))
    );
}

/// That the tests above can fail, and that the policy holds where escaping would not.
#[test]
fn an_unescaped_name_would_be_noticed_and_still_not_run() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let payload = "<img src=x onerror=window.fired=1><script>window.fired=1</script>";
    let html = page("plain name")
        .render()
        .replace("<h1>plain name</h1>", &format!("<h1>{payload}</h1>"));
    browser.open(&write(&folder, "planted.html", &html));
    let found = traces(&browser);
    assert_eq!(
        found["fired"],
        serde_json::Value::Null,
        "the policy stops it"
    );
    assert_eq!(found["foreign"].as_array().map(Vec::len), Some(1));
    assert!(!browser.console().is_empty(), "and says so");

    let start = html.find("<meta http-equiv").unwrap();
    let end = start + html[start..].find('>').unwrap() + 1;
    browser.open(&write(
        &folder,
        "unprotected.html",
        &format!("{}{}", &html[..start], &html[end..]),
    ));
    assert_eq!(traces(&browser)["fired"], 1, "without the policy it runs");
}

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
