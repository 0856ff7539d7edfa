//! A folder to work in, the program, and what came of it, in words.
#![allow(clippy::unwrap_used, dead_code)]

use assert_cmd::cargo::cargo_bin;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A folder of its own in which `lab` runs.
pub struct Bench {
    folder: TempDir,
    stdin: Option<Vec<u8>>,
}

impl Bench {
    /// An empty one.
    pub fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
            stdin: None,
        }
    }

    /// With a file.
    pub fn with(self, name: &str, bytes: impl AsRef<[u8]>) -> Self {
        fs::write(self.path(name), bytes).unwrap();
        self
    }

    /// With these bytes on the standard input.
    pub fn reading(mut self, bytes: impl AsRef<[u8]>) -> Self {
        self.stdin = Some(bytes.as_ref().to_vec());
        self
    }

    /// A place in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The text of a file in it.
    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// The names of everything in it.
    pub fn listing(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// The program with these arguments, not yet started.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(cargo_bin!("lab"));
        command
            .args(arguments)
            .current_dir(self.folder.path())
            .env_remove("NO_COLOR");
        command
    }

    /// Runs it to its end.
    pub fn run(&self, arguments: &[&str]) -> Outcome {
        let mut child = self
            .command(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut pipe = child.stdin.take().unwrap();
        let input = self.stdin.clone().unwrap_or_default();
        // a program that does not read to the end closes the pipe
        let writer = std::thread::spawn(move || drop(pipe.write_all(&input)));
        let output = child.wait_with_output().unwrap();
        writer.join().unwrap();
        Outcome::new(arguments, output)
    }

    /// Runs a line of the shell in which `lab` is the program.
    pub fn shell(&self, line: &str) -> Outcome {
        let folder: &Path = cargo_bin!("lab").parent().unwrap();
        let path = std::env::var("PATH").unwrap_or_default();
        let output = Command::new("bash")
            .args(["-o", "pipefail", "-c", line])
            .current_dir(self.folder.path())
            .env("PATH", format!("{}:{path}", folder.display()))
            .output()
            .unwrap();
        Outcome::new(&[line], output)
    }
}

/// What came of it.
pub struct Outcome {
    line: String,
    /// The exit code; none if a signal ended it.
    pub code: Option<i32>,
    /// The data.
    pub stdout: String,
    /// Everything else.
    pub stderr: String,
}

impl Outcome {
    fn new(arguments: &[&str], output: Output) -> Self {
        let outcome = Self {
            line: arguments.join(" "),
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        };
        assert!(!outcome.stderr.contains("panicked"), "{outcome}");
        outcome
    }

    /// It ended with this code.
    pub fn ends_with(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{self}");
        self
    }

    /// It ended well.
    pub fn succeeds(self) -> Self {
        self.ends_with(0)
    }

    /// The standard error has this.
    pub fn says(self, fragment: &str) -> Self {
        assert!(self.stderr.contains(fragment), "no {fragment:?} in\n{self}");
        self
    }

    /// The standard output has this.
    pub fn prints(self, fragment: &str) -> Self {
        assert!(self.stdout.contains(fragment), "no {fragment:?} in\n{self}");
        self
    }

    /// The standard output is empty.
    pub fn prints_nothing(self) -> Self {
        assert!(self.stdout.is_empty(), "{self}");
        self
    }

    /// The standard error is empty.
    pub fn says_nothing(self) -> Self {
        assert!(self.stderr.is_empty(), "{self}");
        self
    }

    /// The standard output as JSON.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}\n{self}"))
    }

    /// The standard output as a CSV table of numbers with this header.
    pub fn table(&self, header: &str) -> Vec<Vec<f64>> {
        table(&self.stdout, header)
    }
}

/// A CSV table of numbers with this header.
pub fn table(text: &str, header: &str) -> Vec<Vec<f64>> {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(header));
    lines
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect()
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            line,
            code,
            stdout,
            stderr,
        } = self;
        let shown: String = stdout.chars().take(400).collect();
        write!(
            f,
            "lab {line}\nended with {code:?}\n--- stdout\n{shown}\n--- stderr\n{stderr}"
        )
    }
}
