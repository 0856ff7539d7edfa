//! Finished cells on disk.
//!
//! A record is one file that appears whole (written beside, renamed) and carries the hash of its contents, so that whatever a crash left behind
//! is either right or ignored. So there is no need to wait for the disk, which would cost more than the samples do where they are small: a killed process loses no finished cell, a power cut
//! those of the last half minute or so, which are then computed once more.

use super::{Cell, Record};
use crate::storage::{StorageError, write_unhurried};
use std::fs;
use std::path::{Path, PathBuf};

fn place(journal: &Path, cell: Cell) -> PathBuf {
    let Cell {
        source,
        size,
        estimator,
        block,
    } = cell;
    journal.join(format!(
        "source{source}-size{size}-estimator{estimator}-block{block}.json"
    ))
}

/// Writes the record of `cell`.
pub(super) fn save(journal: &Path, cell: Cell, record: &Record) -> Result<(), StorageError> {
    let path = place(journal, cell);
    let body = serde_json::to_string(record)
        .map_err(std::io::Error::other)
        .map_err(StorageError::at(&path, "encoding"))?;
    write_unhurried(
        &path,
        format!("{}\n{body}\n", blake3::hash(body.as_bytes())).as_bytes(),
    )
}

/// The record of `cell`, if it was finished and is undamaged.
pub(super) fn load(journal: &Path, cell: Cell) -> Option<Record> {
    let text = fs::read_to_string(place(journal, cell)).ok()?;
    let (hash, body) = text.split_once('\n')?;
    let body = body.strip_suffix('\n')?;
    (blake3::hash(body.as_bytes()).to_string() == hash)
        .then(|| serde_json::from_str(body).ok())
        .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::{Errors, Tally};
    use crate::experiment::run::Replicate;

    fn record() -> Record {
        let mut tally = Tally::default();
        tally.add(&[0.1 + 0.2, 1e-300, 1.0 / 3.0], &[0.0; 3]);
        let errors = Some(Errors {
            ise: 2.0_f64.sqrt(),
            iae: f64::MIN_POSITIVE,
            ire: 1e22,
            bias: -0.1,
        });
        let replicates = vec![Replicate {
            errors,
            integral: 1.0 - 1e-16,
            modes: 3,
            smoothing: None,
            regions: vec![crate::experiment::run::Part {
                errors,
                integral: 1.0 / 3.0,
            }],
        }];
        Record {
            replicates,
            tally,
            warnings: Vec::new(),
            engine: Some("direct".to_owned()),
            said: Vec::new(),
            coverage: None,
        }
    }

    const CELL: Cell = Cell {
        source: 0,
        size: 1,
        estimator: 2,
        block: 3,
    };

    #[test]
    fn a_record_comes_back_bit_for_bit() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        save(folder.path(), CELL, &record()).expect("writable");
        assert_eq!(load(folder.path(), CELL), Some(record()));
        assert_eq!(load(folder.path(), Cell { block: 4, ..CELL }), None);
    }

    #[test]
    fn a_damaged_record_is_no_record() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        save(folder.path(), CELL, &record()).expect("writable");
        let path = place(folder.path(), CELL);
        let text = fs::read_to_string(&path).expect("readable");
        fs::write(&path, text.replace("\"modes\":3", "\"modes\":4")).expect("writable");
        assert_eq!(load(folder.path(), CELL), None);
        fs::write(&path, &text[..text.len() / 2]).expect("writable");
        assert_eq!(load(folder.path(), CELL), None);
    }
}
