//! All checks under many seeds: false alarms of a healthy laboratory, power against a fault.

use super::{CHECKS, Fault, Finding, LEVEL, Subjects};
use rayon::prelude::*;
use statrs::distribution::{Binomial, DiscreteCDF};

/// What the checks found, seed by seed.
pub struct Examination {
    /// The seeds.
    pub seeds: Vec<u64>,
    /// For each seed what each check found, in the order of [`CHECKS`].
    pub findings: Vec<Vec<Finding>>,
}

/// Runs every check for `number` seeds from `first`, on healthy subjects or with a fault planted. The result does not depend on the number of threads.
pub fn examine(first: u64, number: usize, planted: Option<&Fault>) -> Examination {
    let mut subjects = Subjects::healthy();
    if let Some(fault) = planted {
        (fault.plant)(&mut subjects);
    }
    let seeds: Vec<u64> = (0..number as u64).map(|i| first.wrapping_add(i)).collect();
    let work: Vec<(u64, usize)> = seeds
        .iter()
        .flat_map(|&seed| (0..CHECKS.len()).map(move |check| (seed, check)))
        .collect();
    let found: Vec<Finding> = work
        .into_par_iter()
        .map(|(seed, check)| (CHECKS[check].run)(&subjects, seed))
        .collect();
    let findings = found
        .chunks(CHECKS.len())
        .map(<[Finding]>::to_vec)
        .collect();
    Examination { seeds, findings }
}

impl Examination {
    /// Under how many seeds check number `check` failed.
    pub fn alarms_of(&self, check: usize) -> usize {
        self.findings
            .iter()
            .filter(|findings| findings[check].is_alarm())
            .count()
    }

    /// Under how many seeds any check failed.
    pub fn alarms(&self) -> usize {
        self.findings
            .iter()
            .filter(|findings| findings.iter().any(Finding::is_alarm))
            .count()
    }

    /// Whether there were more alarms than the stated level explains: any alarm for one seed; for many, more than happen with probability 1/1000.
    pub fn is_ill(&self) -> bool {
        let (alarms, seeds) = (self.alarms() as u64, self.seeds.len() as u64);
        if seeds <= 1 {
            return alarms > 0;
        }
        // P(at least as many)
        let more = |alarms: u64| {
            Binomial::new(LEVEL, seeds).map_or(0.0, |chance| chance.sf(alarms.saturating_sub(1)))
        };
        alarms > 0 && more(alarms) < 1e-3
    }

    /// The largest relative error that check number `check` may have missed with the stated probability, the mean over seeds.
    pub fn detectable(&self, check: usize) -> f64 {
        let all = self
            .findings
            .iter()
            .map(|findings| findings[check].detectable);
        all.sum::<f64>() / self.findings.len() as f64
    }
}
