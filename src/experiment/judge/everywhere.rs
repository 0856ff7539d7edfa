//! Claims that theory is right place by place.

use super::short;
use crate::accuracy::{reach, sidak};
use crate::experiment::results::Group;

/// How many standard errors of its mean an estimate must be away from zero for that mean to be taken as normal: where fewer points come, their number is skew.
const KNOWN: f64 = 25.0;

/// What rounding may do to a mean without spread, relative to the greatest.
const ROUNDING: f64 = 1e-9;

/// Whether the means over replicates are the exact ones, in units of their exact standard errors, at all places of all estimators at once.
///
/// Places where the mean is next to zero, as where nearly no sample comes, are left out and counted; where no sample can make a difference the means must be equal but for rounding.
pub(super) fn everywhere<const D: usize>(
    group: &Group<D>,
    of: &[String],
    confidence: f64,
) -> Option<(bool, String)> {
    let truth = group.truth.as_ref()?;
    let (mut places, mut left_out) = (0, 0);
    // deviation in standard errors, estimator, cell
    let mut farthest = (0.0, "", 0);
    for outcome in group.outcomes_of(of) {
        let (Some(expected), Some(spread)) = (&outcome.expected, &outcome.spread) else {
            let name = &outcome.name;
            return Some((false, format!("there is no exact mean of {name}")));
        };
        let root = (outcome.tally.count() as f64).sqrt();
        let peak = expected.iter().fold(0.0, |peak: f64, m| peak.max(m.abs()));
        for (cell, (&expected, &spread)) in expected.iter().zip(spread).enumerate() {
            if group.mask.as_ref().is_some_and(|mask| !mask[cell]) {
                continue;
            }
            let mean = outcome.tally.mean()[cell] + truth[cell];
            match look((mean, expected, spread / root), ROUNDING * peak) {
                Look::Equal => {}
                Look::Skew => left_out += 1,
                Look::Off(deviation) => {
                    places += 1;
                    if deviation > farthest.0 {
                        farthest = (deviation, &outcome.name, cell);
                    }
                }
                Look::Wrong => {
                    let what = format!(
                        "{} at {}: the mean of the estimates is {} where theory says {} ± {}",
                        outcome.name,
                        group.place(cell),
                        short(mean),
                        short(expected),
                        short(spread / root)
                    );
                    return Some((false, what));
                }
            }
        }
    }
    if places == 0 {
        return None;
    }
    let allowed = reach(sidak(confidence, places));
    let (deviation, name, cell) = farthest;
    let detail = format!(
        "of {places} places ({left_out} more are too near to zero to tell) the farthest is {} standard errors off, {name} at {}; chance allows {}",
        short(deviation),
        group.place(cell),
        short(allowed)
    );
    Some((deviation <= allowed, detail))
}

/// What one place says.
#[derive(Debug, PartialEq)]
enum Look {
    /// Nothing can differ there, and nothing does.
    Equal,
    /// Too near to zero: so few points may come that their mean is not to be taken as normal.
    Skew,
    /// So many standard errors lie between.
    Off(f64),
    /// A difference without spread, or no number at all.
    Wrong,
}

/// Judges a simulated mean, given the exact one and its standard error; below `rounding` a spread is none.
fn look((mean, expected, error): (f64, f64, f64), rounding: f64) -> Look {
    if ![mean, expected, error].iter().all(|v| v.is_finite()) {
        return Look::Wrong;
    }
    let off = (mean - expected).abs();
    if error <= rounding {
        return if off <= rounding {
            Look::Equal
        } else {
            Look::Wrong
        };
    }
    // both, so that theory which is wrong about zero is not left out for saying zero
    if expected.abs().max(mean.abs()) < KNOWN * error {
        return Look::Skew;
    }
    Look::Off(off / error)
}

#[cfg(test)]
mod tests {
    use super::{Look, look};

    #[test]
    fn what_is_wrong_is_seen_and_what_is_not_known_is_left_out() {
        let at = |mean, expected, error| look((mean, expected, error), 1e-9);
        assert_eq!(at(1.0, 1.0, 0.0), Look::Equal);
        assert_eq!(at(1.0, 1.1, 0.0), Look::Wrong);
        assert_eq!(at(0.02, 0.01, 0.01), Look::Skew);
        assert!(matches!(at(1.0, 1.1, 0.01), Look::Off(z) if (z - 10.0).abs() < 1e-9));
        // theory that says nothing where simulation finds much
        assert!(matches!(at(5.0, 0.0, 0.01), Look::Off(z) if z > 400.0));
        for wrong in [f64::NAN, f64::INFINITY] {
            assert_eq!(at(wrong, 1.0, 0.1), Look::Wrong);
            assert_eq!(at(1.0, wrong, 0.1), Look::Wrong);
            assert_eq!(at(1.0, 1.0, wrong), Look::Wrong);
        }
    }
}
