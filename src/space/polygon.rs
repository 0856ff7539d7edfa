//! Simple polygons in the plane: rooms that are not boxes.
//!
//! # References
//! Meisters 1975, Polygons have ears.

use super::Point;
use super::ring::{
    clip, clipped_to_box, distance_to_segment, folded, meet, moments, orientation, ring_edges,
};

/// The most vertices: checking that edges do not cross takes the square of their number.
pub const VERTEX_LIMIT: usize = 1000;

/// Why vertices do not make a polygon. Vertices are counted from 1, edge k goes from vertex k to the next one.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PolygonError {
    /// Too few vertices.
    #[error("a polygon needs at least three vertices, not {0}")]
    Few(usize),
    /// Too many vertices.
    #[error("a polygon may have at most {VERTEX_LIMIT} vertices, not {0}")]
    Many(usize),
    /// A coordinate that is NaN, infinite or so large that areas overflow.
    #[error("vertex {vertex} is at ({x}, {y}); coordinates must lie within ±1e100")]
    NotFinite {
        /// Which, from 1.
        vertex: usize,
        /// Its first coordinate.
        x: f64,
        /// Its second coordinate.
        y: f64,
    },
    /// Two vertices at one place.
    #[error(
        "vertices {first} and {second} are both at ({x}, {y}); a simple polygon passes each place once"
    )]
    Repeated {
        /// The earlier one, from 1.
        first: usize,
        /// The later one, from 1.
        second: usize,
        /// Their first coordinate.
        x: f64,
        /// Their second coordinate.
        y: f64,
    },
    /// Two edges with a point in common that is not a shared end.
    #[error(
        "edges {first} and {second} meet; the edges of a simple polygon meet only at their ends (edge k starts at vertex k)"
    )]
    Crossing {
        /// The earlier one, from 1.
        first: usize,
        /// The later one, from 1.
        second: usize,
    },
    /// All vertices on a line, or so close together that their area is lost to rounding.
    #[error("the polygon has no area")]
    Flat,
}

/// A simple polygon, its vertices counter-clockwise.
///
/// Always true: at least three vertices, all different and finite; edges meet only at shared ends; the area is positive.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    vertices: Vec<Point<2>>,
}

impl Polygon {
    /// The polygon with these vertices, in either sense. O(vertices²).
    ///
    /// # Errors
    /// If they are too few or too many, not finite, repeated or on a line, or if edges cross or touch.
    pub fn new(mut vertices: Vec<Point<2>>) -> Result<Self, PolygonError> {
        let count = vertices.len();
        if count < 3 {
            return Err(PolygonError::Few(count));
        }
        if count > VERTEX_LIMIT {
            return Err(PolygonError::Many(count));
        }
        let legal = |v: f64| v.abs() <= 1e100;
        for (k, &[x, y]) in vertices.iter().enumerate() {
            if !(legal(x) && legal(y)) {
                let vertex = k + 1;
                return Err(PolygonError::NotFinite { vertex, x, y });
            }
        }
        for (j, &b) in vertices.iter().enumerate() {
            if let Some(i) = vertices[..j]
                .iter()
                .position(|a| (0..2).all(|k| a[k] - b[k] == 0.0))
            {
                let (first, second) = (i + 1, j + 1);
                let [x, y] = b;
                return Err(PolygonError::Repeated {
                    first,
                    second,
                    x,
                    y,
                });
            }
        }
        if vertices
            .windows(3)
            .all(|three| orientation(three[0], three[1], three[2]) == 0)
        {
            return Err(PolygonError::Flat);
        }
        let edge = |k: usize| [vertices[k], vertices[(k + 1) % count]];
        for j in 1..count {
            for i in 0..j {
                let ([a, b], [c, d]) = (edge(i), edge(j));
                let crossing = if i + 1 == j {
                    folded(a, b, d)
                } else if j + 1 == count && i == 0 {
                    folded(c, d, b)
                } else {
                    meet(a, b, c, d)
                };
                if crossing {
                    return Err(PolygonError::Crossing {
                        first: i + 1,
                        second: j + 1,
                    });
                }
            }
        }
        let area = moments(&vertices)[0];
        if area < 0.0 {
            vertices.reverse();
        }
        let polygon = Self { vertices };
        let (low, high) = polygon.bounds();
        let scale = (high[0] - low[0]) * (high[1] - low[1]);
        // thinner than rounding: the area would be noise
        if area.is_finite() && area.abs() > 1e-12 * scale && area.abs() > f64::MIN_POSITIVE {
            Ok(polygon)
        } else {
            Err(PolygonError::Flat)
        }
    }

