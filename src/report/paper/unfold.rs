//! Flat pieces of surfaces in space, hinged at their common edges and laid into one plane.

/// A rectangle in space: where the origin of its chart lies, the directions of both axes, and the chart's corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Origin, first axis, second axis; the axes of length 1 and perpendicular.
    pub(super) frame: [[f64; 3]; 3],
    /// The lower corner of the chart.
    pub(super) low: [f64; 2],
    /// The upper corner.
    pub(super) high: [f64; 2],
}

/// Where a face lies on the paper: chart (u, v) → origin + u·first + v·second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    origin: [f64; 2],
    first: [f64; 2],
    second: [f64; 2],
}

/// How far apart corners may be, as a share of the size of a face, and still be one: measured rooms have no exact corners.
const SLACK: f64 = 0.03;

impl Face {
    fn corners(&self) -> [[f64; 2]; 4] {
        let [[a, b], [c, d]] = [self.low, self.high];
        [[a, b], [c, b], [c, d], [a, d]]
    }

    fn middle(&self) -> [f64; 2] {
        [0, 1].map(|k: usize| 0.5 * (self.low[k] + self.high[k]))
    }

    fn size(&self) -> f64 {
        (0..2)
            .map(|k| self.high[k] - self.low[k])
            .fold(0.0, f64::max)
    }

    fn in_space(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let [origin, first, second] = self.frame;
        [0, 1, 2].map(|k: usize| origin[k] + u * first[k] + v * second[k])
    }
}

impl Placed {
    /// Where a point of the chart lies.
    pub(super) fn place(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k: usize| self.origin[k] + u * self.first[k] + v * self.second[k])
    }

    /// The point of the chart that lies at a place.
    pub(super) fn chart(&self, place: [f64; 2]) -> [f64; 2] {
        let off = [place[0] - self.origin[0], place[1] - self.origin[1]];
        [self.first, self.second].map(|axis| off[0] * axis[0] + off[1] * axis[1])
    }

    /// The lower and the upper corner of what a face covers.
    pub(super) fn bounds(&self, face: &Face) -> [[f64; 2]; 2] {
        let corners = face.corners().map(|corner| self.place(corner));
        let over = |pick: fn(f64, f64) -> f64, start: f64| {
            [0, 1].map(|k: usize| corners.iter().map(|c| c[k]).fold(start, pick))
        };
        [
            over(f64::min, f64::INFINITY),
            over(f64::max, f64::NEG_INFINITY),
        ]
    }

    /// The face `next` beside the face `here`, turned about their common edge, if they have one.
    fn beside(&self, here: &Face, next: &Face) -> Option<Self> {
        let near = SLACK * here.size().min(next.size());
        let same = |a: [f64; 2], b: [f64; 2]| {
            let (a, b) = (here.in_space(a), next.in_space(b));
            (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt() <= near
        };
        let mut shared = here.corners().into_iter().filter_map(|a| {
            let twin = next.corners().into_iter().find(|&b| same(a, b));
            twin.map(|b| (a, b))
        });
        let ((a, b), (c, d)) = (shared.next()?, shared.next()?);
        let (start, end) = (self.place(a), self.place(c));
        // the edge in the chart is along one axis, forwards or backwards
        let along = [d[0] - b[0], d[1] - b[1]];
        let axis = usize::from(along[1].abs() > along[0].abs());
        let length = (end[0] - start[0]).hypot(end[1] - start[1]);
        let sign = along[axis].signum();
        let edge = [0, 1].map(|k: usize| sign * (end[k] - start[k]) / length);
        let side = |x: [f64; 2]| edge[0] * (x[1] - start[1]) - edge[1] * (x[0] - start[0]);
        let across = [-edge[1], edge[0]];
        [across, across.map(|x| -x)].into_iter().find_map(|across| {
            let (first, second) = if axis == 0 {
                (edge, across)
            } else {
                (across, edge)
            };
            let turned = Self {
                origin: [0, 1].map(|k: usize| start[k] - b[0] * first[k] - b[1] * second[k]),
                first,
                second,
            };
            (side(turned.place(next.middle())) * side(self.place(here.middle())) < 0.0)
                .then_some(turned)
        })
    }
}

