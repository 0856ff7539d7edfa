//! What a small piece of surface receives from a polygon, in closed form.
//!
//! # References
//! Lambert 1760, Photometria; in vector form Baum, Rushmeier & Winget 1989, eq. 6: F = (1/2π) Σ Γᵢ·n, Γᵢ normal to the plane of the
//! receiver and edge i and as long as the angle under which the receiver sees the edge.

use crate::light::vector::Vector;
use std::f64::consts::TAU;

/// The share F of what leaves a small surface at `place` with the unit `normal` that a triangle or quad with these `corners` (planar, in order,
/// in either sense) would receive if nothing stood between: its irradiance is F times the radiosity of an evenly bright one. Parts below
/// the surface's horizon do not count. Which side of the polygon is meant is for the caller to know. Between 0 and 1; O(N).
pub fn seen<const N: usize>(place: Vector, normal: Vector, corners: &[Vector; N]) -> f64 {
    const {
        assert!(
            N >= 3 && N <= 4,
            "cutting at the horizon may add two corners"
        );
    };
    let mut above = [Vector::zeros(); 6];
    let mut count = 0;
    for (i, corner) in corners.iter().enumerate() {
        let (a, b) = (corner - place, corners[(i + 1) % N] - place);
        let (up, next) = (a.dot(&normal), b.dot(&normal));
        if up >= 0.0 {
            above[count] = a;
            count += 1;
        }
        if (up > 0.0 && next < 0.0) || (up < 0.0 && next > 0.0) {
            above[count] = a + (b - a) * (up / (up - next));
            count += 1;
        }
    }
    if count < 3 {
        return 0.0;
    }
    let mut sum = 0.0;
    for i in 0..count {
        let (a, b) = (above[i], above[(i + 1) % count]);
        let across = a.cross(&b);
        let size = across.norm();
        if size > 0.0 {
            sum += size.atan2(a.dot(&b)) * across.dot(&normal) / size;
        }
    }
    (sum / TAU).abs().min(1.0)
}

#[cfg(test)]
mod tests {
    use super::{Vector, seen};
    use crate::numeric::GaussLegendre;

    fn up() -> Vector {
        Vector::z()
    }

    fn corners<const N: usize>(corners: [[f64; 3]; N]) -> [Vector; N] {
        corners.map(Vector::from)
    }

    /// By quadrature of cos θ cos θ' / (π r²) over a parallelogram.
    fn summed(place: Vector, corner: Vector, a: Vector, b: Vector) -> f64 {
        let rule = GaussLegendre::new(24);
        let across = a.cross(&b);
        let mut sum = 0.0;
        for (s, weight) in rule.on(0.0, 1.0) {
            for (t, other) in rule.on(0.0, 1.0) {
                let d = corner + a * s + b * t - place;
                let square = d.norm_squared();
                sum += weight * other * d.z.max(0.0) * d.dot(&across).abs()
                    / (std::f64::consts::PI * square * square);
            }
        }
        sum
    }

    #[test]
    fn it_is_the_integral_over_the_polygon() {
        for [place, corner, a, b] in [
            corners([
                [0.1, 0.2, 0.0],
                [-0.3, -0.2, 1.0],
                [0.5, 0.0, 0.0],
                [0.0, 0.4, 0.0],
            ]),
            corners([
                [1.0, 0.0, 0.0],
                [0.0, 0.0, 0.5],
                [0.0, 1.0, 0.3],
                [0.2, 0.0, 1.0],
            ]),
        ] {
            let quad = [corner, corner + a, corner + a + b, corner + b];
            let (closed, numeric) = (seen(place, up(), &quad), summed(place, corner, a, b));
            assert!((closed - numeric).abs() < 1e-9, "{closed} {numeric}");
            let [p, q, r, s] = quad;
            let halves = seen(place, up(), &[p, q, r]) + seen(place, up(), &[s, r, p]);
            assert!(
                (closed - halves).abs() < 1e-12,
                "the sense of the corners does not matter"
            );
        }
    }

    #[test]
    fn the_horizon_cuts() {
        // a wall through the horizon: only its upper half is seen; and a ceiling without end is all there is to see
        let wall = corners([
            [1.0, -2.0, -1.0],
            [1.0, 2.0, -1.0],
            [1.0, 2.0, 1.0],
            [1.0, -2.0, 1.0],
        ]);
        let upper = corners([
            [1.0, -2.0, 0.0],
            [1.0, 2.0, 0.0],
            [1.0, 2.0, 1.0],
            [1.0, -2.0, 1.0],
        ]);
        let origin = Vector::zeros();
        assert!((seen(origin, up(), &wall) - seen(origin, up(), &upper)).abs() < 1e-14);
        let sky = corners([
            [-1e6, -1e6, 1.0],
            [1e6, -1e6, 1.0],
            [1e6, 1e6, 1.0],
            [-1e6, 1e6, 1.0],
        ]);
        assert!((seen(origin, up(), &sky) - 1.0).abs() < 1e-5);
        let below = sky.map(|corner| -corner);
        assert!(seen(origin, up(), &below).abs() < f64::MIN_POSITIVE);
        // a triangle that touches the place itself
        let touching = corners([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert!((0.0..=1.0).contains(&seen(origin, up(), &touching)));
    }
}
