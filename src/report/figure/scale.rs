//! One axis: from values to places, and where its ticks go.

use super::style;
use crate::report::text::{decimals, exponent, fixed, power, width};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged};
use std::ops::Range;

/// A linear or logarithmic map of an interval onto [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    low: f64,
    high: f64,
    logarithmic: bool,
}

/// What an axis shows: labelled ticks, unlabelled ones, and what its title must add to them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    /// Value and label.
    pub major: Vec<(f64, String)>,
    /// Values with a short tick only.
    pub minor: Vec<f64>,
    /// Labels are multiples of ten to this power.
    pub power: i32,
    /// Labels are differences from this value.
    pub offset: f64,
    /// Digits after the point of that value.
    pub offset_digits: usize,
}

impl Scale {
    /// From `low` to `high`. Whatever the data were, the result is a proper interval: an empty or non-finite one becomes [0, 1],
    /// a point is widened.
    pub fn linear(low: f64, high: f64) -> Self {
        // Half the range of f64, so that the length of the interval is finite.
        let limit = 0.4 * f64::MAX;
        let (low, high) = (low.clamp(-limit, limit), high.clamp(-limit, limit));
        let (low, high) = match (low.is_nan() || high.is_nan(), low < high) {
            (true, _) => (0.0, 1.0),
            (_, true) => (low, high),
            _ => (low.min(high), low.max(high)),
        };
        let least = 1e-12 * low.abs().max(high.abs());
        if high - low > least {
            Self {
                low,
                high,
                logarithmic: false,
            }
        } else {
            let room = if low == 0.0 && high == 0.0 {
                1.0
            } else {
                0.1 * low.abs().max(high.abs())
            };
            Self {
                low: low - room,
                high: high + room,
                logarithmic: false,
            }
        }
    }

    /// From `low` to `high` in equal ratios; falls back to one decade about whatever is positive.
    pub fn logarithmic(low: f64, high: f64) -> Self {
        // Far enough from the ends of f64 that ratios and decades stay finite.
        let limit = |end: f64| (end > 0.0).then(|| end.clamp(1e-150, 1e150));
        let (low, high) = match (limit(low), limit(high)) {
            (Some(low), Some(high)) => (low.min(high), low.max(high)),
            (Some(end), None) | (None, Some(end)) => (end, end),
            (None, None) => (1.0, 10.0),
        };
        if high / low > 1.001 {
            Self {
                low,
                high,
                logarithmic: true,
            }
        } else {
            Self {
                low: low / 2.0,
                high: high * 2.0,
                logarithmic: true,
            }
        }
    }

