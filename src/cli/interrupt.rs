//! Ctrl-C: what is unfinished is taken away, and the exit code is 130.
//!
//! A command that can save its work asks for [`graceful`]; then the first Ctrl-C only raises the flag, and a second one ends at once.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

static RAISED: AtomicBool = AtomicBool::new(false);
static GRACEFUL: AtomicBool = AtomicBool::new(false);
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Listens from now on. Where the system lets nobody listen, Ctrl-C ends the program as it always did.
pub fn listen() {
    let _ = ctrlc::set_handler(|| {
        let first = !RAISED.swap(true, Ordering::SeqCst);
        if !(first && GRACEFUL.load(Ordering::SeqCst)) {
            end();
        }
    });
}

fn end() -> ! {
    if let Ok(paths) = UNFINISHED.lock() {
        for path in paths.iter() {
            let _ = std::fs::remove_file(path);
        }
    }
    std::process::exit(130);
}

/// The flag that is raised by Ctrl-C, for a command that watches it and ends by itself.
pub fn graceful() -> &'static AtomicBool {
    GRACEFUL.store(true, Ordering::SeqCst);
    &RAISED
}

/// Nobody watches the flag any more: from here on Ctrl-C ends at once, and so it does here if it has come meanwhile.
pub fn at_once() {
    GRACEFUL.store(false, Ordering::SeqCst);
    if RAISED.load(Ordering::SeqCst) {
        end();
    }
}

/// A file that must not outlive an interruption.
#[derive(Debug)]
pub struct Unfinished(PathBuf);

impl Unfinished {
    /// Takes responsibility for `path` until dropped.
    pub fn new(path: &Path) -> Self {
        if let Ok(mut paths) = UNFINISHED.lock() {
            paths.push(path.to_owned());
        }
        Self(path.to_owned())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if let Ok(mut paths) = UNFINISHED.lock() {
            paths.retain(|path| *path != self.0);
        }
    }
}
