//! Even data between walls, and data on a slope: what an estimator makes of them is what it makes of every density that is flat or linear there.

use super::data::Data;
use super::law::{fit, values};
use super::subject::Subject;
use density_lab::experiment::settings::WINDOW;
use density_lab::random::{open_unit, stream};
use density_lab::sample::{Sample, Weights};
use density_lab::space::{Domain, Point};

/// Rules that search, or that a truth answers, say nothing of even data; those of one formula do.
pub fn applies<const D: usize>(subject: &Subject<D>) -> bool {
    let by_formula = ["silverman", "normal-reference", "scott"];
    let chosen = subject.name.contains("Word") && {
        let smoothing = [
            "bandwidth = Word(",
            "width = Word(",
            "pilot = Word(",
            "terms = Word(",
        ];
        smoothing.iter().any(|start| {
            subject.name.split(start).skip(1).any(|rest| {
                !by_formula
                    .iter()
                    .any(|rule| rest.starts_with(&format!("\"{rule}\"")))
            })
        })
    };
    !subject.searched && !chosen
}

/// How finely points are spread.
#[derive(Clone, Copy)]
struct Fineness {
    /// Points on each axis.
    count: usize,
    /// What their discreteness may do, relative to the flat density.
    tolerance: f64,
}

impl Fineness {
    /// Few points, for what is far from right; some estimators take the square of their number.
    fn rough(dimensions: usize) -> Self {
        let (count, tolerance) = if dimensions == 1 {
            (400, 0.1)
        } else {
            (40, 0.2)
        };
        Self { count, tolerance }
    }

    /// Less than half of the planted fault.
    fn fine(dimensions: usize) -> Self {
        let (count, tolerance) = if dimensions == 1 {
            (8_000, 5e-3)
        } else {
            (240, 1.5e-2)
        };
        Self { count, tolerance }
    }

    /// What decides where that leaves doubt: steep polynomials feel how few the points at the ends are, and weak tapers do little.
    fn finest(dimensions: usize) -> Self {
        let (count, tolerance) = if dimensions == 1 {
            (30_000, 2e-3)
        } else {
            (640, 5e-3)
        };
        Self { count, tolerance }
    }
}

/// A point in each cell of a grid over the window: in the middle, or anywhere in it.
///
/// Points in the middle are a good rule for smooth kernels and a bad one for windows, which rows of points at equal distance enter and leave all at once; points anywhere
/// are a fair rule for all. What is a bias of the estimator is one with both.
fn even<const D: usize>(n: usize, anywhere: bool) -> Vec<Point<D>> {
    let mut random = stream(1, "even", D as u64);
    let width = (WINDOW[1] - WINDOW[0]) / n as f64;
    (0..n.pow(D as u32))
        .map(|cell| {
            std::array::from_fn(|axis| {
                let along = cell / n.pow(axis as u32) % n;
                let place = if anywhere {
                    open_unit(&mut random)
                } else {
                    0.5
                };
                WINDOW[0] + (along as f64 + place) * width
            })
        })
        .collect()
}

/// A sample of density `shape` (of mean 1, at places from -1 to 1 across the window), and the first place where its estimate is something else.
fn bias<const D: usize>(
    subject: &Subject<D>,
    shape: Option<fn(&[f64]) -> f64>,
    fineness: Fineness,
    anywhere: bool,
) -> Option<String> {
    let domain = Domain::walled([WINDOW[0]; D], [WINDOW[1]; D]).unwrap();
    let points = even::<D>(fineness.count, anywhere);
    let across =
        |x: &Point<D>| x.map(|x| (2.0 * x - WINDOW[0] - WINDOW[1]) / (WINDOW[1] - WINDOW[0]));
    let each = 1.0 / points.len() as f64;
    let weights = match shape {
        None => Weights::Equal(each),
        Some(shape) => Weights::Each(points.iter().map(|x| each * shape(&across(x))).collect()),
    };
    let sample = Sample::new(points, weights, domain.clone()).unwrap();
    let estimate = fit!(subject.plain(), &sample);
    let steps: usize = if D == 1 { 32 } else { 6 };
    let targets: Vec<Point<D>> = (0..(steps + 1).pow(D as u32))
        .map(|number| {
            std::array::from_fn(|axis| {
                let along = number / (steps + 1).pow(axis as u32) % (steps + 1);
                let share = along as f64 / steps as f64;
                // the ends exactly
                (1.0 - share) * WINDOW[0] + share * WINDOW[1]
            })
        })
        .collect();
    let flat = 1.0 / domain.measure();
    targets
        .iter()
        .zip(values(&estimate, &targets))
        .find_map(|(x, value)| {
            let truth = shape.map_or(1.0, |shape| shape(&across(x)));
            let close = (value / flat - truth).abs() <= fineness.tolerance;
            (!close).then(|| format!("{} instead of {truth} at {x:?}", value / flat))
        })
}

/// A bias with points in the middle of cells and with points anywhere in them, which more points do not mend; of who promises nothing the first that shows will do.
fn certain<const D: usize>(
    subject: &Subject<D>,
    shape: Option<fn(&[f64]) -> f64>,
    promised: bool,
) -> Option<String> {
    let both = |fineness: Fineness| {
        let middle = bias(subject, shape, fineness, false)?;
        let anywhere = bias(subject, shape, fineness, true)?;
        Some(format!("{middle}; {anywhere}"))
    };
    if promised {
        both(Fineness::fine(D))?;
        return both(Fineness::finest(D));
    }
    both(Fineness::rough(D))
        .or_else(|| both(Fineness::fine(D)))
        .or_else(|| both(Fineness::finest(D)))
}

pub fn constants<const D: usize>(subject: &Subject<D>, _: &Data<D>) -> Option<String> {
    certain(subject, None, subject.plain().laws().reproduces_constants)
}

pub fn lines<const D: usize>(subject: &Subject<D>, _: &Data<D>) -> Option<String> {
    certain(
        subject,
        Some(|u| match u {
            [u] => 1.0 + 0.9 * u,
            [u, v, ..] => 1.0 + 0.9 * u - 0.08 * v,
            [] => 1.0,
        }),
        subject.plain().laws().reproduces_linear,
    )
}
