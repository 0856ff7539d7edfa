//! The laws themselves: each finds a breach on one data set, or none.

use super::cases::{Data, Sort, Subject, equal, span, weighted};
use density_lab::estimator::{Estimate, Estimator, FitError, Laws};
use density_lab::kernel::Bandwidth;
use density_lab::sample::Sample;
use density_lab::space::{Domain, Field, Grid, Targets};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::LazyLock;

/// One law.
pub struct Law {
    pub name: &'static str,
    /// Where it is promised; `None` for what holds without saying.
    pub promise: Option<fn(&Laws) -> bool>,
    /// What is wrong on these data, if anything.
    pub breach: fn(&Subject, &Data) -> Option<String>,
    pub data: Sort,
    pub cases: u32,
}

macro_rules! promised {
    ($name:literal, $field:ident, $breach:expr, $data:ident, $cases:literal) => {
        Law {
            name: $name,
            promise: Some(|laws| laws.$field),
            breach: $breach,
            data: Sort::$data,
            cases: $cases,
        }
    };
}
macro_rules! universal {
    ($name:literal, $breach:expr, $data:ident, $cases:literal) => {
        Law {
            name: $name,
            promise: None,
            breach: $breach,
            data: Sort::$data,
            cases: $cases,
        }
    };
}

pub const LAWS: &[Law] = &[
    promised!("mass", mass_conserving, mass, Any, 12),
    promised!("sign", non_negative, sign, Any, 16),
    promised!("union", linear, union, General, 16),
    promised!("continuity", continuous, continuity, General, 8),
    promised!("determinism", deterministic, determinism, Any, 12),
    promised!("scale", scale_equivariant, scale, General, 20),
    promised!(
        "translation",
        translation_equivariant,
        translation,
        General,
        20
    ),
    promised!("repetition", repeatable, repetition, General, 16),
    universal!("order", order, Any, 16),
    universal!("zero weights", zero_weights, General, 16),
    universal!("weight unit", weight_unit, Any, 16),
    universal!("channels", channels, General, 12),
    universal!("one place", one_place, OnePlace, 16),
    universal!("many targets", many_targets, Any, 16),
    universal!("far targets", far_targets, General, 6),
];

/// What rounding may do to values, relative to the greatest among them.
const ROUNDING: f64 = 1e-10;

/// The same in another unit or from another origin, where a width found by a search for a minimum is only good to √ε.
fn rounding(subject: &Subject) -> f64 {
    if subject.searched { 1e-6 } else { ROUNDING }
}

/// What a quadrature over jumps may miss, relative to the mass; a hundredth of the least fault planted.
const QUADRATURE: f64 = 1e-4;

/// An estimate, or nothing where the sample is refused for a reason.
fn fitted(estimator: &dyn Estimator<1>, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
    estimator.fit(sample)
}

/// Fits, or leaves the law: refusing is judged by "one place", not by each law again.
macro_rules! fit {
    ($estimator:expr, $sample:expr) => {
        match fitted(&*$estimator, $sample) {
            Ok(estimate) => estimate,
            Err(FitError::Select(_) | FitError::Degenerate(_)) => return None,
            Err(error) => return Some(format!("refused: {error}")),
        }
    };
}

fn values(field: &(impl Field<1> + ?Sized), targets: &[f64]) -> Vec<f64> {
    let places: Vec<[f64; 1]> = targets.iter().map(|&x| [x]).collect();
    field.evaluate(Targets::Points(&places)).values
}

/// The first place where two estimates differ by more than rounding.
fn difference(targets: &[f64], left: &[f64], right: &[f64]) -> Option<String> {
    difference_above(ROUNDING, targets, left, right)
}

fn difference_above(
    tolerance: f64,
    targets: &[f64],
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
            (!close).then(|| format!("at {x}: {a} against {b}, peak {peak}"))
        })
}

/// The length over which the estimate changes: what the estimator says, else the deviation of the data, else their range.
fn length(subject: &Subject, estimate: &Estimate<1>, points: &[f64]) -> f64 {
    let (low, high) = span(points);
    estimate
        .smoothing
        .filter(|_| subject.by_length)
        .unwrap_or_else(|| if high > low { (high - low) / 4.0 } else { 1.0 })
}

fn mass(subject: &Subject, data: &Data) -> Option<String> {
    let sample = data.sample();
    let estimate = fit!(subject.plain(), &sample);
    let usual = length(subject, &estimate, &data.points);
    // bumps of widths of their own are looked at as far as each reaches
    let lengths: Vec<f64> = match &estimate.bandwidth {
        Some(Bandwidth::PerPoint(widths)) => widths.to_vec(),
        _ => vec![usual; data.points.len()],
    };
    let integral = integral(&estimate, &data.points, &lengths);
    let close = (integral - sample.mass()).abs() <= QUADRATURE * sample.mass();
    (!close).then(|| format!("integral {integral}, mass {}", sample.mass()))
}

