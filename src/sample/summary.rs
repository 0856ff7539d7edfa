//! What one looks at before estimating: centre, spread, quantiles, ties. Weighted throughout.

use super::Sample;
use crate::numeric::Sum;

/// A summary of a sample on a line.
///
/// Quantiles are those of the weighted empirical distribution with linear interpolation between order statistics (for equal weights Hyndman
/// & Fan 1996, type 7, the default of R and NumPy). The deviation divides by 1 - Σw²/(Σw)², which is the usual n - 1 for equal weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// The smallest coordinate.
    pub least: f64,
    /// The largest coordinate.
    pub most: f64,
    /// The weighted mean.
    pub mean: f64,
    /// The weighted standard deviation; 0 for a single point.
    pub deviation: f64,
    /// The first quartile, the median, the third quartile.
    pub quartiles: [f64; 3],
    /// The distance between the first and the third quartile, with more digits than the quartiles themselves have far from zero.
    pub interquartile_range: f64,
    /// Points that share their place with an earlier one.
    pub ties: usize,
    /// (Σw)²/Σw².
    pub effective_size: f64,
}

impl Summary {
    /// Summarises `sample`. O(n log n), for the quantiles and ties.
    pub fn of(sample: &Sample<1>) -> Self {
        let x = sample.coordinates();
        let mass = sample.mass();
        // a point of weight zero may be anywhere, and a far centre costs digits
        let centre = (0..x.len())
            .find(|&i| sample.weight(i) > 0.0)
            .map_or(0.0, |i| x[i]);
        let first: Sum = x
            .iter()
            .enumerate()
            .map(|(i, x)| sample.weight(i) * (x - centre))
            .collect();
        let mean = centre + first.value() / mass;
        let second: Sum = x
            .iter()
            .enumerate()
            .map(|(i, x)| sample.weight(i) * (x - mean).powi(2))
            .collect();
        let freedom = 1.0 - 1.0 / sample.effective_size();
        let deviation = if freedom > 0.0 {
            (second.value() / mass / freedom).sqrt()
        } else {
            0.0
        };

        let mut order: Vec<(f64, f64)> = x
            .iter()
            .enumerate()
            .map(|(i, &x)| (x, sample.weight(i)))
            .filter(|&(_, w)| w > 0.0)
            .collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        #[expect(clippy::float_cmp, reason = "ties are equal numbers, nothing less")]
        let ties = order
            .windows(2)
            .filter(|pair| pair[0].0 == pair[1].0)
            .count();
        let quartiles = [0.25, 0.5, 0.75].map(|p| quantile(&order, p));
        Self {
            least: order[0].0,
            most: order[order.len() - 1].0,
            mean,
            deviation,
            quartiles: quartiles.map(|(below, beyond)| below + beyond),
            interquartile_range: (quartiles[2].0 - quartiles[0].0)
                + (quartiles[2].1 - quartiles[0].1),
            ties,
            effective_size: sample.effective_size(),
        }
    }
}

/// The p-quantile of ordered (place, weight) pairs: the order statistic i sits at (Σ_{j<i} wⱼ) / (Σw - w̄ᵢ) of the way, so
/// that equal weights give (i - 1)/(n - 1); in between, linear. Given as the order statistic below it and the
/// distance from that one.
fn quantile(order: &[(f64, f64)], p: f64) -> (f64, f64) {
    let total: f64 = order.iter().map(|&(_, w)| w).sum();
    // each order statistic at the middle of its weight, stretched so that the first is at 0 and the last at 1
    let (first, last) = (0.5 * order[0].1, total - 0.5 * order[order.len() - 1].1);
    if last <= first {
        return (order[0].0, 0.0);
    }
    let wanted = p.mul_add(last - first, first);
    let mut below = 0.0;
    let mut previous = (order[0].0, first);
    for &(x, w) in order {
        let middle = 0.5f64.mul_add(w, below);
        if middle >= wanted {
            let gap = middle - previous.1;
            return if gap > 0.0 {
                (previous.0, (x - previous.0) * ((wanted - previous.1) / gap))
            } else {
                (x, 0.0)
            };
        }
        previous = (x, middle);
        below += w;
    }
    (order[order.len() - 1].0, 0.0)
}

#[cfg(test)]
mod tests {
    use super::Summary;
    use crate::sample::Sample;
    use crate::space::Domain;

    fn sample(points: &[f64]) -> Sample<1> {
        Sample::equal(points.iter().map(|&x| [x]).collect(), Domain::whole()).expect("legal")
    }

    #[test]
    fn quartiles_are_those_of_type_seven() {
        let summary = Summary::of(&sample(&[7.0, 1.0, 2.0, 4.0]));
        // R: quantile(c(1, 2, 4, 7)) = 1, 1.75, 3, 4.75, 7
        let expected = [1.75, 3.0, 4.75];
        for (got, wanted) in summary.quartiles.iter().zip(expected) {
            assert!((got - wanted).abs() < 1e-14, "{summary:?}");
        }
        assert!(
            (summary.deviation - 7.0_f64.sqrt()).abs() < 1e-14,
            "{summary:?}"
        );
    }

    #[test]
    fn zero_weights_are_invisible() {
        let domain = Domain::whole();
        let weighted = Sample::normalised(
            vec![[1.0], [2.0], [4.0], [7.0], [99.0]],
            vec![1.0, 1.0, 1.0, 1.0, 0.0],
            domain,
        );
        let (with, without) = (
            Summary::of(&weighted.expect("legal")),
            Summary::of(&sample(&[1.0, 2.0, 4.0, 7.0])),
        );
        assert!((with.mean - without.mean).abs() < 1e-14);
        assert!((with.deviation - without.deviation).abs() < 1e-14);
        assert!((with.most - 7.0).abs() < 1e-14);
    }

    #[test]
    fn a_distant_origin_costs_no_digits() {
        let near = Summary::of(&sample(&[1.0, 2.0, 4.0, 7.0]));
        let far = Summary::of(&sample(&[1e9 + 1.0, 1e9 + 2.0, 1e9 + 4.0, 1e9 + 7.0]));
        assert!((near.deviation - far.deviation).abs() < 1e-12);
    }

    #[test]
    fn one_point_has_no_spread() {
        let summary = Summary::of(&sample(&[3.0]));
        assert!(
            summary.deviation.abs() < f64::MIN_POSITIVE
                && summary.interquartile_range.abs() < f64::MIN_POSITIVE
        );
    }
}
