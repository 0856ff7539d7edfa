//! Criteria over what they choose, one panel each.

use crate::report::figure::{Axis, Multiples, Role, Series, Small};

/// One criterion.
pub(super) struct Panel<'a> {
    pub title: String,
    pub criterion: Box<dyn Fn(f64) -> f64 + 'a>,
    /// Its choice.
    pub own: Option<f64>,
}

/// All of them.
pub(super) struct Profile<'a> {
    pub title: String,
    pub description: String,
    /// What is chosen.
    pub axis: &'static str,
    /// Places at which each is drawn.
    pub places: u32,
    /// All choices: the axis reaches beyond them.
    pub widths: Vec<f64>,
    /// Choices marked in every panel, by name.
    pub others: Vec<(String, f64)>,
    pub panels: Vec<Panel<'a>>,
}

impl Profile<'_> {
    /// The picture as SVG.
    pub(super) fn draw(self) -> String {
        let (least, most) = self
            .widths
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(a, b), &h| (a.min(h), b.max(h)));
        let (low, high) = (least / 2.5, most * 2.0);
        let grid: Vec<f64> = (0..=self.places)
            .map(|i| low * (high / low).powf(f64::from(i) / f64::from(self.places)))
            .collect();
        let panel = |panel: &Panel<'_>| {
            let y: Vec<f64> = grid.iter().map(|&h| (panel.criterion)(h)).collect();
            let mut series = vec![Series {
                name: "criterion".to_owned(),
                x: grid.clone(),
                y: readable(&y),
                role: Role::Estimate(0),
            }];
            let (bottom, top) = ends(&series[0].y);
            let mark = |name: &str, h: f64, colour| Series {
                name: name.to_owned(),
                x: vec![h, h],
                y: vec![bottom, top],
                role: Role::Estimate(colour),
            };
            if let Some(h) = panel.own {
                series.push(mark("its choice", h, 1));
            }
            for (colour, (name, h)) in (2..).zip(&self.others) {
                series.push(mark(name, *h, colour));
            }
            Small {
                title: panel.title.clone(),
                series,
            }
        };
        Multiples {
            panels: self.panels.iter().map(panel).collect(),
            title: self.title,
            description: self.description,
            x: Axis::new(self.axis, "").logarithmic().over(low, high),
            y: Axis::new("criterion, above its least", ""),
            columns: 2,
            shared: false,
        }
        .draw()
        .to_string()
    }
}

/// How far each value is above the least, without the heights that would flatten the valley: what exceeds four times the median.
fn readable(y: &[f64]) -> Vec<f64> {
    let (bottom, _) = ends(y);
    let mut above: Vec<f64> = y.iter().map(|y| y - bottom).collect();
    let mut sorted: Vec<f64> = above.iter().copied().filter(|y| y.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let cut = 4.0
        * sorted
            .get(sorted.len() / 2)
            .copied()
            .unwrap_or(f64::INFINITY);
    for value in &mut above {
        if value.is_nan() || *value > cut {
            *value = f64::NAN;
        }
    }
    above
}

fn ends(y: &[f64]) -> (f64, f64) {
    y.iter()
        .filter(|y| y.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &y| {
            (a.min(y), b.max(y))
        })
}
