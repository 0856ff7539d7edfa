//! Periodic sides: what a kernel lays beyond one comes in at the opposite one.
//!
//! Not a treatment to choose but what such a side means. Points are repeated a period on, as far as a kernel reaches, and the axis then counts as open; so the
//! mass is kept and there is no edge. Walls of the other axes are treated as asked.

use super::within::Within;
use super::{Boundary, BoundaryError, Bump, Compute};
use crate::kernel::{Bandwidth, KernelSum};
use crate::sample::{Sample, Weights};
use crate::space::{Domain, Field, Point, Side};

/// The most repetitions of a point: beyond, the bandwidth is so much wider than the period that the estimate is flat.
const MOST_IMAGES: f64 = 4096.0;

/// The field of `sum`, computed by `compute`, with what its domain says about each side: periodic ones joined, walls treated by `boundary`.
///
/// # Errors
/// As [`Boundary::correct`].
pub fn apply<const D: usize>(
    boundary: &dyn Boundary<D>,
    sum: KernelSum<D>,
    compute: Compute<'_, D>,
) -> Result<Box<dyn Field<D>>, BoundaryError> {
    if !sum.domain().wraps() {
        return boundary.correct(sum, compute);
    }
    let domain = sum.domain().clone();
    let field = boundary.correct(repeated(&sum)?, compute)?;
    Ok(Box::new(Within { domain, field }))
}

