//! Ctrl-C: what is unfinished is taken away, and the exit code is 130.
//!
//! A command that can save its work asks for [`graceful`]; then the first Ctrl-C only raises the flag, and a second one ends at once.

use crate::storage;
use std::sync::atomic::{AtomicBool, Ordering};

static RAISED: AtomicBool = AtomicBool::new(false);
static GRACEFUL: AtomicBool = AtomicBool::new(false);

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
    storage::abandon(|| std::process::exit(130))
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
