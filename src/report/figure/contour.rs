//! Level lines of values on a grid, by marching squares.
//!
//! # References
//! Lorensen & Cline 1987, Marching Cubes (the plane is its two-dimensional case); ambiguous saddles by the mean of the four corners.

use super::path::Place;
use std::collections::BTreeMap;

/// An edge between neighbouring cell centres: the lower of the two cells, and whether the other is in the next column.
type Edge = (usize, bool);

/// The lines on which values on cells, numbered with the last of `cells` fastest, pass `level`, in units of cells: (0, 0) is the centre of
/// the first cell. Lines are closed or end at the rim; cells that are not finite are not crossed. O(cells).
pub(super) fn contours(values: &[f64], cells: [usize; 2], level: f64) -> Vec<Vec<Place>> {
    let [rows, columns] = cells;
    let mut next: BTreeMap<Edge, Vec<Edge>> = BTreeMap::new();
    let mut join = |a: Edge, b: Edge| {
        next.entry(a).or_default().push(b);
        next.entry(b).or_default().push(a);
    };
    for i in 0..rows.saturating_sub(1) {
        for j in 0..columns.saturating_sub(1) {
            let corner = i * columns + j;
            // counter-clockwise: (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
            let corners = [corner, corner + columns, corner + columns + 1, corner + 1];
            let heights = corners.map(|c| values[c]);
            if !heights.iter().all(|h| h.is_finite()) {
                continue;
            }
            let above = heights.map(|h| h > level);
            let edges: [Edge; 4] = [
                (corner, false),
                (corner + columns, true),
                (corner + 1, false),
                (corner, true),
            ];
            let crossed: Vec<usize> = (0..4).filter(|&k| above[k] != above[(k + 1) % 4]).collect();
            match crossed[..] {
                [a, b] => join(edges[a], edges[b]),
                [_, _, _, _] => {
                    let middle = heights.iter().sum::<f64>() / 4.0 > level;
                    // the two corners that are unlike the middle are cut off
                    let [a, b] = if above[0] == middle {
                        [(edges[0], edges[1]), (edges[2], edges[3])]
                    } else {
                        [(edges[3], edges[0]), (edges[1], edges[2])]
                    };
                    join(a.0, a.1);
                    join(b.0, b.1);
                }
                _ => {}
            }
        }
    }
    let place = |(cell, across): Edge| {
        let other = if across { cell + 1 } else { cell + columns };
        let (from, to) = (values[cell], values[other]);
        let t = ((level - from) / (to - from)).clamp(0.0, 1.0);
        let (i, j) = ((cell / columns) as f64, (cell % columns) as f64);
        if across { (i, j + t) } else { (i + t, j) }
    };
    let mut lines = Vec::new();
    // lines that end first, so that a start inside them is not taken for a closed one
    let ends: Vec<Edge> = next
        .iter()
        .filter(|(_, others)| others.len() == 1)
        .map(|(edge, _)| *edge)
        .chain(next.keys().copied().collect::<Vec<_>>())
        .collect();
    for start in ends {
        let mut at = start;
        let mut line = Vec::new();
        let mut first = true;
        while let Some(others) = next.get_mut(&at) {
            if first {
                line.push(place(at));
                first = false;
            }
            let Some(to) = others.pop() else { break };
            if let Some(back) = next.get_mut(&to)
                && let Some(position) = back.iter().position(|edge| *edge == at)
            {
                back.swap_remove(position);
            }
            line.push(place(to));
            at = to;
            if at == start {
                break;
            }
        }
        if line.len() > 1 {
            lines.push(line);
        }
    }
    lines
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    fn on(cells: [usize; 2], f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        (0..cells[0] * cells[1])
            .map(|c| f((c / cells[1]) as f64, (c % cells[1]) as f64))
            .collect()
    }

    #[test]
    fn a_cone_has_circles_and_a_plane_has_lines() {
        let cells = [41, 51];
        let cone = on(cells, |x, y| (x - 20.0).hypot(y - 25.0));
        let lines = contours(&cone, cells, 12.3);
        assert_eq!(lines.len(), 1);
        let circle = &lines[0];
        assert_eq!(circle.first(), circle.last());
        assert!(
            circle
                .iter()
                .all(|(x, y)| ((x - 20.0).hypot(y - 25.0) - 12.3).abs() < 0.02)
        );
        let length: f64 = circle
            .windows(2)
            .map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1))
            .sum();
        assert!(
            (length / (std::f64::consts::TAU * 12.3) - 1.0).abs() < 0.002,
            "{length}"
        );
        let slope = on(cells, |x, y| x + 2.0 * y);
        let lines = contours(&slope, cells, 40.5);
        assert_eq!(lines.len(), 1);
        assert!(
            lines[0]
                .iter()
                .all(|(x, y)| (x + 2.0 * y - 40.5).abs() < 1e-12)
        );
        let ends = [lines[0][0], *lines[0].last().expect("a line")];
        assert!(
            ends.iter()
                .all(|(x, y)| *x == 0.0 || *x == 40.0 || *y == 0.0 || *y == 50.0)
        );
    }

    #[test]
    fn saddles_gaps_and_flats_are_no_trouble() {
        let cells = [9, 9];
        let saddle = on(cells, |x, y| (x - 4.0) * (y - 4.0));
        for level in [-2.0, -0.25, 0.0, 0.25, 2.0] {
            let lines = contours(&saddle, cells, level);
            assert!((1..=4).contains(&lines.len()), "{level}: {}", lines.len());
        }
        assert!(contours(&on(cells, |_, _| 1.0), cells, 1.0).is_empty());
        let mut holed = on(cells, |x, _| x);
        holed[40] = f64::NAN;
        assert_eq!(contours(&holed, cells, 3.5).len(), 2);
        assert!(contours(&[1.0, 2.0], [1, 2], 1.5).is_empty());
    }
}
