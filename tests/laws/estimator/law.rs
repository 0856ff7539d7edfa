//! The laws by name, and what they are judged with.

use super::data::{Data, Sort, Walls, span};
use super::subject::Subject;
use super::{promised, reproduction, universal};
use density_lab::estimator::{Estimate, Laws};
use density_lab::kernel::Bandwidth;
use density_lab::space::{Field, Point, Targets};

/// One law.
pub struct Law<const D: usize> {
    pub name: &'static str,
    /// Where it is promised; `None` for what holds without saying.
    pub promise: Option<fn(&Laws) -> bool>,
    /// What is wrong on these data, if anything.
    pub breach: fn(&Subject<D>, &Data<D>) -> Option<String>,
    pub data: Sort,
    pub walls: Walls,
    pub cases: u32,
    /// On whom it can be tried.
    pub applies: fn(&Subject<D>) -> bool,
}

/// All of them. Cases are few, since each is tried on hundreds of settings.
#[expect(clippy::too_many_lines, reason = "a list")]
pub fn all<const D: usize>() -> Vec<Law<D>> {
    macro_rules! law {
        ($name:literal, $promise:expr, $breach:expr, $data:ident, $walls:ident, $cases:literal) => {
            Law {
                name: $name,
                promise: $promise,
                breach: $breach,
                data: Sort::$data,
                walls: Walls::$walls,
                cases: $cases,
                applies: |_| true,
            }
        };
    }
    let all: Vec<Law<D>> = vec![
        law!(
            "mass",
            Some(|laws| laws.mass_conserving),
            promised::mass,
            Any,
            Boxes,
            6
        ),
        law!(
            "sign",
            Some(|laws| laws.non_negative),
            promised::sign,
            Any,
            Polygons,
            8
        ),
        law!(
            "union",
            Some(|laws| laws.linear),
            promised::union,
            General,
            Polygons,
            6
        ),
        law!(
            "continuity",
            Some(|laws| laws.continuous),
            promised::continuity,
            General,
            Boxes,
            4
        ),
        law!(
            "determinism",
            Some(|laws| laws.deterministic),
            promised::determinism,
            Any,
            Polygons,
            4
        ),
        law!(
            "scale",
            Some(|laws| laws.scale_equivariant),
            promised::scale,
            General,
            Polygons,
            8
        ),
        law!(
            "translation",
            Some(|laws| laws.translation_equivariant),
            promised::translation,
            General,
            Polygons,
            8
        ),
        law!(
            "repetition",
            Some(|laws| laws.repeatable),
            promised::repetition,
            General,
            Polygons,
            6
        ),
        Law {
            applies: reproduction::applies,
            ..law!(
                "constants",
                Some(|laws| laws.reproduces_constants),
                reproduction::constants,
                OnePlace,
                None,
                1
            )
        },
        Law {
            applies: reproduction::applies,
            ..law!(
                "lines",
                Some(|laws| laws.reproduces_linear),
                reproduction::lines,
                OnePlace,
                None,
                1
            )
        },
        law!("order", None, universal::order, Any, Polygons, 6),
        law!(
            "zero weights",
            None,
            universal::zero_weights,
            General,
            Polygons,
            6
        ),
        law!(
            "weight unit",
            None,
            universal::weight_unit,
            Any,
            Polygons,
            6
        ),
        law!("channels", None, universal::channels, General, Polygons, 5),
        law!("one place", None, universal::one_place, OnePlace, None, 8),
        law!(
            "many targets",
            None,
            universal::many_targets,
            Any,
            Polygons,
            6
        ),
        law!(
            "far targets",
            None,
            universal::far_targets,
            General,
            None,
            3
        ),
    ];
    all
}

/// What rounding may do to values, relative to the greatest among them.
const ROUNDING: f64 = 1e-10;

/// The same in another unit or from another origin, where a width found by a search for a minimum is only good to √ε, and where the parts of a kernel inside
/// a polygon are differences.
pub fn rounding<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> f64 {
    if subject.searched {
        1e-6
    } else if data.domain.outline().is_some() {
        1e-8
    } else {
        ROUNDING
    }
}

/// Fits, or leaves the law: refusing is judged by "one place", not by each law again.
macro_rules! fit {
    ($estimator:expr, $sample:expr) => {
        match $estimator.fit($sample) {
            Ok(estimate) => estimate,
            Err(
                density_lab::estimator::FitError::Select(_)
                | density_lab::estimator::FitError::Degenerate(_),
            ) => return None,
            Err(error) => return Some(format!("refused: {error}")),
        }
    };
}
pub(super) use fit;

pub fn values<const D: usize>(field: &(impl Field<D> + ?Sized), targets: &[Point<D>]) -> Vec<f64> {
    field.evaluate(Targets::Points(targets)).values
}

/// The first place where two estimates differ by more than `tolerance` times the greatest of all values.
pub fn difference<const D: usize>(
    tolerance: f64,
    targets: &[Point<D>],
    left: &[f64],
    right: &[f64],
) -> Option<String> {
    let peak = left
        .iter()
        .chain(right)
        .fold(0.0, |peak: f64, v| peak.max(v.abs()));
    targets
        .iter()
        .zip(left.iter().zip(right))
        .find_map(|(x, (a, b))| {
            // written so that NaN is a difference
            let close = (a - b).abs() <= tolerance * peak;
            (!close).then(|| format!("at {x:?}: {a} against {b}, peak {peak}"))
        })
}

/// The length over which the estimate changes: what the estimator says, else a quarter of the range of the data.
pub fn length<const D: usize>(
    subject: &Subject<D>,
    estimate: &Estimate<D>,
    points: &[Point<D>],
) -> f64 {
    if let Some(Bandwidth::Fixed(h)) = &estimate.bandwidth {
        return h.iter().copied().fold(f64::INFINITY, f64::min);
    }
    let (low, high) = span(points);
    estimate
        .smoothing
        .filter(|_| subject.by_length)
        .unwrap_or_else(|| if high > low { (high - low) / 4.0 } else { 1.0 })
}
