//! Whatever happens to a file, it is answered.

use super::{parse, with};
use density_lab::experiment::read;
use proptest::prelude::*;

const PIECES: &[&str] = &[
    "[",
    "]",
    "{",
    "}",
    "\"",
    "'",
    "=",
    "\n",
    ",",
    ".",
    "nan",
    "-inf",
    "9223372036854775807",
    "1e400",
    "[[",
    "\"\"\"",
    "#",
    "\\u",
    "0x",
    "name",
    "kernel",
    "\u{0}",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    /// Whatever happens to a file, the answer is an experiment or a list of located problems.
    #[test]
    fn damaged_files_are_answered(
        damage in prop::collection::vec((any::<prop::sample::Index>(), 0_u8..6, any::<prop::sample::Index>(), any::<char>()), 1..6)
    ) {
        let mut text: Vec<char> = with(&[]).chars().collect();
        for (place, kind, other, letter) in damage {
            let at = place.index(text.len() + 1);
            let to = (at + other.index(30)).min(text.len());
            match kind {
                0 => { text.drain(at..to); }
                1 => text.insert(at, letter),
                2 => { let copy: Vec<char> = text[at..to].to_vec(); text.splice(at..at, copy); }
                3 => { text.splice(at..at, PIECES[other.index(PIECES.len())].chars()); }
                4 => { text.splice(at..to, PIECES[other.index(PIECES.len())].chars()); }
                _ => text.truncate(text.len() - other.index(text.len() / 2 + 1)),
            }
        }
        let text: String = text.into_iter().collect();
        if let Err(problems) = parse(&text) {
            prop_assert!(!problems.list().is_empty());
            let lines = text.split('\n').count();
            for problem in problems.list() {
                prop_assert!((1..=lines).contains(&problem.line) && problem.column >= 1, "{problems}");
            }
            let _ = problems.render(true);
        }
    }

    #[test]
    fn damaged_estimators_are_answered(text in "[\\[\\]{}='\", a-z0-9.\\-]{0,40}") {
        let _ = read::estimator(&text, "x").map_err(|problems| problems.to_string());
    }
}