/// ∫ over the line by Simpson's rule, halving panels until it agrees with itself; the first panels are half a smoothing length within 12 of them around the
/// data, so that no bump is missed,
/// and cut where compact kernels end.
fn integral(field: &dyn Field<1>, points: &[f64], lengths: &[f64]) -> f64 {
    let mut cuts: Vec<f64> = points
        .iter()
        .zip(lengths)
        .flat_map(|(x, length)| (-24..=24).map(move |k| f64::from(k).mul_add(0.5 * length, *x)))
        .collect();
    cuts.sort_by(f64::total_cmp);
    let f = |x: f64| field.at([x]);
    let share = 0.01 * QUADRATURE / cuts.len() as f64;
    cuts.windows(2)
        .map(|panel| {
            let (a, b) = (panel[0], panel[1]);
            let (fa, fm, fb) = (f(a), f(0.5 * (a + b)), f(b));
            simpson(&f, [a, b], [fa, fm, fb], share, 40)
        })
        .sum()
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

fn sign(subject: &Subject, data: &Data) -> Option<String> {
    let estimate = fit!(subject.plain(), &data.sample());
    let (low, high) = span(&data.points);
    let reach = 6.0 * length(subject, &estimate, &data.points);
    let mut targets = data.targets.clone();
    targets.extend(
        (0..=400).map(|i| f64::from(i).mul_add((high - low + 2.0 * reach) / 400.0, low - reach)),
    );
    let values = values(&estimate, &targets);
    targets
        .iter()
        .zip(values)
        .find(|(_, v)| v.is_nan() || *v < 0.0)
        .map(|(x, v)| format!("{v} at {x}"))
}

fn union(subject: &Subject, data: &Data) -> Option<String> {
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
    let both = fit!(
        estimator,
        &weighted(&data.points, [left.clone(), right.clone()].concat())
    );
    let left = fit!(estimator, &weighted(&data.points[..cut], left));
    let right = fit!(estimator, &weighted(&data.points[cut..], right));
    let apart: Vec<f64> = values(&left, &data.targets)
        .iter()
        .zip(values(&right, &data.targets))
        .map(|(a, b)| a + b)
        .collect();
    difference(&data.targets, &values(&both, &data.targets), &apart)
}

/// Looks where neighbouring values differ least smoothly and halves the interval: a slope fades, a jump stays.
fn continuity(subject: &Subject, data: &Data) -> Option<String> {
    const STEPS: usize = 1500;
    let estimate = fit!(subject.plain(), &data.sample());
    let (low, high) = span(&data.points);
    let s = length(subject, &estimate, &data.points);
    let (low, high) = (low - 4.0 * s, high + 4.0 * s);
    let targets: Vec<f64> = (0..=STEPS)
        .map(|i| (i as f64).mul_add((high - low) / STEPS as f64, low))
        .collect();
    let values = values(&estimate, &targets);
    let peak = values.iter().fold(0.0, |peak: f64, v| peak.max(v.abs()));
    let step = |i: usize| values[i + 1] - values[i];
    let mut suspects: Vec<usize> = (1..STEPS - 1).collect();
    let rough = |i: usize| (step(i) - 0.5 * (step(i - 1) + step(i + 1))).abs();
    suspects.sort_by(|&i, &j| rough(j).total_cmp(&rough(i)));
    for &i in suspects.iter().take(10) {
        let (mut a, mut b) = (targets[i], targets[i + 1]);
        let (mut fa, mut fb) = (estimate.at([a]), estimate.at([b]));
        while b - a > 1e-12 * s.max(a.abs()) {
            let m = 0.5 * (a + b);
            let fm = estimate.at([m]);
            if (fm - fa).abs() >= (fb - fm).abs() {
                (b, fb) = (m, fm);
            } else {
                (a, fa) = (m, fm);
            }
        }
        if (fb - fa).abs() > 1e-8 * peak {
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

fn determinism(subject: &Subject, data: &Data) -> Option<String> {
    let sample = data.sample();
    let bits = |estimator: &dyn Estimator<1>| -> Option<Vec<u64>> {
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
    if first != bits(&*subject.fresh()) {
        return Some("built twice, two answers".to_owned());
    }
    POOLS
        .iter()
        .any(|pool| pool.install(|| bits(&*estimator)) != first)
        .then(|| "another number of threads, another answer".to_owned())
}

fn scale(subject: &Subject, data: &Data) -> Option<String> {
    let a = [
        1e-6,
        2.0_f64.powi(-20),
        0.37,
        3.7,
        1000.0,
        2.0_f64.powi(20),
        1e6,
    ][data.choice % 7];
    let sample = data.sample();
    let total: Vec<f64> = (0..sample.len()).map(|i| sample.weight(i)).collect();
    let stretched = |x: &[f64]| -> Vec<f64> { x.iter().map(|x| a * x).collect() };
    let here = fit!(subject.plain(), &sample);
    let there = fit!(
        subject.moved(a, 0.0),
        &weighted(&stretched(&data.points), total)
    );
    let values_there: Vec<f64> = values(&there, &stretched(&data.targets))
        .iter()
        .map(|v| a * v)
        .collect();
    difference_above(
        rounding(subject),
        &data.targets,
        &values(&here, &data.targets),
        &values_there,
    )
    .map(|what| format!("scale {a}: {what}"))
}

fn translation(subject: &Subject, data: &Data) -> Option<String> {
    let mut t = [1e9_f64, -7.25, 1024.0, 1.0 / 1024.0, -1e6][data.choice % 5];
    if subject.searched && t.abs() > 1e5 {
        // the oracle looks at a distribution function, which has lost its digits there
        t = 1e3;
    }
    let sample = data.sample();
    let total: Vec<f64> = (0..sample.len()).map(|i| sample.weight(i)).collect();
    let moved = |x: &[f64]| -> Vec<f64> { x.iter().map(|x| x + t).collect() };
    let here = fit!(subject.plain(), &sample);
    let there = fit!(
        subject.moved(1.0, t),
        &weighted(&moved(&data.points), total)
    );
    difference_above(
        rounding(subject),
        &data.targets,
        &values(&here, &data.targets),
        &values(&there, &moved(&data.targets)),
    )
    .map(|what| format!("moved by {t}: {what}"))
}

fn repetition(subject: &Subject, data: &Data) -> Option<String> {
    let repeated: Vec<f64> = data
        .points
        .iter()
        .zip(&data.weights)
        .flat_map(|(&x, &w)| std::iter::repeat_n(x, w as usize))
        .collect();
    let estimator = subject.plain();
    let weighted = fit!(estimator, &data.sample());
    let repeated = fit!(estimator, &equal(&repeated));
    difference(
        &data.targets,
        &values(&weighted, &data.targets),
        &values(&repeated, &data.targets),
    )
}

fn order(subject: &Subject, data: &Data) -> Option<String> {
    let sample = data.sample();
    let mut pairs: Vec<(f64, f64)> = data
        .points
        .iter()
        .copied()
        .zip((0..sample.len()).map(|i| sample.weight(i)))
        .collect();
    pairs.rotate_left(data.choice % sample.len());
    pairs.reverse();
    let (points, weights): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
    let estimator = subject.plain();
    let here = fit!(estimator, &sample);
    let there = fit!(estimator, &weighted(&points, weights));
    difference_above(
        rounding(subject),
        &data.targets,
        &values(&here, &data.targets),
        &values(&there, &data.targets),
    )
}

fn zero_weights(subject: &Subject, data: &Data) -> Option<String> {
    let sample = data.sample();
    let (mut points, mut weights) = (
        data.points.clone(),
        (0..sample.len())
            .map(|i| sample.weight(i))
            .collect::<Vec<_>>(),
    );
    for (k, ghost) in [data.targets[0], 1e5, data.targets[1], -1e18]
        .into_iter()
        .enumerate()
    {
        let at = (data.choice + 7 * k) % (points.len() + 1);
        points.insert(at, ghost);
        weights.insert(at, 0.0);
    }
    let estimator = subject.plain();
    let here = fit!(estimator, &sample);
    let there = fit!(estimator, &weighted(&points, weights));
    difference_above(
        rounding(subject),
        &data.targets,
        &values(&here, &data.targets),
        &values(&there, &data.targets),
    )
}

/// Watts or milliwatts: the estimate is in the unit of the weights.
fn weight_unit(subject: &Subject, data: &Data) -> Option<String> {
    let factor = [1e-12, 0.3, 1000.0, 1e12][data.choice % 4];
    let sample = data.sample();
    let estimator = subject.plain();
    let here = fit!(estimator, &sample);
    let there = fit!(
        estimator,
        &weighted(
            &data.points,
            (0..sample.len())
                .map(|i| factor * sample.weight(i))
                .collect()
        )
    );
    let there: Vec<f64> = values(&there, &data.targets)
        .iter()
        .map(|v| v / factor)
        .collect();
    difference_above(
        rounding(subject),
        &data.targets,
        &values(&here, &data.targets),
        &there,
    )
}

/// The channels sum to the total; where estimates add up, each is the estimate of its own weights; a dark channel is dark.
fn channels(subject: &Subject, data: &Data) -> Option<String> {
    let n = data.points.len();
    let red: Vec<f64> = (0..n)
        .map(|i| f64::from(data.weights[i]) / n as f64)
        .collect();
    let green: Vec<f64> = (0..n)
        .map(|i| {
            f64::from(data.weights[(i + data.choice) % n]) / n as f64 * f64::from(u8::from(i > 0))
        })
        .collect();
    let points: Vec<[f64; 1]> = data.points.iter().map(|&x| [x]).collect();
    let sample = Sample::with_channels(
        points,
        vec![red.clone(), vec![0.0; n], green.clone()],
        Domain::whole(),
    )
    .unwrap();
    let estimator = subject.plain();
    let estimate = fit!(estimator, &sample);
    let Some(parts) = (0..3)
        .map(|c| {
            estimate
                .channel(c)
                .map(|field| values(field, &data.targets))
        })
        .collect::<Option<Vec<_>>>()
    else {
        return Some("a channel is missing".to_owned());
    };
    let total = values(&estimate, &data.targets);
    let sum: Vec<f64> = (0..total.len())
        .map(|i| parts[0][i] + parts[2][i])
        .collect();
    if let Some(what) = difference(&data.targets, &total, &sum) {
        return Some(format!("the channels do not sum to the total: {what}"));
    }
    if parts[1].iter().any(|v| v.to_bits() << 1 != 0) {
        return Some("a dark channel is not dark".to_owned());
    }
    if estimator.laws().linear {
        for (weights, part) in [(red, &parts[0]), (green, &parts[2])] {
            let alone = fit!(estimator, &weighted(&data.points, weights));
            if let Some(what) = difference(&data.targets, &values(&alone, &data.targets), part) {
                return Some(format!(
                    "a channel is not the estimate of its weights: {what}"
                ));
            }
        }
    }
    None
}

/// One point, or several at one place: refused in words, or estimated with finite values that keep what is promised.
fn one_place(subject: &Subject, data: &Data) -> Option<String> {
    let estimator = subject.plain();
    let laws = estimator.laws();
    let estimate = match estimator.fit(&data.sample()) {
        Ok(estimate) => estimate,
        Err(error) if laws.linear => return Some(format!("refused with a fixed width: {error}")),
        Err(FitError::Select(_) | FitError::Degenerate(_)) => return None,
        Err(error) => return Some(format!("refused for the wrong reason: {error}")),
    };
    let here = values(&estimate, &data.targets);
    if here
        .iter()
        .any(|v| !v.is_finite() || laws.non_negative && *v < 0.0)
    {
        return Some(format!("{here:?}"));
    }
    if laws.linear {
        let one = fit!(estimator, &equal(&data.points[..1]));
        return difference(&data.targets, &here, &values(&one, &data.targets))
            .map(|what| format!("ties are not one heavy point: {what}"));
    }
    None
}

/// Many targets at once mean the same as one after the other, on a grid and scattered, within the error that the answer states.
fn many_targets(subject: &Subject, data: &Data) -> Option<String> {
    let estimate = fit!(subject.plain(), &data.sample());
    let (low, high) = span(&data.targets);
    let grid = Grid::new([low], [high + 1.0], [64]).unwrap();
    // no kernel is higher than 1.1
    let ceiling = 1.1 * data.sample().mass() / length(subject, &estimate, &data.points);
    let places: Vec<[f64; 1]> = data.targets.iter().map(|&x| [x]).collect();
    for targets in [Targets::Grid(&grid), Targets::Points(&places)] {
        let evaluation = estimate.evaluate(targets);
        if evaluation.values.len() != targets.len() {
            return Some("not one value a target".to_owned());
        }
        for (x, value) in targets.places().zip(&evaluation.values) {
            let one = estimate.at(x);
            let close = (one - value).abs() <= (evaluation.error + 1e-13) * ceiling;
            if !close {
                return Some(format!("{value} among many, {one} alone, at {x:?}"));
            }
        }
    }
    None
}

/// Far from all data there is nothing, and no NaN.
fn far_targets(subject: &Subject, data: &Data) -> Option<String> {
    let estimate = fit!(subject.plain(), &data.sample());
    let far = [-1e300, -1e12, 1e12, 1e300, f64::MAX, f64::MIN];
    let ceiling = 1.0 / length(subject, &estimate, &data.points);
    far.iter()
        .zip(values(&estimate, &far))
        .find(|(_, v)| v.is_nan() || v.abs() > 1e-12 * ceiling)
        .map(|(x, v)| format!("{v} at {x}"))
}
