//! Laws that an estimator promises or not.

use super::data::{Data, equal, moved, moved_domain, span, weighted};
use super::law::{difference, fit, length, rounding, values};
use super::subject::Subject;
use density_lab::estimator::{Estimate, Estimator};
use density_lab::kernel::Bandwidth;
use density_lab::random::{open_unit, stream};
use density_lab::space::{Field, Grid, Point};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::LazyLock;

/// What integration over jumps may miss, relative to the mass: adaptive on the line; a sum over cells in the plane.
fn quadrature(dimensions: usize) -> f64 {
    if dimensions == 1 { 1e-4 } else { 2.5e-2 }
}

pub fn mass<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    if D > 1 && span(&data.points).1 > 500.0 {
        // no grid sees both a cluster and a point at a distance of a thousand clusters
        return None;
    }
    let estimate = fit!(subject.plain(), &data.sample());
    if D > 1 && !subject.by_length && thin(&data.points) {
        return None;
    }
    let promised = subject.plain().laws().mass_conserving;
    let (integral, margin) = match (D, promised) {
        (1, true) => (along_the_line(subject, &estimate, data), quadrature(D)),
        (1, false) => roughly_along_the_line(subject, &estimate, data),
        // who promises nothing is looked at less closely, and must be farther off
        _ => {
            let (integral, size) = over_the_plane(subject, &estimate, data, 1)?;
            let margin = match (promised, subject.plain().laws().continuous) {
                (true, _) => quadrature(D) * size,
                (false, true) => 0.01 * size,
                (false, false) => 0.08,
            };
            (integral, margin)
        }
    };
    let close = (integral - 1.0).abs() <= margin;
    if D > 1 && promised && !close && !subject.by_length {
        // what a finer grid mends is the grid's fault: radii of a few texels are no length that is told
        let finer = over_the_plane(subject, &estimate, data, 3)?.0;
        if (finer - 1.0).abs() < 0.5 * (integral - 1.0).abs() {
            return None;
        }
    }
    (!close).then(|| format!("integral {integral}, mass 1"))
}

/// ∫ over the line by Simpson's rule, halving panels until it agrees with itself; the first panels are half a smoothing length within 12 of them around the
/// data, so that no bump is missed, and cut where compact kernels and the domain end.
fn along_the_line<const D: usize>(
    subject: &Subject<D>,
    estimate: &Estimate<D>,
    data: &Data<D>,
) -> f64 {
    let usual = length(subject, estimate, &data.points);
    // bumps of widths of their own are looked at as far as each reaches
    let lengths: Vec<f64> = match &estimate.bandwidth {
        Some(Bandwidth::PerPoint(widths)) => widths.to_vec(),
        _ => vec![usual; data.points.len()],
    };
    let mut cuts: Vec<f64> = data
        .points
        .iter()
        .zip(lengths)
        .flat_map(|(x, length)| (-24..=24).map(move |k| f64::from(k).mul_add(0.5 * length, x[0])))
        .collect();
    let ends = [data.domain.low()[0], data.domain.high()[0]];
    cuts.extend(ends.iter().filter(|end| end.is_finite()));
    cuts.sort_by(f64::total_cmp);
    let f = |x: f64| estimate.at([x; D]);
    let share = 0.01 * quadrature(D) / cuts.len() as f64;
    cuts.windows(2)
        .map(|panel| {
            let (a, b) = (panel[0], panel[1]);
            let (fa, fm, fb) = (f(a), f(0.5 * (a + b)), f(b));
            simpson(&f, [a, b], [fa, fm, fb], share, 40)
        })
        .sum()
}

/// ∫ over the line by sums over two grids, and how far it may be off, as told by what they differ: estimates that jump or have cusps everywhere leave adaptive rules
/// no end of halving.
fn roughly_along_the_line<const D: usize>(
    subject: &Subject<D>,
    estimate: &Estimate<D>,
    data: &Data<D>,
) -> (f64, f64) {
    let (low, high) = span(&data.points);
    let reach = 12.0 * length(subject, estimate, &data.points);
    let sum = |cells: usize| {
        let grid = Grid::new([low - reach; D], [high + reach; D], [cells; D]).unwrap();
        estimate.on(&grid).integral()
    };
    let (one, other) = (sum(3001), sum(4000));
    (other, 10.0 * (one - other).abs() + 20.0 * quadrature(D))
}

