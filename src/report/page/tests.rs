use super::*;
use std::io::Write as _;
use std::process::{Command, Stdio};

/// SHA-256 of `text` in base 64, by coreutils; `None` where they are missing.
fn sha256(text: &str) -> Option<String> {
    let mut child = Command::new("sha256sum")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .ok()?;
    child.stdin.take()?.write_all(text.as_bytes()).ok()?;
    let output = String::from_utf8(child.wait_with_output().ok()?.stdout).ok()?;
    let bytes: Vec<u8> = (0..32)
        .map(|i| u8::from_str_radix(&output[2 * i..2 * i + 2], 16).expect("hexadecimal"))
        .collect();
    let letters = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut encoded = String::new();
    for chunk in bytes.chunks(3) {
        let word = (0..3).fold(0_u32, |word, i| {
            word << 8 | u32::from(*chunk.get(i).unwrap_or(&0))
        });
        for place in 0..4 {
            encoded.push(if place > chunk.len() {
                '='
            } else {
                letters[(word >> (18 - 6 * place)) as usize & 63] as char
            });
        }
    }
    Some(encoded)
}

#[test]
fn the_policy_names_the_style_and_the_script_that_the_page_has() {
    for (what, text, stated) in [
        ("STYLE_HASH", STYLE, STYLE_HASH),
        ("SCRIPT_HASH", SCRIPT, SCRIPT_HASH),
    ] {
        match sha256(text) {
            Some(hash) => assert_eq!(stated, format!("sha256-{hash}"), "{what} is out of date"),
            None => println!("skipped: no sha256sum"),
        }
    }
}

#[test]
fn nothing_in_the_page_points_outside_it() {
    assert!(!STYLE.contains("url(") && !STYLE.contains("@import"));
    assert!(!SCRIPT.contains("http") && !SCRIPT.contains("innerHTML") && !SCRIPT.contains("eval"));
    let page = Page {
        question: "Why?".into(),
        ..Page::default()
    }
    .render();
    for forbidden in ["http:", "https:", "src=", "@import", "//"] {
        assert!(!page.contains(forbidden), "{forbidden}");
    }
}

#[test]
fn an_empty_page_has_no_empty_sections() {
    let page = Page {
        question: "Why <b>?".into(),
        ..Page::default()
    }
    .render();
    assert!(
        page.contains("<h1>Why &lt;b&gt;?</h1>") && page.contains("<title>Why &lt;b&gt;?</title>")
    );
    assert!(!page.contains("<h2>") && !page.contains("<script"));
}

#[test]
fn the_summary_counts_claims() {
    let claim = |outcome| Verdict {
        text: "t".into(),
        outcome,
        detail: String::new(),
    };
    let page = |outcomes: &[Outcome]| {
        Page {
            claims: outcomes.iter().map(|o| claim(*o)).collect(),
            ..Page::default()
        }
        .render()
    };
    assert!(page(&[Outcome::Pass, Outcome::Pass]).contains("All 2 claims hold."));
    assert!(page(&[Outcome::Fail]).contains("The claim fails."));
    assert!(
        page(&[Outcome::Pass, Outcome::Fail, Outcome::Fail])
            .contains("Of 3 claims, 1 holds, 2 fail.")
    );
    assert!(
        page(&[Outcome::Undecided, Outcome::Pass])
            .contains("Of 2 claims, 1 holds, 1 is undecided.")
    );
}

#[test]
fn the_data_of_the_slider_are_whole_json_and_show_what_the_steps_say() {
    let steps = [0.1, 0.2, 0.4]
        .map(|bandwidth| Step {
            bandwidth,
            estimate: vec![0.0, 1.0 / bandwidth, 0.0],
            exact: None,
            measured: Some(Errors {
                bias2: (bandwidth, Some(0.01)),
                variance: (1.0, None),
                mise: (bandwidth + 1.0, Some(0.02)),
            }),
            ise: Some(0.5),
        })
        .to_vec();
    let slider = Slider {
        grid: vec![-1.0, 0.0, 1.0],
        truth: Some(vec![0.0, 2.0, 0.0]),
        steps,
        start: 1,
        ..Slider::default()
    };
    let html = Page {
        slider: Some(slider),
        ..Page::default()
    }
    .render();
    let json = html
        .split("id=\"sweep-data\">")
        .nth(1)
        .and_then(|rest| rest.split("</script>").next())
        .expect("there are data");
    let shown: serde_json::Value = serde_json::from_str(json).expect("valid JSON");
    assert_eq!(shown.as_array().map(Vec::len), Some(3));
    assert_eq!(shown[1]["bandwidth"], "0.200");
    assert_eq!(shown[1]["cells"][3], "1.200 ± 0.020");
    assert_eq!(shown[1]["cells"][0], "–");
    // The largest peak is beyond two and a half times the truth's.
    assert!(
        shown[0]["note"]
            .as_str()
            .is_some_and(|note| note.contains("10.0"))
            && shown[1]["note"] == ""
    );
    assert!(html.contains(">0.200</output>") && html.contains("data-step=\"0\">least MISE"));
}
