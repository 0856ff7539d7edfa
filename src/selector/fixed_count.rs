//! As many points in the support as one says, if they were even: knows the area and the number of points, nothing else.
//!
//! h = √(C A / (n π)) for a disc, h = C L / (2n) on a line of length L. The noise of an estimate with it does not depend on n, only its bias falls: relative variance 4/(3C) for Epanechnikov's kernel, 1/C for
//! a disc. Consistent only if C grows with n.
//!
//! # References
//! Shirley, Wade, Hubbard, Zareski, Walter & Greenberg 1995, Global illumination via density-estimation; Walter 1998, thesis, section 4.3.

use super::{SelectError, Selection, Selector};
use crate::kernel::{Bandwidth, Kernel, Shape, Symmetry};
use crate::sample::Sample;

/// The rule with its count, for kernels of the line and of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedCount {
    count: f64,
    symmetry: Symmetry,
}

impl FixedCount {
    /// Its name in files.
    pub const NAME: &'static str = "walter";
    /// The count where none is given.
    pub const DEFAULT: f64 = 20.0;

    /// The rule that expects `count` points (above 0) in the support of a kernel.
    pub fn new(count: f64, symmetry: Symmetry) -> Self {
        Self { count, symmetry }
    }
}

/// The length or area in which points lie: that of the domain or, where it has no end, of the least box around all points with a weight.
fn extent<const D: usize>(sample: &Sample<D>) -> Result<f64, SelectError> {
    let measure = sample.domain().measure();
    if measure.is_finite() {
        return Ok(measure);
    }
    let mut box_of_points = 1.0;
    for axis in 0..D {
        let weighed = (0..sample.len()).filter(|&i| sample.weight(i) > 0.0);
        let (low, high) = weighed.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), i| {
            let x = sample.points()[i][axis];
            (low.min(x), high.max(x))
        });
        box_of_points *= high - low;
    }
    if box_of_points > 0.0 && box_of_points.is_finite() {
        return Ok(box_of_points);
    }
    Err(SelectError::NoSpread {
        points: sample.len(),
        place: sample.points()[0][0],
    })
}

impl Selector<1> for FixedCount {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    /// h = C L / (2n); the Gaussian gets the width that smooths as much as Epanechnikov's kernel.
    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        let half = 0.5 * self.count * extent(sample)? / sample.effective_size();
        let h = match shape {
            Shape::Gaussian => {
                half * shape.canonical_scale() / Shape::Epanechnikov.canonical_scale()
            }
            _ => half,
        };
        Ok(Selection::new(h, Vec::new()))
    }
}

impl Selector<2> for FixedCount {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    /// The Gaussian, which has no support, gets the width that smooths as much as the radial Epanechnikov kernel's.
    fn select(&self, sample: &Sample<2>, shape: Shape) -> Result<Selection<2>, SelectError> {
        // the area of the support, which at widths of 1 is a disc or a square
        let support = self.count * extent(sample)? / sample.effective_size();
        let disc = (support / std::f64::consts::PI).sqrt();
        let h = match (shape, self.symmetry) {
            (Shape::Gaussian, _) => {
                disc * Symmetry::Radial.canonical_scale::<2>(Shape::Gaussian)
                    / Symmetry::Radial.canonical_scale::<2>(Shape::Epanechnikov)
            }
            (_, Symmetry::Radial) => disc,
            (_, Symmetry::Product) => 0.5 * support.sqrt(),
        };
        Ok(Selection {
            bandwidth: Bandwidth::Fixed([h; 2]),
            warnings: Vec::new(),
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::space::Domain;

    fn chosen(symmetry: Symmetry, shape: Shape, domain: Domain<2>, n: usize) -> f64 {
        let points = (0..n).map(|i| [0.5, i as f64 / n as f64]).collect();
        let sample = Sample::equal(points, domain).unwrap();
        let rule = FixedCount::new(20.0, symmetry);
        match rule.select(&sample, shape).unwrap().bandwidth {
            Bandwidth::Fixed([h, k]) if h.total_cmp(&k).is_eq() => h,
            other => panic!("one number, not {other:?}"),
        }
    }

    #[test]
    fn the_support_holds_the_count_of_an_even_sample() {
        let room = || Domain::walled([0.0, 0.0], [2.0, 3.0]).unwrap();
        let h = chosen(Symmetry::Radial, Shape::Epanechnikov, room(), 600);
        let expected = std::f64::consts::PI * h * h / 6.0 * 600.0;
        assert!((expected - 20.0).abs() < 1e-12, "{expected}");
        let h = chosen(Symmetry::Product, Shape::Uniform, room(), 600);
        assert!((4.0 * h * h / 6.0 * 600.0 - 20.0).abs() < 1e-12);
        let triangle = Domain::polygon(vec![[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]]).unwrap();
        let points = vec![[0.5, 0.5]; 40];
        let sample = Sample::equal(points, triangle).unwrap();
        let rule = FixedCount::new(10.0, Symmetry::Radial);
        let Bandwidth::Fixed([h, _]) = rule.select(&sample, Shape::Biweight).unwrap().bandwidth
        else {
            panic!("one number")
        };
        assert!((std::f64::consts::PI * h * h - 0.125).abs() < 1e-12);
        // and the Gaussian smooths as much: its deviation is well below the radius
        let ratio = chosen(Symmetry::Radial, Shape::Gaussian, room(), 600)
            / chosen(Symmetry::Radial, Shape::Epanechnikov, room(), 600);
        assert!(
            (ratio - (1.0 / 192.0_f64).powf(1.0 / 6.0)).abs() < 1e-12,
            "{ratio}"
        );
    }

    #[test]
    fn without_walls_the_box_of_the_points_is_the_area() {
        let rule = FixedCount::new(3.0, Symmetry::Product);
        let points = vec![[0.0, 1.0], [2.0, 5.0], [1.0, 1.0]];
        let sample = Sample::equal(points, Domain::whole()).unwrap();
        let chosen: Selection<2> = rule.select(&sample, Shape::Uniform).unwrap();
        let Bandwidth::Fixed([h, _]) = chosen.bandwidth else {
            panic!("one number")
        };
        // three of three points in a square of the whole area, 8
        assert!((4.0 * h * h - 8.0).abs() < 1e-12, "{h}");
        let line = Sample::equal(vec![[0.0], [1.0], [4.0]], Domain::whole()).unwrap();
        let chosen: Selection<1> = rule.select(&line, Shape::Uniform).unwrap();
        let Bandwidth::Fixed([h]) = chosen.bandwidth else {
            panic!("one number")
        };
        assert!((2.0 * h - 4.0).abs() < 1e-12, "{h}");
        let one = Sample::equal(vec![[0.0, 0.0]], Domain::whole()).unwrap();
        let refused = Selector::<2>::select(&rule, &one, Shape::Gaussian);
        assert!(matches!(refused, Err(SelectError::NoSpread { .. })));
    }
}