/// Lays out faces: the first as its chart is, each other beside one that it shares an edge with and where nothing lies yet, and what has no such place in a
/// row to the right. O(faces²) for each face.
pub(super) fn unfold(faces: &[Face]) -> Vec<Placed> {
    let mut placed: Vec<Option<Placed>> = vec![None; faces.len()];
    let mut order = Vec::new();
    let flat = |origin| Placed {
        origin,
        first: [1.0, 0.0],
        second: [0.0, 1.0],
    };
    while let Some(next) = placed.iter().position(Option::is_none) {
        // a new island, right of all others
        let edge = placed
            .iter()
            .zip(faces)
            .filter_map(|(p, face)| Some(p.as_ref()?.bounds(face)[1][0]));
        let edge = edge.fold(f64::NEG_INFINITY, f64::max);
        let face = &faces[next];
        let left = if edge.is_finite() {
            edge + 0.1 * face.size() - face.low[0]
        } else {
            0.0
        };
        placed[next] = Some(flat([left, 0.0]));
        order.push(next);
        let mut at = order.len() - 1;
        while at < order.len() {
            let here = order[at];
            at += 1;
            let Some(base) = placed[here] else { continue };
            for other in 0..faces.len() {
                if placed[other].is_some() {
                    continue;
                }
                let Some(turned) = base.beside(&faces[here], &faces[other]) else {
                    continue;
                };
                let bounds = turned.bounds(&faces[other]);
                let free = placed.iter().zip(faces).all(|(p, face)| {
                    p.is_none_or(|p| !overlap(bounds, p.bounds(face), SLACK * face.size()))
                });
                if free {
                    placed[other] = Some(turned);
                    order.push(other);
                }
            }
        }
    }
    placed.into_iter().flatten().collect()
}

fn overlap(a: [[f64; 2]; 2], b: [[f64; 2]; 2], slack: f64) -> bool {
    (0..2).all(|k| a[0][k] + slack < b[1][k] && b[0][k] + slack < a[1][k])
}

#[cfg(test)]
mod tests {
    use super::{Face, Placed, overlap, unfold};

    /// The unit cube from inside, each face with some chart of its own.
    fn cube() -> Vec<Face> {
        let face = |frame| Face {
            frame,
            low: [0.0; 2],
            high: [1.0; 2],
        };
        [
            [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]],
            [[0., 0., 1.], [0., 1., 0.], [1., 0., 0.]],
            [[0., 1., 0.], [0., 0., 1.], [0., -1., 0.]],
            [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]],
            [[0., 0., 0.], [1., 0., 0.], [0., 0., 1.]],
            [[1., 1., 1.], [-1., 0., 0.], [0., 0., -1.]],
        ]
        .map(face)
        .to_vec()
    }

    #[test]
    fn a_cube_becomes_a_cross() {
        let faces = cube();
        let placed = unfold(&faces);
        assert_eq!(placed.len(), 6);
        for i in 0..6 {
            for j in 0..i {
                let [a, b] = [i, j].map(|k| placed[k].bounds(&faces[k]));
                assert!(!overlap(a, b, 1e-9), "{i} lies on {j}");
            }
        }
        // one piece: each face but the first has an edge in common with another on paper
        let touches = |a: &Placed, f: &Face, b: &Placed, g: &Face| {
            let near = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]) < 1e-9;
            let shared = f.corners().into_iter().filter(|c| {
                let place = a.place(*c);
                let space = f.in_space(*c);
                g.corners().iter().any(|d| {
                    near(place, b.place(*d))
                        && g.in_space(*d)
                            .iter()
                            .zip(space)
                            .all(|(x, y)| (x - y).abs() < 1e-9)
                })
            });
            shared.count() == 2
        };
        for i in 1..6 {
            assert!(
                (0..6).any(|j| j != i && touches(&placed[i], &faces[i], &placed[j], &faces[j])),
                "{i}"
            );
        }
        for (face, placed) in faces.iter().zip(&placed) {
            let back = placed.chart(placed.place([0.3, 0.8]));
            assert!(
                (back[0] - 0.3).abs() < 1e-12 && (back[1] - 0.8).abs() < 1e-12,
                "{face:?}"
            );
        }
    }

    #[test]
    fn what_shares_no_edge_lies_beside() {
        let mut faces = cube();
        faces.truncate(1);
        faces.push(Face {
            frame: [[9., 9., 9.], [1., 0., 0.], [0., 1., 0.]],
            ..faces[0]
        });
        let placed = unfold(&faces);
        assert!(placed[1].bounds(&faces[1])[0][0] > 1.0);
    }
}
