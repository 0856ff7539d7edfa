//! Is the laboratory itself well? Statistical self-checks of known level and power, and known faults to try them on.
//!
//! A [`Check`] draws its own samples, compares what an implementation of a public trait gives with what theory says, and yields a p-value. The [`Subjects`] are the
//! implementations that are examined. A [`Fault`] is a **wrong implementation of one of these traits**, kept here beside the checks: planting it replaces a subject, and nothing
//! in the rest of the code knows of it. So the question "would you have noticed?" has a measured answer for each fault.
//!
//! | what | where |
//! |---|---|
//! | p-values, sharpness, the sum of several comparisons | `evidence.rs` |
//! | what is examined, healthy | `subjects.rs` |
//! | the checks | `checks/` |
//! | the faults | `faults/` |
//! | many seeds: false alarms and power | `examination.rs` |
//! | nominal against actual, for everything that states a probability | `calibration/` |
//!
//! # Level
//! A healthy laboratory fails the whole suite with probability at most [`LEVEL`] a seed: each of the checks is held at [`LEVEL`] over their number (Bonferroni), and each comparison within a check
//! at that over its own number. Comparisons without chance (an engine against the definition) never fail by chance and make the true level lower than stated.
//!
//! # Power
//! Each check says what relative error it would have caught with probability [`POWER`], from the standard error that it measured itself: its *minimum detectable bias*.

pub mod calibration;
mod checks;
mod evidence;
mod examination;
mod faults;
mod subjects;

pub use checks::CHECKS;
pub use evidence::{Evidence, Finding};
pub use examination::{Examination, examine};
pub use faults::FAULTS;
pub use subjects::{Constants, Subjects};

/// The chance that a healthy laboratory fails, at most, for each seed.
pub const LEVEL: f64 = 0.01;

/// The probability with which a check finds an error of the size that it states.
pub const POWER: f64 = 0.9;

/// The level of one check.
pub fn check_level() -> f64 {
    LEVEL / CHECKS.len() as f64
}

/// A self-check.
pub struct Check {
    /// Its name.
    pub name: &'static str,
    /// What must hold, in a sentence.
    pub states: &'static str,
    /// Looks, with random numbers of its own under a seed.
    pub run: fn(&Subjects, u64) -> Finding,
}

/// A wrong implementation of a public trait.
pub struct Fault {
    /// Its name.
    pub name: &'static str,
    /// What is wrong, in a sentence.
    pub summary: &'static str,
    /// The check that is expected to find it; others may too.
    pub caught_by: &'static str,
    /// Puts it in place of what is right.
    pub plant: fn(&mut Subjects),
}

/// The fault of that name.
pub fn fault(name: &str) -> Option<&'static Fault> {
    FAULTS.iter().find(|fault| fault.name == name)
}
