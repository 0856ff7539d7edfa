//! Polylines and areas inside a frame: cut where they leave it, thinned where the eye cannot follow.
//!
//! plotters moves points outside a drawing area onto its edge, which changes the slope of the last visible piece; so everything
//! is cut here first. All functions work in the unit square that the frame is.

/// A place in the unit square, or outside it.
pub(super) type Place = (f64, f64);

/// The pieces of a polyline inside the unit square; a non-finite point ends a piece.
pub(super) fn clip_line(points: impl IntoIterator<Item = Place>) -> Vec<Vec<Place>> {
    let mut pieces: Vec<Vec<Place>> = Vec::new();
    let mut open = false;
    let mut last: Option<Place> = None;
    for point in points {
        if !(point.0.is_finite() && point.1.is_finite()) {
            (last, open) = (None, false);
            continue;
        }
        if let Some(from) = last {
            match clip_segment(from, point) {
                Some((start, end)) => {
                    let joined =
                        open && pieces.last().and_then(|piece| piece.last()) == Some(&start);
                    match pieces.last_mut() {
                        Some(piece) if joined => piece.push(end),
                        _ => pieces.push(vec![start, end]),
                    }
                    open = end == point;
                }
                None => open = false,
            }
        }
        last = Some(point);
    }
    pieces
}

/// The part of a segment inside the unit square [Liang and Barsky 1984].
fn clip_segment(from: Place, to: Place) -> Option<(Place, Place)> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (mut enter, mut leave) = (0.0, 1.0);
    for (direction, room) in [
        (-dx, from.0),
        (dx, 1.0 - from.0),
        (-dy, from.1),
        (dy, 1.0 - from.1),
    ] {
        if direction == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else {
            let at = room / direction;
            if direction < 0.0 {
                enter = f64::max(enter, at);
            } else {
                leave = f64::min(leave, at);
            }
        }
    }
    let at = |t: f64| (from.0 + t * dx, from.1 + t * dy);
    // The end points themselves, not their rounded images, so that neighbouring segments join.
    let start = if enter > 0.0 { at(enter) } else { from };
    let end = if leave < 1.0 { at(leave) } else { to };
    (enter <= leave).then_some((start, end))
}

/// A polygon cut to the unit square [Sutherland and Hodgman 1974]; non-finite corners are the caller's to remove.
pub(super) fn clip_polygon(corners: Vec<Place>) -> Vec<Place> {
    // Each side as a signed distance, positive inside.
    let sides: [fn(Place) -> f64; 4] = [|p| p.0, |p| 1.0 - p.0, |p| p.1, |p| 1.0 - p.1];
    sides.iter().fold(corners, |corners, inside| {
        let mut kept = Vec::with_capacity(corners.len() + 4);
        for (index, &to) in corners.iter().enumerate() {
            let from = corners[(index + corners.len() - 1) % corners.len()];
            let (a, b) = (inside(from), inside(to));
            if (a < 0.0) != (b < 0.0) {
                let t = a / (a - b);
                kept.push((from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1)));
            }
            if b >= 0.0 {
                kept.push(to);
            }
        }
        kept
    })
}

/// `points` without those closer than `tolerance` to the line through their kept neighbours [Douglas and Peucker 1973].
///
/// `size` is the frame in the units of `tolerance`. Expected cost O(n log n).
pub(super) fn thin(points: &[Place], size: (f64, f64), tolerance: f64) -> Vec<Place> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut keep = vec![false; points.len()];
    keep[0] = true;
    keep[points.len() - 1] = true;
    let mut pending = vec![(0, points.len() - 1)];
    while let Some((first, last)) = pending.pop() {
        let (a, b) = (points[first], points[last]);
        let (dx, dy) = ((b.0 - a.0) * size.0, (b.1 - a.1) * size.1);
        let length = dx.hypot(dy);
        let mut farthest = (0.0, first);
        for (index, point) in points.iter().enumerate().take(last).skip(first + 1) {
            let (px, py) = ((point.0 - a.0) * size.0, (point.1 - a.1) * size.1);
            let distance = if length > 0.0 {
                (px * dy - py * dx).abs() / length
            } else {
                px.hypot(py)
            };
            if distance > farthest.0 {
                farthest = (distance, index);
            }
        }
        if farthest.0 > tolerance {
            keep[farthest.1] = true;
            pending.push((first, farthest.1));
            pending.push((farthest.1, last));
        }
    }
    points
        .iter()
        .zip(keep)
        .filter_map(|(&point, kept)| kept.then_some(point))
        .collect()
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn a_line_keeps_its_slope_where_it_leaves_the_frame() {
        let pieces = clip_line([(0.0, 0.5), (0.5, 1.5), (1.0, 0.5)]);
        assert_eq!(
            pieces,
            vec![vec![(0.0, 0.5), (0.25, 1.0)], vec![(0.75, 1.0), (1.0, 0.5)]]
        );
    }

    #[test]
    fn gaps_and_outsiders_split_a_line() {
        let line = [
            (0.1, 0.1),
            (0.2, 0.2),
            (f64::NAN, 0.3),
            (0.4, 0.4),
            (0.5, 0.5),
            (0.6, f64::INFINITY),
            (2.0, 2.0),
            (3.0, 2.0),
        ];
        assert_eq!(
            clip_line(line),
            vec![vec![(0.1, 0.1), (0.2, 0.2)], vec![(0.4, 0.4), (0.5, 0.5)]]
        );
        assert!(clip_line([(0.5, 0.5)]).is_empty());
    }

    #[test]
    fn a_polygon_is_cut_at_the_sides() {
        let cut = clip_polygon(vec![(-1.0, 0.0), (0.5, 1.5), (2.0, 0.0)]);
        assert!(
            cut.iter()
                .all(|&(x, y)| (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y))
        );
        let area: f64 = (0..cut.len())
            .map(|i| {
                let ((x, y), (u, v)) = (cut[i], cut[(i + 1) % cut.len()]);
                0.5 * (x * v - u * y)
            })
            .sum();
        assert!(
            (area.abs() - 1.0).abs() < 1e-12,
            "the triangle covers the square: {area}"
        );
        assert!(clip_polygon(vec![(2.0, 2.0), (3.0, 2.0), (3.0, 3.0)]).is_empty());
    }

    #[test]
    fn thinning_moves_a_curve_by_no_more_than_the_tolerance() {
        let curve: Vec<Place> = (0..=2000)
            .map(|i| {
                let x = f64::from(i) / 2000.0;
                (x, 0.5 + 0.4 * (9.0 * x).sin())
            })
            .collect();
        let size = (600.0, 300.0);
        let thinned = thin(&curve, size, 0.05);
        assert!(
            thinned.len() < 400 && thinned[0] == curve[0] && thinned.last() == curve.last(),
            "{}",
            thinned.len()
        );
        let mut next = 0;
        for &(x, y) in &curve {
            while thinned[next + 1].0 < x {
                next += 1;
            }
            let ((a, fa), (b, fb)) = (thinned[next], thinned[next + 1]);
            let slope = (fb - fa) * size.1 / ((b - a) * size.0);
            let off = (fa + (fb - fa) * (x - a) / (b - a) - y).abs() * size.1 / slope.hypot(1.0);
            assert!(off <= 0.0501, "{off} pixels at {x}");
        }
    }
}