/// Whether the data lie near a line, which a ridge above it makes hard to integrate over.
fn thin<const D: usize>(points: &[Point<D>]) -> bool {
    let n = points.len() as f64;
    let mean = |pick: &dyn Fn(&Point<D>) -> f64| points.iter().map(pick).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p[0]), mean(&|p| p[D - 1]));
    let xx = mean(&|p| (p[0] - x).powi(2));
    let yy = mean(&|p| (p[D - 1] - y).powi(2));
    let xy = mean(&|p| (p[0] - x) * (p[D - 1] - y));
    let spread = (0.25 * (xx - yy).powi(2) + xy * xy).sqrt();
    let (low, high) = span(points);
    (0.5 * (xx + yy) - spread).max(0.0).sqrt() < 0.1 * (high - low)
}

fn simpson(
    f: &impl Fn(f64) -> f64,
    [a, b]: [f64; 2],
    [fa, fm, fb]: [f64; 3],
    tolerance: f64,
    depth: u32,
) -> f64 {
    let m = 0.5 * (a + b);
    let (fl, fr) = (f(0.5 * (a + m)), f(0.5 * (m + b)));
    let whole = (b - a) / 6.0 * (fa + 4.0 * fm + fb);
    let halves = (b - a) / 12.0 * (fa + 4.0 * fl + 2.0 * fm + 4.0 * fr + fb);
    if depth == 0 || (halves - whole).abs() <= tolerance && depth < 38 {
        return halves + (halves - whole) / 15.0;
    }
    simpson(f, [a, m], [fa, fl, fm], 0.6 * tolerance, depth - 1)
        + simpson(f, [m, b], [fm, fr, fb], 0.6 * tolerance, depth - 1)
}

/// A sum over cells: of a coarse grid to find where the estimate is, then of a fine one over that place; and that of the magnitudes, to which the error of such sums is
/// relative. Nothing where the estimate is too narrow for the fine grid.
fn over_the_plane<const D: usize>(
    subject: &Subject<D>,
    estimate: &Estimate<D>,
    data: &Data<D>,
    fineness: usize,
) -> Option<(f64, f64)> {
    const COARSE: usize = 48;
    let h = length(subject, estimate, &data.points);
    let (low, high) = span(&data.points);
    let widest = match &estimate.bandwidth {
        Some(Bandwidth::Fixed(h)) => h.iter().copied().fold(h[0], f64::max),
        Some(Bandwidth::PerPoint(widths)) => widths.iter().copied().fold(h, f64::max),
        _ => h.max(2.0),
    };
    let reach = 9.0 * widest;
    let domain = &data.domain;
    let coarse = Grid::new([low - reach; D], [high + reach; D], [COARSE; D]).unwrap();
    let seen = estimate.on(&coarse);
    let (mut from, mut to) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    let peak = seen
        .values()
        .iter()
        .fold(0.0, |peak: f64, v| peak.max(v.abs()));
    for (x, value) in coarse.centres().zip(seen.values()) {
        if value.abs() > 1e-6 * peak {
            for axis in 0..D {
                from[axis] = from[axis].min(x[axis] - coarse.width(axis));
                to[axis] = to[axis].max(x[axis] + coarse.width(axis));
            }
        }
    }
    // data that fall between the cells of the coarse grid are there, too
    for x in &data.points {
        for axis in 0..D {
            // a bin may be several times as long as the one length that is told of it
            from[axis] = from[axis].min(x[axis] - 2.5 * h);
            to[axis] = to[axis].max(x[axis] + 2.5 * h);
        }
    }
    let laws = subject.plain().laws();
    let mut cells = match (laws.mass_conserving, laws.continuous) {
        (false, false) => [80; D],
        (false, true) => [120; D],
        (true, true) => [200; D],
        // edges fall between cells, slopes do not
        (true, false) => [500; D],
    };
    cells = cells.map(|cells| cells * fineness);
    if domain.has_walls() {
        // cells that end with the domain, as estimates may
        for axis in 0..D {
            let (low, high) = (domain.low()[axis], domain.high()[axis]);
            let width = (high - low) / cells[axis] as f64;
            let below = ((low - from[axis]) / width).ceil().max(0.0);
            let above = ((to[axis] - high) / width).ceil().max(0.0);
            from[axis] = low - below * width;
            to[axis] = high + above * width;
            cells[axis] += (below + above) as usize;
        }
    }
    let fine = Grid::new(from, to, cells).unwrap();
    let least = if laws.mass_conserving { 6.0 } else { 2.0 };
    if h < least * fine.width(0) {
        return None;
    }
    let found = if laws.continuous || !laws.mass_conserving {
        estimate.on(&fine).values().to_vec()
    } else {
        // anywhere in each cell, so that whole rows of cells do not fall on one side of an edge together
        let mut random = stream(1, "cells", data.choice as u64);
        let mut anywhere = |x: Point<D>| -> Point<D> {
            std::array::from_fn(|axis| x[axis] + (open_unit(&mut random) - 0.5) * fine.width(axis))
        };
        let places: Vec<Point<D>> = fine.centres().map(&mut anywhere).collect();
        values(estimate, &places)
    };
    let sum = |part: fn(f64) -> f64| found.iter().map(|v| part(*v)).sum::<f64>();
    let cell = fine.cell_measure();
    Some((cell * sum(|v| v), cell * sum(f64::abs)))
}

