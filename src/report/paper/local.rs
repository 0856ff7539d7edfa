//! The figure of the best bandwidth at each place.

use super::Material;
use super::pictures::place_axis;
use crate::experiment::Figure;
use crate::experiment::results::Group;
use crate::kernel::{Shape, Symmetry};
use crate::report::figure::{Axis, Curves, Role, Series, Svg};
use crate::theory::Family;
use rayon::prelude::*;

/// Places along the line.
const PLACES: usize = 361;

/// The bandwidth of least mean squared error at each place, the same by leading terms, which runs off where the curvature vanishes, and the best for all places.
pub(super) fn draw(material: &Material<'_>, figure: &Figure, group: &Group, kernel: &str) -> Svg {
    let shape = Shape::named(kernel).unwrap_or(Shape::Gaussian);
    let (low, high) = (group.grid.low()[0], group.grid.high()[0]);
    let x: Vec<f64> = (0..PLACES)
        .map(|i| low + (high - low) * i as f64 / (PLACES - 1) as f64)
        .collect();
    let truth = material.bench.truth(group.source);
    let local: Vec<Option<(f64, f64)>> = x
        .par_iter()
        .map(|x| {
            let truth = truth?;
            (truth.at([*x]) > 0.0)
                .then(|| Family::Kernel(shape).best_at(&**truth, group.draws as f64, [*x]))
                .flatten()
                .map(|local| (local.at, local.asymptotic))
        })
        .collect();
    let global = material
        .bench
        .oracle(group.source, (shape, Symmetry::Product), group.draws)
        .map(|oracle| oracle.optimum.at);
    let most = 4.0 * global.unwrap_or(1.0);
    let curve = |name: &str, value: &dyn Fn(usize) -> Option<f64>, role: Role| {
        let (x, y) = (0..PLACES)
            // what runs off is cut well above the frame
            .filter_map(|i| Some((x[i], value(i)?.min(3.0 * most))))
            .unzip();
        Series {
            name: name.to_owned(),
            x,
            y,
            role,
        }
    };
    Curves {
        title: String::new(),
        description: figure.caption.clone(),
        x: place_axis(material, group),
        y: Axis::new("bandwidth h", "").over(0.0, most),
        series: vec![
            curve(
                "best at each place",
                &|i| local[i].map(|l| l.0),
                Role::Estimate(0),
            ),
            curve(
                "by leading terms",
                &|i| local[i].map(|l| l.1),
                Role::Estimate(1),
            ),
            curve("best for all places", &|_| global, Role::Estimate(2)),
        ],
        ..Curves::default()
    }
    .draw()
}