    /// The vertices, counter-clockwise.
    pub fn vertices(&self) -> &[Point<2>] {
        &self.vertices
    }

    /// The edges, each from a vertex to the next, counter-clockwise: the inside is on their left.
    pub fn edges(&self) -> impl Iterator<Item = [Point<2>; 2]> + '_ {
        ring_edges(&self.vertices)
    }

    /// The lower and the upper corner of the least box around it.
    pub fn bounds(&self) -> (Point<2>, Point<2>) {
        let mut bounds = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for vertex in &self.vertices {
            for axis in 0..2 {
                bounds.0[axis] = bounds.0[axis].min(vertex[axis]);
                bounds.1[axis] = bounds.1[axis].max(vertex[axis]);
            }
        }
        bounds
    }

    /// The area.
    pub fn area(&self) -> f64 {
        moments(&self.vertices)[0]
    }

    /// The length of the boundary.
    pub fn perimeter(&self) -> f64 {
        self.edges()
            .map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1]))
            .sum()
    }

    /// Whether `x` is inside or on an edge, without rounding. O(vertices).
    pub fn contains(&self, x: Point<2>) -> bool {
        let mut inside = false;
        for [a, b] in self.edges() {
            let [below, above] = if a[1] <= b[1] { [a, b] } else { [b, a] };
            let beside = below[1] <= x[1] && x[1] <= above[1];
            if !beside {
                continue;
            }
            let turn = orientation(below, above, x);
            if turn == 0 && a[0].min(b[0]) <= x[0] && x[0] <= a[0].max(b[0]) {
                return true;
            }
            // a ray to the right crosses the edge; its upper end does not count, so that a vertex counts once
            inside ^= x[1] < above[1] && turn > 0;
        }
        inside
    }

    /// The distance from `x` to the nearest place on the boundary. O(vertices).
    pub fn distance(&self, x: Point<2>) -> f64 {
        self.edges()
            .map(|edge| distance_to_segment(x, edge))
            .fold(f64::INFINITY, f64::min)
    }

    /// Triangles with the polygon's vertices as corners that cover it without overlap, each counter-clockwise, by cutting off ears. Corners
    /// on a straight edge give no triangle. O(vertices³) at worst, O(vertices²) for most shapes. [Meisters 1975]
    pub fn triangles(&self) -> Vec<[Point<2>; 3]> {
        let mut left: Vec<Point<2>> = self.vertices.clone();
        let mut triangles = Vec::with_capacity(left.len() - 2);
        while left.len() > 3 {
            let count = left.len();
            let corner = |k: usize| {
                [
                    left[(k + count - 1) % count],
                    left[k],
                    left[(k + 1) % count],
                ]
            };
            let straight = |k: &usize| {
                let [a, b, c] = corner(*k);
                orientation(a, b, c) == 0
            };
            let ear = |k: &usize| {
                let [a, b, c] = corner(*k);
                orientation(a, b, c) > 0
                    && (0..count - 3).all(|step| {
                        let x = left[(k + 2 + step) % count];
                        orientation(a, b, x) < 0
                            || orientation(b, c, x) < 0
                            || orientation(c, a, x) < 0
                    })
            };
            // every simple polygon has an ear, unless it is one only when straight corners are taken for none
            let Some(k) = (0..count).find(straight).or_else(|| (0..count).find(ear)) else {
                break;
            };
            let triangle = corner(k);
            if orientation(triangle[0], triangle[1], triangle[2]) > 0 {
                triangles.push(triangle);
            }
            left.remove(k);
        }
        if let &[a, b, c] = &left[..]
            && orientation(a, b, c) > 0
        {
            triangles.push([a, b, c]);
        }
        triangles
    }

    /// The part in the half-plane to the left of the line from `a` to `b`, as a ring: see [`clip`].
    pub fn clipped(&self, a: Point<2>, b: Point<2>) -> Vec<Point<2>> {
        clip(&self.vertices, a, b)
    }

    /// The part in the box from `low` to `high`, as a ring: see [`clip`]. Infinite bounds are allowed.
    pub fn within(&self, low: Point<2>, high: Point<2>) -> Vec<Point<2>> {
        // beyond the polygon a bound cuts nothing, and infinities would not be places
        let (least, greatest) = self.bounds();
        let low = [0, 1].map(|axis: usize| low[axis].clamp(least[axis], greatest[axis]));
        let high = [0, 1].map(|axis: usize| high[axis].clamp(least[axis], greatest[axis]));
        if low[0] >= high[0] || low[1] >= high[1] {
            return Vec::new();
        }
        clipped_to_box(&self.vertices, low, high)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::random::{open_unit, stream};

    fn ell() -> Polygon {
        let vertices = [
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [0.0, 2.0],
        ];
        Polygon::new(vertices.to_vec()).unwrap()
    }

    #[test]
    fn the_sense_is_made_counter_clockwise() {
        let mut vertices = ell().vertices().to_vec();
        vertices.reverse();
        let turned = Polygon::new(vertices).unwrap();
        assert!((turned.area() - 3.0).abs() < 1e-15);
        assert!((turned.perimeter() - 8.0).abs() < 1e-15);
        assert_eq!(turned.bounds(), ([0.0, 0.0], [2.0, 2.0]));
    }

    #[test]
    fn what_is_no_simple_polygon_is_refused_with_its_place() {
        let try_ = |vertices: &[Point<2>]| Polygon::new(vertices.to_vec()).unwrap_err();
        assert_eq!(try_(&[[0.0, 0.0], [1.0, 0.0]]), PolygonError::Few(2));
        assert_eq!(
            try_(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]),
            PolygonError::Flat
        );
        assert!(matches!(
            try_(&[[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0]]),
            PolygonError::NotFinite { vertex: 3, .. }
        ));
        assert!(matches!(
            try_(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]]),
            PolygonError::Repeated {
                first: 1,
                second: 4,
                ..
            }
        ));
        let crossing = |first, second| PolygonError::Crossing { first, second };
        // a bow tie
        assert_eq!(
            try_(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]),
            crossing(1, 3)
        );
        // a vertex on another edge
        assert_eq!(
            try_(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]]),
            crossing(1, 3)
        );
        // a spike that runs back over itself
        assert_eq!(
            try_(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]]),
            crossing(1, 2)
        );
        assert!(Polygon::new(vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0]]).is_ok());
    }

    #[test]
    fn containing_is_exact_on_edges_and_beside_them() {
        let polygon = ell();
        for x in [
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 1.5],
            [1.5, 1.0],
            [2.0, 0.3],
            [0.5, 0.5],
            [0.0, 2.0],
        ] {
            assert!(polygon.contains(x), "{x:?}");
        }
        for x in [
            [1.5, 1.0 + 1e-15],
            [1.0 + 1e-15, 1.5],
            [-1e-300, 1.0],
            [0.5, 2.0 + 1e-15],
            [3.0, 1.0],
            [-1.0, 1.0],
            [f64::NAN, 0.5],
        ] {
            assert!(!polygon.contains(x), "{x:?}");
        }
        // a sloping edge that passes exactly through a representable place, and the numbers next to it
        let far = 1e9;
        let slope =
            Polygon::new(vec![[far, far], [far + 3.0, far + 1.0], [far, far + 3.0]]).unwrap();
        let on = [far + 1.5, far + 0.5];
        assert!(slope.contains(on));
        assert!(!slope.contains([on[0], on[1].next_down()]));
        assert!(slope.contains([on[0], on[1].next_up()]));
    }

    #[test]
    fn area_is_the_share_of_places_inside() {
        let vertices = vec![[0.1, 0.2], [0.9, 0.05], [0.6, 0.5], [0.95, 0.9], [0.3, 0.7]];
        let polygon = Polygon::new(vertices).unwrap();
        let mut random = stream(5, "polygon", 0);
        let n = 400_000;
        let inside = (0..n)
            .filter(|_| polygon.contains([open_unit(&mut random), open_unit(&mut random)]))
            .count() as f64;
        let (share, area) = (inside / f64::from(n), polygon.area());
        let error = (area * (1.0 - area) / f64::from(n)).sqrt();
        assert!((share - area).abs() < 4.0 * error, "{share} {area}");
    }

    #[test]
    fn boxes_cut_polygons_into_parts_that_sum_to_the_whole() {
        let polygon = ell();
        let whole = moments(polygon.vertices());
        assert!((whole[1] - 2.5).abs() < 1e-14 && (whole[2] - 2.5).abs() < 1e-14);
        let cuts = [f64::NEG_INFINITY, 0.3, 0.77, 1.4, f64::INFINITY];
        let mut sum = [0.0; 3];
        for x in cuts.windows(2) {
            for y in cuts.windows(2) {
                let part = moments(&polygon.within([x[0], y[0]], [x[1], y[1]]));
                (0..3).for_each(|k| sum[k] += part[k]);
            }
        }
        for k in 0..3 {
            assert!((sum[k] - whole[k]).abs() < 1e-14, "{sum:?} {whole:?}");
        }
        // the corner that an L lacks
        assert!(moments(&polygon.within([1.0, 1.0], [2.0, 2.0]))[0].abs() < 1e-15);
        assert!(polygon.within([5.0, 5.0], [6.0, 6.0]).is_empty());
        let half = moments(&polygon.clipped([0.0, 0.0], [1.0, 1.0]))[0];
        assert!((half - 1.5).abs() < 1e-14, "{half}");
    }

    #[test]
    fn triangles_cover_the_polygon() {
        let comb: Vec<Point<2>> = (0..40)
            .map(|k| {
                [
                    f64::from(k),
                    if k % 2 == 0 {
                        0.0
                    } else {
                        3.0 + f64::from(k % 5)
                    },
                ]
            })
            .chain([[39.0, -1.0], [20.0, -1.0], [0.0, -1.0]])
            .collect();
        for polygon in [ell(), Polygon::new(comb).unwrap()] {
            let triangles = polygon.triangles();
            let sum: f64 = triangles.iter().map(|t| moments(t)[0]).sum();
            assert!((sum / polygon.area() - 1.0).abs() < 1e-14, "{sum}");
            for [a, b, c] in triangles {
                let middle = [0, 1].map(|k: usize| (a[k] + b[k] + c[k]) / 3.0);
                assert!(polygon.contains(middle));
                assert!(moments(&[a, b, c])[0] > 0.0);
            }
        }
    }

    #[test]
    fn distances_are_to_the_nearest_edge_or_vertex() {
        let polygon = ell();
        assert!((polygon.distance([0.5, 0.5]) - 0.5).abs() < 1e-15);
        assert!((polygon.distance([1.5, 1.5]) - 0.5).abs() < 1e-15);
        assert!((polygon.distance([3.0, -1.0]) - 2.0_f64.sqrt()).abs() < 1e-15);
        assert!((polygon.distance([0.9, 0.9]) - 0.02_f64.sqrt()).abs() < 1e-15);
    }
}