pub fn sign<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let estimate = fit!(subject.plain(), &data.sample());
    let (low, high) = span(&data.points);
    let reach = 6.0 * length(subject, &estimate, &data.points);
    let cells = if D == 1 { 300 } else { 20 };
    let grid = Grid::new([low - reach; D], [high + reach; D], [cells; D]).unwrap();
    let mut targets = data.targets.clone();
    targets.extend(grid.centres());
    let values = values(&estimate, &targets);
    targets
        .iter()
        .zip(values)
        .find(|(_, v)| v.is_nan() || *v < 0.0)
        .map(|(x, v)| format!("{v} at {x:?}"))
}

pub fn union<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let cut = 1 + data.choice % (data.points.len() - 1);
    let share = [0.25, 0.5, 0.875][data.choice % 3];
    let part = |range: std::ops::Range<usize>, share: f64| -> Vec<f64> {
        let total: u32 = data.weights[range.clone()].iter().sum();
        data.weights[range]
            .iter()
            .map(|&w| share * f64::from(w) / f64::from(total))
            .collect()
    };
    let (left, right) = (
        part(0..cut, share),
        part(cut..data.points.len(), 1.0 - share),
    );
    let estimator = subject.plain();
    let domain = &data.domain;
    let together = [left.clone(), right.clone()].concat();
    let both = fit!(estimator, &weighted(&data.points, together, domain));
    let left = fit!(estimator, &weighted(&data.points[..cut], left, domain));
    let right = fit!(estimator, &weighted(&data.points[cut..], right, domain));
    let apart: Vec<f64> = values(&left, &data.targets)
        .iter()
        .zip(values(&right, &data.targets))
        .map(|(a, b)| a + b)
        .collect();
    difference(
        rounding(subject, data),
        &data.targets,
        &values(&both, &data.targets),
        &apart,
    )
}

/// Along the line, or along three straight lines through the plane: looks where neighbouring values differ least smoothly and halves the interval: a slope
/// fades, a jump stays.
pub fn continuity<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let estimate = fit!(subject.plain(), &data.sample());
    let (low, high) = span(&data.points);
    let s = length(subject, &estimate, &data.points);
    let within = |x: f64| x.clamp(data.domain.low()[0], data.domain.high()[0]);
    let (low, high) = (within(low - 4.0 * s), within(high + 4.0 * s));
    if D == 1 {
        return jump(&|t| [t; D], &estimate, [low, high], s, 1200);
    }
    (0..3).find_map(|line| {
        // through a datum, in a direction of its own
        let through = data.points[(data.choice + line) % data.points.len()];
        let slope = [0.618, -0.414, 1.732][line];
        let along = |t: f64| -> Point<D> {
            std::array::from_fn(|axis| {
                let x = if axis == 0 {
                    t
                } else {
                    through[axis] + slope * (t - through[0])
                };
                within(x)
            })
        };
        jump(&along, &estimate, [low, high], s, 400)
    })
}

