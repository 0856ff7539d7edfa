//! Form factors of rectangles in closed form: what the numerical ones are judged by.
//!
//! # References
//! Hamilton & Morgan 1952, Radiant-interchange configuration factors, NACA TN 2836; Howell's catalogue, C-11 and C-14.

use std::f64::consts::PI;

/// The share of what leaves a rectangle a × b that an equal one, `distance` in front of it, receives.
pub fn parallel(a: f64, b: f64, distance: f64) -> f64 {
    let (x, y) = (a / distance, b / distance);
    let (xx, yy) = (x.mul_add(x, 1.0), y.mul_add(y, 1.0));
    let logarithm = 0.5 * (xx * yy / y.mul_add(y, xx)).ln();
    let sides = x * yy.sqrt() * (x / yy.sqrt()).atan() + y * xx.sqrt() * (y / xx.sqrt()).atan();
    2.0 / (PI * x * y) * (logarithm + sides - x * x.atan() - y * y.atan())
}

/// The share of what leaves a rectangle of the given `width` that another, of `height`, receives when they meet at a right angle in an edge
/// of length `edge` common to both.
pub fn perpendicular(width: f64, height: f64, edge: f64) -> f64 {
    let (w, h) = (width / edge, height / edge);
    let (ww, hh) = (w * w, h * h);
    let both = (ww + hh).sqrt();
    let angles = w * (1.0 / w).atan() + h * (1.0 / h).atan() - both * (1.0 / both).atan();
    let all = 1.0 + ww + hh;
    let logarithm = ((1.0 + ww) * (1.0 + hh) / all).ln()
        + ww * (ww * all / ((1.0 + ww) * (ww + hh))).ln()
        + hh * (hh * all / ((1.0 + hh) * (hh + ww))).ln();
    (angles + 0.25 * logarithm) / (PI * w)
}

#[cfg(test)]
mod tests {
    use super::{parallel, perpendicular};

    #[test]
    fn a_cube_sees_itself_all_round() {
        let (opposite, beside) = (parallel(1.0, 1.0, 1.0), perpendicular(1.0, 1.0, 1.0));
        assert!((opposite - 0.199_825).abs() < 5e-7, "{opposite}");
        assert!((beside - 0.200_044).abs() < 5e-7, "{beside}");
        assert!((opposite + 4.0 * beside - 1.0).abs() < 1e-13);
        // a box that is not a cube: 2 × 3 floor, 5 high
        let all = parallel(2.0, 3.0, 5.0)
            + 2.0 * perpendicular(2.0, 5.0, 3.0)
            + 2.0 * perpendicular(3.0, 5.0, 2.0);
        assert!((all - 1.0).abs() < 1e-13, "{all}");
    }
}