    /// The least value that holds all finite `values` (all positive ones on a logarithmic scale) and leaves `margin` of its length
    /// free at both ends.
    pub fn holding(values: impl IntoIterator<Item = f64>, logarithmic: bool, margin: f64) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values {
            if value.is_finite() && (!logarithmic || value > 0.0) {
                low = low.min(value);
                high = high.max(value);
            }
        }
        if low > high {
            (low, high) = (f64::NAN, f64::NAN);
        }
        if logarithmic {
            let tight = Self::logarithmic(low, high);
            let room = (tight.high / tight.low).powf(margin);
            Self::logarithmic(tight.low / room, tight.high * room)
        } else {
            let tight = Self::linear(low, high);
            let room = margin * (tight.high - tight.low);
            Self::linear(tight.low - room, tight.high + room)
        }
    }

    /// The ends.
    pub fn ends(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// Whether equal steps are equal ratios.
    pub fn is_logarithmic(&self) -> bool {
        self.logarithmic
    }

    /// The place of `value`: 0 at the low end, 1 at the high end, beyond them outside; NaN or infinite where there is none.
    pub fn place(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// The value at a place: the inverse of [`Scale::place`].
    pub fn value(&self, place: f64) -> f64 {
        if self.logarithmic {
            self.low * (self.high / self.low).powf(place)
        } else {
            self.low + place * (self.high - self.low)
        }
    }

    /// Ticks for an axis of `length` pixels whose labels stand side by side (`across`) or above each other; no two labels touch.
    pub(super) fn ticks(&self, length: f64, across: bool) -> Ticks {
        let (spacing, least) = if across { (70.0, 5.0) } else { (48.0, 4.0) };
        let mut wanted = (length / spacing).floor().clamp(least, 10.0) as usize;
        loop {
            let ticks = if self.logarithmic {
                self.logarithmic_ticks(wanted)
            } else {
                self.linear_ticks(wanted)
            };
            if wanted <= 1 || !self.crowded(&ticks, length, across) {
                return ticks;
            }
            wanted -= 1;
        }
    }

    fn crowded(&self, ticks: &Ticks, length: f64, across: bool) -> bool {
        let extent = |label: &str| {
            if across {
                width(label, style::TICK) + 8.0
            } else {
                style::TICK + 3.0
            }
        };
        ticks.major.windows(2).any(|pair| {
            let gap = (self.place(pair[1].0) - self.place(pair[0].0)) * length;
            gap < 0.5 * (extent(&pair[0].1) + extent(&pair[1].1))
        })
    }

    /// Multiples of 1, 2 or 5 times a power of ten, at most `wanted` intervals.
    fn linear_ticks(&self, wanted: usize) -> Ticks {
        let span = self.high - self.low;
        let rough = span / wanted as f64;
        let decade = 10f64.powi(rough.log10().floor() as i32);
        let mut step = [1.0, 2.0, 5.0, 10.0]
            .map(|m| m * decade)
            .into_iter()
            .find(|step| *step >= rough * (1.0 - 1e-9))
            .unwrap_or(10.0 * decade);
        if !(step.is_finite() && step > 0.0) {
            step = span;
        }
        let largest = self.low.abs().max(self.high.abs());
        // Far from zero the labels would all begin with the same digits: say those once, in the title.
        let offset = if span < 1e-4 * largest {
            (self.low / (100.0 * step)).round() * 100.0 * step
        } else {
            0.0
        };
        let largest = if offset == 0.0 {
            largest
        } else {
            (self.low - offset).abs().max((self.high - offset).abs())
        };
        let size = exponent(largest, 3);
        let power = if (-3..5).contains(&size) { 0 } else { size };
        let unit = 10f64.powi(power);
        let digits = decimals(exponent(step / unit, 1), 1);
        let first = ((self.low - offset) / step - 1e-9).ceil();
        let last = ((self.high - offset) / step + 1e-9).floor();
        let count = (last - first).clamp(0.0, 1000.0) as usize;
        let major = (0..=count)
            .map(|index| (first + index as f64) * step)
            .filter(|value| value.is_finite())
            .map(|value| (value + offset, fixed(value / unit, digits)))
            .collect();
        let offset_digits = decimals(exponent(100.0 * step, 1), 1);
        Ticks {
            major,
            minor: Vec::new(),
            power,
            offset,
            offset_digits,
        }
    }

    /// Decades; where they are few, their multiples by 2 and 5 or by 1 to 9; within a factor of about two, linear ticks.
    fn logarithmic_ticks(&self, wanted: usize) -> Ticks {
        let inside = |value: &f64| (-1e-9..=1.0 + 1e-9).contains(&self.place(*value));
        let (first, last) = (
            self.low.log10().floor() as i32,
            self.high.log10().ceil() as i32,
        );
        let multiples = |of: &[f64]| -> Vec<f64> {
            (first..=last)
                .flat_map(|k| {
                    of.iter()
                        .map(move |m| format!("{m}e{k}").parse().unwrap_or(f64::NAN))
                })
                .filter(inside)
                .collect()
        };
        let nine = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
        let decades = multiples(&[1.0]);
        let minor = if decades.len() <= 12 {
            multiples(&nine)
        } else {
            Vec::new()
        };
        let sets: [&[f64]; 4] = [&nine, &[1.0, 2.0, 5.0], &[1.0, 3.0], &[1.0]];
        let chosen = sets[if decades.len() < 4 { 0 } else { 3 }..]
            .iter()
            .map(|of| multiples(of))
            .find(|values| values.len() <= wanted + 1)
            .unwrap_or_else(|| {
                decades
                    .iter()
                    .copied()
                    .step_by(decades.len().div_ceil(wanted.max(1)))
                    .collect()
            });
        if chosen.len() < 2 && self.high / self.low < 10.0 {
            let linear = Self {
                logarithmic: false,
                ..*self
            }
            .linear_ticks(wanted);
            return Ticks { minor, ..linear };
        }
        let plain = chosen
            .iter()
            .all(|value| (0.000_999..10_000.5).contains(value));
        let label = |value: f64| {
            let size = exponent(value, 1);
            if plain {
                return fixed(value, decimals(size, 1));
            }
            let multiple = (value / 10f64.powi(size)).round();
            if (multiple - 1.0).abs() < 0.5 {
                power(size)
            } else {
                format!("{multiple}×{}", power(size))
            }
        };
        Ticks {
            major: chosen
                .into_iter()
                .map(|value| (value, label(value)))
                .collect(),
            minor,
            power: 0,
            offset: 0.0,
            offset_digits: 0,
        }
    }
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        // Data are clipped before; this only keeps the cast from overflowing.
        let place = self.place(*value).clamp(-1.0, 2.0);
        limit.0 + (place * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let wanted = hint.max_num_points().max(1);
        let ticks = if self.logarithmic {
            self.logarithmic_ticks(wanted)
        } else {
            self.linear_ticks(wanted)
        };
        ticks.major.into_iter().map(|(value, _)| value).collect()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    fn labels(ticks: &Ticks) -> Vec<&str> {
        ticks
            .major
            .iter()
            .map(|(_, label)| label.as_str())
            .collect()
    }

    #[test]
    fn linear_ticks_are_round_numbers() {
        assert_eq!(
            labels(&Scale::linear(-3.0, 3.0).ticks(500.0, true)),
            ["\u{2212}3", "\u{2212}2", "\u{2212}1", "0", "1", "2", "3"]
        );
        assert_eq!(
            labels(&Scale::linear(0.0, 0.31).ticks(250.0, false)),
            ["0.0", "0.1", "0.2", "0.3"]
        );
        let small = Scale::linear(0.0, 4e-5).ticks(200.0, false);
        assert_eq!(
            (small.power, labels(&small)),
            (-5, vec!["0", "1", "2", "3", "4"])
        );
        let far = Scale::linear(1e9 + 1.0, 1e9 + 5.0).ticks(400.0, true);
        assert_eq!(
            (far.offset, labels(&far)),
            (1e9, vec!["1", "2", "3", "4", "5"])
        );
    }

    #[test]
    fn logarithmic_ticks_suit_the_number_of_decades() {
        assert_eq!(
            labels(&Scale::logarithmic(1e-6, 2e-1).ticks(300.0, false)),
            ["10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹"]
        );
        assert_eq!(
            labels(&Scale::logarithmic(0.02, 2.1).ticks(600.0, true)),
            ["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2"]
        );
        assert_eq!(
            labels(&Scale::logarithmic(1.4e-5, 9e-5).ticks(130.0, false)),
            ["2×10⁻⁵", "5×10⁻⁵"]
        );
        assert!(Scale::logarithmic(2.2, 2.8).ticks(300.0, true).major.len() >= 2);
        assert_eq!(
            Scale::logarithmic(1.0, 1e6).ticks(300.0, true).minor.len(),
            55
        );
    }

    #[test]
    fn labels_never_touch_whatever_the_range() {
        let mut ranges = vec![
            (0.0, 0.0),
            (f64::NAN, 1.0),
            (-1e300, 1e300),
            (5.0, 5.0),
            (1e-320, 2e-320),
            (-f64::MAX, f64::MAX),
            (1e15, 1e15 + 2.0),
        ];
        for exponent in -20..20 {
            for mantissa in [1.0, 1.1, 3.0, 9.7] {
                let high = mantissa * 10f64.powi(exponent);
                ranges.extend([
                    (0.0, high),
                    (-high, 0.3 * high),
                    (0.97 * high, high),
                    (1e-7 * high, high),
                    (-123.4, high),
                ]);
            }
        }
        for (low, high) in ranges {
            for scale in [Scale::linear(low, high), Scale::logarithmic(low, high)] {
                for (length, across) in
                    [(120.0, true), (640.0, true), (80.0, false), (300.0, false)]
                {
                    let ticks = scale.ticks(length, across);
                    assert!(ticks.major.len() < 30, "{scale:?}");
                    assert!(
                        ticks.major.len() <= 1 || !scale.crowded(&ticks, length, across),
                        "{scale:?} {length} {ticks:?}"
                    );
                    for (value, label) in &ticks.major {
                        assert!(
                            (-1e-6..=1.000_001).contains(&scale.place(*value)),
                            "{scale:?} {value}"
                        );
                        assert!(label.chars().count() < 16, "{scale:?} {label}");
                    }
                }
            }
        }
    }

    #[test]
    fn places_and_values_are_inverse() {
        for scale in [Scale::linear(-2.0, 7.0), Scale::logarithmic(1e-3, 50.0)] {
            for value in [0.002, 0.5, 3.0, 6.9] {
                assert!((scale.value(scale.place(value)) - value).abs() < 1e-12);
            }
            assert_eq!(scale.place(scale.ends().0), 0.0);
            assert!((scale.place(scale.ends().1) - 1.0).abs() < 1e-15);
        }
    }
}