fn jump<const D: usize>(
    along: &impl Fn(f64) -> Point<D>,
    estimate: &Estimate<D>,
    [low, high]: [f64; 2],
    s: f64,
    steps: usize,
) -> Option<String> {
    let places: Vec<f64> = (0..=steps)
        .map(|i| {
            (i as f64)
                .mul_add((high - low) / steps as f64, low)
                .min(high)
        })
        .collect();
    let targets: Vec<Point<D>> = places.iter().map(|&t| along(t)).collect();
    let values = values(estimate, &targets);
    let peak = values.iter().fold(0.0, |peak: f64, v| peak.max(v.abs()));
    let step = |i: usize| values[i + 1] - values[i];
    let rough = |i: usize| (step(i) - 0.5 * (step(i - 1) + step(i + 1))).abs();
    let mut suspects: Vec<usize> = (1..steps - 1).collect();
    suspects.sort_by(|&i, &j| rough(j).total_cmp(&rough(i)));
    for &i in suspects.iter().take(8) {
        let (mut a, mut b) = (places[i], places[i + 1]);
        let (mut fa, mut fb) = (estimate.at(along(a)), estimate.at(along(b)));
        while b - a > 1e-12 * s.max(a.abs()) {
            let m = 0.5 * (a + b);
            let fm = estimate.at(along(m));
            if (fm - fa).abs() >= (fb - fm).abs() {
                (b, fb) = (m, fm);
            } else {
                (a, fa) = (m, fm);
            }
        }
        // on a spike between the steps rounding is that of the spike
        if (fb - fa).abs() > 1e-8 * peak.max(fa.abs()).max(fb.abs()) {
            return Some(format!("from {fa} to {fb} between {a} and {b}"));
        }
    }
    None
}

static POOLS: LazyLock<[ThreadPool; 2]> = LazyLock::new(|| {
    [1, 3].map(|threads| {
        ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
    })
});

pub fn determinism<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let sample = data.sample();
    let bits = |estimator: &dyn Estimator<D>| -> Option<Vec<u64>> {
        let estimate = estimator.fit(&sample).ok()?;
        Some(
            values(&estimate, &data.targets)
                .iter()
                .map(|v| v.to_bits())
                .collect(),
        )
    };
    let estimator = subject.plain();
    let first = bits(&*estimator);
    if first != bits(&*estimator) {
        return Some("fitted twice, two answers".to_owned());
    }
    if !subject.oracle && first != bits(&*subject.fresh()) {
        return Some("built twice, two answers".to_owned());
    }
    POOLS
        .iter()
        .any(|pool| pool.install(|| bits(&*estimator)) != first)
        .then(|| "another number of threads, another answer".to_owned())
}

/// The estimate of data x ↦ a x + t, in the unit of the data, is the same.
fn follows<const D: usize>(subject: &Subject<D>, data: &Data<D>, a: f64, t: f64) -> Option<String> {
    let here = fit!(subject.plain(), &data.sample());
    let there = fit!(
        subject.moved(a, t),
        &weighted(
            &moved(&data.points, a, t),
            data.shares(),
            &moved_domain(&data.domain, a, t)
        )
    );
    let there: Vec<f64> = values(&there, &moved(&data.targets, a, t))
        .iter()
        .map(|v| v * a.powi(D as i32))
        .collect();
    difference(
        rounding(subject, data),
        &data.targets,
        &values(&here, &data.targets),
        &there,
    )
    .map(|what| format!("data times {a} plus {t}: {what}"))
}

pub fn scale<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let a = [
        1e-6,
        2.0_f64.powi(-20),
        0.37,
        3.7,
        1000.0,
        2.0_f64.powi(20),
        1e6,
    ][data.choice % 7];
    follows(subject, data, a, 0.0)
}

pub fn translation<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let mut t = [1e9_f64, -7.25, 1024.0, 1.0 / 1024.0, -1e6][data.choice % 5];
    if (subject.searched || data.domain.outline().is_some()) && t.abs() > 1e5 {
        // the oracle looks at a distribution function, and polygons at products of coordinates, which have lost their digits there
        t = 1024.0;
    }
    follows(subject, data, 1.0, t)
}

pub fn repetition<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let repeated: Vec<Point<D>> = data
        .points
        .iter()
        .zip(&data.weights)
        .flat_map(|(&x, &w)| std::iter::repeat_n(x, w as usize))
        .collect();
    let estimator = subject.plain();
    let weighted = fit!(estimator, &data.sample());
    let repeated = fit!(estimator, &equal(&repeated, &data.domain));
    difference(
        rounding(subject, data),
        &data.targets,
        &values(&weighted, &data.targets),
        &values(&repeated, &data.targets),
    )
}
