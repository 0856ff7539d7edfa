//! Files and folders that appear whole or not at all.
//!
//! Everything is written under another name beside its place, flushed, checked, and renamed: a full disk, a kill or a crash leaves what was
//! there before, never half of something.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

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
    let mut file = tempfile::Builder::new()
        .prefix(".lab-")
        .tempfile_in(folder)
        .map_err(StorageError::at(path, "creating"))?;
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
    use super::write_atomically;

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
