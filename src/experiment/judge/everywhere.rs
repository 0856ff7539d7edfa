//! Claims that theory is right place by place.

use super::short;
use crate::accuracy::{reach, sidak};
use crate::experiment::results::{Group, Outcome};

/// How many standard errors of its mean an estimate must be above zero for that mean to be taken as normal: where fewer points come, their number is skew.
const KNOWN: f64 = 25.0;

/// What rounding may do to a mean without spread, relative to the greatest.
const ROUNDING: f64 = 1e-9;

/// Whether the means over replicates are the exact ones, in units of their exact standard errors, at all places of all estimators at once.
///
/// Places that nearly no sample reaches are left out and counted; where no sample can make a difference the means must be equal but for rounding.
pub(super) fn everywhere<const D: usize>(
    group: &Group<D>,
    of: &[String],
    confidence: f64,
) -> Option<(bool, String)> {
    let chosen: Vec<&Outcome> = group
        .outcomes
        .iter()
        .filter(|o| of.is_empty() || of.contains(&o.name))
        .collect();
    let truth = group.truth.as_ref()?;
    let (mut places, mut left_out) = (0, 0);
    // deviation in standard errors, estimator, cell
    let mut farthest = (0.0, "", 0);
    for outcome in &chosen {
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
            let off = (mean - expected).abs();
            if spread <= ROUNDING * peak {
                if off > ROUNDING * peak {
                    let place = place(group, cell);
                    let (name, mean) = (&outcome.name, short(mean));
                    let what = format!("{name} at {place}: {mean} without spread");
                    return Some((false, format!("{what}, not {}", short(expected))));
                }
                continue;
            }
            let error = spread / root;
            if expected.abs() < KNOWN * error {
                left_out += 1;
                continue;
            }
            places += 1;
            if off / error > farthest.0 {
                farthest = (off / error, &outcome.name, cell);
            }
        }
    }
    if places == 0 {
        return None;
    }
    let allowed = reach(sidak(confidence, places));
    let (deviation, name, cell) = farthest;
    let detail = format!(
        "of {places} places ({left_out} more that too few points reach) the farthest is {} standard errors off, {name} at {}; chance allows {}",
        short(deviation),
        place(group, cell),
        short(allowed)
    );
    Some((deviation <= allowed, detail))
}

/// The centre of a cell in words.
fn place<const D: usize>(group: &Group<D>, cell: usize) -> String {
    // a millionth of a cell is rounding
    let unit = 1e-6 * group.grid.width(0);
    let place = group.grid.centre(cell);
    place
        .map(|x| short((x / unit).round() * unit + 0.0))
        .join(", ")
}