/// The sum with its points repeated, on a domain whose periodic axes go on for ever.
fn repeated<const D: usize>(sum: &KernelSum<D>) -> Result<KernelSum<D>, BoundaryError> {
    if matches!(sum.bandwidth(), Bandwidth::PerTarget(_)) {
        return Err(BoundaryError(
            "points on a periodic domain are repeated as far as their kernels reach, which a bandwidth of the target does not say".to_owned(),
        ));
    }
    let (sample, domain) = (sum.sample(), sum.domain());
    let (mut low, mut high, mut sides) = (domain.low(), domain.high(), domain.sides());
    let periods: [Option<f64>; D] = std::array::from_fn(|axis| {
        (sides[axis][0] == Side::Periodic).then(|| high[axis] - low[axis])
    });
    for axis in 0..D {
        if periods[axis].is_some() {
            (low[axis], high[axis]) = (f64::NEG_INFINITY, f64::INFINITY);
            sides[axis] = [Side::Open; 2];
        }
    }
    let open = Domain::new(low, high, sides).map_err(|error| BoundaryError(error.to_string()))?;
    let (mut points, mut origin) = (Vec::with_capacity(sample.len()), Vec::new());
    for (i, point) in sample.points().iter().enumerate() {
        let reach = Bump::of(sum, i, *point).reach();
        let mut number = 1.0;
        let along: [(i32, i32); D] = std::array::from_fn(|axis| {
            let Some(period) = periods[axis] else {
                return (0, 0);
            };
            // the images whose reach meets the domain
            let first = ((domain.low()[axis] - reach[axis] - point[axis]) / period).ceil();
            let last = ((domain.high()[axis] + reach[axis] - point[axis]) / period).floor();
            number *= last - first + 1.0;
            (first as i32, last as i32)
        });
        if number > MOST_IMAGES {
            return Err(BoundaryError(format!(
                "a bandwidth that reaches {reach:?} is so much wider than the period that each point would be repeated {number:.0} times; the estimate is flat long before"
            )));
        }
        let mut at: [i32; D] = std::array::from_fn(|axis| along[axis].0);
        'images: loop {
            points.push(std::array::from_fn(|axis| {
                periods[axis].map_or(point[axis], |period| {
                    f64::from(at[axis]).mul_add(period, point[axis])
                })
            }) as Point<D>);
            origin.push(i);
            for axis in (0..D).rev() {
                if at[axis] < along[axis].1 {
                    at[axis] += 1;
                    continue 'images;
                }
                at[axis] = along[axis].0;
            }
            break;
        }
    }
    let weights = match sample.weights() {
        Weights::Equal(weight) => Weights::Equal(*weight),
        Weights::Each(each) => Weights::Each(origin.iter().map(|i| each[*i]).collect()),
    };
    let bandwidth = match sum.bandwidth() {
        Bandwidth::PerPoint(h) => Bandwidth::PerPoint(origin.iter().map(|i| h[*i]).collect()),
        other => other.clone(),
    };
    let wrap = |error: &dyn std::fmt::Display| BoundaryError(error.to_string());
    let sample = Sample::new(points, weights, open).map_err(|error| wrap(&error))?;
    let repeated = KernelSum::new(sample, sum.shape(), bandwidth).map_err(|error| wrap(&error))?;
    Ok(repeated.with_symmetry(sum.symmetry()))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::boundary::{Ignore, Reflect};
    use crate::kernel::Shape;
    use crate::space::{Grid, Targets};

    fn ring() -> Domain<1> {
        Domain::new([0.0], [1.0], [[Side::Periodic; 2]]).unwrap()
    }

    #[test]
    fn turning_the_ring_turns_the_estimate() {
        let grid = Grid::new([0.0], [1.0], [64]).unwrap();
        for shape in [Shape::Epanechnikov, Shape::Gaussian] {
            for h in [0.03, 0.4, 1.7] {
                let field = |turn: f64| {
                    let points = [0.02, 0.3, 0.31, 0.9, 1.0].map(|x: f64| [(x + turn).fract()]);
                    let sample = Sample::equal(points.to_vec(), ring()).unwrap();
                    let sum = KernelSum::new(sample, shape, Bandwidth::Fixed([h])).unwrap();
                    apply(&Ignore, sum, &|sum| Box::new(sum)).unwrap()
                };
                let values = field(0.0).evaluate(Targets::Grid(&grid)).values;
                // by a quarter: 16 of the 64 cells
                let turned = field(0.25).evaluate(Targets::Grid(&grid)).values;
                for i in 0..64 {
                    assert!(
                        (values[i] - turned[(i + 16) % 64]).abs() < 1e-12,
                        "{shape} {h} {i}"
                    );
                }
                let mass = values.iter().sum::<f64>() / 64.0;
                assert!((mass - 1.0).abs() < 2e-2, "{shape} {h}: {mass}");
            }
        }
    }

    #[test]
    fn a_tube_is_round_on_one_axis_and_walled_on_the_other() {
        let sides = [[Side::Periodic; 2], [Side::Wall; 2]];
        let tube = Domain::new([0.0, 0.0], [2.0, 1.0], sides).unwrap();
        let points: Vec<Point<2>> = (0..40)
            .map(|i| [f64::from(i) * 0.618 % 2.0, f64::from(i) * 0.755 % 1.0])
            .collect();
        let sample = Sample::equal(points, tube).unwrap();
        let sum = KernelSum::new(sample, Shape::Biweight, Bandwidth::Fixed([0.4, 0.3])).unwrap();
        let grid = Grid::new([0.0, 0.0], [2.0, 1.0], [80, 80]).unwrap();
        let mass = |boundary: &dyn Boundary<2>| {
            apply(boundary, sum.clone(), &|sum| Box::new(sum))
                .unwrap()
                .on(&grid)
                .integral()
        };
        assert!((mass(&Reflect) - 1.0).abs() < 1e-4);
        assert!(mass(&Ignore) < 0.95);
    }

    #[test]
    fn a_bandwidth_far_beyond_the_period_is_refused() {
        let sample = Sample::equal(vec![[0.5]], ring()).unwrap();
        let sum = KernelSum::new(sample, Shape::Gaussian, Bandwidth::Fixed([1e5])).unwrap();
        let error = apply(&Ignore, sum, &|sum| Box::new(sum)).err().unwrap();
        assert!(
            error.to_string().contains("wider than the period"),
            "{error}"
        );
    }
}
