//! Mirrored points beyond the walls.
//!
//! On a box every point gets its images in both walls of each axis and, as walls reflect each other, the images of images as far as a kernel reaches; corners follow, as
//! axes multiply. So the estimate is the kernel sum of a density that goes on in mirrors: it keeps its mass and has no slope at
//! a wall. On other polygons that is not possible: a point is mirrored in each edge onto which it falls square, and in each right-angled corner; mass and uniform
//! densities are then kept along edges but only roughly near other corners.

use super::moments::walls;
use super::within::Within;
use super::{Boundary, BoundaryError, Bump, Compute, Equivalent, Promises};
use crate::kernel::{Bandwidth, KernelSum};
use crate::sample::{Sample, Weights};
use crate::space::{Domain, Field, Point, Polygon};

/// Adds mirrored points. [Silverman 1986, section 2.10; Schuster 1985] Bias O(h) where the density has a slope at the wall.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reflect;

/// The most images that a point may have: beyond, the bandwidth is so much wider than the domain that the estimate is flat.
const MOST_IMAGES: f64 = 4096.0;

impl<const D: usize> Boundary<D> for Reflect {
    fn name(&self) -> &'static str {
        "reflect"
    }

    fn promises(&self) -> Promises {
        Promises {
            mass_conserving: true,
            non_negative: true,
            linear: true,
            reproduces_constants: true,
            reproduces_lines: false,
        }
    }

    fn correct(
        &self,
        sum: KernelSum<D>,
        compute: Compute<'_, D>,
    ) -> Result<Box<dyn Field<D>>, BoundaryError> {
        let sample = sum.sample();
        let domain = sample.domain().clone();
        if !domain.has_walls() {
            return Ok(compute(sum));
        }
        if matches!(sum.bandwidth(), Bandwidth::PerTarget(_)) {
            return Err(BoundaryError(
                "the boundary \"reflect\" mirrors points as far as their kernels reach, which a bandwidth of the target does not say; use ignore".to_owned(),
            ));
        }
        let mut points = sample.points().to_vec();
        let mut origin = Vec::new();
        for (i, point) in sample.points().iter().enumerate() {
            let bump = Bump::of(&sum, i, *point);
            check_number(&bump, &domain)?;
            images(&bump, &domain, *point, |image| {
                points.push(image);
                origin.push(i);
            });
        }
        let sources = (0..sample.len()).chain(origin);
        let weights = match sample.weights() {
            Weights::Equal(weight) => Weights::Equal(*weight),
            Weights::Each(each) => Weights::Each(sources.clone().map(|i| each[i]).collect()),
        };
        let bandwidth = match sum.bandwidth() {
            Bandwidth::PerPoint(h) => Bandwidth::PerPoint(sources.map(|i| h[i]).collect()),
            other => other.clone(),
        };
        let mirrored = Sample::new(points, weights, Domain::whole())
            .map_err(|error| BoundaryError(error.to_string()))?;
        let sum = KernelSum::new(mirrored, sum.shape(), bandwidth)
            .map_err(|error| BoundaryError(error.to_string()))?
            .with_symmetry(sum.symmetry());
        Ok(Box::new(Within {
            domain,
            field: compute(sum),
        }))
    }

    /// On boxes and convex polygons an image lies farther from the target than its point. Across an inward corner it may be nearer: an image lies up to two reaches from its point, as
    /// that lies within one of the edge, and up to four where it is mirrored in an outward right corner, within two of it; and an image is felt from one reach.
    fn reaches(&self, domain: &Domain<D>) -> f64 {
        let Some(outline) = domain.outline() else {
            return 1.0;
        };
        let edges: Vec<[Point<2>; 2]> = outline.edges().collect();
        let corners = || (0..edges.len()).map(|i| (edges[i], edges[(i + 1) % edges.len()]));
        let inward = |([a, b], [_, c]): ([Point<2>; 2], [Point<2>; 2])| {
            (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) < 0.0
        };
        if !corners().any(inward) {
            1.0
        } else if corners().any(|(before, after)| is_right(before, after)) {
            5.0
        } else {
            3.0
        }
    }

    fn equivalent<'a>(
        &self,
        bump: &'a Bump<D>,
        domain: &'a Domain<D>,
        x: Point<D>,
    ) -> Option<Equivalent<'a, D>> {
        Some(Box::new(move |y| {
            let mut total = bump.value(x, y);
            images(bump, domain, y, |image| total += bump.value(x, image));
            total
        }))
    }
}

