//! Searching for the least value of a criterion whose shape is not known.

use crate::numeric::{Minimum, minimise};
use crate::space::Warning;

/// What a search over a ladder of bandwidths found.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Found {
    /// The local minima, from the widest bandwidth to the narrowest.
    pub minima: Vec<Minimum>,
    /// The value at the narrow end.
    pub end: f64,
}

/// Places on the ladder to a factor of ten.
const STEPS: f64 = 20.0;

/// How far below the best minimum so far the ladder goes on: there the variance alone is many times the whole error at the best.
const BELOW: f64 = 0.1;

/// Looks for the local minima of `glance` on a ladder from `high` down, and finds their exact places with `exact`. The ladder ends at a tenth of the best minimum, or
/// at `low` if there is none.
pub(super) fn search(
    glance: impl Fn(f64) -> f64,
    exact: impl Fn(f64) -> f64,
    low: f64,
    high: f64,
) -> Found {
    let ratio = 10_f64.powf(-1.0 / STEPS);
    let (mut wider, mut wide) = ((f64::NAN, f64::NAN), (high, glance(high)));
    let mut minima: Vec<Minimum> = Vec::new();
    let mut best = f64::INFINITY;
    let mut stop = low;
    while wide.0 > stop {
        let h = wide.0 * ratio;
        let value = glance(h);
        if wide.1 < wider.1 && wide.1 <= value {
            let found = minimise(&exact, h, wider.0, 1e-9);
            if found.value < best {
                best = found.value;
                stop = (BELOW * found.at).max(low);
            }
            minima.push(found);
        }
        (wider, wide) = (wide, (h, value));
    }
    Found {
        minima,
        end: wide.1,
    }
}

impl Found {
    /// The same with the places in another unit.
    pub fn in_units_of(mut self, unit: f64) -> Self {
        for minimum in &mut self.minima {
            minimum.at *= unit;
        }
        self
    }

    /// The lowest minimum. Where the criterion falls below it at the narrow end, which on rounded data it does without bound, the widest
    /// one \[Hall & Marron 1991\]; `what` is the name of the criterion in warnings.
    pub fn choose(&self, what: &str) -> Option<(f64, Vec<Warning>)> {
        let lowest = self
            .minima
            .iter()
            .copied()
            .min_by(|a, b| a.value.total_cmp(&b.value))?;
        let mut warnings = Vec::new();
        let chosen = if self.end < lowest.value {
            warnings.push(Warning {
                what: format!(
                    "{what} falls below its minima towards bandwidth 0, as it does without bound on tied or rounded data; the widest local minimum is taken"
                ),
                hint: "look at the data for rounding, and compare with sheather-jones".to_owned(),
            });
            self.minima[0]
        } else {
            lowest
        };
        let others: Vec<String> = self
            .minima
            .iter()
            .filter(|other| (other.at / chosen.at - 1.0).abs() > 1e-6)
            .map(|other| format!("{:.4e}", other.at))
            .collect();
        if !others.is_empty() {
            warnings.push(Warning {
                what: format!("{what} has other local minima, at {}", others.join(", ")),
                hint: "structure at more than one scale: compare the estimates at both".to_owned(),
            });
        }
        Some((chosen.at, warnings))
    }
}

/// The least value between `low` and `high`, ends included: the best of a ladder of `glance`, its place found with `exact`. Says whether it is at an end.
pub(super) fn least(
    glance: impl Fn(f64) -> f64,
    exact: impl Fn(f64) -> f64,
    low: f64,
    high: f64,
) -> (f64, bool) {
    const RUNGS: usize = 60;
    let ratio = (high / low).ln() / (RUNGS - 1) as f64;
    let rung = |i: usize| match i {
        0 => low,
        i if i == RUNGS - 1 => high,
        i => low * (ratio * i as f64).exp(),
    };
    let values: Vec<f64> = (0..RUNGS).map(|i| glance(rung(i))).collect();
    let best = (0..RUNGS)
        .min_by(|&a, &b| values[a].total_cmp(&values[b]))
        .unwrap_or(0);
    let found = minimise(
        &exact,
        rung(best.saturating_sub(1)),
        rung((best + 1).min(RUNGS - 1)),
        1e-9,
    );
    // a minimum that a search within the interval cannot tell from its end is at the end
    let near = 1e-6 * (high - low);
    let at_end = found.at - low < near || high - found.at < near;
    (found.at, at_end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_minima_are_found_and_the_lowest_taken() {
        let wells = |h: f64| (h.ln() - 0.1).powi(2) * (h.ln() + 1.2).powi(2) - 0.01 * h.ln();
        let found = search(wells, wells, 1e-4, 10.0);
        assert_eq!(found.minima.len(), 2, "{found:?}");
        let (h, warnings) = found.choose("it").expect("a minimum");
        assert!(
            (h.ln() - 0.1).abs() < 0.02 && warnings.len() == 1,
            "{h} {warnings:?}"
        );
        // one that falls for ever towards 0 beside a shallow minimum
        let falls = |h: f64| (h.ln() - 0.5).powi(2) - 0.3 / h.powi(2);
        let (h, warnings) = search(falls, falls, 1e-4, 10.0).choose("it").expect("one");
        assert!((h.ln() - 0.5).abs() < 0.2 && warnings[0].what.contains("without bound"));
        assert!(search(|h| h, |h| h, 1e-4, 10.0).choose("it").is_none());
    }

    #[test]
    fn the_ends_of_an_interval_count() {
        assert!(least(|h| h, |h| h, 1.0, 2.0).1);
        assert!(least(|h| -h, |h| -h, 1.0, 2.0).1);
        let well = |h: f64| (h - 1.3).powi(2);
        let (at, end) = least(well, well, 1.0, 2.0);
        assert!((at - 1.3).abs() < 1e-7 && !end);
    }
}
