//! Whatever is wrong with what `lab` is given, it says where, says what would be right, and leaves nothing half-done behind.
//!
//! Each row: what is wrong, the files, the arguments, the exit code (2 bad input, 3 the system refused) and what the message must have.
#![allow(clippy::too_many_lines, reason = "tables, one row a case")]

mod arguments;
mod system;
mod tables;

use crate::support::Bench;

struct Bad {
    what: &'static str,
    files: Vec<(&'static str, Vec<u8>)>,
    arguments: Vec<&'static str>,
    code: i32,
    says: Vec<&'static str>,
}

fn bad(what: &'static str, arguments: &[&'static str], code: i32, says: &[&'static str]) -> Bad {
    Bad {
        what,
        files: Vec::new(),
        arguments: arguments.to_vec(),
        code,
        says: says.to_vec(),
    }
}

impl Bad {
    fn with(mut self, name: &'static str, bytes: impl AsRef<[u8]>) -> Self {
        self.files.push((name, bytes.as_ref().to_vec()));
        self
    }

    /// What is wrong with the answer, if anything.
    fn fault(&self) -> Option<String> {
        let mut bench = Bench::new();
        for (name, bytes) in &self.files {
            bench = bench.with(name, bytes);
        }
        let before = bench.listing();
        let outcome = bench.run(&self.arguments);
        let missing = self
            .says
            .iter()
            .find(|fragment| !outcome.stderr.contains(**fragment));
        let fault = if outcome.code != Some(self.code) {
            format!("not exit code {}", self.code)
        } else if let Some(fragment) = missing {
            format!("does not say {fragment:?}")
        } else if !outcome.stdout.is_empty() {
            "prints something".to_owned()
        } else if outcome.stderr.len() > 20_000 {
            "says too much".to_owned()
        } else if bench.listing() != before {
            format!("leaves {:?}", bench.listing())
        } else {
            return None;
        };
        Some(format!("== {}: {fault}\n{outcome}", self.what))
    }
}

fn check(rows: &[Bad]) {
    let faults: Vec<String> = rows.iter().filter_map(Bad::fault).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

const KERNEL: &str = "kernel = { bandwidth = 0.3 }";