fn check_number<const D: usize>(bump: &Bump<D>, domain: &Domain<D>) -> Result<(), BoundaryError> {
    let mut number = 1.0;
    for (axis, reach) in bump.reach().into_iter().enumerate() {
        let [low, high] = walls(domain, axis);
        number *= 2.0 * (reach / (high - low)).ceil() + 1.0;
    }
    if number <= MOST_IMAGES || domain.outline().is_some() {
        return Ok(());
    }
    Err(BoundaryError(format!(
        "a bandwidth of {:?} is so much wider than the domain that each point would have some {number:.0} mirror images; the estimate is flat long before",
        bump.width
    )))
}

/// All images of `point` beyond the walls whose kernels reach into the domain.
fn images<const D: usize>(
    bump: &Bump<D>,
    domain: &Domain<D>,
    point: Point<D>,
    mut give: impl FnMut(Point<D>),
) {
    let reach = bump.reach();
    if let (Some(outline), &[x, y]) = (domain.outline(), &point[..]) {
        let farthest = reach.iter().copied().fold(0.0, f64::max);
        in_outline(outline, [x, y], farthest, |image| {
            give(std::array::from_fn(|axis| image[axis]));
        });
        return;
    }
    let along: [Vec<f64>; D] =
        std::array::from_fn(|axis| on_axis(walls(domain, axis), reach[axis], point[axis]));
    let mut at = [0; D];
    loop {
        // the first of each axis is the point itself
        if at.iter().any(|i| *i > 0) {
            give(std::array::from_fn(|axis| along[axis][at[axis]]));
        }
        let Some(axis) = (0..D).rev().find(|axis| at[*axis] + 1 < along[*axis].len()) else {
            return;
        };
        at[axis] += 1;
        at[axis + 1..].fill(0);
    }
}

/// `x` and its images in one or two walls, as far as `reach` beyond them.
fn on_axis([low, high]: [f64; 2], reach: f64, x: f64) -> Vec<f64> {
    let mut images = vec![x];
    let mut near = |image: f64| {
        let felt = image > low - reach && image < high + reach;
        if felt {
            images.push(image);
        }
        felt
    };
    match (low.is_finite(), high.is_finite()) {
        (false, false) => {}
        (true, false) => {
            near(2.0 * low - x);
        }
        (false, true) => {
            near(2.0 * high - x);
        }
        (true, true) => {
            let period = 2.0 * (high - low);
            // outwards until neither side is felt any more; at first always, as an image in one wall may be felt where the other is not
            for k in 0.. {
                let shift = f64::from(k) * period;
                let mut felt = near(2.0 * low - x - shift) | near(2.0 * high - x + shift);
                if k > 0 {
                    felt |= near(x - shift) | near(x + shift);
                }
                if !felt && shift > reach {
                    break;
                }
            }
        }
    }
    images
}

/// Whether the corner between two edges that follow each other is an outward one of a right angle.
fn is_right([a, b]: [Point<2>; 2], [_, c]: [Point<2>; 2]) -> bool {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
    let cosine = (d[0] * e[0] + d[1] * e[1]) / (d[0].hypot(d[1]) * e[0].hypot(e[1]));
    d[0] * e[1] - d[1] * e[0] > 0.0 && cosine.abs() < 1e-9
}

/// Images in the edges onto which the point falls square, and in right-angled corners.
fn in_outline(outline: &Polygon, x: Point<2>, reach: f64, mut give: impl FnMut(Point<2>)) {
    let mut outside = |image: Point<2>| {
        if !outline.contains(image) {
            give(image);
        }
    };
    let edges: Vec<[Point<2>; 2]> = outline.edges().collect();
    for (i, [a, b]) in edges.iter().enumerate() {
        let d = [b[0] - a[0], b[1] - a[1]];
        let square = d[0] * d[0] + d[1] * d[1];
        let along = ((x[0] - a[0]) * d[0] + (x[1] - a[1]) * d[1]) / square;
        let foot = [along.mul_add(d[0], a[0]), along.mul_add(d[1], a[1])];
        let distance = (x[0] - foot[0]).hypot(x[1] - foot[1]);
        if (0.0..=1.0).contains(&along) && distance < reach {
            outside([2.0 * foot[0] - x[0], 2.0 * foot[1] - x[1]]);
        }
        // the corner at b
        let next = edges[(i + 1) % edges.len()];
        if is_right([*a, *b], next) && (x[0] - b[0]).hypot(x[1] - b[1]) < 2.0 * reach {
            outside([2.0 * b[0] - x[0], 2.0 * b[1] - x[1]]);
        }
    }
}
