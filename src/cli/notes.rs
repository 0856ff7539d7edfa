//! What is said beside the data, on the standard error.
//!
//! A terminal that has gone must not bring the program down, so failures to speak are ignored here, and only here.

use crate::space::Warning;
use std::io::Write;

/// Speaks, or keeps quiet.
#[derive(Clone, Copy, Debug)]
pub struct Notes {
    /// Say nothing but errors.
    pub quiet: bool,
}

impl Notes {
    /// Something that was asked for, or that is good to know.
    pub fn say(self, text: &str) {
        if !self.quiet {
            let _ = writeln!(anstream::stderr(), "{text}");
        }
    }

    /// Something that the reader of a result should know.
    pub fn warn(self, warning: &Warning) {
        if !self.quiet {
            let Warning { what, hint } = warning;
            let _ = writeln!(
                anstream::stderr(),
                "\x1b[1;33mwarning\x1b[0m: {what}; {hint}"
            );
        }
    }
}

/// Why there is no result.
pub fn error(text: &str) {
    let _ = writeln!(anstream::stderr(), "\x1b[1;31merror\x1b[0m: {text}");
}

/// A text that says itself what it is; styled where the terminal can show it.
pub fn tell(text: &str) {
    let _ = write!(anstream::stderr(), "{text}");
}
