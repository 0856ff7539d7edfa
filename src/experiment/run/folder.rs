//! The folder of a run: found by what the experiment is, locked while in use, complete or not there.
//!
//! While a run is going on its folder is called `NAME.partial` and holds the journal; when everything is written it is renamed to `NAME`
//! and the journal goes. A folder that is not a run of this laboratory is never touched.
//!
//! Numbers that another build of the laboratory computed are neither continued nor shown as if this one had: such a run is computed anew, with a word
//! about it, and takes the old one's place when it is finished.

use super::RunError;
use crate::experiment::Experiment;
use crate::experiment::program;
use crate::storage::StorageError;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// The file that says which experiment a folder belongs to, and in its second line which build computes it; `manifest.json` of a finished run holds the same
/// under `fingerprint` and `build`.
const OWNER: &str = "fingerprint";
/// What finished runs have, and what may be left in them after a crash while tidying.
const CONTENTS: [&str; 7] = [
    "manifest.json",
    "report.html",
    "tables",
    "figures",
    "journal",
    OWNER,
    "lock",
];

/// The hash of the resolved experiment with its seed, of whether it was cut short by `--quick` (which judges claims more leniently, whatever the number
/// of replicates), and of the version of the laboratory.
pub fn fingerprint(experiment: &Experiment, quick: bool) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(program::VERSION.as_bytes());
    hasher.update(if quick { b" quick " } else { b" whole " });
    hasher.update(&serde_json::to_vec(experiment).unwrap_or_default());
    hasher.finalize().to_hex().to_string()
}

/// What a run is, and who computes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// [`fingerprint`].
    pub fingerprint: String,
    /// [`program::build`].
    pub build: String,
}

impl Identity {
    /// That of a run of `experiment` by this program.
    pub fn of(experiment: &Experiment, quick: bool) -> Self {
        Self {
            fingerprint: fingerprint(experiment, quick),
            build: program::build().to_owned(),
        }
    }
}

/// What to do about what is there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// A finished run is reused, a half-finished one continued; what another build computed is computed anew.
    Continue,
    /// The same, but what another build began is an error.
    Resume,
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
    remark: Option<String>,
    _lock: File,
}

impl RunFolder {
    /// The folder that a run of the experiment called `name` goes to if none is named: `runs/NAME-HASH8`.
    pub fn default_place(name: &str, identity: &Identity) -> PathBuf {
        Path::new("runs").join(format!("{name}-{}", &identity.fingerprint[..8]))
    }

    /// Opens the folder for a run at `place`.
    ///
    /// # Errors
    /// If the place is taken by something else, another process is at work there, or it cannot be written.
    pub fn open(
        place: &Path,
        identity: &Identity,
        existing: Existing,
    ) -> Result<Opening, RunError> {
        let mut remark = None;
        if let Some(found) = finished(place)?
            && existing != Existing::Replace
        {
            if found.fingerprint != identity.fingerprint {
                return Err(RunError::Folder(format!(
                    "{} holds another run; give another --out, or --force to replace it",
                    place.display()
                )));
            }
            if found.build == identity.build {
                return Ok(Opening::Finished(place.to_owned()));
            }
            only_ours(place)?;
            remark = Some(format!(
                "{} was computed {}: it is computed anew and replaced at the end",
                place.display(),
                program::difference(&found.build)
            ));
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
        crate::storage::sweep(&partial)?;
        let owner = partial.join(OWNER);
        let known = fs::read_to_string(&owner).unwrap_or_default();
        let (theirs, build) = known.split_once('\n').unwrap_or((&known, ""));
        let journal = partial.join("journal");
        if journal.is_dir() {
            crate::storage::sweep(&journal)?;
        }
        let begun = !theirs.is_empty() && existing != Existing::Replace;
        if begun && theirs != identity.fingerprint {
            return Err(RunError::Folder(format!(
                "{} holds an unfinished run of another experiment; give another --out, or --force to discard it",
                partial.display()
            )));
        }
        if begun && build != identity.build {
            let difference = program::difference(build);
            if existing == Existing::Resume {
                return Err(RunError::Folder(format!(
                    "{} was begun {difference}: what they compute cannot be mixed; leave --resume out to begin anew, or go on with that build",
                    partial.display()
                )));
            }
            remark = Some(format!(
                "{} was begun {difference}: it is begun anew",
                partial.display()
            ));
        }
        let mine = format!("{}\n{}", identity.fingerprint, identity.build);
        if known != mine || existing == Existing::Replace {
            if journal.exists() {
                fs::remove_dir_all(&journal).map_err(StorageError::at(&journal, "clearing"))?;
            }
            crate::storage::write_atomically(&owner, mine.as_bytes())?;
        }
        fs::create_dir_all(&journal).map_err(StorageError::at(&journal, "creating"))?;
        Ok(Opening::Open(Self {
            place: place.to_owned(),
            partial,
            journal,
            remark,
            _lock: lock,
        }))
    }

    /// What the user should know about what was here before.
    pub fn remark(&self) -> Option<&str> {
        self.remark.as_deref()
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
    /// If something else has taken the place meanwhile, or renaming fails; the files stay in the partial folder then, and what was there stays where it was.
    pub fn finish(self) -> Result<PathBuf, RunError> {
        let old = sibling(&self.place, &format!("replaced-{}", std::process::id()));
        let replaces = finished(&self.place)?.is_some();
        if replaces {
            fs::rename(&self.place, &old).map_err(StorageError::at(&self.place, "renaming"))?;
        } else if self.place.exists() {
            // it is empty, or it would not have passed
            fs::remove_dir(&self.place).map_err(StorageError::at(&self.place, "removing"))?;
        }
        if let Err(error) = fs::rename(&self.partial, &self.place) {
            if replaces {
                let _ = fs::rename(&old, &self.place);
            }
            return Err(StorageError::at(&self.place, "renaming")(error).into());
        }
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

/// Refuses to replace, unasked, a folder into which somebody has put something.
fn only_ours(place: &Path) -> Result<(), RunError> {
    let entries = fs::read_dir(place).map_err(StorageError::at(place, "reading"))?;
    let other = entries
        .flatten()
        .map(|entry| entry.file_name())
        .find(|name| !CONTENTS.iter().any(|ours| name == ours));
    match other {
        None => Ok(()),
        Some(name) => Err(RunError::Folder(format!(
            "{} was computed by another build of the laboratory and cannot be replaced, because it holds {}, which is not part of a run; give another --out, or --force to replace everything",
            place.display(),
            name.display()
        ))),
    }
}

/// Which finished run is at `place`; `None` if nothing (or an empty folder) is there; an error if it is not a run.
fn finished(place: &Path) -> Result<Option<Identity>, RunError> {
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
            let text = |key| Some(manifest.get(key)?.as_str()?.to_owned());
            Some(Identity {
                fingerprint: text("fingerprint")?,
                // older versions did not say
                build: text("build").unwrap_or_default(),
            })
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
