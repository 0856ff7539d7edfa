//! Laws that hold of every estimator without saying.

use super::data::{Data, equal, span, weighted};
use super::law::{difference, fit, length, rounding, values};
use super::subject::Subject;
use density_lab::estimator::FitError;
use density_lab::sample::Sample;
use density_lab::space::{Field, Grid, Point, Targets};

/// The estimates of two lists of points and weights are the same.
fn same<const D: usize>(
    subject: &Subject<D>,
    data: &Data<D>,
    points: &[Point<D>],
    weights: Vec<f64>,
    factor: f64,
) -> Option<String> {
    let estimator = subject.plain();
    let here = fit!(estimator, &data.sample());
    let there = fit!(estimator, &weighted(points, weights, &data.domain));
    let there: Vec<f64> = values(&there, &data.targets)
        .iter()
        .map(|v| v / factor)
        .collect();
    difference(
        rounding(subject, data),
        &data.targets,
        &values(&here, &data.targets),
        &there,
    )
}

pub fn order<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let mut pairs: Vec<(Point<D>, f64)> = data.points.iter().copied().zip(data.shares()).collect();
    let turn = data.choice % pairs.len();
    pairs.rotate_left(turn);
    pairs.reverse();
    let (points, weights): (Vec<Point<D>>, Vec<f64>) = pairs.into_iter().unzip();
    same(subject, data, &points, weights, 1.0)
}

pub fn zero_weights<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let (mut points, mut weights) = (data.points.clone(), data.shares());
    let ghosts = [data.targets[0], [1e5; D], data.targets[1], [-1e18; D]];
    for (k, ghost) in ghosts.into_iter().enumerate() {
        if data.domain.contains(ghost) {
            let at = (data.choice + 7 * k) % (points.len() + 1);
            points.insert(at, ghost);
            weights.insert(at, 0.0);
        }
    }
    same(subject, data, &points, weights, 1.0)
}

/// Watts or milliwatts: the estimate is in the unit of the weights.
pub fn weight_unit<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let factor = [1e-12, 0.3, 1000.0, 1e12][data.choice % 4];
    let weights = data.shares().iter().map(|w| factor * w).collect();
    same(subject, data, &data.points, weights, factor)
}

/// The channels sum to the total; where estimates add up, each is the estimate of its own weights; a dark channel is dark.
pub fn channels<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let n = data.points.len();
    let red: Vec<f64> = (0..n)
        .map(|i| f64::from(data.weights[i]) / n as f64)
        .collect();
    let green: Vec<f64> = (0..n)
        .map(|i| {
            f64::from(data.weights[(i + data.choice) % n]) / n as f64 * f64::from(u8::from(i > 0))
        })
        .collect();
    let sample = Sample::with_channels(
        data.points.clone(),
        vec![red.clone(), vec![0.0; n], green.clone()],
        data.domain.clone(),
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
    let tolerance = rounding(subject, data);
    let total = values(&estimate, &data.targets);
    let sum: Vec<f64> = (0..total.len())
        .map(|i| parts[0][i] + parts[2][i])
        .collect();
    // what is not linear, such as an exponential of a ratio, is taken of each channel by itself
    let additive = estimator.laws().linear || !subject.name.contains("jones-foster");
    if additive && let Some(what) = difference(tolerance, &data.targets, &total, &sum) {
        return Some(format!("the channels do not sum to the total: {what}"));
    }
    if parts[1].iter().any(|v| v.to_bits() << 1 != 0) {
        return Some("a dark channel is not dark".to_owned());
    }
    if estimator.laws().linear {
        for (weights, part) in [(red, &parts[0]), (green, &parts[2])] {
            let alone = fit!(estimator, &weighted(&data.points, weights, &data.domain));
            let alone = values(&alone, &data.targets);
            if let Some(what) = difference(tolerance, &data.targets, &alone, part) {
                return Some(format!(
                    "a channel is not the estimate of its weights: {what}"
                ));
            }
        }
    }
    None
}

/// One point, or several at one place: refused in words, or estimated with finite values that keep what is promised.
pub fn one_place<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
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
        let one = fit!(estimator, &equal(&data.points[..1], &data.domain));
        let one = values(&one, &data.targets);
        return difference(rounding(subject, data), &data.targets, &here, &one)
            .map(|what| format!("ties are not one heavy point: {what}"));
    }
    None
}

/// Many targets at once mean the same as one after the other, on a grid and scattered, within the error that the answer states.
pub fn many_targets<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let estimate = fit!(subject.plain(), &data.sample());
    let (low, high) = span(&data.targets);
    let cells = if D == 1 { 48 } else { 7 };
    let grid = Grid::new([low; D], [high + 1.0; D], [cells; D]).unwrap();
    // no kernel is higher than 1.1 on the line; one that walls correct may be four times as high
    let height = if data.domain.has_walls() { 4.4 } else { 1.1 };
    let ceiling = (height / length(subject, &estimate, &data.points)).powi(D as i32);
    for targets in [Targets::Grid(&grid), Targets::Points(&data.targets)] {
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
pub fn far_targets<const D: usize>(subject: &Subject<D>, data: &Data<D>) -> Option<String> {
    let estimate = fit!(subject.plain(), &data.sample());
    let mut far: Vec<Point<D>> = [-1e300, -1e12, 1e12, 1e300, f64::MAX, f64::MIN]
        .map(|x| [x; D])
        .to_vec();
    if D > 1 {
        // far along one axis only
        let aside = |x: f64| -> Point<D> { std::array::from_fn(|k| if k == 0 { x } else { 0.0 }) };
        far.extend([aside(1e12), aside(-1e300)]);
    }
    let ceiling = length(subject, &estimate, &data.points)
        .recip()
        .powi(D as i32);
    far.iter()
        .zip(values(&estimate, &far))
        .find(|(_, v)| v.is_nan() || v.abs() > 1e-12 * ceiling)
        .map(|(x, v)| format!("{v} at {x:?}"))
}
