//! Rows of a long trace on disk, piece by piece, until all are there.
//!
//! A piece is one file that appears whole and begins with the hash of the rest, so that whatever a crash left behind is either right or ignored.
//! A spool belongs to one trace, named by an identity; that of another is emptied.

use crate::light::ledger::Ledger;
use crate::storage::{self, StorageError, write_atomically, write_unhurried};
use std::fs;
use std::path::{Path, PathBuf};

/// A folder of finished pieces.
#[derive(Debug)]
pub struct Spool {
    folder: PathBuf,
}

/// One finished piece.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Where its light went.
    pub ledger: Ledger,
    /// Its rows.
    pub rows: Vec<u8>,
}

impl Spool {
    /// The spool in `folder` for the trace of this identity; pieces of the same trace are kept.
    ///
    /// # Errors
    /// If the folder cannot be made or emptied.
    pub fn open(folder: &Path, identity: &str) -> Result<Self, StorageError> {
        let mark = folder.join("trace.json");
        if fs::read_to_string(&mark).ok().as_deref() != Some(identity) {
            if folder.exists() {
                fs::remove_dir_all(folder).map_err(StorageError::at(folder, "emptying"))?;
            }
            fs::create_dir_all(folder).map_err(StorageError::at(folder, "creating"))?;
            write_atomically(&mark, identity.as_bytes())?;
        }
        Ok(Self {
            folder: folder.to_owned(),
        })
    }

    fn place(&self, piece: u64) -> PathBuf {
        self.folder.join(format!("piece-{piece:07}"))
    }

    /// Keeps a piece.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(&self, number: u64, piece: &Piece) -> Result<(), StorageError> {
        let path = self.place(number);
        let about = serde_json::to_string(&piece.ledger)
            .map_err(std::io::Error::other)
            .map_err(StorageError::at(&path, "encoding"))?;
        let mut body = about.into_bytes();
        body.push(b'\n');
        body.extend(&piece.rows);
        let mut bytes = blake3::hash(&body).to_hex().as_bytes().to_vec();
        bytes.push(b'\n');
        bytes.extend(body);
        // the hash tells what a power cut has damaged, so that a piece need not wait for the disk
        write_unhurried(&path, &bytes)
    }

    /// A piece, if it was finished and is undamaged.
    pub fn load(&self, number: u64) -> Option<Piece> {
        let bytes = storage::read(&self.place(number)).ok()?;
        let (hash, body) = (bytes.get(..64)?, bytes.get(65..)?);
        if blake3::hash(body).to_hex().as_bytes() != hash {
            return None;
        }
        let end = body.iter().position(|&byte| byte == b'\n')?;
        Some(Piece {
            ledger: serde_json::from_slice(&body[..end]).ok()?,
            rows: body[end + 1..].to_vec(),
        })
    }

    /// Takes the folder away.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn remove(self) -> Result<(), StorageError> {
        fs::remove_dir_all(&self.folder).map_err(StorageError::at(&self.folder, "removing"))
    }
}

#[cfg(test)]
mod tests {
    use super::{Piece, Spool};
    use crate::light::ledger::Ledger;

    #[test]
    fn pieces_come_back_and_damaged_or_foreign_ones_do_not() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().join("spool");
        let piece = Piece {
            ledger: Ledger {
                emitted: 0.1 + 0.2,
                hits: 3,
                ..Ledger::default()
            },
            rows: b"rows\n\x00".to_vec(),
        };
        let spool = Spool::open(&place, "first").expect("a spool");
        spool.save(4, &piece).expect("writable");
        let again = Spool::open(&place, "first").expect("a spool");
        assert_eq!(again.load(4), Some(piece.clone()));
        assert_eq!(again.load(5), None);
        let path = place.join("piece-0000004");
        let bytes = std::fs::read(&path).expect("readable");
        std::fs::write(&path, &bytes[..bytes.len() - 1]).expect("writable");
        assert_eq!(again.load(4), None);
        again.save(4, &piece).expect("writable");
        let other = Spool::open(&place, "second").expect("a spool");
        assert_eq!(other.load(4), None);
        other.remove().expect("removable");
        assert!(!place.exists());
    }
}
