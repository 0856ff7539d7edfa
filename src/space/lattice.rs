//! Rectangles of one size that cover the plane, side by side along axes that may be turned.

use super::Point;
use super::ring::clipped_to_box;

/// A lattice of rectangles with a corner at its origin, whose first axis makes an angle with that of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    widths: [f64; 2],
    origin: Point<2>,
    /// Cosine and sine of the angle.
    turn: [f64; 2],
}

impl Lattice {
    /// The lattice of rectangles with these sides, turned counter-clockwise about `origin` by an angle in degrees. Right angles are turned by
    /// without rounding, so that what lies on an edge does not move.
    pub fn new(widths: [f64; 2], origin: Point<2>, degrees: f64) -> Self {
        let degrees = degrees % 360.0;
        let quarters = degrees / 90.0;
        let turn = if quarters.fract() == 0.0 {
            [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][(quarters as i32 & 3) as usize]
        } else {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            [cosine, sine]
        };
        Self {
            widths,
            origin,
            turn,
        }
    }

    /// The sides of a rectangle, along the axes of the lattice.
    pub fn widths(&self) -> [f64; 2] {
        self.widths
    }

    /// The area of a rectangle.
    pub fn area(&self) -> f64 {
        self.widths[0] * self.widths[1]
    }

    /// Whether its axes are not those of the plane.
    pub fn is_turned(&self) -> bool {
        self.turn[0] < 0.0 || self.turn[1] != 0.0
    }

    fn along(&self, x: Point<2>) -> [f64; 2] {
        let [u, v] = [x[0] - self.origin[0], x[1] - self.origin[1]];
        let [cosine, sine] = self.turn;
        [cosine * u + sine * v, cosine * v - sine * u]
    }

    /// The numbers along both axes of the rectangle with `x`, as whole `f64`s, which stay in order far beyond the range of integers. What is on an edge
    /// belongs to the rectangle beyond it.
    pub fn number(&self, x: Point<2>) -> [f64; 2] {
        let along = self.along(x);
        [0, 1].map(|k: usize| (along[k] / self.widths[k]).floor())
    }

    /// The lower and the upper corner of a rectangle in the axes of the lattice, seen from the corner of the plane: where the lattice is not turned,
    /// the box that it is.
    pub fn edges(&self, number: [f64; 2]) -> [Point<2>; 2] {
        [0.0, 1.0]
            .map(|step| [0, 1].map(|k| (number[k] + step).mul_add(self.widths[k], self.origin[k])))
    }

    /// The box from `low` to `high` in the axes of the lattice, from its origin: the least rectangle around it.
    fn around(&self, low: Point<2>, high: Point<2>) -> [[f64; 2]; 2] {
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]].map(|x| self.along(x));
        let extreme = |pick: fn(f64, f64) -> f64| {
            [0, 1].map(|k: usize| corners.iter().map(|c| c[k]).fold(corners[0][k], pick))
        };
        [extreme(f64::min), extreme(f64::max)]
    }

    /// The numbers of the first and of the last rectangle, on both axes, among which are all that the box from `low` to `high` touches.
    pub fn numbers(&self, low: Point<2>, high: Point<2>) -> [[f64; 2]; 2] {
        self.around(low, high)
            .map(|end| [0, 1].map(|k: usize| (end[k] / self.widths[k]).floor()))
    }

    /// The part of a rectangle that lies in the finite box from `low` to `high`: its corners, counter-clockwise; fewer than three where there is none.
    pub fn within(&self, number: [f64; 2], low: Point<2>, high: Point<2>) -> Vec<Point<2>> {
        // what is beyond the box is cut first, so that rectangles beyond all numbers become places
        let around = self.around(low, high);
        let [cosine, sine] = self.turn;
        let end = |k: usize, step: f64| {
            ((number[k] + step) * self.widths[k]).clamp(around[0][k], around[1][k])
        };
        let ([a, b], [c, d]) = ([end(0, 0.0), end(0, 1.0)], [end(1, 0.0), end(1, 1.0)]);
        if a >= b || c >= d {
            return Vec::new();
        }
        let place = |[u, v]: [f64; 2]| {
            [
                cosine.mul_add(u, -sine * v) + self.origin[0],
                sine.mul_add(u, cosine * v) + self.origin[1],
            ]
        };
        let ring = [[a, c], [b, c], [b, d], [a, d]].map(place).to_vec();
        clipped_to_box(&ring, low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::polygon_moments;

    fn whole(number: [f64; 2]) -> [i32; 2] {
        number.map(|k| k as i32)
    }

    #[test]
    fn right_angles_are_turned_by_without_rounding() {
        for (degrees, along) in [
            (0.0, [3, 5]),
            (90.0, [5, -3]),
            (-90.0, [-5, 3]),
            (180.0, [-3, -5]),
            (270.0, [-5, 3]),
            (-270.0, [5, -3]),
            (360.0, [3, 5]),
            (-1080.0, [3, 5]),
        ] {
            let lattice = Lattice::new([1.0, 1.0], [1.0, 1.0], degrees);
            assert_eq!(whole(lattice.number([4.0, 6.0])), along, "{degrees}");
            assert_eq!(lattice.is_turned(), degrees % 360.0 != 0.0);
        }
    }

    /// The rectangles that touch a box cover it, without overlap, each with the places that are numbered so.
    #[test]
    fn rectangles_cover_a_box_once() {
        let (low, high) = ([-1.0, 0.5], [2.0, 1.75]);
        for degrees in [0.0, 17.0, 90.0, 133.0, -60.0] {
            let lattice = Lattice::new([0.4, 0.3], [0.1, -0.2], degrees);
            let [first, last] = lattice.numbers(low, high);
            let mut total = 0.0;
            for i in 0..=(last[0] - first[0]) as usize {
                for j in 0..=(last[1] - first[1]) as usize {
                    let number = [first[0] + i as f64, first[1] + j as f64];
                    let ring = lattice.within(number, low, high);
                    let area = polygon_moments(&ring)[0];
                    assert!(area > -1e-15 && area < 0.12 + 1e-12);
                    total += area;
                    if area > 1e-6 {
                        let middle = [0, 1].map(|k: usize| {
                            ring.iter().map(|x| x[k]).sum::<f64>() / ring.len() as f64
                        });
                        assert_eq!(whole(lattice.number(middle)), whole(number));
                    }
                }
            }
            assert!((total - 3.75).abs() < 1e-12, "{degrees}: {total}");
        }
    }

    #[test]
    fn rectangles_beyond_all_numbers_are_cut_to_the_box() {
        let lattice = Lattice::new([1e308, 1e308], [0.0, 0.0], 30.0);
        let inside = |number| polygon_moments(&lattice.within(number, [1.0, 1.0], [2.0, 2.0]))[0];
        let total: f64 = [[0.0, 0.0], [0.0, -1.0], [-1.0, 0.0], [-1.0, -1.0]]
            .into_iter()
            .map(inside)
            .sum();
        assert!((total - 1.0).abs() < 1e-12, "{total}");
        assert!(inside([5.0, 5.0]).abs() < 1e-300);
    }
}
