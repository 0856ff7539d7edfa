//! How often each estimator shows how many modes.

use super::Svg;
use super::canvas::{Canvas, Hang, MARGIN, Type};
use super::curves::WIDTH;
use super::style::{self, Stroke};
use crate::report::text::{fit, fixed, width};

/// The mode counts of one estimator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModeCounts {
    /// Its name.
    pub name: String,
    /// Picks its colour.
    pub colour: usize,
    /// `replicates[m]` replicates showed `m` modes.
    pub replicates: Vec<u64>,
}

/// A small bar chart per estimator, one under the other, over the number of modes.
#[derive(Clone, Debug, Default)]
pub struct Modes {
    /// Printed at the top; may be empty.
    pub title: String,
    /// What the figure shows, for those who do not see it.
    pub description: String,
    /// How many modes the truth has.
    pub truth: Option<usize>,
    /// The estimators, top down.
    pub rows: Vec<ModeCounts>,
}

/// Mode counts from this one on share a column.
const MOST: usize = 15;
const BAND: f64 = 46.0;
const BAR: f64 = 26.0;

impl Modes {
    /// The figure.
    pub fn draw(&self) -> Svg {
        let seen = |row: &ModeCounts| {
            row.replicates
                .iter()
                .rposition(|&count| count > 0)
                .unwrap_or(1)
        };
        let highest = self
            .rows
            .iter()
            .map(seen)
            .chain(self.truth)
            .max()
            .unwrap_or(1)
            .max(3);
        let pooled = highest > MOST;
        let last = highest.min(MOST);
        let first = usize::from(
            self.rows
                .iter()
                .all(|row| row.replicates.first().is_none_or(|&count| count == 0)),
        );
        let columns = (last - first + 1) as f64;
        let names = self
            .rows
            .iter()
            .map(|row| width(&row.name, style::LABEL))
            .fold(0.0, f64::max)
            .min(200.0);
        let left = MARGIN + names + 14.0;
        let pitch = ((WIDTH - left - MARGIN) / columns).min(84.0);
        let right = left + pitch * columns;

        let heading = Canvas::new(WIDTH, 1.0).title(&self.title, WIDTH - 2.0 * MARGIN);
        let top = heading + if self.truth.is_some() { 20.0 } else { 6.0 };
        let bottom = top + BAND * self.rows.len().max(1) as f64;
        let canvas = Canvas::new(WIDTH, bottom + 42.0);
        canvas.title(&self.title, WIDTH - 2.0 * MARGIN);
        let muted = Type::new(style::TICK, style::MUTED, Hang::Middle);
        let middle = |column: usize| left + pitch * ((column - first) as f64 + 0.5);
        if let Some(truth) = self.truth {
            let x = middle(truth.clamp(first, last));
            canvas.rectangle(
                (x - 0.5 * pitch, top),
                (x + 0.5 * pitch, bottom),
                style::INK,
                0.06,
            );
            canvas.text(
                (x, top - 9.0),
                "truth",
                Type::new(style::TICK, style::INK, Hang::Middle),
            );
        }
        for (index, row) in self.rows.iter().enumerate() {
            let base = top + BAND * (index as f64 + 1.0) - 4.0;
            let right_hung = Type::new(style::LABEL, style::INK, Hang::Right);
            canvas.text(
                (left - 12.0, base - 0.36 * BAR),
                &fit(&row.name, style::LABEL, names),
                right_hung,
            );
            canvas.line(
                &[(left, base), (right, base)],
                Stroke::new(style::GRID, 0.75),
            );
            let total = row.replicates.iter().sum::<u64>();
            for column in first..=last {
                let count: u64 = if column == MOST && pooled {
                    row.replicates.iter().skip(column).sum()
                } else {
                    row.replicates.get(column).copied().unwrap_or(0)
                };
                if count == 0 {
                    continue;
                }
                let share = count as f64 / total as f64;
                let (x, half) = (middle(column), (0.32 * pitch).min(20.0));
                canvas.rectangle(
                    (x - half, base - BAR * share),
                    (x + half, base),
                    style::colour(row.colour),
                    0.75,
                );
                canvas.text((x, base - BAR * share - 6.5), &percent(share), muted);
            }
        }
        for column in first..=last {
            let label = if column == MOST && pooled {
                format!("≥ {MOST}")
            } else {
                column.to_string()
            };
            canvas.text((middle(column), bottom + 9.0), &label, muted);
        }
        canvas.text(
            (0.5 * (left + right), bottom + 28.0),
            "number of modes",
            Type::new(style::LABEL, style::INK, Hang::Middle),
        );
        canvas.finish(&self.title, &self.description)
    }
}

/// A share without pretending that some is none or most is all.
fn percent(share: f64) -> String {
    if share < 0.01 {
        "<1\u{202f}%".into()
    } else if share > 0.99 && share < 1.0 {
        ">99\u{202f}%".into()
    } else {
        format!("{}\u{202f}%", fixed(100.0 * share, 0))
    }
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn shares_do_not_round_to_none_or_all() {
        assert_eq!(percent(0.001), "<1\u{202f}%");
        assert_eq!(percent(0.999), ">99\u{202f}%");
        assert_eq!(percent(1.0), "100\u{202f}%");
        assert_eq!(percent(0.634), "63\u{202f}%");
    }
}
