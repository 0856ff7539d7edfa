//! The order of the modules is a drawing in `lib.rs`; here it is enforced.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
    found
}

/// The modules in the order of the table at the top of `lib.rs`.
fn order(library: &str) -> Vec<String> {
    library
        .lines()
        .filter_map(|line| line.strip_prefix("//! | "))
        .filter_map(|row| row.split('|').next())
        .map(|cell| cell.trim().trim_matches(['[', ']', '`']).to_owned())
        .filter(|name| name != "module" && !name.starts_with("---"))
        .collect()
}

/// The modules named in `source` by `crate::name` or, inside braces after `crate::`, by name.
fn uses(source: &str) -> Vec<String> {
    let code: String = source
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect::<Vec<_>>()
        .join("\n");
    let mut found = Vec::new();
    for (start, _) in code.match_indices("crate::") {
        let rest = &code[start + "crate::".len()..];
        if let Some(list) = rest.strip_prefix('{') {
            let mut depth = 0;
            let mut word = String::new();
            for letter in list.chars() {
                match letter {
                    '{' => depth += 1,
                    '}' if depth == 0 => break,
                    '}' => depth -= 1,
                    ',' if depth == 0 => {
                        found.push(std::mem::take(&mut word));
                        continue;
                    }
                    _ => {}
                }
                if depth == 0 {
                    word.push(letter);
                }
            }
            found.push(word);
        } else {
            found.push(
                rest.chars()
                    .take_while(|c| c.is_alphanumeric() || *c == '_')
                    .collect(),
            );
        }
    }
    found
        .into_iter()
        .map(|name| name.trim().split("::").next().unwrap().trim().to_owned())
        .filter(|name| !name.is_empty())
        .collect()
}

#[test]
fn modules_depend_one_way_only() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let order = order(&fs::read_to_string(root.join("lib.rs")).unwrap());
    assert!(
        order.len() >= 10,
        "the table in lib.rs was not understood: {order:?}"
    );
    let rank = |name: &str| order.iter().position(|module| module == name);
    let mut faults = Vec::new();
    for path in sources(&root) {
        let inside = path.strip_prefix(&root).unwrap();
        let top = inside
            .components()
            .next()
            .unwrap()
            .as_os_str()
            .to_str()
            .unwrap()
            .trim_end_matches(".rs")
            .to_owned();
        if top == "lib" || top == "main" {
            continue;
        }
        let Some(here) = rank(&top) else {
            faults.push(format!("{top} is missing from the table in lib.rs"));
            continue;
        };
        for used in uses(&fs::read_to_string(&path).unwrap()) {
            match rank(&used) {
                Some(there) if there > here => faults.push(format!(
                    "{} uses {used}, which comes later",
                    inside.display()
                )),
                None => faults.push(format!(
                    "{} uses crate::{used}, which is not in the table",
                    inside.display()
                )),
                Some(_) => {}
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_reader_of_uses_sees_every_spelling() {
    let source = "use crate::alpha::X;\nuse crate::{beta::{Y, Z}, gamma};\nfn f() { crate::delta::g() }\n// crate::comment::no";
    assert_eq!(uses(source), ["alpha", "beta", "gamma", "delta"]);
}

#[test]
fn no_file_hides_a_second_idea() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let long: Vec<String> = sources(&root)
        .into_iter()
        .map(|path| (fs::read_to_string(&path).unwrap().lines().count(), path))
        .filter(|(lines, _)| *lines > 500)
        .map(|(lines, path)| format!("{} has {lines} lines", path.display()))
        .collect();
    assert!(long.is_empty(), "{}", long.join("\n"));
}
