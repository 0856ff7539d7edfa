//! Where the light went: what was emitted is absorbed, or has escaped.

use serde::{Deserialize, Serialize};

/// The powers of a walk, and the numbers of its paths.
///
/// With survival by albedo every photon has the same power, so that paths can be counted: emitted = absorbed + escaped + endless, exactly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// Paths that began.
    pub paths: u64,
    /// Paths that ended on a surface or by roulette.
    pub ended: u64,
    /// Paths that left the scene.
    pub left: u64,
    /// Arrivals at fronts: the hits.
    pub hits: u64,
    /// Rays cast.
    pub segments: u64,
    /// Power emitted.
    pub emitted: f64,
    /// Power absorbed by fronts.
    pub absorbed: f64,
    /// Power absorbed by backs.
    pub behind: f64,
    /// Power that left the scene.
    pub escaped: f64,
    /// Power that roulette took away less what it gave: 0 on the average.
    pub roulette: f64,
    /// Power of paths that were cut off after 65 535 bounces.
    pub endless: f64,
}

/// What must not be in a ledger.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LedgerError {
    /// Power appeared or vanished: a fault of the program.
    #[error(
        "the light does not add up: {0:e} of what was emitted is neither absorbed nor escaped; please report this"
    )]
    Balance(f64),
    /// Light left a closed scene.
    #[error(
        "light leaks: {share:.2e} of what was emitted left the scene, more than {LEAK:e}; close the gap between its surfaces, turn surfaces that face away (`facing`), or say `open = true` if light may leave"
    )]
    Leak {
        /// The share of the emitted power.
        share: f64,
    },
    /// Paths did not end.
    #[error(
        "{share:.2e} of the light was still on its way after 65535 bounces: reflectances this near 1 in a closed scene cannot be traced"
    )]
    Endless {
        /// The share of the emitted power.
        share: f64,
    },
}

/// The share that may leave a closed scene through seams.
pub const LEAK: f64 = 1e-6;
/// The share that rounding may cost.
const BALANCE: f64 = 1e-9;

impl Ledger {
    /// Adds another.
    pub fn add(&mut self, other: &Self) {
        self.paths += other.paths;
        self.ended += other.ended;
        self.left += other.left;
        self.hits += other.hits;
        self.segments += other.segments;
        self.emitted += other.emitted;
        self.absorbed += other.absorbed;
        self.behind += other.behind;
        self.escaped += other.escaped;
        self.roulette += other.roulette;
        self.endless += other.endless;
    }

    /// What is missing on the side of the losses, as a share of what was emitted.
    pub fn imbalance(&self) -> f64 {
        let spent = self.absorbed + self.behind + self.escaped + self.roulette + self.endless;
        (self.emitted - spent) / self.emitted
    }

    /// Checks that the light adds up, that none leaks from a scene that is not `open`, and that all paths ended.
    ///
    /// # Errors
    /// If not.
    pub fn check(&self, open: bool) -> Result<(), LedgerError> {
        let imbalance = self.imbalance();
        if imbalance.is_nan() || imbalance.abs() > BALANCE {
            return Err(LedgerError::Balance(imbalance));
        }
        let share = self.escaped / self.emitted;
        if !open && share > LEAK {
            return Err(LedgerError::Leak { share });
        }
        let share = self.endless / self.emitted;
        if share > LEAK {
            return Err(LedgerError::Endless { share });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Ledger, LedgerError};

    #[test]
    fn what_is_lost_or_leaks_is_told() {
        let good = Ledger {
            emitted: 10.0,
            absorbed: 7.0,
            escaped: 3.0,
            ..Ledger::default()
        };
        assert_eq!(good.check(true), Ok(()));
        assert!(matches!(good.check(false), Err(LedgerError::Leak { .. })));
        let lost = Ledger {
            absorbed: 7.0 - 1e-7,
            ..good
        };
        assert!(matches!(lost.check(true), Err(LedgerError::Balance(_))));
    }
}
