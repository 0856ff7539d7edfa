//! How much memory there is, so that a task too large for it is refused with a figure instead of being killed half-way.
//!
//! An oversized allocation aborts the process, and a merely large one succeeds and is killed when it is used; so whoever is about to hold much
//! asks here first.

use std::fs;

/// More bytes were asked for than there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{} of memory would be needed, and {} are available", Bytes(*.needed), Bytes(*.available))]
pub struct TooLarge {
    /// Bytes asked for.
    pub needed: u64,
    /// Bytes available when asked.
    pub available: u64,
}

/// Bytes that can still be used: the least of what the machine can free and what the control group of the process allows. Where neither is
/// known, no limit.
pub fn available() -> u64 {
    [machine(), control_group()]
        .into_iter()
        .flatten()
        .min()
        .unwrap_or(u64::MAX)
}

/// `count` times `zero`, each page of which has been written once.
///
/// What a system gives as zeros may be one page shown many times until it is written. A table that is read and written in turn then takes a copy of it page by
/// page, and each copy interrupts all processors that run this program: where two threads fill tables that costs more than the second one gains.
#[inline]
pub fn zeros<T: Copy>(zero: T, count: usize) -> Vec<T> {
    const PAGE: usize = 4096;
    let mut table = vec![zero; count];
    let step = (PAGE / size_of::<T>().max(1)).max(1);
    for place in table.iter_mut().step_by(step) {
        // not left out as superfluous
        *place = std::hint::black_box(zero);
    }
    if let Some(last) = table.last_mut() {
        *last = std::hint::black_box(zero);
    }
    table
}

/// Says whether `needed` further bytes fit.
///
/// # Errors
/// If they do not.
pub fn check(needed: u64) -> Result<(), TooLarge> {
    let available = available();
    if needed <= available {
        Ok(())
    } else {
        Err(TooLarge { needed, available })
    }
}

fn machine() -> Option<u64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// The unified hierarchy as a container sees it, at its root.
fn control_group() -> Option<u64> {
    let number = |name: &str| -> Option<u64> {
        fs::read_to_string(format!("/sys/fs/cgroup/{name}"))
            .ok()?
            .trim()
            .parse()
            .ok()
    };
    Some(number("memory.max")?.saturating_sub(number("memory.current")?))
}

/// Shows bytes in a unit that a person reads: `1.5 GiB`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bytes(pub u64);

impl std::fmt::Display for Bytes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        const UNITS: [&str; 6] = ["KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
        if self.0 < 1024 {
            return write!(f, "{} bytes", self.0);
        }
        let mut amount = self.0 as f64 / 1024.0;
        let mut unit = 0;
        while amount >= 1023.95 && unit + 1 < UNITS.len() {
            amount /= 1024.0;
            unit += 1;
        }
        write!(f, "{amount:.1} {}", UNITS[unit])
    }
}

#[cfg(test)]
mod tests {
    use super::{Bytes, available, check};

    #[test]
    fn amounts_are_readable() {
        let shown = [0, 1023, 1536, 5 << 30, u64::MAX].map(|bytes| Bytes(bytes).to_string());
        assert_eq!(
            shown,
            ["0 bytes", "1023 bytes", "1.5 KiB", "5.0 GiB", "16.0 EiB"]
        );
    }

    #[test]
    fn what_does_not_fit_is_refused_with_the_figure() {
        assert_eq!(check(1), Ok(()));
        if available() < u64::MAX {
            let refusal = check(u64::MAX).expect_err("nobody has 16 EiB");
            assert!(refusal.to_string().starts_with("16.0 EiB of memory"));
        }
    }
}
