//! Files and folders that appear whole or not at all.
//!
//! Everything is written under another name beside its place, flushed, checked, and renamed: a full disk, a kill or a crash leaves what was
//! there before, never half of something.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// An I/O failure with the file it happened to.
#[derive(Debug, thiserror::Error)]
#[error("{}: {doing} failed: {source}", path.display())]
pub struct StorageError {
    /// The file or folder.
    pub path: PathBuf,
    /// What was being done.
    pub doing: &'static str,
    /// What the system said.
    pub source: io::Error,
}

impl StorageError {
    /// For use with `map_err`: what was done to which path.
    pub fn at(path: &Path, doing: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self {
            path,
            doing,
            source,
        }
    }
}

/// The beginning of the names of files that are not finished.
pub const PREFIX: &str = ".lab-";

/// Files that must not outlive an interruption.
struct Registry(Mutex<Vec<PathBuf>>);

static UNFINISHED: Registry = Registry(Mutex::new(Vec::new()));

impl Registry {
    fn paths(&self) -> MutexGuard<'_, Vec<PathBuf>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn make(
        &'static self,
        file: impl FnOnce() -> io::Result<NamedTempFile>,
    ) -> io::Result<(NamedTempFile, Unfinished)> {
        let mut paths = self.paths();
        let file = file()?;
        let path = file.path().to_owned();
        paths.push(path.clone());
        Ok((
            file,
            Unfinished {
                registry: self,
                path,
            },
        ))
    }

    fn abandon<T>(&self, last: impl FnOnce() -> T) -> T {
        let paths = self.paths();
        for path in paths.iter() {
            let _ = fs::remove_file(path);
        }
        last()
    }
}

/// Responsibility for a file that must not outlive an interruption, until dropped.
pub struct Unfinished {
    registry: &'static Registry,
    path: PathBuf,
}

impl Unfinished {
    /// Makes a file under another name and takes responsibility for it, in one step, so that no interruption comes between.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn make(
        file: impl FnOnce() -> io::Result<NamedTempFile>,
    ) -> io::Result<(NamedTempFile, Self)> {
        UNFINISHED.make(file)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        self.registry.paths().retain(|path| *path != self.path);
    }
}

/// Takes away all files that are not finished, and lets nobody begin another while `last` is done, which ends the program.
pub fn abandon<T>(last: impl FnOnce() -> T) -> T {
    UNFINISHED.abandon(last)
}

/// Takes away what a killed process has left unfinished in a folder that is now ours.
///
/// # Errors
/// If the folder cannot be read or a file not removed.
pub fn sweep(folder: &Path) -> Result<(), StorageError> {
    let entries = fs::read_dir(folder).map_err(StorageError::at(folder, "reading"))?;
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with(PREFIX) && path.is_file() {
            fs::remove_file(&path).map_err(StorageError::at(&path, "removing"))?;
        }
    }
    Ok(())
}

/// Writes `bytes` to `path` so that the file appears complete or stays as it was.
///
/// # Errors
/// If the folder cannot be written or the disk is full.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), StorageError> {
    write(path, bytes, true)
}

/// The same without waiting for the disk: a kill leaves all or nothing, but what a power cut leaves must be checked by who reads it.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_unhurried(path: &Path, bytes: &[u8]) -> Result<(), StorageError> {
    write(path, bytes, false)
}

fn write(path: &Path, bytes: &[u8], wait: bool) -> Result<(), StorageError> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let make = || tempfile::Builder::new().prefix(PREFIX).tempfile_in(folder);
    let (mut file, guard) = Unfinished::make(make).map_err(StorageError::at(path, "creating"))?;
    file.write_all(bytes)
        .and_then(|()| file.flush())
        .map_err(StorageError::at(path, "writing"))?;
    if wait {
        // some file systems report a full disk only here
        file.as_file()
            .sync_data()
            .map_err(StorageError::at(path, "writing"))?;
    }
    readable_by_others(file.path()).map_err(StorageError::at(path, "writing"))?;
    file.persist(path)
        .map_err(|error| StorageError::at(path, "renaming")(error.error))?;
    drop(guard);
    Ok(())
}

/// Temporary files are private; what they become is an ordinary file.
#[cfg(unix)]
fn readable_by_others(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable_by_others(_path: &Path) -> io::Result<()> {
    Ok(())
}

/// Reads a whole file.
///
/// # Errors
/// If it cannot be read.
pub fn read(path: &Path) -> Result<Vec<u8>, StorageError> {
    fs::read(path).map_err(StorageError::at(path, "reading"))
}

#[cfg(test)]
mod tests {
    use super::{PREFIX, Registry, sweep, write_atomically};
    use std::sync::Mutex;

    #[test]
    fn a_file_appears_whole_and_replaces_another() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("table.csv");
        write_atomically(&path, b"first").expect("writable");
        write_atomically(&path, b"second").expect("writable");
        assert_eq!(std::fs::read(&path).expect("readable"), b"second");
        assert_eq!(
            std::fs::read_dir(folder.path()).expect("readable").count(),
            1,
            "nothing else is left"
        );
    }

    /// What an interruption finds half written goes; what is finished stays; and what a kill has left goes when the folder is taken over.
    #[test]
    fn nothing_half_written_outlives_an_interruption() {
        // of its own: other tests write files meanwhile
        static OURS: Registry = Registry(Mutex::new(Vec::new()));
        let folder = tempfile::tempdir().expect("a temporary folder");
        let names = || {
            let entries = std::fs::read_dir(folder.path()).expect("readable");
            let mut names: Vec<_> = entries.flatten().map(|e| e.file_name()).collect();
            names.sort();
            names
        };
        write_atomically(&folder.path().join("table.csv"), b"whole").expect("writable");
        let make = || {
            tempfile::Builder::new()
                .prefix(PREFIX)
                .tempfile_in(folder.path())
        };
        let (half, guard) = OURS.make(make).expect("writable");
        assert_eq!(names().len(), 2);
        OURS.abandon(|| ());
        assert_eq!(names(), ["table.csv"]);
        drop((half, guard));
        let (file, guard) = OURS.make(make).expect("writable");
        let kept = folder.path().join("kept");
        file.persist(&kept).expect("writable");
        drop(guard);
        std::fs::write(folder.path().join(".lab-left"), b"half").expect("writable");
        OURS.abandon(|| ());
        assert_eq!(names(), [".lab-left", "kept", "table.csv"]);
        sweep(folder.path()).expect("readable");
        assert_eq!(names(), ["kept", "table.csv"]);
    }

    #[test]
    fn failure_names_the_file() {
        let error = write_atomically(std::path::Path::new("/proc/nowhere/table.csv"), b"x")
            .expect_err("not writable");
        assert!(
            error.to_string().contains("/proc/nowhere/table.csv"),
            "{error}"
        );
    }
}
