//! Why a command ends before its end, and the exit code that says so.

use crate::experiment::read::Problems;
use crate::sample::file::FileError;
use crate::storage::StorageError;
use std::io;
use std::path::Path;

/// Why a command stopped.
#[derive(Debug)]
pub enum Stop {
    /// Whoever reads our output has gone: nothing is wrong.
    ReaderGone,
    /// Exit code 1: a claim or a comparison failed; the command has said which.
    Failed,
    /// Exit code 2: something given is not what it should be.
    Input(String),
    /// Exit code 2 likewise, where the reason has been told.
    Usage,
    /// Exit code 3: the system did not do what was asked of it.
    System(String),
    /// Exit code 130: stopped by its user.
    Interrupted(String),
}

impl Stop {
    /// What `error` on writing to `place` means.
    pub fn writing(place: &dyn std::fmt::Display, error: &io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self::ReaderGone
        } else {
            Self::System(format!("{place}: cannot be written: {error}"))
        }
    }

    /// What `error` on reading `path` means.
    pub fn reading(path: &Path, error: &io::Error) -> Self {
        Self::System(format!("{}: cannot be read: {error}", path.display()))
    }

    /// Tells what is wrong with an experiment, and what that means.
    pub fn problems(problems: &Problems) -> Self {
        if problems.is_input_output() {
            return Self::System(problems.to_string());
        }
        super::notes::tell(&problems.render(true));
        Self::Usage
    }

    /// The exit code.
    pub fn code(&self) -> u8 {
        match self {
            Self::ReaderGone => 0,
            Self::Failed => 1,
            Self::Input(_) | Self::Usage => 2,
            Self::System(_) => 3,
            Self::Interrupted(_) => 130,
        }
    }

    /// What to tell the user, if anything.
    pub fn message(&self) -> Option<&str> {
        match self {
            Self::Input(message) | Self::System(message) | Self::Interrupted(message) => {
                Some(message)
            }
            Self::ReaderGone | Self::Failed | Self::Usage => None,
        }
    }
}

impl From<FileError> for Stop {
    fn from(error: FileError) -> Self {
        match error {
            FileError::System { .. } => Self::System(error.to_string()),
            FileError::Content { .. } => Self::Input(error.to_string()),
        }
    }
}

impl From<StorageError> for Stop {
    fn from(error: StorageError) -> Self {
        Self::System(error.to_string())
    }
}
