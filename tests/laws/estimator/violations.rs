//! Every planted violation, with the law that must catch it.

use super::planted::{
    Spoilt, boastful, good, histogram, kernel, modest, plant, sample_spoilt, silverman,
    values_spoilt,
};
use super::subject::Subject;
use density_lab::experiment::catalogue::{Builds, Entry};
use density_lab::experiment::settings::WINDOW;
use density_lab::sample::Sample;
use density_lab::space::Point;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// exp(-|z - centre|²/2) with the centre on the first axis.
fn bump<const D: usize>(x: Point<D>, centre: f64, width: f64) -> f64 {
    let squares: f64 = (0..D)
        .map(|axis| ((x[axis] - if axis == 0 { centre } else { 0.0 }) / width).powi(2))
        .sum();
    (-0.5 * squares).exp()
}

/// Every planted violation with the name of the law that must catch it.
pub fn all<const D: usize>() -> Vec<(Subject<D>, &'static str)>
where
    Entry: Builds<D>,
{
    [broken(), universal(), forgotten()]
        .into_iter()
        .flatten()
        .collect()
}

/// Promises that are not kept.
#[expect(clippy::too_many_lines, reason = "a list")]
fn broken<const D: usize>() -> Vec<(Subject<D>, &'static str)>
where
    Entry: Builds<D>,
{
    static COUNTER: AtomicU32 = AtomicU32::new(0);
    // integrals over jumps are less exact in the plane
    let small = if D == 1 { 0.01 } else { 0.04 };
    vec![
        (
            values_spoilt("loses some of the mass", "ignore", move |_, v| {
                (1.0 - small) * v
            }),
            "mass",
        ),
        (
            values_spoilt(
                "gains some mass far from the data",
                "ignore",
                move |x, v| {
                    v + small * bump(x, 5.0, 1.0) / std::f64::consts::TAU.powf(D as f64 / 2.0)
                },
            ),
            "mass",
        ),
        (
            boastful(
                "divides by the share inside, called conserving",
                |scale, _| kernel(0.4 * scale, "normalise"),
                |laws| laws.mass_conserving = true,
            ),
            "mass",
        ),
        (
            values_spoilt(
                "dips a thousandth of the peak below zero",
                "ignore",
                |x, v| v - 1e-3 * bump(x, 4.0, 0.5),
            ),
            "sign",
        ),
        (
            values_spoilt(
                "is minus the least number in the tails",
                "ignore",
                |_, v| {
                    if v < 1e-12 { -f64::MIN_POSITIVE } else { v }
                },
            ),
            "sign",
        ),
        (
            boastful(
                "local linear, called non-negative",
                |scale, _| kernel(0.8 * scale, "local-linear"),
                |laws| laws.non_negative = true,
            ),
            "sign",
        ),
        (
            boastful(
                "a width from the data, called linear",
                |_, _| silverman(),
                |laws| laws.linear = true,
            ),
            "union",
        ),
        (
            boastful(
                "the positive treatment of walls, called linear",
                |scale, _| kernel(0.4 * scale, "jones-foster"),
                |laws| laws.linear = true,
            ),
            "union",
        ),
        (
            sample_spoilt("bends weights", |x, w| {
                let total: f64 = w.iter().sum();
                (
                    x.to_vec(),
                    w.iter().map(|w| w * (1.0 + 0.01 * w / total)).collect(),
                )
            }),
            "union",
        ),
        (
            values_spoilt("jumps by one percent", "ignore", |x, v| {
                if x[0] > 0.3 { 1.01 * v } else { v }
            }),
            "continuity",
        ),
        (
            boastful(
                "a histogram, called continuous",
                |scale, shift| histogram(0.37 * scale, shift),
                |laws| laws.continuous = true,
            ),
            "continuity",
        ),
        (
            values_spoilt("never gives the same last bit", "ignore", |_, v| {
                let odd = COUNTER.fetch_add(1, Ordering::Relaxed) % 2;
                f64::from_bits(v.to_bits() + u64::from(odd))
            }),
            "determinism",
        ),
        (
            plant("does not stretch its width", |_, _| good(1.0)),
            "scale",
        ),
        (
            boastful(
                "does not stretch its origin",
                |scale, _| histogram(0.37 * scale, 0.111),
                |_| (),
            ),
            "scale",
        ),
        (
            boastful(
                "does not move its origin",
                |scale, _| histogram(0.37 * scale, 0.0),
                |_| (),
            ),
            "translation",
        ),
        (
            plant("loses digits far from zero", |scale, _| Spoilt {
                prepare: Some(Arc::new(|sample: &Sample<D>| {
                    // as if kept in single precision
                    let points = sample
                        .points()
                        .iter()
                        .map(|x| x.map(|x| f64::from(x as f32)))
                        .collect();
                    Sample::new(points, sample.weights().clone(), sample.domain().clone()).unwrap()
                })),
                ..good(scale)
            }),
            "translation",
        ),
        (
            boastful(
                "a width from the effective size, called repeatable",
                |_, _| silverman(),
                |laws| laws.repeatable = true,
            ),
            "repetition",
        ),
        (
            sample_spoilt("ignores weights", |x, w| {
                let total: f64 = w.iter().sum();
                (x.to_vec(), vec![total / x.len() as f64; x.len()])
            }),
            "repetition",
        ),
        (
            boastful(
                "sees no walls, called even between them",
                |scale, _| kernel(0.4 * scale, "ignore"),
                |laws| laws.reproduces_constants = true,
            ),
            "constants",
        ),
        (
            values_spoilt("is a little low at a wall", "reflect", move |x, v| {
                if x[0] < WINDOW[0] + 0.01 {
                    (1.0 - small) * v
                } else {
                    v
                }
            }),
            "constants",
        ),
        (
            boastful(
                "reflects, called right for lines",
                |scale, _| kernel(0.4 * scale, "reflect"),
                |laws| laws.reproduces_linear = true,
            ),
            "lines",
        ),
        (
            values_spoilt(
                "is a little high in one place",
                "local-linear",
                move |x, v| v * (1.0 + small * bump(x, 1.3, 0.6)),
            ),
            "lines",
        ),
    ]
}

/// What breaks laws that need no promise.
#[expect(clippy::too_many_lines, reason = "a list")]
fn universal<const D: usize>() -> Vec<(Subject<D>, &'static str)>
where
    Entry: Builds<D>,
{
    vec![
        (
            sample_spoilt("gives the first point one percent more", |x, w| {
                let mut w = w.to_vec();
                w[0] *= 1.01;
                (x.to_vec(), w)
            }),
            "order",
        ),
        (
            sample_spoilt("drops the last point", |x, w| {
                let n = (x.len() - 1).max(1);
                (x[..n].to_vec(), w[..n].to_vec())
            }),
            "order",
        ),
        (
            sample_spoilt("sees points of weight zero", |x, w| {
                let total: f64 = w.iter().sum();
                (
                    x.to_vec(),
                    w.iter()
                        .map(|w| 0.99 * w + 0.01 * total / x.len() as f64)
                        .collect(),
                )
            }),
            "zero weights",
        ),
        (
            sample_spoilt("forces the mass to one", |x, w| {
                let total: f64 = w.iter().sum();
                (x.to_vec(), w.iter().map(|w| w / total).collect())
            }),
            "weight unit",
        ),
        (
            values_spoilt("adds a constant of its own unit", "ignore", |x, v| {
                if x[0].abs() < 4.0 { v + 1e-6 } else { v }
            }),
            "weight unit",
        ),
        (
            plant("gives every channel half of the total", |scale, _| Spoilt {
                deaf_to_channels: true,
                ..good(scale)
            }),
            "channels",
        ),
        (
            plant("smooths each channel by itself", |_, _| {
                Spoilt::new(silverman())
            }),
            "channels",
        ),
        (
            sample_spoilt("drops ties", |x, w| {
                let (mut points, mut weights) = (Vec::new(), Vec::new());
                for (x, w) in x.iter().zip(w) {
                    if !points.contains(x) {
                        points.push(*x);
                        weights.push(*w);
                    }
                }
                (points, weights)
            }),
            "one place",
        ),
        (
            values_spoilt(
                "is not a number where all points are one",
                "ignore",
                |_, v| if v > 0.95 { f64::NAN } else { v },
            ),
            "one place",
        ),
        (
            plant(
                "is off by a millionth when many targets are asked for",
                |scale, _| Spoilt {
                    spoil: Some(Arc::new(|_, v| v * (1.0 + 1e-6))),
                    only_many: true,
                    ..good(scale)
                },
            ),
            "many targets",
        ),
        (
            values_spoilt("is not a number far away", "ignore", |x, v| {
                if x[0].abs() > 1e200 {
                    x[0] * x[0] * v
                } else {
                    v
                }
            }),
            "far targets",
        ),
        (
            values_spoilt("never quite ends", "ignore", |_, v| v + 1e-9),
            "far targets",
        ),
    ]
}

/// Promises that could be made and are not.
fn forgotten<const D: usize>() -> Vec<(Subject<D>, &'static str)>
where
    Entry: Builds<D>,
{
    vec![
        (
            modest("keeps mass, unsaid", "ignore", |laws| {
                laws.mass_conserving = false;
            }),
            "mass",
        ),
        (
            modest("is never negative, unsaid", "ignore", |laws| {
                laws.non_negative = false;
            }),
            "sign",
        ),
        (
            modest("is linear, unsaid", "ignore", |laws| laws.linear = false),
            "union",
        ),
        (
            modest("is continuous, unsaid", "ignore", |laws| {
                laws.continuous = false;
            }),
            "continuity",
        ),
        (
            modest("is deterministic, unsaid", "ignore", |laws| {
                laws.deterministic = false;
            }),
            "determinism",
        ),
        (
            modest("follows scale, unsaid", "ignore", |laws| {
                laws.scale_equivariant = false;
            }),
            "scale",
        ),
        (
            modest("follows translation, unsaid", "ignore", |laws| {
                laws.translation_equivariant = false;
            }),
            "translation",
        ),
        (
            modest("repeats, unsaid", "ignore", |laws| laws.repeatable = false),
            "repetition",
        ),
        (
            modest("is even between walls, unsaid", "reflect", |laws| {
                laws.reproduces_constants = false;
            }),
            "constants",
        ),
        (
            modest("is right for lines, unsaid", "local-linear", |laws| {
                laws.reproduces_linear = false;
            }),
            "lines",
        ),
    ]
}
