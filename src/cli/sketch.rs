//! The picture of one estimate.

use super::estimate::Places;
use crate::report::figure::{Axis, Colours, Curves, HeatMaps, Map, Role, Series};
use crate::sample::Sample;

/// What is known beside the numbers.
pub struct Sketch<'a> {
    /// What the estimator is called.
    pub name: &'a str,
    /// The columns of the data, where they were named.
    pub columns: &'a [String],
    /// Whether the estimate is continuous.
    pub continuous: bool,
}

/// Drawing an estimate in `D` dimensions.
pub trait Draws<const D: usize> {
    /// The picture as an SVG document.
    fn draw(&self, sample: &Sample<D>, places: &Places<D>, values: &[f64]) -> String;
}

impl Sketch<'_> {
    fn axis(&self, axis: usize) -> Axis {
        let name = self.columns.get(axis).map(String::as_str);
        Axis::new(name.unwrap_or(["x", "y"][axis]), "")
    }

    fn description(points: usize) -> String {
        format!("The estimated density of {points} points.")
    }
}

/// The estimate over its data.
impl Draws<1> for Sketch<'_> {
    fn draw(&self, sample: &Sample<1>, places: &Places<1>, values: &[f64]) -> String {
        // more ticks than this are a grey bar at any size
        const TICKS: usize = 100_000;
        let mut curve: Vec<(f64, f64)> = places
            .targets()
            .places()
            .map(|[x]| x)
            .zip(values.iter().copied())
            .collect();
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut x, y): (Vec<f64>, Vec<f64>) = curve.into_iter().unzip();
        let role = match places {
            Places::Grid(grid) if !self.continuous => {
                x = (0..=grid.len())
                    .map(|i| (i as f64).mul_add(grid.width(0), grid.low()[0]))
                    .collect();
                Role::Steps(0)
            }
            _ => Role::Estimate(0),
        };
        Curves {
            title: self.name.to_owned(),
            description: Self::description(sample.len()),
            x: self.axis(0),
            y: Axis::new("density", ""),
            series: vec![Series {
                name: "estimate".to_owned(),
                x,
                y,
                role,
            }],
            rug: sample
                .coordinates()
                .iter()
                .step_by(sample.len().div_ceil(TICKS))
                .copied()
                .collect(),
            ..Curves::default()
        }
        .draw()
        .to_string()
    }
}

/// The estimate as a map with level lines; scattered places make none.
impl Draws<2> for Sketch<'_> {
    fn draw(&self, sample: &Sample<2>, places: &Places<2>, values: &[f64]) -> String {
        let mut figure = HeatMaps {
            title: self.name.to_owned(),
            description: Self::description(sample.len()),
            x: self.axis(0),
            y: self.axis(1),
            high: [1.0; 2],
            label: "density".to_owned(),
            colours: Colours::Amount,
            levels: self.continuous,
            columns: 1,
            ..HeatMaps::default()
        };
        if let Places::Grid(grid) = places {
            (figure.low, figure.high) = (grid.low(), grid.high());
            figure.cells = grid.cells();
            figure.maps = vec![Map {
                values: values.to_vec(),
                ..Map::default()
            }];
        }
        figure.draw().to_string()
    }
}
