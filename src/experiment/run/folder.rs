//! The folder of a run: found by what the experiment is, locked while in use, complete or not there.
//!
//! While a run is going on its folder is called `NAME.partial` and holds the journal; when everything is written it is renamed to `NAME`
//! and the journal goes. A folder that is not a run of this laboratory is never touched.

use super::RunError;
use crate::experiment::Experiment;
use crate::storage::StorageError;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// The file that says which experiment a folder belongs to; `manifest.json` of a finished run holds the same under `fingerprint`.
const OWNER: &str = "fingerprint";

/// What identifies a run: the hash of the resolved experiment, its seed, and the version of the laboratory.
pub fn fingerprint(experiment: &Experiment) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.update(&serde_json::to_vec(experiment).unwrap_or_default());
    hasher.finalize().to_hex().to_string()
}

/// What to do about what is there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// A finished run is reused, a half-finished one continued.
    Continue,
    /// A run is discarded and begun anew.
    Replace,
}

/// How a run folder was opened.
pub enum Opening {
    /// There is work to do here.
    Open(RunFolder),
    /// The run was finished before and is here.
    Finished(PathBuf),
}

/// A folder with a run going on; unlocked when dropped.
pub struct RunFolder {
    place: PathBuf,
    partial: PathBuf,
    journal: PathBuf,
    _lock: File,
}

impl RunFolder {
    /// The folder that a run of `experiment` goes to if none is named: `runs/NAME-HASH8`.
    pub fn default_place(experiment: &Experiment) -> PathBuf {
        Path::new("runs").join(format!(
            "{}-{}",
            experiment.name,
            &fingerprint(experiment)[..8]
        ))
    }

    /// Opens the folder for a run of `experiment` at `place`.
    ///
    /// # Errors
    /// If the place is taken by something else, another process is at work there, or it cannot be written.
    pub fn open(
        place: &Path,
        experiment: &Experiment,
        existing: Existing,
    ) -> Result<Opening, RunError> {
        let identity = fingerprint(experiment);
        if let Some(found) = finished_identity(place)? {
            if found == identity && existing == Existing::Continue {
                return Ok(Opening::Finished(place.to_owned()));
            }
            if existing == Existing::Continue {
                return Err(RunError::Folder(format!(
                    "{} holds another run; give another --out, or --force to replace it",
                    place.display()
                )));
            }
        }
        let partial = sibling(place, "partial");
        let unowned = fs::read_dir(&partial).is_ok_and(|mut inside| inside.next().is_some())
            && !partial.join(OWNER).is_file()
            && !partial.join("lock").is_file();
        if unowned {
            return Err(RunError::Folder(format!(
                "{} exists and is not an unfinished run of this laboratory; nothing in it was touched; give another --out",
                partial.display()
            )));
        }
        fs::create_dir_all(&partial).map_err(StorageError::at(&partial, "creating"))?;
        let lock = lock(&partial)?;
        let owner = partial.join(OWNER);
        let known = fs::read_to_string(&owner).unwrap_or_default();
        let journal = partial.join("journal");
        if known != identity && !known.is_empty() && existing == Existing::Continue {
            return Err(RunError::Folder(format!(
                "{} holds an unfinished run of another experiment; give another --out, or --force to discard it",
                partial.display()
            )));
        }
        if known != identity || existing == Existing::Replace {
            if journal.exists() {
                fs::remove_dir_all(&journal).map_err(StorageError::at(&journal, "clearing"))?;
            }
            crate::storage::write_atomically(&owner, identity.as_bytes())?;
        }
        fs::create_dir_all(&journal).map_err(StorageError::at(&journal, "creating"))?;
        Ok(Opening::Open(Self {
            place: place.to_owned(),
            partial,
            journal,
            _lock: lock,
        }))
    }

    /// Where finished cells are kept while the run goes on.
    pub(super) fn journal(&self) -> &Path {
        &self.journal
    }

    /// Where the run's files are to be written before [`RunFolder::finish`].
    pub fn path(&self) -> &Path {
        &self.partial
    }

    /// Makes a folder inside, for tables or figures, empty even if an earlier attempt left something.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn fresh(&self, name: &str) -> Result<PathBuf, StorageError> {
        let path = self.partial.join(name);
        if path.exists() {
            fs::remove_dir_all(&path).map_err(StorageError::at(&path, "clearing"))?;
        }
        fs::create_dir_all(&path).map_err(StorageError::at(&path, "creating"))?;
        Ok(path)
    }

    /// Everything is written: the folder takes its name, in place of a run that was to be replaced, and the journal goes.
    ///
    /// # Errors
    /// If renaming fails; the files stay in the partial folder then.
    pub fn finish(self) -> Result<PathBuf, RunError> {
        let old = sibling(&self.place, &format!("replaced-{}", std::process::id()));
        let replaces = self.place.exists();
        if replaces {
            fs::rename(&self.place, &old).map_err(StorageError::at(&self.place, "renaming"))?;
        }
        fs::rename(&self.partial, &self.place)
            .map_err(StorageError::at(&self.place, "renaming"))?;
        if replaces {
            fs::remove_dir_all(&old).map_err(StorageError::at(&old, "removing"))?;
        }
        // the run is complete and in its place from here on; what is left to do is tidying
        for leftover in ["journal", OWNER, "lock"] {
            let path = self.place.join(leftover);
            let removed = if path.is_dir() {
                fs::remove_dir_all(&path)
            } else {
                fs::remove_file(&path)
            };
            removed.map_err(StorageError::at(&path, "removing"))?;
        }
        Ok(self.place)
    }
}

fn sibling(place: &Path, ending: &str) -> PathBuf {
    let mut name = place.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{ending}"));
    place.with_file_name(name)
}

/// The fingerprint of the finished run at `place`; `None` if nothing (or an empty folder) is there; an error if it is not a run.
fn finished_identity(place: &Path) -> Result<Option<String>, RunError> {
    let Ok(about) = fs::metadata(place) else {
        return Ok(None);
    };
    if !about.is_dir() {
        return Err(RunError::Folder(format!(
            "{} exists and is not a folder; give another --out",
            place.display()
        )));
    }
    let mut inside = fs::read_dir(place).map_err(StorageError::at(place, "reading"))?;
    if inside.next().is_none() {
        return Ok(None);
    }
    let manifest = fs::read(place.join("manifest.json")).ok();
    let identity = manifest
        .and_then(|bytes| serde_json::from_slice::<serde_json::Value>(&bytes).ok())
        .and_then(|manifest| {
            manifest
                .get("fingerprint")
                .and_then(|f| f.as_str())
                .map(str::to_owned)
        });
    match identity {
        Some(identity) => Ok(Some(identity)),
        None => Err(RunError::Folder(format!(
            "{} exists and is not a run of this laboratory; nothing in it was touched; give another --out",
            place.display()
        ))),
    }
}

fn lock(partial: &Path) -> Result<File, RunError> {
    let path = partial.join("lock");
    let file = File::create(&path).map_err(StorageError::at(&path, "creating"))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(_) => Err(RunError::Folder(format!(
            "another process is running this experiment in {}",
            partial.display()
        ))),
    }
}
