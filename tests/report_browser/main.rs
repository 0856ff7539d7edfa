//! The report in a real browser: the slider moves curve and numbers, nothing fails, nothing is asked of a network, and no name
//! becomes a program. Skipped, with a message, where there is no chromium with its driver.

#![allow(clippy::unwrap_used, clippy::format_push_string)]

mod browser;
mod page;
mod run;

use browser::Browser;
use density_lab::report::text::{significant, uncertain};
use page::{BANDWIDTHS, errors_at, page};
use serde_json::json;
use std::path::PathBuf;

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
