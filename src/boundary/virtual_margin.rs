//! A virtual margin: what was registered beyond the wall reaches in.

use super::within::Within;
use super::{Boundary, BoundaryError, Bump, Compute, Equivalent, Promises, one_width};
use crate::kernel::{Bandwidth, KernelSum};
use crate::sample::{Sample, Weights};
use crate::space::{Domain, Field, Point};

/// Adds the bumps of the points registered beyond the domain ([`Sample::margin`]), as far as their kernels reach in; what a kernel lays outside is still lost, and what comes in takes its place. [after Lastra, Urena,
/// Revelles & Montes 2002, who count all crossings of the tangent plane]
///
/// Where the density goes on smoothly beyond the domain (a free-standing polygon in smooth light) the estimate in the domain is that of the whole plane: bias O(h²), no trace of the edge. The estimate integrates over the
/// domain to what a kernel estimate of everything lays there, which is the mass of the sample up to O(h²) and chance. Where nothing was registered beyond (a wall, a corner of a closed room) it is [`Ignore`](super::Ignore) inside
/// the domain: half of f at an edge. So it is right exactly where something really passes.
#[derive(Clone, Copy, Debug, Default)]
pub struct VirtualMargin;

impl<const D: usize> Boundary<D> for VirtualMargin {
    fn name(&self) -> &'static str {
        "virtual-margin"
    }

    fn promises(&self) -> Promises {
        Promises {
            mass_conserving: false,
            non_negative: true,
            linear: true,
            reproduces_constants: false,
            reproduces_lines: false,
        }
    }

    fn correct(
        &self,
        sum: KernelSum<D>,
        compute: Compute<'_, D>,
    ) -> Result<Box<dyn Field<D>>, BoundaryError> {
        let domain = sum.domain().clone();
        if !domain.has_walls() {
            return Ok(compute(sum));
        }
        let sample = sum.sample();
        if sample.margin().next().is_none() {
            let field = compute(sum);
            return Ok(Box::new(Within { domain, field }));
        }
        let bump = one_width(&sum, "virtual-margin")?;
        let reach = bump.reach();
        // as far from the box around the domain as a kernel reaches
        let near = |x: &Point<D>| {
            (0..D).all(|axis| {
                x[axis] >= domain.low()[axis] - reach[axis]
                    && x[axis] <= domain.high()[axis] + reach[axis]
            })
        };
        let mut points = sample.points().to_vec();
        let mut weights: Vec<f64> = (0..points.len()).map(|i| sample.weight(i)).collect();
        for (x, weight) in sample.margin().filter(|(x, _)| near(x)) {
            points.push(x);
            weights.push(weight);
        }
        let first = weights[0];
        let weights = if weights.iter().all(|w| w.total_cmp(&first).is_eq()) {
            Weights::Equal(first)
        } else {
            Weights::Each(weights.into())
        };
        let wrap = |error: &dyn std::fmt::Display| BoundaryError(error.to_string());
        let all = Sample::new(points, weights, Domain::whole()).map_err(|error| wrap(&error))?;
        let all = KernelSum::new(all, sum.shape(), Bandwidth::Fixed(bump.width))
            .map_err(|error| wrap(&error))?
            .with_symmetry(sum.symmetry());
        let field = compute(all);
        Ok(Box::new(Within { domain, field }))
    }

    fn equivalent<'a>(
        &self,
        bump: &'a Bump<D>,
        _domain: &'a Domain<D>,
        x: Point<D>,
    ) -> Option<Equivalent<'a, D>> {
        Some(Box::new(move |y| bump.value(x, y)))
    }

    fn sees_beyond(&self) -> bool {
        true
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::boundary::{Ignore, corrected_moments};
    use crate::density::{self, Density, Window, WindowPlane};
    use crate::kernel::{Shape, Symmetry};
    use crate::random;
    use crate::sample::{Drawn, Source};
    use crate::space::{Polygon, Targets};
    use std::sync::Arc;

    /// The light of a density on a fine grid of weighted points: sums over it are integrals, to rounding where everything is smooth.
    fn lit(outline: &Polygon, with_margin: bool) -> Sample<2> {
        let light = density::named_in_plane("normal-2d").unwrap();
        let domain = Domain::inside(outline.clone());
        let step = 0.04;
        let (mut inside, mut beyond) = ((Vec::new(), Vec::new()), (Vec::new(), Vec::new()));
        for i in -100..=100 {
            for j in -100..=100 {
                let x = [step * (f64::from(i) + 0.3), step * (f64::from(j) + 0.6)];
                let side = if domain.contains(x) {
                    &mut inside
                } else {
                    &mut beyond
                };
                side.0.push(x);
                side.1.push(light.at(x) * step * step);
            }
        }
        let sample = Sample::new(inside.0, Weights::Each(inside.1.into()), domain).unwrap();
        if !with_margin {
            return sample;
        }
        let weights = Weights::Each(beyond.1.into());
        sample.with_margin(beyond.0, weights, Vec::new()).unwrap()
    }

    fn triangle() -> Polygon {
        Polygon::new(vec![[-1.0, -0.75], [1.5, -0.5], [0.25, 1.25]]).unwrap()
    }

    fn at(boundary: &dyn Boundary<2>, sample: &Sample<2>, h: f64, x: Point<2>) -> f64 {
        let sum =
            KernelSum::new(sample.clone(), Shape::Gaussian, Bandwidth::Fixed([h; 2])).unwrap();
        boundary
            .correct(sum, &|sum| Box::new(sum))
            .unwrap()
            .evaluate(Targets::Points(&[x]))
            .values[0]
    }

    /// A free-standing triangle in the light of a normal: at its corners, on its edges and inside the bias is h²/2 Δf + O(h⁴).
    #[test]
    fn a_free_standing_polygon_has_a_bias_of_second_order_everywhere() {
        let light = density::named_in_plane("normal-2d").unwrap();
        let sample = lit(&triangle(), true);
        for x in [[-1.0, -0.75], [0.25, 1.25], [0.25, -0.625], [0.2, 0.1]] {
            let bias = |h: f64| at(&VirtualMargin, &sample, h, x) - light.at(x);
            let (narrow, wide) = (bias(0.1), bias(0.2));
            let slope = (wide / narrow).abs().log2();
            assert!((slope - 2.0).abs() < 0.06, "{x:?}: {slope}");
            let leading = 0.005 * light.laplacian(x);
            assert!(
                (narrow / leading - 1.0).abs() < 0.03,
                "{x:?}: {narrow} {leading}"
            );
        }
        // a seeded fault: one in a hundred of the crossings is missed
        let x = [0.25, -0.625];
        let missed = 0.99 * at(&VirtualMargin, &sample, 0.1, x) - light.at(x);
        assert!((missed / (0.005 * light.laplacian(x)) - 1.0).abs() > 0.03);
    }

    /// Nothing beyond the edge: half of it is missing there, in the share of the angle at a corner.
    #[test]
    fn where_nothing_is_beyond_it_is_no_treatment() {
        let light = density::named_in_plane("normal-2d").unwrap();
        let sample = lit(&triangle(), false);
        for x in [[-1.0, -0.75], [0.25, -0.625], [0.2, 0.1]] {
            for h in [0.1, 0.3] {
                let (with, without) = (
                    at(&VirtualMargin, &sample, h, x),
                    at(&Ignore, &sample, h, x),
                );
                assert!((with - without).abs() < 1e-15);
            }
        }
        let edge = at(&VirtualMargin, &sample, 0.15, [0.25, -0.625]) / light.at([0.25, -0.625]);
        assert!((edge - 0.5).abs() < 0.06, "{edge}");
        assert!(at(&VirtualMargin, &sample, 0.3, [0.25, -0.9]).abs() < 1e-300);
    }

    /// Draws from a window, with what fell beside it, against the exact mean and variance.
    #[test]
    fn simulated_moments_are_the_exact_ones() {
        const SAMPLES: u64 = 2000;
        let normal = density::named("normal").unwrap();
        let truth: Arc<dyn Density<1>> = Arc::new(Window::new(normal, -0.5, 1.5).unwrap());
        let source = Drawn(truth.clone());
        let (h, draws) = (0.4, 100);
        let bump = Bump {
            shape: Shape::Epanechnikov,
            symmetry: Symmetry::Product,
            width: [h],
        };
        let places = [[-0.5], [-0.3], [0.5], [1.5]];
        let mut sums = [[0.0; 2]; 4];
        for number in 0..SAMPLES {
            let mut stream = random::stream(8, "virtual margin", number);
            let sample = source.sample(draws, &mut stream).unwrap();
            assert_eq!(sample.len(), draws);
            assert!((sample.mass() - 1.0).abs() < 1e-12);
            let sum = KernelSum::new(sample, bump.shape, Bandwidth::Fixed([h])).unwrap();
            let field = VirtualMargin.correct(sum, &|sum| Box::new(sum)).unwrap();
            for (sums, x) in sums.iter_mut().zip(&places) {
                let value = field.at(*x);
                sums[0] += value / SAMPLES as f64;
                sums[1] += value * value / SAMPLES as f64;
            }
        }
        for ([mean, square], [x]) in sums.into_iter().zip(places) {
            let exact = corrected_moments(&VirtualMargin, &bump, &*truth, draws, x).unwrap();
            let variance = square - mean * mean;
            // four places and two moments at 1e-4 in all: 4.2 standard errors; the variance has about √(2/2000)
            let error = (exact.variance / SAMPLES as f64).sqrt();
            assert!(
                (mean - exact.mean).abs() < 4.2 * error,
                "{x}: {mean} {}",
                exact.mean
            );
            let ratio = variance / exact.variance;
            assert!((ratio - 1.0).abs() < 4.2 * 0.035, "{x}: {ratio}");
            // the wall is not felt: 0.1 h² f″ at the most
            assert!((exact.mean - truth.at([x])).abs() < 0.02, "{x}");
        }
    }

    #[test]
    fn margins_are_checked_and_have_no_part_in_the_sample() {
        let sample = Sample::equal(vec![[0.2], [0.7]], Domain::unit()).unwrap();
        let with = |points: Vec<[f64; 1]>, weight| {
            let weights = Weights::Equal(weight);
            sample.clone().with_margin(points, weights, Vec::new())
        };
        let legal = with(vec![[-0.1], [1.3]], 0.5).unwrap();
        assert_eq!((legal.len(), legal.margin().count()), (2, 2));
        assert!((legal.mass() - 1.0).abs() < 1e-15);
        assert!(with(vec![[0.5]], 0.5).is_err());
        assert!(with(vec![[f64::NAN]], 0.5).is_err());
        assert!(with(vec![[-1.0]], -0.5).is_err());
        assert_eq!(with(Vec::new(), 0.5).unwrap().margin().count(), 0);
        let colours = vec![vec![0.2, 0.3], vec![0.3, 0.2]];
        let coloured = Sample::with_channels(vec![[0.2], [0.7]], colours, Domain::unit()).unwrap();
        let each = |w: f64| Weights::Equal(w);
        let coloured = coloured
            .with_margin(vec![[-0.1]], each(0.5), vec![each(0.1), each(0.4)])
            .unwrap();
        let red: Vec<_> = coloured.channel(0).margin().collect();
        assert_eq!(red, vec![([-0.1], 0.1)]);
        let per_point = KernelSum::new(
            legal,
            Shape::Biweight,
            Bandwidth::PerPoint(vec![0.1; 2].into()),
        );
        assert!(
            VirtualMargin
                .correct(per_point.unwrap(), &|sum| Box::new(sum))
                .is_err()
        );
    }

    #[test]
    fn a_window_of_the_plane_is_a_density() {
        let light = density::named_in_plane("normal-2d").unwrap();
        let window = WindowPlane::new(light, triangle()).unwrap();
        let (low, high) = window.bulk(0.0);
        assert!((window.probability(low, high) - 1.0).abs() < 1e-12);
        let halves =
            window.probability(low, [0.3, high[1]]) + window.probability([0.3, low[1]], high);
        assert!((halves - 1.0).abs() < 1e-9, "{halves}");
    }
}
