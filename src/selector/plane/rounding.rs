//! Values that were written with few digits.

use crate::sample::Sample;

/// A kernel whose deviation is below this share of the distance between neighbouring values shows the values, not a density: the ripple of an
/// even row of Gaussians is 2 exp(-2π² share²), one hundredth at a half.
const SHARE: f64 = 0.5;

/// The distances between values to which the coordinates of a sample were rounded, where so many coincide that it shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounding([Option<f64>; 2]);

impl Rounding {
    /// Looks at both axes. O(n log n).
    pub fn of(sample: &Sample<2>) -> Self {
        Self([0, 1].map(|axis| {
            let values = sample.points().iter().enumerate();
            let heavy = values.filter(|(i, _)| sample.weight(*i) > 0.0);
            step(heavy.map(|(_, x)| x[axis]).collect())
        }))
    }

    /// The first axis on which a Gaussian with deviations `h` is too narrow for the rounding there, with the distance of values.
    pub fn resolved_by(self, h: [f64; 2]) -> Option<(usize, f64)> {
        (0..2).find_map(|axis| {
            self.0[axis]
                .filter(|step| h[axis] < SHARE * step)
                .map(|step| (axis, step))
        })
    }
}

/// The lower quartile of the gaps between different values, if a quarter of the values have their like.
fn step(mut values: Vec<f64>) -> Option<f64> {
    let all = values.len();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    if values.len() < 2 || 4 * values.len() > 3 * all {
        return None;
    }
    let mut gaps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let quarter = gaps.len() / 4;
    Some(*gaps.select_nth_unstable_by(quarter, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::step;

    #[test]
    fn the_step_of_rounded_values_is_found_and_no_other() {
        let values = |n: u32| (0..n).map(|i| (f64::from(i) * 0.618_034).fract());
        assert_eq!(step(values(300).collect()), None);
        let tenths = values(300).map(|x| (x * 10.0).round() / 10.0).collect();
        assert!((step(tenths).expect("ties") - 0.1).abs() < 1e-12);
        // an outlier and one odd value do not hide it
        let odd = values(300).map(|x| (x * 40.0).round()).chain([1e6, 0.37]);
        assert!((step(odd.collect()).expect("ties") - 1.0).abs() < 1e-12);
        assert_eq!(step(vec![1.0; 9]), None);
        assert_eq!(step(vec![]), None);
    }
}
